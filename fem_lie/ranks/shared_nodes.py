"""Nodes that several ranks have: sums over all ranks, and numbers on which all agree.

Each rank has a part of a scene. Parts meet at nodes of which each has a copy with the same values.
Sums over cells and nodes are partial on each rank. All ranks add the parts of a shared node in the
same order, so that its copies stay equal to the last bit, and decide by the same numbers.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from mpi4py import MPI

import numpy as np

from fem_lie._arrays import Array, Flags, Indices


class SharedNodes:
    """Nodes of a part that other ranks have, too.

    Attributes:
        comm: Communicator of all parts.
        owned: Nodes that count as those of this rank, shape (n,): each node has one owner.
        several: Whether there are several ranks.
    """

    def __init__(self, comm: MPI.Intracomm, count: int, neighbours: Mapping[int, Indices]) -> None:
        """Prepare the exchange.

        Args:
            comm: Communicator of all parts.
            count: Number n of nodes of this part.
            neighbours: Nodes shared with each other rank that has any, in an order that is common
                to both.
        """
        self.comm, self.several = comm, comm.size > 1
        self._neighbours = dict(sorted(neighbours.items()))
        self.owned: Flags = np.ones(count, dtype=bool)
        for rank, nodes in self._neighbours.items():
            if rank < comm.rank:
                self.owned[nodes] = False
        self._shared = np.unique(
            np.concatenate([np.empty(0, np.int64), *self._neighbours.values()])
        )

    @classmethod
    def alone(cls, count: int) -> SharedNodes:
        """Those of a scene on one rank: none."""
        return cls(MPI.COMM_SELF, count, {})

    def sum(self, values: Array) -> None:
        """Add the values of all ranks at shared nodes, in place.

        Args:
            values: One row for each node, shape (≥ n, …).
        """
        if not self.several:
            return
        own = values[self._shared]
        received = {rank: np.empty_like(values[at]) for rank, at in self._neighbours.items()}
        requests = [self.comm.Irecv(found, rank) for rank, found in received.items()]
        given = [np.ascontiguousarray(values[at]) for at in self._neighbours.values()]
        requests += [
            self.comm.Isend(part, rank) for rank, part in zip(self._neighbours, given, strict=True)
        ]
        MPI.Request.Waitall(requests)
        values[self._shared] = 0.0
        for rank in sorted([*received, self.comm.rank]):
            if rank == self.comm.rank:
                values[self._shared] += own
            else:
                values[self._neighbours[rank]] += received[rank]

    def take_from_owners(self, values: Array) -> None:
        """Copy the values of shared nodes from their owners, in place; shape (≥ n, …)."""
        values[: len(self.owned)][~self.owned] = 0.0
        self.sum(values)

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
        error: Any = None
        try:
            yield
        except kinds as raised:
            error = raised
        first = next((each for each in self.comm.allgather(error) if each is not None), None)
        if first is not None:
            raise error or first
