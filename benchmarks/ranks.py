"""The same on any number of ranks: random scenes of all kinds, and fixed ones for all schemes.

    tools/run python3 -m benchmarks.ranks --out 1.pickle
    tools/run mpirun --oversubscribe -n 3 python3 -m benchmarks.ranks --out 3.pickle
    tools/run python3 -m benchmarks.ranks --compare 1.pickle 3.pickle

On several ranks scenes of all sizes are divided where statics and generalised-α can divide them;
all ranks together factorise the matrices of the others. ``--log`` prints who has what. Comparing
prints a row for each study: scenes, the largest difference over what :mod:`.random_scenes` takes
as the size of such numbers, the largest over a scale that contains round-off, and where it is.
Round-off of random scenes is estimated by one rank as the median of the changes if a scene is
written in other units, turned or in another order; where it exceeds the target, the scale is larger
by as much as it does. ``--interrupt FILE`` makes a run that ends amid its steps; ``--resume FILE
--out OUT`` takes it to its end on any number of ranks.
"""

from __future__ import annotations

import argparse
import logging
import pickle
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from mpi4py import MPI

import numpy as np

import fem_lie as fl
from benchmarks import conserving_contact
from benchmarks.random_scenes import (
    NEAR,
    STUDIES,
    Numbers,
    Outcome,
    Study,
    Values,
    Way,
    difference,
    differences,
    outcome,
)
from fem_lie.solve.motion.integrator import Integrator
from tests.divided_scenes import divide
from tests.parallel_scenes import column, pendulum, share_factors, sheet, stopped
from tests.random_scenes import random_scene
from tests.test_explicit_joints import net

SEEDS = range(8)
TARGET = 1e-10
STEPS, STEP = 20, 1e-3


def by_bodies(values: np.ndarray, info: Any) -> np.ndarray:
    """Values of all nodes, (k, n, …), body after body: the numbering depends on the division."""
    return np.concatenate([values[:, body.nodes] for body in info.bodies], axis=1)


def motion(
    scene: fl.Scene,
    scheme: Integrator,
    step: float | fl.schemes.AdaptiveStep = STEP,
    steps: int = STEPS,
) -> Numbers:
    """Frames, velocities, joint forces, energies and times of a run."""
    result = scheme.run(scene, duration=steps * STEP, step=step, progress=False)
    energies = np.array([result.kinetic, result.elastic, result.potential])
    return {
        "frames": Values(by_bodies(result.frames, result.info), "of 1"),
        "velocities": Values(by_bodies(result.velocities, result.info), "velocity"),
        "joint forces": Values(result.joint_forces, "force"),
        "energies": Values(energies, "energy"),
        "times": Values(result.times, "time"),
    }


def path() -> Numbers:
    """Of a column that buckles, and the point where it does."""
    found = fl.follow_path(column(), fl.stability.PathEnds(critical_points=1))
    critical = np.array([point.factor for point in found.bifurcations])
    return {
        "frames": Values(found.frames, "of 1"),
        "factors": Values(found.factors, "factor"),
        "critical": Values(critical, "factor"),
    }


def shell() -> Numbers:
    """A sheet pulled at its corner, and its frequencies."""
    scene, _ = sheet()
    rest, modes = fl.statics(scene, load_steps=2), fl.vibrations(scene, 3)
    return {
        "frames": Values(by_bodies(rest.frames, rest.info), "of 1"),
        "frequencies": Values(modes.frequencies, "frequency"),
    }


def dropped(law: fl.contact.Penalty | fl.contact.Impact) -> fl.Scene:
    """A ball just over the floor."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    ball = scene.add(fl.RigidBody(1.0, 4e-3 * np.eye(3), (0, 0, 0.1)))
    ball.add_velocity((0.3, 0, -0.5))
    floor = fl.contact.Plane(fl.ground(), (0, 0, 1))
    scene.add(fl.contact.Contact(fl.contact.Sphere(ball.point("centre"), 0.1), floor, law))
    return scene


def balls_in_a_box() -> fl.Scene:
    """Of the benchmark of contact in conserving steps."""
    build, stiffness, _, _ = conserving_contact.CASES["box"]
    return build(stiffness)[0]


FIXED: dict[str, Callable[[], Numbers]] = {
    "path, with its bifurcation": path,
    "statics and vibrations of a shell": shell,
    "generalised-α, adaptive steps": lambda: motion(
        pendulum(), fl.GeneralisedAlpha(), fl.schemes.AdaptiveStep(1e-4)
    ),
    "generalised-α, net of cables": lambda: motion(net(), fl.GeneralisedAlpha()),
    "generalised-α, contact by penalty": lambda: motion(
        dropped(fl.contact.Penalty(1e5)), fl.GeneralisedAlpha()
    ),
    "generalised-α, impacts": lambda: motion(dropped(fl.contact.Impact()), fl.GeneralisedAlpha()),
    "energy-momentum, contact": lambda: motion(balls_in_a_box(), fl.EnergyMomentum()),
    "variational": lambda: motion(pendulum(), fl.schemes.Variational()),
    "explicit, net of cables": lambda: motion(net(), fl.Explicit(), 1e-5, 1),
}


def interrupted(file: Path) -> None:
    """Leave the file of a run that ends amid its steps."""
    try:
        fl.GeneralisedAlpha().run(
            stopped(0.011), duration=0.02, step=STEP, file=file, checkpoint_every=2, progress=False
        )
    except ArithmeticError:
        return
    raise AssertionError("the run should have ended early")


def to_the_end(file: Path) -> Numbers:
    """From the last checkpoint."""
    result = fl.GeneralisedAlpha().resume(stopped(np.inf), file, progress=False)
    return {"frames": Values(result.frames, "of 1")}


def all_of(file: Path | None) -> dict[str, list[Outcome]]:
    """Outcomes of all scenes of each study."""
    with TemporaryDirectory() as folder:
        given = file or Path(MPI.COMM_WORLD.bcast(folder)) / "run.h5"
        if file is None:
            interrupted(given)
        found = {"resumed": [Outcome(to_the_end(given))]}
        MPI.COMM_WORLD.barrier()
    if file is not None:
        return found
    for name, run in FIXED.items():
        found[name] = [Outcome(run())]
    of_study = with_round_off if MPI.COMM_WORLD.size == 1 else of_scene
    for name, study in STUDIES.items():
        found[f"random scenes: {name}"] = [of_study(study, seed) for seed in SEEDS]
    return found


def of_scene(study: Study, seed: int) -> Outcome:
    """Outcome of a random scene."""
    return outcome(study, Way(random_scene(seed, study.wanted)))


def with_round_off(study: Study, seed: int) -> Outcome:
    """Outcome of a random scene, and how much its numbers change if it is written otherwise."""
    found, ways = differences(study, seed, NEAR)
    return found._replace(round_off=float(np.median([error for error, _ in ways.values()])))


def compare(one: Path, other: Path) -> None:
    """Print a row for each study that both have."""
    first, second = (pickle.loads(path.read_bytes()) for path in (one, other))
    for name in sorted(first.keys() & second.keys()):
        both = list(zip(first[name], second[name], strict=True))
        found = [difference(a, b) for a, b in both]
        worst, where = max(found)
        scaled = [
            error / max(1.0, a.round_off / TARGET)
            for (error, _), (a, _) in zip(found, both, strict=True)
        ]
        print(
            f"| {other.stem} | {name} | {len(both)} | {worst:.1e} | {max(scaled):.1e} | "
            f"{where[:60]} |"
        )


def main() -> None:
    """Compute and keep, or compare."""
    asking = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    asking.add_argument("--out", type=Path)
    asking.add_argument("--resume", type=Path)
    asking.add_argument("--interrupt", type=Path)
    asking.add_argument("--compare", type=Path, nargs=2)
    asking.add_argument("--log", action="store_true")
    asked = asking.parse_args()
    if asked.compare:
        compare(*asked.compare)
        return
    if asked.log:
        logging.basicConfig(format="%(message)s")
        logging.getLogger("fem_lie.parts").setLevel(logging.INFO)
    if MPI.COMM_WORLD.size > 1:
        share_factors()
        divide()
    if asked.interrupt:
        interrupted(asked.interrupt)
        return
    found = all_of(asked.resume)
    if MPI.COMM_WORLD.rank == 0:
        asked.out.write_bytes(pickle.dumps(found))


if __name__ == "__main__":
    main()
