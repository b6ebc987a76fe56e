"""Random small scenes: the same result in other units, turned, moved, and in another order.

Each scene of :mod:`tests.random_scenes` is computed as it is and in eight other ways, and what is
found is brought back and compared: positions over the size of the scene, velocities, energies,
joint forces and moments over the largest in the scene (or over what is small for these scenes),
eigenvalues and load factors over their own size.

    python3 -m benchmarks.random_scenes --scenes 200
"""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Callable, Collection
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import fem_lie as fl
from benchmarks.progress import Progress
from fem_lie import lie
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.lie.node_types import NodeType, has_position
from fem_lie.solve.motion.integrator import Integrator
from tests.random_scenes import (
    CONSERVING,
    HELD,
    MIXED,
    MIXED_CONSERVING,
    MOTION,
    PROPORTIONAL,
    Wanted,
    random_scene,
)
from tests.scene_builder import build
from tests.scene_data import SceneData, ShellData, converted, placed, reordered
from tests.unit_systems import METRES, OTHER_SYSTEMS, UnitSystem


class Values(NamedTuple):
    """Numbers of one thing, and of what they are a part: all of a group have the same scale."""

    values: np.ndarray
    group: str


Numbers = dict[str, Values]

SCALES = {"of the size": 1.0, "of 1": 1.0, "force": 1.0, "velocity": 1e-2, "energy": 1e-2}
"""At least, in metres, newtons and seconds: what is round-off in a scene is not its own measure."""
ABSOLUTE = ("of the size", "of 1")

TARGET = 1e-8
FAR = {"moved by 1e3": 1e3, "moved by 1e6": 1e6}
NEAR = (*map(str, OTHER_SYSTEMS), "turned", "another order")


def allowed(way: str) -> float:
    """The target, and the round-off of distant positions in strains, larger for slender beams."""
    return TARGET + 1e-10 * FAR.get(way, 0.0)


class Way(NamedTuple):
    """A scene written otherwise, and the way back.

    Attributes:
        data: The scene.
        units: Its units.
        rotation: By which it was turned.
        shift: By which it was moved after that, in metres.
    """

    data: SceneData
    units: UnitSystem = METRES
    rotation: np.ndarray = np.eye(3)
    shift: np.ndarray = np.zeros(3)


def ways(data: SceneData, seed: int) -> dict[str, Way]:
    """All, the given one first."""
    rng = np.random.default_rng(seed)
    Q, shift = lie.so3_exp(rng.normal(size=3)), data.size * rng.normal(size=3)
    still, same = np.zeros(3), np.eye(3)
    far = {name: factor * shift for name, factor in FAR.items()}
    return {
        "as it is": Way(data),
        **{str(u): Way(converted(data, u), units=u) for u in OTHER_SYSTEMS},
        "turned": Way(placed(data, Q, still), rotation=Q),
        **{name: Way(placed(data, same, x), shift=x) for name, x in far.items()},
        "another order": Way(reordered(data, rng)),
    }


def _global(rotation: np.ndarray, local: np.ndarray) -> np.ndarray:
    return np.einsum("...ij,...j->...i", rotation, local)


def positions(way: Way, info: SceneInfo, frames: np.ndarray) -> Numbers:
    """Positions over the size, and directors, of all nodes of each body."""
    found, size = {}, way.data.size
    shift = way.units.length(way.shift) / size
    for body in way.data.bodies:
        own = info.body(body.name)
        H, kinds = frames[..., own.nodes, :, :], own.node_types
        assert kinds is not None
        x = (H[..., has_position(kinds), 0, :] / size - shift) @ way.rotation
        found[f"positions of {body.name}"] = Values(x, "of the size")
        if (kinds != NodeType.FRAME).any():
            continue
        # a shell's first two directors are its own choice
        first = 3 if isinstance(body, ShellData) else 1
        found[f"directors of {body.name}"] = Values(H[..., first:, :] @ way.rotation, "of 1")
    return found


def joint_forces(way: Way, info: SceneInfo, forces: np.ndarray) -> Numbers:
    """Absolute values, as axes of joints are chosen along global ones; moments over the size."""
    back, found = way.units.inverse, {}
    size = back.length(way.data.size)
    for joint in way.data.joints:
        f = back.wrench(forces[..., info.joint(joint.name), :]).reshape(*forces.shape[:-2], 2, 3)
        values = np.linalg.norm(f, axis=-1) / [1.0, size]
        found[f"force and moment of {joint.name}"] = Values(values, "force")
    return found


def motion(scheme: Integrator) -> Callable[[Way], Numbers]:
    """What a scheme in time finds."""

    def run(way: Way) -> Numbers:
        data, built, back = way.data, build(way.data), way.units.inverse
        step = data.duration / data.steps
        result = scheme.run(built.scene, duration=data.duration, step=step, progress=False)
        speeds = {}
        for body in data.bodies:
            own = result.info.body(body.name)
            assert own.node_types is not None
            nodes = own.nodes[has_position(own.node_types)]
            R = result.frames[:, nodes, 1:].swapaxes(-1, -2)
            v = back.velocity(_global(R, result.velocities[:, nodes, :3]))
            speeds[f"velocities of {body.name}"] = Values(v @ way.rotation, "velocity")
        energies = {"kinetic energy": result.kinetic, "elastic energy": result.elastic}
        if not way.shift.any():
            # that of a load with a history depends on where the origin is
            energies["potential energy"] = result.potential - result.potential[0]
        return {
            **positions(way, result.info, result.frames),
            **joint_forces(way, result.info, result.joint_forces),
            **speeds,
            **{name: Values(back.energy(e), "energy") for name, e in energies.items()},
        }

    return run


def equilibrium(way: Way) -> Numbers:
    """The last state of statics."""
    built = build(way.data, static=True)
    result = fl.statics(built.scene)
    return {
        **positions(way, result.info, result.frames[-1]),
        **joint_forces(way, result.info, result.joint_forces[-1]),
    }


def frequencies(way: Way) -> Numbers:
    """Eigenvalues of the slowest vibrations, each over its absolute value."""
    modes = fl.vibrations(build(way.data, static=True).scene, 4)
    own = way.units.inverse.rate(1.0) * modes.eigenvalues
    return {f"eigenvalue {k}": Values(s, f"eigenvalue {k}") for k, s in enumerate(own)}


def load_factors(way: Way) -> Numbers:
    """The lowest of linear buckling."""
    factors = fl.buckling(build(way.data, static=True).scene, 2).factors
    return {f"factor {k}": Values(f, f"factor {k}") for k, f in enumerate(factors)}


MOST_ITERATIONS, FINEST = 50, 32
"""Of a step that a conserving scheme resolves (25, where those that are too large take 90 to 400);
and the parts at most of a step that is too large."""


def as_given(data: SceneData) -> SceneData:
    """The scene with its own steps."""
    return data


def resolved_by(scheme: Integrator) -> Callable[[SceneData], SceneData]:
    """Scenes with steps that a scheme makes in full, in few iterations.

    Whether a step that is too large finds a solution in full or in parts is a matter of the last
    digits, and the solutions differ.
    """

    def resolved(data: SceneData) -> SceneData:
        parts = 1
        while parts < FINEST and not _resolves(scheme, data, parts):
            parts *= 2
        return replace(data, steps=parts * data.steps)

    return resolved


def _resolves(scheme: Integrator, data: SceneData, parts: int) -> bool:
    step = data.duration / data.steps / parts
    try:
        result = scheme.run(build(data).scene, duration=data.duration, step=step, progress=False)
    except fl.ConvergenceError:
        return False
    except ValueError:  # refused, with any step
        return True
    return not result.divided and bool((np.diff(result.iterations) <= MOST_ITERATIONS).all())


class Study(NamedTuple):
    """What is computed of which scenes.

    Attributes:
        wanted: What scenes may have.
        run: What is found of one.
        resolved: The scene with the steps that all ways of writing it are run with.
    """

    wanted: Wanted
    run: Callable[[Way], Numbers]
    resolved: Callable[[SceneData], SceneData] = as_given


SHORT = 12
ENERGY_MOMENTUM, ENERGY_DECAYING = fl.EnergyMomentum(), fl.EnergyDecaying()
STUDIES = {
    "generalised-α": Study(
        replace(MOTION, steps=SHORT), motion(fl.GeneralisedAlpha(tolerance=1e-9))
    ),
    "energy-momentum": Study(replace(CONSERVING, steps=SHORT), motion(ENERGY_MOMENTUM)),
    "energy-decaying": Study(replace(CONSERVING, steps=SHORT), motion(ENERGY_DECAYING)),
    "mixed, generalised-α": Study(
        replace(MIXED, steps=SHORT), motion(fl.GeneralisedAlpha(tolerance=1e-11))
    ),
    "mixed, energy-momentum": Study(
        replace(MIXED_CONSERVING, steps=SHORT),
        motion(ENERGY_MOMENTUM),
        resolved_by(ENERGY_MOMENTUM),
    ),
    "mixed, energy-decaying": Study(
        replace(MIXED_CONSERVING, steps=SHORT),
        motion(ENERGY_DECAYING),
        resolved_by(ENERGY_DECAYING),
    ),
    "statics": Study(HELD, equilibrium),
    "vibrations": Study(HELD, frequencies),
    "buckling": Study(PROPORTIONAL, load_factors),
}


class Outcome(NamedTuple):
    """Numbers, or why there are none.

    Attributes:
        found: The numbers.
        failure: Kind of the error.
        round_off: Their largest difference from those of the scene in other ways, if it is known.
    """

    found: Numbers
    failure: str = ""
    round_off: float = 0.0


def outcome(study: Study, way: Way) -> Outcome:
    """What a study finds, or the kind of error that it ends with."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return Outcome(study.run(way))
    except (ValueError, fl.ConvergenceError) as error:
        return Outcome({}, f"{type(error).__name__}: {error}")


def difference(one: Outcome, other: Outcome) -> tuple[float, str]:
    """The largest difference of two outcomes, and of what it is; inf if only one has failed."""
    if bool(one.failure) != bool(other.failure):
        return np.inf, one.failure or other.failure
    scales = dict(SCALES)
    for values, group in one.found.values():
        if group not in ABSOLUTE:
            scales[group] = max(scales.get(group, 0.0), float(np.abs(values).max(initial=0.0)))
    worst, where = 0.0, ""
    for name, (values, group) in one.found.items():
        if name not in other.found:
            continue
        given = other.found[name].values
        if given.shape != values.shape:
            return np.inf, f"{name}: {given.shape} instead of {values.shape}"
        largest = float(np.abs(given - values).max(initial=0.0)) / scales[group]
        if not largest <= worst:
            worst, where = largest, name
    return worst, where


def differences(
    study: Study, seed: int, chosen: Collection[str] | None = None
) -> tuple[Outcome, dict[str, tuple[float, str]]]:
    """The scene as it is, and how much the ``chosen`` ways, by default all, differ from it."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        data = study.resolved(random_scene(seed, study.wanted))
    all_ways = ways(data, seed)
    first = outcome(study, all_ways.pop("as it is"))
    others = {name: way for name, way in all_ways.items() if chosen is None or name in chosen}
    return first, {name: difference(first, outcome(study, w)) for name, w in others.items()}


def record(study: Study, seed: int, chosen: Collection[str] | None) -> dict[str, Any]:
    """The same as JSON has it."""
    first, found = differences(study, seed, chosen)
    return {"failure": first.failure, "ways": found}


def main() -> None:
    """Print a table: the largest difference of each study and way, and those above the target."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", type=int, default=200)
    parser.add_argument("--first", type=int, default=0, help="seed of the first")
    parser.add_argument("--study", choices=STUDIES, action="append")
    parser.add_argument("--way", action="append", help="default: all")
    parser.add_argument("--save", type=Path, help="file of results, to continue from")
    options = parser.parse_args()
    seeds, progress = range(options.first, options.first + options.scenes), Progress(options.save)
    for name in options.study or STUDIES:
        worst: dict[str, list[float]] = {}
        failures = 0
        for seed in seeds:
            compute = partial(record, STUDIES[name], seed, options.way)
            known = progress.result(f"{name}, {seed}", compute)
            if known["failure"]:
                failures += 1
                print(f"    {name}, seed {seed}: {known['failure'][:150]}", flush=True)
            for way, (error, where) in known["ways"].items():
                worst.setdefault(way, []).append(error)
                if not error <= allowed(way):
                    print(f"    {name}, seed {seed}, {way}: {error:.1e}, {where[:200]}", flush=True)
        for way, errors in worst.items():
            above = sum(not error <= TARGET for error in errors)
            print(
                f"| {name} | {way} | {max(errors):.1e} | {np.median(errors):.1e} | {above} of "
                f"{len(errors)} |",
                flush=True,
            )
        print(f"    {name}: {failures} scenes fail as they are", flush=True)


if __name__ == "__main__":
    main()
