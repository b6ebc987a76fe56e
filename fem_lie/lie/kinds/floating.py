r"""Inertia of bodies that move with one frame and deform in few shapes within it: compiled.

Coordinates ``z`` are those of :mod:`.floating_coordinates`. Every point of a body has rows that are
linear in ``Q = (x, d_k, z_a d_k)``, so that inertia is ``Q̈`` times a constant matrix, gyroscopic
and centrifugal forces included; what of it is in ``(x, d_k)`` alone is inertia of the frame's node
and none of this. For derivatives the same functions are called with complex rows: the imaginary
part of a polynomial at ``q + i ε δq`` is its derivative, to round-off.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie.lie.kinds.floating_coordinates import (
    Rows,
    add_amplitudes,
    add_products,
    coordinates,
    spread,
)
from fem_lie.lie.kinds.forces import acceleration, acceleration_derivatives, pull, push
from fem_lie.lie.kinds.kind import SLOPE
from fem_lie.lie.tuples import cross, load, load_row, store_row

PlainFloating: TypeAlias = tuple[Indices, Array]
"""A :class:`Floating` at the door from Python."""

_STEP = 1e-30
_HEAD = 3  # of the numbers: gravity
_OTHERS, _SIZE, _NUMBERS, _NODES = range(4)  # in the integers of a body; its nodes come last


class Floating(NamedTuple):
    """Inertia of such bodies beyond that of their frames.

    Attributes:
        integers: How many there are, where each begins in this array, and of each: other
            interfaces, coordinates, where it begins in ``numbers``, and its nodes.
        numbers: Acceleration of free fall, and of each body ``X`` and ``D`` of its other
            interfaces, 12 each, and the matrix of ``Q``, whose first four rows have nothing in the
            first four columns.
    """

    integers: Indices
    numbers: Array

    @classmethod
    def of(cls, bodies: list[tuple[Indices, Array, Array]]) -> Floating:
        """Pack bodies: nodes, places and directors (i, 4, 3) of other interfaces, matrix."""
        own: list[int] = []
        starts, numbers = [], [np.zeros(_HEAD)]
        for nodes, interfaces, matrix in bodies:
            starts.append(1 + len(bodies) + len(own))
            at = sum(len(part) for part in numbers)
            own += [len(interfaces), (len(matrix) - 4) // 3, at, *map(int, nodes)]
            numbers += [np.ravel(interfaces), np.ravel(matrix)]
        integers = np.array([len(bodies), *starts, *own], dtype=np.int64)
        return cls(integers, np.concatenate(numbers))

    @property
    def plain(self) -> PlainFloating:
        """As compiled functions are quicker to call with."""
        return (*self,)

    @property
    def pairs(self) -> tuple[Indices, Indices]:
        """Nodes of each block of :func:`tangents`."""
        found: list[Indices] = [np.empty((2, 0), dtype=np.int64)]
        for body in range(self.integers[0]):
            nodes = nodes_of(self.integers, body)
            found.append(np.array([np.repeat(nodes, len(nodes)), np.tile(nodes, len(nodes))]))
        rows, columns = np.concatenate(found, axis=1)
        return rows, columns


@compiled
def nodes_of(integers: Indices, body: int) -> Indices:
    """Nodes of a body."""
    at = integers[1 + body]
    others, size = integers[at + _OTHERS], integers[at + _SIZE]
    count = 1 + others + (size - 6 * others + 5) // 6
    return integers[at + _NODES : at + _NODES + count]


@compiled
def _parts(integers: Indices, numbers: Array, body: int) -> tuple[Array, Array]:
    """Interfaces (i, 4, 3) and matrix of a body."""
    at = integers[1 + body]
    others, n = integers[at + _OTHERS], 4 + 3 * integers[at + _SIZE]
    first = integers[at + _NUMBERS]
    middle = first + 12 * others
    interfaces = numbers[first:middle].reshape((others, 4, 3))
    return interfaces, numbers[middle : middle + n * n].reshape((n, n))


@compiled
def _row_forces(
    motion: tuple[Rows, Rows, Rows], gravity: Array, interfaces: Array, G: Array, f: Rows
) -> None:
    """Add inertia less weight on rows (k, 4, 3) with rates and accelerations, to ``f``."""
    q, rate, second = motion
    others, m = interfaces.shape[0], (G.shape[0] - 4) // 3
    z, dz, ddz = np.zeros(m, q.dtype), np.zeros(m, q.dtype), np.zeros(m, q.dtype)
    coordinates(q, interfaces, z)
    add_products(rate[0], q, interfaces, 1.0, dz)
    add_products(q[0], rate, interfaces, 1.0, dz)
    add_amplitudes(rate, others, dz)
    add_products(second[0], q, interfaces, 1.0, ddz)
    add_products(rate[0], rate, interfaces, 2.0, ddz)
    add_products(q[0], second, interfaces, 1.0, ddz)
    add_amplitudes(second, others, ddz)
    Q, F = np.empty((4 + 3 * m, 3), q.dtype), np.zeros((4 + 3 * m, 3), q.dtype)
    for j in range(3):
        Q[0, j] = second[0, 0, j] - gravity[j]
        for k in range(3):
            Q[1 + k, j] = second[0, 1 + k, j]
    for a in range(m):
        for k in range(3):
            for j in range(3):
                moved = ddz[a] * q[0, 1 + k, j] + 2.0 * dz[a] * rate[0, 1 + k, j]
                Q[4 + 3 * a + k, j] = moved + z[a] * second[0, 1 + k, j]
    _multiply(G, Q, F)
    for k in range(4):
        for j in range(3):
            f[0, k, j] += F[k, j]
    g = np.zeros(m, q.dtype)
    for a in range(m):
        for k in range(3):
            for j in range(3):
                force = F[4 + 3 * a + k, j]
                g[a] += q[0, 1 + k, j] * force
                f[0, 1 + k, j] += z[a] * force
    spread(g, q, interfaces, f)


@compiled
def _multiply(G: Array, Q: Rows, F: Rows) -> None:
    for r in range(G.shape[0]):
        s0, s1, s2 = F[r, 0], F[r, 1], F[r, 2]
        for c in range(4 if r < 4 else 0, G.shape[0]):
            s0 += G[r, c] * Q[c, 0]
            s1 += G[r, c] * Q[c, 1]
            s2 += G[r, c] * Q[c, 2]
        F[r, 0], F[r, 1], F[r, 2] = s0, s1, s2


@compiled
def add_forces(
    kinds: Indices,
    H: Array,
    v: Array,
    second: Array,
    integers: Indices,
    numbers: Array,
    out: Array,
) -> None:
    """Add inertia less weight of all bodies on rows of nodes.

    Args:
        kinds: Of all nodes, shape (n,).
        H: Frames.
        v: Twists.
        second: Accelerations of all rows, shape (n, 4, 3).
        integers: See :class:`Floating`.
        numbers: Likewise.
        out: Shape (n, 4, 3).
    """
    for body in range(integers[0]):
        nodes = nodes_of(integers, body)
        interfaces, G = _parts(integers, numbers, body)
        k = nodes.shape[0]
        state, f = np.zeros((3, k, 4, 3)), np.zeros((k, 4, 3))
        for i in range(k):
            state[0, i], state[2, i] = H[nodes[i]], second[nodes[i]]
            push(kinds[nodes[i]], H[nodes[i]], v[nodes[i]], state[1, i])
        _row_forces((state[0], state[1], state[2]), numbers[:_HEAD], interfaces, G, f)
        for i in range(k):
            out[nodes[i]] += f[i]


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
    """Add derivatives of :func:`add_forces`, pulled back, as inertia's own ``tangents`` do.

    Args:
        motion: Frames, local velocities and their rates.
        kinds: Of the nodes.
        floating: See :class:`Floating`.
        places: Of each of its pairs among the blocks of derivatives in motion and in frames.
        factors: Of the derivatives in the accelerations and in the velocities.
        parts: Blocks of derivatives in these, and in frames.
    """
    (H, v, a), (integers, numbers), (_, damping), (A, K) = motion, floating, factors, parts
    W, X, local = np.empty((4, 3, 6)), np.empty((4, 3, 6)), np.empty((4, 3))
    unit, pushed, turned, own, pair = (
        np.empty(6),
        np.empty((4, 3)),
        np.empty((4, 3)),
        np.empty(6),
        0,
    )
    for body in range(integers[0]):
        nodes = nodes_of(integers, body)
        interfaces, G = _parts(integers, numbers, body)
        k = nodes.shape[0]
        state = np.zeros((3, k, 4, 3), np.complex128)
        for i in range(k):
            node = nodes[i]
            push(kinds[node], H[node], v[node], pushed)
            state[0, i], state[1, i] = H[node], pushed
            acceleration(kinds[node], H[node], v[node], a[node], local, pushed)
            state[2, i] = pushed
        f = np.empty((k, 4, 3), np.complex128)
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
                    f[:] = 0.0
                    _row_forces((state[0], state[1], state[2]), numbers[:_HEAD], interfaces, G, f)
                    state[:, j] = real
                    for i in range(k):
                        own[:] = 0.0
                        pull(kinds[nodes[i]], H[nodes[i]], f[i].imag / _STEP, 1.0, own)
                        at = pair + k * i + j
                        block = K[places[1][at]] if of_frames else A[places[0][at]]
                        for row in range(6):
                            block[row, column] += own[row]
        pair += k * k


@compiled
def add_invariants(
    H: Array, qdot: Array, integers: Indices, numbers: Array, invariants: Array
) -> float:
    """Add kinetic energy and momenta (7,) of rates (n, 4, 3) of rows; returns the potential."""
    potential = 0.0
    for body in range(integers[0]):
        nodes = nodes_of(integers, body)
        interfaces, G = _parts(integers, numbers, body)
        others, m, k = interfaces.shape[0], (G.shape[0] - 4) // 3, nodes.shape[0]
        q, rate = np.empty((k, 4, 3)), np.empty((k, 4, 3))
        for i in range(k):
            q[i], rate[i] = H[nodes[i]], qdot[nodes[i]]
        z, dz = np.zeros(m), np.zeros(m)
        coordinates(q, interfaces, z)
        add_products(rate[0], q, interfaces, 1.0, dz)
        add_products(q[0], rate, interfaces, 1.0, dz)
        add_amplitudes(rate, others, dz)
        Q, V, P = np.zeros((G.shape[0], 3)), np.zeros((G.shape[0], 3)), np.zeros((G.shape[0], 3))
        Q[:4], V[:4] = q[0], rate[0]
        for a in range(m):
            for c in range(3):
                Q[4 + 3 * a + c] = z[a] * q[0, 1 + c]
                V[4 + 3 * a + c] = dz[a] * q[0, 1 + c] + z[a] * rate[0, 1 + c]
        _multiply(G, V, P)
        for r in range(G.shape[0]):
            x, y = Q[r], P[r]
            invariants[4] += x[1] * y[2] - x[2] * y[1]
            invariants[5] += x[2] * y[0] - x[0] * y[2]
            invariants[6] += x[0] * y[1] - x[1] * y[0]
            for j in range(3):
                invariants[0] += 0.5 * V[r, j] * y[j]
                potential -= G[0, r] * x[j] * numbers[j] if r > 3 else 0.0
        for j in range(3):
            invariants[1 + j] += P[0, j]
    return potential


@compiled
def add_weights(H: Array, integers: Indices, numbers: Array, out: Array, at: int) -> None:
    """Add the moments about the origin that weight has beyond that of the frames."""
    for body in range(integers[0]):
        nodes = nodes_of(integers, body)
        interfaces, G = _parts(integers, numbers, body)
        m, first = (G.shape[0] - 4) // 3, np.zeros(3)
        q, z = np.empty((nodes.shape[0], 4, 3)), np.zeros(m)
        for i in range(nodes.shape[0]):
            q[i] = H[nodes[i]]
        coordinates(q, interfaces, z)
        for a in range(m):
            for c in range(3):
                first += G[0, 4 + 3 * a + c] * z[a] * q[0, 1 + c]
        moment = cross(load(first, 0), load(numbers, 0))
        for j in range(3):
            out[at + j] += moment[j]
