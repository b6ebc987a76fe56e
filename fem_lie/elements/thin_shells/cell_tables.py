"""Tables of an element and data of a cell, as kernels read them at addresses."""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import inlined
from fem_lie.elements.thin_shells.nodal_coordinates import NODES, SIZES, VECTORS
from fem_lie.forms.kernels.addresses import Pointer, shift

HEAD = 5
"""Numbers before the tables: samples of each strain, points, fraction at the points."""
HALF = 21
"""Number of entries of the upper half of a symmetric matrix (6, 6)."""
_ROWS = 12 * NODES


class Rule(NamedTuple):
    """Tables of an element, the same for all cells.

    Derivatives ``d = table q`` are, in this order: ∂ξ at the samples of E₁₁, ∂η at those of E₂₂, ∂ξ
    and then ∂η at those of 2 E₁₂, and ∂ξ, ∂η, ∂ξξ, ∂ηη, ∂ξη at the quadrature points, each at all
    of them.

    Attributes:
        counts: Numbers of samples of E₁₁, of E₂₂ and of 2 E₁₂, and of quadrature points.
        share: Fraction of the membrane strain at the points themselves.
        table: Derivatives of the shape functions, shape (d, 16).
        columns: Transpose of ``table``: both are read along rows.
        spread: For each strain, values at the points of the polynomials that are one at a sample,
            shapes (g, s₁), (g, s₂), (g, s₃).
        spread_columns: Transposes of ``spread``.
    """

    counts: tuple[int, int, int, int]
    share: float
    table: Array
    columns: Array
    spread: tuple[Array, Array, Array]
    spread_columns: tuple[Array, Array, Array]

    def packed(self) -> Array:
        """Tables as one array for the kernels."""
        tables = self.table, self.columns, *self.spread, *self.spread_columns
        head = np.array([*self.counts, self.share])
        return np.concatenate([head, *(table.ravel() for table in tables)])


@inlined
def first_point(counts: tuple[int, int, int, int]) -> int:
    """Number of derivatives before those at the quadrature points."""
    return counts[0] + counts[1] + 2 * counts[2]


@inlined
def derivatives(counts: tuple[int, int, int, int]) -> int:
    """Number of derivatives."""
    return first_point(counts) + 5 * counts[3]


class Data(NamedTuple):
    """Data of one cell.

    Attributes:
        coordinates: Coordinates of its nodes, shape (8, 4, 3).
        sizes: Sizes of the cell in the patch's parameters, see :mod:`.coordinates`, shape (4,).
        sampled: Membrane strains of the unloaded cell at the samples, shape (s,).
        unloaded: All strains of the unloaded cell at the points, shape (6, g).
        stiffness: Upper half of ``D`` at the points, by rows, shape (21, g).
        stress: Independent stress, shape (6, g).
    """

    coordinates: Array
    sizes: Array
    sampled: Array
    unloaded: Array
    stiffness: Array
    stress: Array


def stress_at(samples: int, points: int) -> int:
    """Offset of the independent stress, the last of a cell's data."""
    return _ROWS + SIZES + samples + (6 + HALF) * points


@inlined
def read_rule(c: Pointer) -> Rule:
    """Tables at the address ``c``, see :meth:`Rule.packed`."""
    head = numba.carray(c, (HEAD,))
    n1, n2, n3, g = int(head[0]), int(head[1]), int(head[2]), int(head[3])
    count = derivatives((n1, n2, n3, g))
    at = HEAD + 2 * VECTORS * count
    table = numba.carray(shift(c, HEAD), (count, VECTORS))
    columns = numba.carray(shift(c, HEAD + VECTORS * count), (VECTORS, count))
    first = numba.carray(shift(c, at), (g, n1))
    second = numba.carray(shift(c, at + g * n1), (g, n2))
    third = numba.carray(shift(c, at + g * (n1 + n2)), (g, n3))
    at += g * (n1 + n2 + n3)
    of_first = numba.carray(shift(c, at), (n1, g))
    of_second = numba.carray(shift(c, at + g * n1), (n2, g))
    of_third = numba.carray(shift(c, at + g * (n1 + n2)), (n3, g))
    spread = first, second, third
    return Rule((n1, n2, n3, g), head[4], table, columns, spread, (of_first, of_second, of_third))


@inlined
def read_data(w: Pointer, counts: tuple[int, int, int, int]) -> Data:
    """Data of the cell at the address ``w``."""
    samples, points = counts[0] + counts[1] + counts[2], counts[3]
    at = _ROWS + SIZES
    sampled = numba.carray(shift(w, at), (samples,))
    at += samples
    unloaded = numba.carray(shift(w, at), (6, points))
    at += 6 * points
    stiffness = numba.carray(shift(w, at), (HALF, points))
    at += HALF * points
    stress = numba.carray(shift(w, at), (6, points))
    coordinates, sizes = numba.carray(w, (NODES, 4, 3)), numba.carray(shift(w, _ROWS), (SIZES,))
    return Data(coordinates, sizes, sampled, unloaded, stiffness, stress)


@inlined
def read_tables(w: Pointer, c: Pointer) -> tuple[Rule, Data]:
    """Tables and data of the cell at the address ``w``."""
    rule = read_rule(c)
    return rule, read_data(w, rule.counts)
