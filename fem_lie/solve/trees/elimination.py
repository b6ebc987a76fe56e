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

from typing import NamedTuple, TypeAlias

from fem_lie._arrays import Array
from fem_lie._jit import inlined, inlined_uncounted, uncounted
from fem_lie._jit.packed_arrays import Frames, Integers1, Numbers1, Numbers2, Sixes
from fem_lie.lie.tuples import (
    Matrix,
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
)

BALL, FREE, COMMUTING, GROUP = range(4)
"""Motions of a joint: rotations about its centre, all (of a link without one before), columns that
commute, any other subgroup."""

Symmetric: TypeAlias = tuple[float, float, float, float, float, float]
"""Symmetric 3×3 matrix: xx, xy, xz, yy, yz, zz."""

INERTIA = 21
"""Numbers of an inertia: symmetric block of translations (6), coupling (9), rotations (6)."""


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
        bent: ``ad(v) S q̇``, (k, 6).
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
    bent: Sixes
    inertia: Numbers2
    p: Sixes
    u: Sixes
    e: Numbers2
    a: Sixes
    rate: Numbers1


@inlined
def _first(M: Array, i: int) -> Vector:
    return M[i, 0], M[i, 1], M[i, 2]


@inlined
def _last(M: Array, i: int) -> Vector:
    return M[i, 3], M[i, 4], M[i, 5]


@inlined
def _store(M: Array, i: int, u: Vector, ω: Vector) -> None:
    M[i, 0], M[i, 1], M[i, 2] = u
    M[i, 3], M[i, 4], M[i, 5] = ω


@inlined
def _add(M: Array, i: int, at: int, values: Vector) -> None:
    M[i, at] += values[0]
    M[i, at + 1] += values[1]
    M[i, at + 2] += values[2]


@inlined
def _symmetric(M: Array, i: int, at: int) -> Symmetric:
    return M[i, at], M[i, at + 1], M[i, at + 2], M[i, at + 3], M[i, at + 4], M[i, at + 5]


@inlined
def _blocks(M: Array, i: int) -> tuple[Symmetric, Matrix, Symmetric]:
    """Blocks of an inertia: translations, coupling, rotations."""
    B = M[i, 6], M[i, 7], M[i, 8], M[i, 9], M[i, 10], M[i, 11], M[i, 12], M[i, 13], M[i, 14]
    return _symmetric(M, i, 0), B, _symmetric(M, i, 15)


@inlined
def _times_symmetric(S: Symmetric, v: Vector) -> Vector:
    return (
        S[0] * v[0] + S[1] * v[1] + S[2] * v[2],
        S[1] * v[0] + S[3] * v[1] + S[4] * v[2],
        S[2] * v[0] + S[4] * v[1] + S[5] * v[2],
    )


@inlined
def _times(M: Matrix, v: Vector) -> Vector:
    return (
        M[0] * v[0] + M[1] * v[1] + M[2] * v[2],
        M[3] * v[0] + M[4] * v[1] + M[5] * v[2],
        M[6] * v[0] + M[7] * v[1] + M[8] * v[2],
    )


@inlined
def _transposed_times(M: Matrix, v: Vector) -> Vector:
    return (
        M[0] * v[0] + M[3] * v[1] + M[6] * v[2],
        M[1] * v[0] + M[4] * v[1] + M[7] * v[2],
        M[2] * v[0] + M[5] * v[1] + M[8] * v[2],
    )


@inlined
def _inverse(S: Symmetric) -> Symmetric:
    a, b, c, d, e, f = S
    xx, xy, xz = d * f - e * e, c * e - b * f, b * e - c * d
    r = 1.0 / (a * xx + b * xy + c * xz)
    return r * xx, r * xy, r * xz, r * (a * f - c * c), r * (b * c - a * e), r * (a * d - b * b)


@inlined
def _rotated(d1: Vector, d2: Vector, d3: Vector, S: Symmetric) -> Symmetric:
    """``R S Rᵀ``."""
    t1 = rotate(d1, d2, d3, (S[0], S[1], S[2]))
    t2 = rotate(d1, d2, d3, (S[1], S[3], S[4]))
    t3 = rotate(d1, d2, d3, (S[2], S[4], S[5]))
    return (
        t1[0] * d1[0] + t2[0] * d2[0] + t3[0] * d3[0],
        t1[0] * d1[1] + t2[0] * d2[1] + t3[0] * d3[1],
        t1[0] * d1[2] + t2[0] * d2[2] + t3[0] * d3[2],
        t1[1] * d1[1] + t2[1] * d2[1] + t3[1] * d3[1],
        t1[1] * d1[2] + t2[1] * d2[2] + t3[1] * d3[2],
        t1[2] * d1[2] + t2[2] * d2[2] + t3[2] * d3[2],
    )


@inlined
def _rotated_full(d1: Vector, d2: Vector, d3: Vector, M: Matrix) -> tuple[Vector, Vector, Vector]:
    """Rows of ``R M Rᵀ``."""
    t1 = rotate(d1, d2, d3, (M[0], M[3], M[6]))
    t2 = rotate(d1, d2, d3, (M[1], M[4], M[7]))
    t3 = rotate(d1, d2, d3, (M[2], M[5], M[8]))
    return (
        plus(scaled(t1[0], d1), combined(t2[0], d2, t3[0], d3)),
        plus(scaled(t1[1], d1), combined(t2[1], d2, t3[1], d3)),
        plus(scaled(t1[2], d1), combined(t2[2], d2, t3[2], d3)),
    )


@inlined
def _add_inertia(
    M: Array, i: int, A: Symmetric, b: tuple[Vector, Vector, Vector], D: Symmetric
) -> None:
    """Add blocks ``A``, the rows of ``B``, and ``D``."""
    for k in range(6):
        M[i, k] += A[k]
        M[i, 15 + k] += D[k]
    for k in range(3):
        M[i, 6 + k] += b[0][k]
        M[i, 9 + k] += b[1][k]
        M[i, 12 + k] += b[2][k]


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
                su = combined(1.0, su, now.w[k], _first(links.columns, k))
                sω = combined(1.0, sω, now.w[k], _last(links.columns, k))
        if p >= 0:
            d1, d2, d3 = load_row(now.X[i], 1), load_row(now.X[i], 2), load_row(now.X[i], 3)
            ω = _last(now.v, p)
            u = plus(_first(now.v, p), cross(ω, load_row(now.X[i], 0)))
            u, ω = rotate_back(d1, d2, d3, u), rotate_back(d1, d2, d3, ω)
        u, ω = plus(u, su), plus(ω, sω)
        _store(now.v, i, u, ω)
        _store(now.bent, i, plus(cross(ω, su), cross(u, sω)), cross(ω, sω))
        m, J = links.body[i, 0], _symmetric(links.body, i, 4)
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
            moment = plus(cross(s, u), _times_symmetric(J, ω))
            _store(now.p, i, cross(ω, n), plus(cross(ω, moment), cross(u, n)))
        else:
            _store(now.p, i, zero, zero)


@inlined_uncounted
def inward(links: Links, now: Motion) -> None:
    """Eliminate all columns, from the last link to the first."""
    for i in range(links.parent.shape[0] - 1, -1, -1):
        parent, start, end = links.parent[i], links.first[i], links.first[i + 1]
        A, B, D = _blocks(now.inertia, i)
        pu, pω = _first(now.p, i), _last(now.p, i)
        d1, d2, d3 = load_row(now.X[i], 1), load_row(now.X[i], 2), load_row(now.X[i], 3)
        r, cu, cω = load_row(now.X[i], 0), _first(now.bent, i), _last(now.bent, i)
        if links.motion[i] <= FREE:
            inverse = _inverse(D)
            e = _times_symmetric(inverse, pω)
            w1 = _times_symmetric(inverse, (B[0], B[1], B[2]))
            w2 = _times_symmetric(inverse, (B[3], B[4], B[5]))
            w3 = _times_symmetric(inverse, (B[6], B[7], B[8]))
            for k in range(3):
                now.u[start + k, 0], now.u[start + k, 1] = w1[k], w2[k]
                now.u[start + k, 2], now.e[start + k, 0] = w3[k], e[k]
            ball = links.motion[i] == BALL
            if ball and parent < 0:
                continue
            b1, b2, b3 = (B[0], B[1], B[2]), (B[3], B[4], B[5]), (B[6], B[7], B[8])
            A = (
                A[0] - dot(w1, b1), A[1] - dot(w1, b2), A[2] - dot(w1, b3),
                A[3] - dot(w2, b2), A[4] - dot(w2, b3), A[5] - dot(w3, b3),
            )  # fmt: skip
            f = minus(pu, _times(B, e))
            if not ball:
                f = _times_symmetric(_inverse(A), f)
                for k in range(3):
                    now.e[start + 3 + k, 0] = -f[k]
                continue
            f = plus(f, _times_symmetric(A, cu))
            f, A = rotate(d1, d2, d3, f), _rotated(d1, d2, d3, A)
            _add(now.p, parent, 0, f)
            _add(now.p, parent, 3, cross(r, f))
            c1 = cross(r, (A[0], A[1], A[2]))
            c2 = cross(r, (A[1], A[3], A[4]))
            c3 = cross(r, (A[2], A[4], A[5]))
            g1, g2, g3 = (c1[0], c2[0], c3[0]), (c1[1], c2[1], c3[1]), (c1[2], c2[2], c3[2])
            h1, h2, h3 = cross(r, g1), cross(r, g2), cross(r, g3)
            S = h1[0], h2[0], h3[0], h2[1], h3[1], h3[2]
            _add_inertia(now.inertia, parent, A, (c1, c2, c3), S)
            continue
        for k in range(start, end):
            su, sω = _first(links.columns, k), _last(links.columns, k)
            uu = plus(_times_symmetric(A, su), _times(B, sω))
            uω = plus(_transposed_times(B, su), _times_symmetric(D, sω))
            inverse_d = 1.0 / (dot(su, uu) + dot(sω, uω))
            e_k = dot(su, pu) + dot(sω, pω)
            _store(now.u, k, uu, uω)
            now.e[k, 0], now.e[k, 1] = e_k, inverse_d
            x, y, z = scaled(inverse_d, uu)
            a, b, c = scaled(inverse_d, uω)
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
            pu, pω = combined(1.0, pu, -e_k, (x, y, z)), combined(1.0, pω, -e_k, (a, b, c))
        if parent < 0:
            continue
        pu = plus(pu, plus(_times_symmetric(A, cu), _times(B, cω)))
        pω = plus(pω, plus(_transposed_times(B, cu), _times_symmetric(D, cω)))
        f, A = rotate(d1, d2, d3, pu), _rotated(d1, d2, d3, A)
        _add(now.p, parent, 0, f)
        _add(now.p, parent, 3, plus(rotate(d1, d2, d3, pω), cross(r, f)))
        b1, b2, b3 = _rotated_full(d1, d2, d3, B)
        D = _rotated(d1, d2, d3, D)
        c1 = plus(b1, cross(r, (A[0], A[1], A[2])))
        c2 = plus(b2, cross(r, (A[1], A[3], A[4])))
        c3 = plus(b3, cross(r, (A[2], A[4], A[5])))
        g1, g2, g3 = (c1[0], c2[0], c3[0]), (c1[1], c2[1], c3[1]), (c1[2], c2[2], c3[2])
        h1, h2, h3 = cross(r, g1), cross(r, g2), cross(r, g3)
        k1 = cross(r, (b1[0], b2[0], b3[0]))
        k2 = cross(r, (b1[1], b2[1], b3[1]))
        k3 = cross(r, (b1[2], b2[2], b3[2]))
        S = (
            D[0] + h1[0] + k1[0], D[1] + h2[0] + k1[1], D[2] + h3[0] + k1[2],
            D[3] + h2[1] + k2[1], D[4] + h3[1] + k2[2], D[5] + h3[2] + k3[2],
        )  # fmt: skip
        _add_inertia(now.inertia, parent, A, (c1, c2, c3), S)


@inlined_uncounted
def accelerations(links: Links, now: Motion) -> None:
    """Rates of all twists and of ``q̇``, from the first link to the last."""
    g = -links.gravity[0], -links.gravity[1], -links.gravity[2]
    for i in range(links.parent.shape[0]):
        parent, start, end = links.parent[i], links.first[i], links.first[i + 1]
        d1, d2, d3 = load_row(now.X[i], 1), load_row(now.X[i], 2), load_row(now.X[i], 3)
        u, ω = g, (0.0, 0.0, 0.0)
        if parent >= 0:
            ω = _last(now.a, parent)
            u = plus(_first(now.a, parent), cross(ω, load_row(now.X[i], 0)))
        u = plus(rotate_back(d1, d2, d3, u), _first(now.bent, i))
        ω = plus(rotate_back(d1, d2, d3, ω), _last(now.bent, i))
        if links.motion[i] <= FREE:
            at = start
            if links.motion[i] == FREE:
                found = now.e[start + 3, 0], now.e[start + 4, 0], now.e[start + 5, 0]
                store(now.rate, start, minus(found, u))
                u, at = found, start + 3
            turned = (
                -now.e[start, 0] - dot(_first(now.u, start), u),
                -now.e[start + 1, 0] - dot(_first(now.u, start + 1), u),
                -now.e[start + 2, 0] - dot(_first(now.u, start + 2), u),
            )
            store(now.rate, at, minus(turned, ω))
            ω = turned
        else:
            for k in range(end - 1, start - 1, -1):
                pulled = now.e[k, 0] + dot(_first(now.u, k), u) + dot(_last(now.u, k), ω)
                q = -pulled * now.e[k, 1]
                u = combined(1.0, u, q, _first(links.columns, k))
                ω = combined(1.0, ω, q, _last(links.columns, k))
                now.rate[k] = q
        _store(now.a, i, u, ω)


@uncounted
def wrench(now: Motion, i: int) -> tuple[Vector, Vector]:
    """Force and moment of the joint on link ``i`` at its origin, in its axes."""
    u, ω = _first(now.a, i), _last(now.a, i)
    A, B, D = _blocks(now.inertia, i)
    force = plus(_times_symmetric(A, u), _times(B, ω))
    moment = plus(_transposed_times(B, u), _times_symmetric(D, ω))
    return plus(force, _first(now.p, i)), plus(moment, _last(now.p, i))
