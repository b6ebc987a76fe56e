"""Which nodes of a matrix are eliminated one by one, in which order, and onto which others."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Flags, Indices
from fem_lie._jit import compiled, inlined

MOST = 4
"""Neighbours of a node that is eliminated: two on either side, as in a thread that bends."""

_KNOWN = 8
"""Neighbours that a node may have in between, of which others are eliminated before it."""

Numbers = npt.NDArray[np.int32]


class ConstraintNodes(Protocol):
    """Nodes that constraints touch."""

    @property
    def nodes(self) -> Indices:
        """Of each leg."""


class Pattern(Protocol):
    """What is asked of a matrix, see :class:`~fem_lie.linear.saddle_point.KKT`."""

    indptr: Indices
    indices: Indices
    unit_rows: Flags
    filled: int

    @property
    def incidences(self) -> ConstraintNodes:
        """Of the constraints."""


class Plan(NamedTuple):
    """In which order nodes are eliminated, onto which, and where their blocks are.

    Attributes:
        order: Nodes that are eliminated, shape (e,).
        place: Of each node in that order, −1 if it is left, shape (n,).
        near: Its neighbours at that time, −1 where there is none more, shape (e, MOST).
        first: Where their unknowns begin among all of these, and how many, shape (e, MOST + 1).
        start: Where the blocks of a node begin: its own, ``U``, ``L``; shape (e + 1,).
        sizes: Free unknowns of each node, shape (n,).
        rank: Number of an unknown among those of its node, shape (6 n,).
        free: Unknown of a node by this number, shape (n, 6).
    """

    order: Numbers
    place: Numbers
    near: Numbers
    first: Numbers
    start: Indices
    sizes: Numbers
    rank: Numbers
    free: Numbers


class Left(NamedTuple):
    """Pairs of nodes that are left, between which elimination makes blocks.

    Attributes:
        pointers: Rows of the pattern, shape (n + 1,).
        indices: Nodes.
        start: Where each block begins, one more at the end.
    """

    pointers: Indices
    indices: Indices
    start: Indices


@compiled
def eliminate(pointers: Indices, indices: Indices, may: Flags) -> tuple[Numbers, Numbers, Numbers]:
    """Which nodes can be eliminated onto few others: order, place of each in it, neighbours.

    Args:
        pointers: Rows of the pattern of nodes; ``indices`` are its columns.
        indices: See there.
        may: Which of them may be, shape (n,).
    """
    n = may.shape[0]
    near, count = np.full((n, _KNOWN), -1, np.int32), np.zeros(n, np.int32)
    place, order, done = np.full(n, -1, np.int32), np.empty(n, np.int32), 0
    open_, before = may.copy(), -1
    for v in range(n):
        if pointers[v + 1] - pointers[v] - 1 > _KNOWN:
            open_[v] = False
        if open_[v]:
            for p in range(pointers[v], pointers[v + 1]):
                if indices[p] != v:
                    near[v, count[v]] = indices[p]
                    count[v] += 1
    # who has too many neighbours at first may have fewer when these are gone
    while done > before:
        before = done
        for v in range(n):
            if not open_[v] or count[v] > MOST:
                continue
            for s in range(count[v]):
                i = near[v, s]
                if open_[i]:
                    open_[i] = _meet(near, count, i, v)
            place[v], order[done] = done, v
            done += 1
            open_[v] = False
    return order[:done], place, near[order[:done], :MOST].copy()


@inlined
def _meet(near: Numbers, count: Numbers, i: int, v: int) -> bool:
    """Make the neighbours of ``v`` those of ``i``, without ``v``; returns whether that could be."""
    kept = 0
    for s in range(count[i]):
        if near[i, s] != v:
            near[i, kept] = near[i, s]
            kept += 1
    for s in range(count[v]):
        j = near[v, s]
        known = j == i
        for t in range(kept):
            known |= near[i, t] == j
        if not known:
            if kept == _KNOWN:
                return False
            near[i, kept] = j
            kept += 1
    for s in range(kept, _KNOWN):
        near[i, s] = -1
    count[i] = kept
    return True


def plan_of(kkt: Pattern) -> Plan:
    """What can be eliminated of a matrix: nodes without constraints that have few neighbours."""
    held = kkt.unit_rows[: 6 * (len(kkt.indptr) - 1)].reshape(-1, 6)
    may = np.asarray(~held.all(axis=1))
    may[kkt.incidences.nodes] = False
    order, place, near = eliminate(kkt.indptr, kkt.indices, may)
    sizes = (~held).sum(axis=1).astype(np.int32)
    widths = np.where(near >= 0, sizes[near], 0)
    first = np.zeros((len(order), MOST + 1), dtype=np.int32)
    np.cumsum(widths, axis=1, out=first[:, 1:])
    own = sizes[order].astype(np.int64)
    start = np.append(0, np.cumsum(own * own + 2 * own * first[:, MOST]))
    rank = np.where(held, -1, np.cumsum(~held, axis=1) - 1).astype(np.int32).ravel()
    free = np.argsort(held, axis=1, kind="stable").astype(np.int32)
    return Plan(order, place, near, first, start, sizes, rank, free)


def pairs_left(plan: Plan) -> Left:
    """Pairs of nodes that are left and were neighbours of one that is eliminated."""
    n = len(plan.sizes)
    stays = (plan.near >= 0) & (plan.place[plan.near] < 0)
    left = np.where(stays, plan.near, -1).astype(np.int64)
    found = [np.empty(0, np.int64)]
    for a in left.T:
        for b in left.T:
            both = (a >= 0) & (b >= 0)
            found.append(np.unique(a[both] * n + b[both]))
    i, j = np.divmod(np.unique(np.concatenate(found)), n)
    pointers = np.searchsorted(i, np.arange(n + 1))
    start = np.append(0, np.cumsum(plan.sizes[i].astype(np.int64) * plan.sizes[j]))
    return Left(pointers, j, start)
