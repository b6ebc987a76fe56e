r"""Energy, forces and matrix in few shapes that some cells of a body make, with weights.

Nodes move as ``Hᵢ = Hᵢ⁰ exp dᵢ`` with ``dᵢ = Φᵢ η``, so that of forces ``f`` in their axes::

    ∂W/∂η = Σ Φᵀ Tᵀ f          ∂²W/∂η² = Σ Φᵀ (Tᵀ K T + ∂(Tᵀ f)/∂d) Φ

with ``T = T₆(d)`` and the cells' own matrix ``K``. That of all is symmetric in every state.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie.reduce.basis import Basis


class Moved(NamedTuple):
    """Some nodes in few shapes.

    Attributes:
        d: Increments ``Φ η``, shape (n, 6).
        frames: ``H⁰ exp d``, shape (n, 4, 3).
        tangents: ``T₆(d)``, shape (n, 6, 6).
    """

    d: Array
    frames: Array
    tangents: Array


class NodesInShapes:
    """Some nodes of a body, and the shapes there.

    Attributes:
        shapes: ``Φ`` of each, shape (n, 6, m).
    """

    def __init__(self, basis: Basis, nodes: Indices) -> None:
        """Take what is needed; a node may come several times."""
        self._start = basis.body.frames[nodes]
        self.shapes: Array = np.ascontiguousarray(basis.shapes[:, nodes].transpose(1, 2, 0))

    def at(self, coordinates: Array) -> Moved:
        """The nodes at coordinates (m,)."""
        d = self.shapes @ coordinates
        return Moved(d, np.asarray(lie.se3_retract(self._start, d)), lie.se3_tangent(d))

    def pulled(self, moved: Moved, forces: Array) -> Array:
        """``Φᵀ Tᵀ f`` of each node, shape (n, m), of forces (n, 6)."""
        local = np.einsum("nij,ni->nj", moved.tangents, forces)
        return np.asarray(np.einsum("njm,nj->nm", self.shapes, local))

    def motions(self, moved: Moved) -> Array:
        """``T Φ``, twists of the nodes, shape (n, 6, m)."""
        return np.asarray(moved.tangents @ self.shapes)

    def bent(self, moved: Moved, forces: Array) -> Array:
        """``Σ Φᵀ ∂(Tᵀ f)/∂d Φ``, shape (m, m).

        From ``T⁻ᵀ g = f`` with ``g = Tᵀ f``: ``∂g/∂d = −Tᵀ ∂(T⁻ᵀ g)/∂d``.
        """
        turned = np.einsum("nij,ni->nj", moved.tangents, forces)
        change = lie.se3_tangent_inverse_transposed_derivative(moved.d, turned)
        change = -np.swapaxes(moved.tangents, 1, 2) @ change
        return summed(self.shapes, change @ self.shapes)


def summed(first: Array, second: Array) -> Array:
    """``Σ Aᵀ B`` of matrices (n, 6, m), shape (m, m)."""
    m = first.shape[2]
    return np.asarray(first.reshape(-1, m).T @ second.reshape(-1, m))


class CellsInShapes:
    """Some cells of a body, with weights.

    Attributes:
        nodes: Their nodes in the shapes, those of one cell after those of the other.
        count: How many cells.
    """

    def __init__(self, basis: Basis, cells: Indices, weights: Array) -> None:
        """Assemble these cells, and no others.

        Args:
            basis: The shapes.
            cells: Numbers of cells, shape (s,).
            weights: Factors of their energies, shape (s,).

        Raises:
            ValueError: The body has no cells that can be taken one by one.
        """
        self._term = basis.body.cells_apart(cells, weights)
        self.count = len(cells)
        self.nodes = NodesInShapes(basis, basis.body.elastic_cells[cells].ravel())
        self._H = np.empty((self._term.count, 4, 3))
        self._r, self._order = np.empty((self._term.count, 6)), self._term.order
        rows, columns = self._term.pairs
        place = np.argsort(self._order)
        self._rows, self._columns = place[rows], place[columns]

    def energy(self, coordinates: Array) -> float:
        """Stored energy."""
        self._H[self._order] = self.nodes.at(coordinates).frames
        return self._term.energy(self._H)

    def of_each(self, coordinates: Array) -> Array:
        """Forces in the shapes that each cell makes, shape (s, m)."""
        moved = self.nodes.at(coordinates)
        pulled = self.nodes.pulled(moved, self._forces(moved, self._term.room()))
        return np.asarray(pulled.reshape(self.count, -1, pulled.shape[1]).sum(axis=1))

    def forces(self, coordinates: Array) -> Array:
        """Sum of these, shape (m,)."""
        return np.asarray(self.of_each(coordinates).sum(axis=0))

    def forces_and_matrix(self, coordinates: Array) -> tuple[Array, Array]:
        """Gradient (m,) and second derivative (m, m) of the energy."""
        moved, kept = self.nodes.at(coordinates), self._term.room()
        forces = self._forces(moved, kept)
        if self._term.stress_update is not None:
            self._term.stress_update.reset_stress(self._H)
        blocks = self._term.tangent(self._H, kept)
        motions = self.nodes.motions(moved)
        matrix = summed(motions[self._rows], blocks @ motions[self._columns])
        matrix += self.nodes.bent(moved, forces)
        return self.nodes.pulled(moved, forces).sum(axis=0), matrix

    def _forces(self, moved: Moved, kept: Array) -> Array:
        """Of the nodes, in their axes, shape (n, 6)."""
        self._H[self._order] = moved.frames
        self._r[:] = 0.0
        if self._term.local is not None:
            self._term.local.condense(self._H)
        self._term.add_forces(self._H, self._r, kept)
        return self._r[self._order]
