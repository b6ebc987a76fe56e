"""Fully parametrised plate: positions and three position gradients at four corners.

A cell has 44 strains, two more than motions that are not rigid, all products of vectors at its
corners, the middles of its edges and its own:

- ``E₁₁`` and the shear ``γ₁ = r₁·d`` at both ends and in the middle of the edges along ξ, ``E₂₂``
  and ``γ₂`` likewise along η; ``2 E₁₂`` at all nine places,
- ``κ₁₁ = r₁·d₁`` of each edge along ξ, four thirds of its middle less a third of the mean of its
  ends, which is right on arcs; ``κ₂₂`` likewise; ``2 κ₁₂`` in the middle,
- ``E₃₃ = ½ d·d − ½`` at the corners, and ``E₁₁``, ``E₂₂`` in the middle,

with ``d`` the slope across the thickness. Edges are as the beam of :mod:`.strains`, and for the
same reason nothing locks that bends without stretch, shear and thickness. Fields of these strains
within the cell are quadratic along, linear across, that of ``2 E₁₂`` quadratic in both. Of what
``E₁₁`` and ``E₂₂`` in the middle are more than at the edges beside it a small share counts, without
which corners that turn in the surface to and fro would meet no stiffness. (Where less of ``2 E₁₂``
is taken, at 2×2 Gauss points, curved shells lock less on coarse meshes, but thick strips that bend
within their surface are too soft by some hundredths.)

The section's stiffness (8, 8) is that of :class:`~fem_lie.ShellSection`, laminates included:
stress across the thickness is nil, and ``E₃₃`` has a stiffness of its own (no Poisson locking). The
mean shear of an edge has MacNeal's residual bending flexibility, ``1/G + h²/12D``, without which
linear moments would need twice the cells.

Interpolation of the plate of places and three slopes: surfaces between cubic edges.

At each corner, (0, 0), (1, 0), (0, 1), (1, 1), are the place, its derivatives along ξ and η, and
the slope across the thickness. Edges are cubics of places and slopes, what is between them is
blended linearly (S. A. Coons 1967; the polynomials are those of A. Adini & R. W. Clough 1960), so
that neighbours fit. The slope across the thickness is bilinear.

Strains of the plate of places and three slopes, and the compiled functions of its cells.

Strains are sums of products of vectors, the energy is ``½ ε·C ε`` of those less the strains of the
unloaded cell, with the ``C`` of :mod:`.plate`. Nodes are those of thin shells, with the slope
across the thickness where these have the mixed derivative.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, number
from fem_lie._jit import callback
from fem_lie.elements.thin_shells.rows import COORDINATES, CORNERS
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
"""Derivatives in a table: none, ξ, η."""

_H = np.array([[1.0, 0, -3, 2], [0, 1, -2, 1], [0, 0, 3, -2], [0, 0, -1, 1]])
_L = np.array([[1.0, -1, 0, 0], [0, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 0]])
"""By powers: place and slope of the first end, then of the second; cubics, and lines."""


def table(points: Array) -> Array:
    """Values and derivatives of the place at points (g, 2), shape (g, 3, 16).

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
    """The same of the slope across the thickness."""
    found = np.zeros((len(points), 3, 4, 4))
    for k, orders in enumerate(((0, 0), (1, 0), (0, 1))):
        lx, ly = (_at(_L, points[:, j], orders[j]) for j in range(2))
        for corner in range(4):
            found[:, k, corner, 3] = lx[2 * (corner % 2)] * ly[2 * (corner // 2)]
    return found.reshape(-1, 3, 16)


def _at(powers: Array, x: Array, order: int) -> Array:
    """Derivatives of polynomials at places (g,), shape (4, g)."""
    return np.stack([np.polynomial.Polynomial(c).deriv(order)(x) for c in powers])


GRID = np.array([0.0, 0.5, 1.0])
STRAINS = 44


class _Places(NamedTuple):
    """Where strains begin: membrane at two edges of three places, shear likewise, nine of 2 E₁₂."""

    E11: int = 0
    E22: int = 6
    E12: int = 12
    S1: int = 21
    S2: int = 27


E = _Places()
K11, K22, K12, E33, MIDDLE = 33, 35, 37, 38, 42

_R1, _R2, _D, _D1, _D2 = 0, 9, 18, 27, 36
"""Vectors at nine places, the second parameter runs first: slopes, director and its slopes."""
_POINT_VECTORS = 45


def _interpolation() -> Array:
    """The 45 vectors of those of the interpolation, shape (45, 16)."""
    at = hermite.products(GRID, GRID)
    places, across = table(at), directors(at)
    parts = places[:, 1], places[:, 2], across[:, 0], across[:, 1], across[:, 2]
    return np.concatenate(parts)


def _edge(k: int, side: int, place: int) -> int:
    """Number in the grid of a place on an edge along ``k``."""
    i, j = (place, 2 * side) if k == 0 else (2 * side, place)
    return 3 * i + j


def _terms() -> Array:
    """Strain, both vectors and the factor of each product, shape (t, 4)."""
    found: list[tuple[float, ...]] = []
    for k, (r, d, membrane, shear, bent) in enumerate(
        ((_R1, _D1, E.E11, E.S1, K11), (_R2, _D2, E.E22, E.S2, K22))
    ):
        for side in range(2):
            for place, share in enumerate((-1 / 6, 4 / 3, -1 / 6)):
                at, number = _edge(k, side, place), 3 * side + place
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


def data(q: Array, extraction: Array, C: Array) -> Array:
    """Data of cells.

    Args:
        q: Vectors of the interpolation, unloaded, shape (m, 16, 3).
        extraction: These of the coordinate vectors of nodes, shape (m, 16, 16).
        C: Of the cells, shape (m, 44, 44).
    """
    T = (_INTERPOLATION @ extraction)[:, np.newaxis, :, COORDINATES]
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
    """The element of :class:`~fem_lie.AncfShell`.

    Attributes:
        bending_flexibility: Whether mean shear has the residual bending flexibility.
        share: How much counts of the energy of ``E₁₁`` and ``E₂₂`` in the middle beside that at the
            edges, between 0 and 1.

    Raises:
        ValueError: The share is not between 0 and 1.
    """

    bending_flexibility: bool = True
    share: float = 0.02

    def __post_init__(self) -> None:
        """Check the share."""
        if not 0.0 <= number(self.share, "AncfPlate: share") <= 1.0:
            raise ValueError(f"the share must lie between 0 and 1, got {self.share!r}")

    def stiffness(self, q: Array, along: Array, D: Array) -> Array:
        """``C`` of cells, shape (m, 44, 44).

        Args:
            q: Vectors of the interpolation, unloaded, shape (m, 16, 3).
            along: Vector of each cell whose projection onto the surface is e₁, shape (m, 3).
            D: Section stiffness, shape (m, 8, 8).
        """
        x, w = hermite.gauss(_POINTS)
        at, weights = hermite.products(x, x), np.outer(w, w).ravel()
        fields, mean = _fields(at, float(np.sqrt(self.share))), _mean_shear(at)
        T, areas = _to_axes(np.einsum("gka,maj->mgkj", table(at)[:, 1:], q), along)
        across = 0.5 * (D[:, 0, 0] + D[:, 1, 1])
        local = np.einsum("mgia,mij,mgjb->mgab", T, D, T)
        local *= (areas * weights)[..., np.newaxis, np.newaxis]
        thick = (areas * weights) * across[:, np.newaxis]
        G = local[..., _SHEAR, _SHEAR].copy()
        softer = G
        if self.bending_flexibility:
            bending = np.einsum("mgii->mgi", local[..., _BENDING, _BENDING])[..., :2]
            flexible = np.linalg.inv(G)
            flexible[..., [0, 1], [0, 1]] += 1.0 / (12.0 * bending)
            softer = np.linalg.inv(flexible)
        local[..., _SHEAR, _SHEAR] = 0.0
        C = np.einsum("gs,mg,gt->mst", fields[:, 8], thick, fields[:, 8], optimize=True)
        for field, moduli in (
            (fields[:, :8], local),
            (fields[:, _SHEAR] - mean, G),
            (mean, softer),
        ):
            C += np.einsum("gas,mgab,gbt->mst", field, moduli, field, optimize=True)
        return np.asarray(0.5 * (C + C.swapaxes(1, 2)))

    def surface_rule(self) -> tuple[Array, Array, Array]:
        """Values (g, 16), slopes (g, 2, 16) and weights (g,) for integrals over a cell."""
        x, w = hermite.gauss(_POINTS)
        found = table(hermite.products(x, x))
        return found[:, 0], found[:, 1:], np.asarray(np.outer(w, w)).ravel()

    def inertia(self, q: Array, density: Array) -> Array:
        """``∫ (ρ₀₀ r r + ρ₀₁ (r d + d r) + ρ₁₁ d d) dA`` of the vectors, shape (m, 16, 16).

        Args:
            q: Vectors of the interpolation, unloaded, shape (m, 16, 3).
            density: Mass matrix of (r, d) per area, shape (m, 2, 2).
        """
        x, w = hermite.gauss(_POINTS + 1)
        at = hermite.products(x, x)
        shapes = table(at)
        r1, r2 = (np.einsum("ga,maj->mgj", shapes[:, k], q) for k in (1, 2))
        areas = np.linalg.norm(np.cross(r1, r2), axis=-1) * np.outer(w, w).ravel()
        both = np.stack([shapes[:, 0], directors(at)[:, 0]])
        return np.einsum("mg,iga,mij,jgb->mab", areas, both, density, both, optimize=True)


def _fields(at: Array, share: float) -> Array:
    """All strains at places (g, 2) of the sampled ones, shape (g, 9, 44)."""
    found = np.zeros((len(at), 9, STRAINS))
    ξ, η = at.T
    quadratic = [hermite.lagrange(GRID, t) for t in (ξ, η)]
    linear = [np.stack([1 - t, t], axis=1) for t in (ξ, η)]
    for k, (first, shear) in enumerate(((E.E11, E.S1), (E.E22, E.S2))):
        # samples: both edges, and three places on each
        values = np.einsum("gs,ge->ges", quadratic[k], linear[1 - k]).reshape(-1, 6)
        found[:, k, first : first + 6] = values
        found[:, 6 + k, shear : shear + 6] = values
        # what is in the middle, and not on the edges: a share of the bubble over their mean
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
    """Means along the edges, linear between them, shape (g, 2, 44)."""
    found = np.zeros((len(at), 2, STRAINS))
    for k, first in enumerate((E.S1, E.S2)):
        t = at[:, 1 - k]
        edges = np.stack([1 - t, t], axis=1)
        found[:, k, first : first + 6] = np.einsum("ge,s->ges", edges, _SIMPSON).reshape(-1, 6)
    return found


def _to_axes(slopes: Array, along: Array) -> tuple[Array, Array]:
    """From covariant strains to those along the section's axes (m, g, 8, 8), and areas (m, g)."""
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
