"""Axes of the points of an ANCF beam: those of its sections."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Flags
from fem_lie._jit import compiled
from fem_lie.bodies.thin_shells.assembly import surface_axes
from fem_lie.lie.node_types.node_type import MIXED_DERIVATIVE, SURFACE_GRADIENT, set_axes
from fem_lie.lie.tuples import load_row, store_row


@compiled
def rotate_section_axes(coordinates: Array, moves: Flags) -> None:
    """Rotate the axes of all points with their sections, and copy positions to the second nodes.

    The first axis is normal to the section; the others are the polar rotation of the directions of
    its two gradients.

    Args:
        coordinates: Coordinates of the SURFACE_GRADIENT nodes, then of the MIXED_DERIVATIVE nodes,
            shape (2 n, 4, 3).
        moves: Points whose axes rotate, shape (n,).
    """
    n = moves.shape[0]
    for i in range(n):
        store_row(coordinates[n + i], 0, load_row(coordinates[i], 0))
        if moves[i]:
            e2, e3, e1 = surface_axes(
                load_row(coordinates[n + i], 1), load_row(coordinates[n + i], 2)
            )
            set_axes(SURFACE_GRADIENT, coordinates[i], e1, e2, e3)
            set_axes(MIXED_DERIVATIVE, coordinates[n + i], e1, e2, e3)


def second_nodes(frames: Array) -> Array:
    """Coordinates of the MIXED_DERIVATIVE nodes of undeformed section frames, (n, 4, 3)."""
    coordinates = frames.copy()
    coordinates[:, 1], coordinates[:, 2], coordinates[:, 3] = frames[:, 2], frames[:, 3], 0.0
    both = np.concatenate([frames, coordinates])
    rotate_section_axes(both, np.ones(len(frames), dtype=bool))
    return both[len(frames) :]
