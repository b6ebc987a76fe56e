"""What a row is, and how its times are measured."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

ROUNDS = 3


class Unavailable(Exception):
    """What a row is compared with cannot be had on this machine; says why."""


@dataclass(frozen=True)
class Outcome:
    """What was measured.

    Attributes:
        ours: Our figure with its unit.
        peer: What it is compared with, and its figure; empty where the target is absolute.
        met: Whether the target is met.
    """

    ours: str
    peer: str
    met: bool


@dataclass(frozen=True)
class Row:
    """One row of the table.

    Attributes:
        title: Scene and size, and what is measured of it.
        target: In words, with its unit.
        measure: Measures it; raises :class:`Unavailable` where nothing is there to compare with.
    """

    title: str
    target: str
    measure: Callable[[], Outcome]


def in_turns(*functions: Callable[[], float], rounds: int = ROUNDS) -> list[float]:
    """The least of several measurements of each function, which are called in turns.

    Each function returns its own seconds, so that preparations need not count.
    """
    measured = [[function() for function in functions] for _ in range(rounds)]
    return [min(times) for times in zip(*measured, strict=True)]


def processor_seconds(
    command: Sequence[str | Path], folder: Path, environment: Mapping[str, str]
) -> float:
    """Processor time of a process and all its children, in seconds.

    Args:
        command: Program and arguments.
        folder: Where it runs.
        environment: Variables that differ from those of this process.

    Raises:
        RuntimeError: It fails; with what it wrote.
    """
    process = subprocess.Popen(
        [*map(str, command)],
        cwd=folder,
        env={**os.environ, **environment},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    assert process.stdout is not None
    written = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise RuntimeError(f"{command} ended with {process.returncode}:\n{written}")
    return usage.ru_utime + usage.ru_stime
