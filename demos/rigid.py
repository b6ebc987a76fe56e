"""Axes and moments of inertia of rigid bars and boxes."""

from __future__ import annotations

import numpy as np


def axes_along(direction: np.ndarray) -> np.ndarray:
    """Axes as columns, the first along a direction that is not vertical, the second level."""
    along = direction / np.linalg.norm(direction)
    across = np.cross((0, 0, 1), along)
    across /= np.linalg.norm(across)
    return np.column_stack([along, across, np.cross(along, across)])


def box_inertia(mass: float, edges: np.ndarray) -> np.ndarray:
    """Principal moments of inertia of a box."""
    squares = edges**2
    return mass / 12 * (squares.sum() - squares)
