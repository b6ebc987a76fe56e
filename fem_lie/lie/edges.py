"""Frames whose first axis is a given direction."""

from __future__ import annotations

from math import sqrt

from fem_lie._arrays import Array
from fem_lie._jit import uncounted
from fem_lie.lie.tuples import (
    Vector,
    combined,
    cross,
    dot,
    load_row,
    plus,
    scaled,
    store_rows,
)

_OPPOSITE = 1e-12
"""Of ``1 + cos``: there is no smallest rotation to the opposite direction."""


@uncounted
def turn_on_to(rows: Array, way: Vector) -> None:
    """Turn the axes in ``rows`` (4, 3) by the smallest rotation; the first is along ``way``."""
    D, beside = load_row(rows, 1), load_row(rows, 2)
    t = scaled(1.0 / sqrt(dot(way, way)), way)
    near = max(1.0 + dot(D, t), _OPPOSITE)
    second = combined(1.0, beside, -dot(beside, t) / near, plus(D, t))
    store_rows(rows, 1, t, second, cross(t, second))
