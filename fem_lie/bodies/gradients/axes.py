"""Axes of the points of an ANCF beam: those of its sections."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Flags
from fem_lie._jit import compiled
from fem_lie.bodies.thin_shells.assembly import surface_axes
from fem_lie.lie.node_types.node_type import MIXED_DERIVATIVE, SURFACE_GRADIENT, set_axes
from fem_lie.lie.tuples import load_row, store_row


@compiled
def follow_sections(rows: Array, moves: Flags) -> None:
    """Rotate the axes of all points with their sections, and copy positions to the second nodes.

    The first axis is normal to the section; the others are the polar rotation of the directions of
    its two gradients.

    Args:
        rows: Coordinates of the SURFACE_GRADIENT nodes, then of the MIXED_DERIVATIVE nodes, shape
            (2 n, 4, 3).
        moves: Points whose axes rotate, shape (n,).
    """
    n = moves.shape[0]
    for i in range(n):
        store_row(rows[n + i], 0, load_row(rows[i], 0))
        if moves[i]:
            e2, e3, e1 = surface_axes(load_row(rows[n + i], 1), load_row(rows[n + i], 2))
            set_axes(SURFACE_GRADIENT, rows[i], e1, e2, e3)
            set_axes(MIXED_DERIVATIVE, rows[n + i], e1, e2, e3)


def second_nodes(frames: Array) -> Array:
    """Coordinates of the MIXED_DERIVATIVE nodes of undeformed section frames, (n, 4, 3)."""
    rows = frames.copy()
    rows[:, 1], rows[:, 2], rows[:, 3] = frames[:, 2], frames[:, 3], 0.0
    both = np.concatenate([frames, rows])
    follow_sections(both, np.ones(len(frames), dtype=bool))
    return both[len(frames) :]
