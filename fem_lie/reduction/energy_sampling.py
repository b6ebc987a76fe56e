"""Energy-conserving sampling and weighting (ECSW): a few weighted cells replace all cells.

The reduced force of all cells, ``Σ_e Φᵀ Tᵀ f_e``, is approximated in training states by a few of
them, ``Σ_e ξ_e Φᵀ Tᵀ f_e`` with weights ``ξ ≥ 0``. These forces are the gradient of the energy
``Σ_e ξ_e W_e``, so the matrix remains symmetric. Forces are compared in the energy norm of the
stiffness at rest, and all states have the same weight. This is a least-squares problem with bounds,
of which a vertex is computed: the number of singular vectors of the training forces follows from
the tolerance, and at most as many cells have weights.

C. Farhat, P. Avery, T. Chapman & J. Cortial, Int. J. Numer. Meth. Engng 98 (2014) 625, with the
singular vectors of J. A. Hernández, M. A. Caicedo & A. Ferrer, CMAME 313 (2017) 687.

*Reduced energy, forces and matrix.* Nodes move as ``Hᵢ = Hᵢ⁰ exp dᵢ`` with ``dᵢ = Φᵢ η``, so that
with forces ``f`` in their axes::

    ∂W/∂η = Σ Φᵀ Tᵀ f          ∂²W/∂η² = Σ Φᵀ (Tᵀ K T + ∂(Tᵀ f)/∂d) Φ

with ``T = T₆(d)`` and the tangent stiffness ``K`` of the cells. The sum over all cells is symmetric
in every state.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.linalg
import scipy.optimize

from fem_lie import lie
from fem_lie._arrays import Array, Indices, instance, positive
from fem_lie.lie.node_types import rigid_motions
from fem_lie.reduction.basis import Basis, ReducedStates


class Moved(NamedTuple):
    """Some nodes at given modal coordinates.

    Attributes:
        d: Increments ``Φ η``, shape (n, 6).
        frames: ``H⁰ exp d``, shape (n, 4, 3).
        tangents: ``T₆(d)``, shape (n, 6, 6).
    """

    d: Array
    frames: Array
    tangents: Array


class ReducedNodes:
    """Some nodes of a body, and the modes there.

    Attributes:
        modes: Modes ``Φ`` at each node, shape (n, 6, m).
    """

    def __init__(self, basis: Basis, nodes: Indices) -> None:
        """Select nodes; a node may be given several times."""
        self._start = basis.body.frames[nodes]
        self.modes: Array = np.ascontiguousarray(basis.modes[:, nodes].transpose(1, 2, 0))

    def at(self, coordinates: Array) -> Moved:
        """The nodes at modal coordinates (m,)."""
        d = self.modes @ coordinates
        return Moved(d, np.asarray(lie.se3_retract(self._start, d)), lie.se3_tangent(d))

    def pulled(self, moved: Moved, forces: Array) -> Array:
        """Reduced forces ``Φᵀ Tᵀ f`` of each node, shape (n, m), for nodal forces (n, 6)."""
        local = np.einsum("nij,ni->nj", moved.tangents, forces)
        return np.asarray(np.einsum("njm,nj->nm", self.modes, local))

    def motions(self, moved: Moved) -> Array:
        """``T Φ``, twists of the nodes per modal velocity, shape (n, 6, m)."""
        return np.asarray(moved.tangents @ self.modes)

    def bent(self, moved: Moved, forces: Array) -> Array:
        """Geometric stiffness ``Σ Φᵀ ∂(Tᵀ f)/∂d Φ``, shape (m, m).

        From ``T⁻ᵀ g = f`` with ``g = Tᵀ f``: ``∂g/∂d = −Tᵀ ∂(T⁻ᵀ g)/∂d``.
        """
        turned = np.einsum("nij,ni->nj", moved.tangents, forces)
        change = lie.se3_tangent_inverse_transposed_derivative(moved.d, turned)
        change = -np.swapaxes(moved.tangents, 1, 2) @ change
        return summed(self.modes, change @ self.modes)


def summed(first: Array, second: Array) -> Array:
    """``Σ Aᵀ B`` of matrices (n, 6, m), shape (m, m)."""
    m = first.shape[2]
    return np.asarray(first.reshape(-1, m).T @ second.reshape(-1, m))


class ReducedCells:
    """Some cells of a body, with weights.

    Attributes:
        nodes: Nodes of all cells and the modes there, cell by cell.
        count: Number of cells.
    """

    def __init__(self, basis: Basis, cells: Indices, weights: Array) -> None:
        """Assemble these cells only.

        Args:
            basis: The modes.
            cells: Numbers of cells, shape (s,).
            weights: Weights of their energies, shape (s,).

        Raises:
            ValueError: The cells of this body cannot be assembled individually.
        """
        self._term = basis.body.model.weighted_cells(cells, weights)
        self.count = len(cells)
        self.nodes = ReducedNodes(basis, basis.body.model.elastic_cells[cells].ravel())
        self._H = np.empty((self._term.count, 4, 3))
        self._r, self._order = np.empty((self._term.count, 6)), self._term.order
        rows, columns = self._term.pairs
        inverse = np.argsort(self._order)
        self._rows, self._columns = inverse[rows], inverse[columns]

    def energy(self, coordinates: Array) -> float:
        """Stored energy."""
        self._H[self._order] = self.nodes.at(coordinates).frames
        return self._term.energy(self._H)

    def of_each(self, coordinates: Array) -> Array:
        """Reduced forces of each cell, shape (s, m)."""
        moved = self.nodes.at(coordinates)
        pulled = self.nodes.pulled(moved, self._forces(moved, self._term.workspace()))
        return np.asarray(pulled.reshape(self.count, -1, pulled.shape[1]).sum(axis=1))

    def forces(self, coordinates: Array) -> Array:
        """Reduced forces, the sum over all cells, shape (m,)."""
        return np.asarray(self.of_each(coordinates).sum(axis=0))

    def forces_and_matrix(self, coordinates: Array) -> tuple[Array, Array]:
        """Gradient (m,) and second derivative (m, m) of the energy."""
        moved, kept = self.nodes.at(coordinates), self._term.workspace()
        forces = self._forces(moved, kept)
        if self._term.stress_update is not None:
            self._term.stress_update.reset_stress(self._H)
        blocks = self._term.tangent(self._H, kept)
        motions = self.nodes.motions(moved)
        matrix = summed(motions[self._rows], blocks @ motions[self._columns])
        matrix += self.nodes.bent(moved, forces)
        return self.nodes.pulled(moved, forces).sum(axis=0), matrix

    def _forces(self, moved: Moved, kept: Array) -> Array:
        """Nodal forces in the nodes' axes, shape (n, 6)."""
        self._H[self._order] = moved.frames
        self._r[:] = 0.0
        if self._term.local is not None:
            self._term.local.condense(self._H)
        self._term.add_forces(self._H, self._r, kept)
        return self._r[self._order]


_ROUND_OFF = 1e-12

_RIGID = 1e-9  # part of a mode beyond rigid motions below which it has no strain


class CellSample(NamedTuple):
    """Weighted cells that replace all cells of a reduced-order body.

    Attributes:
        basis: The modes.
        cells: Numbers of the cells, increasing, shape (s,).
        weights: Weights of their energies, positive, shape (s,).
        error: Relative error of the training forces.
    """

    basis: Basis
    cells: Indices
    weights: Array
    error: float

    def reduced_cells(self) -> ReducedCells:
        """Energy, forces and matrix of these cells."""
        return ReducedCells(self.basis, self.cells, self.weights)


def ecsw(states: ReducedStates, tolerance: float) -> CellSample:
    """Choose a few cells with non-negative weights that reproduce the forces in training states.

    Example:
        >>> steel = fl.Material(E=2e11, nu=0.3, density=7800.0)
        >>> scene, square = fl.Scene(), fl.Section.rectangle(0.02, 0.02, steel)
        >>> beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), square, cells=40))
        >>> clamp = scene.add(fl.Clamp(beam.point("start")))
        >>> load = scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, 800)))
        >>> trained = fl.statics(scene, levels=(0.4, 0.8, 1.2))
        >>> basis = fl.reduction.pod(trained, beam, 2, axes=fl.reduction.FixedAxes())
        >>> sample = fl.reduction.ecsw(basis.project(trained, axes=fl.reduction.FixedAxes()), 1e-3)
        >>> len(sample.cells) <= 6, sample.error <= 1e-3
        (True, True)
        >>> float(fl.reduction.sampled_statics(scene, sample).frames[-1, -1, 0, 2].round(2))
        0.1

    Args:
        states: Training states, projected on a basis: ``basis.project(result)``.
        tolerance: Relative error of the training forces, below 1.

    Raises:
        ValueError: The cells of this body cannot be assembled individually, no state has strain, or
            the tolerance is below round-off.
    """
    instance(states, ReducedStates, "states", "states from basis.project(result)")
    if positive(tolerance, "tolerance") >= 1.0:
        raise ValueError(f"tolerance must be below 1, got {tolerance!r}")
    basis = states.basis
    count = len(basis.body.model.elastic_cells)
    forces = forces_of_training(ReducedCells(basis, np.arange(count), np.ones(count)), states)
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


def _has_rigid_motion(basis: Basis) -> bool:
    """Whether a combination of the modes moves the body as a rigid one."""
    frames = basis.body.frames
    centre, size = frames[:, 0].mean(axis=0), np.ptp(frames[:, 0], axis=0).max()
    weight = np.repeat([1.0, size], 3)  # all in lengths
    rigid = rigid_motions(basis.body.model.node_types, frames, centre) * weight[:, np.newaxis]
    rigid = rigid.reshape(-1, 6) / weight
    modes = (basis.modes * weight).reshape(len(basis), -1).T
    modes /= np.maximum(np.linalg.norm(modes, axis=0), np.finfo(np.float64).tiny)
    left = modes - rigid @ np.linalg.lstsq(rigid, modes, rcond=_RIGID)[0]
    return bool(np.linalg.svd(left, compute_uv=False)[-1] < _RIGID)


def forces_of_training(cells: ReducedCells, states: ReducedStates) -> Array:
    """Reduced forces of each cell in all states, in the energy norm at rest, shape (k m, s).

    The forces of each state are divided by the norm of their sum; states without strain are
    omitted.
    """
    if _has_rigid_motion(states.basis):
        raise ValueError("the basis has rigid-body modes, which have no stiffness: omit them")
    _, stiffness = cells.forces_and_matrix(np.zeros(len(states.basis)))
    root = np.linalg.cholesky(stiffness)
    found = [
        scipy.linalg.solve_triangular(root, cells.of_each(each).T, lower=True)
        for each in states.coordinates
    ]
    sizes = [float(np.linalg.norm(each.sum(axis=1))) for each in found]
    most = max(sizes, default=0.0)
    some = [f / size for f, size in zip(found, sizes, strict=True) if size > _ROUND_OFF * most]
    if not some:
        raise ValueError("expected training states with strain, got states without forces")
    return np.concatenate(some)
