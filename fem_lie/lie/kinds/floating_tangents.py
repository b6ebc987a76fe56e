"""Derivatives of the inertia of bodies that deform in few shapes within a frame: compiled.

The functions of :mod:`.floating` are called with complex rows: the imaginary part of a polynomial
at ``q + i ε δq`` is its derivative, to round-off.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie.lie.kinds.floating import (
    PlainFloating,
    accelerate,
    multiply,
    nodes_of,
    parts_of,
    spread_forces,
)
from fem_lie.lie.kinds.forces import acceleration, acceleration_derivatives, pull, push
from fem_lie.lie.kinds.kind import SLOPE
from fem_lie.lie.tuples import cross, load_row, store_row

_STEP = 1e-30


@compiled
def _turned_rates(kind: int, H: Array, column: int, rate: Array, out: Array) -> None:
    """Set what an increment does to the rates of rows at a constant velocity of the group."""
    out[:] = 0.0
    if kind >= SLOPE or column < 3:
        return
    axis = load_row(H, column - 2)
    for k in range(1 if kind & 1 else 0, 4):
        store_row(out, k, cross(axis, load_row(rate, k)))


@compiled
def tangents(
    motion: tuple[Array, Array, Array],
    kinds: Indices,
    floating: PlainFloating,
    places: tuple[Indices, Indices],
    factors: tuple[float, float],
    parts: tuple[Array, Array],
) -> None:
    """Add derivatives of forces of :mod:`.floating`, pulled back, as those of inertia's tangents.

    Args:
        motion: Frames, local velocities and their rates.
        kinds: Of the nodes.
        floating: See :class:`~fem_lie.lie.kinds.floating.Floating`.
        places: Of each of its pairs among the blocks of derivatives in motion and in frames.
        factors: Of the derivatives in the accelerations and in the velocities.
        parts: Blocks of derivatives in these, and in frames.
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
            push(kinds[node], H[node], v[node], pushed)
            state[0, i], state[1, i] = H[node], pushed
            acceleration(kinds[node], H[node], v[node], a[node], local, pushed)
            state[2, i] = pushed
        f, n = np.empty((k, 4, 3), np.complex128), G.shape[0]
        Q, F = np.empty((2, 3, n), np.complex128)
        constant, changed = np.zeros((2, 3, n))
        z = np.zeros((4, (n - 4) // 3), np.complex128)
        accelerate((state[0], state[1], state[2]), numbers[:3], interfaces, z, Q)
        multiply(G, Q.real.copy(), constant)
        for j in range(k):
            node = nodes[j]
            acceleration_derivatives(kinds[node], H[node], v[node], a[node], factors, (W, X))
            real = state[:, j].copy()
            for column in range(6):
                unit[:] = 0.0
                unit[column] = 1.0
                push(kinds[node], H[node], unit, pushed)
                _turned_rates(kinds[node], H[node], column, real[1].real.copy(), turned)
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
                        pull(kinds[nodes[i]], H[nodes[i]], f[i].imag / _STEP, 1.0, own)
                        at = pair + k * i + j
                        block = K[places[1][at]] if of_frames else A[places[0][at]]
                        for row in range(6):
                            block[row, column] += own[row]
        pair += k * k
