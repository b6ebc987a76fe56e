"""Processor time of the cases of :mod:`benchmarks.short_runs` in two checkouts, in turns.

    RUN -m benchmarks.in_turns OTHER [--rounds 7] [--only "generalised-α" "net"] [--list]

OTHER is the folder of another checkout, such as ``git worktree add OTHER COMMIT``. Each checkout
runs its own scenes with its own package, in a process of its own that stays alive, so public names
may differ; cases are the same by scheme and name. Every case runs once for what is compiled, loaded
and cached. In each round all cases then run in both processes, one right after the other, and the
order changes from round to round. What counts is the processor time of building the scene and of
the whole run, that of child processes included: the least of all rounds, since other work on the
machine only adds.

The table has the least time A of the other checkout and B of this one, their ratio, the iterations
of both, and the difference of the ends of both runs over the largest number in them.
"""

from __future__ import annotations

import json
import logging
import os
import resource
import subprocess
import sys
import warnings
from argparse import ArgumentParser
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np

HERE = Path(__file__).parents[1]
ANSWER = "--answer"
LIMIT = 1.10
"""Ratio above which a case is listed at the end."""


class Row(NamedTuple):
    """One case.

    Attributes:
        scheme: Name of the scheme.
        case: What is in the scene.
        seconds: Least processor time in the other checkout and in this one.
        iterations: Likewise.
        apart: Largest difference of the ends of both runs over the largest number in them.
    """

    scheme: str
    case: str
    seconds: tuple[float, float]
    iterations: tuple[int, int]
    apart: float

    @property
    def ratio(self) -> float:
        """Time in this checkout over that in the other one."""
        return self.seconds[1] / self.seconds[0]


# --- the process of a checkout --------------------------------------------------------------------


def answer(folder: str) -> None:
    """Run the cases whose names are asked for, with the scenes and the package of a folder."""
    sys.path.insert(0, folder)
    import fem_lie

    assert Path(fem_lie.__file__).is_relative_to(folder), fem_lie.__file__
    from benchmarks.short_runs import CASES

    logging.disable(logging.WARNING)
    warnings.simplefilter("ignore")
    cases = {f"{case.scheme}, {case.name}": case for case in CASES}
    for line in sys.stdin:
        before = processor_time()
        try:
            outcome = cases[line.strip()].run()
        except (RuntimeError, TypeError, ValueError, AttributeError, KeyError) as error:
            found: dict[str, Any] = {"error": f"{type(error).__name__}: {error}"}
        else:
            found = {
                "seconds": processor_time() - before,
                "iterations": outcome.iterations,
                "end": outcome.end.ravel().tolist(),
            }
        print("=", json.dumps(found), flush=True)


def processor_time() -> float:
    """Seconds of this process and of its children that have ended."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(each.ru_utime + each.ru_stime for each in used)


# --- both in turns --------------------------------------------------------------------------------


class Checkout:
    """A process that runs cases with the package of a folder."""

    def __init__(self, folder: Path) -> None:
        self._process = subprocess.Popen(
            [sys.executable, __file__, ANSWER, str(folder)],
            env={**os.environ, "OMP_NUM_THREADS": "1", "PYTHONPATH": str(folder)},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def run(self, name: str) -> dict[str, Any]:
        """What the process answers about a case."""
        assert self._process.stdin is not None and self._process.stdout is not None
        self._process.stdin.write(f"{name}\n")
        self._process.stdin.flush()
        for line in self._process.stdout:
            if line.startswith("= "):
                found: dict[str, Any] = json.loads(line[2:])
                return found
        raise SystemExit("the process of a checkout has ended")

    def end(self) -> None:
        """Let the process end."""
        assert self._process.stdin is not None
        self._process.stdin.close()
        self._process.wait()


@contextmanager
def checkouts(*folders: Path) -> Iterator[list[Checkout]]:
    """Processes that end with the block."""
    found = [Checkout(folder) for folder in folders]
    try:
        yield found
    finally:
        for each in found:
            each.end()


def measure(
    both: Sequence[Checkout], names: Sequence[str], rounds: int
) -> dict[str, tuple[list[dict[str, Any]], np.ndarray]]:
    """Of each case the first answers of both, and times of all rounds, shape (rounds, 2).

    Cases that fail in either process run once and have no times.
    """
    first = {name: [checkout.run(name) for checkout in both] for name in names}
    runs = [n for n, answers in first.items() if not any("error" in a for a in answers)]
    seconds = {name: np.zeros((rounds if name in runs else 0, 2)) for name in names}
    for k in range(rounds):
        start = perf_counter()
        for name in runs:
            for side in (0, 1) if k % 2 == 0 else (1, 0):
                seconds[name][k, side] = both[side].run(name)["seconds"]
        print(f"round {k + 1}: {perf_counter() - start:.0f} s", file=sys.stderr, flush=True)
    return {name: (first[name], seconds[name]) for name in names}


def difference(ends: Sequence[Sequence[float]]) -> float:
    """Largest difference over the largest number; infinite if there are not as many of both."""
    one, other = (np.array(end) for end in ends)
    if one.shape != other.shape:
        return float("inf")
    return float(np.abs(one - other).max() / max(np.abs(one).max(), np.finfo(float).tiny))


def show(rows: Sequence[Row]) -> None:
    """The table, the median and the largest ratio, and the cases above the limit."""
    print("| scheme | case | A, s | B, s | B/A | iterations A | B | ends apart |")
    print("|---|---|---|---|---|---|---|---|")
    for row in rows:
        a, b = row.seconds
        print(
            f"| {row.scheme} | {row.case} | {a:.3f} | {b:.3f} | {row.ratio:.2f} "
            f"| {row.iterations[0]} | {row.iterations[1]} | {row.apart:.0e} |"
        )
    ordered = sorted(rows, key=lambda row: -row.ratio)
    above = [f"{row.scheme}, {row.case}: {row.ratio:.2f}" for row in ordered if row.ratio > LIMIT]
    print(f"\nmedian {np.median([row.ratio for row in rows]):.3f}, largest {ordered[0].ratio:.2f}")
    print(f"above {LIMIT:.2f}: {'; '.join(above) or 'none'}")


def main() -> None:
    """Measure and show."""
    parser = ArgumentParser(description="Processor time of short runs in two checkouts, in turns")
    parser.add_argument("other", type=Path, help="folder of another checkout")
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--only", nargs="+", default=[""], help="parts of scheme and case")
    parser.add_argument("--list", action="store_true", help="print the cases and end")
    given = parser.parse_args()
    from benchmarks.short_runs import CASES

    cases = {f"{case.scheme}, {case.name}": case for case in CASES}
    names = [name for name in cases if any(part in name for part in given.only)]
    if given.list:
        print("\n".join(names))
        return
    if not names:
        parser.error(f"no case has any of {given.only} in its name; --list shows all")
    with checkouts(given.other.resolve(), HERE) as both:
        found = measure(both, names, given.rounds)
    rows = []
    for name, (answers, seconds) in found.items():
        case = cases[name]
        if len(seconds) == 0:
            said = [a.get("error", "runs") for a in answers]
            print(f"{name}: A: {said[0]}; B: {said[1]}")
            continue
        a, b = seconds.min(axis=0)
        iterations = answers[0]["iterations"], answers[1]["iterations"]
        apart = difference([each["end"] for each in answers])
        rows.append(Row(case.scheme, case.name, (a, b), iterations, apart))
    show(rows)


if __name__ == "__main__":
    if sys.argv[1:2] == [ANSWER]:
        answer(sys.argv[2])
    else:
        main()
