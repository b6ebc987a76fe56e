"""Compiled velocity constraints: rolling without slip, and knife edges.

They constrain the twist of frame B relative to frame A, in the axes of B: ``W V = 0``::

    V = ξ_B − Ad(G⁻¹) ξ_A,    G = H_A⁻¹ H_B,    dV/dt = ξ'_B − Ad(G⁻¹) ξ'_A + ad(V) Ad(G⁻¹) ξ_A

An edge has a constant ``W``, as it is fixed in the local frame. A disc of radius ρ about e₃ of B
that touches the plane across e₃ of A has a ``W`` that depends on the contact point. With ``ν`` the
normal of the plane in B, ``σ n = (ν₁, ν₂, 0)`` and ``t = (n₂, −n₁, 0)`` along the path, the point
of the disc at ``−ρ n`` has no velocity along t and along ``l = ν × t``, across the path::

    t·u + ρ ω₃ = 0,    l·u + ρ σ t·ω = 0

A position constraint, ``Δ₃ = ρ σ``, keeps the disc on the plane.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled


class RollingArrays(NamedTuple):
    """Packed arrays of all velocity constraints: ``j`` pairs of frames with ``k`` constraints.

    Attributes:
        nodes: Nodes A and B, shape (j, 2).
        frames: Joint frames in the frames of their nodes, shape (j, 2, 4, 3).
        first: First constraint of each pair in these arrays, and ``k`` at the end, shape (j + 1,).
        selection: ``W`` of edges, shape (k, 6).
        radius: Radius of discs, 0 for edges, shape (j,).
        incidences: Incidence of each constraint with the nodes of its sides A and B, −1: that side
            does not move, shape (k, 2).
        start: Number of the first of these constraints among all, shape (1,).
    """

    nodes: Indices
    frames: Array
    first: Indices
    selection: Array
    radius: Array
    incidences: Indices
    start: Indices


@compiled
def _frames(H: Array, arrays: RollingArrays, j: int, A: Array, B: Array, G: Array) -> None:
    """Both frames and ``G = H_A⁻¹ H_B`` of pair j."""
    lie.compose(H[arrays.nodes[j, 0]], arrays.frames[j, 0], A)
    lie.compose(H[arrays.nodes[j, 1]], arrays.frames[j, 1], B)
    for k in range(3):
        G[0, k] = 0.0
        for i in range(3):
            G[0, k] += A[1 + k, i] * (B[0, i] - A[0, i])
        for n in range(3):
            G[1 + n, k] = 0.0
            for i in range(3):
                G[1 + n, k] += A[1 + k, i] * B[1 + n, i]


@compiled
def _disc(G: Array, radius: float, V: Array, W: Array, rate: Array) -> None:
    """Both rows of a disc, (2, 6), and their rates at the relative twist ``V``."""
    nu = np.array([G[1, 2], G[2, 2], G[3, 2]])
    change = np.cross(nu, V[3:])
    sigma = math.sqrt(nu[0] ** 2 + nu[1] ** 2)
    n0, n1 = nu[0] / sigma, nu[1] / sigma
    along = n0 * change[0] + n1 * change[1]
    d0, d1 = (change[0] - n0 * along) / sigma, (change[1] - n1 * along) / sigma
    t, dt = np.array([n1, -n0, 0.0]), np.array([d1, -d0, 0.0])
    W[:], rate[:] = 0.0, 0.0
    W[0, :3], rate[0, :3] = t, dt
    W[0, 5] = radius
    W[1, :3], rate[1, :3] = np.cross(nu, t), np.cross(change, t) + np.cross(nu, dt)
    W[1, 3:], rate[1, 3:] = radius * sigma * t, radius * (along * t + sigma * dt)


@compiled
def _rows(
    H: Array, v: Array, arrays: RollingArrays, j: int, G: Array, V: Array, W: Array, rate: Array
) -> Array:
    """Compute ``G``, ``V``, rows ``W`` (≥ k, 6) and their rates; return ``Ad(G⁻¹) ξ_A``."""
    A, B = np.empty((4, 3)), np.empty((4, 3))
    carried = np.zeros(6)
    _frames(H, arrays, j, A, B, G)
    V[:] = 0.0
    if arrays.nodes[j, 1] < v.shape[0]:
        lie.apply_adjoint_inverse(arrays.frames[j, 1], v[arrays.nodes[j, 1]], V)
    if arrays.nodes[j, 0] < v.shape[0]:
        lie.apply_adjoint_inverse(arrays.frames[j, 0], v[arrays.nodes[j, 0]], carried)
        lie.apply_adjoint_inverse(G, carried, carried)
        V -= carried
    if arrays.radius[j] > 0.0:
        _disc(G, arrays.radius[j], V, W, rate)
    else:
        for i in range(arrays.first[j + 1] - arrays.first[j]):
            W[i], rate[i] = arrays.selection[arrays.first[j] + i], 0.0
    return carried


@compiled
def _side(arrays: RollingArrays, j: int, side: int, G: Array, force: Array, out: Array) -> None:
    """Nodal force of a side due to ``force``, which is conjugate to the relative twist."""
    if side == 1:
        lie.apply_adjoint_inverse_transposed(arrays.frames[j, 1], force, out)
        return
    lie.apply_adjoint_inverse_transposed(G, force, out)
    for k in range(6):
        out[k] = -out[k]
    lie.apply_adjoint_inverse_transposed(arrays.frames[j, 0], out, out)


@compiled
def evaluate(
    H: Array,
    v: Array,
    arrays: RollingArrays,
    multipliers: Array,
    scale: Array,
    count: int,
    r: Array,
) -> None:
    """Add ``Wᵀλ`` to the nodal rows of ``r``; set the rows of the constraints to ``scale W V``.

    Arguments as in :func:`fem_lie.joints.equations.terms.evaluate`.
    """
    G, V, W, rate = np.empty((4, 3)), np.empty(6), np.empty((6, 6)), np.empty((6, 6))
    force, moved = np.empty(6), np.empty(6)
    for j in range(arrays.nodes.shape[0]):
        _rows(H, v, arrays, j, G, V, W, rate)
        force[:] = 0.0
        for i in range(arrays.first[j + 1] - arrays.first[j]):
            row = arrays.start[0] + arrays.first[j] + i
            r[6 * count + row] = scale[row] * (W[i] @ V)
            force += multipliers[row] * W[i]
        for side in range(2):
            node = arrays.nodes[j, side]
            if node < count:
                _side(arrays, j, side, G, force, moved)
                for k in range(6):
                    r[6 * node + k] += moved[k]


@compiled
def jacobian(H: Array, arrays: RollingArrays, rows: Array) -> None:
    """Add ``W`` in nodal twists to the constraint Jacobian, one row of six per incidence."""
    G, V, W, rate = np.empty((4, 3)), np.empty(6), np.empty((6, 6)), np.empty((6, 6))
    moved, still = np.empty(6), np.zeros((0, 6))
    for j in range(arrays.nodes.shape[0]):
        _rows(H, still, arrays, j, G, V, W, rate)
        for i in range(arrays.first[j + 1] - arrays.first[j]):
            for side in range(2):
                incidence = arrays.incidences[arrays.first[j] + i, side]
                if incidence >= 0:
                    _side(arrays, j, side, G, W[i], moved)
                    for k in range(6):
                        rows[incidence, k] += moved[k]


@compiled
def rates(H: Array, v: Array, arrays: RollingArrays, first: Array, second: Array) -> None:
    """``W V`` and its rate at constant twists, into the rows of these constraints."""
    G, V, W, rate = np.empty((4, 3)), np.empty(6), np.empty((6, 6)), np.empty((6, 6))
    change = np.empty(6)
    for j in range(arrays.nodes.shape[0]):
        carried = _rows(H, v, arrays, j, G, V, W, rate)
        change[:3] = np.cross(V[3:], carried[:3]) + np.cross(V[:3], carried[3:])
        change[3:] = np.cross(V[3:], carried[3:])
        for i in range(arrays.first[j + 1] - arrays.first[j]):
            row = arrays.start[0] + arrays.first[j] + i
            first[row] = W[i] @ V
            second[row] = W[i] @ change + rate[i] @ V


@compiled
def wrenches(
    H: Array, arrays: RollingArrays, multipliers: Array, items: Indices, out: Array
) -> None:
    """Add force and moment on frame A, in that frame, to the rows ``items`` (j,) of ``out``."""
    G, V, W, rate = np.empty((4, 3)), np.empty(6), np.empty((6, 6)), np.empty((6, 6))
    force, still = np.empty(6), np.zeros((0, 6))
    for j in range(arrays.nodes.shape[0]):
        _rows(H, still, arrays, j, G, V, W, rate)
        force[:] = 0.0
        for i in range(arrays.first[j + 1] - arrays.first[j]):
            force += multipliers[arrays.start[0] + arrays.first[j] + i] * W[i]
        lie.apply_adjoint_inverse_transposed(G, force, force)
        out[items[j]] += force
