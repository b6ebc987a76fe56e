"""Axes of threads' nodes that follow the motion of what is around them.

Axes of a slope that go along by the smallest rotation of its tangent do not see a rotation about
it, and those of a place stay as they are: a bent cable that whirls has a matrix that changes. Here
the mean rotation ``Q`` of the whole body since the start is taken out first::

    A = Σ e ⊗ E over all edges,  Q = polar A,    R_i = polar(t ⊗ T + μ Q),  polar(Σ e ⊗ E + μ Q)

with edges ``e`` and tangents ``t``, ``E`` and ``T`` at the start; the first is of a slope, the
second of a place with the edges that it has. For small ``μ`` that is the smallest rotation of what
``Q`` leaves, without its singularity. A superposed rigid motion turns all axes alike, so that
nothing is different in them. It depends on the state alone.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie.bodies.nodes import Follower
from fem_lie.lie.polar import polar_rotation

_MEAN = 0.1
"""``μ``."""

_STRAIGHT = 1e-6  # second singular value of A at the start over the first


@compiled
def _turn(
    rows: Array, edges: Indices, begun: tuple[Array, Array], slopes: bool, moments: Array
) -> None:
    """Turn the axes of ``rows`` (n, 4, 3); ``moments`` is room for (n + 1, 3, 3).

    ``begun`` are edges over their lengths (m, 3) and axes (n, 3, 3) at the start.
    """
    E, axes = begun
    n = rows.shape[0]
    moments[:] = 0.0
    R, Q = np.empty((3, 3)), np.empty((3, 3))
    for k in range(edges.shape[0]):
        a, b = edges[k]
        e = rows[b, 0] - rows[a, 0]
        e /= np.sqrt((e * e).sum())
        part = np.outer(e, E[k])
        moments[n] += part
        if not slopes:
            moments[a] += part
            moments[b] += part
    if not polar_rotation(moments[n], Q):
        return
    for i in range(n):
        F = moments[i]
        tangent = rows[i, 1] / np.sqrt((rows[i, 1] * rows[i, 1]).sum())
        if slopes:
            F += np.outer(tangent, axes[i, 0])
        if not polar_rotation(F + _MEAN * Q, R):
            continue
        new = axes[i] @ R.T
        if slopes:
            beside = new[1] - (new[1] * tangent).sum() * tangent
            size = np.sqrt((beside * beside).sum())
            if not size > _MEAN:
                continue
            rows[i, 2] = beside / size
            rows[i, 3] = np.cross(tangent, rows[i, 2])
        else:
            rows[i, 1:] = new


def following(frames: Array, edges: Indices, slopes: bool) -> Follower | None:
    """What turns the axes, or ``None`` if the body is straight, so that its rotation is not known.

    Args:
        frames: At the start, shape (n, 4, 3).
        edges: Pairs of nodes, shape (m, 2).
        slopes: Whether nodes have slopes, which are in the second rows.
    """
    chords = np.diff(frames[edges, 0], axis=1)[:, 0]
    E = chords / np.linalg.norm(chords, axis=1, keepdims=True)
    values = np.linalg.svd(E.T @ E, compute_uv=False)
    if values[1] <= _STRAIGHT * values[0]:
        return None
    axes = frames[:, 1:].copy()
    axes[:, 0] /= np.linalg.norm(axes[:, 0], axis=1, keepdims=True)
    moments = np.empty((len(frames) + 1, 3, 3))

    def turn(rows: Array) -> None:
        _turn(rows, edges, (E, axes), slopes, moments)

    return turn
