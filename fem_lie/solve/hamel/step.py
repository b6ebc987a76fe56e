"""Steps of single rigid bodies in their own frames, compiled; formulas are in :mod:`.hamel`."""

from __future__ import annotations

from math import nan, sqrt
from typing import NamedTuple, TypeAlias

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined
from fem_lie.lie.node_types import reorthonormalise
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
from fem_lie.solve.conserving.midpoint.cayley import mean_of, turned

_MOST = 200
_ROUND_OFF, _ROUND_OFF_LEVEL = 1e-16, 1e-11
"""Relative changes of velocities that are round-off; and that are if they do not decrease."""


class Bodies(NamedTuple):
    """Constants of all bodies.

    Attributes:
        mass: Masses, (n,).
        turning: Inertia tensors in the bodies' axes, (n, 3, 3).
        allowed: Bases of the admissible velocities, three of translation and three of rotation, in
            the bodies' axes, (n, 6, 6); only the first ``columns`` columns are used.
        inverse: Inverse of the inertia in these bases, (n, 6, 6).
        columns: Numbers of admissible velocities, (n,).
        radius: Radii of rolling discs, 0 for others, (n,).
        disc: Centres and axes of discs in the bodies' axes, (n, 2, 3).
        normal: Normals of the planes, (n, 3).
        gravity: Acceleration of gravity, (3,).
    """

    mass: Array
    turning: Array
    allowed: Array
    inverse: Array
    columns: Indices
    radius: Array
    disc: Array
    normal: Array
    gravity: Array


PlainBodies: TypeAlias = tuple[Array, Array, Array, Array, Indices, Array, Array, Array, Array]


@inlined
def _times(A: Array, v: Vector) -> Vector:
    return dot(load_row(A, 0), v), dot(load_row(A, 1), v), dot(load_row(A, 2), v)


@inlined
def _largest(change: float, size: float, previous: float) -> bool:
    """Whether a change is round-off, so that the iteration ends."""
    return change <= _ROUND_OFF * size or (
        change <= _ROUND_OFF_LEVEL * size and change > 0.5 * previous
    )


@inlined
def _arm(b: Vector, d: Vector, N: Vector, radius: float, sine: float) -> Vector:
    """Vector from the mass centre to the contact point, for a disc at ``b`` with the axis ``d``."""
    down = combined(1.0, N, -dot(N, d), d)
    return combined(1.0, b, -radius / sine, down)


@inlined
def _sine(d: Vector, N: Vector) -> float:
    c = dot(d, N)
    return sqrt(1.0 - c * c)


@compiled
def contact(H: Array, disc: Array, N: Array, radius: float) -> Vector:
    """Vector from the mass centre to the contact point at a frame (4, 3)."""
    d1, d2, d3 = load_row(H, 1), load_row(H, 2), load_row(H, 3)
    b, d = rotate(d1, d2, d3, load_row(disc, 0)), rotate(d1, d2, d3, load_row(disc, 1))
    up = load(N, 0)
    return _arm(b, d, up, radius, _sine(d, up))


@compiled
def rolling(H: Array, s: Array, disc: Array, normal: Array, radius: Array, out: Array) -> None:
    """Velocities in space of mass centres of discs that do not slip, (n, 3), at frames and twists.

    Rows of bodies without a radius are left as they are.
    """
    for i in range(len(radius)):
        if radius[i] > 0.0:
            ω = rotate(load_row(H[i], 1), load_row(H[i], 2), load_row(H[i], 3), load(s[i], 3))
            store(out[i], 0, cross(contact(H[i], disc[i], normal[i], radius[i]), ω))


@compiled
def _end(H: Array, position: Vector, ψ: Vector) -> None:
    store_row(H, 0, position)
    for k in range(1, 4):
        store_row(H, k, turned(ψ, load_row(H, k)))
    reorthonormalise(0, H)


@compiled
def _slide(
    H: Array,
    s: Array,
    inertia: tuple[float, Array, Array, Array, int],
    g: Vector,
    h: float,
    out: Array,
) -> None:
    """Step of a free body, or of one with constrained velocity components in its axes."""
    mass, J, Z, inverse, count = inertia
    d1, d2, d3 = load_row(H, 1), load_row(H, 2), load_row(H, 3)
    V0, W0 = load(s, 0), load(s, 3)
    mid, f, r = s.copy(), np.empty(6), np.empty(6)
    previous, V, W, ψ = np.inf, V0, W0, scaled(h, rotate(d1, d2, d3, W0))
    for attempt in range(_MOST):
        V, W = load(mid, 0), load(mid, 3)
        ψ = scaled(h, rotate(d1, d2, d3, W))
        m1, m2, m3 = mean_of(ψ, d1), mean_of(ψ, d2), mean_of(ψ, d3)
        fall = plus(cross(V, W), rotate_back(m1, m2, m3, g))
        store(f, 0, scaled(mass, combined(2.0 / h, minus(V, V0), -1.0, fall)))
        spin = cross(_times(J, W), W)
        store(f, 3, combined(2.0 / h, _times(J, minus(W, W0)), -1.0, spin))
        change = size = 0.0
        for j in range(count):
            r[j] = 0.0
            for k in range(6):
                r[j] += Z[k, j] * f[k]
        for k in range(6):
            step = 0.0
            for j in range(count):
                for i in range(count):
                    step -= 0.5 * h * Z[k, j] * inverse[j, i] * r[i]
            mid[k] += step
            change, size = max(change, abs(step)), max(size, abs(mid[k]))
        if _largest(change, size, previous):
            break
        previous = change
        if attempt == _MOST - 1:
            mid[:] = nan
    V, W = load(mid, 0), load(mid, 3)
    ψ = scaled(h, rotate(d1, d2, d3, W))
    m1, m2, m3 = mean_of(ψ, d1), mean_of(ψ, d2), mean_of(ψ, d3)
    store(out, 0, rotate(m1, m2, m3, load(f, 0)))
    store(out, 3, rotate(m1, m2, m3, load(f, 3)))
    for k in range(6):
        s[k] = 2.0 * mid[k] - s[k]
    _end(H, combined(1.0, load_row(H, 0), h, rotate(m1, m2, m3, V)), ψ)


@compiled
def _roll(
    H: Array,
    s: Array,
    inertia: tuple[float, Array],
    plane: tuple[float, Array, Array],
    g: Vector,
    h: float,
    out: Array,
) -> None:
    """Step of a rolling disc, which its rotation determines."""
    (mass, J), (radius, disc, normal) = inertia, plane
    d1, d2, d3 = load_row(H, 1), load_row(H, 2), load_row(H, 3)
    N, b, axis = load(normal, 0), load_row(disc, 0), load_row(disc, 1)
    v0, W0 = load(s, 0), load(s, 3)
    a = rotate_back(d1, d2, d3, contact(H, disc, normal, radius))
    K, right = np.empty((3, 3)), np.empty(3)
    for k in range(3):
        for i in range(3):
            K[k, i] = J[k, i] - mass * a[k] * a[i] + (mass * dot(a, a) if i == k else 0.0)
    inverse, previous = np.empty((3, 3)), np.inf
    inverse[:] = np.linalg.inv(K)
    W, ψ, v, F = W0, scaled(h, rotate(d1, d2, d3, W0)), v0, v0
    arm = a
    start = rotate(d1, d2, d3, axis)
    for attempt in range(_MOST):
        w = rotate(d1, d2, d3, W)
        ψ = scaled(h, w)
        m1, m2, m3 = mean_of(ψ, d1), mean_of(ψ, d2), mean_of(ψ, d3)
        end = turned(ψ, start)
        sine = 0.5 * (_sine(start, N) + _sine(end, N))
        middle = scaled(0.5, plus(start, end))
        arm = _arm(rotate(m1, m2, m3, b), middle, N, radius, sine)
        v = cross(arm, w)
        F = scaled(mass, combined(2.0 / h, minus(v, v0), -1.0, g))
        moment = plus(cross(_times(J, W), W), rotate_back(m1, m2, m3, cross(arm, F)))
        store(right, 0, combined(2.0 / h, _times(J, minus(W, W0)), -1.0, moment))
        step = scaled(-0.5 * h, _times(inverse, load(right, 0)))
        W = plus(W, step)
        change = sqrt(dot(step, step))
        if _largest(change, sqrt(dot(W, W)), previous):
            break
        previous = change
        if attempt == _MOST - 1:
            W = nan, nan, nan
    # the last change of W is round-off: the motion uses one and the same rotation
    ψ = scaled(h, rotate(d1, d2, d3, W))
    store(out, 0, F)
    store(out, 3, cross(arm, F))
    store(s, 0, combined(2.0, v, -1.0, v0))
    store(s, 3, combined(2.0, W, -1.0, W0))
    _end(H, combined(1.0, load_row(H, 0), h, v), ψ)


@compiled
def run(H: Array, s: Array, bodies: PlainBodies, h: float, steps: int, impulses: Array) -> None:
    """Make ``steps`` steps of all bodies.

    Args:
        H: Frames at their mass centres, (≥ n, 4, 3), updated.
        s: Velocities: translation (of discs in space, of others in their axes), and rotation in the
            axes, (n, 6), updated.
        bodies: See :class:`Bodies`.
        h: Step size.
        steps: Number of steps.
        impulses: Impulses of gravity and of contacts, force and moment about the origin, (2, 6),
            updated.
    """
    mass, turning, allowed, inverse, count, radius, disc, normal, gravity = bodies
    g, out = load(gravity, 0), np.empty(6)
    for _ in range(steps):
        for i in range(s.shape[0]):
            before = load_row(H[i], 0)
            if radius[i] > 0.0:
                plane = radius[i], disc[i], normal[i]
                _roll(H[i], s[i], (mass[i], turning[i]), plane, g, h, out)
            else:
                inertia = mass[i], turning[i], allowed[i], inverse[i], count[i]
                _slide(H[i], s[i], inertia, g, h, out)
            x = scaled(0.5, plus(before, load_row(H[i], 0)))
            F, weight = load(out, 0), scaled(mass[i], g)
            M, turn = plus(load(out, 3), cross(x, F)), cross(x, weight)
            for k in range(3):
                impulses[0, k] += h * weight[k]
                impulses[0, 3 + k] += h * turn[k]
                impulses[1, k] += h * F[k]
                impulses[1, 3 + k] += h * M[k]
