"""Inertia of reduced-order bodies: a floating frame and modal coordinates within it; compiled.

The coordinates ``z`` are those of :mod:`.floating_coordinates`. Positions of all points of a body
are linear in ``Q = (x, d_k, z_a d_k)``, so that inertia is a constant matrix times ``Q̈``,
gyroscopic and centrifugal forces included. The part of the matrix in ``(x, d_k)`` only is inertia
of the frame's node, and is not included here.
"""

from __future__ import annotations

from typing import Any, NamedTuple, TypeAlias

import numba
import numpy as np
from numba import types

from fem_lie._arrays import Array, Indices
from fem_lie._jit import callback, compiled, inlined, inlined_uncounted, uncounted
from fem_lie._jit.by_address import call_with_arrays
from fem_lie._jit.copies import copy_matrix
from fem_lie._jit.packed_arrays import Integers1, Numbers1
from fem_lie._jit.stack import blocks_at, matrix_at, stack, vector_at
from fem_lie.lie.node_types.floating_coordinates import (
    Rows,
    add_amplitudes,
    add_products,
    coordinates,
    spread,
)
from fem_lie.lie.node_types.forces import push_forward
from fem_lie.lie.tuples import Vector, cross, load, plus, scaled

PlainFloating: TypeAlias = tuple[Integers1, Numbers1]
"""A :class:`Floating` as a plain tuple, which is faster to pass from Python."""

_HEAD = 3  # of the numbers: gravity
_FORCES, _INVARIANTS, _WEIGHTS = -3, -2, -1  # addresses, at the end of the integers
_OTHERS, _SIZE, _NUMBERS, _NODES = range(4)  # in the integers of a body; its nodes come last


class FloatingModes(NamedTuple):
    """Mass and stiffness of a body that deforms within the frame of its first node.

    Attributes:
        interfaces: Positions and directors of the other interfaces in that frame, (i, 4, 3).
        inertia: Mass matrix in ``Q``, with z_a d_1, z_a d_2, z_a d_3 for one coordinate after the
            other, without that of the nodes themselves, (4 + 3 m, 4 + 3 m).
        stiffness: ``K`` of the energy ``½ eᵀ K e`` of the strains ``e``, (m, m).
        quadratic: ``Q_abc`` of the strains, (m, m, m).
    """

    interfaces: Array
    inertia: Array
    stiffness: Array
    quadratic: Array


class Floating(NamedTuple):
    """All reduced-order bodies of a scene, packed: inertia beyond that of frames, and stiffness.

    Attributes:
        integers: Number of bodies, start of each body in this array, and for each body: number of
            other interfaces, number of coordinates, start in ``numbers``, and its nodes; then
            addresses of the compiled functions, so that scenes without such bodies do not compile
            them.
        numbers: Acceleration of gravity (3,), and for each body ``X`` and ``D`` of its other
            interfaces, 12 each; the matrix of ``Q``, sorted by directors, zero in the first four
            rows and columns; the stiffness; and ``Q_abc`` at ``[c, a, b]``.
    """

    integers: Indices
    numbers: Array

    @classmethod
    def of(cls, bodies: list[tuple[Indices, FloatingModes]]) -> Floating:
        """Pack bodies with the indices of their nodes."""
        own: list[int] = []
        starts, numbers = [], [np.zeros(_HEAD)]
        for nodes, (interfaces, matrix, stiffness, quadratic) in bodies:
            starts.append(1 + len(bodies) + len(own))
            at = sum(len(part) for part in numbers)
            own += [len(interfaces), (len(matrix) - 4) // 3, at, *map(int, nodes)]
            m = (len(matrix) - 4) // 3
            order = np.r_[:4, 4 + np.arange(3 * m).reshape(m, 3).T.ravel()]
            numbers += [np.ravel(interfaces), np.ravel(matrix[np.ix_(order, order)])]
            numbers += [np.ravel(stiffness), np.ravel(quadratic.transpose(2, 0, 1))]
        functions = (_add_forces, _add_invariants, _add_weights) if bodies else ()
        addresses = [function.address for function in functions]
        integers = np.array([len(bodies), *starts, *own, *addresses], dtype=np.int64)
        return cls(integers, np.concatenate(numbers))

    @property
    def plain(self) -> PlainFloating:
        """The same as a plain tuple, which is faster to pass to compiled functions."""
        return (*self,)

    @property
    def contents(self) -> tuple[Indices, Array]:
        """Contents that are equal in all processes: without addresses, and without gravity."""
        return self.integers[: min(_FORCES, _INVARIANTS, _WEIGHTS)], self.numbers[_HEAD:]

    @property
    def sizes(self) -> Indices:
        """Number of coordinates of each body."""
        return self.integers[self.integers[1 : 1 + self.integers[0]] + _SIZE]

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
    """Nodes of the body with index ``body``."""
    at = integers[1 + body]
    return integers[at + _NODES : at + _NODES + _count(integers, at)]


@inlined_uncounted
def _count(integers: Indices, at: int) -> int:
    """Number of nodes of the body whose integers start at ``at``."""
    others, size = integers[at + _OTHERS], integers[at + _SIZE]
    return int(1 + others + (size - 6 * others + 5) // 6)


@compiled
def parts_of(integers: Indices, numbers: Array, body: int) -> tuple[Array, Array]:
    """Interfaces (i, 4, 3) and mass matrix (4 + 3 m, 4 + 3 m) of a body."""
    at = integers[1 + body]
    others, n = integers[at + _OTHERS], 4 + 3 * integers[at + _SIZE]
    first = integers[at + _NUMBERS]
    middle = first + 12 * others
    interfaces = numbers[first:middle].reshape((others, 4, 3))
    return interfaces, numbers[middle : middle + n * n].reshape((n, n))


@compiled
def elastic_of(integers: Indices, numbers: Array, body: int) -> tuple[Array, Array]:
    """Stiffness (m, m) of a body, and ``Q_abc`` at ``[c, a, b]``."""
    at = integers[1 + body]
    m, n = integers[at + _SIZE], 4 + 3 * integers[at + _SIZE]
    first = integers[at + _NUMBERS] + 12 * integers[at + _OTHERS] + n * n
    last = first + m * m
    return numbers[first:last].reshape((m, m)), numbers[last : last + m**3].reshape((m, m, m))


@uncounted
def accelerate(
    motion: tuple[Rows, Rows, Rows], gravity: Array, interfaces: Array, z: Rows, Q: Rows
) -> None:
    """Set ``Q̈`` less gravity, (3, 4 + 3 m), and ``z`` with its first and second rates, (3, m).

    ``z`` must be zero at the call.
    """
    q, rate, second = motion
    others, m = interfaces.shape[0], z.shape[1]
    coordinates(q, interfaces, z[0])
    add_products(rate[0], q, interfaces, 1.0, z[1])
    add_products(q[0], rate, interfaces, 1.0, z[1])
    add_amplitudes(rate, others, z[1])
    add_products(second[0], q, interfaces, 1.0, z[2])
    add_products(rate[0], rate, interfaces, 2.0, z[2])
    add_products(q[0], second, interfaces, 1.0, z[2])
    add_amplitudes(second, others, z[2])
    for j in range(3):
        Q[j, 0] = second[0, 0, j] - gravity[j]
        for k in range(3):
            d, v, w = q[0, 1 + k, j], 2.0 * rate[0, 1 + k, j], second[0, 1 + k, j]
            Q[j, 1 + k] = w
            row = Q[j, 4 + k * m : 4 + (k + 1) * m]
            for a in range(m):
                row[a] = z[2, a] * d + z[1, a] * v + z[0, a] * w


@uncounted
def multiply(G: Array, Q: Rows, F: Rows) -> None:
    """Add ``Q G`` to ``F``, both (3, 4 + 3 m); sums along rows of ``G`` are vectorised."""
    F0, F1, F2 = F[0], F[1], F[2]
    for c in range(G.shape[0]):
        row, Q0, Q1, Q2 = G[c], Q[0, c], Q[1, c], Q[2, c]
        for r in range(G.shape[0]):
            F0[r] += row[r] * Q0
            F1[r] += row[r] * Q1
            F2[r] += row[r] * Q2


@uncounted
def spread_forces(F: Rows, q: Rows, interfaces: Array, z: Rows, g: Rows, f: Rows) -> None:
    """Add forces ``F`` on ``Q`` as forces on nodal coordinates to ``f`` (k, 4, 3).

    ``g`` (m,) must be zero at the call.
    """
    m = z.shape[0]
    for j in range(3):
        f[0, 0, j] += F[j, 0]
        for k in range(3):
            d, turning, row = q[0, 1 + k, j], F[j, 1 + k], F[j, 4 + k * m : 4 + (k + 1) * m]
            for a in range(m):
                g[a] += d * row[a]
                turning += z[a] * row[a]
            f[0, 1 + k, j] += turning
    spread(g, q, interfaces, f)


@inlined
def add_forces(
    node_types: Indices,
    H: Array,
    v: Array,
    second: Array,
    integers: Indices,
    numbers: Array,
    out: Array,
) -> None:
    """Add inertia forces less weight of all bodies to forces on nodal coordinates.

    Args:
        node_types: Type of each node, shape (n,).
        H: Nodal coordinates.
        v: Twists.
        second: Accelerations of all nodal coordinates, shape (n, 4, 3).
        integers: See :class:`Floating`.
        numbers: See :class:`Floating`.
        out: Shape (n, 4, 3).
    """
    arrays = node_types, H, v, second, integers, numbers, out
    sizes = H.shape[0], second.shape[0], integers.shape[0], numbers.shape[0]
    call_with_arrays(integers[_FORCES], arrays, sizes)


_Integers, _Doubles = types.CPointer(types.int64), types.CPointer(types.float64)


@callback(types.void(_Integers, *[_Doubles] * 3, _Integers, *[_Doubles] * 2, *[types.int64] * 4))
def _add_forces(
    kinds_at: Any,
    H_at: Any,
    v_at: Any,
    second_at: Any,
    integers_at: Any,
    numbers_at: Any,
    out_at: Any,
    count: int,
    masters: int,
    size: int,
    length: int,
) -> None:
    """:func:`add_forces` with addresses and sizes of the arrays."""
    _add_all_forces(
        numba.carray(kinds_at, (count,)),
        numba.carray(H_at, (count, 4, 3)),
        numba.carray(v_at, (masters, 6)),
        numba.carray(second_at, (masters, 4, 3)),
        numba.carray(integers_at, (size,)),
        numba.carray(numbers_at, (length,)),
        numba.carray(out_at, (masters, 4, 3)),
    )


@uncounted
def _add_all_forces(
    node_types: Indices,
    H: Array,
    v: Array,
    second: Array,
    integers: Indices,
    numbers: Array,
    out: Array,
) -> None:
    for body in range(integers[0]):
        at = integers[1 + body]
        others, n = integers[at + _OTHERS], 4 + 3 * integers[at + _SIZE]
        first = integers[at + _NUMBERS]
        middle = first + 12 * others
        interfaces = numbers[first:middle].reshape((others, 4, 3))
        G = numbers[middle : middle + n * n].reshape((n, n))
        nodes = integers[at + _NODES : at + _NODES + _count(integers, at)]
        _add_forces_of(node_types, (H, v, second), numbers[:_HEAD], nodes, (interfaces, G), out)


@uncounted
def _add_forces_of(
    node_types: Indices,
    motion: tuple[Array, Array, Array],
    gravity: Array,
    nodes: Indices,
    parts: tuple[Array, Array],
    out: Array,
) -> None:
    """Add the forces of one body; see :func:`add_forces` and :func:`parts_of`."""
    (H, v, second), (interfaces, G) = motion, parts
    k, n, m = nodes.shape[0], G.shape[0], (G.shape[0] - 4) // 3
    q, rate = blocks_at(stack(12 * k), k, 4, 3), blocks_at(stack(12 * k), k, 4, 3)
    acceleration, f = blocks_at(stack(12 * k), k, 4, 3), blocks_at(stack(12 * k), k, 4, 3)
    Q, F = matrix_at(stack(3 * n), 3, n), matrix_at(stack(3 * n), 3, n)
    z = matrix_at(stack(4 * m), 4, m)
    z[:], F[:], f[:] = 0.0, 0.0, 0.0
    for i in range(k):
        node = nodes[i]
        for row in range(4):
            for j in range(3):
                q[i, row, j], acceleration[i, row, j] = H[node, row, j], second[node, row, j]
        push_forward(node_types[node], H[node], v[node], rate[i])
    accelerate((q, rate, acceleration), gravity, interfaces, z, Q)
    multiply(G, Q, F)
    spread_forces(F, q, interfaces, z[0], z[3], f)
    for i in range(k):
        for row in range(4):
            for j in range(3):
                out[nodes[i], row, j] += f[i, row, j]


@inlined
def add_invariants(
    H: Array, qdot: Array, count: int, integers: Indices, numbers: Array, invariants: Array
) -> float:
    """Add kinetic energy and momenta (7,) of coordinate rates; return the potential energy.

    Args:
        H: Nodal coordinates.
        qdot: Rates of the coordinates of ``count`` nodes and, if they are independent, of vectors
            ``(0, z_a d_k)`` of all coordinates of all bodies, (≥ count, 4, 3).
        count: Number of moving nodes.
        integers: See :class:`Floating`.
        numbers: See :class:`Floating`.
        invariants: Kinetic energy, momentum, angular momentum, added to, shape (7,).
    """
    potential = vector_at(stack(1), 1)
    arrays = H, qdot, integers, numbers, invariants, potential
    sizes = H.shape[0], qdot.shape[0], count, integers.shape[0], numbers.shape[0]
    call_with_arrays(integers[_INVARIANTS], arrays, sizes)
    return float(potential[0])


@callback(types.void(*[_Doubles] * 2, _Integers, *[_Doubles] * 3, *[types.int64] * 5))
def _add_invariants(
    H_at: Any,
    qdot_at: Any,
    integers_at: Any,
    numbers_at: Any,
    invariants_at: Any,
    potential_at: Any,
    count: int,
    rates: int,
    masters: int,
    size: int,
    length: int,
) -> None:
    """:func:`add_invariants` with addresses and sizes of the arrays."""
    numba.carray(potential_at, (1,))[0] = _add_all_invariants(
        numba.carray(H_at, (count, 4, 3)),
        numba.carray(qdot_at, (rates, 4, 3)),
        masters,
        numba.carray(integers_at, (size,)),
        numba.carray(numbers_at, (length,)),
        numba.carray(invariants_at, (7,)),
    )


@uncounted
def _add_all_invariants(
    H: Array, qdot: Array, count: int, integers: Indices, numbers: Array, invariants: Array
) -> float:
    potential, beyond = 0.0, count
    for body in range(integers[0]):
        at = integers[1 + body]
        others, n = integers[at + _OTHERS], 4 + 3 * integers[at + _SIZE]
        first = integers[at + _NUMBERS]
        middle = first + 12 * others
        interfaces = numbers[first:middle].reshape((others, 4, 3))
        G = numbers[middle : middle + n * n].reshape((n, n))
        nodes = integers[at + _NODES : at + _NODES + _count(integers, at)]
        rates = qdot[beyond : beyond + integers[at + _SIZE]] if qdot.shape[0] > count else qdot[:0]
        beyond += integers[at + _SIZE]
        weight = _add_invariants_of((H, qdot, rates), nodes, (interfaces, G), invariants)
        for j in range(3):
            potential -= weight[j] * numbers[j]
    return potential


@uncounted
def _add_invariants_of(
    rows: tuple[Array, Array, Array],
    nodes: Indices,
    parts: tuple[Array, Array],
    invariants: Array,
) -> Vector:
    """Add the invariants of one body; return its first moment of mass beyond that of its frame."""
    (H, qdot, known), (interfaces, G) = rows, parts
    k, n, m = nodes.shape[0], G.shape[0], (G.shape[0] - 4) // 3
    q, rate = blocks_at(stack(12 * k), k, 4, 3), blocks_at(stack(12 * k), k, 4, 3)
    Q, V = matrix_at(stack(3 * n), 3, n), matrix_at(stack(3 * n), 3, n)
    P, z = matrix_at(stack(3 * n), 3, n), matrix_at(stack(2 * m), 2, m)
    P[:], z[:] = 0.0, 0.0
    for i in range(k):
        for row in range(4):
            for j in range(3):
                q[i, row, j], rate[i, row, j] = H[nodes[i], row, j], qdot[nodes[i], row, j]
    coordinates(q, interfaces, z[0])
    add_products(rate[0], q, interfaces, 1.0, z[1])
    add_products(q[0], rate, interfaces, 1.0, z[1])
    add_amplitudes(rate, interfaces.shape[0], z[1])
    for j in range(3):
        for i in range(4):
            Q[j, i], V[j, i] = q[0, i, j], rate[0, i, j]
        for i in range(3):
            d, v, at = q[0, 1 + i, j], rate[0, 1 + i, j], 4 + i * m
            for a in range(m):
                Q[j, at + a], V[j, at + a] = z[0, a] * d, z[1, a] * d + z[0, a] * v
                if known.shape[0] > 0:
                    V[j, at + a] = known[a, 1 + i, j]
    multiply(G, V, P)
    for r in range(n):
        for j in range(3):
            invariants[0] += 0.5 * V[j, r] * P[j, r]
            one, two = (j + 1) % 3, (j + 2) % 3
            invariants[4 + j] += Q[one, r] * P[two, r] - Q[two, r] * P[one, r]
    first = 0.0, 0.0, 0.0
    for r in range(4, n):
        first = plus(first, scaled(G[0, r], (Q[0, r], Q[1, r], Q[2, r])))
    for j in range(3):
        invariants[1 + j] += P[j, 0]
    return first


@inlined
def add_weights(H: Array, integers: Indices, numbers: Array, out: Array, at: int) -> None:
    """Add the moments of weight about the origin beyond those of the frames to ``out``."""
    arrays = H, integers, numbers, out
    sizes = H.shape[0], integers.shape[0], numbers.shape[0], out.shape[0], at
    call_with_arrays(integers[_WEIGHTS], arrays, sizes)


@callback(types.void(_Doubles, _Integers, *[_Doubles] * 2, *[types.int64] * 5))
def _add_weights(
    H_at: Any,
    integers_at: Any,
    numbers_at: Any,
    out_at: Any,
    count: int,
    size: int,
    length: int,
    row: int,
    at: int,
) -> None:
    """:func:`add_weights` with addresses and sizes of the arrays."""
    _add_all_weights(
        numba.carray(H_at, (count, 4, 3)),
        numba.carray(integers_at, (size,)),
        numba.carray(numbers_at, (length,)),
        numba.carray(out_at, (row,)),
        at,
    )


@compiled
def _add_all_weights(H: Array, integers: Indices, numbers: Array, out: Array, at: int) -> None:
    gravity = load(numbers, 0)
    if gravity == (0.0, 0.0, 0.0):
        return
    for body in range(integers[0]):
        nodes = nodes_of(integers, body)
        interfaces, G = parts_of(integers, numbers, body)
        m, first = (G.shape[0] - 4) // 3, np.zeros(3)
        q, z = np.empty((nodes.shape[0], 4, 3)), np.zeros(m)
        for i in range(nodes.shape[0]):
            copy_matrix(H[nodes[i]], q[i])
        coordinates(q, interfaces, z)
        for a in range(m):
            for c in range(3):
                first += G[0, 4 + c * m + a] * z[a] * q[0, 1 + c]
        moment = cross(load(first, 0), gravity)
        for j in range(3):
            out[at + j] += moment[j]
