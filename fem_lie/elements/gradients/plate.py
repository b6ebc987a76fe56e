"""Fully parametrised ANCF plate: positions and three position gradients at four corners.

Nodal vectors at each corner, (0, 0), (1, 0), (0, 1), (1, 1), are the position, its derivatives
along ξ and η, and the gradient ``d`` across the thickness. Edges are the cubics through positions
and gradients; the surface between them is blended linearly (S. A. Coons 1967; the polynomials are
those of A. Adini & R. W. Clough 1960), so that it is continuous across cells. The gradient across
the thickness is bilinear.

A cell has 44 strains, two more than deformation modes, all products of vectors at its corners, the
midpoints of its edges and its centre:

- ``E₁₁`` and the shear ``γ₁ = r₁·d`` at both ends and at the midpoint of the edges along ξ, ``E₂₂``
  and ``γ₂`` likewise along η; ``2 E₁₂`` at all nine points,
- ``κ₁₁ = r₁·d₁`` of each edge along ξ, four thirds of its midpoint value less a third of the mean
  of its ends, which is accurate on arcs; ``κ₂₂`` likewise; ``2 κ₁₂`` at the centre,
- ``E₃₃ = ½ d·d − ½`` at the corners, and ``E₁₁``, ``E₂₂`` at the centre.

The strains of the unloaded cell are subtracted, and the energy is ``½ ε·C ε``. Edges are like the
beam of :mod:`.ancf`, and the element does not lock for the same reason. Fields of these strains
within the cell are quadratic along, linear across; that of ``2 E₁₂`` is quadratic in both
directions. The difference of ``E₁₁`` and ``E₂₂`` at the centre from the adjacent edges has a small
fraction of the stiffness, without which alternating in-plane rotations of corners would have no
energy. (With ``2 E₁₂`` at 2×2 Gauss points, curved shells lock less on coarse meshes, but thick
strips in in-plane bending are a few per cent too soft.)

The section stiffness (8, 8) is that of :class:`~fem_lie.ShellSection`, laminates included: the
stress across the thickness is zero, and ``E₃₃`` has its own stiffness (no Poisson locking). The
mean shear of an edge has MacNeal's residual bending flexibility, ``1/G + h²/12D``, without which
linear moments would need twice as many cells.

Nodes are those of thin shells, with the gradient across the thickness in place of the mixed
derivative.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, number
from fem_lie._jit import callback
from fem_lie.elements.thin_shells.nodal_coordinates import COORDINATES, CORNERS
from fem_lie.forms.kernels.addresses import Pointer
from fem_lie.forms.small_energy.assembly import CellFunctions
from fem_lie.forms.small_energy.cell import (
    add_energy,
    add_forces,
    add_tangent_at_stress,
    update_stress,
)
from fem_lie.forms.small_energy.element import CELL_SIGNATURE, data_at_rest, element
from fem_lie.lie.node_types.node_type import NodeType
from fem_lie.mesh.bicubic import hermite

VALUE, ALONG, ACROSS = range(3)
"""Indices of a table: value, and derivatives in ξ and η."""

_H = np.array([[1.0, 0, -3, 2], [0, 1, -2, 1], [0, 0, 3, -2], [0, 0, -1, 1]])
_L = np.array([[1.0, -1, 0, 0], [0, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 0]])
"""Coefficients by powers: value and slope of the first end, then the second; cubic, linear."""


def table(points: Array) -> Array:
    """Shape functions of the position and derivatives at points (g, 2), shape (g, 3, 16).

    Args:
        points: Points in reference coordinates, shape (g, 2).
    """
    found = np.zeros((len(points), 3, 4, 4))
    for k, orders in enumerate(((0, 0), (1, 0), (0, 1))):
        (hx, lx), (hy, ly) = (
            (_at(_H, points[:, j], orders[j]), _at(_L, points[:, j], orders[j])) for j in range(2)
        )
        for corner in range(4):
            a, b = 2 * (corner % 2), 2 * (corner // 2)
            found[:, k, corner, 0] = hx[a] * ly[b] + lx[a] * hy[b] - lx[a] * ly[b]
            found[:, k, corner, 1] = hx[a + 1] * ly[b]
            found[:, k, corner, 2] = lx[a] * hy[b + 1]
    return found.reshape(-1, 3, 16)


def directors(points: Array) -> Array:
    """Shape functions of the gradient across the thickness, and derivatives."""
    found = np.zeros((len(points), 3, 4, 4))
    for k, orders in enumerate(((0, 0), (1, 0), (0, 1))):
        lx, ly = (_at(_L, points[:, j], orders[j]) for j in range(2))
        for corner in range(4):
            found[:, k, corner, 3] = lx[2 * (corner % 2)] * ly[2 * (corner // 2)]
    return found.reshape(-1, 3, 16)


def _at(powers: Array, x: Array, order: int) -> Array:
    """Derivatives of polynomials at points (g,), shape (4, g)."""
    return np.stack([np.polynomial.Polynomial(c).deriv(order)(x) for c in powers])


GRID = np.array([0.0, 0.5, 1.0])
STRAINS = 44


class _Places(NamedTuple):
    """Offsets of strains: membrane at two edges of three points, shear, nine of 2 E₁₂."""

    E11: int = 0
    E22: int = 6
    E12: int = 12
    S1: int = 21
    S2: int = 27


E = _Places()
K11, K22, K12, E33, MIDDLE = 33, 35, 37, 38, 42

_R1, _R2, _D, _D1, _D2 = 0, 9, 18, 27, 36
"""Vectors at nine points, the second parameter first: tangents, director and its derivatives."""
_POINT_VECTORS = 45


def _interpolation() -> Array:
    """45 vectors from those of the interpolation, shape (45, 16)."""
    at = hermite.products(GRID, GRID)
    positions, across = table(at), directors(at)
    parts = positions[:, 1], positions[:, 2], across[:, 0], across[:, 1], across[:, 2]
    return np.concatenate(parts)


def _edge(k: int, side: int, point: int) -> int:
    """Index in the grid of a point on an edge along ``k``."""
    i, j = (point, 2 * side) if k == 0 else (2 * side, point)
    return 3 * i + j


def _terms() -> Array:
    """Strain, both vectors and the factor of each product, shape (t, 4)."""
    found: list[tuple[float, ...]] = []
    for k, (r, d, membrane, shear, bent) in enumerate(
        ((_R1, _D1, E.E11, E.S1, K11), (_R2, _D2, E.E22, E.S2, K22))
    ):
        for side in range(2):
            for point, share in enumerate((-1 / 6, 4 / 3, -1 / 6)):
                at, number = _edge(k, side, point), 3 * side + point
                found.append((membrane + number, r + at, r + at, 0.5))
                found.append((shear + number, r + at, _D + at, 1.0))
                found.append((bent + side, r + at, d + at, share))
    for at in range(9):
        found.append((E.E12 + at, _R1 + at, _R2 + at, 1.0))
    found += [(MIDDLE, _R1 + 4, _R1 + 4, 0.5), (MIDDLE + 1, _R2 + 4, _R2 + 4, 0.5)]
    found += [(K12, _R1 + 4, _D2 + 4, 1.0), (K12, _R2 + 4, _D1 + 4, 1.0)]
    for corner, at in enumerate((0, 6, 2, 8)):
        found.append((E33 + corner, _D + at, _D + at, 0.5))
    return np.array(found)


_INTERPOLATION, _TERMS = _interpolation(), _terms()
ELEMENT = element(
    [NodeType.SURFACE_GRADIENT] * CORNERS + [NodeType.MIXED_DERIVATIVE] * CORNERS,
    _TERMS,
    vectors=_POINT_VECTORS,
    strains=STRAINS,
)


def data(q: Array, hermite_matrices: Array, C: Array) -> Array:
    """Data of cells.

    Args:
        q: Unloaded vectors of the interpolation, shape (m, 16, 3).
        hermite_matrices: Matrices to them from the coordinate vectors of nodes, shape (m, 16, 16).
        C: Stiffness on the strains of each cell, shape (m, 44, 44).
    """
    T = (_INTERPOLATION @ hermite_matrices)[:, np.newaxis, :, COORDINATES]
    return data_at_rest(ELEMENT, T, (_INTERPOLATION @ q)[:, np.newaxis], C[:, np.newaxis])


@callback(CELL_SIGNATURE)
def energy_of_cell(A: Pointer, w: Pointer, h: Pointer) -> None:
    """Energy of a cell."""
    add_energy(ELEMENT, A, w)


@callback(CELL_SIGNATURE)
def forces_of_cell(A: Pointer, w: Pointer, h: Pointer) -> None:
    """Forces of a cell."""
    add_forces(ELEMENT, A, w)


@callback(CELL_SIGNATURE)
def tangent_of_cell(A: Pointer, w: Pointer, h: Pointer) -> None:
    """Tangent stiffness of a cell."""
    add_tangent_at_stress(ELEMENT, A, w)


@callback(CELL_SIGNATURE)
def stress_of_cell(A: Pointer, w: Pointer, h: Pointer) -> None:
    """Linearised stress of a cell."""
    update_stress(ELEMENT, A, w, h)


FUNCTIONS = CellFunctions(energy_of_cell, forces_of_cell, tangent_of_cell, stress_of_cell)

_POINTS = 3
_SIMPSON = np.array([1.0, 4.0, 1.0]) / 6
_MEMBRANE, _BENDING, _SHEAR = slice(0, 3), slice(3, 6), slice(6, 8)


@dataclass(frozen=True)
class AncfPlate:
    """Finite element of :class:`~fem_lie.AncfShell`.

    Attributes:
        bending_flexibility: Whether mean shear has the residual bending flexibility.
        share: Fraction of the energy of ``E₁₁`` and ``E₂₂`` at the centre relative to the edges,
            between 0 and 1.

    Raises:
        ValueError: ``share`` is not between 0 and 1.
    """

    bending_flexibility: bool = True
    share: float = 0.02

    def __post_init__(self) -> None:
        """Check the fraction."""
        if not 0.0 <= number(self.share, "AncfPlate: share") <= 1.0:
            raise ValueError(f"the share must lie between 0 and 1, got {self.share!r}")

    def stiffness(self, q: Array, along: Array, D: Array) -> Array:
        """Stiffness ``C`` of cells on their strains, shape (m, 44, 44).

        Args:
            q: Unloaded vectors of the interpolation, shape (m, 16, 3).
            along: Vector of each cell whose projection onto the surface is e₁, shape (m, 3).
            D: Section stiffness, shape (m, 8, 8).
        """
        x, w = hermite.gauss(_POINTS)
        at, weights = hermite.products(x, x), np.outer(w, w).ravel()
        fields, mean = _fields(at, float(np.sqrt(self.share))), _mean_shear(at)
        T, areas = _to_axes(np.einsum("gka,maj->mgkj", table(at)[:, 1:], q), along)
        local, G, softer = (
            moduli * (areas * weights)[..., np.newaxis, np.newaxis] for moduli in self._moduli(T, D)
        )
        thick = (areas * weights) * _across(D)[:, np.newaxis]
        C = np.einsum("gs,mg,gt->mst", fields[:, 8], thick, fields[:, 8], optimize=True)
        for field, moduli in (
            (fields[:, :8], local),
            (fields[:, _SHEAR] - mean, G),
            (mean, softer),
        ):
            C += np.einsum("gas,mgab,gbt->mst", field, moduli, field, optimize=True)
        return np.asarray(0.5 * (C + C.swapaxes(1, 2)))

    def _moduli(self, T: Array, D: Array) -> tuple[Array, Array, Array]:
        """Moduli of covariant strains without shear, of shear, and of mean shear, per area."""
        local = np.einsum("mgia,mij,mgjb->mgab", T, D, T)
        G = local[..., _SHEAR, _SHEAR].copy()
        local[..., _SHEAR, _SHEAR] = 0.0
        if not self.bending_flexibility:
            return local, G, G
        bending = np.einsum("mgii->mgi", local[..., _BENDING, _BENDING])[..., :2]
        flexible = np.linalg.inv(G)
        flexible[..., [0, 1], [0, 1]] += 1.0 / (12.0 * bending)
        return local, G, np.linalg.inv(flexible)

    def stress(self, q: Array, along: Array, D: Array, at: Array) -> tuple[Array, Array]:
        """Stress at points of cells as a function of their strains, and its compliance.

        The nine components are the resultants along the section axes, and the force across the
        thickness; the strains at the centres do not contribute.

        Args:
            q: Unloaded vectors of the interpolation, shape (m, 16, 3).
            along: Vector of each cell whose projection onto the surface is e₁, shape (m, 3).
            D: Section stiffness, shape (m, 8, 8).
            at: Reference points, shape (g, 2).

        Returns:
            Matrices, shape (m, g, 9, 44), and compliance, shape (m, 9, 9).
        """
        fields, mean, across = _fields(at, 0.0), _mean_shear(at), _across(D)
        T, _ = _to_axes(np.einsum("gka,maj->mgkj", table(at)[:, 1:], q), along)
        local, G, softer = self._moduli(T, D)
        covariant = np.einsum("mgab,gbs->mgas", local, fields[:, :8])
        covariant[..., _SHEAR, :] = G @ (fields[:, _SHEAR] - mean) + softer @ mean
        found = np.empty((*covariant.shape[:2], 9, STRAINS))
        found[..., :8, :] = np.linalg.solve(T.swapaxes(-1, -2), covariant)
        found[..., 8, :] = across[:, np.newaxis, np.newaxis] * fields[:, 8]
        compliance = np.zeros((len(D), 9, 9))
        compliance[:, :8, :8], compliance[:, 8, 8] = np.linalg.inv(D), 1 / across
        return found, compliance

    def surface_rule(self) -> tuple[Array, Array, Array]:
        """Values (g, 16), slopes (g, 2, 16) and weights (g,) of a quadrature rule over a cell."""
        x, w = hermite.gauss(_POINTS)
        found = table(hermite.products(x, x))
        return found[:, 0], found[:, 1:], np.asarray(np.outer(w, w)).ravel()

    def inertia(self, q: Array, density: Array) -> Array:
        """Mass matrix ``∫ (ρ₀₀ r r + ρ₀₁ (r d + d r) + ρ₁₁ d d) dA``, shape (m, 16, 16).

        Args:
            q: Unloaded vectors of the interpolation, shape (m, 16, 3).
            density: Mass matrix of (r, d) per area, shape (m, 2, 2).
        """
        x, w = hermite.gauss(_POINTS + 1)
        at = hermite.products(x, x)
        shapes = table(at)
        r1, r2 = (np.einsum("ga,maj->mgj", shapes[:, k], q) for k in (1, 2))
        areas = np.linalg.norm(np.cross(r1, r2), axis=-1) * np.outer(w, w).ravel()
        both = np.stack([shapes[:, 0], directors(at)[:, 0]])
        return np.einsum("mg,iga,mij,jgb->mab", areas, both, density, both, optimize=True)


def _across(D: Array) -> Array:
    """Stiffness across the thickness, shape (m,)."""
    return np.asarray(0.5 * (D[:, 0, 0] + D[:, 1, 1]))


def _fields(at: Array, share: float) -> Array:
    """Strain fields at points (g, 2) from the sampled strains, shape (g, 9, 44)."""
    found = np.zeros((len(at), 9, STRAINS))
    ξ, η = at.T
    quadratic = [hermite.lagrange(GRID, t) for t in (ξ, η)]
    linear = [np.stack([1 - t, t], axis=1) for t in (ξ, η)]
    for k, (first, shear) in enumerate(((E.E11, E.S1), (E.E22, E.S2))):
        # samples: both edges, and three points on each
        values = np.einsum("gs,ge->ges", quadratic[k], linear[1 - k]).reshape(-1, 6)
        found[:, k, first : first + 6] = values
        found[:, 6 + k, shear : shear + 6] = values
        # at the centre: a fraction of the bubble over the mean of the edges
        bubble = share * 4 * linear[1 - k].prod(axis=1)
        found[:, k, MIDDLE + k] = bubble
        found[:, k, [first + 1, first + 4]] -= 0.5 * bubble[:, np.newaxis]
        found[:, 3 + k, (K11, K22)[k] : (K11, K22)[k] + 2] = linear[1 - k]
    full = np.einsum("gi,gj->gij", *quadratic).reshape(-1, 9)
    found[:, 2, E.E12 : E.E12 + 9] = full
    found[:, 5, K12] = 1.0
    corners = np.stack([linear[0][:, a % 2] * linear[1][:, a // 2] for a in range(4)], axis=1)
    found[:, 8, E33 : E33 + 4] = corners
    return found


def _mean_shear(at: Array) -> Array:
    """Mean shear along the edges, linear between them, shape (g, 2, 44)."""
    found = np.zeros((len(at), 2, STRAINS))
    for k, first in enumerate((E.S1, E.S2)):
        t = at[:, 1 - k]
        edges = np.stack([1 - t, t], axis=1)
        found[:, k, first : first + 6] = np.einsum("ge,s->ges", edges, _SIMPSON).reshape(-1, 6)
    return found


def _to_axes(slopes: Array, along: Array) -> tuple[Array, Array]:
    """Transformation of covariant strains to section axes (m, g, 8, 8), and areas (m, g)."""
    r1, r2 = slopes[:, :, 0], slopes[:, :, 1]
    m = np.cross(r1, r2)
    areas = np.linalg.norm(m, axis=-1)
    n = m / areas[..., np.newaxis]
    e1 = along[:, np.newaxis] - np.einsum("mj,mgj->mg", along, n)[..., np.newaxis] * n
    e1 /= np.linalg.norm(e1, axis=-1, keepdims=True)
    J = np.einsum("kmgj,amgj->mgka", np.stack([e1, np.cross(n, e1)]), np.stack([r1, r2]))
    inverse = np.linalg.inv(J)
    (a, b), (c, d) = inverse.transpose(2, 3, 0, 1)
    T = np.zeros((*areas.shape, 8, 8))
    T[..., _MEMBRANE, _MEMBRANE] = T[..., _BENDING, _BENDING] = np.array(
        [[a * a, c * c, a * c], [b * b, d * d, b * d], [2 * a * b, 2 * c * d, a * d + b * c]]
    ).transpose(2, 3, 0, 1)
    T[..., _SHEAR, _SHEAR] = inverse.swapaxes(-1, -2)
    return T, areas
