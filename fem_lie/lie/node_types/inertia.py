"""Inertia in redundant coordinates: one constant matrix for all bodies, projected to nodal axes.

Every node has coordinates ``q = (x, d₁, d₂, d₃)``, and the kinetic energy is ``½ Σ G_ij[a, b] q̇_ia
· q̇_jb`` with a *constant* block-sparse matrix ``G`` (4×4 blocks). For a beam it is the consistent
mass matrix of linearly interpolated positions and directors, for a rigid body a single block. With
velocities ``v`` and accelerations ``a`` along nodal axes, ``q̇ = L v`` and ``q̈ = L a + L̇ v``, the
inertia force is ``Lᵀ G q̈``, gyroscopic and centrifugal terms included. (Betsch & Leyendecker,
IJNME 67 (2006) 499, the discrete null space; conventions in :mod:`fem_lie.lie`.)
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled, inlined, uncounted
from fem_lie._jit.packed_arrays import Integers1, Numbers3
from fem_lie._jit.stack import matrix_at, stack
from fem_lie.lie import directors
from fem_lie.lie.node_types.all_nodes import push_all_forward
from fem_lie.lie.node_types.forces import (
    acceleration,
    acceleration_derivatives,
    pull_back,
    push_forward,
)
from fem_lie.lie.node_types.node_type import (
    MODAL,
    POSITION_GRADIENT,
    axes,
    first_vector,
    vector_count,
)
from fem_lie.lie.tuples import dot, load, load_row, rotate, rotate_back, store

Invariants: TypeAlias = tuple[float, float, float, float, float, float, float]
"""Kinetic energy, momentum and angular momentum about the origin."""

PlainInertia: TypeAlias = tuple[Integers1, Integers1, Numbers3]
"""An :class:`Inertia` as a plain tuple, faster to pass from Python to compiled functions."""


PlainMotion: TypeAlias = tuple[Array, Array, Array]
"""Frames (≥ n, 4, 3) of all nodes, local velocities (n, 6) and their rates, as a plain tuple."""


@uncounted
def accelerations(node_types: Indices, H: Array, v: Array, a: Array, out: Array) -> None:
    """``q̈ = L a + L̇ v``; shapes (n,), (n, 4, 3), (n, 6), (n, 6), (n, 4, 3)."""
    local = matrix_at(stack(12), 4, 3)
    for i in range(v.shape[0]):
        acceleration(node_types[i], H[i], v[i], a[i], local, out[i])


@inlined
def multiply_row(i: int, indptr: Indices, indices: Indices, G: Array, q: Array, out: Array) -> None:
    """Node ``i`` of the product of :func:`multiply`, shape (4, 3)."""
    for a in range(4):
        s0 = s1 = s2 = 0.0
        for entry in range(indptr[i], indptr[i + 1]):
            j = indices[entry]
            for b in range(4):
                g = G[entry, a, b]
                if g != 0.0:  # two thirds of the entries are zero for most bodies
                    s0 += g * q[j, b, 0]
                    s1 += g * q[j, b, 1]
                    s2 += g * q[j, b, 2]
        out[a, 0], out[a, 1], out[a, 2] = s0, s1, s2


@uncounted
def multiply(indptr: Indices, indices: Indices, G: Array, q: Array, out: Array) -> None:
    """``out = G q`` for block-sparse ``G`` (nnz, 4, 4) acting on nodal vectors (n, 4, 3)."""
    for i in range(indptr.shape[0] - 1):
        multiply_row(i, indptr, indices, G, q, out[i])


@compiled
def tangents(
    motion: PlainMotion,
    node_types: Indices,
    G: PlainInertia,
    block_indices: tuple[Indices, Indices],
    factors: tuple[float, float],
    parts: tuple[Array, Array],
) -> None:
    """Add ``mass·∂r/∂a + damping·∂r/∂v`` to ``A`` and ``Lᵀ G ∂q̈/∂h`` to ``K``.

    ``r = Lᵀ G q̈`` is the inertia force.

    Args:
        motion: Coordinates (≥ n, 4, 3), local velocities (n, 6) and their rates (n, 6).
        node_types: Type of each node, shape (n,); derivatives in accelerations and velocities are
            in those of the group.
        G: The block-sparse matrix.
        block_indices: Index of each block of ``G`` among the blocks of ``A`` and of ``K``.
        factors: ``mass``, of the derivative in accelerations, and ``damping``, in velocities.
        parts: ``A``, blocks (b, 6, 6) of the derivative in (a, v), and ``K``, of that in local
            increments, both updated; they may be one array. ``∂Lᵀ`` is in neither.
    """
    (H, v, a), (indptr, indices, blocks), (A, K) = motion, G, parts
    in_A, in_K = block_indices
    W, X = np.empty((4, 3, 6)), np.empty((4, 3, 6))
    unit, vector = np.empty(3), np.empty((4, 3))
    Q, left = np.empty((3, 3)), np.empty((4, 3))
    for i in range(indptr.shape[0] - 1):
        for entry in range(indptr[i], indptr[i + 1]):
            j = indices[entry]
            of_rates, of_frames = A[in_A[entry]], K[in_K[entry]]
            if node_types[i] >= POSITION_GRADIENT and node_types[j] >= POSITION_GRADIENT:
                _add_straight(
                    (node_types[i], node_types[j]), H[i], H[j], blocks[entry], factors[0], of_rates
                )
                continue
            if node_types[i] >= POSITION_GRADIENT or node_types[j] >= POSITION_GRADIENT:
                acceleration_derivatives(node_types[j], H[j], v[j], a[j], factors, (W, X))
                _add_pulled(node_types[i], H[i], blocks[entry], W, of_rates)
                _add_pulled(node_types[i], H[i], blocks[entry], X, of_frames)
                continue
            directors.acceleration_derivatives(
                node_types[j] & 1 == 1, v[j], a[j], factors, (W, X), (unit, vector)
            )
            for k in range(3):
                for m in range(3):
                    Q[k, m] = 0.0
                    for n in range(3):
                        Q[k, m] += H[i, 1 + k, n] * H[j, 1 + m, n]
            for block, right in ((of_rates, W), (of_frames, X)):
                for column in range(6):
                    _force_on_frame(blocks[entry], Q, right, column, left)
                    for k in range(3):
                        block[k, column] += left[0, k]
                    block[3, column] += left[2, 2] - left[3, 1]
                    block[4, column] += left[3, 0] - left[1, 2]
                    block[5, column] += left[1, 1] - left[2, 0]


PlainEnds: TypeAlias = tuple[tuple[Array, Array], tuple[Array, Array]]
"""Nodes (≥ n, 4, 3) at the start and end of a step, and maps (n, 2, 3, 3) of both."""


@compiled
def momentum_tangents(
    ends: PlainEnds,
    node_types: Indices,
    G: PlainInertia,
    block_indices: Indices,
    factor: float,
    A: Array,
) -> None:
    """Add ``factor T₀ᵀ L(H₀)ᵀ G L(H₁) T₁`` to ``A``: change of the momenta at the start of a step.

    Args:
        ends: Nodes at the start and at the end of the step; transposes of the maps ``T₀ᵀ`` from
            forces on the nodes at the start, and maps ``T₁`` to motions of the nodes at the end.
        node_types: Type of each node, shape (n,).
        G: The block-sparse matrix.
        block_indices: Index of each block of ``G`` among the blocks of ``A``.
        factor: Factor of the matrix.
        A: Blocks (b, 6, 6), updated.
    """
    ((start, end), (T0, T1)), (indptr, indices, blocks) = ends, G
    unit, motion, r, row = np.empty(6), np.empty(6), np.empty(6), np.empty(6)
    rates, force = np.empty((4, 3)), np.empty((4, 3))
    for i in range(indptr.shape[0] - 1):
        for entry in range(indptr[i], indptr[i + 1]):
            j, block = indices[entry], A[block_indices[entry]]
            for column in range(6):
                unit[:], r[:] = 0.0, 0.0
                unit[column] = 1.0
                _map(T1[j], unit, motion)
                push_forward(node_types[j], end[j], motion, rates)
                _times(blocks[entry], rates, force)
                pull_back(node_types[i], start[i], force, factor, r)
                _map_back(T0[i], r, row)
                for k in range(6):
                    block[k, column] += row[k]


@inlined
def _map(maps: Array, a: Array, out: Array) -> None:
    """``T a`` of one node, with maps (2, 3, 3) of the first and last three components."""
    for k in range(2):
        T = maps[k]
        row = rotate_back(load_row(T, 0), load_row(T, 1), load_row(T, 2), load(a, 3 * k))
        store(out, 3 * k, row)


@inlined
def _map_back(maps: Array, r: Array, out: Array) -> None:
    """``Tᵀ r``."""
    for k in range(2):
        T = maps[k]
        row = rotate(load_row(T, 0), load_row(T, 1), load_row(T, 2), load(r, 3 * k))
        store(out, 3 * k, row)


@inlined
def _times(g: Array, a: Array, out: Array) -> None:
    """Product of a block (4, 4) with the rates (4, 3) of a node."""
    for k in range(4):
        for j in range(3):
            out[k, j] = 0.0
            for b in range(4):
                out[k, j] += g[k, b] * a[b, j]


@inlined
def _add_straight(
    node_types: tuple[int, int], H: Array, other: Array, g: Array, mass: float, block: Array
) -> None:
    """Add ``mass Lᵀ g L`` of two nodes that are not frames: their ``L`` is constant."""
    left, right = axes(node_types[0], H), axes(node_types[1], other)
    for k in range(vector_count(node_types[0])):
        for m in range(vector_count(node_types[1])):
            factor = mass * g[first_vector(node_types[0]) + k, first_vector(node_types[1]) + m]
            for i in range(3):
                for j in range(3):
                    block[3 * k + i, 3 * m + j] += factor * dot(left[i], right[j])


@compiled
def _add_pulled(node_type: int, H: Array, g: Array, right: Array, block: Array) -> None:
    """Add ``Lᵀ g right`` of a node of any type; ``right`` (4, 3, 6) has global components."""
    force, r = np.empty((4, 3)), np.empty(6)
    for column in range(6):
        _times(g, right[:, :, column], force)
        r[:] = 0.0
        pull_back(node_type, H, force, 1.0, r)
        for k in range(6):
            block[k, column] += r[k]


@compiled
def _force_on_frame(g: Array, Q: Array, right: Array, column: int, out: Array) -> None:
    """``out[a] = Σ_b g[a, b] Q right[b, :, column]``."""
    for a in range(4):
        for k in range(3):
            total = 0.0
            for b in range(4):
                if g[a, b] != 0.0:
                    total += g[a, b] * (
                        Q[k, 0] * right[b, 0, column]
                        + Q[k, 1] * right[b, 1, column]
                        + Q[k, 2] * right[b, 2, column]
                    )
            out[a, k] = total


@compiled
def invariants(
    node_types: Indices,
    H: Array,
    v: Array,
    indptr: Indices,
    indices: Indices,
    G: Array,
    qdot: Array,
    p: Array,
) -> Invariants:
    """Invariants of velocities ``v`` (n, 6); ``qdot`` and ``p`` are work arrays (n, 4, 3)."""
    push_all_forward(node_types, H, v, qdot)
    return invariants_of_rates(node_types, H, qdot, indptr, indices, G, p)


@uncounted
def invariants_of_rates(
    node_types: Indices,
    H: Array,
    qdot: Array,
    indptr: Indices,
    indices: Indices,
    G: Array,
    p: Array,
) -> Invariants:
    """Invariants of rates ``qdot`` of (x, d₁, d₂, d₃), shape (n, 4, 3); ``p`` is a work array.

    Amplitudes of modal nodes are no vectors, and have no momenta. Coordinates beyond those of the
    nodes of ``node_types`` (≤ n,) are vectors.
    """
    multiply(indptr, indices, G, qdot, p)
    energy = 0.0
    p0 = p1 = p2 = l0 = l1 = l2 = 0.0
    for i in range(qdot.shape[0]):
        p0 += p[i, 0, 0]
        p1 += p[i, 0, 1]
        p2 += p[i, 0, 2]
        turns = i >= node_types.shape[0] or node_types[i] != MODAL
        for k in range(4):
            x, y = H[i, k], p[i, k]
            if turns:
                l0 += x[1] * y[2] - x[2] * y[1]
                l1 += x[2] * y[0] - x[0] * y[2]
                l2 += x[0] * y[1] - x[1] * y[0]
            for j in range(3):
                energy += 0.5 * qdot[i, k, j] * y[j]
    return energy, p0, p1, p2, l0, l1, l2


@uncounted
def local_twists(H: Array, qdot: Array, turning: Array, out: Array) -> None:
    """Twists (n, 6) in nodal axes of rates (n, 4, 3) of (x, d₁, d₂, d₃), strain rates removed.

    ``(Rᵀẋ, Σ turning_l Rᵀḋ_l)``, see :func:`turning_of`.
    """
    turned = matrix_at(stack(12), 4, 3)
    for i in range(qdot.shape[0]):
        for k in range(4):
            for a in range(3):
                turned[k, a] = 0.0
                for j in range(3):
                    turned[k, a] += H[i, 1 + a, j] * qdot[i, k, j]
        for a in range(3):
            out[i, a] = turned[0, a]
            spin = 0.0
            for k in range(3):
                for c in range(3):
                    spin += turning[i, a, k, c] * turned[1 + k, c]
            out[i, 3 + a] = spin


def mass_blocks(node_types: Indices, H: Array, inertia: PlainInertia) -> Array:
    """Blocks ``Lᵀ G L`` of the mass matrix in twists at frames ``H``, shape (nnz, 6, 6)."""
    (indptr, indices, G), n = inertia, len(node_types)
    L = np.empty((6, n, 4, 3))
    for k in range(6):
        push_all_forward(node_types, H, np.tile(np.eye(6)[k], (n, 1)), L[k])
    by_node = np.ascontiguousarray(L.transpose(1, 0, 3, 2))  # node, twist, component, vector
    row = np.repeat(np.arange(n), np.diff(indptr))
    left = (by_node.reshape(n, 18, 4)[row] @ G).reshape(-1, 6, 12)
    return np.asarray(left @ by_node.reshape(n, 6, 12)[indices].swapaxes(1, 2))


def director_inertia(inertia: Inertia, count: int) -> Array:
    """Inertia of the directors of each of ``count`` nodes by itself, (n, 3, 3)."""
    found = np.zeros((count, 3, 3))
    rows = np.repeat(np.arange(len(inertia.indptr[1:])), np.diff(inertia.indptr))
    own = rows == inertia.indices
    found[rows[own]] = inertia.blocks[own, 1:, 1:]
    return found


def turning_of(E: Array, held: Flags) -> Array:
    """Linear map from rates of directors, not necessarily rigid, to an angular velocity.

    ω has the angular momentum of the rates: ``J ω = Σ E_kl e_k × Rᵀḋ_l`` with the node's own
    director inertia ``E``. Rates of directors without inertia follow from no balance and are
    arbitrary. About axes without inertia ω is the mean ``½ Σ e_k × Rᵀḋ_k``; it is zero where
    rotation is held.

    Args:
        E: Inertia of the directors of each node by itself, :func:`director_inertia`, (n, 3, 3).
        held: Mask of unknowns that are zero, shape (n, 6).

    Returns:
        Shape (n, 3, 3, 3): component of ω, director, component of its rate in the frame.
    """
    # nodes without own inertia share one map; position nodes do not rotate
    some = E.any(axis=(1, 2)) & ~held[:, 3:].all(axis=1)
    found = np.repeat(_turning(np.zeros((1, 3, 3))), len(held), axis=0)
    found[some] = _turning(E[some])
    found[held[:, 3:]] = 0.0
    return found


def _turning(E: Array) -> Array:
    """Map of :func:`turning_of` for directors' inertia ``E`` (n, 3, 3) where nothing is held."""
    J = np.trace(E, axis1=1, axis2=2)[:, np.newaxis, np.newaxis] * np.eye(3) - E
    moments, axes = np.linalg.eigh(J)
    felt = moments > _MASSLESS * moments[:, 2:]
    inverse = np.divide(1.0, moments, out=np.zeros_like(moments), where=felt)
    cross = lie.hat(np.eye(3)).swapaxes(1, 2)
    heavy = np.einsum("nai,ni,nbi,bkc,nkl->nalc", axes, inverse, axes, cross, E, optimize=True)
    light = np.einsum("nai,ni,nbi,blc->nalc", axes, ~felt, axes, 0.5 * cross, optimize=True)
    return np.asarray(heavy + light)


_MASSLESS = 1e-10  # of a node's largest moment of inertia


class Inertia(NamedTuple):
    """Constant block-sparse mass matrix in the coordinates (x, d₁, d₂, d₃) of all nodes.

    Attributes:
        indptr: First block of each row, shape (n + 1,); empty without inertia.
        indices: Column of each block, shape (nnz,).
        blocks: Shape (nnz, 4, 4), kg for positions, kg m and kg m² with directors.
    """

    indptr: Integers1
    indices: Integers1
    blocks: Numbers3

    @classmethod
    def none(cls) -> Inertia:
        """Matrix without rows, for compiled functions where there is no inertia."""
        return cls(np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64), np.zeros((0, 4, 4)))

    @classmethod
    def zero(cls, count: int) -> Inertia:
        """Matrix of ``count`` nodes without blocks."""
        return cls.none()._replace(indptr=np.zeros(count + 1, dtype=np.int64))

    @property
    def pairs(self) -> tuple[Indices, Indices]:
        """Nodes of each block, shape (nnz,) each."""
        return np.repeat(np.arange(len(self.indptr) - 1), np.diff(self.indptr)), self.indices

    @property
    def plain(self) -> PlainInertia:
        """The same as a plain tuple, which is faster to pass to compiled functions."""
        return (*self,)
