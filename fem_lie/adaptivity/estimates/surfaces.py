"""Recovered stress of shells on smooth patches: polynomials through the best stress around.

Curvatures of bicubics are best where Gauss' rule of two by two points has them, resultants of the
ANCF plate in their mean over a cell. Polynomials are in the tangent plane of each cell. Components
belong to the sections' axes, which move with the shell, so states may be rotated at will; those of
neighbours are rotated to one frame first.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.adaptivity.estimates.patches import Pairs, Patches, complete_powers, shared_nodes
from fem_lie.adaptivity.estimates.stress_fields import StressFields
from fem_lie.bodies.gradients.ancf_shell import AncfShell
from fem_lie.bodies.thin_shells.assembly import MEMBRANE_AND_BENDING, ThinShellAssembly
from fem_lie.bodies.thin_shells.thin_shell import ThinShell
from fem_lie.mesh.bicubic import hermite
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.history import Result
from fem_lie.results.states import nodes_in
from fem_lie.scene import Scene

_BEST = 2
"""Gauss points per direction at which the curvatures of bicubics are best."""
_LEAST = 4
"""Least number of cells of a patch."""
_COMPONENTS = 9
"""Membrane forces, moments, shear forces, and the force across the thickness."""


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


class _SurfacePatches:
    """Fits in the tangent planes of the cells."""

    def __init__(
        self, shell: ThinShell | AncfShell, points: Array, best: Array, degree: int
    ) -> None:
        """Set up the fits.

        Args:
            shell: The shell.
            points: Reference points at which stress is recovered, shape (q, 2).
            best: Reference points at which it is best, shape (g, 2).
            degree: Degree of the polynomials.
        """
        own, sampled, middle = (_points(shell, at) for at in (points, best, np.array([[0.5, 0.5]])))
        corners = shared_nodes(shell.model.connectivity[:, :4], shell.model.stiffness)
        pairs = Pairs.around_elements(corners, _LEAST)
        every = np.arange(len(own.positions))
        self._turned = _turning(middle, pairs.patches, sampled, pairs.elements)
        # the inverse of a rotation is that by the opposite angle
        self._back = np.linalg.inv(_turning(middle, every, own, every))
        samples = _in_planes(shell, middle, pairs.patches, sampled, pairs.elements)
        self._patches = Patches.of(pairs, samples, complete_powers(2, degree))
        self._here = self._patches.at(every, _in_planes(shell, middle, every, own, every))

    def __call__(self, best: Array) -> Array:
        """Recovered stress (m, q, b) from the best one (m, g, b)."""
        b = best.shape[2]
        turned = np.einsum(
            "pgij,pgj->pgi", self._turned[..., :b, :b], best[self._patches.pairs.elements]
        )
        smooth = self._here @ self._patches.coefficients(turned)
        return np.asarray(np.einsum("mqij,mqj->mqi", self._back[..., :b, :b], smooth))


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
    at, _ = hermite.gauss(shell.model.formulation.points)
    best, _ = hermite.gauss(_BEST)
    to_best = hermite.lagrange(at, best)
    values = np.kron(to_best, to_best)
    recovered = _SurfacePatches(shell, hermite.products(at, at), hermite.products(best, best), 2)
    areas, compliance = _areas(shell), np.linalg.inv(stiffness)
    found = []
    for k in steps:
        own = term.strains(np.ascontiguousarray(result.frames[k][nodes])) @ stiffness
        found.append(StressFields(own, recovered(values @ own), areas, compliance))
    return found


def ancf_shell_fields(
    result: Result | StaticResult, shell: AncfShell, scene: Scene, steps: Sequence[int]
) -> list[StressFields]:
    """Stress of the cells and recovered stress in some states.

    Of a cell the mean is best, to which a plane is fitted.

    Raises:
        ValueError: The shell is not in that result.
    """
    model, nodes = shell.model, nodes_in(result.info, shell)
    term = model.assemble([model])
    at, w = hermite.gauss(3)
    points = hermite.products(at, at)
    stress, compliance = model.formulation.stress(
        model.hermite_vectors(), model.axes, model.stiffness, points
    )
    recovered = _SurfacePatches(shell, points, np.array([[0.5, 0.5]]), 1)
    areas, mean = _areas(shell), np.outer(w, w).ravel()
    found = []
    for k in steps:
        strains = term.strains(np.ascontiguousarray(result.frames[k][nodes]))
        own = np.einsum("mgas,ms->mga", stress, strains)
        best = np.einsum("g,mga->ma", mean, own)[:, np.newaxis]
        found.append(StressFields(own, recovered(best), areas, compliance))
    return found


def _areas(shell: ThinShell | AncfShell) -> Array:
    """Area of each quadrature point, shape (m, g)."""
    _, slopes, weights = shell.model.surface_rule()
    r1, r2 = np.einsum("gka,maj->kmgj", slopes, shell.model.hermite_vectors())
    return np.asarray(np.linalg.norm(np.cross(r1, r2), axis=-1) * weights)


def _points(shell: ThinShell | AncfShell, at: Array) -> _Points:
    table = type(shell.model).table(at)[:, : hermite.ACROSS + 1]
    positions, r1, r2 = np.einsum("gka,maj->kmgj", table, shell.model.hermite_vectors())
    n = np.cross(r1, r2)
    n /= np.linalg.norm(n, axis=-1, keepdims=True)
    return _Points(positions, _in_plane(shell.model.axes[:, np.newaxis], n), n)


def _in_plane(vectors: Array, normals: Array) -> Array:
    e = vectors - np.einsum("...j,...j->...", vectors, normals)[..., np.newaxis] * normals
    return np.asarray(e / np.linalg.norm(e, axis=-1, keepdims=True))


def _in_planes(
    shell: ThinShell | AncfShell, middle: _Points, cells: Indices, points: _Points, others: Indices
) -> Array:
    """Coordinates of points of other cells in the tangent planes of cells, shape (p, g, 2)."""
    first, normal = middle.first[cells, 0], middle.normals[cells, 0]
    axes = np.stack([first, np.cross(normal, first)], axis=-1)
    size = np.sqrt(shell.model.sizes[cells, :2].prod(axis=1))
    away = points.positions[others] - middle.positions[cells]
    return np.asarray(away @ axes / size[:, np.newaxis, np.newaxis])


def _turning(middle: _Points, cells: Indices, points: _Points, others: Indices) -> Array:
    """Rotation of components from sections' axes at points to axes of cells, (p, g, 9, 9)."""
    n = points.normals[others]
    e = points.first[others]
    f = _in_plane(middle.first[cells], n)
    # cosine and sine of the angle from e₁ of the section to e₁ of the cell
    c = np.einsum("pgj,pgj->pg", e, f)
    s = np.einsum("pgj,pgj->pg", np.cross(e, f), n)
    found = np.zeros((*c.shape, _COMPONENTS, _COMPONENTS))
    plane = np.array(
        [[c * c, s * s, 2 * s * c], [s * s, c * c, -2 * s * c], [-s * c, s * c, c * c - s * s]]
    ).transpose(2, 3, 0, 1)
    found[..., :3, :3] = found[..., 3:6, 3:6] = plane
    found[..., 6:8, 6:8] = np.array([[c, s], [-s, c]]).transpose(2, 3, 0, 1)
    found[..., 8, 8] = 1.0
    return found
