"""Errors by recovered stress: how far the stress of the elements is from a smoother one.

Recovered stress of thin shells: polynomials through the best stress of the cells around.

Curvatures of bicubics are best, by an order, where Gauss' rule of two by two points has them (O. C.
Zienkiewicz & J. Z. Zhu, IJNME 33 (1992) 1331). To these values in a cell and in those that share a
point with it a polynomial of second degree in the tangent plane is fitted, the nearer the closer:
else errors seem much too large where curvatures change within few cells. How much nearer was chosen
by one problem, see docs/measured/adaptivity.md. Components belong to the sections' axes, which
move with the shell, so states may be rotated at will; those of neighbours are rotated to one frame
first.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix, diags

from fem_lie._arrays import Array, Indices
from fem_lie.adaptivity.estimates.estimate import (
    ElementErrors,
    ErrorEstimate,
    Estimated,
    Estimator,
    steps_of,
)
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.shells.shell import Shell
from fem_lie.bodies.thin_shells.assembly import MEMBRANE_AND_BENDING, ThinShellAssembly
from fem_lie.bodies.thin_shells.thin_shell import ThinShell
from fem_lie.mesh.bicubic import hermite
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.history import Result
from fem_lie.results.states import nodes_in
from fem_lie.results.stresses.element_forces import without_jumps
from fem_lie.results.stresses.nodal_values import CellPoints
from fem_lie.results.stresses.section_forces import SectionForces, section_forces
from fem_lie.results.stresses.shell_resultants import Resultants, resultant_series
from fem_lie.results.stresses.shell_stress import ShellStress, in_axes, integration
from fem_lie.scene import Scene


@dataclass(frozen=True, eq=False)
class StressFields:
    """Stress at q points of each of m elements, b components in local frames.

    Attributes:
        own: Stress of the elements, shape (m, q, b).
        recovered: Recovered stress, of higher order, shape (m, q, b).
        weights: Integration weight (length or area) of each point, shape (m, q).
        compliance: ``D⁻¹`` of each element, shape (m, b, b).
    """

    own: Array
    recovered: Array
    weights: Array
    compliance: Array

    def energy(self, stress: Array) -> Array:
        """``∫ σ · D⁻¹ σ`` of each element, shape (m,): twice its elastic energy."""
        return self.work(stress, stress)

    def work(self, a: Array, b: Array) -> Array:
        """``∫ σ_a · D⁻¹ σ_b`` of each element, shape (m,)."""
        at_points = ((a @ self.compliance) * b).sum(axis=2)
        return np.asarray((at_points * self.weights).sum(axis=1))

    @property
    def missing(self) -> Array:
        """Recovered stress minus that of the elements, shape (m, q, b)."""
        return self.recovered - self.own

    @property
    def errors(self) -> ElementErrors:
        """Element errors: energy of the difference."""
        return ElementErrors(self.energy(self.missing), float(self.energy(self.own).sum()))


def beam_fields(
    result: Result | StaticResult, beam: Beam, scene: Scene, steps: Sequence[int]
) -> list[StressFields]:
    """Stress of the elements and recovered stress in some states.

    Forces at the ends of elements are in equilibrium with all forces on nodes and joints, so they
    are of higher order than ``σ = D ε``; in local frames they are components of one smooth field.
    The recovered stress is a polynomial in each element, of a degree equal to the number g of
    integration points. It interpolates these forces at both ends, without the jumps of distributed
    loads, and with g = 2 it has the mean of the element's own stress. The superconvergent patch of
    Zienkiewicz & Zhu (IJNME 33 (1992) 1331) is the element itself.

    Raises:
        ValueError: See :func:`~fem_lie.results.stresses.section_forces.section_forces`; or the
            energy of the element is not a strain energy.
    """
    found = section_forces(result, beam, scene, states=steps)
    return [_beam_fields(found, k) for k in range(len(steps))]


def _beam_fields(found: SectionForces, k: int) -> StressFields:
    beam, stress = found.beam, found.at_points(k)
    # without viscous forces
    ends = found.elements.at_ends(found.frames[k])[np.newaxis]
    ends = without_jumps(beam, ends, found.single)[0]
    g = stress.shape[1]
    x, w = np.polynomial.legendre.leggauss(g + 1)
    at = 0.5 * (1.0 + x)
    own, (start, end) = _polynomial(stress, at), np.swapaxes(ends, 0, 1)[:, :, np.newaxis]
    recovered = start + at[:, np.newaxis] * (end - start)
    if g > 1:
        missing = 1.5 * (stress.mean(axis=1) - ends.mean(axis=1))[:, np.newaxis]
        recovered = recovered + missing * (4.0 * at * (1.0 - at))[:, np.newaxis]
    weights = 0.5 * w * beam.model.lengths[:, np.newaxis]
    return StressFields(own, recovered, weights, np.linalg.inv(beam.model.stiffness))


def _polynomial(values: Array, at: Array) -> Array:
    """Values (m, g, 6) at Gauss points, interpolated to points ``at`` (q,) from 0 to 1."""
    x, _ = np.polynomial.legendre.leggauss(values.shape[1])
    points = np.vander(0.5 * (1.0 + x), increasing=True)
    positions = np.vander(at, values.shape[1], increasing=True)
    return np.asarray(np.einsum("qg,mgi->mqi", positions @ np.linalg.inv(points), values))


def shell_fields(
    result: Result | StaticResult, shell: Shell, scene: Scene, steps: Sequence[int]
) -> list[StressFields]:
    """Stress of the cells and recovered stress in some states.

    The recovered stress is interpolated from nodal values by the shape functions of the mesh. Nodal
    values are means over the cells that meet smoothly at the node, each rotated to one frame; at
    edges they are from a plane fitted to the values around (see
    :mod:`~fem_lie.results.stresses.shell_values`). Rigid motion is contained in the frames, not in
    the averaged components.

    Raises:
        ValueError: The shell is not in that result, or there is no such state.
    """
    series = resultant_series(result, shell, states=steps)
    rule, _ = integration(shell)
    shapes = CellPoints.of(shell.model.cut_mesh, rule).shapes
    compliance = ShellStress.of(shell).compliance
    return [_shell_fields(found, shapes, compliance) for found in series]


def _shell_fields(found: Resultants, shapes: Array, compliance: Array) -> StressFields:
    positions, number = found.stress_points, found.stress_points.patches.number
    nodal = in_axes(found.averaged[number], positions.shared[number], positions.section_at_nodes)
    own = in_axes(found.at_points, positions.asked, positions.section)
    return StressFields(own, shapes @ nodal, found.areas, compliance)


_BEST, _POWERS = 2, ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
_LEAST = 4
"""Least number of cells for a polynomial; if fewer are adjacent, the next ones are added."""
_DETERMINED = 1e-10
"""Relative eigenvalue of the normal equations that counts as zero."""
_NEAR = 4.0
"""Weights decrease with the distance d, in sizes of cells, as ``(1 + 4 d²)⁻⁴``."""


class _Points(NamedTuple):
    """The same reference points in all cells.

    Attributes:
        positions: Undeformed positions, shape (m, g, 3).
        first: e₁ of the section, shape (m, g, 3).
        normals: Normals, shape (m, g, 3).
    """

    positions: Array
    first: Array
    normals: Array


def thin_fields(
    result: Result | StaticResult, shell: ThinShell, scene: Scene, steps: Sequence[int]
) -> list[StressFields]:
    """Stress of the cells and recovered stress in some states.

    Raises:
        ValueError: The shell is not in that result.
    """
    nodes = nodes_in(result.info, shell)
    term = ThinShellAssembly([shell.model])
    stiffness = shell.model.stiffness[:, MEMBRANE_AND_BENDING, MEMBRANE_AND_BENDING]
    compliance = np.linalg.inv(stiffness)
    strains = [term.strains(np.ascontiguousarray(result.frames[k][nodes])) for k in steps]
    own = [e @ stiffness for e in strains]
    recovered = _recovered(shell, own)
    _, slopes, weights = shell.model.surface_rule()
    r1, r2 = np.einsum("gka,maj->kmgj", slopes, shell.model.hermite_vectors())
    areas = np.linalg.norm(np.cross(r1, r2), axis=-1) * weights
    return [
        StressFields(σ, better, areas, compliance) for σ, better in zip(own, recovered, strict=True)
    ]


def _recovered(shell: ThinShell, stresses: list[Array]) -> list[Array]:
    """Recovered stress in each state, shape (m, g, 6)."""
    at, _ = hermite.gauss(shell.model.formulation.points)
    best, _ = hermite.gauss(_BEST)
    squares = hermite.products(at, at), hermite.products(best, best), np.array([[0.5, 0.5]])
    own, samples, middle = (_points(shell, square) for square in squares)
    to_best = hermite.lagrange(at, best)
    values = np.kron(to_best, to_best)
    cells, others = _around(shell)
    basis = _basis(shell, middle, cells, samples, others)
    weighted = (
        basis / (1.0 + _NEAR * (basis[..., 1:3] ** 2).sum(-1, keepdims=True)) ** 4
    ).swapaxes(1, 2)
    turned = _turning(middle, cells, samples, others)
    normal = np.zeros((len(own.positions), len(_POWERS), len(_POWERS)))
    np.add.at(normal, cells, weighted @ basis)
    every = np.arange(len(own.positions))
    here, back = _basis(shell, middle, every, own, every), _turning(middle, every, own, every)
    found = []
    for σ in stresses:
        right = np.zeros((len(σ), len(_POWERS), σ.shape[2]))
        best_stress = np.einsum("pgij,pgj->pgi", turned, (values @ σ)[others])
        np.add.at(right, cells, weighted @ best_stress)
        # if few cells do not determine all coefficients, use the least-norm solution
        smooth = here @ (np.linalg.pinv(normal, _DETERMINED, hermitian=True) @ right)
        # the inverse of a rotation is that by the opposite angle
        found.append(np.asarray(np.linalg.solve(back, smooth[..., np.newaxis])[..., 0]))
    return found


def _points(shell: ThinShell, at: Array) -> _Points:
    table = hermite.table(at)[:, : hermite.ACROSS + 1]
    positions, r1, r2 = np.einsum("gka,maj->kmgj", table, shell.model.hermite_vectors())
    n = np.cross(r1, r2)
    n /= np.linalg.norm(n, axis=-1, keepdims=True)
    return _Points(positions, _in_plane(shell.model.axes[:, np.newaxis], n), n)


def _in_plane(vectors: Array, normals: Array) -> Array:
    e = vectors - np.einsum("...j,...j->...", vectors, normals)[..., np.newaxis] * normals
    return np.asarray(e / np.linalg.norm(e, axis=-1, keepdims=True))


def _around(shell: ThinShell) -> tuple[Indices, Indices]:
    """Pairs of a cell and a cell of its polynomial; sections are equal."""
    points = shell.model.connectivity[:, :4]
    m, n = len(points), shell.model.points_count
    rows = np.repeat(np.arange(m), 4)
    has = csr_matrix((np.ones(4 * m), (rows, points.ravel())), (m, n))
    _, section = np.unique(shell.model.stiffness.reshape(m, -1), axis=0, return_inverse=True)
    neighbours = _alike(has @ has.T, section.ravel())
    few = np.flatnonzero(np.diff(neighbours.indptr) < _LEAST)
    if len(few):
        chosen = np.isin(np.arange(m), few)
        neighbours = neighbours + diags(chosen.astype(np.float64)) @ neighbours @ neighbours
    return np.repeat(np.arange(m), np.diff(neighbours.indptr)), neighbours.indices.astype(np.int64)


def _alike(pairs: csr_matrix, section: Indices) -> csr_matrix:
    found = pairs.tocoo()
    same = section[found.row] == section[found.col]
    return csr_matrix((np.ones(same.sum()), (found.row[same], found.col[same])), pairs.shape)


def _basis(
    shell: ThinShell, middle: _Points, cells: Indices, points: _Points, others: Indices
) -> Array:
    """Monomials at points of other cells, in the tangent planes of cells, shape (p, g, 6)."""
    first, normal = middle.first[cells, 0], middle.normals[cells, 0]
    axes = np.stack([first, np.cross(normal, first)], axis=-1)
    size = np.sqrt(shell.model.sizes[cells, :2].prod(axis=1))
    away = points.positions[others] - middle.positions[cells]
    x, y = np.moveaxis(away @ axes / size[:, np.newaxis, np.newaxis], -1, 0)
    return np.stack([x**i * y**j for i, j in _POWERS], axis=-1)


def _turning(middle: _Points, cells: Indices, points: _Points, others: Indices) -> Array:
    """Rotation of components from sections' axes at points to axes of cells, (p, g, 6, 6)."""
    n = points.normals[others]
    e = points.first[others]
    f = _in_plane(middle.first[cells], n)
    # cosine and sine of the angle from e₁ of the section to e₁ of the cell
    c = np.einsum("pgj,pgj->pg", e, f)
    s = np.einsum("pgj,pgj->pg", np.cross(e, f), n)
    found = np.zeros((*c.shape, 6, 6))
    plane = np.array(
        [[c * c, s * s, 2 * s * c], [s * s, c * c, -2 * s * c], [-s * c, s * c, c * c - s * s]]
    ).transpose(2, 3, 0, 1)
    found[..., :3, :3] = found[..., 3:, 3:] = plane
    return found


_RECOVERIES: dict[type, Callable[..., list[StressFields]]] = {
    Beam: beam_fields,
    Shell: shell_fields,
    ThinShell: thin_fields,
}


@dataclass(frozen=True)
class RecoveryEstimate(ErrorEstimate):
    """Error estimate ``∫ (σ* − σ)·D⁻¹(σ* − σ)`` with a recovered stress σ*: the default.

    (O. C. Zienkiewicz & J. Z. Zhu, IJNME 24 (1987) 337.)

    Example:
        >>> fl.adaptivity.RecoveryEstimate()
        RecoveryEstimate()
    """

    def estimators(self) -> Mapping[type, Estimator]:
        """Functions for beams, shells and thin shells."""
        return dict.fromkeys(_RECOVERIES, _errors)


def _errors(
    result: Result | StaticResult, body: Estimated, scene: Scene, steps: Sequence[int]
) -> list[ElementErrors]:
    return [fields.errors for fields in fields_of(result, body, scene, steps)]


def fields_of(
    result: Result | StaticResult, body: Estimated, scene: Scene, steps: Sequence[int] = (-1,)
) -> list[StressFields]:
    """Stress of the elements of a body and recovered stress in some states.

    Raises:
        ValueError: See :meth:`~fem_lie.adaptivity.estimates.estimate.ErrorEstimate.errors`.
    """
    chosen = steps_of(result, body, scene, steps, tuple(_RECOVERIES))
    (recovery,) = (r for kind, r in _RECOVERIES.items() if isinstance(body, kind))
    return recovery(result, body, scene, chosen)
