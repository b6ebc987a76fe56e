"""Whether nodes of bodies are where nodes can be: what users have set is checked by."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.lie.kinds import all_axes

_ORTHONORMAL = 1e-8  # as of prescribed motions


def check_nodes(label: str, kinds: Indices, frames: Array, velocities: Array) -> None:
    """Refuse what is no node, and velocities that are none.

    Args:
        label: Of the body, for messages.
        kinds: What its nodes are, shape (n,).
        frames: Their rows, shape (n, 4, 3).
        velocities: Wanted of shape (n, 6).

    Raises:
        ValueError: Axes are not right-handed and orthonormal, or numbers not finite.
    """
    shape, count = velocities.shape, len(frames)
    if shape != (count, 6) or not np.isfinite(velocities).all():
        raise ValueError(
            f"velocities of {label} must be finite and of shape ({count}, 6), got\n{velocities}"
        )
    axes = all_axes(kinds, frames)
    gap = np.abs(axes @ axes.transpose(0, 2, 1) - np.eye(3)).max(axis=(1, 2))
    right = np.linalg.det(axes) > 0.0
    finite = np.isfinite(frames).all(axis=(1, 2))
    bad = np.flatnonzero(~(finite & (gap <= _ORTHONORMAL) & right))
    if len(bad):
        raise ValueError(
            f"frames of {label} must be a place and right-handed orthonormal axes; that of node "
            f"{bad[0]} is\n{frames[bad[0]]}"
        )
