"""Work against precision of all schemes: what an error from 1e-3 to 1e-10 costs.

Two scenes, both of soft bars: the double pendulum of order_four.py, and a four-bar mechanism whose
last axis is tilted by 5 degrees, driven by one radian in 0.2 s. The error is the distance between
the final positions of all nodes and those of a reference, over the length of the model, so it is
the error in time alone. References are composed steps, iterated to round-off, of half the size of
any other; they are kept beside the numbers (``--references`` makes them anew) with by how much
steps of twice the size differ from them.

Each scheme is run to three tolerances of its iteration, and at an error the cheapest run counts.
Seconds are those that the processor had for the run, without what it takes to begin; all runs are
made one after the other, again and again, and of each the least counts.

    python -m benchmarks.work_precision [--repeats 3] [--references] [--table]
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from time import process_time
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

import fem_lie as fl
from demos.soft_bars import SOFT, soft_pendulum
from fem_lie.solve import progress_bars
from fem_lie.solve.motion.integrator import Integrator

DOCS = Path(__file__).parents[1] / "docs" / "measured"
REFERENCES = Path(__file__).parents[1] / "demos" / "reference" / "work_precision.csv"
NUMBERS = DOCS / "work_precision.csv"
TOLERANCES = (1e-6, 1e-7, 0.0)
ERRORS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)
TARGET, WANTED = 1e-7, 5.0
FINEST = 3200


class Problem(NamedTuple):
    """A scene, how long it moves, and its length."""

    scene: Callable[[], fl.Scene]
    duration: float
    length: float


class Method(NamedTuple):
    """A scheme for a tolerance, and numbers of its steps."""

    scheme: Callable[[float], Integrator]
    steps: tuple[int, ...]


class Row(NamedTuple):
    """One run."""

    problem: str
    method: str
    tolerance: float
    steps: int
    error: float
    seconds: float
    iterations: int
    matrices: int


def four_bar() -> fl.Scene:
    """Three soft bars between two hinges, the first of which is driven."""
    corners = [(0, 0, 0), (0, 0, 0.2), (0.4, 0, 0.2), (0.4, 0, 0)]
    scene = fl.Scene()
    one, two, three = (
        scene.add(fl.Beam.straight(a, b, SOFT, cells=3, up=(0, 1, 0))) for a, b in pairwise(corners)
    )
    y, tilted = (0, 1, 0), (-np.sin(np.radians(5.0)), np.cos(np.radians(5.0)), 0)
    crank = scene.add(fl.joints.Revolute(fl.ground(), one.point("start"), axis=y))
    scene.add(fl.joints.Revolute(one.point("end"), two.point("start"), axis=y))
    scene.add(fl.joints.Revolute(two.point("end"), three.point("start"), axis=tilted))
    scene.add(fl.joints.Revolute(fl.ground(), three.point("end"), axis=y))
    scene.add(fl.joints.Drive(crank.angle, _turned))
    return scene


def _turned(t: float) -> float:
    """One radian in 0.2 s, with rates that begin from zero."""
    s = t / 0.2
    return s**3 * (10.0 - 15.0 * s + 6.0 * s**2)


PROBLEMS = {
    "soft double pendulum": Problem(soft_pendulum, 0.4, 1.0),
    "soft four-bar": Problem(four_bar, 0.2, 0.4),
}
_SECOND = tuple(100 * 2**k for k in range(8))
METHODS = {
    "generalised-alpha": Method(
        lambda tolerance: fl.GeneralisedAlpha(radius=0.8, tolerance=tolerance or 1e-11), _SECOND
    ),
    "energy-momentum": Method(lambda tolerance: fl.EnergyMomentum(tolerance), _SECOND[:-1]),
    "energy-decaying": Method(lambda tolerance: fl.EnergyDecaying(tolerance), _SECOND[:-1]),
    "variational": Method(lambda tolerance: fl.schemes.Variational(tolerance), _SECOND[:-2]),
    "composed, five stages": Method(
        lambda tolerance: fl.schemes.Composed(fl.EnergyMomentum(tolerance)),
        (20, 40, 80, 160, 320, 640),
    ),
    "composed, nine stages": Method(
        lambda tolerance: fl.schemes.Composed(
            fl.EnergyMomentum(tolerance), fl.schemes.NineStages()
        ),
        (11, 22, 44, 88, 176, 352),
    ),
    "composed, triple jump": Method(
        lambda tolerance: fl.schemes.Composed(
            fl.EnergyMomentum(tolerance), fl.schemes.TripleJump()
        ),
        (40, 80, 160, 320, 640, 1280),
    ),
}
FOURTH = ("composed, five stages", "composed, nine stages", "composed, triple jump")


def run(problem: Problem, scheme: Integrator, steps: int) -> fl.Result:
    """The state at the end alone is kept."""
    duration = problem.duration
    return scheme.run(problem.scene(), duration=duration, step=duration / steps, save_every=steps)


def positions(result: fl.Result) -> np.ndarray:
    """Of all nodes at the end, shape (N, 3)."""
    return np.asarray(result.frames[-1, :, 0])


def make_references() -> None:
    """Write them, and by how much they differ from steps of twice the size."""
    with REFERENCES.open("w", newline="") as file:
        table = csv.writer(file)
        for name, problem in PROBLEMS.items():
            near, far = (
                positions(run(problem, fl.schemes.Composed(), n)) for n in (FINEST, FINEST // 2)
            )
            gap = float(np.linalg.norm(near - far, axis=1).max() / problem.length)
            print(f"{name}: {FINEST} and {FINEST // 2} composed steps differ by {gap:.1e}")
            table.writerow([name, repr(gap), *map(repr, near.ravel().tolist())])


def references() -> dict[str, np.ndarray]:
    """Positions at the end, of each problem."""
    with REFERENCES.open(newline="") as file:
        return {row[0]: np.array(row[2:], dtype=float).reshape(-1, 3) for row in csv.reader(file)}


def measure(repeats: int) -> list[Row]:
    """All runs, in turns; those that fail are said and left out."""
    progress_bars.perf_counter = process_time  # of the processor, beside whatever else runs
    exact, best = references(), dict[tuple[str, str, float, int], Row]()
    plans = [
        (problem, method, tolerance, steps)
        for problem in PROBLEMS
        for method, (_, numbers) in METHODS.items()
        for tolerance in TOLERANCES
        for steps in numbers
    ]
    failed = set()
    for _ in range(repeats):
        for plan in plans:
            name, method, tolerance, steps = plan
            problem = PROBLEMS[name]
            if plan in failed:
                continue
            try:
                made = run(problem, METHODS[method].scheme(tolerance), steps)
            except fl.ConvergenceError as error:
                failed.add(plan)
                print(f"{plan}: {error}")
                continue
            error = np.linalg.norm(positions(made) - exact[name], axis=1).max() / problem.length
            counts = int(made.iterations[-1]), made.factorisations
            row = Row(*plan, float(error), made.seconds, *counts)
            if plan not in best or row.seconds < best[plan].seconds:
                best[plan] = row
    return list(best.values())


def write(rows: list[Row]) -> None:
    """Keep the numbers."""
    with NUMBERS.open("w", newline="") as file:
        table = csv.writer(file)
        table.writerow(Row._fields)
        table.writerows(rows)


def read() -> list[Row]:
    """Those that are kept."""
    with NUMBERS.open(newline="") as file:
        return [
            Row(a, b, float(c), int(d), float(e), float(f), int(g), int(h))
            for a, b, c, d, e, f, g, h in list(csv.reader(file))[1:]
        ]


def front(rows: list[Row]) -> list[Row]:
    """Those that no other run beats in both error and seconds, by error from the largest."""
    kept: list[Row] = []
    for row in sorted(rows, key=lambda row: row.seconds):
        if not kept or row.error < kept[-1].error:
            kept.append(row)
    return kept


def seconds_at(error: float, rows: list[Row]) -> float:
    """What an error costs with the better tolerance; no number beyond the best run.

    Between runs of one tolerance, logarithms of both.
    """
    found = [float("inf")]
    for tolerance in TOLERANCES:
        kept = front([row for row in rows if row.tolerance == tolerance])
        errors = np.log([row.error for row in kept])[::-1]
        seconds = np.log([row.seconds for row in kept])[::-1]
        if len(kept) and np.log(error) >= errors[0]:
            found.append(float(np.exp(np.interp(np.log(error), errors, seconds))))
    return min(found)


def show(rows: list[Row]) -> None:
    """A table of seconds at errors, and the ratio that is wanted."""
    for problem in PROBLEMS:
        print(f"\n| {problem}: ms | " + " | ".join(f"{e:.0e}" for e in ERRORS) + " |")
        print("|---" * (len(ERRORS) + 1) + "|")
        at = {}
        for method in METHODS:
            own = [row for row in rows if (row.problem, row.method) == (problem, method)]
            cells = [seconds_at(error, own) for error in ERRORS]
            at[method] = cells[ERRORS.index(TARGET)]
            reported = ("–" if np.isinf(cell) else f"{1e3 * cell:.3g}" for cell in cells)
            print(f"| {method} | " + " | ".join(reported) + " |")
        fastest = min(at[name] for name in FOURTH)
        ratio = at["generalised-alpha"] / fastest
        print(f"fourth order at {TARGET:.0e}: {ratio:.2f} times faster (wanted {WANTED:g})")


def draw(rows: list[Row]) -> None:
    """Error over seconds, the front of each scheme."""
    figure = Figure(figsize=(10.0, 4.5), dpi=130, layout="constrained")
    for axes, problem in zip(figure.subplots(1, 2), PROBLEMS, strict=True):
        for method in METHODS:
            own = [row for row in rows if (row.problem, row.method) == (problem, method)]
            kept = front(own)
            seconds, errors = [row.seconds for row in kept], [row.error for row in kept]
            line = "o-" if method in FOURTH else "s--"
            axes.loglog(seconds, errors, line, markersize=4, label=method)
        axes.set(title=problem, xlabel="processor seconds", ylabel="error, relative")
        axes.set_ylim(1e-11, 1e-2)
        axes.grid(color="#DDDDDD", linewidth=0.6)
    axes.legend(frameon=False, fontsize=8)
    figure.savefig(DOCS / "work_precision.png")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--references", action="store_true", help="make references anew")
    parser.add_argument("--table", action="store_true", help="of the numbers that are kept")
    options = parser.parse_args()
    if options.references or not REFERENCES.is_file():
        make_references()
    if not options.table:
        write(measure(options.repeats))
    rows = read()
    show(rows)
    draw(rows)


if __name__ == "__main__":
    main()
