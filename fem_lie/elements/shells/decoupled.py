"""Bending strain of a four-node shell that is independent of membrane strain, in UFL.

With the full form ``x,α·t,β`` a shell under membrane strain has bending strain; with this form it
has none, and a single element bends to any angle exactly. It suits shells with much bending and
little membrane strain.
"""

from __future__ import annotations

import ufl
from ufl.core.expr import Expr

from fem_lie.elements.shells.strains import CENTRE, Point, Surface, symmetric_product

EDGES = ((0, 1), (2, 3), (0, 2), (1, 3))
"""Nodes of the edges of DOLFINx's quadrilateral, two along each reference coordinate."""


def tangents_and_cosines(s: Surface) -> Expr:
    """Arguments of :func:`decoupled_bending`, shape (10,), for a four-node quadrilateral.

    They are ``x,₁`` and ``x,₂`` at the centre, and the cosines of the angles between the directors
    at the ends of each edge.
    """
    cosines = [ufl.dot(s.directors[a], s.directors[b]) for a, b in EDGES]
    return ufl.as_vector([*s.dx(0, CENTRE), *s.dx(1, CENTRE), *cosines])


def decoupled_bending(s: Surface, p: Point) -> Expr:
    """Bending strain ``½ (a_α·t,β + a_β·t,α)`` as (11, 22, 2·12), without membrane strain.

    The tangents ``a_α`` are the unloaded ones, rotated with the mid-surface at the cell's centre
    (polar decomposition), and ``t,α`` is the angle between the directors at the ends of an edge,
    interpolated to the opposite edge. A single four-node element under end moments bends to the
    exact angle. (Liu & Hu 2021, the simplified bending strain.)
    """
    given = tangents_and_cosines(s) if s.intermediate is None else s.intermediate
    g1, g2 = (ufl.as_vector([given[3 * k + j] for j in range(3)]) for k in (0, 1))
    arcs = [_arc(s.directors[a], s.directors[b], given[6 + k]) for k, (a, b) in enumerate(EDGES)]
    ξ, η = p
    dt = (1 - η) * arcs[0] + η * arcs[1], (1 - ξ) * arcs[2] + ξ * arcs[3]
    Q1, Q2 = rotated_axes(s.jacobian, g1, g2)
    J = s.jacobian_here
    tangents = J[0, 0] * Q1 + J[0, 1] * Q2, J[1, 0] * Q1 + J[1, 1] * Q2
    return symmetric_product(tangents, dt)


def rotated_axes(J: Expr, g1: Expr, g2: Expr) -> tuple[Expr, Expr]:
    """Axes ``Q e_i`` with the rotation ``Q`` of ``F = Q U``, ``F e_i = (J⁻¹)_iα g_α``.

    In two dimensions ``U = (C + √det C I)/√(tr C + 2 √det C)`` with ``C = FᵀF``.
    """
    inverse = ufl.inv(J)
    F = [inverse[i, 0] * g1 + inverse[i, 1] * g2 for i in (0, 1)]
    C11, C22, C12 = ufl.dot(F[0], F[0]), ufl.dot(F[1], F[1]), ufl.dot(F[0], F[1])
    area = ufl.sqrt(C11 * C22 - C12**2)
    # U⁻¹ = (tr U I − U)/det U
    scale = 1 / (ufl.sqrt(C11 + C22 + 2 * area) * area)
    return (
        scale * ((C22 + area) * F[0] - C12 * F[1]),
        scale * ((C11 + area) * F[1] - C12 * F[0]),
    )


def _arc(a: Expr, b: Expr, cosine: Expr) -> Expr:
    """Difference ``b − a`` of unit vectors, scaled from chord to the angle θ between them.

    ``θ/(2 sin θ/2) = (1 + u) atan(√u)/√u`` with ``u = tan² θ/4``; Gauss' continued fraction of the
    arcus tangent, which is smooth at 0, has an error of 1e-14 at a right angle.
    """
    half = ufl.sqrt((1 + cosine) / 2)
    u = (1 - half) / (1 + half)
    fraction: Expr | float = 21.0
    for k in range(10, 0, -1):
        fraction = (2 * k - 1) + k**2 * u / fraction
    return (1 + u) / fraction * (b - a)
