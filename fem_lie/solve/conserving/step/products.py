"""Sums over the nodes of velocities in the metric of inertia, and best fit of a rotation.

``Σ X_r (G Y)_s`` for each pair of V, ``δ = Δq/h − V`` and w, see :mod:`.dissipation`.
"""

from __future__ import annotations

from fem_lie._arrays import Array
from fem_lie._jit import inlined, uncounted
from fem_lie._jit.stack import blocks_at, stack, vector_at
from fem_lie.lie.node_types import inertia
from fem_lie.lie.node_types.inertia import Inertia
from fem_lie.lie.tuples import (
    Vector,
    dot,
    load_row,
    minus,
    plus,
    scaled,
    store_row,
)
from fem_lie.solve.conserving.midpoint.cayley import mean_of
from fem_lie.solve.conserving.midpoint.mean_forces import solve_symmetric
from fem_lie.solve.conserving.step.ranks import Ranks, add_up
from fem_lie.solve.conserving.step.records import TOTAL, Products

TURNS = 30
"""Largest number of iterations for the rotation, and for β."""


@uncounted
def begin_products(mass: Inertia, V: Array, w: Array, products: Products, ranks: Ranks) -> None:
    """Sums that are constant in a step, over the nodes of all ranks."""
    indptr, indices, blocks = mass
    _, Gw, GV, sums = products
    inertia.multiply(indptr, indices, blocks, w, Gw)
    inertia.multiply(indptr, indices, blocks, V, GV)
    _sum(V, Gw, sums[0, 2])
    _sum(w, Gw, sums[2, 2])
    _sum(V, GV, sums[0, 0])
    _add_up_blocks(ranks, sums, (0, 2, 0), (2, 2, 0))
    _transpose(sums, 0, 2)


@uncounted
def set_products(
    mass: Inertia, V: Array, w: Array, delta: Array, h: float, products: Products, ranks: Ranks
) -> None:
    """Sums that depend on the increments, shape (≥ n, 4, 3), over the nodes of all ranks."""
    indptr, indices, blocks = mass
    δ, Gδ, _, sums = products
    for i in range(V.shape[0]):
        for k in range(4):
            for j in range(3):
                δ[i, k, j] = delta[i, k, j] / h - V[i, k, j]
    inertia.multiply(indptr, indices, blocks, δ, Gδ)
    _sum(V, Gδ, sums[0, 1])
    _sum(δ, Gδ, sums[1, 1])
    _sum(w, Gδ, sums[2, 1])
    _add_up_blocks(ranks, sums, (0, 1, 2), (1, 1, 1))
    _transpose(sums, 0, 1)
    _transpose(sums, 2, 1)


@uncounted
def _add_up_blocks(
    ranks: Ranks, sums: Array, x: tuple[int, int, int], y: tuple[int, int, int]
) -> None:
    """Sums over all ranks of the blocks of three pairs, in place."""
    if ranks.addresses[TOTAL] == 0:
        return
    values = vector_at(stack(27), 27)
    for b in range(3):
        for r in range(3):
            for s in range(3):
                values[9 * b + 3 * r + s] = sums[x[b], y[b], r, s]
    add_up(ranks, values)
    for b in range(3):
        for r in range(3):
            for s in range(3):
                sums[x[b], y[b], r, s] = values[9 * b + 3 * r + s]


@inlined
def _sum(X: Array, GY: Array, out: Array) -> None:
    """``Σ X_r (G Y)_s``, (3, 3)."""
    a00 = a01 = a02 = a10 = a11 = a12 = a20 = a21 = a22 = 0.0
    for i in range(X.shape[0]):
        for k in range(4):
            x, y, z = X[i, k, 0], X[i, k, 1], X[i, k, 2]
            f, g, m = GY[i, k, 0], GY[i, k, 1], GY[i, k, 2]
            a00 += x * f
            a01 += x * g
            a02 += x * m
            a10 += y * f
            a11 += y * g
            a12 += y * m
            a20 += z * f
            a21 += z * g
            a22 += z * m
    store_row(out, 0, (a00, a01, a02))
    store_row(out, 1, (a10, a11, a12))
    store_row(out, 2, (a20, a21, a22))


@inlined
def _transpose(sums: Array, x: int, y: int) -> None:
    for r in range(3):
        for s in range(3):
            sums[y, x, r, s] = sums[x, y, s, r]


@inlined
def product(sums: Array, x: Vector, y: Vector, out: Array) -> None:
    """Sums of two linear combinations of (V, δ, w), (3, 3)."""
    for r in range(3):
        for s in range(3):
            total = 0.0
            for i in range(3):
                for j in range(3):
                    if x[i] != 0.0 and y[j] != 0.0:
                        total += x[i] * y[j] * sums[i, j, r, s]
            out[r, s] = total


@inlined
def changes(χ: float, β: float) -> tuple[Vector, Vector, Vector]:
    """``a``, ``V + ½ a`` and ``a − β w`` as linear combinations of (V, δ, w)."""
    k = 2.0 / (1.0 + χ)
    kept = 0.5 * χ * β * k
    return (0.0, k, kept), (1.0, 0.5 * k, 0.5 * kept), (0.0, k, kept - β)


@inlined
def make_means(ψ: Vector, M: Array) -> None:
    """``(I − ½ψ̂)⁻¹ M``."""
    for s in range(3):
        turned = mean_of(ψ, (M[0, s], M[1, s], M[2, s]))
        M[0, s], M[1, s], M[2, s] = turned


@inlined
def make_squares(ψ: Vector, W: Array) -> None:
    """Sums of V̄ with itself, from those of ``V + ½ a`` in ``W``."""
    make_means(ψ, W)
    for r in range(3):
        store_row(W, r, mean_of(ψ, load_row(W, r)))


@inlined
def copy(M: Array, out: Array) -> None:
    """``out = M``, (3, 3)."""
    for r in range(3):
        store_row(out, r, load_row(M, r))


@inlined
def turn(M: Array) -> Vector:
    """``Σ X × G Y`` from ``Σ X_r (G Y)_s``."""
    return M[1, 2] - M[2, 1], M[2, 0] - M[0, 2], M[0, 1] - M[1, 0]


@inlined
def trace(M: Array) -> float:
    """Sum of the diagonal."""
    return M[0, 0] + M[1, 1] + M[2, 2]


@inlined
def times(A: Array, v: Vector) -> Vector:
    """``A v``."""
    return dot(load_row(A, 0), v), dot(load_row(A, 1), v), dot(load_row(A, 2), v)


@inlined
def resistance(W: Array, A: Array) -> None:
    """``A`` with ``A Ω = Σ V̄ × G (Ω × V̄)`` from the sums of V̄ with itself."""
    total = trace(W)
    for r in range(3):
        for s in range(3):
            A[r, s] = -0.5 * (W[r, s] + W[s, r])
        A[r, r] += total


@inlined
def nearest(A: Array, shifted: Array, right: Vector) -> Vector:
    """Rotation for which ``Ω × V̄`` is the best fit to ``b`` in the metric of inertia.

    Args:
        A: See :func:`resistance`.
        shifted: Workspace, (3, 3).
        right: ``Σ V̄ × G b``.
    """
    # motion along one line has no rotation about it
    least = 1e-12 * trace(A)
    if least == 0.0:
        return (0.0, 0.0, 0.0)
    for r in range(3):
        for s in range(3):
            shifted[r, s] = A[r, s]
        shifted[r, r] += least
    first = solve_symmetric(shifted, right)
    # remove the effect of the shift, except in directions without rotation
    rest = minus(right, times(A, first))
    return plus(first, solve_symmetric(shifted, rest))


@uncounted
def turning(sums: Array, χ: float, β: float, start: Vector) -> Vector:
    """``χ P``: P is the rotation that fits ``ΔV − β w``, over 1 + χ; ``start``: initial guess."""
    work = blocks_at(stack(54), 6, 3, 3)
    W, A, shifted, X, kept, squared = work[0], work[1], work[2], work[3], work[4], work[5]
    _, p, b = changes(χ, β)
    product(sums, p, b, kept)
    product(sums, p, p, squared)
    ψ = start
    for _ in range(TURNS):
        copy(squared, W)
        make_squares(ψ, W)
        resistance(W, A)
        copy(kept, X)
        make_means(ψ, X)
        found = scaled(χ, nearest(A, shifted, turn(X)))
        gap, ψ = minus(found, ψ), found
        if dot(gap, gap) <= 1e-30 * dot(ψ, ψ):
            break
    return ψ
