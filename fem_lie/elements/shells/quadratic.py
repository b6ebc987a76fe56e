"""Assumed strains of six-node triangles and nine-node quadrilaterals, in UFL.

MITC6: Lee & Bathe, Comput. Struct. 82 (2004) 945. MITC9: Bucalem & Bathe, IJNME 36 (1993) 3729.
Covariant strains are sampled where those of the quadratic interpolation are most accurate, and
interpolated from there.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import sqrt

import ufl
from ufl.core.expr import Expr

from fem_lie.elements.shells.strains import Point, Surface

LOW, HIGH = 0.5 - 0.5 / sqrt(3), 0.5 + 0.5 / sqrt(3)
TWO = (LOW, HIGH)
THREE = (0.5 - 0.5 * sqrt(0.6), 0.5, 0.5 + 0.5 * sqrt(0.6))
"""Gauss points of the unit interval."""

Sample = Callable[[float, float], Expr]


def _membrane(s: Surface, first: int, second: int) -> Sample:
    return lambda *q: ufl.dot(s.dx(first, q), s.dx(second, q))


def _shear(s: Surface, along: int) -> Sample:
    return lambda *q: ufl.dot(s.dx(along, q), s.t(q))


def _ends(low: Expr, high: Expr) -> tuple[Expr, Expr]:
    """Values at 0 and 1 of the linear function through values at the two Gauss points."""
    mean, rise = (low + high) / 2, sqrt(3) / 2 * (high - low)
    return mean - rise, mean + rise


def mitc6_shear(s: Surface, p: Point) -> Expr:
    """Shear ``x,α·t`` of a six-node triangle, linear, sampled at two Gauss points of each edge."""
    first, second = _shear(s, 0), _shear(s, 1)

    def across(σ: float) -> Expr:
        """Along the edge from (1, 0) to (0, 1)."""
        return second(1 - σ, σ) - first(1 - σ, σ)

    a1, end1 = _ends(first(LOW, 0.0), first(HIGH, 0.0))
    a2, end2 = _ends(second(0.0, LOW), second(0.0, HIGH))
    q0, q1 = _ends(across(LOW), across(HIGH))
    ξ, η = p
    return ufl.as_vector(
        [
            a1 + ξ * (end1 - a1) + η * (end2 - a1 - q1),
            a2 + η * (end2 - a2) + ξ * (q0 + end1 - a2),
        ]
    )


def mitc6_membrane(s: Surface, p: Point) -> Expr:
    """Membrane strain ``½ x,α·x,β`` as (11, 22, 2·12) of a six-node triangle, linear.

    The strain along each edge's direction is sampled at the edge's Gauss points and at the point
    ``1/√3`` towards the opposite corner.
    """
    ξ, η = p
    far = 1 / sqrt(3)

    def along_edge(sample: Sample, q: Callable[[float, float], Point]) -> Expr:
        """Linear in (σ along the edge, τ towards the corner); ``q`` gives the point of (σ, τ)."""
        start, end = _ends(sample(*q(LOW, 0.0)), sample(*q(HIGH, 0.0)))
        slope = end - start
        rise = (sample(*q(LOW, far)) - start - slope * LOW) / far
        return lambda σ, τ: start + slope * σ + rise * τ

    def stretch(*q: float) -> Expr:
        d = s.dx(1, q) - s.dx(0, q)
        return ufl.dot(d, d)

    e11 = along_edge(_membrane(s, 0, 0), lambda σ, τ: (σ, τ))(ξ, η)
    e22 = along_edge(_membrane(s, 1, 1), lambda σ, τ: (τ, σ))(η, ξ)
    across = along_edge(stretch, lambda σ, τ: (1 - σ - τ, σ))(η, 1 - ξ - η)
    return ufl.as_vector([e11 / 2, e22 / 2, (e11 + e22 - across) / 2])


def mitc9_membrane(s: Surface, p: Point) -> Expr:
    """``½ x,α·x,β`` as (11, 22, 2·12) of a nine-node quadrilateral, two points along α."""
    e11 = _tensor(_membrane(s, 0, 0), TWO, THREE, p)
    e22 = _tensor(_membrane(s, 1, 1), THREE, TWO, p)
    return ufl.as_vector([e11 / 2, e22 / 2, _tensor(_membrane(s, 0, 1), TWO, TWO, p)])


def mitc9_shear(s: Surface, p: Point) -> Expr:
    """``x,α·t`` of a nine-node quadrilateral, from two points along α and three across."""
    return ufl.as_vector(
        [_tensor(_shear(s, 0), TWO, THREE, p), _tensor(_shear(s, 1), THREE, TWO, p)]
    )


def _tensor(sample: Sample, first: Sequence[float], second: Sequence[float], p: Point) -> Expr:
    """Product polynomial through samples at ``first`` × ``second``."""
    return sum(
        _lagrange(first, i, p[0]) * _lagrange(second, k, p[1]) * sample(a, b)
        for i, a in enumerate(first)
        for k, b in enumerate(second)
    )


def _lagrange(points: Sequence[float], i: int, at: Expr) -> Expr:
    product = 1.0
    for k, other in enumerate(points):
        if k != i:
            product = product * (at - other) / (points[i] - other)
    return product
