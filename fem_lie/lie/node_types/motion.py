"""Motion of one node of any type: increments, velocities, rigid motions; compiled.

Frames are tested first, so that other types cost them nothing. All other types share one branch;
the functions in which they differ are in :mod:`.node_type`.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie._jit import compiled, inlined
from fem_lie.lie import motions
from fem_lie.lie.motions import local_components
from fem_lie.lie.node_types.node_type import (
    MIXED_DERIVATIVE,
    MODAL,
    POSITION_GRADIENT,
    SURFACE_GRADIENT,
    add_increment,
    axes,
    axes_spin,
    first_vector,
    second_vector,
    vector_count,
)
from fem_lie.lie.series import exponential, rotation_vector
from fem_lie.lie.tuples import (
    combined,
    cross,
    dot,
    load,
    load_row,
    minus,
    plus,
    rotate,
    rotate_back,
    scaled,
    store,
    store_row,
)


@inlined
def to_global_components(node_type: int, H: Array, a: Array) -> None:
    """Rotate both vectors of ``a`` (6,) from components along the node's axes to global ones."""
    d1, d2, d3 = axes(node_type, H)
    store(a, 0, rotate(d1, d2, d3, load(a, 0)))
    store(a, 3, rotate(d1, d2, d3, load(a, 3)))


@inlined
def to_nodal_components(node_type: int, H: Array, a: Array) -> None:
    """Inverse of :func:`to_global_components`."""
    d1, d2, d3 = axes(node_type, H)
    store(a, 0, rotate_back(d1, d2, d3, load(a, 0)))
    store(a, 3, rotate_back(d1, d2, d3, load(a, 3)))


@inlined
def move(node_type: int, H: Array, d: Array, out: Array) -> None:
    """Coordinates of the node ``H`` after an increment ``d`` (6,) of its group."""
    if node_type == 0:
        lie.retract(H, d, out)
    else:
        _move_otherwise(node_type, H, d, out)


@compiled
def _move_otherwise(node_type: int, H: Array, d: Array, out: Array) -> None:
    if node_type < POSITION_GRADIENT:
        motions.move(node_type, H, d, out)
    else:
        add_increment(node_type, H, d, out)


@inlined
def retract(node_type: int, H: Array, h: Array, out: Array) -> None:
    """Coordinates after an increment ``h`` (6,) along the node's axes: ``H exp(h)`` for frames."""
    if node_type < POSITION_GRADIENT:
        lie.retract(H, h, out)
    else:
        d1, d2, d3 = axes(node_type, H)
        d = np.empty(6)
        store(d, 0, rotate(d1, d2, d3, load(h, 0)))
        store(d, 3, rotate(d1, d2, d3, load(h, 3)))
        add_increment(node_type, H, d, out)


@inlined
def go_on(node_type: int, start: Array, H: Array, out: Array) -> None:
    """Coordinates half a step after ``H`` if the motion from ``start`` goes on steadily."""
    if node_type < POSITION_GRADIENT:
        d1, d2, d3 = load_row(H, 1), load_row(H, 2), load_row(H, 3)
        made = rotation_vector(
            local_components(start, d1), local_components(start, d2), local_components(start, d3)
        )
        dx = minus(load_row(H, 0), load_row(start, 0))
        _, r1, r2, r3 = exponential((0.0, 0.0, 0.0), scaled(0.5, made))
        store_row(out, 0, combined(1.0, load_row(H, 0), 0.5, dx))
        store_row(out, 1, rotate(d1, d2, d3, r1))
        store_row(out, 2, rotate(d1, d2, d3, r2))
        store_row(out, 3, rotate(d1, d2, d3, r3))
    else:
        d, at = np.zeros(6), first_vector(node_type)
        for k in range(vector_count(node_type)):
            change = minus(load_row(H, at + k), load_row(start, at + k))
            store(d, 3 * k, scaled(0.5, change))
        add_increment(node_type, H, d, out)


@inlined
def reorthonormalise(node_type: int, H: Array) -> None:
    """Remove the round-off from the directors of a frame; other nodes are not changed."""
    if node_type < POSITION_GRADIENT:
        lie.reorthonormalise(H)


@compiled
def tangent(node_type: int, d: Array, out: Array) -> None:
    """``T`` (6, 6): a correction ``x`` of ``d`` moves the node by the twist ``T x``."""
    if node_type < POSITION_GRADIENT:
        motions.tangent(node_type, d, out)
    else:
        out[:] = 0.0
        for k in range(6):
            out[k, k] = 1.0


@compiled
def tangent_inverse(node_type: int, d: Array, out: Array) -> None:
    """Inverse ``T⁻¹`` (6, 6) of :func:`tangent`."""
    if node_type < POSITION_GRADIENT:
        motions.tangent_inverse(node_type, d, out)
    else:
        out[:] = 0.0
        for k in range(6):
            out[k, k] = 1.0


@inlined
def to_local(node_type: int, H: Array, v: Array, vdot: Array, twist: Array, rate: Array) -> None:
    """Velocity along the node's axes and its rate, from velocity and acceleration of the group."""
    if node_type < POSITION_GRADIENT:
        motions.to_local(node_type, H, v, vdot, twist, rate)
    else:
        d1, d2, d3 = axes(node_type, H)
        store(twist, 0, rotate_back(d1, d2, d3, load(v, 0)))
        store(twist, 3, rotate_back(d1, d2, d3, load(v, 3)))
        ψ = axes_spin(node_type, H, load(twist, 3))
        for at in (0, 3):
            local = rotate_back(d1, d2, d3, load(vdot, at))
            store(rate, at, minus(local, cross(ψ, load(twist, at))))


@inlined
def from_local(node_type: int, H: Array, twist: Array, rate: Array, v: Array, vdot: Array) -> None:
    """Inverse of :func:`to_local`."""
    if node_type < POSITION_GRADIENT:
        motions.from_local(node_type, H, twist, rate, v, vdot)
    else:
        (d1, d2, d3), ψ = axes(node_type, H), axes_spin(node_type, H, load(twist, 3))
        for at in (0, 3):
            own = load(twist, at)
            local = plus(load(rate, at), cross(ψ, own))
            store(v, at, rotate(d1, d2, d3, own))
            store(vdot, at, rotate(d1, d2, d3, local))


@inlined
def to_group(node_type: int, H: Array, x: Array) -> None:
    """Change of an increment or velocity from nodal axes to those of its group, in place."""
    if node_type < POSITION_GRADIENT:
        if node_type & 1:
            store(x, 0, motions.global_components(H, load(x, 0)))
    else:
        to_global_components(node_type, H, x)


@inlined
def from_group(node_type: int, H: Array, x: Array) -> None:
    """Inverse of :func:`to_group`."""
    if node_type < POSITION_GRADIENT:
        if node_type & 1:
            store(x, 0, motions.local_components(H, load(x, 0)))
    else:
        to_nodal_components(node_type, H, x)


@compiled
def cubic_term(node_type: int, v: Array, vdot: Array, out: Array) -> None:
    """Commutator ``[v, v̇]`` of the group: h³/12 times it is in the increment of a motion.

    The Cayley map adds ``−v̂³``. The term is zero where increments add.
    """
    out[:] = 0.0
    if node_type >= POSITION_GRADIENT:
        return
    u, ω, du, dω = load(v, 0), load(v, 3), load(vdot, 0), load(vdot, 3)
    square = dot(ω, ω) if node_type & 2 else 0.0
    store(out, 3, combined(1.0, cross(ω, dω), square, ω))
    if node_type & 1 == 0:
        moved = plus(cross(ω, du), cross(u, dω))
        if node_type & 2:
            moved = minus(moved, cross(ω, cross(ω, u)))
        store(out, 0, moved)


@compiled
def rigid_twists(node_type: int, H: Array, out: Array) -> None:
    """Columns ``v`` (6, 6) of the rigid motions: along the global axes, about the origin."""
    x, (d1, d2, d3) = load_row(H, 0), axes(node_type, H)
    out[:] = 0.0
    if node_type == MODAL:
        return
    placed = node_type < POSITION_GRADIENT or first_vector(node_type) == 0
    if not placed:
        x = load_row(H, first_vector(node_type))
    for k in range(3):
        e = (1.0 if k == 0 else 0.0), (1.0 if k == 1 else 0.0), (1.0 if k == 2 else 0.0)
        moved, arm = rotate_back(d1, d2, d3, e), rotate_back(d1, d2, d3, cross(e, x))
        turned = (
            moved
            if node_type < POSITION_GRADIENT
            else rotate_back(d1, d2, d3, cross(e, second_vector(node_type, H)))
        )
        for j in range(3):
            out[j, k], out[j, 3 + k] = (moved[j] if placed else 0.0), arm[j]
            out[3 + j, 3 + k] = turned[j]


@compiled
def result_twist(node_type: int, H: Array, v: Array, out: Array) -> None:
    """Translation and rotation along the rows of ``H`` that results report for ``v``, (6,).

    It is zero for mixed-derivative nodes, which have no position; for modal nodes it is the rates
    of the amplitudes.
    """
    for k in range(6):
        out[k] = v[k]
    if node_type == MODAL:
        return
    if node_type == MIXED_DERIVATIVE:
        out[:] = 0.0
    elif node_type == SURFACE_GRADIENT:
        along, (d1, d2, d3) = load_row(H, 1), axes(node_type, H)
        a1, a2, a3 = rotate_back(d1, d2, d3, along)
        square = a1 * a1 + a2 * a2 + a3 * a3
        spin = scaled(1.0 / square, cross((a1, a2, a3), load(v, 3)))
        # row 1 is not an axis: it has components along all three
        for at, w in ((0, load(v, 0)), (3, spin)):
            first = w[0] / a1
            store(out, at, (first, w[1] - a2 * first, w[2] - a3 * first))
    elif node_type >= POSITION_GRADIENT:
        along = load_row(H, 1)
        out[0] = v[0] / sqrt(dot(along, along))
        store(out, 3, axes_spin(node_type, H, load(v, 3)))
