"""Forces on one node of any type, and its inertia: velocities, pull-back of forces; compiled.

With the constant matrix ``G`` of :mod:`fem_lie.lie.node_types.inertia` the inertia force is ``Lᵀ G
(L a + L̇ v)`` for all types, where ``a`` is the rate of ``v``. Frames are tested first.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled, inlined
from fem_lie.lie import directors
from fem_lie.lie.node_types.node_type import (
    MODAL,
    POSITION_GRADIENT,
    axes,
    axes_spin,
    first_vector,
    second_vector,
    vector_count,
)
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
def push_forward(node_type: int, H: Array, v: Array, out: Array) -> None:
    """Rates of the nodal coordinates, ``q̇ = L v``, shape (4, 3)."""
    if node_type < POSITION_GRADIENT:
        directors.push_forward(H, v, out)
    else:
        d1, d2, d3 = axes(node_type, H)
        out[:] = 0.0
        at = first_vector(node_type)
        for k in range(vector_count(node_type)):
            store_row(out, at + k, rotate(d1, d2, d3, load(v, 3 * k)))


@inlined
def pull_back(node_type: int, H: Array, f: Array, sign: float, r: Array) -> None:
    """Add ``sign · Lᵀ f``, the generalised force of ``f`` (4, 3), to ``r`` (6,)."""
    if node_type < POSITION_GRADIENT:
        directors.pull_back(H, f, sign, r)
    else:
        d1, d2, d3 = axes(node_type, H)
        at = first_vector(node_type)
        for k in range(vector_count(node_type)):
            local = rotate_back(d1, d2, d3, load_row(f, at + k))
            store(r, 3 * k, combined(1.0, load(r, 3 * k), sign, local))


@inlined
def add_along_increments(node_type: int, mean: Array, f: Array, out: Array) -> None:
    """Add the generalised force of ``f`` (4, 3), conjugate to increments of the group.

    ``mean`` are the mean directors of a frame over the step, about which its increment rotates it.
    """
    if node_type < POSITION_GRADIENT:
        moment = load(out, 3)
        for k in range(1, 4):
            moment = plus(moment, cross(load_row(mean, k), load_row(f, k)))
        store(out, 0, plus(load(out, 0), load_row(f, 0)))
        store(out, 3, moment)
    else:
        at = first_vector(node_type)
        for k in range(vector_count(node_type)):
            store(out, 3 * k, plus(load(out, 3 * k), load_row(f, at + k)))


@inlined
def pull_back_derivative(node_type: int, H: Array, f: Array, sign: float, block: Array) -> None:
    """Add ``sign · ∂(Lᵀ f)/∂h`` to ``block`` (6, 6)."""
    if node_type < POSITION_GRADIENT:
        directors.pull_back_derivative(H, f, sign, block)
    else:
        d1, d2, d3 = axes(node_type, H)
        at = first_vector(node_type)
        for j in range(3):
            # the axes rotate by ψ; components of a constant f change by −ψ × Rᵀf
            unit = (1.0 if j == 0 else 0.0), (1.0 if j == 1 else 0.0), (1.0 if j == 2 else 0.0)
            ψ = axes_spin(node_type, H, unit)
            for k in range(vector_count(node_type)):
                turned = cross(ψ, rotate_back(d1, d2, d3, load_row(f, at + k)))
                for i in range(3):
                    block[3 * k + i, 3 + j] -= sign * turned[i]


@inlined
def acceleration(node_type: int, H: Array, v: Array, a: Array, local: Array, out: Array) -> None:
    """Accelerations ``q̈ = L a + L̇ v``, shape (4, 3); ``local`` is a work array (4, 3)."""
    if node_type < POSITION_GRADIENT:
        directors.local_acceleration(v, a, local)
        directors.to_global(H, local, out)
    else:
        (d1, d2, d3), ψ = axes(node_type, H), axes_spin(node_type, H, load(v, 3))
        at = first_vector(node_type)
        out[:] = 0.0
        for k in range(vector_count(node_type)):
            rate = plus(load(a, 3 * k), cross(ψ, load(v, 3 * k)))
            store_row(out, at + k, rotate(d1, d2, d3, rate))


@compiled
def acceleration_derivatives(
    node_type: int,
    H: Array,
    v: Array,
    a: Array,
    factors: tuple[float, float],
    right: tuple[Array, Array],
) -> None:
    """``W = mass ∂q̈/∂v̇ + damping ∂q̈/∂v`` and ``X``, ∂q̈ by rotated axes, both (4, 3, 6).

    Derivatives are in the velocities and accelerations of the group; ``factors`` are (mass,
    damping), ``right`` is (W, X), overwritten.
    """
    (mass, _), (W, X) = factors, right
    W[:] = 0.0
    X[:] = 0.0
    if node_type < POSITION_GRADIENT:
        w, x = np.empty((4, 3, 6)), np.empty((4, 3, 6))
        unit, vector = np.empty(3), np.empty((4, 3))
        translates = node_type & 1 == 1
        directors.acceleration_derivatives(translates, v, a, factors, (w, x), (unit, vector))
        for column in range(6):
            directors.to_global(H, w[:, :, column], W[:, :, column])
            directors.to_global(H, x[:, :, column], X[:, :, column])
    else:
        d1, d2, d3 = axes(node_type, H)
        at = first_vector(node_type)
        for j in range(3):
            for k in range(vector_count(node_type)):
                W[at + k, j, 3 * k] = mass * d1[j]
                W[at + k, j, 3 * k + 1] = mass * d2[j]
                W[at + k, j, 3 * k + 2] = mass * d3[j]


@inlined
def wrench(node_type: int, H: Array, r: Array) -> tuple[Vector, Vector]:
    """Force, and moment about the node, of a generalised force ``r`` (6,); global components.

    Forces on a mixed-derivative node have a moment only, and those on modal amplitudes neither.
    """
    if node_type == MODAL:
        return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    d1, d2, d3 = axes(node_type, H)
    force, moment = rotate(d1, d2, d3, load(r, 0)), rotate(d1, d2, d3, load(r, 3))
    if node_type >= POSITION_GRADIENT:
        moment = cross(second_vector(node_type, H), moment)
        if first_vector(node_type) > 0:
            moment = plus(moment, cross(load_row(H, first_vector(node_type)), force))
            force = (0.0, 0.0, 0.0)
    return force, moment
