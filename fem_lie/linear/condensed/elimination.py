"""Order in which nodes of a matrix are eliminated, and the neighbours onto which they are."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Flags, Indices
from fem_lie._jit import compiled, inlined
from fem_lie.ranks.shared_nodes import SharedNodes

MOST = 4
"""Largest number of neighbours of an eliminated node: two on either side, as in a rod."""

_KNOWN = 8
"""Largest number of neighbours of a node before others are eliminated."""

Numbers = npt.NDArray[np.int32]


class ConstraintNodes(Protocol):
    """Nodes of the incidences of constraints."""

    @property
    def nodes(self) -> Indices:
        """Node of each incidence."""


class Pattern(Protocol):
    """Attributes of the matrix that are used, see :class:`~fem_lie.linear.saddle_point.KKT`."""

    indptr: Indices
    indices: Indices
    unit_rows: Flags
    filled: int
    shared: SharedNodes

    @property
    def incidences(self) -> ConstraintNodes:
        """Incidences of the constraints."""


class Plan(NamedTuple):
    """Order of elimination, neighbours, and positions of blocks.

    Attributes:
        order: Eliminated nodes, shape (e,).
        position: Position of each node in that order, −1 if it remains, shape (n,).
        near: Neighbours of a node when it is eliminated, −1 where there is none, shape (e, MOST).
        first: First unknown of each neighbour among all of these, and their number, shape (e, MOST
            + 1).
        start: Start of the blocks of a node: its own, ``U``, ``L``; shape (e + 1,).
        sizes: Number of free unknowns of each node, shape (n,).
        rank: Number of an unknown among the free ones of its node, shape (6 n,).
        free: Unknown of a node by this number, shape (n, 6).
    """

    order: Numbers
    position: Numbers
    near: Numbers
    first: Numbers
    start: Indices
    sizes: Numbers
    rank: Numbers
    free: Numbers


class Left(NamedTuple):
    """Pairs of remaining nodes between which elimination makes blocks.

    Attributes:
        pointers: Row pointers of the pattern, shape (n + 1,).
        indices: Nodes.
        start: Start of each block, and the total at the end.
    """

    pointers: Indices
    indices: Indices
    start: Indices


@compiled
def eliminate(pointers: Indices, indices: Indices, may: Flags) -> tuple[Numbers, Numbers, Numbers]:
    """Nodes that can be eliminated onto few others: order, position of each, neighbours.

    Args:
        pointers: Row pointers of the pattern of nodes.
        indices: Column indices of the pattern.
        may: Whether a node may be eliminated, shape (n,).
    """
    n = may.shape[0]
    near, count = np.full((n, _KNOWN), -1, np.int32), np.zeros(n, np.int32)
    position, order, done = np.full(n, -1, np.int32), np.empty(n, np.int32), 0
    eligible, before = may.copy(), -1
    for v in range(n):
        if pointers[v + 1] - pointers[v] - 1 > _KNOWN:
            eligible[v] = False
        if eligible[v]:
            for p in range(pointers[v], pointers[v + 1]):
                if indices[p] != v:
                    near[v, count[v]] = indices[p]
                    count[v] += 1
    # a node with too many neighbours may have fewer after their elimination
    while done > before:
        before = done
        for v in range(n):
            if not eligible[v] or count[v] > MOST:
                continue
            for s in range(count[v]):
                i = near[v, s]
                if eligible[i]:
                    eligible[i] = _meet(near, count, i, v)
            position[v], order[done] = done, v
            done += 1
            eligible[v] = False
    return order[:done], position, near[order[:done], :MOST].copy()


@inlined
def _meet(near: Numbers, count: Numbers, i: int, v: int) -> bool:
    """Add the neighbours of ``v`` to those of ``i``, without ``v``; whether there is space."""
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
    """Plan of the elimination of nodes without constraints that have few neighbours.

    Nodes that several ranks have remain, as each rank has only a part of their rows.
    """
    held = kkt.unit_rows[: 6 * (len(kkt.indptr) - 1)].reshape(-1, 6)
    may = np.asarray(~held.all(axis=1))
    may[kkt.incidences.nodes] = False
    may[: len(kkt.shared.copied)] &= ~kkt.shared.copied
    order, position, near = eliminate(kkt.indptr, kkt.indices, may)
    sizes = (~held).sum(axis=1).astype(np.int32)
    widths = np.where(near >= 0, sizes[near], 0)
    first = np.zeros((len(order), MOST + 1), dtype=np.int32)
    np.cumsum(widths, axis=1, out=first[:, 1:])
    own = sizes[order].astype(np.int64)
    start = np.append(0, np.cumsum(own * own + 2 * own * first[:, MOST]))
    rank = np.where(held, -1, np.cumsum(~held, axis=1) - 1).astype(np.int32).ravel()
    free = np.argsort(held, axis=1, kind="stable").astype(np.int32)
    return Plan(order, position, near, first, start, sizes, rank, free)


def pairs_left(plan: Plan) -> Left:
    """Pairs of remaining nodes that were neighbours of an eliminated node."""
    n = len(plan.sizes)
    stays = (plan.near >= 0) & (plan.position[plan.near] < 0)
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
