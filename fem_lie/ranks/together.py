"""MPI ranks that do the same work: checks at synchronisation points, and a common termination."""

from __future__ import annotations

import atexit
import logging
import os
import sys
import time
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from importlib import import_module
from types import TracebackType

from mpi4py import MPI

import numpy as np

from fem_lie._arrays import Array

SAME = 1e-8
"""Largest relative difference of the same numbers on two ranks, as round-off grows."""

PATIENCE = 1.0
"""Seconds that other ranks wait so that the first one can report an error of all."""


HANGS_FROM, HANGS_UNTIL = (5, 0, 0), (5, 0, 11)
"""Versions of Open MPI whose ranks may wait for ever: open-mpi/ompi issue 12979.

If its shared memory has no free fragment, the acknowledgement of a large message is not sent again.
"""

FRAGMENTS = "OMPI_MCA_btl_sm_free_list_max"
"""Environment variable with the number of those fragments, -1 for any."""


class RanksError(RuntimeError):
    """Ranks do different work; raised on all of them."""


def several() -> bool:
    """Whether the script runs on more than one rank."""
    return int(MPI.COMM_WORLD.size) > 1


def first() -> bool:
    """Whether this is the first rank, which writes."""
    return int(MPI.COMM_WORLD.rank) == 0


def meet(place: str, numbers: Array | None = None) -> None:
    """Wait for all ranks, and check that they are at the same point with the same numbers.

    Args:
        place: Description of the point, for the message.
        numbers: Numbers that must be equal on all ranks up to round-off; always of one size.

    Raises:
        RanksError: They differ.
    """
    world = MPI.COMM_WORLD
    size = 0.0 if numbers is None else float(np.abs(numbers).sum())
    gathered = world.allgather((place, size))
    if len({name for name, _ in gathered}) > 1:
        where = ", ".join(f"rank {k} at {name}" for k, (name, _) in enumerate(gathered))
        raise RanksError(f"all ranks must do the same work, but they differ: {where}")
    sizes = np.array([number for _, number in gathered])
    if np.ptp(sizes) > SAME * sizes.max():
        raise RanksError(
            f"all ranks must do the same work, but at {place} their numbers differ: sums of sizes "
            f"{', '.join(f'{s:.9e}' for s in sizes)}; does the scene depend on the rank, or on "
            "random numbers without a seed?"
        )


ARRIVAL = 10.0
"""Seconds that a rank with an error waits for others, which may wait for it elsewhere."""


def all_arrive(comm: MPI.Intracomm) -> bool:
    """Whether all ranks come here, soon; without an answer from a rank that waits elsewhere."""
    request, until = comm.Ibarrier(), time.monotonic() + ARRIVAL
    while not request.Test():
        if time.monotonic() > until:
            return False
        time.sleep(1e-3)
    return True


def from_first(work: str, error: OSError | None) -> None:
    """Raise an error of the first rank on all ranks.

    Args:
        work: Description of the work, for the synchronisation point.
        error: Error of the first rank; ``None`` on others.

    Raises:
        OSError: That of the first rank.
    """
    meet(work)
    raised = MPI.COMM_WORLD.bcast(error)
    if raised is not None:
        raise raised


@cache
def end_together() -> None:
    """Terminate all ranks, with one message, if one of them raises an error.

    The first scene calls it, so that the import has no side effect. From then on an uncaught error
    on one rank terminates all. A rank at the end of its script waits for the others there, and
    reports an error if they wait elsewhere.
    """
    if several():
        # what is registered last is called first at exit: these two wait there for all ranks, too,
        # but do not say why
        for library in "petsc4py.PETSc", "slepc4py.SLEPc":
            import_module(library)
        sys.excepthook = _end_all
        atexit.register(_at_end)
        check_library()


def check_library() -> None:
    """Warn of an MPI library whose ranks may wait for each other for ever."""
    name, version = MPI.get_vendor()
    hangs = name == "Open MPI" and HANGS_FROM <= version < HANGS_UNTIL
    if hangs and FRAGMENTS not in os.environ and first():
        logging.getLogger(__name__).warning(
            "ranks of Open MPI %s may wait for each other for ever when large matrices are "
            "factorised; export %s=-1 before mpirun",
            ".".join(map(str, version)),
            FRAGMENTS,
        )


def _end_all(kind: type[BaseException], error: BaseException, at: TracebackType | None) -> None:
    """Print the error once, and terminate all ranks."""
    world = MPI.COMM_WORLD
    if world.rank:
        # the first rank reports an error of all, and then ends this one
        time.sleep(PATIENCE)
    text = "".join(traceback.format_exception(kind, error, at))
    print(f"rank {world.rank} of {world.size} ends all:\n{text}", file=sys.stderr, flush=True)
    world.Abort(1)


@cache
def _ending() -> MPI.Intracomm:
    """Communicator of the end of scripts only, which no reduction of a solver uses."""
    return MPI.COMM_WORLD.Dup()


_left: list[str] = []
"""What this rank did with others when its script ended by ``SystemExit``, the whole work last."""


_divisions = 0
"""Number of times that all ranks have met to divide a scene."""


def meet_to_divide() -> None:
    """Wait for all ranks before a scene is divided, from when on they work together.

    Raises:
        RanksError: Another rank does something else, such as ending its script.
    """
    global _divisions
    meet("the division of a scene")
    _ending()
    _divisions += 1


@contextmanager
def all_stay(work: str) -> Iterator[None]:
    """Work in which a scene may be divided; then a rank whose script ends amid it is an error.

    If all ranks end there, that is no error.

    Args:
        work: Description of the work, for the message.
    """
    before = _divisions
    try:
        yield
    except SystemExit:
        if _divisions > before:
            _left.append(work)
        raise


def _at_end() -> None:
    """Last synchronisation point."""
    world = MPI.COMM_WORLD
    if _left:
        # others may be in a reduction of the solver, with which no collective may mix
        if not all_arrive(_ending()):
            print(
                f"RanksError: all ranks must do the same work, but rank {world.rank} of "
                f"{world.size} is at the end of the script, which it left in {_left[-1]}; expected "
                "that all ranks end it, or none",
                file=sys.stderr,
                flush=True,
            )
            world.Abort(1)
        return
    try:
        meet("the end of the script")
    except RanksError as error:
        if first():
            print(f"{type(error).__name__}: {error}", file=sys.stderr, flush=True)
        else:
            time.sleep(PATIENCE)
        os._exit(1)
