"""Averaging attachment frame: the mean of many nodes without rotations, such as a face of a solid.

With weights ``w_k`` that sum to one the origin is ``x̄ = Σ w_k x_k``, and the axes are the rotation
``R`` of the polar decomposition ``A = Σ w_k (x_k − x̄) ⊗ ξ_k = R S``. Here ``ξ_k`` is the position
of a node relative to the mean, in the frame of the undeformed patch. Nodal variations are along the
nodes' own axes, ``δx_k = R_k h_k``. With ``Q_k = RᵀR_k`` and ``Y = tr(S) 1 − S`` the twist is::

    u = Σ w_k Q_k h_k,    ω = Y⁻¹ Σ w_k ξ_k × Q_k h_k

The frame is a function of twelve mean coordinates, ``x̄`` and ``A``, which are linear in the nodal
positions. Joints and loads on the frame couple the nodes through these coordinates only.

A force and moment on the frame is distributed over the nodes with these weights. The nodes may lie
in a plane, where ``A`` has rank two, but not on a line.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled
from fem_lie.attachments.attachment import AttachmentFrame, AttachmentKind, MeanCoordinates
from fem_lie.lie.polar import polar_rotation

_ROUND_OFF = 1e-14  # relative to the largest coordinate of a node
_LINE = 1e-6  # ratio of the second extent to the first below which nodes count as collinear


@compiled
def _cross(a: Array, b: Array) -> Array:
    return np.array(
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    )


@compiled
def _relative(X: Array, data: Array, H: Array, Q: Array) -> tuple[Array, Array]:
    """Set the frame ``H`` and the relative rotations ``Q_k``; return ``S`` and ``Y⁻¹``."""
    count = X.shape[0]
    A, R, mean = np.zeros((3, 3)), np.empty((3, 3)), np.zeros(3)
    for k in range(count):
        mean += data[4 * k] * X[k, 0]
    for k in range(count):
        for i in range(3):
            arm = data[4 * k] * (X[k, 0, i] - mean[i])
            for j in range(3):
                A[i, j] += arm * data[4 * k + 1 + j]
    polar_rotation(A, R)
    H[0] = mean
    H[1:] = R.T
    S = R.T @ A
    for k in range(count):
        Q[k] = H[1:] @ np.ascontiguousarray(X[k, 1:]).T
    return S, np.linalg.inv(np.trace(S) * np.eye(3) - S)


@compiled
def _locate(X: Array, data: Array, H: Array, J: Array) -> None:
    Q = np.empty((X.shape[0], 3, 3))
    _, inverse = _relative(X, data, H, Q)
    J[:] = 0.0
    for k in range(X.shape[0]):
        weight, ξ = data[4 * k], data[4 * k + 1 : 4 * k + 4]
        for c in range(3):
            moved = weight * np.ascontiguousarray(Q[k, :, c])
            J[k, :3, c] = moved
            J[k, 3:, c] = inverse @ _cross(ξ, moved)


@compiled
def _spread(X: Array, data: Array, S: Array) -> None:
    """Jacobian of ``Rᵀ Σ w_k x_k`` and of the columns of ``Rᵀ A/ρ``, at constant ``R``."""
    Q, H = np.empty((X.shape[0], 3, 3)), np.empty((4, 3))
    _relative(X, data, H, Q)
    size = _size(data)
    S[:] = 0.0
    for k in range(X.shape[0]):
        for i in range(3):
            for c in range(3):
                moved = data[4 * k] * Q[k, i, c]
                S[k, i, c] = moved
                for j in range(3):
                    S[k, 3 + 3 * j + i, c] = moved * data[4 * k + 1 + j] / size


@compiled
def _core(X: Array, data: Array, f: Array, L: Array, C: Array) -> None:
    """Twist and geometric stiffness in mean coordinates, column by column."""
    Q, H, one = np.empty((X.shape[0], 3, 3)), np.empty((4, 3)), np.eye(3)
    S, inverse = _relative(X, data, H, Q)
    size = _size(data)
    n, μ = f[:3].copy(), inverse @ f[3:]
    L[:], C[:] = 0.0, 0.0
    for i in range(3):
        L[i, i] = 1.0
    for j in range(3):
        for i in range(3):
            column = 3 + 3 * j + i
            ω = size * (inverse @ _cross(one[j], one[i]))
            L[3:, column] = ω
            dS = np.zeros((3, 3))
            dS[i, j] = size
            for b in range(3):
                dS[:, b] -= _cross(ω, np.ascontiguousarray(S[:, b]))
            dμ = -inverse @ (np.trace(dS) * μ - dS @ μ)
            C[:3, column] = _cross(ω, n)
            for b in range(3):
                felt = _cross(ω, _cross(one[b], μ)) + _cross(one[b], dμ)
                C[3 + 3 * b : 6 + 3 * b, column] = -size * felt


@compiled
def _size(data: Array) -> float:
    """Radius of gyration ``ρ`` of the undeformed patch, which scales ``A`` to a length."""
    square = 0.0
    for k in range(data.shape[0] // 4):
        for j in range(3):
            square += data[4 * k] * data[4 * k + 1 + j] ** 2
    return float(np.sqrt(square))


@compiled
def _bend(X: Array, data: Array, f: Array, K: Array) -> None:
    count = X.shape[0]
    S, L, C = np.empty((count, 12, 6)), np.empty((6, 12)), np.empty((12, 12))
    _spread(X, data, S)
    _core(X, data, f, L, C)
    for k in range(count):
        left = np.ascontiguousarray(S[k].T) @ C
        for j in range(count):
            K[k, :, j, :] = left @ S[j]


PATCH = AttachmentKind(
    _locate, _bend, summed=True, turns=True, means=MeanCoordinates(12, _spread, _core)
)


def averaging_attachment(
    nodes: Sequence[int], positions: Array, weights: Array, axes: Array
) -> AttachmentFrame:
    """Averaging attachment frame of some nodes of a body.

    Args:
        nodes: Numbers of the k nodes.
        positions: Undeformed positions, shape (k, 3).
        weights: Weights of the nodes, such as their tributary areas, shape (k,). They are
            normalised.
        axes: Axes of the undeformed frame as rows, shape (3, 3).

    Raises:
        ValueError: The nodes are on a line or coincide.
    """
    shares = weights / weights.sum()
    arms = (positions - shares @ positions) @ axes.T
    # round-off would give a plane patch a spurious mean coordinate
    arms[np.abs(arms) <= _ROUND_OFF * np.abs(positions).max()] = 0.0
    extents = np.linalg.svd(arms, compute_uv=False)
    if len(extents) < 2 or extents[1] <= _LINE * extents[0]:
        raise ValueError(
            f"expected nodes that are not collinear for an averaging attachment, "
            f"got {len(nodes)} at\n{positions}"
        )
    data = np.column_stack([shares, arms]).ravel()
    return AttachmentFrame(PATCH, tuple(map(int, nodes)), tuple(map(float, data)))
