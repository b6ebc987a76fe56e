"""Closest points of lines and surfaces to a position in the reference configuration."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.optimize import brentq

from fem_lie._arrays import Array

AT_NODE = 1e-9
"""Points closer to a node than this fraction of the body's size are the node."""

_STEP = 1e-6  # of differences along a cell
_ROUNDS = 30
_SMALL = 1e-15


def near_cells(position: Array, corners: Array) -> list[int]:
    """Cells that may contain the point closest to a position.

    Args:
        position: Shape (3,).
        corners: Corners of the cells, shape (m, k, 3); cells are at most twice as long as the
            extent of their corners.
    """
    away = np.linalg.norm(corners - position, axis=2).min(axis=1)
    size = np.linalg.norm(np.ptp(corners, axis=1), axis=1)
    return [int(cell) for cell in np.flatnonzero(away - size <= away.min())]


def closest_on_lines(
    position: Array, ends: Array, line: Callable[[int, float], Array]
) -> tuple[int, float]:
    """Element whose point is closest to a position, and the fraction of it from 0 to 1.

    Args:
        position: Shape (3,).
        ends: Ends of the elements, shape (m, 2, 3).
        line: Position at a fraction of an element, shape (3,).
    """

    def foot(element: int) -> float:
        def slope(part: float) -> float:
            tangent = line(element, min(part + _STEP, 1.0)) - line(element, max(part - _STEP, 0.0))
            return float((line(element, part) - position) @ tangent)

        if slope(0.0) >= 0.0:
            return 0.0
        return 1.0 if slope(1.0) <= 0.0 else float(brentq(slope, 0.0, 1.0, xtol=_SMALL))

    near = near_cells(position, ends)
    parts = [foot(element) for element in near]
    best = _nearest(position, [line(*at) for at in zip(near, parts, strict=True)])
    return near[best], parts[best]


def closest_on_surface(
    position: Array, corners: Array, surface: Callable[[int, Array], Array]
) -> tuple[int, Array]:
    """Cell whose point is closest to a position, and the coordinates in it from 0 to 1.

    Args:
        position: Shape (3,).
        corners: Corners of the cells, shape (m, 4, 3).
        surface: Position and tangents at coordinates (2,) of a cell, shape (3, 3).
    """

    def foot(cell: int) -> Array:
        at = np.full(2, 0.5)
        for _ in range(_ROUNDS):
            x, *tangents = surface(cell, at)
            step = np.linalg.lstsq(np.array(tangents).T, position - x, rcond=None)[0]
            moved = np.clip(at + step, 0.0, 1.0)
            if np.abs(moved - at).max() <= _SMALL:
                break
            at = moved
        return at

    near = near_cells(position, corners)
    feet = [foot(cell) for cell in near]
    best = _nearest(position, [surface(*at)[0] for at in zip(near, feet, strict=True)])
    return near[best], feet[best]


def _nearest(position: Array, points: Sequence[Array]) -> int:
    return int(np.linalg.norm(np.array(points) - position, axis=1).argmin())
