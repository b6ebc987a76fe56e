"""Attachment frames between nodal frames: on the geodesic, or interpolated.

*On the geodesic* of SE(3) between two nodal frames, as inside geodesic beam elements. At
``0 ≤ ξ ≤ 1`` the frame is ``H_a exp(ξ d)``, ``d = log(H_a⁻¹ H_b)``. Its twist, and so the nodal
forces, follow from the Jacobians (:mod:`fem_lie.joints.equations.sliding` has the case of a
variable ξ)::

    J_a = Ad(exp(−ξ d)) − ξ T(ξ d) T⁻¹(−d),    J_b = ξ T(ξ d) T⁻¹(d)

*Interpolated*: positions and directors are interpolated independently. With the values ``Nᵢ`` of
the shape functions the origin is ``Σ Nᵢ xᵢ``, and the axes are the rotation ``R`` nearest to ``F =
Σ Nᵢ Rᵢ``, from the polar decomposition ``F = R U``. With ``Qᵢ = RᵀRᵢ``, ``U = Σ Nᵢ Qᵢ`` and ``Y =
tr(U) 1 − U``::

    u = Σ Nᵢ Qᵢ uᵢ,    ω = Y⁻¹ Σ Nᵢ (tr(Qᵢ) 1 − Qᵢᵀ) ωᵢ,    δQᵢ = −ω̂ Qᵢ + Qᵢ ω̂ᵢ
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie._jit import compiled
from fem_lie.attachments.attachment import AttachmentFrame, AttachmentKind


@compiled
def _parts(X: Array, data: Array, d: Array, E: Array, T: Array, D: Array, A: Array) -> None:
    """``d``, ``exp(ξ d)``, ``T(ξ d)``, ``δd = D (h_a, h_b)`` with ``D`` (2, 6, 6), ``Ad(E⁻¹)``."""
    back = np.empty((4, 3))
    lie.relative(X[0], X[1], d)
    along = data[0] * d
    lie.exp_se3(along, E)
    lie.inverse(E, back)
    lie.adjoint(back, A)
    lie.tangent(along, T)
    lie.tangent_inverse_minus(d, D[0])
    lie.tangent_inverse(d, D[1])
    D[0] *= -1.0


@compiled
def _locate_on_geodesic_frame(X: Array, data: Array, H: Array, J: Array) -> None:
    d, E, T = np.empty(6), np.empty((4, 3)), np.empty((6, 6))
    D, A = np.empty((2, 6, 6)), np.empty((6, 6))
    _parts(X, data, d, E, T, D, A)
    lie.compose(X[0], E, H)
    J[0] = A + data[0] * (T @ D[0])
    J[1] = data[0] * (T @ D[1])


@compiled
def _bend_on_geodesic_frame(X: Array, data: Array, f: Array, K: Array) -> None:
    """Geometric stiffness, from the variations of ``Tᵀ(ξ d) f`` and ``Ad(E⁻¹)ᵀ f``."""
    ξ, d, E, T = data[0], np.empty(6), np.empty((4, 3)), np.empty((6, 6))
    D, A, G, P = np.empty((2, 6, 6)), np.empty((6, 6)), np.empty((3, 6, 6)), np.empty((6, 6))
    _parts(X, data, d, E, T, D, A)
    g = T.T @ f
    lie.tangent_inverse_transposed_derivative(ξ * d, g, G[0])
    lie.tangent_inverse_transposed_derivative_minus(d, g, G[1])
    lie.tangent_inverse_transposed_derivative(d, g, G[2])
    lie.coadjoint_matrix(f, P)
    change = -ξ * (T.T @ G[0])
    # of the forces on both nodes in d
    by_a = ξ * (G[1] + D[0].T @ change - A.T @ (P @ T))
    by_b = ξ * (G[2] + D[1].T @ change)
    for side in range(2):
        K[0, :, side] = by_a @ D[side]
        K[1, :, side] = by_b @ D[side]


GEODESIC = AttachmentKind(_locate_on_geodesic_frame, _bend_on_geodesic_frame)


def on_geodesic(a: int, b: int, ξ: float) -> AttachmentFrame:
    """Frame at ξ on the geodesic from node ``a`` (ξ = 0) to node ``b`` (ξ = 1)."""
    return AttachmentFrame(GEODESIC, (a, b), (ξ,))


_MOST = 30  # iterations; four suffice for relative rotations of 45°


@compiled
def _nearest(F: Array, R: Array) -> None:
    """Rotation nearest to ``F`` (3, 3), both with directors as rows, by ``R ← ½ (R + R⁻ᵀ)``."""
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
    """Set the frame ``H`` and the relative rotations ``Qᵢ``; return ``Y⁻¹``."""
    H[:], U = 0.0, np.zeros((3, 3))
    for i in range(X.shape[0]):
        H += N[i] * X[i]
    _nearest(H[1:].copy(), H[1:])
    for i in range(X.shape[0]):
        Q[i] = H[1:] @ X[i, 1:].T
        U += N[i] * Q[i]
    return np.linalg.inv(np.trace(U) * np.eye(3) - U)


@compiled
def _locate_on_interpolated(X: Array, data: Array, H: Array, J: Array) -> None:
    Q, one = np.empty((X.shape[0], 3, 3)), np.eye(3)
    inverse = _relative(X, data, H, Q)
    for i in range(X.shape[0]):
        J[i] = 0.0
        J[i, :3, :3] = data[i] * Q[i]
        J[i, 3:, 3:] = data[i] * (inverse @ (np.trace(Q[i]) * one - Q[i].T))


@compiled
def _bend_on_interpolated(X: Array, data: Array, f: Array, K: Array) -> None:
    """Geometric stiffness, column by column; only rotations of nodes contribute."""
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


INTERPOLATED = AttachmentKind(_locate_on_interpolated, _bend_on_interpolated)


def interpolated(nodes: Sequence[int], values: Sequence[float]) -> AttachmentFrame:
    """Frame interpolated between ``nodes`` with shape function values that sum to one."""
    return AttachmentFrame(INTERPOLATED, tuple(map(int, nodes)), tuple(map(float, values)))
