r"""Fully parametrised plate: places and all three slopes at four corners; its law and inertia.

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
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_lie._arrays import Array, number
from fem_lie.elements.gradients import coons
from fem_lie.elements.gradients.plate_strains import E33, GRID, K11, K12, K22, MIDDLE, STRAINS, E
from fem_lie.elements.thin_shells import hermite

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
        T, areas = _to_axes(np.einsum("gka,maj->mgkj", coons.table(at)[:, 1:], q), along)
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
        found = coons.table(hermite.products(x, x))
        return found[:, 0], found[:, 1:], np.asarray(np.outer(w, w)).ravel()

    def inertia(self, q: Array, density: Array) -> Array:
        """``∫ (ρ₀₀ r r + ρ₀₁ (r d + d r) + ρ₁₁ d d) dA`` of the vectors, shape (m, 16, 16).

        Args:
            q: Vectors of the interpolation, unloaded, shape (m, 16, 3).
            density: Gram matrix of (r, d) per area, shape (m, 2, 2).
        """
        x, w = hermite.gauss(_POINTS + 1)
        at = hermite.products(x, x)
        shapes = coons.table(at)
        r1, r2 = (np.einsum("ga,maj->mgj", shapes[:, k], q) for k in (1, 2))
        areas = np.linalg.norm(np.cross(r1, r2), axis=-1) * np.outer(w, w).ravel()
        both = np.stack([shapes[:, 0], coons.directors(at)[:, 0]])
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
