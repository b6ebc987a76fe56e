"""Forces on one node of any kind, and its inertia: what ``q̇ = L v`` makes of them; compiled.

Inertia is the same for all: with the constant matrix ``G`` of :mod:`fem_lie.lie.kinds.inertia`
it is ``Lᵀ G (L a + L̇ v)``, where ``a`` is the rate of ``v``. Frames are asked for first.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled, inlined
from fem_lie.lie import directors
from fem_lie.lie.kinds.kind import AMPLITUDE, SLOPE, axes, first, slope, straight, turning
from fem_lie.lie.tuples import (
    Vector,
    combined,
    cross,
    load,
    load_row,
    plus,
    rotate,
    rotate_back,
    store,
    store_row,
)


@inlined
def push(kind: int, H: Array, v: Array, out: Array) -> None:
    """``q̇ = L v``, shape (4, 3)."""
    if kind < SLOPE:
        directors.push(H, v, out)
    else:
        d1, d2, d3 = axes(kind, H)
        out[:] = 0.0
        at = first(kind)
        for k in range(straight(kind)):
            store_row(out, at + k, rotate(d1, d2, d3, load(v, 3 * k)))


@inlined
def pull(kind: int, H: Array, f: Array, sign: float, r: Array) -> None:
    """``r += sign · Lᵀ f``, of a force ``f`` on the rows, (4, 3) to (6,)."""
    if kind < SLOPE:
        directors.pull(H, f, sign, r)
    else:
        d1, d2, d3 = axes(kind, H)
        at = first(kind)
        for k in range(straight(kind)):
            local = rotate_back(d1, d2, d3, load_row(f, at + k))
            store(r, 3 * k, combined(1.0, load(r, 3 * k), sign, local))


@inlined
def add_along_increments(kind: int, mean: Array, f: Array, out: Array) -> None:
    """Add forces on rows, (4, 3), along increments, (6,), which frames have about these means."""
    if kind < SLOPE:
        moment = load(out, 3)
        for k in range(1, 4):
            moment = plus(moment, cross(load_row(mean, k), load_row(f, k)))
        store(out, 0, plus(load(out, 0), load_row(f, 0)))
        store(out, 3, moment)
    else:
        at = first(kind)
        for k in range(straight(kind)):
            store(out, 3 * k, plus(load(out, 3 * k), load_row(f, at + k)))


@inlined
def pull_derivative(kind: int, H: Array, f: Array, sign: float, block: Array) -> None:
    """``block += sign · ∂(Lᵀ f)/∂h``."""
    if kind < SLOPE:
        directors.pull_derivative(H, f, sign, block)
    else:
        d1, d2, d3 = axes(kind, H)
        at = first(kind)
        for j in range(3):
            # the axes turn by ψ, and what stands still in them by −ψ × Rᵀf
            unit = (1.0 if j == 0 else 0.0), (1.0 if j == 1 else 0.0), (1.0 if j == 2 else 0.0)
            ψ = turning(kind, H, unit)
            for k in range(straight(kind)):
                turned = cross(ψ, rotate_back(d1, d2, d3, load_row(f, at + k)))
                for i in range(3):
                    block[3 * k + i, 3 + j] -= sign * turned[i]


@inlined
def acceleration(kind: int, H: Array, v: Array, a: Array, local: Array, out: Array) -> None:
    """``q̈ = L a + L̇ v``, shape (4, 3); ``local`` is a work array of that shape."""
    if kind < SLOPE:
        directors.local_acceleration(v, a, local)
        directors.to_global(H, local, out)
    else:
        (d1, d2, d3), ψ = axes(kind, H), turning(kind, H, load(v, 3))
        at = first(kind)
        out[:] = 0.0
        for k in range(straight(kind)):
            rate = plus(load(a, 3 * k), cross(ψ, load(v, 3 * k)))
            store_row(out, at + k, rotate(d1, d2, d3, rate))


@compiled
def acceleration_derivatives(
    kind: int,
    H: Array,
    v: Array,
    a: Array,
    factors: tuple[float, float],
    right: tuple[Array, Array],
) -> None:
    """``W = mass ∂q̈/∂v̇ + damping ∂q̈/∂v`` and ``X``, what turning the axes does, both (4, 3, 6).

    Derivatives are in the velocities and accelerations of the group, with the factors mass and
    damping; ``right`` is (W, X), overwritten.
    """
    (mass, _), (W, X) = factors, right
    W[:] = 0.0
    X[:] = 0.0
    if kind < SLOPE:
        w, x = np.empty((4, 3, 6)), np.empty((4, 3, 6))
        unit, vector = np.empty(3), np.empty((4, 3))
        translates = kind & 1 == 1
        directors.acceleration_derivatives(translates, v, a, factors, (w, x), (unit, vector))
        for column in range(6):
            directors.to_global(H, w[:, :, column], W[:, :, column])
            directors.to_global(H, x[:, :, column], X[:, :, column])
    else:
        d1, d2, d3 = axes(kind, H)
        at = first(kind)
        for j in range(3):
            for k in range(straight(kind)):
                W[at + k, j, 3 * k] = mass * d1[j]
                W[at + k, j, 3 * k + 1] = mass * d2[j]
                W[at + k, j, 3 * k + 2] = mass * d3[j]


@inlined
def wrench(kind: int, H: Array, r: Array) -> tuple[Vector, Vector]:
    """Force, and moment about the node, that ``r`` (6,) in its axes is; global components.

    What acts on rows that are no place has a moment alone, and what acts on amplitudes neither.
    """
    if kind == AMPLITUDE:
        return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    d1, d2, d3 = axes(kind, H)
    force, moment = rotate(d1, d2, d3, load(r, 0)), rotate(d1, d2, d3, load(r, 3))
    if kind >= SLOPE:
        moment = cross(slope(kind, H), moment)
        if first(kind) > 0:
            moment = plus(moment, cross(load_row(H, first(kind)), force))
            force = (0.0, 0.0, 0.0)
    return force, moment
