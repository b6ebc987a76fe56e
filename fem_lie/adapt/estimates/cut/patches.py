"""Small problems: the cells about each node, cut in four, with their own nodes free."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.sparse.linalg
from scipy.sparse import csc_matrix

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.adapt.estimates.cut.cut_shells import Cut

_FIVE = 5
# part of a cell from the problem about each of its corners
_TAKEN = {
    "triangle": np.vstack([np.eye(3), np.full((1, 3), 1.0 / 3.0)]),
    "quadrilateral": np.eye(4),
}


class Patches(NamedTuple):
    """One problem about each node of a shell: that node and the new ones on its side of the rim.

    Attributes:
        nodes: The nodes of all problems, one problem after the other, shape (r,).
        places: In that list, of the nodes of each cell in the problem of each corner of its parent,
            −1 for those that stay, shape (corners, 4 m, k).
        shares: Of what is found there in each cell, shape (corners, 4 m).
    """

    nodes: Indices
    places: Indices
    shares: Array

    @classmethod
    def of(cls, cut: Cut) -> Patches:
        """Those of a shell whose cells are cut."""
        corners, cells = cut.shell.own_mesh.cells, cut.fine.own_mesh.cells
        n, N, edges = len(cut.shell.frames), len(cut.fine.frames), len(cut.ends)
        m, k = corners.shape
        middles = np.arange(n + edges, N)
        about = [np.arange(n), cut.ends.ravel(), corners[: len(middles)].ravel()]
        nodes = [np.arange(n), np.repeat(n + np.arange(edges), 2), np.repeat(middles, k)]
        keys = np.sort(np.concatenate(about) * N + np.concatenate(nodes))
        wanted = np.repeat(corners.T, 4, axis=1)[..., np.newaxis] * N + cells
        found = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
        places = np.where(keys[found] == wanted, found, -1)
        return cls(keys % N, places, np.tile(_TAKEN[cut.shell.own_mesh.cell].T, m))

    def stress(self, stress: Array, works: Array, rest: Array, free: Flags) -> Array:
        """Stress (4 m, s) that balances what is left, each cell's from the problem it belongs to.

        Args:
            stress: Its derivatives in the motions of the nodes, shape (4 m, s, k, 5).
            works: What these are to be multiplied with to give forces, of the same shape.
            rest: Force that is missing at each node, shape (N, 5).
            free: In which it can move, shape (N, 5).
        """
        m, s, k, _ = stress.shape
        stress, works = stress.reshape(m, s, -1), works.reshape(m, s, -1)
        K = np.swapaxes(works, 1, 2) @ stress
        loose = free[self.nodes]
        size = loose.size
        numbers = np.where(loose, np.arange(size).reshape(loose.shape), -1)
        numbers = np.concatenate([numbers, np.full((1, _FIVE), -1)])  # nodes that stay
        rows = numbers[self.places].reshape(len(self.places), m, k * _FIVE)
        i, j = np.broadcast_arrays(rows[..., np.newaxis], rows[:, :, np.newaxis])
        known = (i >= 0) & (j >= 0)
        fixed = np.flatnonzero(~loose.ravel())
        values = np.concatenate([np.broadcast_to(K, i.shape)[known], np.ones(len(fixed))])
        places = np.concatenate([i[known], fixed]), np.concatenate([j[known], fixed])
        matrix = csc_matrix((values, places), shape=(size, size))
        forces = np.where(loose, rest[self.nodes], 0.0).ravel()
        solve = scipy.sparse.linalg.splu(matrix, permc_spec="MMD_AT_PLUS_A")
        moved = np.append(solve.solve(forces), 0.0)[rows]  # (corners, 4 m, k 5)
        taken = np.einsum("cm,cmi->mi", self.shares, moved)
        return np.asarray((stress @ taken[..., np.newaxis])[..., 0])
