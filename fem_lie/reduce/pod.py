"""Proper orthogonal decomposition of local motion: the shapes that a motion had."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import whole
from fem_lie.bodies.body import Body
from fem_lie.reduce.axes import Axes, MeanAxes
from fem_lie.reduce.basis import Basis
from fem_lie.reduce.local_motions import frames_of, local_motion
from fem_lie.results.states import StateSeries


def pod(result: StateSeries, body: Body, modes: int, *, axes: Axes | None = None) -> Basis:
    """Shapes that are nearest to all states of a result once rigid motion is taken out of them.

    Left singular vectors of the snapshots, orthonormal with rotations times the body's size.

    Args:
        result: The states.
        body: Of which body of the scene.
        modes: How many shapes.
        axes: Which rigid motion is taken out; default: :class:`MeanAxes`.

    Raises:
        ValueError: The result has no such body, or fewer independent states than ``modes``.
    """
    whole(modes, "modes")
    frames = frames_of(result, body)
    motion = local_motion(body, frames, MeanAxes() if axes is None else axes)
    scale = np.repeat([1.0, body.size], 3)
    snapshots = (motion.increments * scale).reshape(len(frames), -1)
    _, sizes, shapes = np.linalg.svd(snapshots, full_matrices=False)
    rank = int((sizes > 1e-12 * body.size).sum())
    if modes > rank:
        raise ValueError(
            f"modes must be at most {rank}, as many independent states has {body.label} in the "
            f"result, got {modes}"
        )
    return Basis(body, shapes[:modes].reshape(modes, -1, 6) / scale)
