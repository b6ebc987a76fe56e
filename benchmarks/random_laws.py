"""Random small scenes of all kinds: order of convergence, balance of energy, resumed runs.

Each scene of :mod:`tests.random_scenes` with all kinds of bodies is run with steps of h, h/2 and
h/4, and with smaller ones where these do not resolve its waves. Differences at the end have to
fall; the balance of energy, with what was dissipated, has to
close; and a run that is interrupted and resumed from its file has to be the same to the last bit.
Units, rotation, translation and order are :mod:`benchmarks.random_scenes`.

    python3 -m benchmarks.random_laws --scenes 100
"""

from __future__ import annotations

import argparse
import tempfile
import warnings
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple
from unittest import mock

import numpy as np

import fem_lie as fl
from benchmarks.progress import Progress
from fem_lie.lie.node_types import has_position
from fem_lie.solve.motion.integrator import Integrator
from fem_lie.solve.recording.checkpoints import Checkpoints
from tests.random_scenes import MIXED, MIXED_CONSERVING, Wanted, random_scene
from tests.scene_builder import build
from tests.scene_data import SceneData

STEPS = 12
HALVED = 0.6
"""Largest difference of h/2 and h/4 over that of h and h/2: 0.25 for waves that steps resolve."""
FINEST = 128
"""Parts of a step at most, where loads that begin at once make waves that larger ones do not
resolve."""
REST = 1e-12
"""Energy of a scene in which nothing moves, J: gaps are parts of round-off."""
RESOLVED = 2e-4
"""Differences over the size of a scene that may be those of waves which no step resolves."""


class Scheme(NamedTuple):
    """A scheme, its scenes, and how well it balances energy.

    Attributes:
        wanted: What scenes may have.
        scheme: It.
        gap: Of the balance of energy, at most.
        finer: In so many parts of steps a larger gap has to fall; 1: there may be none.
    """

    wanted: Wanted
    scheme: Integrator
    gap: float
    finer: int


SCHEMES = {
    "generalised-α": Scheme(MIXED, fl.GeneralisedAlpha(tolerance=1e-9), 1e-2, 16),
    "energy-momentum": Scheme(MIXED_CONSERVING, fl.EnergyMomentum(), 1e-7, 1),
    "energy-decaying": Scheme(MIXED_CONSERVING, fl.EnergyDecaying(), 1e-7, 1),
}


def run(scheme: Integrator, data: SceneData, parts: int = 1, **options: Any) -> fl.Result:
    """The motion with steps that are ``parts`` times as short."""
    step = data.duration / (data.steps * parts)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return scheme.run(
            build(data).scene, duration=data.duration, step=step, progress=False, **options
        )


def last_positions(result: fl.Result) -> np.ndarray:
    """Those of all nodes that have one, at the end, shape (n, 3)."""
    return result.frames[-1, has_position(result.info.node_types), 0]


def order(known: Scheme, data: SceneData) -> str:
    """What is wrong with the differences between steps of h, h/2, h/4 and so on, or nothing.

    They fall from h on; or with smaller steps twice one after the other, or to nothing.
    """
    ends = [last_positions(run(known.scheme, data, parts)) for parts in (1, 2)]
    found, falls, parts = [float(np.abs(ends[0] - ends[1]).max())], 0, 2
    while parts < FINEST:
        parts *= 2
        ends = [ends[1], last_positions(run(known.scheme, data, parts))]
        found.append(float(np.abs(ends[0] - ends[1]).max()))
        small = found[-1] <= RESOLVED * data.size
        falls = falls + 1 if small or found[-1] <= HALVED * found[-2] else 0
        if falls and (parts == 4 or small or falls == 2):
            return ""
    return f"differences {', '.join(f'{each:.1e}' for each in found)}"


def balance(known: Scheme, data: SceneData) -> str:
    """What is wrong with the balance of energy, or nothing.

    Loads that begin at once make waves that no step resolves, and dissipation takes their energy.
    """
    result = run(known.scheme, data)
    gap = result.balance_error
    if gap <= known.gap or float((result.kinetic + result.elastic).max()) <= REST:
        return ""
    finer = run(known.scheme, data, known.finer).balance_error
    return "" if finer <= HALVED * gap else f"energy gaps {gap:.1e}, {finer:.1e}"


def resumed(known: Scheme, data: SceneData) -> str:
    """What is wrong with a run that was interrupted at two thirds, or nothing."""
    whole, write = run(known.scheme, data), Checkpoints.write

    def interrupted(store: Checkpoints, index: int, *rest: Any) -> None:
        write(store, index, *rest)
        if index >= 2 * data.steps // 3:
            raise KeyboardInterrupt

    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "run.h5"
        with mock.patch.object(Checkpoints, "write", interrupted):
            try:
                run(known.scheme, data, file=file, checkpoint_every=3)
            except KeyboardInterrupt:
                pass
            else:
                return "was never interrupted"
        again = known.scheme.resume(build(data).scene, file)
    names = ("frames", "velocities", "joint_forces", "elastic", "kinetic")
    changed = [n for n in names if not np.array_equal(getattr(again, n), getattr(whole, n))]
    return "" if not changed else f"other {', '.join(changed)}"


LAWS: dict[str, Callable[[Scheme, SceneData], str]] = {
    "order": order,
    "energy": balance,
    "resume": resumed,
}


def broken(name: str, seed: int, laws: tuple[str, ...] = (*LAWS,)) -> dict[str, str]:
    """Laws that a scene breaks, with how; ``refused``: it does not run at all."""
    known = SCHEMES[name]
    data = random_scene(seed, replace(known.wanted, steps=STEPS))
    found = {}
    try:
        for law in laws:
            if said := LAWS[law](known, data):
                found[law] = said
    except (ValueError, fl.ConvergenceError) as error:
        found["refused"] = f"{type(error).__name__}: {error}"
    return found


def main() -> None:
    """Print every law that a scene breaks, and how many do."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", type=int, default=100)
    parser.add_argument("--first", type=int, default=0, help="seed of the first")
    parser.add_argument("--scheme", choices=SCHEMES, action="append")
    parser.add_argument("--law", choices=LAWS, action="append")
    parser.add_argument("--save", type=Path, help="file of results, to continue from")
    options = parser.parse_args()
    laws, progress = tuple(options.law or LAWS), Progress(options.save)
    for name in options.scheme or SCHEMES:
        count: Counter[str] = Counter()
        for seed in range(options.first, options.first + options.scenes):
            key = f"{name}, {seed}, {' '.join(laws)}"
            found = progress.result(key, partial(broken, name, seed, laws))
            count.update(list(found))
            for law, said in found.items():
                print(f"    {name}, seed {seed}, {law}: {said[:200]}", flush=True)
        print(f"| {name} | {options.scenes} | {dict(count)} |", flush=True)


if __name__ == "__main__":
    main()
