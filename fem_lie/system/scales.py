"""By what constraints are scaled in the matrix, and what their scaled multipliers move."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled, inlined
from fem_lie.linear.bordered import Border, flexibility

_ALIKE = 30.0  # largest over smallest of constraints that are one vector and scaled as one


class Vectors:
    """Which constraints are one vector.

    Attributes:
        first: First constraint of each vector, shape (k,).
        own: Vector of each constraint, shape (m,).
        others: Constraints of the vector of each, (m, w); beyond its end any, see :attr:`there`.
        there: Which of these are of the vector, (m, w).
    """

    def __init__(self, joined: Flags) -> None:
        """From which constraints go on from the one before, shape (m,)."""
        count = len(joined)
        self.first: Indices = np.flatnonzero(~joined)
        self.own: Indices = np.cumsum(~joined) - 1
        sizes = np.diff(self.first, append=count)
        place = np.arange(int(sizes.max(initial=1)))
        self.there = place < sizes[self.own, np.newaxis]
        reached = self.first[self.own, np.newaxis] + place
        self.others: Indices = np.where(self.there, reached, 0)

    def scales(
        self,
        border: Border,
        rows: Array,
        diagonal: Array,
        units: Array,
        spread: Array | None = None,
    ) -> Array:
        """``1/(B diag(S)⁻¹ Bᵀ)`` of constraints, shape (m,).

        Those that are one vector have the mean, which does not depend on their axes, unless they
        differ much: one scale would leave the matrix as badly conditioned as they differ.

        Args:
            border: Legs of the constraints.
            rows: ``B``, six of each leg, zero along what is held.
            diagonal: Of ``S``, shape (n, 6).
            units: Unit of each unknown, zero of those that are held, shape (n, 6).
            spread: By how much constraints of :attr:`others` change each with forces of the size
                of their scale, (m, w), overwritten.
        """
        soft = flexibility(diagonal, units)
        moved = np.zeros(self.there.shape)
        _move(border.ptr, border.nodes, rows, soft, self.others, self.there, moved)
        own = self.there & (self.others == np.arange(len(self.own))[:, np.newaxis])
        total = moved[own]
        if len(self.own):
            low, high = (each.reduceat(total, self.first) for each in (np.minimum, np.maximum))
            mean = np.bincount(self.own, total) / np.bincount(self.own)
            total = np.where((high <= _ALIKE * low)[self.own], mean[self.own], total)
        scale = np.divide(1.0, total, out=np.ones_like(total), where=total > 0.0)
        if spread is not None:
            felt = (total > 0.0)[:, np.newaxis]
            spread[:] = np.where(felt, moved * scale[self.others], own)
        return scale


@compiled
def _move(
    ptr: Indices,
    nodes: Indices,
    rows: Array,
    soft: Array,
    others: Indices,
    there: Flags,
    moved: Array,
) -> None:
    """``B diag(S)⁻¹ Bᵀ`` within vectors."""
    for c in range(others.shape[0]):
        for j in range(others.shape[1]):
            if there[c, j]:
                moved[c, j] = _product(ptr, nodes, rows, soft, c, others[c, j])


@inlined
def _product(ptr: Indices, nodes: Indices, rows: Array, soft: Array, a: int, b: int) -> float:
    """Of two constraints."""
    e, f, total = ptr[a], ptr[b], 0.0
    while e < ptr[a + 1] and f < ptr[b + 1]:
        node = nodes[e]
        if node < nodes[f]:
            e += 1
        elif node > nodes[f]:
            f += 1
        else:
            for k in range(6):
                total += rows[e, k] * rows[f, k] * soft[node, k]
            e, f = e + 1, f + 1
    return total
