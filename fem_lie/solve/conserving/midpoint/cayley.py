"""Mean configuration, increments and rotations over a step, by the Cayley map; compiled.

A node rotates by the spatial vector ψ with the Cayley map, ``R₁ = cay(ψ) R``. Mean and increment of
its directors are then, exactly::

    d̄ = (I − ½ψ̂)⁻¹ d = (d + ½ ψ×d + ¼ ψ (ψ·d)) / (1 + ¼|ψ|²),        d₁ − d = ψ × d̄,

so that a moment ``Σ d̄_k × f_k`` does exactly the work ``Σ f_k · (d₁_k − d_k)`` on ψ, and directors
stay orthonormal. (Betsch & Leyendecker, IJNME 67 (2006) 499; Romero & Armero, IJNME 54 (2002)
1683.) Increments are never differences of configurations: they have all their digits, however small
the step, and the configuration is their compensated sum.

Rotation error: a node that rotates at a constant rate ``ω`` is rotated in a step by the Cayley map
of ``h ω``, by the angle ``2 atan(h ω/2)`` instead of ``h ω``, which is too small by a fraction
``(h ω)²/12``. Energy and momenta do not show this, because they are those of ``ω``.
"""

from __future__ import annotations

from math import sqrt

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined, inlined_uncounted
from fem_lie.forms.fixed_arrays import as_frames, as_sixes
from fem_lie.lie.tuples import (
    Vector,
    combined,
    cross,
    dot,
    load,
    load_row,
    minus,
    plus,
    scaled,
    store_row,
)


def midpoint_frames(H: Array, end: Array, count: int) -> Array:
    """Frames at the midpoint along screw motions: means of rotating frames would be strained."""
    middle = end.copy()
    step = lie.se3_relative(H[:count], end[:count])
    middle[:count] = lie.se3_retract(H[:count], 0.5 * step)
    return middle


@inlined
def mean_of(ψ: Vector, d: Vector) -> Vector:
    """``(I − ½ψ̂)⁻¹ d``: the mean of ``d`` and ``cay(ψ) d``."""
    s = 1.0 / (1.0 + 0.25 * dot(ψ, ψ))
    turned = plus(combined(1.0, d, 0.5, cross(ψ, d)), scaled(0.25 * dot(ψ, d), ψ))
    return scaled(s, turned)


@inlined
def half(ψ: Vector) -> Vector:
    """The vector of the half rotation: ``cay(half ψ)² = cay(ψ)``."""
    return scaled(1.0 / (1.0 + sqrt(1.0 + 0.25 * dot(ψ, ψ))), ψ)


@inlined
def turned(ψ: Vector, d: Vector) -> Vector:
    """``cay(ψ) d``."""
    return plus(d, cross(ψ, mean_of(ψ, d)))


@inlined
def left_moment(moment: Vector, f: Vector, u: Vector) -> Vector:
    """Moment about the mean position of a node that moves by ``u``, from ``moment`` and ``f``."""
    return minus(moment, cross(scaled(0.5, u), f))


@compiled
def span(H: Array, step: Array, delta: Array, mean: Array, end: Array, middle: Array) -> None:
    """Increments, means, ends and midpoint frames of all nodes that move.

    Args:
        H: Frames at the start, (n, 4, 3).
        step: Spatial translation and rotation ψ of each node, (n, 6).
        delta: Increments of (x, d₁, d₂, d₃), (n, 4, 3), overwritten like the following.
        mean: Means.
        end: Frames at the end.
        middle: Mean positions with the half rotations.
    """
    H, step, delta, mean = as_frames(H), as_sixes(step), as_frames(delta), as_frames(mean)
    end, middle = as_frames(end), as_frames(middle)
    for i in range(step.shape[0]):
        span_one(H[i], step[i], delta[i], mean[i], end[i], middle[i])


@inlined_uncounted
def span_one(H: Array, step: Array, delta: Array, mean: Array, end: Array, middle: Array) -> None:
    """:func:`span` of one frame."""
    u, ψ = load(step, 0), load(step, 3)
    φ = half(ψ)
    x = load_row(H, 0)
    store_row(delta, 0, u)
    store_row(end, 0, plus(x, u))
    store_row(mean, 0, combined(1.0, x, 0.5, u))
    store_row(middle, 0, combined(1.0, x, 0.5, u))
    for k in range(1, 4):
        d = load_row(H, k)
        d_mean = mean_of(ψ, d)
        change = cross(ψ, d_mean)
        store_row(mean, k, d_mean)
        store_row(delta, k, change)
        store_row(end, k, plus(d, change))
        store_row(middle, k, turned(φ, d))


@compiled
def set_attached_nodes(A: Array, master: Indices, offset: Array, out: Array) -> None:
    """Coordinates (x, d₁, d₂, d₃) of all nodes from those of their masters, or increments.

    The map is linear. Shapes (≥ n, 4, 3), (N,), (N, 4, 3), (N, 4, 3).
    """
    for i in range(master.shape[0]):
        L, C = A[master[i]], offset[i]
        for k in range(4):
            for j in range(3):
                value = C[k, 0] * L[1, j] + C[k, 1] * L[2, j] + C[k, 2] * L[3, j]
                out[i, k, j] = value + L[0, j] if k == 0 else value


@compiled
def advance(q: Array, rest: Array, delta: Array) -> None:
    """``q += delta``, compensated: digits beyond double precision are kept in ``rest``.

    (n, 4, 3).
    """
    q, rest, delta = as_frames(q), as_frames(rest), as_frames(delta)
    for i in range(delta.shape[0]):
        for k in range(4):
            for j in range(3):
                term = delta[i, k, j] + rest[i, k, j]
                total = q[i, k, j] + term
                # |q| may be smaller than the term: Knuth's summation, not Dekker's
                part = total - q[i, k, j]
                rest[i, k, j] = (q[i, k, j] - (total - part)) + (term - part)
                q[i, k, j] = total


@inlined
def spin(H: Array, V: Array) -> Vector:
    """Angular velocity of a frame from its rates."""
    twice = (0.0, 0.0, 0.0)
    for k in range(1, 4):
        twice = plus(twice, cross(load_row(H, k), load_row(V, k)))
    return scaled(0.5, twice)
