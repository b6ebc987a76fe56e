"""Accelerations of a tree of rigid links by recursive elimination, compiled.

Every link moves relative to the one before by a joint, whose twists are combinations of constant
columns ``S`` in the frame of the link. With the frame ``X = (R, r)`` of a link in that of the one
before, and rates ``q̇`` along the columns, twists and their rates are::

    v = Ad(X⁻¹) v_p + S q̇        v̇ = Ad(X⁻¹) v̇_p + ad(v) S q̇ + S q̈

Outward, this gives velocities and the forces ``p = −ad(v)ᵀ M v − f`` of each link at rest. Inward,
each link adds the inertia ``I`` and the force ``p`` that the one before feels to its own: those of
a link with free columns, one after the other, are ::

    u = I s    d = s·u    e = s·p        I ← I − u uᵀ/d    p ← p − u e/d

since no force acts along ``s``. Outward again, ``q̈ = −(e + u·v̇)/d`` in reverse order. The work
grows with the number of links (Featherstone, Rigid Body Dynamics Algorithms (2008), chapter 7).
Rotations of ball joints and of free links are eliminated as a block of three: what is left of the
inertia is a 3×3 mass of their centre. All components are along the axes of the links, so that
inertia is constant; uniform gravity is an acceleration of the ground.
"""

from __future__ import annotations

from typing import NamedTuple

from fem_lie._jit import inlined_uncounted, uncounted
from fem_lie._jit.packed_arrays import Frames, Integers1, Numbers1, Numbers2, Sixes
from fem_lie.lie.tuples import (
    Matrix,
    Vector,
    combined,
    cross,
    dot,
    load,
    load_frame,
    load_row,
    minus,
    plus,
    rotate,
    rotate_back,
    scaled,
    store,
)
from fem_lie.solve.trees.blocks import (
    INERTIA,
    Symmetric,
    add_inertia,
    add_three,
    columns_crossed,
    first_half,
    inverse_of,
    load_blocks,
    load_symmetric,
    rotated,
    rotated_full,
    rows_crossed,
    second_half,
    store_halves,
    times,
    times_symmetric,
    transposed_times,
)

BALL, FREE, COMMUTING, GROUP = range(4)
"""Motions of a joint: rotations about its centre, all (of a link without one before), columns that
commute, any other subgroup."""


class Links(NamedTuple):
    """Constants of a tree of ``k`` links with ``d`` free columns; links follow the ones before.

    Attributes:
        parent: Link before each one, −1: ground, (k,).
        motion: Type of its joint's motion, (k,).
        first: First column of each link, and ``d`` at the end, (k + 1,).
        columns: Twists of the joint in the frame of the link, (d, 6).
        body: Mass, first moment (3) and moments of inertia (6) about the origin of the link, (k,
            10).
        gravity: Acceleration, if the loads are uniform gravity only, else zero, (3,).
    """

    parent: Integers1
    motion: Integers1
    first: Integers1
    columns: Sixes
    body: Numbers2
    gravity: Numbers1


class Motion(NamedTuple):
    """State of a tree at one time, and what follows from it.

    Attributes:
        X: Frames of the links in those before, (k, 4, 3).
        w: Rates ``q̇``, (d,).
        v: Twists, (k, 6).
        coriolis: ``ad(v) S q̇``, (k, 6).
        inertia: Inertia of each link with all behind it, (k, 21).
        p: Force of each link with all behind it, if it is not accelerated, (k, 6).
        u: ``I s`` of all columns; of ball joints and free links the columns of ``B D⁻¹``, (d, 6).
        e: ``s·p`` and ``1/d`` of all columns; of ball joints and free links ``D⁻¹ p``, then the
            acceleration of the origin, (d, 2).
        a: Rates of the twists minus gravity, (k, 6).
        rate: ``q̈``, (d,).
    """

    X: Frames
    w: Numbers1
    v: Sixes
    coriolis: Sixes
    inertia: Numbers2
    p: Sixes
    u: Sixes
    e: Numbers2
    a: Sixes
    rate: Numbers1


@inlined_uncounted
def outward(links: Links, now: Motion, bias: bool) -> None:
    """Velocities of all links, and their own inertia; with ``bias`` the forces of inertia at rest.

    Args:
        links: The tree.
        now: Its motion; ``X`` and ``w`` are given.
        bias: Whether ``p`` is that of inertia; else it is zero.
    """
    zero = (0.0, 0.0, 0.0)
    for i in range(links.parent.shape[0]):
        p, start, end = links.parent[i], links.first[i], links.first[i + 1]
        u = ω = su = sω = zero
        if links.motion[i] == BALL:
            sω = load(now.w, start)
        elif links.motion[i] == FREE:
            su, sω = load(now.w, start), load(now.w, start + 3)
        else:
            for k in range(start, end):
                su = combined(1.0, su, now.w[k], first_half(links.columns, k))
                sω = combined(1.0, sω, now.w[k], second_half(links.columns, k))
        if p >= 0:
            d1, d2, d3 = load_row(now.X[i], 1), load_row(now.X[i], 2), load_row(now.X[i], 3)
            ω = second_half(now.v, p)
            u = plus(first_half(now.v, p), cross(ω, load_row(now.X[i], 0)))
            u, ω = rotate_back(d1, d2, d3, u), rotate_back(d1, d2, d3, ω)
        u, ω = plus(u, su), plus(ω, sω)
        store_halves(now.v, i, u, ω)
        store_halves(now.coriolis, i, plus(cross(ω, su), cross(u, sω)), cross(ω, sω))
        m, J = links.body[i, 0], load_symmetric(links.body, i, 4)
        s = links.body[i, 1], links.body[i, 2], links.body[i, 3]
        for k in range(INERTIA):
            now.inertia[i, k] = 0.0
        now.inertia[i, 0] = now.inertia[i, 3] = now.inertia[i, 5] = m
        now.inertia[i, 7], now.inertia[i, 8], now.inertia[i, 9] = s[2], -s[1], -s[2]
        now.inertia[i, 11], now.inertia[i, 12], now.inertia[i, 13] = s[0], s[1], -s[0]
        for k in range(6):
            now.inertia[i, 15 + k] = J[k]
        if bias:
            n = plus(scaled(m, u), cross(ω, s))
            moment = plus(cross(s, u), times_symmetric(J, ω))
            store_halves(now.p, i, cross(ω, n), plus(cross(ω, moment), cross(u, n)))
        else:
            store_halves(now.p, i, zero, zero)


@inlined_uncounted
def _without_rotations(now: Motion, i: int, start: int) -> tuple[Symmetric, Vector]:
    """Eliminate all rotations of link ``i``: the mass of its origin, and the force there."""
    A, B, D = load_blocks(now.inertia, i)
    inverse = inverse_of(D)
    e = times_symmetric(inverse, second_half(now.p, i))
    b1, b2, b3 = (B[0], B[1], B[2]), (B[3], B[4], B[5]), (B[6], B[7], B[8])
    w1, w2 = times_symmetric(inverse, b1), times_symmetric(inverse, b2)
    w3 = times_symmetric(inverse, b3)
    for k in range(3):
        now.u[start + k, 0], now.u[start + k, 1] = w1[k], w2[k]
        now.u[start + k, 2], now.e[start + k, 0] = w3[k], e[k]
    A = (
        A[0] - dot(w1, b1), A[1] - dot(w1, b2), A[2] - dot(w1, b3),
        A[3] - dot(w2, b2), A[4] - dot(w2, b3), A[5] - dot(w3, b3),
    )  # fmt: skip
    return A, minus(first_half(now.p, i), times(B, e))


@inlined_uncounted
def _without_columns(
    links: Links, now: Motion, i: int
) -> tuple[tuple[Symmetric, Matrix, Symmetric], Vector, Vector]:
    """Eliminate the columns of link ``i`` one by one: what is left of its inertia and force."""
    A, B, D = load_blocks(now.inertia, i)
    pu, pω = first_half(now.p, i), second_half(now.p, i)
    for k in range(links.first[i], links.first[i + 1]):
        su, sω = first_half(links.columns, k), second_half(links.columns, k)
        uu = plus(times_symmetric(A, su), times(B, sω))
        uω = plus(transposed_times(B, su), times_symmetric(D, sω))
        inverse = 1.0 / (dot(su, uu) + dot(sω, uω))
        e = dot(su, pu) + dot(sω, pω)
        store_halves(now.u, k, uu, uω)
        now.e[k, 0], now.e[k, 1] = e, inverse
        x, y, z = scaled(inverse, uu)
        a, b, c = scaled(inverse, uω)
        A = (
            A[0] - x * uu[0], A[1] - x * uu[1], A[2] - x * uu[2],
            A[3] - y * uu[1], A[4] - y * uu[2], A[5] - z * uu[2],
        )  # fmt: skip
        B = (
            B[0] - x * uω[0], B[1] - x * uω[1], B[2] - x * uω[2],
            B[3] - y * uω[0], B[4] - y * uω[1], B[5] - y * uω[2],
            B[6] - z * uω[0], B[7] - z * uω[1], B[8] - z * uω[2],
        )  # fmt: skip
        D = (
            D[0] - a * uω[0], D[1] - a * uω[1], D[2] - a * uω[2],
            D[3] - b * uω[1], D[4] - b * uω[2], D[5] - c * uω[2],
        )  # fmt: skip
        pu, pω = combined(1.0, pu, -e, (x, y, z)), combined(1.0, pω, -e, (a, b, c))
    return (A, B, D), pu, pω


@inlined_uncounted
def _add_mass(now: Motion, i: int, parent: int, A: Symmetric, f: Vector) -> None:
    """Add the mass and the force at the origin of link ``i`` to the link before."""
    r, d1, d2, d3 = load_frame(now.X[i])
    f = rotate(d1, d2, d3, plus(f, times_symmetric(A, first_half(now.coriolis, i))))
    A = rotated(d1, d2, d3, A)
    add_three(now.p, parent, 0, f)
    add_three(now.p, parent, 3, cross(r, f))
    rows = rows_crossed(r, A)
    add_inertia(now.inertia, parent, A, rows, columns_crossed(r, rows))


@inlined_uncounted
def _add_all(
    now: Motion,
    i: int,
    parent: int,
    inertia: tuple[Symmetric, Matrix, Symmetric],
    pu: Vector,
    pω: Vector,
) -> None:
    """Add the inertia and the force of link ``i`` to the link before."""
    A, B, D = inertia
    r, d1, d2, d3 = load_frame(now.X[i])
    cu, cω = first_half(now.coriolis, i), second_half(now.coriolis, i)
    pu = plus(pu, plus(times_symmetric(A, cu), times(B, cω)))
    pω = plus(pω, plus(transposed_times(B, cu), times_symmetric(D, cω)))
    f = rotate(d1, d2, d3, pu)
    add_three(now.p, parent, 0, f)
    add_three(now.p, parent, 3, plus(rotate(d1, d2, d3, pω), cross(r, f)))
    A, D = rotated(d1, d2, d3, A), rotated(d1, d2, d3, D)
    b1, b2, b3 = rotated_full(d1, d2, d3, B)
    c1, c2, c3 = rows_crossed(r, A)
    rows = plus(b1, c1), plus(b2, c2), plus(b3, c3)
    S = columns_crossed(r, rows)
    # of −Bᵀ r̂, which alone is not symmetric
    k1 = cross(r, (b1[0], b2[0], b3[0]))
    k2 = cross(r, (b1[1], b2[1], b3[1]))
    k3 = cross(r, (b1[2], b2[2], b3[2]))
    D = (
        D[0] + S[0] + k1[0], D[1] + S[1] + k1[1], D[2] + S[2] + k1[2],
        D[3] + S[3] + k2[1], D[4] + S[4] + k2[2], D[5] + S[5] + k3[2],
    )  # fmt: skip
    add_inertia(now.inertia, parent, A, rows, D)


@inlined_uncounted
def inward(links: Links, now: Motion) -> None:
    """Eliminate all columns, from the last link to the first."""
    for i in range(links.parent.shape[0] - 1, -1, -1):
        parent, start = links.parent[i], links.first[i]
        if links.motion[i] == BALL:
            A, f = _without_rotations(now, i, start)
            if parent >= 0:
                _add_mass(now, i, parent, A, f)
        elif links.motion[i] == FREE:
            A, f = _without_rotations(now, i, start)
            a = times_symmetric(inverse_of(A), f)
            for k in range(3):
                now.e[start + 3 + k, 0] = -a[k]
        else:
            left, pu, pω = _without_columns(links, now, i)
            if parent >= 0:
                _add_all(now, i, parent, left, pu, pω)


@inlined_uncounted
def accelerations(links: Links, now: Motion) -> None:
    """Rates of all twists and of ``q̇``, from the first link to the last."""
    g = -links.gravity[0], -links.gravity[1], -links.gravity[2]
    for i in range(links.parent.shape[0]):
        parent, start, end = links.parent[i], links.first[i], links.first[i + 1]
        d1, d2, d3 = load_row(now.X[i], 1), load_row(now.X[i], 2), load_row(now.X[i], 3)
        u, ω = g, (0.0, 0.0, 0.0)
        if parent >= 0:
            ω = second_half(now.a, parent)
            u = plus(first_half(now.a, parent), cross(ω, load_row(now.X[i], 0)))
        u = plus(rotate_back(d1, d2, d3, u), first_half(now.coriolis, i))
        ω = plus(rotate_back(d1, d2, d3, ω), second_half(now.coriolis, i))
        if links.motion[i] <= FREE:
            at = start
            if links.motion[i] == FREE:
                found = now.e[start + 3, 0], now.e[start + 4, 0], now.e[start + 5, 0]
                store(now.rate, start, minus(found, u))
                u, at = found, start + 3
            turned = (
                -now.e[start, 0] - dot(first_half(now.u, start), u),
                -now.e[start + 1, 0] - dot(first_half(now.u, start + 1), u),
                -now.e[start + 2, 0] - dot(first_half(now.u, start + 2), u),
            )
            store(now.rate, at, minus(turned, ω))
            ω = turned
        else:
            for k in range(end - 1, start - 1, -1):
                pulled = now.e[k, 0] + dot(first_half(now.u, k), u) + dot(second_half(now.u, k), ω)
                q = -pulled * now.e[k, 1]
                u = combined(1.0, u, q, first_half(links.columns, k))
                ω = combined(1.0, ω, q, second_half(links.columns, k))
                now.rate[k] = q
        store_halves(now.a, i, u, ω)


@uncounted
def wrench(now: Motion, i: int) -> tuple[Vector, Vector]:
    """Force and moment of the joint on link ``i`` at its origin, in its axes."""
    u, ω = first_half(now.a, i), second_half(now.a, i)
    A, B, D = load_blocks(now.inertia, i)
    force = plus(times_symmetric(A, u), times(B, ω))
    moment = plus(transposed_times(B, u), times_symmetric(D, ω))
    return plus(force, first_half(now.p, i)), plus(moment, second_half(now.p, i))
