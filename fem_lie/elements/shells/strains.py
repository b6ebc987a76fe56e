"""Strains of a Reissner-Mindlin shell with position ``x`` and director ``t``, in UFL.

With convected coordinates ``ξ^α`` of the mid-surface, and capitals for the unloaded state::

    E_αβ = ½ (x,α·x,β − X,α·X,β)                      membrane
    K_αβ = ½ (x,α·t,β + x,β·t,α) − reference          bending
    γ_α  = x,α·t − X,α·D                              transverse shear

All are quadratic in ``(x, t)`` and invariant under rigid rotation of both. (Simo & Fox, CMAME 72
(1989) 267.) Functions here return them in Voigt order as ``(11, 22, 2·12)`` and ``(1, 2)``, for one
state; those of the unloaded state are subtracted later, and :func:`to_local` transforms them to a
Cartesian basis.

A point of a cell is a pair of reference coordinates: numbers, for tying points, or UFL expressions,
for quadrature points. Therefore shape functions are written as polynomials
(:class:`ShapeFunctions`): UFL's ``grad`` is available at quadrature points only.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import prod
from typing import Any, TypeAlias

import basix
import numpy as np
import ufl
from ufl.core.expr import Expr

from fem_lie._arrays import Array
from fem_lie.mesh.shapes import nodes_of

Point: TypeAlias = Sequence[Any]
"""Reference coordinates: two numbers or two UFL expressions."""

CENTRE = (0.5, 0.5)
"""Centre of a quadrilateral."""


@dataclass(frozen=True)
class ShapeFunctions:
    """Lagrange shape functions of a cell, ``N_i = Σ_k c_ki ξ^a_k η^b_k``.

    Attributes:
        powers: Exponents ``(a, b)`` of the monomials.
        coefficients: ``c``, shape (monomials, nodes).
    """

    powers: tuple[tuple[int, int], ...]
    coefficients: Array

    @property
    def count(self) -> int:
        """Number of nodes."""
        return len(self.powers)

    @classmethod
    def of(cls, cell: basix.CellType, degree: int) -> ShapeFunctions:
        """Shape functions of DOLFINx's nodes.

        Args:
            cell: Triangle or quadrilateral.
            degree: 1 or 2, with equally spaced nodes.
        """
        total = degree if cell == basix.CellType.triangle else 2 * degree
        every = range(degree + 1)
        powers = tuple((a, b) for a in every for b in every if a + b <= total)
        nodes = nodes_of(cell.name, degree)
        monomials = np.array([[x**a * y**b for a, b in powers] for x, y in nodes])
        # they are small integers, up to round-off
        return cls(powers, np.asarray(np.round(np.linalg.inv(monomials), 10), dtype=np.float64))

    def combine(self, values: Sequence[Expr], p: Point, along: int | None = None) -> Expr:
        """Interpolation ``Σ N_i(p) value_i``, or its derivative in coordinate 0 or 1."""
        weights = [self._monomial(k, p, along) for k in range(len(self.powers))]
        terms: list[Expr] = []
        for i, value in enumerate(values):
            parts = zip(self.coefficients[:, i], weights, strict=True)
            weight = sum(float(c) * m for c, m in parts if c != 0.0 and not _zero(m))
            if not _zero(weight):
                terms.append(weight * value)
        return sum(terms[1:], terms[0])

    def _monomial(self, k: int, p: Point, along: int | None) -> Any:
        exponents = list(self.powers[k])
        factor = 1.0
        if along is not None:
            factor = float(exponents[along])
            exponents[along] -= 1
        if factor == 0.0:
            return 0.0
        return prod([p[j] for j in (0, 1) for _ in range(exponents[j])], start=factor)


def _zero(weight: Any) -> bool:
    return isinstance(weight, int | float) and weight == 0.0


@dataclass(frozen=True)
class Surface:
    """Mid-surface and directors of one cell, by their values at its nodes.

    Attributes:
        shapes: Shape functions.
        positions: ``x`` of the nodes, each of shape (3,).
        directors: ``t`` of the nodes, each of shape (3,).
        jacobian: ``J_αi = X,α·e_i`` at the unloaded cell's centre, shape (2, 2).
        jacobian_here: ``J_αi`` at the quadrature point.
        skew: ``(c₁, c₂)``: the part ``c_α X,α/2`` in the plane of the centre of
            ``¼ (X₀ − X₁ − X₂ + X₃)``, unloaded; zero for a parallelogram.
        intermediate: Values of a function of the surface as local unknowns, or ``None``: see
            :mod:`fem_lie.elements.shells.decoupled`.
        bubble: ``w`` of ``t = Σ N_i t_i + 27 ξ η (1 − ξ − η) w^α
            x,α`` on a three-node triangle, or ``None``. With components along ``x,α`` it rotates
            with the surface.
    """

    shapes: ShapeFunctions
    positions: Sequence[Expr]
    directors: Sequence[Expr]
    jacobian: Expr
    jacobian_here: Expr
    skew: Expr
    intermediate: Expr | None = None
    bubble: Expr | None = None

    def t(self, p: Point) -> Expr:
        """Director."""
        ξ, η = p
        return self._with_bubble(self.shapes.combine(self.directors, p), ξ * η * (1 - ξ - η))

    def dx(self, along: int, p: Point) -> Expr:
        """Tangent ``x,α``."""
        return self.shapes.combine(self.positions, p, along)

    def dt(self, along: int, p: Point) -> Expr:
        """Derivative of the director, ``t,α``."""
        mine, other = p[along], p[1 - along]
        t = self.shapes.combine(self.directors, p, along)
        return self._with_bubble(t, other * (1 - 2 * mine - other))

    def _with_bubble(self, t: Expr, shape: Any) -> Expr:
        if self.bubble is None:
            return t
        # x,α of a three-node triangle is the same everywhere
        g = [self.dx(k, (0.0, 0.0)) for k in (0, 1)]
        return t + 27 * shape * (self.bubble[0] * g[0] + self.bubble[1] * g[1])


def membrane(s: Surface, p: Point) -> Expr:
    """Membrane strain ``½ x,α·x,β`` as (11, 22, 2·12).

    Args:
        s: The surface, with its coordinates and directors.
        p: Point in reference coordinates.
    """
    a, b = s.dx(0, p), s.dx(1, p)
    return ufl.as_vector([ufl.dot(a, a) / 2, ufl.dot(b, b) / 2, ufl.dot(a, b)])


def mitc4_plus_membrane(s: Surface, p: Point) -> Expr:
    """Membrane strain ``½ x,α·x,β`` as (11, 22, 2·12) of a quadrilateral, from five points.

    It is independent of the warping of a cell, with which distorted meshes of curved thin shells
    would lock. (Ko, Lee & Bathe, Comput. Struct. 182 (2017) 404: MITC4+.)
    """

    def at(first: int, second: int, *q: float) -> Expr:
        return ufl.dot(s.dx(first, q), s.dx(second, q)) / 2

    a, b = at(0, 0, 0.5, 1.0), at(0, 0, 0.5, 0.0)
    c, d = at(1, 1, 1.0, 0.5), at(1, 1, 0.0, 0.5)
    middle = at(0, 1, 0.5, 0.5)
    c1, c2 = s.skew[0], s.skew[1]
    # x,₁₂·x,₁₂ by the strains at the five points: exact for a flat cell
    cross = (
        c1 * (c1 - 1) * a + c1 * (c1 + 1) * b + c2 * (c2 - 1) * c + c2 * (c2 + 1) * d
    ) / 2 + 2 * c1 * c2 * middle
    cross /= c1**2 + c2**2 - 1
    ξ, η = 2 * p[0] - 1, 2 * p[1] - 1
    e11 = (a + b) / 2 + η * (a - b) / 2 + (η**2 - 1) * cross
    e22 = (c + d) / 2 + ξ * (c - d) / 2 + (ξ**2 - 1) * cross
    e12 = middle + ξ * (a - b) / 4 + η * (c - d) / 4 + ξ * η * cross
    return ufl.as_vector([e11, e22, 2 * e12])


def bending(s: Surface, p: Point) -> Expr:
    """Bending strain ``½ (x,α·t,β + x,β·t,α)`` as (11, 22, 2·12), full form.

    It depends on membrane strain.

    Args:
        s: The surface, with its coordinates and directors.
        p: Point in reference coordinates.
    """
    return symmetric_product((s.dx(0, p), s.dx(1, p)), (s.dt(0, p), s.dt(1, p)))


def shear(s: Surface, p: Point) -> Expr:
    """Transverse shear strain ``x,α·t``."""
    t = s.t(p)
    return ufl.as_vector([ufl.dot(s.dx(0, p), t), ufl.dot(s.dx(1, p), t)])


def mitc4_shear(s: Surface, p: Point) -> Expr:
    """Shear ``x,α·t`` of a four-node quadrilateral, sampled at the midpoints of two edges.

    (Bathe & Dvorkin, IJNME 21 (1985) 367.)

    Args:
        s: The surface, with its coordinates and directors.
        p: Point in reference coordinates.
    """

    def at(along: int, *q: float) -> Expr:
        return ufl.dot(s.dx(along, q), s.t(q))

    ξ, η = p
    return ufl.as_vector(
        [
            (1 - η) * at(0, 0.5, 0.0) + η * at(0, 0.5, 1.0),
            (1 - ξ) * at(1, 0.0, 0.5) + ξ * at(1, 1.0, 0.5),
        ]
    )


def mitc3_shear(s: Surface, p: Point) -> Expr:
    """``x,α·t`` of a three-node triangle with a bubble, assumed linear: MITC3+.

    (Lee, Lee & Bathe, Comput. Struct. 138 (2014) 12, eq. 16.)
    """

    def at(*q: float) -> tuple[Expr, Expr]:
        t = s.t(q)
        return ufl.dot(s.dx(0, q), t), ufl.dot(s.dx(1, q), t)

    d = 1e-4
    (a1, a2), (b1, b2), (c1, c2) = at(1 / 6, 2 / 3), at(2 / 3, 1 / 6), at(1 / 6, 1 / 6)
    (d1, _), (_, e2) = at(1 / 3 + d, 1 / 3 - 2 * d), at(1 / 3 - 2 * d, 1 / 3 + d)
    f1, f2 = at(1 / 3 + d, 1 / 3 + d)
    twist, (ξ, η) = f1 - d1 - f2 + e2, p
    return ufl.as_vector(
        [
            (2 * b1 - b2) / 3 + (c1 + c2) / 3 + twist * (3 * η - 1) / 3,
            (2 * a2 - a1) / 3 + (c1 + c2) / 3 + twist * (1 - 3 * ξ) / 3,
        ]
    )


def symmetric_product(a: tuple[Expr, Expr], b: tuple[Expr, Expr]) -> Expr:
    """Symmetric product ``½ (a_α·b_β + a_β·b_α)`` as (11, 22, 2·12)."""
    return ufl.as_vector(
        [
            ufl.dot(a[0], b[0]),
            ufl.dot(a[1], b[1]),
            ufl.dot(a[0], b[1]) + ufl.dot(a[1], b[0]),
        ]
    )


def local_jacobian(unloaded: Surface, p: Point, direction: Expr) -> Expr:
    """Jacobian ``J_αi = X,α·e_i`` with e₁ along the projection of ``direction`` at ``p``.

    Args:
        unloaded: Unloaded surface.
        p: Point.
        direction: Vector of shape (3,), not normal to the surface: the axis e₁ of the material.
    """
    a, b = unloaded.dx(0, p), unloaded.dx(1, p)
    normal = _unit(ufl.cross(a, b))
    e1 = _unit(direction - ufl.dot(direction, normal) * normal)
    e2 = ufl.cross(normal, e1)
    return ufl.as_matrix([[ufl.dot(a, e1), ufl.dot(a, e2)], [ufl.dot(b, e1), ufl.dot(b, e2)]])


def _unit(v: Expr) -> Expr:
    return v / ufl.sqrt(ufl.dot(v, v))


def to_local(inverse: Expr, m: Expr, k: Expr, g: Expr) -> Expr:
    """Eight Cartesian strains of covariant membrane, bending and shear strains.

    ``E_ij = (J⁻¹)_iα E_αβ (J⁻¹)_jβ``, ``γ_i = (J⁻¹)_iα γ_α``; the result is
    ``(E₁₁, E₂₂, 2E₁₂, K₁₁, K₂₂, 2K₁₂, γ₁, γ₂)``.

    Args:
        inverse: ``J⁻¹``, see :func:`local_jacobian`.
        m: Membrane strain (11, 22, 2·12).
        k: Bending strain (11, 22, 2·12).
        g: Shear strain (1, 2).
    """

    def tensor(e: Expr) -> list[Expr]:
        E = inverse * ufl.as_matrix([[e[0], e[2] / 2], [e[2] / 2, e[1]]]) * ufl.transpose(inverse)
        return [E[0, 0], E[1, 1], E[0, 1] + E[1, 0]]

    local = inverse * g
    return ufl.as_vector([*tensor(m), *tensor(k), local[0], local[1]])
