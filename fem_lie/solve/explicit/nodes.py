"""Momenta of single nodes, and their motion with constant momenta; compiled.

With lumped inertia nodes have momenta of their own, ``p = (m ẋ, spin)`` in global components: for
frames the spin is the angular momentum about the mass centre; for position and position-gradient
nodes momenta are the rates of both vectors times their masses. A free node conserves them.
Rotations over a step are those of Moser & Veselov: with the increment ``F`` in the body::

    Σ E_kl e_k × F e_l = h Rᵀ spin            F = cay(ψ):  J ψ + ½ ψ × J ψ = (1 + ¼ ψ·ψ) h Rᵀ spin

(Commun. Math. Phys. 139 (1991) 217); for directors ``sin φ = h |spin|/E``.
"""

from __future__ import annotations

from math import asin, cos, nan, sin, sqrt
from typing import NamedTuple, TypeAlias

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined
from fem_lie._jit.packed_arrays import Integers1, Integers2, Numbers2, Numbers3
from fem_lie.lie.directors import rotate_onto
from fem_lie.lie.node_types import (
    POSITION,
    reorthonormalise,
    retract,
    to_global_components,
    to_nodal_components,
)
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

STILL, STRAIGHT, FRAME, DIRECTOR, AXIAL = 0, 1, 2, 3, 4
"""How a node moves: not at all, by additive vectors, as a frame, by its third axis, or with a
rotation about its first axis."""

_ROUND_OFF, _MOST = 4.0 * float(np.finfo(np.float64).eps), 50
_SMALL = 1e-10
"""Corrections below this fraction of a rotation are round-off if they no longer decrease."""


class Masses(NamedTuple):
    """Lumped inertia of nodes.

    Attributes:
        kinds: Types of the nodes, (n,).
        ways: How they move, see :data:`STILL`, (n,).
        masses: Masses of both vectors, 1 for a missing one; for frames the first is the mass, (n,
            2).
        centre: Mass centre of frames in their axes, (n, 3).
        turning: Inertia tensors about it, in the nodes' axes, (n, 3, 3).
        inverse: Their inverses, zero about axes without inertia, (n, 3, 3).
        edges: Nodes whose first axis is the direction to another node, and masters of the latter,
            (k, 2).
        ends: Positions of these other nodes in the frames of their masters, (k, 3).
    """

    kinds: Integers1
    ways: Integers1
    masses: Numbers2
    centre: Numbers2
    turning: Numbers3
    inverse: Numbers3
    edges: Integers2
    ends: Numbers2


PlainMasses: TypeAlias = tuple[
    Integers1, Integers1, Numbers2, Numbers2, Numbers3, Numbers3, Integers2, Numbers2
]


@inlined
def _times(A: Array, v: Vector) -> Vector:
    return dot(load_row(A, 0), v), dot(load_row(A, 1), v), dot(load_row(A, 2), v)


@inlined
def _axes(H: Array) -> tuple[Vector, Vector, Vector]:
    return load_row(H, 1), load_row(H, 2), load_row(H, 3)


@compiled
def kick(masses: PlainMasses, H: Array, r: Array, size: float, p: Array) -> None:
    """``p −= size · forces`` of the residual ``r`` (6 n,), in the axes of the nodes."""
    kinds, ways, _, centre, _, _, _, _ = masses
    f = np.empty(6)
    for i in range(kinds.shape[0]):
        way = ways[i]
        if way == STILL:
            continue
        if way == STRAIGHT:
            store(f, 0, load(r, 6 * i))
            store(f, 3, load(r, 6 * i + 3))
            to_global_components(kinds[i], H[i], f)
            for at in (0, 3):
                store(p[i], at, combined(1.0, load(p[i], at), -size, load(f, at)))
            continue
        d1, d2, d3 = _axes(H[i])
        force, moment = load(r, 6 * i), load(r, 6 * i + 3)
        moment = minus(moment, cross(load_row(centre, i), force))
        store(p[i], 0, combined(1.0, load(p[i], 0), -size, rotate(d1, d2, d3, force)))
        store(p[i], 3, combined(1.0, load(p[i], 3), -size, rotate(d1, d2, d3, moment)))


@compiled
def write_in_new_axes(kinds: Indices, before: Array, after: Array, r: Array) -> None:
    """Transform forces ``r`` (≥ 6 n,) along the axes of nodes to rotated axes.

    Args:
        kinds: Types of the nodes, (n,).
        before: Nodes with their old axes.
        after: The same with their new axes.
        r: Forces, updated.
    """
    f = np.empty(6)
    for i in range(kinds.shape[0]):
        f[:] = r[6 * i : 6 * i + 6]
        to_global_components(kinds[i], before[i], f)
        to_nodal_components(kinds[i], after[i], f)
        r[6 * i : 6 * i + 6] = f


@compiled
def decay(factors: Array, p: Array) -> None:
    """Multiply both halves of the momenta (n, 6) by factors (n, 2), or (0, 2) without damping."""
    for i in range(factors.shape[0]):
        for at in (0, 3):
            store(p[i], at, scaled(factors[i, at // 3], load(p[i], at)))


@compiled
def _turn_by(J: Array, inverse: Array, a: Vector) -> Vector:
    """``ψ`` with ``J ψ + ½ ψ × J ψ = (1 + ¼ ψ·ψ) a``; nan if there is no solution nearby."""
    ψ = _times(inverse, a)
    K, right, before = np.empty((3, 3)), np.empty(3), np.inf
    for _ in range(_MOST):
        Jψ = _times(J, ψ)
        wrong = combined(1.0, Jψ, 0.5, cross(ψ, Jψ))
        wrong = combined(1.0, wrong, -(1.0 + 0.25 * dot(ψ, ψ)), a)
        for k in range(3):
            e = (1.0 if k == 0 else 0.0), (1.0 if k == 1 else 0.0), (1.0 if k == 2 else 0.0)
            Je = _times(J, e)
            change = plus(cross(e, Jψ), cross(ψ, Je))
            change = combined(1.0, combined(1.0, Je, 0.5, change), -0.5 * dot(ψ, e), a)
            K[0, k], K[1, k], K[2, k] = change
        store(right, 0, wrong)
        step = _solved(K, right)
        ψ = minus(ψ, step)
        now, size = dot(step, step), dot(ψ, ψ)
        # if inertia differs much between axes, round-off is larger than that of ψ
        if now <= _ROUND_OFF**2 * size or (now >= before and now <= _SMALL**2 * size):
            return ψ
        before = now
    return nan, nan, nan


@inlined
def _solved(K: Array, right: Array) -> Vector:
    """Solution by Cramer's rule."""
    a, b, c = (
        (K[0, 0], K[1, 0], K[2, 0]),
        (K[0, 1], K[1, 1], K[2, 1]),
        (K[0, 2], K[1, 2], K[2, 2]),
    )
    r = load(right, 0)
    whole = 1.0 / dot(a, cross(b, c))
    return whole * dot(r, cross(b, c)), whole * dot(a, cross(r, c)), whole * dot(a, cross(b, r))


@inlined
def _by_cayley(ψ: Vector, e: Vector) -> Vector:
    once = cross(ψ, e)
    factor = 1.0 / (1.0 + 0.25 * dot(ψ, ψ))
    return combined(1.0, e, factor, combined(1.0, once, 0.5, cross(ψ, once)))


@inlined
def _by_angle(a: Vector, sine: float, e: Vector) -> Vector:
    """``e`` rotated about the unit vector ``a``."""
    angle = asin(sine) if sine <= 1.0 else nan
    once = cross(a, e)
    return combined(1.0, combined(1.0, e, sin(angle), once), 1.0 - cos(angle), cross(a, once))


@compiled
def _drift_frame(
    H: Array, way: int, inertia: tuple[Array, Array, Array], h: float, motion: tuple[Vector, Vector]
) -> None:
    """Move a frame with a velocity of the mass centre, and a spin about it."""
    (centre, J, inverse), (v, spin) = inertia, motion
    d1, d2, d3 = _axes(H)
    c = load(centre, 0)
    position = plus(load_row(H, 0), combined(h, v, 1.0, rotate(d1, d2, d3, c)))
    a = scaled(h, rotate_back(d1, d2, d3, spin))
    size = sqrt(dot(a, a))
    if size > 0.0:
        ψ = a if way != FRAME else _turn_by(J, inverse, a)
        angle = a[0] * inverse[0, 0]
        for k in range(3):
            e = (1.0 if k == 0 else 0.0), (1.0 if k == 1 else 0.0), (1.0 if k == 2 else 0.0)
            if way == DIRECTOR:
                e = _by_angle(scaled(1.0 / size, ψ), size * inverse[0, 0], e)
            elif way == AXIAL:
                once = cross((1.0, 0.0, 0.0), e)
                e = combined(cos(angle), e, sin(angle), once) if k > 0 else e
            else:
                e = _by_cayley(ψ, e)
            store_row(H, 1 + k, rotate(d1, d2, d3, e))
        reorthonormalise(0, H)
        d1, d2, d3 = _axes(H)
    store_row(H, 0, minus(position, rotate(d1, d2, d3, c)))


@compiled
def drift(masses: PlainMasses, p: Array, h: float, H: Array) -> None:
    """Move all nodes for a time ``h`` with constant momenta."""
    kinds, ways, weight, centre, turning, inverse, edges, ends = masses
    d = np.empty(6)
    for i in range(kinds.shape[0]):
        way = ways[i]
        if way == STILL:
            continue
        first = h / weight[i, 0]
        if way == STRAIGHT:
            if kinds[i] == POSITION:
                store_row(H[i], 0, combined(1.0, load_row(H[i], 0), first, load(p[i], 0)))
            else:
                store(d, 0, scaled(first, load(p[i], 0)))
                store(d, 3, scaled(h / weight[i, 1], load(p[i], 3)))
                to_nodal_components(kinds[i], H[i], d)
                retract(kinds[i], H[i], d, H[i])
            continue
        spin = load(p[i], 3)
        if way == DIRECTOR:
            # only round-off is along the axis
            d3 = load_row(H[i], 3)
            spin = combined(1.0, spin, -dot(spin, d3), d3)
        v = scaled(1.0 / weight[i, 0], load(p[i], 0))
        inertia = centre[i], turning[i], inverse[i]
        _drift_frame(H[i], way, inertia, h, (v, spin))
    _go_along_edges(edges, ends, p, H)


@compiled
def _go_along_edges(edges: Indices, ends: Array, p: Array, H: Array) -> None:
    """Rotate frames onto their edges by the smallest rotation, together with their spins."""
    for k in range(edges.shape[0]):
        i, j = edges[k, 0], edges[k, 1]
        d1, d2, d3 = _axes(H[j])
        end = plus(load_row(H[j], 0), rotate(d1, d2, d3, load_row(ends, k)))
        spin = dot(load(p[i], 3), load_row(H[i], 1))
        rotate_onto(H[i], minus(end, load_row(H[i], 0)))
        store(p[i], 3, scaled(spin, load_row(H[i], 1)))


@compiled
def momenta(masses: PlainMasses, H: Array, v: Array, p: Array) -> None:
    """Momenta of twists ``v`` (≥ n, 6) in the axes of the nodes."""
    kinds, ways, weight, centre, turning, _, _, _ = masses
    for i in range(kinds.shape[0]):
        p[i] = 0.0
        if ways[i] == STRAIGHT:
            p[i] = v[i]
            to_global_components(kinds[i], H[i], p[i])
            store(p[i], 0, scaled(weight[i, 0], load(p[i], 0)))
            store(p[i], 3, scaled(weight[i, 1], load(p[i], 3)))
        elif ways[i] != STILL:
            d1, d2, d3 = _axes(H[i])
            ω = load(v[i], 3)
            u = plus(load(v[i], 0), cross(ω, load_row(centre, i)))
            store(p[i], 0, rotate(d1, d2, d3, scaled(weight[i, 0], u)))
            store(p[i], 3, rotate(d1, d2, d3, _times(turning[i], ω)))


@compiled
def twists(masses: PlainMasses, H: Array, p: Array, v: Array) -> None:
    """Inverse of :func:`momenta`."""
    kinds, ways, weight, centre, _, inverse, _, _ = masses
    for i in range(kinds.shape[0]):
        v[i] = 0.0
        if ways[i] == STRAIGHT:
            store(v[i], 0, scaled(1.0 / weight[i, 0], load(p[i], 0)))
            store(v[i], 3, scaled(1.0 / weight[i, 1], load(p[i], 3)))
            to_nodal_components(kinds[i], H[i], v[i])
        elif ways[i] != STILL:
            d1, d2, d3 = _axes(H[i])
            ω = _times(inverse[i], rotate_back(d1, d2, d3, load(p[i], 3)))
            u = scaled(1.0 / weight[i, 0], rotate_back(d1, d2, d3, load(p[i], 0)))
            store(v[i], 0, minus(u, cross(ω, load_row(centre, i))))
            store(v[i], 3, ω)
