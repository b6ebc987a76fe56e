"""The bent plate: beside Kratos, and beside an earlier commit of this repository."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from benchmarks.everyday_rows.row import Outcome, Row, Unavailable, in_turns
from benchmarks.peer_scenes import environment
from benchmarks.peer_scenes.comparisons import COMPARISONS, Method, Request
from benchmarks.peer_scenes.processes import Asked

ROOT = Path(__file__).parents[2]
SCRIPT = Path(__file__).with_name("plate.py")
EARLIER = "4d78d80"
"""Before OpenBLAS, and before the solver was chosen by the matrix."""
CELLS = 50
LIMIT = 3600.0  # seconds for one answer
SMALL = 8  # cells per side of the plate that lets both compile and find their settings
AGREED = 0.01  # of the displacement
OVER_OURS, OVER_EARLIER = 40.0, 0.35  # targets


def beside_kratos() -> Outcome:
    """Processor seconds of both solvers, without imports, set-up and compilation."""
    python = environment.interpreters("kratos").get("kratos")
    if python is None:
        raise Unavailable("Kratos cannot be installed here by pip")
    comparison = COMPARISONS["plate"]
    programs = {
        code: Asked(code, path, LIMIT)
        for code, path in (("ours", Path(sys.executable)), ("kratos", python))
    }
    answers: dict[Method, Request] = {}

    def seconds(method: Method, cells: int) -> float:
        answer = programs[method.code].ask(comparison.request(method, cells))
        if "failed" in answer:
            raise RuntimeError(f"{method.label}, {cells}² cells: {answer['failed']}")
        answers[method] = answer
        return float(answer["seconds"])

    try:
        for method in comparison.methods:
            seconds(method, SMALL)
        times = in_turns(*(partial(seconds, method, CELLS) for method in comparison.methods))
    finally:
        for program in programs.values():
            program.stop()
    moved = [np.array(answers[method]["place"]) for method in comparison.methods]
    agree = np.linalg.norm(moved[1] - moved[0]) <= AGREED * np.linalg.norm(moved[0])
    ratio = times[1] / times[0]
    ours, theirs = (f"{s:.3g} s, tip {u[2]:.4f} m" for s, u in zip(times, moved, strict=True))
    steps = answers[comparison.methods[1]]["settings"]
    return Outcome(
        ours, f"Kratos, {steps}, {theirs}: {ratio:.0f} times", bool(agree and ratio >= OVER_OURS)
    )


@contextmanager
def checkout(commit: str) -> Iterator[Path]:
    """A clone of this repository at a commit, in a temporary folder."""
    with TemporaryDirectory() as folder:
        succeed(["git", "clone", "--quiet", "--no-checkout", ROOT, folder])
        succeed(["git", "-C", folder, "checkout", "--quiet", "--detach", commit])
        yield Path(folder)


def succeed(command: Sequence[str | Path], variables: Mapping[str, str] = os.environ) -> None:
    """Run a command without which there is nothing to compare with.

    Raises:
        Unavailable: It fails, or there is no such program.
    """
    try:
        subprocess.run(command, env=variables, check=True, capture_output=True, text=True)
    except subprocess.CalledProcessError as error:
        text = " ".join(error.stderr.split())
        raise Unavailable(f"{' '.join(map(str, command))}: {text}") from error
    except OSError as error:
        raise Unavailable(str(error)) from error


def outside() -> dict[str, str]:
    """Variables with which ``tools/run`` of another checkout enters that one's own environment."""
    variables = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "FEM_LIE_INSIDE")}
    return variables | ({"FEM_LIE_WAY": "root"} if "FEM_LIE_INSIDE" in os.environ else {})


def printed_seconds(command: Sequence[str | Path], variables: Mapping[str, str]) -> float:
    """What a program prints last.

    Raises:
        RuntimeError: It fails; with what it wrote.
    """
    done = subprocess.run(
        command, cwd=ROOT, env=variables, capture_output=True, text=True, check=False
    )
    if done.returncode:
        raise RuntimeError(f"{command} ended with {done.returncode}:\n{done.stderr}")
    return float(done.stdout.split()[-1])


def beside_earlier() -> Outcome:
    """Processor seconds of all of ``statics``, each commit in the environment of its own.

    The earlier one's environment is set up first, if it is not there: some minutes, and downloads.
    """
    with checkout(EARLIER) as folder:
        run = folder / "tools" / "run"
        succeed([run, "true"], outside())
        here = {**os.environ, "PYTHONPATH": str(ROOT)}
        now, before = in_turns(
            partial(printed_seconds, [sys.executable, SCRIPT], here),
            partial(printed_seconds, [run, "python3", SCRIPT], outside()),
        )
    ratio = now / before
    return Outcome(f"{now:.2f} s", f"{EARLIER}, {before:.2f} s: {ratio:.2f}", ratio <= OVER_EARLIER)


ROWS = (
    Row(f"plate of {CELLS}² cells, statics", f"Kratos ≥ {OVER_OURS:.0f} times", beside_kratos),
    Row(f"plate of 100² cells, statics over {EARLIER}", f"≤ {OVER_EARLIER} times", beside_earlier),
)
