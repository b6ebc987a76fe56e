"""Frames half-way between the ends of a step."""

from __future__ import annotations

from fem_lie import lie
from fem_lie._arrays import Array


def half_way(H: Array, end: Array, count: int) -> Array:
    """Frames half-way to the end along screws: the means of what turns as a whole are strained."""
    middle = end.copy()
    step = lie.se3_relative(H[:count], end[:count])
    middle[:count] = lie.se3_retract(H[:count], 0.5 * step)
    return middle
