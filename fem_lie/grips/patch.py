"""A frame in the mean of a patch of nodes that are places, such as a face of a solid.

With weights ``w_k`` that sum up to one the origin is ``x̄ = Σ w_k x_k``, and the axes are the
rotation ``R`` of ``A = Σ w_k (x_k − x̄) ⊗ ξ_k = R S``, by polar decomposition, where ``ξ_k`` is the
place of a node against the mean in the frame of the unloaded patch. Nodes move along their own
axes by ``δx_k = R_k h_k``; with ``Q_k = RᵀR_k`` and ``Y = tr(S) 1 − S`` the twist is::

    u = Σ w_k Q_k h_k,    ω = Y⁻¹ Σ w_k ξ_k × Q_k h_k

A force and moment on the frame is spread over the nodes with these weights. The nodes may lie in a
plane, where ``A`` has rank two, but not on a line.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled
from fem_lie.grips.grip import Grip, GripKind
from fem_lie.lie.polar import polar_rotation
from fem_lie.lie.tuples import cross, dot, load, minus, scaled

_LINE = 1e-6  # second extent of a patch over the first, of one that is a line


@compiled
def _cross(a: Array, b: Array) -> Array:
    return np.array(
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    )


@compiled
def _relative(X: Array, data: Array, H: Array, Q: Array) -> tuple[Array, Array]:
    """Sets the frame ``H`` and ``Q_k``; returns ``S`` and ``Y⁻¹``."""
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
def _bend(X: Array, data: Array, f: Array, K: Array) -> None:
    """Column by column: moving one node turns the frame, and with it what all nodes feel."""
    count = X.shape[0]
    Q, H = np.empty((count, 3, 3)), np.empty((4, 3))
    S, inverse = _relative(X, data, H, Q)
    n, μ, g = f[:3].copy(), inverse @ f[3:], np.empty((count, 3))
    for k in range(count):
        g[k] = n - _cross(data[4 * k + 1 : 4 * k + 4], μ)
    K[:] = 0.0
    for j in range(count):
        ξ = data[4 * j + 1 : 4 * j + 4]
        for c in range(3):
            moved = data[4 * j] * np.ascontiguousarray(Q[j, :, c])
            ω = inverse @ _cross(ξ, moved)
            dS = np.outer(moved, ξ)
            for b in range(3):
                dS[:, b] -= _cross(ω, np.ascontiguousarray(S[:, b]))
            dμ = -inverse @ (np.trace(dS) * μ - dS @ μ)
            turn, moment = load(ω, 0), load(dμ, 0)
            for k in range(count):
                turned, bent = cross(turn, load(g[k], 0)), cross(load(data, 4 * k + 1), moment)
                change = scaled(data[4 * k], minus(turned, bent))
                for r in range(3):
                    K[k, r, j, c] = dot((Q[k, 0, r], Q[k, 1, r], Q[k, 2, r]), change)


PATCH = GripKind(_locate, _bend, summed=True, turns=True)


def in_the_mean(nodes: Sequence[int], places: Array, weights: Array, axes: Array) -> Grip:
    """The frame of some nodes.

    Args:
        nodes: Of the body, k of them.
        places: Unloaded, shape (k, 3).
        weights: Of the nodes, such as the areas that they carry, shape (k,).
        axes: Of the frame, unloaded, as rows, shape (3, 3).

    Raises:
        ValueError: The nodes are at one place or on a line.
    """
    shares = weights / weights.sum()
    arms = (places - shares @ places) @ axes.T
    extents = np.linalg.svd(arms, compute_uv=False)
    if len(extents) < 2 or extents[1] <= _LINE * extents[0]:
        raise ValueError(
            f"a patch needs nodes that are not on a line, got {len(nodes)} at\n{places}"
        )
    data = np.column_stack([shares, arms]).ravel()
    return Grip(PATCH, tuple(map(int, nodes)), tuple(map(float, data)))
