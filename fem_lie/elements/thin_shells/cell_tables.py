"""What kernels of cells read: tables of an element, and the numbers of one cell, at addresses."""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import inlined
from fem_lie.elements.thin_shells.rows import NODES, VECTORS
from fem_lie.forms.kernels.addresses import Pointer, shift

HEAD = 5
"""Numbers before the tables of an element: samples of each strain, points, share at the points."""
_ROWS, _SIZES = 12 * NODES, 3


class Rule(NamedTuple):
    """Tables of an element, the same for all cells.

    Attributes:
        counts: Samples of E₁₁, of E₂₂ and of 2 E₁₂, and points of integration.
        share: How much of the membrane strain is that at the points themselves.
        along: ∂ξ at the samples of E₁₁, shape (s₁, 16).
        across: ∂η at those of E₂₂, shape (s₂, 16).
        both: Both at those of 2 E₁₂, shape (s₃, 2, 16).
        spread: Of each strain, values at the points of the polynomials that are one at a sample,
            shapes (g, s₁), (g, s₂), (g, s₃).
        points: (∂ξ, ∂η, ∂ξξ, ∂ηη, ∂ξη) there, shape (g, 5, 16).
    """

    counts: tuple[int, int, int, int]
    share: float
    along: Array
    across: Array
    both: Array
    spread: tuple[Array, Array, Array]
    points: Array

    def packed(self) -> Array:
        """As the kernels read it."""
        tables = self.along, self.across, self.both, *self.spread, self.points
        head = np.array([*self.counts, self.share])
        return np.concatenate([head, *(table.ravel() for table in tables)])


class Data(NamedTuple):
    """What the kernels read of one cell.

    Attributes:
        rows: Of its nodes, shape (8, 4, 3).
        sizes: Of the cell in the patch's parameters, see :mod:`.rows`, shape (3,).
        sampled: Membrane strains of the unloaded cell at the samples, shape (s,).
        unloaded: All strains of the unloaded cell at the points, shape (g, 6).
        stiffness: ``D`` at the points, shape (g, 6, 6).
        stress: What is carried, shape (g, 6).
    """

    rows: Array
    sizes: Array
    sampled: Array
    unloaded: Array
    stiffness: Array
    stress: Array


def stress_at(samples: int, points: int) -> int:
    """Where the carried stress begins in a cell's data; it is the last of them."""
    return _ROWS + _SIZES + samples + 42 * points


@inlined
def read_rule(c: Pointer) -> Rule:
    """What :meth:`Rule.packed` has made, at ``c``."""
    head = numba.carray(c, (HEAD,))
    n1, n2, n3, g = int(head[0]), int(head[1]), int(head[2]), int(head[3])
    at = HEAD
    along = numba.carray(shift(c, at), (n1, VECTORS))
    at += VECTORS * n1
    across = numba.carray(shift(c, at), (n2, VECTORS))
    at += VECTORS * n2
    both = numba.carray(shift(c, at), (n3, 2, VECTORS))
    at += 2 * VECTORS * n3
    first = numba.carray(shift(c, at), (g, n1))
    at += g * n1
    second = numba.carray(shift(c, at), (g, n2))
    at += g * n2
    third = numba.carray(shift(c, at), (g, n3))
    at += g * n3
    points = numba.carray(shift(c, at), (g, 5, VECTORS))
    return Rule((n1, n2, n3, g), head[4], along, across, both, (first, second, third), points)


@inlined
def read_data(w: Pointer, samples: int, points: int) -> Data:
    """That of the cell whose numbers begin at ``w``."""
    at = _ROWS + _SIZES
    sampled = numba.carray(shift(w, at), (samples,))
    at += samples
    unloaded = numba.carray(shift(w, at), (points, 6))
    at += 6 * points
    stiffness = numba.carray(shift(w, at), (points, 6, 6))
    at += 36 * points
    stress = numba.carray(shift(w, at), (points, 6))
    rows, sizes = numba.carray(w, (NODES, 4, 3)), numba.carray(shift(w, _ROWS), (_SIZES,))
    return Data(rows, sizes, sampled, unloaded, stiffness, stress)


@inlined
def read_tables(w: Pointer, c: Pointer) -> tuple[Rule, Data]:
    """Both, of a cell with the data at ``w``."""
    rule = read_rule(c)
    n1, n2, n3, points = rule.counts
    return rule, read_data(w, n1 + n2 + n3, points)
