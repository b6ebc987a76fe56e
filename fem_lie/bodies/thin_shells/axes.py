"""Axes of the nodes of a thin shell: those of the surface, which they follow."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Flags
from fem_lie._jit import compiled, inlined
from fem_lie.lie.kinds.kind import CROSSING, SURFACE, set_axes
from fem_lie.lie.tuples import (
    Vector,
    combined,
    cross,
    dot,
    load_row,
    minus,
    plus,
    scaled,
    store_row,
)


@inlined
def _unit(a: Vector) -> Vector:
    return scaled(1.0 / np.sqrt(dot(a, a)), a)


@inlined
def surface_axes(along: Vector, across: Vector) -> tuple[Vector, Vector, Vector]:
    """The polar rotation of the slopes' directions and the normal."""
    a, b = _unit(along), _unit(across)
    # bisectors are across each other; of slopes across each other the axes are along them
    inner, outer = _unit(plus(a, b)), _unit(minus(a, b))
    half = np.sqrt(0.5)
    first = combined(half, inner, half, outer)
    third = _unit(cross(a, b))
    return first, cross(third, first), third


@compiled
def follow_surface(rows: Array, moves: Flags) -> None:
    """Turn the axes of all points, and tell the second nodes where they are.

    Args:
        rows: Of the SURFACE nodes, then of the CROSSING ones, shape (2 n, 4, 3).
        moves: Points whose axes turn, shape (n,).
    """
    n = moves.shape[0]
    for i in range(n):
        store_row(rows[n + i], 0, load_row(rows[i], 0))
        if moves[i]:
            e1, e2, e3 = surface_axes(load_row(rows[i], 1), load_row(rows[n + i], 2))
            set_axes(SURFACE, rows[i], e1, e2, e3)
            set_axes(CROSSING, rows[n + i], e1, e2, e3)
