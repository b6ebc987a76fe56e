r"""Products ``z_a d_k`` of reduced-order bodies as coordinates with inertia, at one time; compiled.

Definitions, and their use over a step, are in :mod:`.reduced_bodies`.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie.lie.node_types import inertia, pull_all_back, push_all_forward
from fem_lie.lie.node_types.floating import (
    Floating,
    accelerate,
    elastic_of,
    nodes_of,
    parts_of,
    spread_forces,
)
from fem_lie.lie.node_types.floating_coordinates import add_times, coordinates, strains
from fem_lie.lie.node_types.inertia import Inertia, PlainInertia, multiply


def inertia_with_products(mass: Inertia, bodies: Floating) -> Inertia:
    """The mass matrix of nodal coordinates, followed by products."""
    if not bodies.sizes.sum():
        return mass
    n, blocks = len(mass.indptr) - 1, [mass.blocks]
    rows, columns = ([each] for each in mass.pairs)
    for body, first in enumerate(n + np.cumsum(bodies.sizes) - bodies.sizes):
        frame = nodes_of(bodies.integers, body)[0]
        _, G = parts_of(*bodies, body)
        m = (len(G) - 4) // 3
        # rows of G with the same director are contiguous
        at = np.concatenate([[np.arange(4)], 4 + np.arange(3 * m).reshape(3, m).T], axis=None)
        own = np.zeros((m + 1, 4, m + 1, 4))
        some = np.zeros((m + 1, 4), dtype=bool)
        some[0], some[1:, 1:] = True, True
        own.reshape(4 * m + 4, -1)[np.ix_(some.ravel(), some.ravel())] = G[np.ix_(at, at)]
        numbers = np.concatenate([[frame], first + np.arange(m)])
        rows.append(np.repeat(numbers, m + 1)[1:])
        columns.append(np.tile(numbers, m + 1)[1:])
        blocks.append(own.transpose(0, 2, 1, 3).reshape(-1, 4, 4)[1:])
    r, c = np.concatenate(rows), np.concatenate(columns)
    order = np.lexsort((c, r))
    indptr = np.searchsorted(r[order], np.arange(n + bodies.sizes.sum() + 1)).astype(np.int64)
    return Inertia(indptr, c[order].astype(np.int64), np.concatenate(blocks)[order])


def product_numbers(part: Floating, nodes: Indices, whole: Floating) -> Indices:
    """Indices of the products of some bodies among those of all.

    ``nodes``: indices of their nodes.
    """
    first = np.cumsum(whole.sizes) - whole.sizes
    frames = [int(nodes_of(whole.integers, body)[0]) for body in range(len(first))]
    rows: list[Indices] = [np.empty(0, dtype=np.int64)]
    for body, size in enumerate(part.sizes):
        at = frames.index(int(nodes[nodes_of(part.integers, body)[0]]))
        rows.append(first[at] + np.arange(size))
    return np.concatenate(rows)


def product_weights(mass: Inertia, n: int, gravity: Array) -> Array:
    """Weight (p, 4, 3) of the products, the rows of ``mass`` after the first ``n``."""
    falling = np.zeros((len(mass.indptr) - 1, 4, 3))
    weight = np.zeros_like(falling)
    falling[:, 0] = gravity
    multiply(*mass, falling, weight)
    return weight[n:]


@compiled
def products_at(integers: Indices, numbers: Array, H: Array, out: Array) -> None:
    """Products (m, 4, 3) at frames ``H``."""
    first = 0
    for body in range(integers[0]):
        nodes, (interfaces, G) = nodes_of(integers, body), parts_of(integers, numbers, body)
        m = (G.shape[0] - 4) // 3
        q, z = np.empty((nodes.shape[0], 4, 3)), np.empty(m)
        for i in range(nodes.shape[0]):
            q[i] = H[nodes[i]]
        coordinates(q, interfaces, z)
        for a in range(m):
            out[first + a, 0] = 0.0
            out[first + a, 1:] = z[a] * q[0, 1:]
        first += m


@compiled
def product_rates(
    integers: Indices, numbers: Array, motion: tuple[Array, Array, Array], out: Array
) -> None:
    """First and second rates (2, m, 4, 3) of the products.

    Args:
        integers: See :class:`~fem_lie.lie.node_types.floating.Floating`.
        numbers: See :class:`~fem_lie.lie.node_types.floating.Floating`.
        motion: Frames, and first and second rates of all nodal coordinates, (≥ n, 4, 3).
        out: Rates, overwritten.
    """
    first, (H, rates, seconds) = 0, motion
    for body in range(integers[0]):
        nodes, (interfaces, G) = nodes_of(integers, body), parts_of(integers, numbers, body)
        n, k = G.shape[0], nodes.shape[0]
        q, still, z, A = (
            np.empty((3, k, 4, 3)),
            np.zeros(3),
            np.zeros((3, (n - 4) // 3)),
            np.empty((3, n)),
        )
        for i in range(k):
            q[0, i], q[1, i], q[2, i] = H[nodes[i]], rates[nodes[i]], seconds[nodes[i]]
        accelerate((q[0], q[1], q[2]), still, interfaces, z, A)
        m = z.shape[1]
        for a in range(m):
            for r in range(3):
                for j in range(3):
                    rate = z[1, a] * q[0, 0, 1 + r, j] + z[0, a] * q[1, 0, 1 + r, j]
                    out[0, first + a, 1 + r, j] = rate
                    out[1, first + a, 1 + r, j] = A[j, 4 + r * m + a]
            out[0, first + a, 0] = out[1, first + a, 0] = 0.0
        first += m


@compiled
def add_on_rows(integers: Indices, numbers: Array, H: Array, F: Array, out: Array) -> None:
    """Add forces ``F`` (m, 4, 3) on products at frames ``H`` to those on nodes, (n, 4, 3)."""
    first = 0
    for body in range(integers[0]):
        nodes, (interfaces, G) = nodes_of(integers, body), parts_of(integers, numbers, body)
        n, k, m = G.shape[0], nodes.shape[0], (G.shape[0] - 4) // 3
        q, f, z, flat = np.empty((k, 4, 3)), np.zeros((k, 4, 3)), np.zeros((2, m)), np.zeros((3, n))
        for i in range(k):
            q[i] = H[nodes[i]]
        for a in range(m):
            for r in range(3):
                for j in range(3):
                    flat[j, 4 + r * m + a] = F[first + a, 1 + r, j]
        coordinates(q, interfaces, z[0])
        spread_forces(flat, q, interfaces, z[0], z[1], f)
        for i in range(k):
            out[nodes[i]] += f[i]
        first += m


@compiled
def stored_energies(integers: Indices, numbers: Array, H: Array, W: Array) -> None:
    """Stored energies (bodies,) at frames ``H``."""
    for body in range(integers[0]):
        nodes, (interfaces, _) = nodes_of(integers, body), parts_of(integers, numbers, body)
        K, Q = elastic_of(integers, numbers, body)
        m = K.shape[0]
        q, J, (z, e, s) = np.empty((nodes.shape[0], 4, 3)), np.empty((m, m)), np.zeros((3, m))
        for i in range(nodes.shape[0]):
            q[i] = H[nodes[i]]
        coordinates(q, interfaces, z)
        strains(Q, z, J, e)
        add_times(K, e, s)
        energy = 0.0
        for a in range(m):
            energy += e[a] * s[a]
        W[body] = 0.5 * energy


# --- nodal coordinates and products ---


@compiled
def accelerations(
    kinds: Indices, bodies: tuple[Indices, Array], H: Array, twist: Array, out: Array
) -> None:
    """Set the second rates of nodes and products (n + p, 4, 3) at steady twists (n, 6)."""
    n = len(kinds)
    inertia.accelerations(kinds, H, twist, np.zeros_like(twist), out[:n])
    if len(out) > n:
        rates, found = np.empty((n, 4, 3)), np.empty((2, *out[n:].shape))
        push_all_forward(kinds, H, twist, rates)
        product_rates(*bodies, (H, rates, out[:n]), found)
        out[n:] = found[1]


@compiled
def add_inertia(
    kinds: Indices,
    mass: Inertia | PlainInertia,
    bodies: tuple[Indices, Array],
    H: Array,
    q: Array,
    factor: float,
    forces: Array,
) -> None:
    """Add ``factor Lᵀ G q``, with ``q`` (n + p, 4, 3), at frames ``H`` to ``forces``, (n, 6)."""
    n, work = len(kinds), np.empty_like(q)
    multiply(mass[0], mass[1], mass[2], q, work)
    add_on_rows(*bodies, H, work[n:], work[:n])
    pull_all_back(kinds, H, work[:n], factor, forces.reshape(-1))
