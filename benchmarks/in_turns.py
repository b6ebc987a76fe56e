"""Time per step of the double pendulum and of trusses in two checkouts, measured in turns.

    python3 benchmarks/in_turns.py OTHER [scheme ...] [--cases 1 2 3 truss2 truss8]

OTHER is the folder of another checkout, such as ``git worktree add OTHER COMMIT``; schemes are
``alpha``, ``conserving`` and ``decaying``, by default all; cases are those of the double pendulum,
and thin trusses of two and of eight cells with the feet of all longerons driven. Each checkout has
a process, and they run one after the other, again and again. What other work on the machine adds is
in no step for long: the least mean of 20 steps in a row, or of those between two matrices, is that
of steps without a new matrix; the mean over whole runs has matrices, too. Of pendulums all states
are kept, of trusses one in 20.
"""

from __future__ import annotations

import os
import subprocess
import sys
from argparse import ArgumentParser
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from time import perf_counter

import numpy as np

ROUNDS, IN_A_ROW = 5, 20
STEPS = {"1": 1000, "2": 1000, "3": 1000, "truss2": 600, "truss8": 200}
ANSWER = "--answer"
SCHEMES = {
    "alpha": "GeneralisedAlpha(radius=0.8)",
    "conserving": "EnergyMomentum()",
    "decaying": "EnergyDecaying()",
}


def measure() -> None:
    """Answer requests, a case and a scheme, with microseconds, iterations and matrices."""
    sys.path.insert(0, os.getcwd())
    import fem_lie as fl

    solve = "fem_lie.solve."
    # before there were rooms, files had other names
    rooms = Path("fem_lie/solve/alpha").is_dir()
    names = ("alpha.run", "conserving.run") if rooms else ("alpha_run", "conserving_run")
    stamps: list[tuple[float, int]] = []
    for kind in (import_module(solve + name).Run for name in names):
        for name in ("_advance", "_factorise", "_refresh"):
            if hasattr(kind, name):
                setattr(kind, name, _stamped(getattr(kind, name), stamps))
    for line in sys.stdin:
        case, scheme = line.split()
        stamps.clear()
        run, count = eval(SCHEMES[scheme], vars(fl)).run, STEPS[case]
        built, h, every = scene(case)
        result = run(built, step=h, duration=count * h, save_every=every, progress=False)
        times, steps = np.array(stamps).T
        # loops that make many steps come back after as many
        later = np.minimum(np.searchsorted(steps, steps + IN_A_ROW), len(steps) - 1)
        made = steps[later] - steps
        long = made >= IN_A_ROW
        least = 1e6 * ((times[later] - times)[long] / made[long]).min()
        each = result.iterations[-1] / count
        print("=", least, 1e6 * result.seconds / count, each, result.factorisations, flush=True)


def scene(case):  # type: ignore[no-untyped-def]
    """A scene, its step, and which of its states are kept, with what this checkout has."""
    import fem_lie as fl
    from demos import double_pendulum, truss_deployment

    if case in "123":
        return double_pendulum.pendulum(int(case))[0], double_pendulum.STEP[int(case)], 1
    inner, outer = (0.5 * diameter for diameter in truss_deployment.DIAMETERS["thin"])
    section = fl.Section.tube(inner, outer, truss_deployment.STEEL)
    cells = int(case.removeprefix("truss"))
    return truss_deployment.Truss(cells, section, 10, 4, fl.Choices()).scene, 2e-3, 20


def _stamped(function, stamps):  # type: ignore[no-untyped-def]
    def stamped(run, *arguments):  # type: ignore[no-untyped-def]
        stamps.append((perf_counter(), run.index))
        result = function(run, *arguments)
        stamps.append((perf_counter(), run.index))
        return result

    return stamped


def answers(process: subprocess.Popen[str], request: str) -> Iterator[float]:
    """The numbers that a process answers to a request."""
    assert process.stdin is not None and process.stdout is not None
    process.stdin.write(f"{request}\n")
    process.stdin.flush()
    for line in process.stdout:
        if line.startswith("= "):
            return map(float, line.split()[1:])
    raise SystemExit("a process has ended")


def main(other: str, schemes: list[str], cases: list[str]) -> None:
    here = Path(__file__).parents[1]
    processes = [
        subprocess.Popen(
            [sys.executable, __file__, ANSWER],
            cwd=folder,
            env={**os.environ, "OMP_NUM_THREADS": "1", "PYTHONPATH": str(folder)},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        for folder in (Path(other).resolve(), here)
    ]
    print("scheme      case  µs without a new matrix  ratio    µs with all  ratio  iterations")
    for scheme in schemes:
        for case in cases:
            rounds = [[[*answers(p, f"{case} {scheme}")] for p in processes] for _ in range(ROUNDS)]
            (a, b) = np.min(rounds, axis=0)
            print(
                f"{scheme:10} {case:>6} {a[0]:11.1f} {b[0]:11.1f} {b[0] / a[0]:6.2f}"
                f"  {a[1]:7.1f} {b[1]:7.1f} {b[1] / a[1]:5.2f}  {a[2]:.2f} {b[2]:.2f}"
                f"  matrices {a[3]:.0f} {b[3]:.0f}",
                flush=True,
            )
    for process in processes:
        process.terminate()


if __name__ == "__main__":
    if sys.argv[1:] == [ANSWER]:
        measure()
    else:
        parser = ArgumentParser(description="Time per step in two checkouts, in turns")
        parser.add_argument("other", help="folder of another checkout")
        parser.add_argument("schemes", nargs="*", default=list(SCHEMES), help=", ".join(SCHEMES))
        parser.add_argument("--cases", nargs="+", choices=STEPS, default=["1", "2", "3"])
        given = parser.parse_args()
        main(given.other, given.schemes, given.cases)
