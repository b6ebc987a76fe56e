r"""What nodes are, and all in which one kind differs from another: compiled, one node at a time.

Every node is four rows ``H (4, 3)``, a place and three vectors, and has a velocity ``v`` in its own
axes ``R``; forces, tangents and the unknowns of Newton's method are in these axes, too. What the
rows mean, and what ``v`` does to them, is the node's *kind*:

==============  =====================================  =====================================
                FRAME, on one of two groups            SLOPE
==============  =====================================  =====================================
rows            place ``x``, directors ``R e_k``       ``x``, slope ``x'``; 2 and 3 carried
axes ``R``      the directors                          tangent ``x'/|x'|``, rows 2 and 3
``v``           ``(Rᵀẋ, ω)``                           ``(Rᵀẋ, Rᵀẋ')``
of the group    see :mod:`fem_lie.lie.motions`         ``(ẋ, ẋ')`` and ``(ẍ, ẍ')``, added
``q̇ = L v``     ``ẋ``, ``ḋ_k = R (ω × e_k)``           ``ẋ``, ``ẋ'``; the other rows are zero
==============  =====================================  =====================================

The axes of a slope are carried along by the smallest rotation, without any about the tangent; they
have no inertia and feel no force, and only say in which components the equations are written.

Inertia is the same for all: with the constant matrix ``G`` of :mod:`fem_lie.system.nodes.inertia`
it is ``Lᵀ G (L a + L̇ v)``, where ``a`` is the rate of ``v``.

A number says which kind a node is: ``group + 2 · parametrisation`` of a frame, below :data:`SLOPE`,
or one of :class:`NodeKind`. To add a kind: a number there, what it is in the table at the end of
this file, and its branch in each of the functions of one node. Loops over all nodes call these, and
know nothing of kinds. Frames are asked for first: their path is as short as if they were alone.
"""

from __future__ import annotations

from enum import IntEnum
from math import sqrt
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled, inlined
from fem_lie.lie import directors, motions
from fem_lie.lie.motions import Parametrisation
from fem_lie.lie.tuples import (
    Vector,
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

SLOPE = 4
"""The first kind that is no frame."""

_OPPOSITE = 1e-12  # 1 + cosine: there is no smallest rotation to the opposite direction


class NodeKind(IntEnum):
    """What a body's nodes are."""

    FRAME = 0
    SLOPE = SLOPE


# --- one node: axes -------------------------------------------------------------------------------


@inlined
def axes(kind: int, H: Array) -> tuple[Vector, Vector, Vector]:
    """The node's own axes, unit vectors in global components."""
    first = load_row(H, 1)
    if kind >= SLOPE:
        first = scaled(1.0 / sqrt(dot(first, first)), first)
    return first, load_row(H, 2), load_row(H, 3)


@inlined
def _transport(kind: int, H: Array, v: Array) -> Vector:
    """Angular velocity of a slope's axes, in them: ``e₁ × Rᵀẋ' / |x'|``."""
    slope = load_row(H, 1)
    stretch = 1.0 / sqrt(dot(slope, slope))
    return 0.0, -v[5] * stretch, v[4] * stretch


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


# --- one node: motion -----------------------------------------------------------------------------


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
        return
    old, beside, slope = load_row(H, 1), load_row(H, 2), plus(load_row(H, 1), load(d, 3))
    old, tangent = _unit(old), _unit(slope)
    # the smallest rotation between the tangents, set right to round-off
    along = dot(beside, tangent) / max(1.0 + dot(old, tangent), _OPPOSITE)
    beside = minus(beside, scaled(along, plus(old, tangent)))
    beside = _unit(minus(beside, scaled(dot(beside, tangent), tangent)))
    store_row(out, 0, plus(load_row(H, 0), load(d, 0)))
    store_row(out, 1, slope)
    store_row(out, 2, beside)
    store_row(out, 3, cross(tangent, beside))


@inlined
def _unit(a: Vector) -> Vector:
    return scaled(1.0 / sqrt(dot(a, a)), a)


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
        _move_otherwise(kind, H, d, out)


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
        ψ = _transport(kind, H, twist)
        for at in (0, 3):
            local = rotate_back(d1, d2, d3, load(vdot, at))
            store(rate, at, minus(local, cross(ψ, load(twist, at))))


@inlined
def from_local(kind: int, H: Array, twist: Array, rate: Array, v: Array, vdot: Array) -> None:
    """Inverse of :func:`to_local`."""
    if kind < SLOPE:
        motions.from_local(kind, H, twist, rate, v, vdot)
    else:
        (d1, d2, d3), ψ = axes(kind, H), _transport(kind, H, twist)
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
    x, slope, (d1, d2, d3) = load_row(H, 0), load_row(H, 1), axes(kind, H)
    out[:] = 0.0
    for k in range(3):
        e = (1.0 if k == 0 else 0.0), (1.0 if k == 1 else 0.0), (1.0 if k == 2 else 0.0)
        moved, lever = rotate_back(d1, d2, d3, e), rotate_back(d1, d2, d3, cross(e, x))
        turned = moved if kind < SLOPE else rotate_back(d1, d2, d3, cross(e, slope))
        for j in range(3):
            out[j, k], out[j, 3 + k], out[3 + j, 3 + k] = moved[j], lever[j], turned[j]


@compiled
def shown(kind: int, H: Array, v: Array, out: Array) -> None:
    """``v`` as results have it: translation and rotation along the rows of ``H``, (6,)."""
    for k in range(6):
        out[k] = v[k]
    if kind >= SLOPE:
        slope = load_row(H, 1)
        stretch = sqrt(dot(slope, slope))
        ψ = _transport(kind, H, v)
        out[0] = v[0] / stretch
        out[3], out[4], out[5] = 0.0, ψ[1], ψ[2]


# --- one node: forces and inertia -----------------------------------------------------------------


@inlined
def push(kind: int, H: Array, v: Array, out: Array) -> None:
    """``q̇ = L v``, shape (4, 3)."""
    if kind < SLOPE:
        directors.push(H, v, out)
    else:
        d1, d2, d3 = axes(kind, H)
        out[:] = 0.0
        store_row(out, 0, rotate(d1, d2, d3, load(v, 0)))
        store_row(out, 1, rotate(d1, d2, d3, load(v, 3)))


@inlined
def pull(kind: int, H: Array, f: Array, sign: float, r: Array) -> None:
    """``r += sign · Lᵀ f``, of a force ``f`` on the rows, (4, 3) to (6,)."""
    if kind < SLOPE:
        directors.pull(H, f, sign, r)
    else:
        d1, d2, d3 = axes(kind, H)
        for k in range(2):
            local = rotate_back(d1, d2, d3, load_row(f, k))
            store(r, 3 * k, combined(1.0, load(r, 3 * k), sign, local))


@inlined
def pull_derivative(kind: int, H: Array, f: Array, sign: float, block: Array) -> None:
    """``block += sign · ∂(Lᵀ f)/∂h``."""
    if kind < SLOPE:
        directors.pull_derivative(H, f, sign, block)
    else:
        # the axes turn by ψ = (0, −h₅, h₄)/|x'|, and what stands still in them by −ψ × Rᵀf
        d1, d2, d3 = axes(kind, H)
        slope = load_row(H, 1)
        c = sign / sqrt(dot(slope, slope))
        for k in range(2):
            n = rotate_back(d1, d2, d3, load_row(f, k))
            block[3 * k, 5] += c * n[2]
            block[3 * k, 4] += c * n[1]
            block[3 * k + 1, 4] -= c * n[0]
            block[3 * k + 2, 5] -= c * n[0]


@inlined
def acceleration(kind: int, H: Array, v: Array, a: Array, local: Array, out: Array) -> None:
    """``q̈ = L a + L̇ v``, shape (4, 3); ``local`` is a work array of that shape."""
    if kind < SLOPE:
        directors.local_acceleration(v, a, local)
        directors.to_global(H, local, out)
    else:
        (d1, d2, d3), ψ = axes(kind, H), _transport(kind, H, v)
        out[:] = 0.0
        for k in range(2):
            rate = plus(load(a, 3 * k), cross(ψ, load(v, 3 * k)))
            store_row(out, k, rotate(d1, d2, d3, rate))


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
        for j in range(3):
            for k in range(2):
                W[k, j, 3 * k] = mass * d1[j]
                W[k, j, 3 * k + 1] = mass * d2[j]
                W[k, j, 3 * k + 2] = mass * d3[j]


@inlined
def wrench(kind: int, H: Array, r: Array) -> tuple[Vector, Vector]:
    """Force, and moment about the node, that ``r`` (6,) in its axes is; global components."""
    d1, d2, d3 = axes(kind, H)
    force, moment = rotate(d1, d2, d3, load(r, 0)), rotate(d1, d2, d3, load(r, 3))
    if kind >= SLOPE:
        moment = cross(load_row(H, 1), moment)
    return force, moment


# --- all nodes ------------------------------------------------------------------------------------


@compiled
def move_all(kinds: Indices, H: Array, d: Array, out: Array) -> None:
    """:func:`move` for nodes (n,)."""
    for i in range(kinds.shape[0]):
        move(kinds[i], H[i], d[i], out[i])


@compiled
def follow_all(kinds: Indices, H: Array, h: Array, out: Array) -> None:
    """:func:`follow` for nodes (n,)."""
    for i in range(kinds.shape[0]):
        follow(kinds[i], H[i], h[i], out[i])


@compiled
def twists(kinds: Indices, d: Array, x: Array, out: Array) -> None:
    """``T(d) x`` of all nodes, shapes (n, 6)."""
    T = np.empty((6, 6))
    for i in range(kinds.shape[0]):
        tangent(kinds[i], d[i], T)
        for k in range(6):
            out[i, k] = 0.0
            for n in range(6):
                out[i, k] += T[k, n] * x[i, n]


@compiled
def all_from_local(
    kinds: Indices, H: Array, twist: Array, rate: Array, v: Array, vdot: Array
) -> None:
    """:func:`from_local` for nodes (n,)."""
    for i in range(kinds.shape[0]):
        from_local(kinds[i], H[i], twist[i], rate[i], v[i], vdot[i])


@compiled
def all_to_group(kinds: Indices, H: Array, x: Array) -> None:
    """:func:`to_group` for nodes (n,), shape (n, 6), in place."""
    for i in range(kinds.shape[0]):
        to_group(kinds[i], H[i], x[i])


@compiled
def all_from_group(kinds: Indices, H: Array, x: Array) -> None:
    """:func:`from_group` for nodes (n,), shape (n, 6), in place."""
    for i in range(kinds.shape[0]):
        from_group(kinds[i], H[i], x[i])


@compiled
def bend_all(kinds: Indices, v: Array, vdot: Array, out: Array) -> None:
    """:func:`bend` for nodes (n,), shapes (n, 6)."""
    for i in range(kinds.shape[0]):
        bend(kinds[i], v[i], vdot[i], out[i])


@compiled
def turn_all(kinds: Indices, H: Array, r: Array) -> None:
    """:func:`turn` for the rows (6 n,) of nodes (n,) at the head of ``r``."""
    for i in range(kinds.shape[0]):
        turn(kinds[i], H[i], r[6 * i : 6 * i + 6])


@compiled
def turn_all_back(kinds: Indices, H: Array, r: Array) -> None:
    """:func:`turn_back` for the rows (6 n,) of nodes (n,) at the head of ``r``."""
    for i in range(kinds.shape[0]):
        turn_back(kinds[i], H[i], r[6 * i : 6 * i + 6])


@compiled
def rigid_motions(kinds: Indices, H: Array, about: Array) -> Array:
    """:func:`rigid` for nodes (n,), turning about a place (3,), shape (n, 6, 6)."""
    out, node = np.empty((kinds.shape[0], 6, 6)), np.empty((4, 3))
    for i in range(kinds.shape[0]):
        node[:] = H[i]
        node[0] -= about
        rigid(kinds[i], node, out[i])
    return out


@compiled
def shown_all(kinds: Indices, H: Array, v: Array, out: Array) -> None:
    """:func:`shown` for nodes (n,), shapes (n, 6)."""
    for i in range(kinds.shape[0]):
        shown(kinds[i], H[i], v[i], out[i])


@compiled
def push_all(kinds: Indices, H: Array, v: Array, out: Array) -> None:
    """:func:`push` for nodes (n,), shape (n, 4, 3)."""
    for i in range(kinds.shape[0]):
        push(kinds[i], H[i], v[i], out[i])


@compiled
def pull_all(kinds: Indices, H: Array, f: Array, sign: float, r: Array) -> None:
    """:func:`pull` for nodes (n,), shapes (n, 4, 3) and (6 n,)."""
    for i in range(kinds.shape[0]):
        pull(kinds[i], H[i], f[i], sign, r[6 * i : 6 * i + 6])


@compiled
def advance(
    kinds: Indices, H: Array, dx: Array, held: Flags, uncoupled: Flags, size: float
) -> float:
    """Move the nodes by ``−dx`` in their axes; returns the largest increment over ``size``.

    Frames by ``H exp(−dx)``, or where they are uncoupled by :func:`fem_lie.lie.motions.retract`.
    """
    largest, h = 0.0, np.empty((1, 6))
    for i in range(held.shape[0]):
        if not held[i].all():
            for k in range(6):
                h[0, k] = -dx[6 * i + k]
                step = abs(h[0, k]) / (size if k < 3 else 1.0)
                if step > largest or step != step:  # nan stays
                    largest = step
            if uncoupled[i]:
                motions.retract(H[i : i + 1], h)
            else:
                follow(kinds[i], H[i], h[0], H[i])
                settle(kinds[i], H[i])
    return largest


# --- what a kind is, for Python -------------------------------------------------------------------


class Traits(NamedTuple):
    """What is known of a kind of node beforehand.

    Attributes:
        unknowns: How many it has.
        rows: How many of the rows of ``H`` have inertia and take forces.
        clamped: Which unknowns are zero where place and direction do not change, shape (6,).
    """

    unknowns: int
    rows: int
    clamped: tuple[bool, ...]


TRAITS = MappingProxyType(
    {
        NodeKind.FRAME: Traits(6, 4, (True,) * 6),
        # the slope's length is stretch, and stays free
        NodeKind.SLOPE: Traits(6, 2, (True, True, True, False, True, True)),
    }
)


def kinds_of(nodes: Indices, groups: Indices, parametrisation: Parametrisation) -> Indices:
    """The number of each node: ``nodes`` are :class:`NodeKind`, ``groups`` those of frames."""
    frames = groups + 2 * int(parametrisation)
    return np.where(nodes == NodeKind.FRAME, frames, nodes).astype(np.int64)


def at_rest(kinds: Indices) -> Indices:
    """The same with all frames on SE(3), where acceleration is the rate of the twist."""
    return np.where(kinds < SLOPE, 0, kinds)


def on_r3(kinds: Indices) -> Flags:
    """Which nodes are frames on R³×SO(3)."""
    return np.asarray((kinds < SLOPE) & (kinds & 1 == 1))
