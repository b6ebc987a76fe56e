"""Compiled constraints of joints: everything is written in the relative motion of two frames.

The frames A and B of a joint are fixed to their nodes. With ``Δ = R_Aᵀ (x_B − x_A)`` and
``Q = R_Aᵀ R_B`` the constraints of every joint here are ``Φ = S z``, ``z = (Δ, Q)`` with a constant
selection ``S``: invariant under rigid motion, at most quadratic in positions and directors. With
twists ``(u, η)`` of the joint frames::

    δΔ = Q u_B − u_A + Δ × η_A        δQ = Q η̂_B − η̂_A Q

The node ``count`` and those after it do not move by themselves: ground and prescribed frames.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie import lie
from fem_lie._jit import Array, Indices, compiled


class JointTable(NamedTuple):
    """All joints of a scene, ``j`` joints with ``m`` constraints.

    Attributes:
        nodes: Nodes A and B, shape (j, 2).
        frames: Frames of the joint in its nodes' frames, shape (j, 2, 4, 3).
        first: First constraint of each joint and ``m`` at the end, shape (j + 1,).
        selection: Rows ``S``, shape (m, 12): three columns for Δ, nine for Q (row-major).
    """

    nodes: Indices
    frames: Array
    first: Indices
    selection: Array


@compiled
def _relative_motion(H: Array, table: JointTable, j: int, A: Array, B: Array, z: Array) -> None:
    """``z = (Δ, Q)`` of joint j, and its two frames."""
    lie.compose(H[table.nodes[j, 0]], table.frames[j, 0], A)
    lie.compose(H[table.nodes[j, 1]], table.frames[j, 1], B)
    for k in range(3):
        z[k] = 0.0
        for i in range(3):
            z[k] += A[1 + k, i] * (B[0, i] - A[0, i])
        for n in range(3):
            q = 0.0
            for i in range(3):
                q += A[1 + k, i] * B[1 + n, i]
            z[3 + 3 * k + n] = q


@compiled
def _variation(z: Array, twist_a: Array, twist_b: Array, out: Array) -> None:
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


@compiled
def _force(z: Array, p: Array, fa: Array, fb: Array) -> None:
    """Forces on the two frames that do the work ``p · δz``."""
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


@compiled
def _multiplier_weights(table: JointTable, j: int, weights: Array, p: Array) -> None:
    """``p = Sᵀ weights`` of joint j: what its constraints do on ``δz``."""
    p[:] = 0.0
    for c in range(table.first[j], table.first[j + 1]):
        for k in range(12):
            p[k] += weights[c] * table.selection[c, k]


@compiled
def evaluate(
    H: Array, table: JointTable, weights: Array, scale: Array, count: int, r: Array
) -> None:
    """Add joint forces ``Bᵀ weights`` to the nodes' rows of ``r``; set its last rows ``scale · Φ``.

    Args:
        H: Frames of all nodes, shape (≥ count, 4, 3).
        table: The joints.
        weights: Multipliers in units of forces and moments, shape (m,).
        scale: Factor of each constraint, shape (m,).
        count: Number of nodes that move.
        r: Residual, shape (6 count + m,), updated.
    """
    A, B, z, p = np.empty((4, 3)), np.empty((4, 3)), np.empty(12), np.empty(12)
    force, moved = np.empty((2, 6)), np.empty(6)
    for j in range(table.nodes.shape[0]):
        _relative_motion(H, table, j, A, B, z)
        for c in range(table.first[j], table.first[j + 1]):
            value = 0.0
            for k in range(12):
                value += table.selection[c, k] * z[k]
            r[6 * count + c] = scale[c] * value
        _multiplier_weights(table, j, weights, p)
        _force(z, p, force[0], force[1])
        for side in range(2):
            node = table.nodes[j, side]
            if node < count:
                lie.apply_adjoint_inverse_transposed(table.frames[j, side], force[side], moved)
                for k in range(6):
                    r[6 * node + k] += moved[k]


@compiled
def wrenches(H: Array, table: JointTable, weights: Array, side: Indices, out: Array) -> None:
    """Force and moment that each joint exerts on its frame A or B (``side`` 0 or 1), in that frame.

    ``out`` has shape (j, 6).
    """
    A, B, z, p = np.empty((4, 3)), np.empty((4, 3)), np.empty(12), np.empty(12)
    force = np.empty((2, 6))
    for j in range(table.nodes.shape[0]):
        _relative_motion(H, table, j, A, B, z)
        _multiplier_weights(table, j, weights, p)
        _force(z, p, force[0], force[1])
        for k in range(6):
            out[j, k] = -force[side[j], k]


@compiled
def jacobian(H: Array, table: JointTable, rows: Array) -> None:
    """``rows[c, side] = ∂Φ_c/∂h`` in the twists of the nodes A and B, shape (m, 2, 6)."""
    A, B, z = np.empty((4, 3)), np.empty((4, 3)), np.empty(12)
    force = np.empty((2, 6))
    for j in range(table.nodes.shape[0]):
        _relative_motion(H, table, j, A, B, z)
        for c in range(table.first[j], table.first[j + 1]):
            _force(z, table.selection[c], force[0], force[1])
            for side in range(2):
                lie.apply_adjoint_inverse_transposed(
                    table.frames[j, side], force[side], rows[c, side]
                )


@compiled
def geometric(H: Array, table: JointTable, weights: Array, place: Indices, K: Array) -> None:
    """Add ``∂(Bᵀ weights)/∂h`` to blocks ``K``; ``place`` (j, 2, 2) says where, −1: nowhere."""
    A, B, z, p = np.empty((4, 3)), np.empty((4, 3)), np.empty(12), np.empty(12)
    twist, still, unit = np.empty(6), np.zeros(6), np.empty(6)
    dz, force, moved = np.empty(12), np.empty((2, 6)), np.empty(6)
    for j in range(table.nodes.shape[0]):
        _relative_motion(H, table, j, A, B, z)
        _multiplier_weights(table, j, weights, p)
        for column in range(12):
            source = column // 6
            if place[j, 0, source] < 0 and place[j, 1, source] < 0:
                continue
            unit[:] = 0.0
            unit[column % 6] = 1.0
            lie.apply_adjoint_inverse(table.frames[j, source], unit, twist)
            if source == 0:
                _variation(z, twist, still, dz)
            else:
                _variation(z, still, twist, dz)
            _force(dz, p, force[0], force[1])
            force[0, :3] = 0.0  # −n: the only part that does not depend on z
            for side in range(2):
                if place[j, side, source] >= 0:
                    lie.apply_adjoint_inverse_transposed(table.frames[j, side], force[side], moved)
                    block = K[place[j, side, source]]
                    for k in range(6):
                        block[k, column % 6] += moved[k]


@compiled
def rates(H: Array, v: Array, table: JointTable, first: Array, second: Array) -> None:
    """``first = dΦ/dt``, ``second = d²Φ/dt²`` (m,) at constant twists ``v`` (nodes, 6)."""
    A, B, z = np.empty((4, 3)), np.empty((4, 3)), np.empty(12)
    ta, tb, dz, ddz = np.empty(6), np.empty(6), np.empty(12), np.empty(12)
    for j in range(table.nodes.shape[0]):
        _relative_motion(H, table, j, A, B, z)
        lie.apply_adjoint_inverse(table.frames[j, 0], v[table.nodes[j, 0]], ta)
        lie.apply_adjoint_inverse(table.frames[j, 1], v[table.nodes[j, 1]], tb)
        _variation(z, ta, tb, dz)
        _variation(dz, ta, tb, ddz)
        for k in range(3):
            ddz[k] += ta[k]  # −u_A is the only part that does not depend on z
        for c in range(table.first[j], table.first[j + 1]):
            first[c] = second[c] = 0.0
            for k in range(12):
                first[c] += table.selection[c, k] * dz[k]
                second[c] += table.selection[c, k] * ddz[k]
