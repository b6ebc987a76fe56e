"""Pressure on thin shells: normal to the surface, per current area, with its load stiffness.

It has no energy in general, so that the small-energy kernel does not apply.
"""

from __future__ import annotations

import numba
import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import callback, compiled, inlined
from fem_lie._jit.stack import stack
from fem_lie.elements.thin_shells.nodal_coordinates import (
    NODES,
    SIZES,
    UNKNOWNS,
    VECTORS,
    gather,
    pull,
    pull_matrix,
)
from fem_lie.forms.cell_sums import CellSum, Pattern
from fem_lie.forms.kernels.addresses import UFCX_SIGNATURE, Pointer, shift
from fem_lie.forms.term import Pairs, Term
from fem_lie.lie.tuples import (
    Vector,
    cross,
    dot,
    load,
    minus,
    plus,
    scaled,
    store,
    store_row,
)

_ROWS, _PRESSURE = 12 * NODES, 4
_HEAD = 2
"""Number of constants before the tables: amplitude, and number of points."""


@inlined
def _sum(table: Array, q: Array) -> Vector:
    x = y = z = 0.0
    for a in range(VECTORS):
        x += table[a] * q[a, 0]
        y += table[a] * q[a, 1]
        z += table[a] * q[a, 2]
    return x, y, z


@inlined
def _parts(w: Pointer, c: Pointer) -> tuple[Array, Array, Array, Array]:
    """Coordinates, sizes, pressure, and tables of value, slopes and weight, (g, 49)."""
    coordinates, sizes = numba.carray(w, (NODES, 4, 3)), numba.carray(shift(w, _ROWS), (SIZES,))
    pressure = numba.carray(shift(w, _ROWS + SIZES), (_PRESSURE,))
    points = int(numba.carray(c, (_HEAD,))[1])
    return coordinates, sizes, pressure, numba.carray(shift(c, _HEAD), (points, 3 * VECTORS + 1))


@callback(UFCX_SIGNATURE)
def force_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Add the forces, with the sign of a residual."""
    coordinates, sizes, pressure, tables = _parts(w, c)
    q = numba.carray(stack(UNKNOWNS), (VECTORS, 3))
    f = numba.carray(stack(UNKNOWNS), (VECTORS, 3))
    gather(coordinates, sizes, q)
    f[:] = 0.0
    for g in range(tables.shape[0]):
        N, first, second = tables[g, :16], tables[g, 16:32], tables[g, 32:48]
        p = pressure[0] + dot(load(pressure, 1), _sum(N, q))
        push = scaled(-c[0] * tables[g, 48] * p, cross(_sum(first, q), _sum(second, q)))
        for a in range(VECTORS):
            store(f[a], 0, plus(load(f[a], 0), scaled(N[a], push)))
    pull(coordinates, sizes, f, numba.carray(A, (NODES, 6)))


@compiled
def _change(tables: Array, q: Array, pressure: Array, factor: float, change: Array) -> None:
    """Derivative of the force at a point in each component of ``q``, as rows, shape (48, 3)."""
    N, first, second = tables[:16], tables[16:32], tables[32:48]
    r1, r2, gradient = _sum(first, q), _sum(second, q), load(pressure, 1)
    normal = cross(r1, r2)
    p = pressure[0] + dot(gradient, _sum(N, q))
    for b in range(VECTORS):
        # δ(r₁ × r₂) = δ × (N,₁ r₂ − N,₂ r₁)
        lever = minus(scaled(first[b], r2), scaled(second[b], r1))
        for j in range(3):
            unit = (1.0 if j == 0 else 0.0), (1.0 if j == 1 else 0.0), (1.0 if j == 2 else 0.0)
            turned = scaled(factor * p, cross(unit, lever))
            risen = scaled(factor * N[b] * gradient[j], normal)
            store_row(change, 3 * b + j, plus(turned, risen))


@callback(UFCX_SIGNATURE)
def tangent_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Add the load stiffness."""
    coordinates, sizes, pressure, tables = _parts(w, c)
    q = numba.carray(stack(UNKNOWNS), (VECTORS, 3))
    K = numba.carray(stack(UNKNOWNS * UNKNOWNS), (UNKNOWNS, UNKNOWNS))
    change, R = numba.carray(stack(144), (UNKNOWNS, 3)), numba.carray(stack(72), (NODES, 3, 3))
    gather(coordinates, sizes, q)
    K[:] = 0.0
    for g in range(tables.shape[0]):
        _change(tables[g], q, pressure, -c[0] * tables[g, 48], change)
        for a in range(VECTORS):
            for b in range(UNKNOWNS):
                for i in range(3):
                    K[3 * a + i, b] += tables[g, a] * change[b, i]
    pull_matrix(coordinates, sizes, K, R, numba.carray(A, (NODES, 6, NODES, 6)))


class ThinPushes(Term):
    """Forces of one pressure on thin shells."""

    label, load, of_bodies = "pressure on thin shells", True, True

    def __init__(
        self, cells: Indices, sizes: Array, pressure: Array, rule: tuple[Array, Array, Array]
    ) -> None:
        """Pack the data of the cells.

        Args:
            cells: Nodes of each cell, shape (m, 8).
            sizes: Sizes of the cells, see :mod:`.nodal_coordinates`, shape (m, 4).
            pressure: p₀ and its gradient of each cell, shape (m, 4).
            rule: Values (g, 16), slopes (g, 2, 16) and weights (g,) at points of a cell.
        """
        values, slopes, weights = rule
        tables = np.concatenate(
            [values, slopes[:, 0], slopes[:, 1], weights[:, np.newaxis]], axis=1
        )
        self._constants = np.concatenate([[1.0, len(values)], tables.ravel()])
        data = np.concatenate([sizes, pressure], axis=1)
        given = data, self._constants, np.zeros((len(cells), 1))
        self._forces = CellSum(cells, force_kernel.address, *given, written=12 * cells.shape[1])
        self._matrix = CellSum(cells, tangent_kernel.address, *given, written=12 * cells.shape[1])
        self._pattern = Pattern.of(cells, int(cells.max()) + 1)
        count = len(self._pattern.indptr) - 1
        rows = np.repeat(np.arange(count), np.diff(self._pattern.indptr))
        self._pairs: Pairs = rows, self._pattern.indices
        self._contents = cells, sizes, pressure

    @property
    def pairs(self) -> Pairs:
        """First and second node of each block of the pattern."""
        return self._pairs

    @property
    def contents(self) -> tuple[Array | Indices, ...]:
        """Data of the cells, for fingerprints."""
        return self._contents

    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """Add the pressure forces at nodal coordinates ``H`` to ``out``."""
        self._constants[0] = self.amplitude
        self._forces.add_vector(H, out.reshape(-1))

    def tangent(self, H: Array, kept: Array) -> Array:
        """Load stiffness at nodal coordinates ``H``, shape (pairs, 6, 6)."""
        self._constants[0] = self.amplitude
        return self._matrix.matrix(H, self._pattern)
