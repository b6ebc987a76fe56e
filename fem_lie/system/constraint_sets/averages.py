"""Averaging attachments in the matrix: a few mean coordinates couple many nodes.

Coordinates ``s = Σ S h`` are sums over the nodes, and joints add ``Sᵀ C S`` to the matrix, with a
small core ``C``. It is either added to the blocks of all node pairs, or kept as a low-rank part
outside of the sparsity pattern.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.linalg

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled
from fem_lie.linear.low_rank import LowRank
from fem_lie.system.constraint_sets.constraint_set import ConstraintSet, Means
from fem_lie.system.nodes.held_attachments import HeldAttachments


@compiled
def _expand(
    core: Array, S: Array, of: Indices, left: Indices, right: Indices, index: Indices, K: Array
) -> None:
    """Add ``Sᵀ C S`` to blocks ``K``."""
    product, row, column = np.empty((S.shape[1], 6)), -1, -1
    for p in range(left.shape[0]):
        i, j = left[p], right[p]
        if of[i] != row or j != column:
            row, column = of[i], j
            product[:] = np.ascontiguousarray(core[row, :, of[j]]) @ S[j]
        K[index[p]] += S[i].T @ product


class AveragedPairs:
    """Contributions of joints between the nodes of averaging attachments.

    Attributes:
        means: Entries of the attachments; ``None`` if there are none.
        nodes: Rows and columns of pairs of nodes, shape (d,) each.
    """

    def __init__(
        self, attachments: HeldAttachments, blocks: Indices, first: Indices, second: Indices
    ) -> None:
        """Find the pairs of entries within averaging attachments, and between those joints couple.

        Args:
            attachments: Attachments of the set.
            blocks: Blocks of the set between two averaging attachments, shape (q,).
            first: Attachment of the rows of each block, shape (q,).
            second: Attachment of its columns, shape (q,).
        """
        self._attachments, self._blocks, self._first, self._second = (
            attachments,
            blocks,
            first,
            second,
        )
        of = attachments.averaged[attachments.of]
        nodes, self._of = attachments.nodes[of >= 0], of[of >= 0]
        joined = np.eye(int(of.max(initial=-1)) + 1, dtype=bool)
        joined[first, second] = True
        # entries of one column and attachment are adjacent
        self._right, self._left = np.nonzero(joined.T[self._of][:, self._of])
        self.nodes = nodes[self._left], nodes[self._right]
        self.means = Means(nodes, self._of, attachments.coordinates) if len(nodes) else None

    def core(self, H: Array, blocks: Array, forces: Array) -> Array:
        """``C`` (w, r, w, r), from blocks of the set and its forces on all attachments, (g, 6)."""
        L, C = self._attachments.cores(H, forces)
        w, r = C.shape[:2]
        core, alone = np.zeros((w, r, w, r)), np.arange(w)
        by_pair = core.swapaxes(1, 2)
        by_pair[alone, alone] = C
        between = blocks[self._blocks]
        pulled = L[self._first].transpose(0, 2, 1) @ between @ L[self._second]
        np.add.at(by_pair, (self._first, self._second), pulled)
        return core

    def add(self, H: Array, core: Array, index: Indices, K: Array) -> None:
        """Add ``Sᵀ C S`` to blocks ``K`` at the positions of :attr:`nodes`."""
        _expand(core, self._attachments.spread(H), self._of, self._left, self._right, index, K)


class Averages:
    """Mean coordinates of all averaging attachments with joints, ``s = Σ S h``.

    Attributes:
        nodes: Node of each row of ``S``, shape (l,): one row per node of an attachment and
            coordinate.
    """

    def __init__(self, sets: Sequence[ConstraintSet]) -> None:
        """Number the coordinates.

        Args:
            sets: All sets of constraints, some of which have averaging attachments.
        """
        self._sets: list[ConstraintSet] = []
        none: Indices = np.empty(0, dtype=np.int64)
        nodes, coordinates, attachments, first = [none], [none], [none], 0
        for each in sets:
            if (means := each.means) is None:
                continue
            self._sets.append(each)
            own, number = np.arange(means.each), int(means.of.max()) + 1
            nodes.append(np.repeat(means.nodes, means.each))
            coordinates.append((first + means.each * means.of[:, np.newaxis] + own).ravel())
            attachments.append(np.repeat(first + np.arange(number), means.each))
            first += means.each * number
        self.nodes: Indices = np.concatenate(nodes)
        self._coordinates: Indices = np.concatenate(coordinates)
        self._attachments, self._count = np.concatenate(attachments), first
        self.clear()

    def clear(self) -> None:
        """Set the geometric stiffness to zero."""
        self._spread: Array = np.zeros((len(self.nodes), 6))
        self._core: Array = np.zeros((self._count, self._count))

    def take(self, H: Array, multipliers: Array) -> None:
        """Evaluate the geometric stiffness of joints with multipliers (m,)."""
        found = [each.mean_stiffness(H, multipliers) for each in self._sets]
        if found:
            self._spread = np.concatenate([S.reshape(-1, 6) for S, _ in found])
            size = [C.shape[0] * C.shape[1] for _, C in found]
            cores = (C.reshape(n, n) for (_, C), n in zip(found, size, strict=True))
            self._core = np.asarray(scipy.linalg.block_diag(*cores))

    def put(self, rows: Array) -> None:
        """Set the last rows, (≥ l, 6), to the derivatives of the coordinates in twists."""
        rows[len(rows) - len(self._spread) :] = self._spread

    def low_rank(self, left: Array, right: Array, soft: Array, held: Flags) -> LowRank | None:
        """Low-rank part of the matrix.

        Args:
            left: Derivatives of the coordinates in twists, shape (l, 6).
            right: Derivatives in increments, shape (l, 6).
            soft: Flexibility of each unknown of the nodes, shape (n, 6).
            held: Unknowns that are zero, shape (n, 6).
        """
        if not self._count:
            return None
        incidence, own = np.nonzero(~held[self.nodes])
        node, coordinates = self.nodes[incidence], self._coordinates[incidence]
        U, W = left[incidence, own], right[incidence, own]
        # all coordinates of an attachment are lengths; some of a plane attachment are always zero
        alike = self._attachments
        yields = np.bincount(alike[coordinates], U**2 * soft[node, own], self._count)[alike]
        scale = np.divide(1.0, yields, out=np.ones_like(yields), where=yields > 0.0)
        return LowRank(6 * node + own, coordinates, U, W, self._core, scale)
