"""Derivatives of the inertia of reduced-order bodies in a floating frame: compiled.

The functions of :mod:`.floating` are evaluated at complex coordinates: the imaginary part of a
polynomial at ``q + i ε δq`` is its derivative, to round-off.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie.lie.node_types.floating import (
    PlainFloating,
    accelerate,
    multiply,
    nodes_of,
    parts_of,
    spread_forces,
)
from fem_lie.lie.node_types.forces import (
    acceleration,
    acceleration_derivatives,
    pull_back,
    push_forward,
)
from fem_lie.lie.node_types.node_type import POSITION_GRADIENT
from fem_lie.lie.tuples import cross, load_row, store_row

_STEP = 1e-30


@compiled
def _turned_rates(node_type: int, H: Array, column: int, rate: Array, out: Array) -> None:
    """Set the change of coordinate rates by an increment at constant group velocity."""
    out[:] = 0.0
    if node_type >= POSITION_GRADIENT or column < 3:
        return
    axis = load_row(H, column - 2)
    for k in range(1 if node_type & 1 else 0, 4):
        store_row(out, k, cross(axis, load_row(rate, k)))


@compiled
def tangents(
    motion: tuple[Array, Array, Array],
    node_types: Indices,
    floating: PlainFloating,
    block_indices: tuple[Indices, Indices],
    factors: tuple[float, float],
    parts: tuple[Array, Array],
) -> None:
    """Add derivatives of the forces of :mod:`.floating`, pulled back, to those of inertia.

    Args:
        motion: Nodal coordinates, local velocities and their rates.
        node_types: Type of each node.
        floating: See :class:`~fem_lie.lie.node_types.floating.Floating`.
        block_indices: Index of the block of each of its pairs, for derivatives in motion and in
            frames.
        factors: Of the derivatives in accelerations and in velocities.
        parts: Blocks of the derivatives in accelerations and velocities, and in frames.
    """
    (H, v, a), (integers, numbers), (_, damping), (A, K) = motion, floating, factors, parts
    W, X, local = np.empty((4, 3, 6)), np.empty((4, 3, 6)), np.empty((4, 3))
    unit, own, (pushed, turned), pair = np.empty(6), np.empty(6), np.empty((2, 4, 3)), 0
    for body in range(integers[0]):
        nodes = nodes_of(integers, body)
        interfaces, G = parts_of(integers, numbers, body)
        k = nodes.shape[0]
        state = np.zeros((3, k, 4, 3), np.complex128)
        for i in range(k):
            node = nodes[i]
            push_forward(node_types[node], H[node], v[node], pushed)
            state[0, i], state[1, i] = H[node], pushed
            acceleration(node_types[node], H[node], v[node], a[node], local, pushed)
            state[2, i] = pushed
        f, n = np.empty((k, 4, 3), np.complex128), G.shape[0]
        Q, F = np.empty((2, 3, n), np.complex128)
        constant, changed = np.zeros((2, 3, n))
        z = np.zeros((4, (n - 4) // 3), np.complex128)
        accelerate((state[0], state[1], state[2]), numbers[:3], interfaces, z, Q)
        multiply(G, Q.real.copy(), constant)
        for j in range(k):
            node = nodes[j]
            acceleration_derivatives(node_types[node], H[node], v[node], a[node], factors, (W, X))
            real = state[:, j].copy()
            for column in range(6):
                unit[:] = 0.0
                unit[column] = 1.0
                push_forward(node_types[node], H[node], unit, pushed)
                _turned_rates(node_types[node], H[node], column, real[1].real.copy(), turned)
                for of_frames in (False, True):
                    if of_frames:
                        state[0, j] = real[0] + 1j * _STEP * pushed
                        state[1, j] = real[1] + 1j * _STEP * turned
                        state[2, j] = real[2] + 1j * _STEP * X[:, :, column]
                    else:
                        state[1, j] = real[1] + 1j * (_STEP * damping) * pushed
                        state[2, j] = real[2] + 1j * _STEP * W[:, :, column]
                    z[:], f[:], changed[:] = 0.0, 0.0, 0.0
                    accelerate((state[0], state[1], state[2]), numbers[:3], interfaces, z, Q)
                    multiply(G, Q.imag.copy(), changed)
                    F[:] = constant + 1j * changed
                    spread_forces(F, state[0], interfaces, z[0], z[3], f)
                    state[:, j] = real
                    for i in range(k):
                        own[:] = 0.0
                        pull_back(node_types[nodes[i]], H[nodes[i]], f[i].imag / _STEP, 1.0, own)
                        at = pair + k * i + j
                        block = K[block_indices[1][at]] if of_frames else A[block_indices[0][at]]
                        for row in range(6):
                            block[row, column] += own[row]
        pair += k * k
