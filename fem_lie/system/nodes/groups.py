"""Connected groups of elements, on one rank or over several, and their rigid motions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.linear.spectra.free_unknowns import triangle
from fem_lie.linear.spectra.pencil import FREE, kernel
from fem_lie.ranks.shared_nodes import SharedNodes


class Groups:
    """Groups of nodes that elements connect; without elements each node is one.

    Attributes:
        of_node: Group of each node among those of all ranks, shape (n,).
        count: Number of groups of all ranks.
    """

    def __init__(self, shared: SharedNodes, pairs: Sequence[tuple[Indices, Indices]]) -> None:
        """Find the groups; all ranks together.

        Args:
            shared: Nodes that other ranks have, too.
            pairs: Rows and columns of pairs of nodes of the same element.
        """
        n = len(shared.owned)
        none = np.empty(0, np.int64)
        rows, columns = (np.concatenate([none, *(pair[k] for pair in pairs)]) for k in (0, 1))
        graph = sp.coo_matrix((np.ones(len(rows)), (rows, columns)), shape=(n, n))
        pieces, label = connected_components(graph, directed=False)
        self.of_node, self.count = shared.groups(label, pieces)
        self._shared = shared
        order = np.argsort(self.of_node, kind="stable")
        own, first = np.unique(self.of_node[order], return_index=True)
        parts = np.split(order, first[1:])
        self._nodes: dict[int, Indices] = {int(g): at for g, at in zip(own, parts, strict=True)}
        self._common = {int(g) for g in self.of_node[shared.copied]}

    def sums(self, values: Array) -> Array:
        """Sums over the nodes of each group, from rows (n, k), shape (``count``, k)."""
        found, owned = np.zeros((self.count, values.shape[1])), self._shared.owned
        np.add.at(found, self.of_node[owned], values[owned])
        return self._shared.total(found)

    def basis(self, R: Array, stuck: Flags, held: Flags) -> tuple[sp.csr_matrix, Indices]:
        """Orthonormal basis of the rigid motions that supports allow.

        Args:
            R: Rigid motions of the group of each node, shape (6 n, 6).
            stuck: Unknowns that supports hold, shape (6 n,).
            held: Unknowns that are zero, shape (6 n,).

        Returns:
            The basis, motions of the free unknowns as columns, shape (f, r), and the group of each
            column, (r,); columns are those of all ranks.
        """
        rows = {g: (6 * at[:, np.newaxis] + np.arange(6)).ravel() for g, at in self._nodes.items()}
        supports = self._stacked({g: triangle(R[at[stuck[at]]]) for g, at in rows.items()})
        free = {g: at[~held[at]] for g, at in rows.items()}
        motions = {g: R[at] @ kernel(supports[g]) for g, at in free.items()}
        owned = np.repeat(self._shared.owned, 6)
        # twice: the first pass leaves round-off of badly conditioned motions
        for _ in range(2):
            own = {g: triangle(x[owned[free[g]]]) for g, x in motions.items()}
            found = self._stacked(own)
            motions = {g: x @ _orthonormalising(found[g]) for g, x in motions.items()}
        return self._as_columns(free, motions, np.cumsum(~held) - 1)

    def _as_columns(
        self, free: dict[int, Indices], motions: dict[int, Array], number: Indices
    ) -> tuple[sp.csr_matrix, Indices]:
        """Matrix of the motions of all groups, see :meth:`basis`; ``number`` of free unknowns."""
        widths = {g: x.shape[1] for g, x in motions.items()}
        first, total = self._shared.columns(widths, self._common)
        rows: list[Indices] = [np.empty(0, np.int64)]
        columns, values = rows.copy(), [np.zeros(0)]
        of_column = np.zeros(total, dtype=np.int64)
        for g, x in motions.items():
            k, width = x.shape
            rows.append(np.repeat(number[free[g]], width))
            columns.append(np.tile(first[g] + np.arange(width), k))
            values.append(x.ravel())
            of_column[first[g] : first[g] + width] = g
        at = np.concatenate(rows), np.concatenate(columns)
        shape = (int(number[-1]) + 1, total)
        basis = sp.csr_matrix((np.concatenate(values), at), shape=shape)
        return basis, self._shared.highest(of_column)

    def _stacked(self, triangles: dict[int, Array]) -> dict[int, Array]:
        """Triangles of QR factors of each group, with the rows of all ranks of common groups."""
        found = dict(triangles)
        for g, parts in self._shared.of_all({g: triangles[g] for g in self._common}).items():
            if g in self._common:
                found[g] = triangle(np.concatenate(parts))
        return found


def _orthonormalising(of: Array) -> Array:
    """Factor that makes motions with this triangle of QR factors orthonormal, shape (c, ≤ c).

    Motions that move nothing, as the spin of a cable, are left out.
    """
    _, sizes, turn = np.linalg.svd(of)
    kept = sizes > FREE * sizes.max(initial=0.0)
    return np.asarray(turn[: len(sizes)][kept].T / sizes[kept])
