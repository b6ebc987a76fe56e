"""Thin-shell element of bicubic Hermite patches: assumed strains and geometry.

It has four corners with twelve unknowns each: position, two gradients and the mixed derivative, so
that the surface is continuously differentiable across cells. There is no transverse shear: the
director is the normal. Membrane strains of such an element cannot vanish in a thin shell that
bends, except at the points of certain sets; they are sampled there and interpolated. ``E₁₁``: three
Lobatto points along ξ, two of which are nodes, as in :mod:`fem_lie.elements.rods.cable`, on four
lines through Gauss points; ``E₂₂`` likewise along η; ``2 E₁₂``: 2×2 Gauss points.

A free cell then has two zero-energy modes besides the six rigid ones. A small fraction of the
strains at the quadrature points themselves gives them stiffness, with hardly more locking. With 3×3
points for ``2 E₁₂`` there are no such modes, and three times the error where a radius is a thousand
thicknesses; with three lines instead of four there are three modes.

The energy is that of W. T. Koiter; on assumed strains: E. N. Dvorkin & K.-J. Bathe, *Eng. Comput.*
1 (1984) 77. Derivatives are hand-written: in UFL they would be in 48 coordinates of each cell, 2304
entries of a matrix whose compilation takes minutes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_lie._arrays import Array, number
from fem_lie.elements.thin_shells.cell_tables import Rule
from fem_lie.mesh.bicubic import hermite


@dataclass(frozen=True)
class BicubicHermite:
    """Bicubic Hermite element of thin shells.

    Attributes:
        share: Fraction of the membrane strains at the quadrature points themselves, not assumed,
            between 0 and 1.
        across: Gauss points across of the sets of ``E₁₁`` and ``E₂₂``.
        shear: Gauss points of the set of ``2 E₁₂`` per direction.
        points: Gauss quadrature points per direction.

    Raises:
        ValueError: ``share`` is not between 0 and 1, or a number of points is too small for the
            cubics.
    """

    share: float = 0.02
    across: int = 4
    shear: int = 2
    points: int = 4

    def __post_init__(self) -> None:
        """Check the options."""
        if not 0.0 <= number(self.share, "BicubicHermite: share") <= 1.0:
            raise ValueError(f"the share must lie between 0 and 1, got {self.share!r}")
        for name, least in (("across", 3), ("shear", 2), ("points", 3)):
            if not getattr(self, name) >= least:
                raise ValueError(
                    f"BicubicHermite: {name} must be at least {least}, got {getattr(self, name)!r}"
                )

    def rule(self) -> Rule:
        """Tables for all cells."""
        three, lines = hermite.lobatto(), hermite.gauss(self.across)[0]
        plain, (inner, _) = hermite.gauss(self.shear)[0], hermite.gauss(self.points)
        sets = (three, lines), (lines, three), (plain, plain)
        at = hermite.products(inner, inner)
        spread = [
            np.einsum(
                "ga,gb->gab", hermite.lagrange(x, at[:, 0]), hermite.lagrange(y, at[:, 1])
            ).reshape(len(at), -1)
            for x, y in sets
        ]
        first, second, third = (hermite.table(hermite.products(x, y)) for x, y in sets)
        found = [
            first[:, hermite.ALONG],
            second[:, hermite.ACROSS],
            *third[:, hermite.ALONG : hermite.ACROSS + 1].swapaxes(0, 1),
            *hermite.table(at)[:, hermite.ALONG :].swapaxes(0, 1),
        ]
        table = np.concatenate(found)
        columns = [np.ascontiguousarray(part.T) for part in (table, *spread)]
        return Rule(
            counts=(len(first), len(second), len(third), len(at)),
            share=float(self.share),
            table=table,
            columns=columns[0],
            spread=(spread[0], spread[1], spread[2]),
            spread_columns=(columns[1], columns[2], columns[3]),
        )

    def surface_rule(self, more: int = 0) -> tuple[Array, Array, Array]:
        """Values (g, 16), slopes (g, 2, 16) and weights (g,) of a quadrature rule over a cell.

        Args:
            more: Points per direction in addition to those of the energy.
        """
        x, w = hermite.gauss(self.points + more)
        found = hermite.table(hermite.products(x, x))
        slopes = found[:, hermite.ALONG : hermite.ACROSS + 1]
        return found[:, hermite.VALUE], slopes, np.asarray(np.outer(w, w)).ravel()

    def weights(self) -> Array:
        """Quadrature weights on the unit square, shape (g,)."""
        _, w = hermite.gauss(self.points)
        return np.asarray(np.outer(w, w)).ravel()


def unloaded(rule: Rule, q: Array) -> tuple[Array, Array, Array]:
    """Strains of unloaded cells, and derivatives at the points.

    Args:
        rule: Tables of the element.
        q: Hermite vectors, shape (m, 16, 3).

    Returns:
        Membrane strains at the samples (m, s), all strains at the points (m, g, 6), and ``z``
        there, (m, g, 5, 3).
    """
    n1, n2, n3, points = rule.counts
    ends = np.cumsum([n1, n2, n3, n3])
    first, second, *both, d = np.split(np.einsum("ra,maj->mrj", rule.table, q), ends, axis=1)
    sampled = [0.5 * (first**2).sum(-1), 0.5 * (second**2).sum(-1), (both[0] * both[1]).sum(-1)]
    z = d.reshape(len(q), 5, points, 3).swapaxes(1, 2)
    r1, r2 = z[:, :, 0], z[:, :, 1]
    n = np.cross(r1, r2)
    n /= np.linalg.norm(n, axis=-1, keepdims=True)
    bent = -np.einsum("mgkj,mgj->mgk", z[:, :, 2:], n) * [1.0, 1.0, 2.0]
    plane = np.stack([0.5 * (r1**2).sum(-1), 0.5 * (r2**2).sum(-1), (r1 * r2).sum(-1)], axis=-1)
    return np.concatenate(sampled, axis=1), np.concatenate([plane, bent], axis=-1), z


def to_axes(z: Array, along: Array) -> tuple[Array, Array]:
    """Transformation of covariant strains to the section axes.

    Args:
        z: Derivatives of the unloaded position, shape (m, g, 5, 3).
        along: Vector of each cell whose projection onto the surface is e₁, shape (m, 3).

    Returns:
        ``T`` with the six strains along the axes ``T ε``, (m, g, 6, 6), and areas (m, g).
    """
    r1, r2 = z[:, :, 0], z[:, :, 1]
    m = np.cross(r1, r2)
    area = np.linalg.norm(m, axis=-1)
    n = m / area[..., np.newaxis]
    e1 = along[:, np.newaxis] - np.einsum("mj,mgj->mg", along, n)[..., np.newaxis] * n
    e1 /= np.linalg.norm(e1, axis=-1, keepdims=True)
    e2 = np.cross(n, e1)
    J = np.einsum("kmgj,amgj->mgka", np.stack([e1, e2]), np.stack([r1, r2]))
    (a, b), (c, d) = np.linalg.inv(J).transpose(2, 3, 0, 1)  # rows are parameters
    # ε_ij = ε_αβ (J⁻¹)_αi (J⁻¹)_βj, with twice the mixed one as third
    plane = np.array(
        [[a * a, c * c, a * c], [b * b, d * d, b * d], [2 * a * b, 2 * c * d, a * d + b * c]]
    ).transpose(2, 3, 0, 1)
    T = np.zeros((*area.shape, 6, 6))
    T[..., :3, :3] = T[..., 3:, 3:] = plane
    return T, area
