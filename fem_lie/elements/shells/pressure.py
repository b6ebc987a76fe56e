"""Pressure on cells of shells and facets of solids, normal to the current surface.

On node i of a cell acts ``f_i = ∫ N_i p (x,₁ × x,₂) dξ`` with ``p = p₀ + g·x`` at the current
position. It is the gradient of ``∫ p dV`` if the surface closes a volume, or ends on fixed lines or
planes of symmetry; then the load stiffness is symmetric (K. Schweizerhof & E. Ramm, Comput. Struct.
18 (1984) 1099).
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined
from fem_lie.forms.term import Pairs, Term
from fem_lie.lie.motions import local_components
from fem_lie.lie.tuples import Vector, cross, load, load_row, minus, plus, scaled, store
from fem_lie.mesh.shapes import FaceRule


@inlined
def _sum(H: Array, nodes: Indices, factors: Array) -> Vector:
    """Interpolated position or tangent ``Σ factors_i x_i``."""
    total = (0.0, 0.0, 0.0)
    for i in range(nodes.shape[0]):
        total = plus(total, scaled(factors[i], load_row(H[nodes[i]], 0)))
    return total


@inlined
def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled
def _add_surface_forces(
    H: Array, cells: Indices, N: Array, dN: Array, w: Array, p: Array, amplitude: float, out: Array
) -> None:
    """Subtract the pressure forces from ``out`` (n, 6); ``p`` (c, 4) has p₀ and g of each cell."""
    for c in range(cells.shape[0]):
        nodes, gradient = cells[c], load(p[c], 1)
        for q in range(w.shape[0]):
            normal = cross(_sum(H, nodes, dN[0, q]), _sum(H, nodes, dN[1, q]))
            pressure = p[c, 0] + _dot(gradient, _sum(H, nodes, N[q]))
            push = scaled(amplitude * w[q] * pressure, normal)
            for i in range(nodes.shape[0]):
                f = scaled(N[q, i], local_components(H[nodes[i]], push))
                store(out[nodes[i]], 0, minus(load(out[nodes[i]], 0), f))


@compiled
def _surface_tangent(
    H: Array,
    cells: Indices,
    N: Array,
    dN: Array,
    w: Array,
    p: Array,
    amplitude: float,
    blocks: Array,
) -> None:
    """``blocks[c, i, j]`` (6, 6): derivative of the forces on node i in twists of node j."""
    blocks[:] = 0.0
    for c in range(cells.shape[0]):
        nodes, gradient = cells[c], load(p[c], 1)
        for q in range(w.shape[0]):
            g1, g2 = _sum(H, nodes, dN[0, q]), _sum(H, nodes, dN[1, q])
            normal, factor = cross(g1, g2), -amplitude * w[q]
            pressure = p[c, 0] + _dot(gradient, _sum(H, nodes, N[q]))
            for i in range(nodes.shape[0]):
                # the components rotate with the frame: δ(Rᵀ f) = (Rᵀ f) × η
                share = factor * pressure * N[q, i]
                n0, n1, n2 = scaled(share, local_components(H[nodes[i]], normal))
                block = blocks[c, i, i]
                block[0, 4] -= n2
                block[0, 5] += n1
                block[1, 3] += n2
                block[1, 5] -= n0
                block[2, 3] -= n1
                block[2, 4] += n0
            for j in range(nodes.shape[0]):
                # δ(x,₁ × x,₂) = δx × (N,₁ x,₂ − N,₂ x,₁)
                b = minus(scaled(dN[0, q, j], g2), scaled(dN[1, q, j], g1))
                for k in range(3):
                    e = load_row(H[nodes[j]], 1 + k)
                    turned = scaled(factor * pressure, cross(e, b))
                    risen = scaled(factor * N[q, j] * _dot(gradient, e), normal)
                    change = plus(turned, risen)
                    for i in range(nodes.shape[0]):
                        f = scaled(N[q, i], local_components(H[nodes[i]], change))
                        for a in range(3):
                            blocks[c, i, j, a, k] += f[a]


class SurfacePushes(Term):
    """Pressure on a surface of shell cells or solid facets, with its load stiffness."""

    label, load, of_bodies = "pressure on shells", True, True

    def __init__(self, cells: Indices, rule: FaceRule, pressure: Array) -> None:
        """Store the cells and the quadrature rule.

        Args:
            cells: Nodes of each cell, shape (m, k).
            rule: Quadrature rule of a cell.
            pressure: p₀ and gradient g of each cell, shape (m, 4).
        """
        self._faces = cells, rule.values, rule.slopes, rule.weights, pressure
        count = cells.shape[1]
        rows, columns = np.repeat(cells, count, axis=1).ravel(), np.tile(cells, (1, count)).ravel()
        self._coupled: Pairs = rows, columns
        self._blocks = np.empty((len(cells), count, count, 6, 6))

    @property
    def pairs(self) -> Pairs:
        """Node pairs of all cells."""
        return self._coupled

    @property
    def contents(self) -> tuple[Array | Indices, ...]:
        """Arrays on which the forces depend, for fingerprints."""
        return self._faces

    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """Subtract the pressure forces from ``out``."""
        _add_surface_forces(H, *self._faces, self.amplitude, out)

    def tangent(self, H: Array, kept: Array) -> Array:
        """Load stiffness, one block per node pair, shape (m k², 6, 6)."""
        _surface_tangent(H, *self._faces, self.amplitude, self._blocks)
        return self._blocks.reshape(-1, 6, 6)
