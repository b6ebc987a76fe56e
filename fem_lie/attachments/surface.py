"""Attachment frame at a point of a surface with position-gradient coordinates.

The position and its derivatives along the two surface parameters are linear combinations of the
nodal coordinate vectors ``q``: ``x = Σ c₀ q``, ``r₁ = Σ c₁ q``, ``r₂ = Σ c₂ q``. The first axis of
the frame is along ``r₁``; the third is the normal. With ``r₁ = s d₁``, ``r₂ = p d₁ + q d₂`` and the
rates ``a``, ``b`` of ``r₁``, ``r₂`` along these axes, the angular velocity is::

    ω = (b₃/q − a₃ p/(s q), −a₃/s, a₂/s)

Moments are therefore forces on ``r₁`` and ``r₂``: ``(0, f₆, −f₅ − f₄ p/q)/s`` and ``(0, 0, f₄/q)``.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled
from fem_lie.attachments.attachment import AttachmentFrame, AttachmentKind
from fem_lie.lie.node_types import MIXED_DERIVATIVE, SURFACE_GRADIENT, axes
from fem_lie.lie.tuples import store

# the first half of the nodes have position and r₁, the other half r₂ and the mixed derivative


@compiled
def _row(i: int, half: int, nodes: int) -> int:
    return half if 2 * i < nodes else half + 1


@compiled
def _frame(X: Array, c: Array, H: Array, Q: Array) -> tuple[float, float, float]:
    """Set the frame and ``Qᵢ``, its axes times those of the nodes; return ``s, p, q``."""
    k, first, second = X.shape[0], np.zeros(3), np.zeros(3)
    H[:] = 0.0
    for i in range(k):
        for half in range(2):
            row = X[i, _row(i, half, k)]
            H[0] += c[i, half, 0] * row
            first += c[i, half, 1] * row
            second += c[i, half, 2] * row
    s = np.sqrt(np.dot(first, first))
    H[1] = first / s
    m = np.cross(first, second)
    H[3] = m / np.sqrt(np.dot(m, m))
    H[2] = np.cross(H[3], H[1])
    R = np.empty((3, 3))
    for i in range(k):
        for a, axis in enumerate(axes(SURFACE_GRADIENT if 2 * i < k else MIXED_DERIVATIVE, X[i])):
            store(R[a], 0, axis)
        Q[i] = H[1:] @ R.T
    return s, np.dot(second, H[1]), np.dot(second, H[2])


@compiled
def locate_surface(X: Array, data: Array, H: Array, J: Array) -> None:
    """Frame and Jacobian, see :class:`~fem_lie.attachments.attachment.AttachmentKind`."""
    k = X.shape[0]
    c, Q = data.reshape((k, 2, 3)), np.empty((k, 3, 3))
    s, p, q = _frame(X, c, H, Q)
    for i in range(k):
        for half in range(2):
            own = J[i, :, 3 * half : 3 * half + 3]
            own[:3] = c[i, half, 0] * Q[i]
            first, second = c[i, half, 1], c[i, half, 2]
            own[3] = (second / q - first * p / (s * q)) * Q[i, 2]
            own[4] = -first / s * Q[i, 2]
            own[5] = first / s * Q[i, 1]


@compiled
def bend_surface(X: Array, data: Array, f: Array, K: Array) -> None:
    """Geometric stiffness: by the rotation of the frame and by ``s``, ``p``, ``q``."""
    k = X.shape[0]
    c, Q, H = data.reshape((k, 2, 3)), np.empty((k, 3, 3)), np.empty((4, 3))
    s, p, q = _frame(X, c, H, Q)
    n, ω, on_first, on_second = f[:3].copy(), np.empty(3), np.zeros(3), np.zeros(3)
    on_first[1], on_first[2] = f[5] / s, -f[4] / s - f[3] * p / (s * q)
    on_second[2] = f[3] / q
    changed_first, changed_second = np.zeros(3), np.zeros(3)
    for j in range(k):
        for half in range(2):
            for m in range(3):
                a, b = c[j, half, 1] * Q[j, :, m], c[j, half, 2] * Q[j, :, m]
                ω[0], ω[1], ω[2] = b[2] / q - a[2] * p / (s * q), -a[2] / s, a[1] / s
                ds, dp, dq = a[0], b[0] + ω[2] * q, b[1] - ω[2] * p
                changed_first[1] = -on_first[1] * ds / s
                change = dp / (s * q) - p * ds / (s * s * q) - p * dq / (s * q * q)
                changed_first[2] = f[4] * ds / (s * s) - f[3] * change
                changed_second[2] = -on_second[2] * dq / q
                for i in range(k):
                    for other in range(2):
                        c0, c1, c2 = c[i, other, 0], c[i, other, 1], c[i, other, 2]
                        g = c0 * n + c1 * on_first + c2 * on_second
                        dg = np.cross(ω, g) + c1 * changed_first + c2 * changed_second
                        K[i, 3 * other : 3 * other + 3, j, 3 * half + m] = Q[i].T @ dg


ON_SURFACE = AttachmentKind(locate_surface, bend_surface, summed=True, turns=True)


def on_surface(nodes: Sequence[int], coefficients: Array) -> AttachmentFrame:
    """Frame at a point of a surface between nodes.

    Args:
        nodes: Surface-gradient nodes, then as many mixed-derivative nodes.
        coefficients: Coefficients of the two coordinate vectors of each node in the position and
            its two derivatives, shape (k, 2, 3).
    """
    return AttachmentFrame(
        ON_SURFACE, tuple(map(int, nodes)), tuple(map(float, coefficients.ravel()))
    )
