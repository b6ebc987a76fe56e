"""A place on the geodesic of SE(3) between two frames: the inside of geodesic beam elements.

At ``0 ≤ ξ ≤ 1`` the frame is ``H_a exp(ξ d)``, ``d = log(H_a⁻¹ H_b)``. Its twist, and so the forces
on both nodes, are (:mod:`fem_lie.joints.equations.sliding` has the same with a ξ that moves)::

    J_a = Ad(exp(−ξ d)) − ξ T(ξ d) T⁻¹(−d),    J_b = ξ T(ξ d) T⁻¹(d)
"""

from __future__ import annotations

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie._jit import compiled
from fem_lie.grips.grip import Grip, GripKind


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
def _locate(X: Array, data: Array, H: Array, J: Array) -> None:
    d, E, T = np.empty(6), np.empty((4, 3)), np.empty((6, 6))
    D, A = np.empty((2, 6, 6)), np.empty((6, 6))
    _parts(X, data, d, E, T, D, A)
    lie.compose(X[0], E, H)
    J[0] = A + data[0] * (T @ D[0])
    J[1] = data[0] * (T @ D[1])


@compiled
def _bend(X: Array, data: Array, f: Array, K: Array) -> None:
    """``g = Tᵀ(ξ d) f`` changes by ``−ξ Tᵀ G(ξ d, g) δd``, and ``Ad(E⁻¹)ᵀ f`` with ``E``."""
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


GEODESIC = GripKind(_locate, _bend)


def on_geodesic(a: int, b: int, ξ: float) -> Grip:
    """The frame at ξ between the nodes ``a`` (ξ = 0) and ``b`` (ξ = 1)."""
    return Grip(GEODESIC, (a, b), (ξ,))
