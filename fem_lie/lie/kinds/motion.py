"""How one node of any kind moves: by increments, at velocities, rigidly; compiled.

Frames are asked for first: their path is as short as if they were alone. The others are one case:
all in which they differ stands in :mod:`.kind`.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie._jit import compiled, inlined
from fem_lie.lie import motions
from fem_lie.lie.kinds.kind import (
    AMPLITUDE,
    CROSSING,
    SLOPE,
    SURFACE,
    axes,
    carry,
    first,
    slope,
    turning,
)
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
)


@inlined
def turn(kind: int, H: Array, a: Array) -> None:
    """Both halves of ``a`` (6,) from components along the node's axes to global ones."""
    d1, d2, d3 = axes(kind, H)
    store(a, 0, rotate(d1, d2, d3, load(a, 0)))
    store(a, 3, rotate(d1, d2, d3, load(a, 3)))


@inlined
def turn_back(kind: int, H: Array, a: Array) -> None:
    """Inverse of :func:`turn`."""
    d1, d2, d3 = axes(kind, H)
    store(a, 0, rotate_back(d1, d2, d3, load(a, 0)))
    store(a, 3, rotate_back(d1, d2, d3, load(a, 3)))


@inlined
def move(kind: int, H: Array, d: Array, out: Array) -> None:
    """The node ``H`` moved by the increment ``d`` of its group."""
    if kind == 0:
        lie.retract(H, d, out)
    else:
        _move_otherwise(kind, H, d, out)


@compiled
def _move_otherwise(kind: int, H: Array, d: Array, out: Array) -> None:
    if kind < SLOPE:
        motions.move(kind, H, d, out)
    else:
        carry(kind, H, d, out)


@inlined
def follow(kind: int, H: Array, h: Array, out: Array) -> None:
    """The node moved by ``h`` in its own axes: along a screw motion, or straight on."""
    if kind < SLOPE:
        lie.retract(H, h, out)
    else:
        d1, d2, d3 = axes(kind, H)
        d = np.empty(6)
        store(d, 0, rotate(d1, d2, d3, load(h, 0)))
        store(d, 3, rotate(d1, d2, d3, load(h, 3)))
        carry(kind, H, d, out)


@inlined
def settle(kind: int, H: Array) -> None:
    """Take out of a node that has been moved often what round-off has made of it."""
    if kind < SLOPE:
        lie.reorthonormalise(H)


@compiled
def tangent(kind: int, d: Array, out: Array) -> None:
    """``T`` with the twist of the moved node ``T x`` for a correction ``x`` of ``d``, (6, 6)."""
    if kind < SLOPE:
        motions.tangent(kind, d, out)
    else:
        out[:] = 0.0
        for k in range(6):
            out[k, k] = 1.0


@inlined
def to_local(kind: int, H: Array, v: Array, vdot: Array, twist: Array, rate: Array) -> None:
    """``v`` in the node's axes and its rate, from velocity and acceleration of the group."""
    if kind < SLOPE:
        motions.to_local(kind, H, v, vdot, twist, rate)
    else:
        d1, d2, d3 = axes(kind, H)
        store(twist, 0, rotate_back(d1, d2, d3, load(v, 0)))
        store(twist, 3, rotate_back(d1, d2, d3, load(v, 3)))
        ψ = turning(kind, H, load(twist, 3))
        for at in (0, 3):
            local = rotate_back(d1, d2, d3, load(vdot, at))
            store(rate, at, minus(local, cross(ψ, load(twist, at))))


@inlined
def from_local(kind: int, H: Array, twist: Array, rate: Array, v: Array, vdot: Array) -> None:
    """Inverse of :func:`to_local`."""
    if kind < SLOPE:
        motions.from_local(kind, H, twist, rate, v, vdot)
    else:
        (d1, d2, d3), ψ = axes(kind, H), turning(kind, H, load(twist, 3))
        for at in (0, 3):
            own = load(twist, at)
            local = plus(load(rate, at), cross(ψ, own))
            store(v, at, rotate(d1, d2, d3, own))
            store(vdot, at, rotate(d1, d2, d3, local))


@inlined
def to_group(kind: int, H: Array, x: Array) -> None:
    """A change of an increment or velocity, in the node's axes, to that of its group, in place."""
    if kind < SLOPE:
        if kind & 1:
            store(x, 0, motions.global_components(H, load(x, 0)))
    else:
        turn(kind, H, x)


@inlined
def from_group(kind: int, H: Array, x: Array) -> None:
    """Inverse of :func:`to_group`."""
    if kind < SLOPE:
        if kind & 1:
            store(x, 0, motions.local_components(H, load(x, 0)))
    else:
        turn_back(kind, H, x)


@compiled
def bend(kind: int, v: Array, vdot: Array, out: Array) -> None:
    """What the increment of a motion with ``v`` and ``v̇`` has beyond their series, over h³/12.

    ``[v, v̇]`` of the group, and ``−v̂³`` with the Cayley map; nothing where increments add.
    """
    out[:] = 0.0
    if kind >= SLOPE:
        return
    u, ω, du, dω = load(v, 0), load(v, 3), load(vdot, 0), load(vdot, 3)
    square = dot(ω, ω) if kind & 2 else 0.0
    store(out, 3, combined(1.0, cross(ω, dω), square, ω))
    if kind & 1 == 0:
        moved = plus(cross(ω, du), cross(u, dω))
        if kind & 2:
            moved = minus(moved, cross(ω, cross(ω, u)))
        store(out, 0, moved)


@compiled
def rigid(kind: int, H: Array, out: Array) -> None:
    """``v`` of the six rigid motions: along the fixed axes, and about those through the origin."""
    x, (d1, d2, d3) = load_row(H, 0), axes(kind, H)
    out[:] = 0.0
    if kind == AMPLITUDE:
        return
    placed = kind < SLOPE or first(kind) == 0
    if not placed:
        x = load_row(H, first(kind))
    for k in range(3):
        e = (1.0 if k == 0 else 0.0), (1.0 if k == 1 else 0.0), (1.0 if k == 2 else 0.0)
        moved, lever = rotate_back(d1, d2, d3, e), rotate_back(d1, d2, d3, cross(e, x))
        turned = moved if kind < SLOPE else rotate_back(d1, d2, d3, cross(e, slope(kind, H)))
        for j in range(3):
            out[j, k], out[j, 3 + k] = (moved[j] if placed else 0.0), lever[j]
            out[3 + j, 3 + k] = turned[j]


@compiled
def shown(kind: int, H: Array, v: Array, out: Array) -> None:
    """``v`` as results have it: translation and rotation along the rows of ``H``, (6,).

    A node without a place has none; of amplitudes it is their rates.
    """
    for k in range(6):
        out[k] = v[k]
    if kind == AMPLITUDE:
        return
    if kind == CROSSING:
        out[:] = 0.0
    elif kind == SURFACE:
        along, (d1, d2, d3) = load_row(H, 1), axes(kind, H)
        a1, a2, a3 = rotate_back(d1, d2, d3, along)
        square = a1 * a1 + a2 * a2 + a3 * a3
        spin = scaled(1.0 / square, cross((a1, a2, a3), load(v, 3)))
        # row 1 is no axis, but has parts along all of them
        for at, w in ((0, load(v, 0)), (3, spin)):
            share = w[0] / a1
            store(out, at, (share, w[1] - a2 * share, w[2] - a3 * share))
    elif kind >= SLOPE:
        along = load_row(H, 1)
        out[0] = v[0] / sqrt(dot(along, along))
        store(out, 3, turning(kind, H, load(v, 3)))
