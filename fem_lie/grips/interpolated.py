"""A place between frames whose positions and directors are interpolated as they are.

With the values ``Nᵢ`` of the nodes' shape functions the origin is ``Σ Nᵢ xᵢ`` and the axes are the
rotation ``R`` next to ``F = Σ Nᵢ Rᵢ``, ``F = R U`` (polar decomposition), which turns with the
body. With ``Qᵢ = RᵀRᵢ``, ``U = Σ Nᵢ Qᵢ`` and ``Y = tr(U) 1 − U``::

    u = Σ Nᵢ Qᵢ uᵢ,    ω = Y⁻¹ Σ Nᵢ (tr(Qᵢ) 1 − Qᵢᵀ) ωᵢ,    δQᵢ = −ω̂ Qᵢ + Qᵢ ω̂ᵢ
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled
from fem_lie.grips.grip import Grip, GripKind

_MOST = 30  # iterations; four do for nodes that turn by half a right angle


@compiled
def _nearest(F: Array, R: Array) -> None:
    """Rotation next to ``F`` (3, 3), both with directors as rows, by ``R ← ½ (R + R⁻ᵀ)``."""
    R[:] = F
    for _ in range(_MOST):
        a, b, c = np.cross(R[1], R[2]), np.cross(R[2], R[0]), np.cross(R[0], R[1])
        volume, change = np.dot(R[0], a), 0.0
        for j in range(3):
            for k, other in enumerate((a, b, c)):
                step = 0.5 * (other[j] / volume - R[k, j])
                R[k, j] += step
                change = max(change, abs(step))
        if not change > 1e-15:
            break


@compiled
def _relative(X: Array, N: Array, H: Array, Q: Array) -> Array:
    """Sets the frame ``H`` and ``Qᵢ``; returns ``Y⁻¹``."""
    H[:], U = 0.0, np.zeros((3, 3))
    for i in range(X.shape[0]):
        H += N[i] * X[i]
    _nearest(H[1:].copy(), H[1:])
    for i in range(X.shape[0]):
        Q[i] = H[1:] @ X[i, 1:].T
        U += N[i] * Q[i]
    return np.linalg.inv(np.trace(U) * np.eye(3) - U)


@compiled
def _locate(X: Array, data: Array, H: Array, J: Array) -> None:
    Q, one = np.empty((X.shape[0], 3, 3)), np.eye(3)
    inverse = _relative(X, data, H, Q)
    for i in range(X.shape[0]):
        J[i] = 0.0
        J[i, :3, :3] = data[i] * Q[i]
        J[i, 3:, 3:] = data[i] * (inverse @ (np.trace(Q[i]) * one - Q[i].T))


@compiled
def _bend(X: Array, data: Array, f: Array, K: Array) -> None:
    """Column by column: a rotation of one node changes ``Q`` of all; positions change nothing."""
    k, one = X.shape[0], np.eye(3)
    Q, dQ, H = np.empty((k, 3, 3)), np.empty((k, 3, 3)), np.empty((4, 3))
    inverse = _relative(X, data, H, Q)
    n, m = f[:3].copy(), inverse @ f[3:]
    K[:] = 0.0
    for j in range(k):
        turns = data[j] * (inverse @ (np.trace(Q[j]) * one - Q[j].T))
        for c in range(3):
            spin, dU = _hat(turns[:, c]), np.zeros((3, 3))
            for i in range(k):
                dQ[i] = -spin @ Q[i]
                if i == j:
                    dQ[i] += Q[i] @ _hat(one[c])
                dU += data[i] * dQ[i]
            dm = -inverse @ (np.trace(dU) * m - dU @ m)
            for i in range(k):
                K[i, :3, j, 3 + c] = data[i] * (dQ[i].T @ n)
                moment = np.trace(dQ[i]) * m - dQ[i] @ m + np.trace(Q[i]) * dm - Q[i] @ dm
                K[i, 3:, j, 3 + c] = data[i] * moment


@compiled
def _hat(a: Array) -> Array:
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


INTERPOLATED = GripKind(_locate, _bend)


def interpolated(nodes: Sequence[int], values: Sequence[float]) -> Grip:
    """The frame between ``nodes`` whose shape functions have these values, which sum up to one."""
    return Grip(INTERPOLATED, tuple(map(int, nodes)), tuple(map(float, values)))
