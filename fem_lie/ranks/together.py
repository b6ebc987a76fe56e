"""Ranks that do the same: where they meet they make sure of it, and they end together."""

from __future__ import annotations

import atexit
import os
import sys
import time
import traceback
from functools import cache
from types import TracebackType

from mpi4py import MPI

import numpy as np

from fem_lie._arrays import Array

SAME = 1e-8
"""How far apart, relatively, the same numbers of two ranks may be: round-off grows."""

PATIENCE = 1.0
"""Seconds that ranks leave to the first one to tell of an error that all have."""


class RanksError(RuntimeError):
    """Ranks do not do the same; raised on all of them."""


def several() -> bool:
    """Whether the script runs on more than one rank."""
    return int(MPI.COMM_WORLD.size) > 1


def first() -> bool:
    """Whether this is the rank that writes."""
    return int(MPI.COMM_WORLD.rank) == 0


def meet(place: str, numbers: Array | None = None) -> None:
    """Wait for all ranks, and make sure that they are at the same place with the same numbers.

    Args:
        place: Where this rank is, for the message.
        numbers: What has to be the same on all but for round-off; it must have one size.

    Raises:
        RanksError: They are not.
    """
    world = MPI.COMM_WORLD
    size = 0.0 if numbers is None else float(np.abs(numbers).sum())
    told = world.allgather((place, size))
    if len({name for name, _ in told}) > 1:
        where = ", ".join(f"rank {k} at {name}" for k, (name, _) in enumerate(told))
        raise RanksError(f"all ranks have to do the same, but they are apart: {where}")
    sizes = np.array([number for _, number in told])
    if np.ptp(sizes) > SAME * sizes.max():
        raise RanksError(
            f"all ranks have to do the same, but at {place} their numbers differ: sums of sizes "
            f"{', '.join(f'{s:.9e}' for s in sizes)}; does the scene depend on the rank, or on "
            "random numbers without a seed?"
        )


def from_first(work: str, error: OSError | None) -> None:
    """Raise on all ranks what went wrong on the first, of which the others know nothing.

    Args:
        work: What was done, for the place where ranks meet.
        error: Of the first rank; others give ``None``.

    Raises:
        OSError: That of the first rank.
    """
    meet(work)
    told = MPI.COMM_WORLD.bcast(error)
    if told is not None:
        raise told


@cache
def end_together() -> None:
    """See to it that an error on one rank is the end of all, with one message.

    The package calls it when it is imported: a rank that fails before its first scene would wait
    for ever for the others at the end. From then on what a rank does not catch ends all of them. A
    rank that comes to the end of its script waits for the others there, and is told if they wait
    for it elsewhere.
    """
    if several():
        sys.excepthook = _end_all
        atexit.register(_at_end)


def _end_all(kind: type[BaseException], error: BaseException, at: TracebackType | None) -> None:
    """Tell once, and end all ranks."""
    world = MPI.COMM_WORLD
    if world.rank:
        time.sleep(PATIENCE)  # what all have the first one tells, and then this one is gone
    text = "".join(traceback.format_exception(kind, error, at))
    print(f"rank {world.rank} of {world.size} ends all:\n{text}", file=sys.stderr, flush=True)
    world.Abort(1)


def _at_end() -> None:
    """The last place where ranks meet."""
    try:
        meet("the end of the script")
    except RanksError as error:
        if first():
            print(f"{type(error).__name__}: {error}", file=sys.stderr, flush=True)
        else:
            time.sleep(PATIENCE)
        os._exit(1)
