"""Energy-conserving sampling and weighting: few cells whose weighted forces are those of all.

What all cells do in the shapes, ``Σ_e Φᵀ Tᵀ f_e``, is wanted in some states of training from few
of them, ``Σ_e ξ_e Φᵀ Tᵀ f_e`` with weights ``ξ ≥ 0``. Such forces are the gradient of the energy
``Σ_e ξ_e W_e``, so that the matrix stays symmetric. Forces are compared by the energy that they
would store at rest, and each state counts alike. That is a least-squares problem with bounds, of
which a vertex is wanted: of the singular vectors of the training as few are taken as the tolerance
allows, and as many cells at most have weights then.

C. Farhat, P. Avery, T. Chapman & J. Cortial, Int. J. Numer. Meth. Engng 98 (2014) 625, by the
singular vectors of J. A. Hernández, M. A. Caicedo & A. Ferrer, CMAME 313 (2017) 687.

Energy, forces and matrix in few shapes that some cells of a body make, with weights.

Nodes move as ``Hᵢ = Hᵢ⁰ exp dᵢ`` with ``dᵢ = Φᵢ η``, so that of forces ``f`` in their axes::

    ∂W/∂η = Σ Φᵀ Tᵀ f          ∂²W/∂η² = Σ Φᵀ (Tᵀ K T + ∂(Tᵀ f)/∂d) Φ

with ``T = T₆(d)`` and the cells' own matrix ``K``. That of all is symmetric in every state.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.linalg
import scipy.optimize

from fem_lie import lie
from fem_lie._arrays import Array, Indices, instance, positive
from fem_lie.reduce.basis import Basis, Reduced


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
        self._term = basis.body.weighted_cells(cells, weights)
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


_ROUND_OFF = 1e-12


class CellSample(NamedTuple):
    """Cells that stand for all in few shapes.

    Attributes:
        basis: The shapes.
        cells: Numbers of the cells, increasing, shape (s,).
        weights: Factors of their energies, positive, shape (s,).
        error: Of the forces of training, relative.
    """

    basis: Basis
    cells: Indices
    weights: Array
    error: float

    def in_shapes(self) -> CellsInShapes:
        """Energy, forces and matrix of these cells."""
        return CellsInShapes(self.basis, self.cells, self.weights)


def ecsw(states: Reduced, tolerance: float) -> CellSample:
    """Few cells, and weights that are not negative, with the forces of all in states of training.

    Example:
        >>> steel = fl.Material(E=2e11, nu=0.3, density=7800.0)
        >>> scene, square = fl.Scene(), fl.Section.rectangle(0.02, 0.02, steel)
        >>> beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), square, cells=40))
        >>> clamp = scene.add(fl.Clamp(beam.point("start")))
        >>> load = scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, 800)))
        >>> trained = fl.statics(scene, levels=(0.4, 0.8, 1.2))
        >>> basis = fl.pod(trained, beam, 2, axes=fl.FixedAxes())
        >>> sample = fl.ecsw(basis.project(trained, axes=fl.FixedAxes()), 1e-3)
        >>> len(sample.cells) <= 6, sample.error <= 1e-3
        (True, True)
        >>> float(fl.sampled_statics(scene, sample).frames[-1, -1, 0, 2].round(2))
        0.1

    Args:
        states: Of training, in the shapes: ``basis.project(result)``.
        tolerance: Of the forces of training, relative, below 1.

    Raises:
        ValueError: The body has no cells that can be taken one by one, nothing is strained, or the
            tolerance is beyond round-off.
    """
    instance(states, Reduced, "states", "states in few shapes, of basis.project(result)")
    if positive(tolerance, "tolerance") >= 1.0:
        raise ValueError(f"tolerance must be below 1, got {tolerance!r}")
    basis = states.basis
    count = len(basis.body.elastic_cells)
    forces = forces_of_training(CellsInShapes(basis, np.arange(count), np.ones(count)), states)
    left, sizes, right = np.linalg.svd(forces, full_matrices=False)
    wanted = forces.sum(axis=1)
    for rank in range(1, int((sizes > _ROUND_OFF * sizes[0]).sum()) + 1):
        rows = sizes[:rank, np.newaxis] * right[:rank]
        weights, _ = scipy.optimize.nnls(rows, left[:, :rank].T @ wanted)
        error = np.linalg.norm(forces @ weights - wanted) / np.linalg.norm(wanted)
        if error <= tolerance:
            cells = np.flatnonzero(weights)
            return CellSample(basis, cells, weights[cells], float(error))
    raise ValueError(f"no weights have an error of {tolerance:g}: give a larger tolerance")


def forces_of_training(cells: CellsInShapes, states: Reduced) -> Array:
    """Forces of each cell in all shapes and states, in units of energy at rest, (k m, s).

    Those of each state are over the norm of their sum; states without strain are left out.
    """
    _, stiffness = cells.forces_and_matrix(np.zeros(len(states.basis)))
    try:
        root = np.linalg.cholesky(stiffness)
    except np.linalg.LinAlgError:
        raise ValueError(
            "the shapes have rigid motions, which no cell resists: leave them out"
        ) from None
    found = [
        scipy.linalg.solve_triangular(root, cells.of_each(each).T, lower=True)
        for each in states.coordinates
    ]
    sizes = [float(np.linalg.norm(each.sum(axis=1))) for each in found]
    most = max(sizes, default=0.0)
    some = [f / size for f, size in zip(found, sizes, strict=True) if size > _ROUND_OFF * most]
    if not some:
        raise ValueError("states of training must have strain: there are no forces in any of them")
    return np.concatenate(some)
