"""Compiled sums over the nodes of a scene: inertia, loads, and the blocks of the matrix."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fem_lie import constraints, inertia
from fem_lie._jit import Array, Indices, compiled
from fem_lie.constraints import JointTable
from fem_lie.frames import pull, pull_derivative
from fem_lie.groups import tangent, turn


class Inertia(NamedTuple):
    """Constant matrix of (x, d₁, d₂, d₃) of all nodes: rows, columns and blocks (nnz, 4, 4)."""

    indptr: Indices
    indices: Indices
    blocks: Array


class Loads(NamedTuple):
    """Nodal loads at one time.

    Attributes:
        gravity: Force on (x, d₁, d₂, d₃), shape (n, 4, 3).
        dead: Force and moment fixed in space, shape (n, 6).
        following: Force and moment in the nodes' frames, shape (n, 6).
    """

    gravity: Array
    dead: Array
    following: Array


@compiled
def _add_loads(H: Array, dead: Array, following: Array, r: Array) -> None:
    """``r −= loads``: global forces and moments (n, 6) and local ones (n, 6)."""
    for i in range(dead.shape[0]):
        for a in range(3):
            for j in range(3):
                r[6 * i + a] -= H[i, 1 + a, j] * dead[i, j]
                r[6 * i + 3 + a] -= H[i, 1 + a, j] * dead[i, 3 + j]
            r[6 * i + a] -= following[i, a]
            r[6 * i + 3 + a] -= following[i, 3 + a]


@compiled
def _add_load_stiffness(H: Array, dead: Array, diagonal: Indices, K: Array) -> None:
    """``K −= ∂(local components of global loads)/∂h``: ``(Rᵀf)^`` and ``(Rᵀm)^``."""
    for i in range(dead.shape[0]):
        block = K[diagonal[i]]
        for kind in range(2):
            at, row = 3 * kind, 3 * kind
            n0 = n1 = n2 = 0.0
            for j in range(3):
                n0 += H[i, 1, j] * dead[i, at + j]
                n1 += H[i, 2, j] * dead[i, at + j]
                n2 += H[i, 3, j] * dead[i, at + j]
            block[row, 4] += n2
            block[row, 5] -= n1
            block[row + 1, 3] -= n2
            block[row + 1, 5] += n0
            block[row + 2, 3] += n1
            block[row + 2, 4] -= n0


@compiled
def rigid_residual(
    H: Array,
    v: Array,
    a: Array,
    mass: tuple[Any, ...],
    loads: tuple[Any, ...],
    joints: tuple[Any, ...],
    weights: Array,
    scale: Array,
    work: Array,
    r: Array,
) -> None:
    """``r = Lᵀ (G q̈ − gravity) − loads + Bᵀ weights``, and ``scale · Φ``; ``work`` (2, n, 4, 3).

    The records come as plain tuples, which makes the call from Python cheaper.
    """
    indptr, indices, blocks = mass
    gravity, dead, following = loads
    count = dead.shape[0]
    r[:] = 0.0
    inertia.accelerations(H, v[:count], a[:count], work[0])
    inertia.multiply(indptr, indices, blocks, work[0], work[1])
    for i in range(count):
        for k in range(4):
            for j in range(3):
                work[1, i, k, j] -= gravity[i, k, j]
    pull(H, work[1], 1.0, r[: 6 * count].reshape(count, 6))
    _add_loads(H, dead, following, r)
    table = JointTable(joints[0], joints[1], joints[2], joints[3])
    constraints.evaluate(H, table, weights, scale, count, r)


@compiled
def load_potential(H: Array, gravity: Array, dead: Array) -> float:
    """Potential of gravity and of global forces, ``−Σ gravity · q − Σ force · x``."""
    energy = 0.0
    for i in range(dead.shape[0]):
        for j in range(3):
            energy -= dead[i, j] * H[i, 0, j]
            for k in range(4):
                energy -= gravity[i, k, j] * H[i, k, j]
    return energy


@compiled
def rigid_tangent(
    H: Array,
    v: Array,
    a: Array,
    kinds: Indices,
    mass: Inertia,
    place: Indices,
    f: Array,
    dead: Array,
    diagonal: Indices,
    factors: tuple[float, float],
    A: Array,
    K: Array,
) -> None:
    """Derivatives of :func:`rigid_residual`.

    ``f = G q̈ − gravity`` is that of the last residual, ``factors`` are ∂a/∂d and ∂v/∂d.
    """
    count = dead.shape[0]
    inertia.tangents(
        H,
        v[:count],
        a[:count],
        kinds,
        mass.indptr,
        mass.indices,
        mass.blocks,
        place,
        factors[0],
        factors[1],
        A,
        K,
    )
    for i in range(count):
        pull_derivative(H[i], f[i], 1.0, K[diagonal[i]])
    _add_load_stiffness(H, dead, diagonal, K)


@compiled
def add_blocks(target: Array, place: Indices, blocks: Array) -> None:
    """``target[place] += blocks``."""
    for b in range(place.shape[0]):
        for k in range(6):
            for n in range(6):
                target[place[b], k, n] += blocks[b, k, n]


@compiled
def combine(
    A: Array, K: Array, rows: Array, kinds: Indices, d: Array, nodes: Indices, bind: Indices
) -> None:
    """``A ← A + K T(d)``, ``rows ← rows T(d)``: derivatives in d, not in ``h = T(d) δd``."""
    count = d.shape[0]
    T, product = np.empty((count, 6, 6)), np.empty((6, 6))
    for i in range(count):
        tangent(kinds[i], d[i], T[i])
    for b in range(bind.shape[0]):
        _multiply(K[b], T[bind[b]], product)
        for k in range(6):
            for n in range(6):
                A[b, k, n] += product[k, n]
    row = np.empty(6)
    for c in range(rows.shape[0]):
        for side in range(2):
            node = nodes[c, side]
            if node < count:
                for n in range(6):
                    row[n] = 0.0
                    for k in range(6):
                        row[n] += rows[c, side, k] * T[node, k, n]
                rows[c, side] = row


@compiled
def to_inertial(
    A: Array, columns: Array, rows: Array, H: Array, nodes: Indices, indptr: Indices, bind: Indices
) -> None:
    """Blocks ``R_i A_ij R_jᵀ`` and border ``b_j R_jᵀ``: global components at frames ``H``."""
    for i in range(indptr.shape[0] - 1):
        for b in range(indptr[i], indptr[i + 1]):
            j = bind[b]
            for n in range(6):
                turn(H[i], A[b, :, n])
            for k in range(6):
                turn(H[j], A[b, k])
    for c in range(rows.shape[0]):
        for side in range(2):
            if nodes[c, side] < indptr.shape[0] - 1:
                turn(H[nodes[c, side]], columns[c, side])
                turn(H[nodes[c, side]], rows[c, side])


@compiled
def _multiply(A: Array, B: Array, out: Array) -> None:
    for i in range(6):
        for j in range(6):
            out[i, j] = 0.0
            for k in range(6):
                out[i, j] += A[i, k] * B[k, j]
