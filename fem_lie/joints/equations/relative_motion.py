"""Compiled relative motion ``z = (Δ, Q)`` of two frames, its variation, and forces along it.

With ``Δ = R_Aᵀ (x_B − x_A)`` and ``Q = R_Aᵀ R_B``, row by row, and twists ``(u, η)``::

    δΔ = Q u_B − u_A + Δ × η_A        δQ = Q η̂_B − η̂_A Q
"""

from __future__ import annotations

from fem_lie._arrays import Array
from fem_lie._jit import inlined


@inlined
def relative_motion(A: Array, B: Array, z: Array) -> None:
    """``z = (Δ, Q)`` of two frames, shape (12,)."""
    for k in range(3):
        z[k] = 0.0
        for i in range(3):
            z[k] += A[1 + k, i] * (B[0, i] - A[0, i])
        for n in range(3):
            q = 0.0
            for i in range(3):
                q += A[1 + k, i] * B[1 + n, i]
            z[3 + 3 * k + n] = q


@inlined
def variation(z: Array, twist_a: Array, twist_b: Array, out: Array) -> None:
    """``out = (δΔ, δQ)`` for twists (6,) of the two frames."""
    ua, wa, ub, wb = twist_a[:3], twist_a[3:], twist_b[:3], twist_b[3:]
    D, Q = z[:3], z[3:].reshape(3, 3)
    out[0] = -ua[0] + D[1] * wa[2] - D[2] * wa[1]
    out[1] = -ua[1] + D[2] * wa[0] - D[0] * wa[2]
    out[2] = -ua[2] + D[0] * wa[1] - D[1] * wa[0]
    dQ = out[3:].reshape(3, 3)
    for k in range(3):
        out[k] += Q[k, 0] * ub[0] + Q[k, 1] * ub[1] + Q[k, 2] * ub[2]
        dQ[k, 0] = Q[k, 1] * wb[2] - Q[k, 2] * wb[1]
        dQ[k, 1] = Q[k, 2] * wb[0] - Q[k, 0] * wb[2]
        dQ[k, 2] = Q[k, 0] * wb[1] - Q[k, 1] * wb[0]
    for n in range(3):
        dQ[0, n] -= wa[1] * Q[2, n] - wa[2] * Q[1, n]
        dQ[1, n] -= wa[2] * Q[0, n] - wa[0] * Q[2, n]
        dQ[2, n] -= wa[0] * Q[1, n] - wa[1] * Q[0, n]


@inlined
def force(z: Array, p: Array, fa: Array, fb: Array) -> None:
    """Forces and moments (6,) on the two frames that do the work ``p · δz``."""
    D, Q, n, P = z[:3], z[3:].reshape(3, 3), p[:3], p[3:].reshape(3, 3)
    fa[0], fa[1], fa[2] = -n[0], -n[1], -n[2]
    fa[3] = n[1] * D[2] - n[2] * D[1]
    fa[4] = n[2] * D[0] - n[0] * D[2]
    fa[5] = n[0] * D[1] - n[1] * D[0]
    for k in range(3):
        fb[k] = Q[0, k] * n[0] + Q[1, k] * n[1] + Q[2, k] * n[2]
        fb[3 + k] = 0.0
    for i in range(3):
        # rows of P and Q for the moment on A, columns for that on B
        fa[3] -= P[2, i] * Q[1, i] - P[1, i] * Q[2, i]
        fa[4] -= P[0, i] * Q[2, i] - P[2, i] * Q[0, i]
        fa[5] -= P[1, i] * Q[0, i] - P[0, i] * Q[1, i]
        fb[3] += Q[i, 2] * P[i, 1] - Q[i, 1] * P[i, 2]
        fb[4] += Q[i, 0] * P[i, 2] - Q[i, 2] * P[i, 0]
        fb[5] += Q[i, 1] * P[i, 0] - Q[i, 0] * P[i, 1]
