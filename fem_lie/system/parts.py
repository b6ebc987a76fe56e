"""Blocks of the tangent matrix as arrays, and the scaling of constraints.

``A`` are derivatives in corrections of increments, ``K`` in twists. For columns of position nodes
both are equal and share their blocks, and in statics, where only ``K`` has contributions, all do;
the separate blocks of ``K`` follow those of ``A``.
"""

from __future__ import annotations

from enum import Enum

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled, inlined
from fem_lie._jit.copies import copy_matrix
from fem_lie.lie.motions import tangent_inverse
from fem_lie.lie.node_types.node_type import POSITION, POSITION_GRADIENT
from fem_lie.lie.tuples import load, load_row, rotate, store
from fem_lie.linear.saddle_point import Incidences, flexibility

_ALIKE = 30.0  # largest ratio within a vector of constraints that has one scale


class Vectors:
    """Grouping of constraints into vectors.

    Attributes:
        first: First constraint of each vector, shape (k,).
        own: Vector of each constraint, shape (m,).
        others: Constraints of the vector of each, (m, w); arbitrary where not :attr:`there`.
        there: Whether these entries belong to the vector, (m, w).
    """

    def __init__(self, joined: Flags) -> None:
        """Group constraints; ``joined`` says which belong to the vector of the one before, (m,)."""
        count = len(joined)
        self.first: Indices = np.flatnonzero(~joined)
        self.own: Indices = np.cumsum(~joined) - 1
        sizes = np.diff(self.first, append=count)
        within = np.arange(int(sizes.max(initial=1)))
        self.there = within < sizes[self.own, np.newaxis]
        reached = self.first[self.own, np.newaxis] + within
        self.others: Indices = np.where(self.there, reached, 0)

    def scales(
        self,
        incidences: Incidences,
        rows: Array,
        diagonal: Array,
        units: Array,
        spread: Array | None = None,
    ) -> Array:
        """Scale factors ``1/(B diag(S)⁻¹ Bᵀ)`` of constraints, shape (m,).

        Constraints of one vector have the mean, which does not depend on their axes, unless they
        differ much: the matrix would then be as badly conditioned as they differ.

        Args:
            incidences: Incidences of the constraints.
            rows: ``B``, one row of six per incidence, zero along held unknowns.
            diagonal: Diagonal of ``S``, shape (n, 6).
            units: Unit of each unknown, zero for held ones, shape (n, 6).
            spread: Change of each constraint of :attr:`others` under forces of the size of their
                scale, (m, w), overwritten.
        """
        soft = flexibility(diagonal, units)
        moved = np.zeros(self.there.shape)
        _move(incidences.ptr, incidences.nodes, rows, soft, self.others, self.there, moved)
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
    """Product of two constraints."""
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


class Sharing(Enum):
    """Pairs of nodes that have one block for ``A`` and ``K``."""

    NONE = "none"
    POSITIONS = "those whose columns are of position nodes"
    ALL = "all, as A has no contributions of its own at rest"


class Parts:
    """The matrices ``A`` and ``K``.

    If all pairs share their blocks, the blocks exist only from :meth:`clear` to :meth:`release`:
    in statics nothing reads them after the matrix is filled, and they take more memory than it.

    Attributes:
        blocks: Blocks of ``A``, then the separate blocks of ``K``, shape (any, 6, 6).
        of_K: Position of the block of ``K`` of each pair, shape (nnz,).
        separate: Whether all blocks of ``K`` are separate.
    """

    def __init__(self, kinds: Indices, bind: Indices, sharing: Sharing) -> None:
        """Find the positions of the blocks.

        Args:
            kinds: Types of the nodes.
            bind: Node of the columns of each block.
            sharing: Pairs that share their blocks.
        """
        self._bind, count = bind, len(bind)
        alone = kinds[bind] != POSITION
        if sharing is not Sharing.POSITIONS:
            alone[:] = sharing is Sharing.NONE
        self.separate = bool(alone.all())
        self.of_K: Indices = np.arange(count)
        self.of_K[alone] = count + np.arange(alone.sum())
        self._shape = count + int(alone.sum()), 6, 6
        self._lasts = sharing is not Sharing.ALL
        self.blocks = np.zeros(self._shape if self._lasts else (0, 6, 6))

    def clear(self) -> None:
        """Set all blocks to zero."""
        if self._lasts:
            self.blocks[:] = 0.0
        else:
            self.blocks = np.zeros(self._shape)

    def release(self) -> None:
        """Free the blocks if nothing reads them after the matrix is filled."""
        if not self._lasts:
            self.blocks = np.zeros((0, 6, 6))

    @property
    def A(self) -> Array:
        """Blocks of ``A`` of all pairs, shape (nnz, 6, 6)."""
        return self.blocks[: len(self.of_K)]

    @property
    def K(self) -> Array:
        """Blocks of ``K`` of all pairs, if all are separate, shape (nnz, 6, 6)."""
        assert self.separate
        return self.blocks[len(self.of_K) :]

    def index_in_K(self, index: Indices) -> Indices:
        """Positions in ``K`` of pairs at positions in ``A``, −1 where there is none."""
        return np.where(index < 0, -1, self.of_K[index])

    def add_share(self, share: Array, others: Array) -> None:
        """Add other blocks times a factor of each pair, (nnz, 1, 1)."""
        count = len(share)
        own = np.flatnonzero(self.of_K >= count)
        self.blocks[:count] += share * others[:count]
        self.blocks[count:] += share[own] * others[count:]

    def refer_to_unknowns(self, motions: Array) -> None:
        """Change derivatives in motions of the nodes into derivatives in other unknowns.

        Only the separate blocks of ``K`` change: those of position nodes move as their unknowns.

        Args:
            motions: Maps from unknowns to motions, see
                :class:`~fem_lie.system.time_state.Plan`, (n, k, 3, 3).
        """
        _refer_to_unknowns(self.blocks, self.of_K, motions, self._bind)

    def refer_to_twists(self, kinds: Indices, d: Array) -> None:
        """``A ← A T⁻¹(d)``: derivatives in ``h = T(d) δd`` instead of d."""
        _refer_to_twists(self.blocks, self.of_K, kinds, d, self._bind)

    def add_K(self) -> None:
        """``A ← A + K``."""
        _add(self.blocks, self.of_K)


@compiled
def _add(blocks: Array, of_K: Indices) -> None:
    for b in range(of_K.shape[0]):
        if of_K[b] != b:
            for k in range(6):
                for n in range(6):
                    blocks[b, k, n] += blocks[of_K[b], k, n]


@compiled
def _refer_to_twists(blocks: Array, of_K: Indices, kinds: Indices, d: Array, bind: Indices) -> None:
    inverse, product = np.empty((6, 6)), np.empty((6, 6))
    for b in range(bind.shape[0]):
        node = bind[b]
        # nodes with vector coordinates have T = 1
        if of_K[b] == b or kinds[node] >= POSITION_GRADIENT:
            continue
        tangent_inverse(kinds[node], d[node], inverse)
        for i in range(6):
            for j in range(6):
                product[i, j] = 0.0
                for k in range(6):
                    product[i, j] += blocks[b, i, k] * inverse[k, j]
        copy_matrix(product, blocks[b])


@compiled
def _refer_to_unknowns(blocks: Array, of_K: Indices, motions: Array, bind: Indices) -> None:
    for b in range(bind.shape[0]):
        if of_K[b] != b:
            for k in range(6):
                _map_row(motions[bind[b]], blocks[of_K[b], k])


@compiled
def map_rows(rows: Array, motions: Array, nodes: Indices) -> None:
    """Change rows of a Jacobian in motions of the nodes into derivatives in other unknowns.

    Args:
        rows: One row of six per incidence, updated.
        motions: Maps from unknowns to motions, see :class:`~fem_lie.system.time_state.Plan`,
            (n, k, 3, 3).
        nodes: Node of each incidence.
    """
    for incidence in range(rows.shape[0]):
        _map_row(motions[nodes[incidence]], rows[incidence])


@inlined
def _map_row(maps: Array, row: Array) -> None:
    """``row ← row M`` of one node."""
    for k in range(maps.shape[0]):
        M, a = maps[k], load(row, 3 * k)
        store(row, 3 * k, rotate(load_row(M, 0), load_row(M, 1), load_row(M, 2), a))
