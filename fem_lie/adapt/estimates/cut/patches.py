"""Small problems: each cell with those that touch it, cut in four, with the nodes within free."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.sparse.linalg
from scipy.sparse import bsr_matrix, coo_matrix, csr_matrix

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.adapt.estimates.cut.cut_shells import Cut

_FIVE = 5


class Patches(NamedTuple):
    """One problem for each cell of a shell: its corners and all new nodes beside one of these.

    Attributes:
        patch: Of each node of all problems, sorted, shape (r,).
        nodes: Which node of the cut shell it is, sorted within a problem, shape (r,).
        total: Number of nodes of the cut shell.
    """

    patch: Indices
    nodes: Indices
    total: int

    @classmethod
    def of(cls, cut: Cut) -> Patches:
        """Those of a shell whose cells are cut."""
        corners, (m, k) = cut.shell.own_mesh.cells, cut.shell.own_mesh.cells.shape
        n, N, edges = len(cut.shell.frames), len(cut.fine.frames), len(cut.ends)
        middles = np.arange(n + edges, N)
        about = [np.arange(n), cut.ends.ravel(), corners[: len(middles)].ravel()]
        nodes = [np.arange(n), np.repeat(n + np.arange(edges), 2), np.repeat(middles, k)]
        pairs = np.concatenate(about), np.concatenate(nodes)
        beside = csr_matrix((np.ones(len(pairs[0])), pairs), shape=(n, N))
        of_cells = csr_matrix((np.ones(m * k), (np.repeat(np.arange(m), k), corners.ravel())))
        found = np.unique(np.ravel_multi_index((of_cells @ beside).nonzero(), (m, N)))
        return cls(found // N, found % N, N)

    def solved(self, cells: Indices, stiffness: Array, rest: Array, free: Flags) -> Array:
        """Motions of the nodes of each fine cell in the problem of its parent, (4 m, k, 5).

        Args:
            cells: Nodes of the fine cells, shape (4 m, k).
            stiffness: Of these, shape (4 m, k 5, k 5).
            rest: Force that is missing at each node, shape (N, 5).
            free: In which it can move, shape (N, 5).
        """
        K = _assembled(cells, stiffness, free)
        keys = self.patch * self.total + self.nodes
        starts, lengths = K.indptr[self.nodes], np.diff(K.indptr)[self.nodes]
        row = np.repeat(np.arange(len(keys)), lengths)
        first = np.repeat(np.cumsum(lengths) - lengths, lengths)
        block = starts[row] + np.arange(len(row)) - first
        wanted = self.patch[row] * self.total + K.indices[block]
        column = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
        known = keys[column] == wanted  # others are on the rim
        counts = np.bincount(row[known], minlength=len(keys))
        matrix = bsr_matrix(
            (K.data[block[known]], column[known], np.append(0, np.cumsum(counts))),
            shape=(keys.size * _FIVE,) * 2,
        )
        forces = np.where(free, rest, 0.0)[self.nodes].ravel()
        solve = scipy.sparse.linalg.splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A")
        moved = solve.solve(forces).reshape(-1, _FIVE)
        parents = np.arange(len(cells))[:, np.newaxis] // 4
        return np.asarray(moved[np.searchsorted(keys, parents * self.total + cells)])


def _assembled(cells: Indices, stiffness: Array, free: Flags) -> bsr_matrix:
    """Blocks of five by five, sorted; motions that are held have a one on the diagonal."""
    size = free.size
    rows = (_FIVE * cells[..., np.newaxis] + np.arange(_FIVE)).reshape(len(cells), -1)
    loose = free.ravel()[rows]
    values = stiffness * (loose[:, :, np.newaxis] & loose[:, np.newaxis])
    i, j = np.broadcast_arrays(rows[..., np.newaxis], rows[:, np.newaxis])
    held = np.flatnonzero(~free.ravel())
    entries = np.concatenate([values.ravel(), np.ones(len(held))])
    places = np.concatenate([i.ravel(), held]), np.concatenate([j.ravel(), held])
    K = coo_matrix((entries, places), shape=(size, size)).tocsr().tobsr((_FIVE, _FIVE))
    K.sort_indices()
    return K
