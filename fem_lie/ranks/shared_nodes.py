"""Nodes that several ranks have: sums over all ranks, and numbers on which all agree.

Each rank has a part of a scene. Parts meet at nodes of which each has a copy with the same values.
Sums over cells and nodes are partial on each rank. One rank owns a shared node: it adds the parts
of all, by PETSc's star forest, and the others copy its sum, so that copies stay equal to the last
bit. All ranks decide by the same numbers.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from typing import Any

from mpi4py import MPI
from mpi4py.util import dtlib
from petsc4py import PETSc

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Flags, Indices


@cache
def _row_type(of: np.dtype[Any], size: int) -> MPI.Datatype:
    """MPI's type of a row of so many numbers."""
    return dtlib.from_numpy_dtype(of).Create_contiguous(size).Commit()


class SharedNodes:
    """Nodes of a part that other ranks have, too.

    Attributes:
        comm: Communicator of all parts.
        owned: Nodes that count as those of this rank, shape (n,): each node has one owner.
        copied: Nodes that other ranks have, too, shape (n,).
        several: Whether there are several ranks.
    """

    def __init__(self, comm: MPI.Intracomm, count: int, neighbours: Mapping[int, Indices]) -> None:
        """Find the owners; all ranks together.

        Args:
            comm: Communicator of all parts.
            count: Number n of nodes of this part.
            neighbours: Nodes shared with each other rank that has any, in an order that is common
                to both.
        """
        self.comm, self.several = comm, comm.size > 1
        none = np.empty(0, dtype=np.int64)
        numbers = comm.alltoall([neighbours.get(rank, none) for rank in range(comm.size)])
        owner, there = np.full(count, comm.rank), np.arange(count)
        for rank in reversed(range(comm.rank)):  # the lowest one is the owner
            nodes = neighbours.get(rank, none)
            owner[nodes], there[nodes] = rank, numbers[rank]
        self.owned: Flags = owner == comm.rank
        self.copied: Flags = np.zeros(count, dtype=np.bool_)
        for nodes in neighbours.values():
            self.copied[nodes] = True
        copies = np.flatnonzero(~self.owned)
        at_owners = np.column_stack([owner, there])[copies]
        self._forest = PETSc.SF().create(comm)
        given = copies.astype(PETSc.IntType), at_owners.astype(PETSc.IntType)
        self._forest.setGraph(count, *given)

    @classmethod
    def alone(cls, count: int) -> SharedNodes:
        """Those of a scene on one rank: none."""
        return cls(MPI.COMM_SELF, count, {})

    def sum(self, values: Array) -> None:
        """Add the values of all ranks at shared nodes, in place.

        Args:
            values: One row for each node, contiguous, shape (≥ n, …).
        """
        if not self.several:
            return
        row = _row_type(values.dtype, values[0].size)
        self._forest.reduceBegin(row, values, values, MPI.SUM)
        self._forest.reduceEnd(row, values, values, MPI.SUM)
        self.take_from_owners(values)

    def take_from_owners(self, values: npt.NDArray[Any]) -> None:
        """Copy the values of shared nodes from their owners, in place; rows as of :meth:`sum`."""
        if not self.several:
            return
        row = _row_type(values.dtype, values[0].size)
        self._forest.bcastBegin(row, values, values, MPI.REPLACE)
        self._forest.bcastEnd(row, values, values, MPI.REPLACE)

    # --- numbers on which all agree ---

    def largest(self, value: float) -> float:
        """Largest value of all ranks; nan if one is."""
        if not self.several:
            return value
        given = np.array([np.isnan(value), -np.inf if np.isnan(value) else value])
        self.comm.Allreduce(MPI.IN_PLACE, given, op=MPI.MAX)
        return float("nan") if given[0] else float(given[1])

    def total(self, values: Array) -> Array:
        """Sum over all ranks, the same on all; any shape."""
        return np.asarray(self.comm.allreduce(values)) if self.several else values

    def all(self, flag: bool) -> bool:
        """Whether it is so on all ranks."""
        return bool(self.comm.allreduce(flag, op=MPI.LAND)) if self.several else flag

    def any(self, flag: bool) -> bool:
        """Whether it is so on any rank."""
        return bool(self.comm.allreduce(flag, op=MPI.LOR)) if self.several else flag

    @contextmanager
    def errors(self, *kinds: type[Exception]) -> Iterator[None]:
        """Context whose error on one rank is raised on all at its end.

        Args:
            kinds: Classes of errors that are to be expected; the others end all ranks.
        """
        if not self.several:
            yield
            return
        error: Exception | None = None
        try:
            yield
        except kinds as raised:
            error = raised
        # constructors of errors may take more than the message
        given = None if error is None else (type(error), str(error))
        first = next((each for each in self.comm.allgather(given) if each is not None), None)
        if error is not None:
            raise error
        if first is not None:
            kind, message = first
            raise kind.__new__(kind, message)
