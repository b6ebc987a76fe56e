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
from typing import Any, NamedTuple

from mpi4py import MPI
from mpi4py.util import dtlib
from petsc4py import PETSc

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from fem_lie._arrays import Array, Flags, Indices


@cache
def _row_type(of: np.dtype[Any], size: int) -> MPI.Datatype:
    """MPI's type of a row of so many numbers."""
    return dtlib.from_numpy_dtype(of).Create_contiguous(size).Commit()


Extended = npt.NDArray[np.longdouble]


class RanksDifferError(RuntimeError):
    """Ranks ask for different values; raised on those that wait for others."""


class _Asked(NamedTuple):
    """What a rank asks for in a context of errors, and its own contribution."""

    what: str
    value: Any


class SharedNodes:
    """Nodes of a part that other ranks have, too.

    Attributes:
        comm: Communicator of all parts.
        owned: Nodes that count as those of this rank, shape (n,): each node has one owner.
        owns: Number of these.
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
        self.owns = int(self.owned.sum())
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

    def sum(self, values: Array | Extended) -> None:
        """Add the values of all ranks at shared nodes, in place.

        In extended precision parts that cancel leave its round-off, not that of double precision.

        Args:
            values: One row for each node, contiguous, shape (≥ n, …).
        """
        if not self.several:
            return
        if values.dtype == np.longdouble:
            # PETSc adds double precision only
            high = values.astype(np.float64)
            low = (values - high).astype(np.float64)
            self.sum(high)
            self.sum(low)
            np.add(high.astype(np.longdouble), low, out=values)
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

    # --- groups of nodes ---

    def groups(self, label: Indices, count: int) -> tuple[Indices, int]:
        """Groups of connected nodes over all ranks.

        Args:
            label: Group of each node on this rank, shape (n,).
            count: Number of these groups.

        Returns:
            Group of each node among those of all ranks, shape (n,), and their number.
        """
        if not self.several:
            return label, count
        total = self.comm.allreduce(count)
        own = (label + self.comm.scan(count) - count).astype(PETSc.IntType)
        at_owner = own.copy()
        self.take_from_owners(at_owner[:, np.newaxis])
        pairs = np.unique(np.column_stack([own, at_owner])[self.copied], axis=0)
        rows, columns = np.concatenate(self.comm.allgather(pairs)).T
        graph = sp.coo_matrix((np.ones(len(rows)), (rows, columns)), shape=(total, total))
        groups, number = connected_components(graph, directed=False)
        return number[own].astype(np.int64), int(groups)

    def of_all(self, values: Mapping[int, Array]) -> dict[int, list[Array]]:
        """Values of all ranks by their key, those of lower ranks first."""
        given = self.comm.allgather(dict(values)) if self.several else [values]
        found: dict[int, list[Array]] = {}
        for key, value in (pair for each in given for pair in each.items()):
            found.setdefault(key, []).append(value)
        return found

    def columns(self, widths: Mapping[int, int], common: set[int]) -> tuple[dict[int, int], int]:
        """First column of each group of a matrix of all ranks, and its number of columns.

        Args:
            widths: Number of columns of each group on this rank, the same on all ranks.
            common: Groups of this rank that others have, too.
        """
        own = sum(width for group, width in widths.items() if group not in common)
        last = self.comm.scan(own) - own if self.several else 0
        total = self.comm.allreduce(own) if self.several else own
        start: dict[int, int] = {}
        for group, width in widths.items():
            if group not in common:
                start[group], last = last, last + width
        shared = self.of_all({group: np.array(widths[group]) for group in common})
        for group in sorted(shared):
            start[group], total = total, total + int(shared[group][0])
        return start, total

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

    def highest(self, values: Indices) -> Indices:
        """Largest value of all ranks of each entry, any shape."""
        found = values.copy()
        if self.several:
            self.comm.Allreduce(MPI.IN_PLACE, found, op=MPI.MAX)
        return found

    def all(self, flag: bool) -> bool:
        """Whether it is so on all ranks."""
        return bool(self.comm.allreduce(flag, op=MPI.LAND)) if self.several else flag

    def any(self, flag: bool) -> bool:
        """Whether it is so on any rank."""
        return bool(self.comm.allreduce(flag, op=MPI.LOR)) if self.several else flag

    def first(self, value: Any) -> Any:
        """Value of the first rank, which all have computed: they decide alike."""
        return self.comm.bcast(value) if self.several else value

    def exchange(self, what: str, value: Any) -> list[Any]:
        """Values of all ranks, those of lower ranks first, within the context :meth:`errors`.

        For functions of users, which may fail on one rank only: that rank takes part until all have
        left the context.

        Args:
            what: What is asked for, the same on all ranks.
            value: The contribution of this rank.

        Raises:
            RanksDifferError: Another rank has failed, or asks for something else.
        """
        if not self.several:
            return [value]
        found = self.comm.allgather(_Asked(what, value))
        for rank, each in enumerate(found):
            if not isinstance(each, _Asked):
                did = "has nothing to ask" if each is None else f"failed: {each[1]}"
                raise RanksDifferError(f"rank {self.comm.rank} asks for {what}, rank {rank} {did}")
            if each.what != what:
                raise RanksDifferError(
                    f"rank {self.comm.rank} asks for {what}, rank {rank} for {each.what}: expected "
                    "functions that do the same on all ranks"
                )
        return [each.value for each in found]

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
        found = self.comm.allgather(given)
        while any(isinstance(each, _Asked) for each in found):  # others are not here yet
            found = self.comm.allgather(given)
        first = next((each for each in found if each is not None), None)
        if error is not None:
            raise error
        if first is not None:
            kind, message = first
            raise kind.__new__(kind, message)
