"""Inertia in redundant coordinates: one constant matrix for all bodies, seen from nodal frames.

Every node carries ``q = (x, d₁, d₂, d₃)`` and the kinetic energy is ``½ Σ G_ij[a, b] q̇_ia · q̇_jb``
with a *constant* block-sparse matrix ``G`` (4×4 blocks): a beam's is the consistent mass matrix of
linearly interpolated positions and directors, a rigid body's a single block. With local velocities
``v`` and accelerations ``a``, ``q̇ = L v``, ``q̈ = L a + L̇ v`` and the inertia force is ``Lᵀ G q̈``:
gyroscopic and centrifugal terms included, nothing else to derive. (Betsch & Leyendecker, IJNME 67
(2006) 499, the discrete null space; conventions in :mod:`fem_lie.lie`.)
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie.forms.frames import push

Invariants: TypeAlias = tuple[float, float, float, float, float, float, float]
"""Kinetic energy, momentum and angular momentum about the origin."""

PlainInertia: TypeAlias = tuple[Indices, Indices, Array]
"""An :class:`Inertia` at the door from Python: compiled functions are quicker to call so."""


@compiled
def _local_acceleration(v: Array, a: Array, i: int, w: Array) -> None:
    """Components of ``Rᵀ q̈``: rows ``u̇ + ω×u`` and ``(ω̇^ + ω^ω^) e_k`` of ``w`` (4, 3)."""
    u0, u1, u2, w0, w1, w2 = v[i, 0], v[i, 1], v[i, 2], v[i, 3], v[i, 4], v[i, 5]
    a0, a1, a2 = a[i, 3], a[i, 4], a[i, 5]
    w[0, 0] = a[i, 0] + w1 * u2 - w2 * u1
    w[0, 1] = a[i, 1] + w2 * u0 - w0 * u2
    w[0, 2] = a[i, 2] + w0 * u1 - w1 * u0
    w[1, 0] = -w1 * w1 - w2 * w2
    w[1, 1] = w0 * w1 + a2
    w[1, 2] = w0 * w2 - a1
    w[2, 0] = w0 * w1 - a2
    w[2, 1] = -w0 * w0 - w2 * w2
    w[2, 2] = w1 * w2 + a0
    w[3, 0] = w0 * w2 + a1
    w[3, 1] = w1 * w2 - a0
    w[3, 2] = -w0 * w0 - w1 * w1


@compiled
def accelerations(H: Array, v: Array, a: Array, out: Array) -> None:
    """``q̈ = L a + L̇ v``; shapes (n, 4, 3), (n, 6), (n, 6), (n, 4, 3)."""
    w = np.empty((4, 3))
    for i in range(v.shape[0]):
        _local_acceleration(v, a, i, w)
        for k in range(4):
            for j in range(3):
                out[i, k, j] = H[i, 1, j] * w[k, 0] + H[i, 2, j] * w[k, 1] + H[i, 3, j] * w[k, 2]


@compiled
def multiply(indptr: Indices, indices: Indices, G: Array, q: Array, out: Array) -> None:
    """``out = G q`` for block-sparse ``G`` (nnz, 4, 4) acting on nodal vectors (n, 4, 3)."""
    for i in range(indptr.shape[0] - 1):
        for a in range(4):
            s0 = s1 = s2 = 0.0
            for entry in range(indptr[i], indptr[i + 1]):
                j = indices[entry]
                for b in range(4):
                    g = G[entry, a, b]
                    s0 += g * q[j, b, 0]
                    s1 += g * q[j, b, 1]
                    s2 += g * q[j, b, 2]
            out[i, a, 0], out[i, a, 1], out[i, a, 2] = s0, s1, s2


@compiled
def _hat_minus(w: Array, scale: float, out: Array) -> None:
    """``out −= scale · ŵ``."""
    out[0, 1] += scale * w[2]
    out[0, 2] -= scale * w[1]
    out[1, 0] -= scale * w[2]
    out[1, 2] += scale * w[0]
    out[2, 0] += scale * w[1]
    out[2, 1] -= scale * w[0]


@compiled
def _right_factors(
    v: Array,
    a: Array,
    i: int,
    kind: int,
    mass: float,
    damping: float,
    W: Array,
    X: Array,
    unit: Array,
    vector: Array,
) -> None:
    """Local derivatives of q̈ of node i: ``W[k]`` (4, 3, 6) in (a, v), ``X[k]`` (4, 3, 6) in h.

    ``W = mass ∂q̈/∂a + damping ∂q̈/∂v``; ``X`` is what turning the frame does to q̈, ``−ŵ_k``.
    On R³×SO(3) (odd ``kind``) ẍ itself is in ``a``: it feels neither ω nor the turning frame.
    """
    W[:] = 0.0
    X[:] = 0.0
    u, omega = v[i, :3], v[i, 3:]
    for j in range(3):
        W[0, j, j] = mass
    if kind & 1 == 0:
        _hat_minus(omega, -damping, W[0, :, :3])
        _hat_minus(u, damping, W[0, :, 3:])
    for k in range(3):
        unit[:] = 0.0
        unit[k] = 1.0
        _hat_minus(unit, mass, W[1 + k, :, 3:])
        # ∂(ω×(ω×e_k))/∂ω = ω e_kᵀ + ω_k I − 2 e_k ωᵀ
        for j in range(3):
            W[1 + k, j, 3 + k] += damping * omega[j]
            W[1 + k, j, 3 + j] += damping * omega[k]
            W[1 + k, k, 3 + j] -= 2.0 * damping * omega[j]
    _local_acceleration(v, a, i, vector)
    for k in range(kind & 1, 4):
        _hat_minus(vector[k], 1.0, X[k, :, 3:])


@compiled
def tangents(
    H: Array,
    v: Array,
    a: Array,
    kinds: Indices,
    indptr: Indices,
    indices: Indices,
    G: Array,
    place: Indices,
    mass: float,
    damping: float,
    A: Array,
    K: Array,
) -> None:
    """Add ``mass·∂r/∂a + damping·∂r/∂v`` to ``A`` and ``Lᵀ G ∂q̈/∂h`` to ``K``.

    ``r = Lᵀ G q̈`` is the inertia force.

    Args:
        H: Frames (n, 4, 3).
        v: Local velocities (n, 6).
        a: Local accelerations (n, 6).
        kinds: What the derivatives in accelerations and velocities are by, see
            :mod:`fem_lie.lie.motions`: their rates on SE(3), (ẍ, ω̇) on R³×SO(3).
        indptr: Rows of the block-sparse matrix ``G``.
        indices: Columns of its blocks.
        G: Its blocks (nnz, 4, 4).
        place: Position of each block of ``G`` in the pattern of ``A`` and ``K`` (blocks, 6, 6).
        mass: Factor of the derivative in the accelerations.
        damping: Factor of the derivative in the velocities.
        A: Blocks of the derivative in (a, v), updated.
        K: Blocks of the derivative in local increments, updated; the part of ``∂Lᵀ`` is not in it.
    """
    W, X = np.empty((4, 3, 6)), np.empty((4, 3, 6))
    unit, vector = np.empty(3), np.empty((4, 3))
    Q, left = np.empty((3, 3)), np.empty((4, 3))
    for i in range(indptr.shape[0] - 1):
        for entry in range(indptr[i], indptr[i + 1]):
            j = indices[entry]
            _right_factors(v, a, j, kinds[j], mass, damping, W, X, unit, vector)
            for k in range(3):
                for m in range(3):
                    Q[k, m] = 0.0
                    for n in range(3):
                        Q[k, m] += H[i, 1 + k, n] * H[j, 1 + m, n]
            for target, right in ((A, W), (K, X)):
                block = target[place[entry]]
                for column in range(6):
                    _force_on_frame(G[entry], Q, right, column, left)
                    for k in range(3):
                        block[k, column] += left[0, k]
                    block[3, column] += left[2, 2] - left[3, 1]
                    block[4, column] += left[3, 0] - left[1, 2]
                    block[5, column] += left[1, 1] - left[2, 0]


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
    H: Array, v: Array, indptr: Indices, indices: Indices, G: Array, qdot: Array, p: Array
) -> Invariants:
    """Those of twists ``v`` (n, 6); ``qdot`` and ``p`` are work arrays (n, 4, 3)."""
    push(H, v, qdot)
    return invariants_of_rates(H, qdot, indptr, indices, G, p)


@compiled
def invariants_of_rates(
    H: Array, qdot: Array, indptr: Indices, indices: Indices, G: Array, p: Array
) -> Invariants:
    """The same of rates ``qdot`` of (x, d₁, d₂, d₃), (n, 4, 3)."""
    multiply(indptr, indices, G, qdot, p)
    energy = 0.0
    p0 = p1 = p2 = l0 = l1 = l2 = 0.0
    for i in range(qdot.shape[0]):
        p0 += p[i, 0, 0]
        p1 += p[i, 0, 1]
        p2 += p[i, 0, 2]
        for k in range(4):
            x, y = H[i, k], p[i, k]
            l0 += x[1] * y[2] - x[2] * y[1]
            l1 += x[2] * y[0] - x[0] * y[2]
            l2 += x[0] * y[1] - x[1] * y[0]
            for j in range(3):
                energy += 0.5 * qdot[i, k, j] * y[j]
    return energy, p0, p1, p2, l0, l1, l2


@compiled
def local_twists(H: Array, qdot: Array, out: Array) -> None:
    """Twists (n, 6) in the frames of rates (n, 4, 3) of (x, d₁, d₂, d₃), without what deforms them.

    ``(Rᵀẋ, ½ Σ e_k × Rᵀḋ_k)``.
    """
    turned = np.empty((4, 3))
    for i in range(qdot.shape[0]):
        for k in range(4):
            for a in range(3):
                turned[k, a] = 0.0
                for j in range(3):
                    turned[k, a] += H[i, 1 + a, j] * qdot[i, k, j]
        for a in range(3):
            b, c = (a + 1) % 3, (a + 2) % 3
            out[i, a] = turned[0, a]
            out[i, 3 + a] = 0.5 * (turned[1 + b, c] - turned[1 + c, b])


class Inertia(NamedTuple):
    """Constant matrix of (x, d₁, d₂, d₃) of all nodes, sparse by blocks.

    Attributes:
        indptr: First block of each row, shape (n + 1,), or empty if there is nothing.
        indices: Column of each block, shape (nnz,).
        blocks: Shape (nnz, 4, 4).
    """

    indptr: Indices
    indices: Indices
    blocks: Array

    @classmethod
    def none(cls) -> Inertia:
        """Without rows: for compiled functions where there is nothing."""
        return cls(np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64), np.zeros((0, 4, 4)))

    @property
    def plain(self) -> PlainInertia:
        """As compiled functions are quicker to call with."""
        return (*self,)
