"""Increment of an element without its rigid part, and balanced mean of its forces at both ends.

Points 1 and 2 of :mod:`fem_lie.solve.conserving.midpoint.discrete_gradient`.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple, TypeAlias

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined
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
)
from fem_lie.solve.conserving.midpoint.cayley import turned

Symmetric: TypeAlias = tuple[float, float, float, float, float, float]
"""Symmetric matrix (3, 3), row by row from the diagonal."""


class Ends(NamedTuple):
    """Both ends of a step.

    Attributes:
        H0: Frames of all nodes at the start, (N, 4, 3).
        H1: Frames at the end.
        F0: Forces of all elements at the start, in the frames of their nodes, (cell nodes, 6).
        F1: Forces at the end.
    """

    H0: Array
    H1: Array
    F0: Array
    F1: Array


class Path(NamedTuple):
    """Means and increments of all nodes.

    Attributes:
        mean: Means of (x, d₁, d₂, d₃), (N, 4, 3).
        delta: Increments of them.
        step: Spatial translations and rotations ψ, (N, 6).
    """

    mean: Array
    delta: Array
    step: Array


class RigidPart(NamedTuple):
    """Rigid part of an element's increment.

    Attributes:
        centre: Mean of its nodes.
        ρ2: Their mean square distance from the centre, the metric of rotations.
        shift: Translation.
        ω: Rotation, as a vector of the Cayley map.
        inverse: Inverse of the metric of rotations about the centre, six numbers.
        half: Columns of the half rotation ``cay(ω)^½``.
        k: ``√(1 + ¼|ω|²)``.
    """

    centre: Vector
    ρ2: float
    shift: Vector
    ω: Vector
    inverse: Symmetric
    half: tuple[Vector, Vector, Vector]
    k: float


@inlined
def add_resistance(A: Array, s: float, v: Vector) -> None:
    """``A += s (|v|² I − v vᵀ)``."""
    square = dot(v, v)
    for i in range(3):
        A[i, i] += s * square
        for j in range(3):
            A[i, j] -= s * v[i] * v[j]


@inlined
def solve_symmetric(A: Array, b: Vector) -> Vector:
    """``A⁻¹ b`` of a symmetric positive definite matrix (3, 3)."""
    c00 = A[1, 1] * A[2, 2] - A[1, 2] * A[1, 2]
    c01 = A[0, 2] * A[1, 2] - A[0, 1] * A[2, 2]
    c02 = A[0, 1] * A[1, 2] - A[0, 2] * A[1, 1]
    c11 = A[0, 0] * A[2, 2] - A[0, 2] * A[0, 2]
    c12 = A[0, 1] * A[0, 2] - A[0, 0] * A[1, 2]
    c22 = A[0, 0] * A[1, 1] - A[0, 1] * A[0, 1]
    s = 1.0 / (A[0, 0] * c00 + A[0, 1] * c01 + A[0, 2] * c02)
    return (
        s * (c00 * b[0] + c01 * b[1] + c02 * b[2]),
        s * (c01 * b[0] + c11 * b[1] + c12 * b[2]),
        s * (c02 * b[0] + c12 * b[1] + c22 * b[2]),
    )


@inlined
def _resisting(director: bool, ρ2: float, t: Vector, w: Vector) -> Vector:
    """The metric on rotations: ``ρ² w``, or ``ρ² t×(w×t)`` for a director node."""
    return scaled(ρ2, cross(t, cross(w, t))) if director else scaled(ρ2, w)


@inlined
def shrunk(ω: Vector, v: Vector) -> Vector:
    """``C v`` with ``C`` the mean of ``cay(ω)^½`` and its transpose."""
    k = sqrt(1.0 + 0.25 * dot(ω, ω))
    return combined(1.0 / k, v, 0.25 * dot(ω, v) / (k * (1.0 + k)), ω)


@inlined
def unshrunk(ω: Vector, v: Vector) -> Vector:
    """``C⁻¹ v``."""
    k = sqrt(1.0 + 0.25 * dot(ω, ω))
    return combined(k, v, -0.25 * dot(ω, v) / (1.0 + k), ω)


@inlined
def _resisted(A: Symmetric, s: float, v: Vector) -> Symmetric:
    """``A + s (|v|² I − v vᵀ)``."""
    x, y, z = v
    a, b, c = s * x * x, s * y * y, s * z * z
    return (
        A[0] + (b + c),
        A[1] - s * x * y,
        A[2] - s * x * z,
        A[3] + (a + c),
        A[4] - s * y * z,
        A[5] + (a + b),
    )


@inlined
def _inverse(A: Symmetric) -> Symmetric:
    a, b, c, d, e, f = A
    c00, c01, c02 = d * f - e * e, c * e - b * f, b * e - c * d
    s = 1.0 / (a * c00 + b * c01 + c * c02)
    return s * c00, s * c01, s * c02, s * (a * f - c * c), s * (b * c - a * e), s * (a * d - b * b)


@inlined
def _times(A: Symmetric, v: Vector) -> Vector:
    x, y, z = v
    return (
        A[0] * x + A[1] * y + A[2] * z,
        A[1] * x + A[3] * y + A[4] * z,
        A[2] * x + A[4] * y + A[5] * z,
    )


@inlined
def metric_and_fit(nodes: Indices, director: bool, path: Path) -> RigidPart:
    """The rigid part of an element's increment, and the metric of rotations about it."""
    mean, delta, step = path
    share = 1.0 / nodes.shape[0]
    centre, shift = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for i in nodes:
        centre = plus(centre, scaled(share, load_row(mean[i], 0)))
        shift = plus(shift, scaled(share, load_row(delta[i], 0)))
    A = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    b, ρ2 = (0.0, 0.0, 0.0), 0.0
    for i in nodes:
        r = minus(load_row(mean[i], 0), centre)
        A = _resisted(A, 1.0, r)
        ρ2 += share * dot(r, r)
        b = plus(b, cross(r, minus(load_row(delta[i], 0), shift)))
    for i in nodes:
        t, ψ = load_row(mean[i], 3), load(step[i], 3)
        b = plus(b, _resisting(director, ρ2, t, ψ))
        if director:
            A = _resisted(A, ρ2, t)
        else:
            A = (A[0] + ρ2, A[1], A[2], A[3] + ρ2, A[4], A[5] + ρ2)
    inverse = _inverse(A)
    ω = _times(inverse, b)
    k = sqrt(1.0 + 0.25 * dot(ω, ω))
    φ = scaled(1.0 / (1.0 + k), ω)
    half = turned(φ, (1.0, 0.0, 0.0)), turned(φ, (0.0, 1.0, 0.0)), turned(φ, (0.0, 0.0, 1.0))
    return RigidPart(centre, ρ2, shift, ω, inverse, half, k)


@inlined
def _midpoint_frames(
    H0: Array, H1: Array, f0: Vector, f1: Vector, half: tuple[Vector, Vector, Vector]
) -> Vector:
    """``½ (Q R₀ f₀ + Qᵀ R₁ f₁)`` of forces in the node's frames, ``half`` columns of ``Q``."""
    a = rotate(load_row(H0, 1), load_row(H0, 2), load_row(H0, 3), f0)
    b = rotate(load_row(H1, 1), load_row(H1, 2), load_row(H1, 3), f1)
    q1, q2, q3 = half
    return combined(0.5, rotate(q1, q2, q3, a), 0.5, rotate_back(q1, q2, q3, b))


@inlined
def _on_director(f: Array) -> Vector:
    """Force along the frame's axes on its third director, equivalent to the moment ``f[3:5]``."""
    return f[4], -f[3], 0.0


@inlined
def mean_forces(
    nodes: Indices,
    director: bool,
    ends: Ends,
    mean: Array,
    fit: RigidPart,
    out: Array,
) -> None:
    """Mean of the forces (k, 6) at both ends, without its resultant and moment, into ``out``.

    The forces in ``ends`` are those of the element only.
    """
    H0, H1, F0, F1 = ends
    centre, ρ2, _, ω, inverse, half, k = fit
    once, along = 1.0 / k, 0.25 / (k * (1.0 + k))
    force, moment = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for a in range(nodes.shape[0]):
        i = nodes[a]
        t, r = load_row(mean[i], 3), minus(load_row(mean[i], 0), centre)
        # see shrunk and unshrunk
        f = _midpoint_frames(H0[i], H1[i], load(F0[a], 0), load(F1[a], 0), half)
        f = combined(once, f, along * dot(ω, f), ω)
        if director:
            g = _midpoint_frames(H0[i], H1[i], _on_director(F0[a]), _on_director(F1[a]), half)
            m = cross(t, combined(once, g, along * dot(ω, g), ω))
        else:
            g = _midpoint_frames(H0[i], H1[i], load(F0[a], 3), load(F1[a], 3), half)
            m = combined(once, g, -along * once * dot(ω, g), ω)
        store(out[a], 0, f)
        store(out[a], 3, m)
        force = plus(force, f)
        moment = plus(moment, plus(cross(r, f), m))
    c, w = scaled(1.0 / nodes.shape[0], force), _times(inverse, moment)
    for a in range(nodes.shape[0]):
        i = nodes[a]
        t, r = load_row(mean[i], 3), minus(load_row(mean[i], 0), centre)
        store(out[a], 0, minus(load(out[a], 0), plus(c, cross(w, r))))
        store(out[a], 3, minus(load(out[a], 3), _resisting(director, ρ2, t, w)))


@inlined
def deformation(
    nodes: Indices, director: bool, path: Path, fit: RigidPart, s: Array, Ms: Array
) -> float:
    """The increment without its rigid part, ``s`` and ``M s`` (k, 6); returns ``|s|²``."""
    mean, delta, step = path
    centre, ρ2, shift, ω, _, _, _ = fit
    square = 0.0
    for a in range(nodes.shape[0]):
        i = nodes[a]
        t, r = load_row(mean[i], 3), minus(load_row(mean[i], 0), centre)
        u = minus(minus(load_row(delta[i], 0), shift), cross(ω, r))
        w = minus(load(step[i], 3), ω)
        m = _resisting(director, ρ2, t, w)
        store(s[a], 0, u)
        store(s[a], 3, w)
        store(Ms[a], 0, u)
        store(Ms[a], 3, m)
        square += dot(u, u) + dot(w, m)
    return square
