"""Independent stress and strain fields of shell elements with four and three nodes, in UFL.

Stress resultants ``(N, M, Q)`` of quadrilaterals, eight Cartesian components at a point, have 14
parameters: five each for membrane and bending, four for shear (Gruttmann & Wagner, CMAME 194 (2005)
4279)::

    N, M = [I₃, v₁ (η − η̄), v₂ (ξ − ξ̄)] s        v_α = (J_α1², J_α2², J_α1 J_α2)
    Q    = [I₂, J₁ (η − η̄), J₂ (ξ − ξ̄)] s

with the Jacobian ``J`` of the cell's centre and the centroid ``(ξ̄, η̄)``: the linear parts do no
work on constant strains.

Strains have 24 parameters: all eight components are linear in ``ξ`` and ``η``. They contain ``D⁻¹``
times any of these stresses, so that with a quadratic law and a constant ``D`` Hu-Washizu is
Hellinger-Reissner. With the 14 modes of the stresses only it would be stiffer: bending in the plane
has a transverse contraction that these modes do not contain.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import ufl
from ufl.core.expr import Expr

from fem_lie.elements.shells.strains import Point

STRAINS = 24


@dataclass(frozen=True)
class StressModes:
    """Stress resultants of a cell type.

    Attributes:
        size: Number of parameters.
        field: Function ``(parameters, point, centroid, J of the centre)`` that returns stress
            resultants, shape (8,).
    """

    size: int
    field: Callable[[Sequence[Expr], Point, Expr, Expr], Expr]


def quadrilateral_stress(s: Sequence[Expr], p: Point, centroid: Expr, J: Expr) -> Expr:
    """Stress resultants of a quadrilateral, shape (8,).

    Args:
        s: 14 parameters.
        p: Point.
        centroid: ``(ξ̄, η̄)``.
        J: Jacobian of the centre, shape (2, 2).
    """
    ξ, η = p[0] - centroid[0], p[1] - centroid[1]
    Q = [s[10 + i] + η * s[12] * J[0, i] + ξ * s[13] * J[1, i] for i in (0, 1)]
    return ufl.as_vector([*_linear(s[:5], ξ, η, J), *_linear(s[5:10], ξ, η, J), *Q])


def _linear(s: Sequence[Expr], ξ: Expr, η: Expr, J: Expr) -> list[Expr]:
    pairs = ((0, 0), (1, 1), (0, 1))
    return [
        s[k] + η * s[3] * J[0, i] * J[0, j] + ξ * s[4] * J[1, i] * J[1, j]
        for k, (i, j) in enumerate(pairs)
    ]


def strain(a: Sequence[Expr], p: Point, centroid: Expr) -> Expr:
    """Strains, shape (8,), linear in the reference coordinates, from 24 parameters."""
    ξ, η = p[0] - centroid[0], p[1] - centroid[1]
    return ufl.as_vector([a[i] + ξ * a[8 + i] + η * a[16 + i] for i in range(8)])


def triangle_stress(s: Sequence[Expr], p: Point, centroid: Expr, J: Expr) -> Expr:
    """Constant membrane stress, linear moments, and shear like the strain of MITC3+.

    Args:
        s: 15 parameters.
        p: Point.
        centroid: ``(1/3, 1/3)``.
        J: Jacobian of the cell, shape (2, 2).
    """
    ξ, η = p[0] - centroid[0], p[1] - centroid[1]
    M = [s[3 + i] + ξ * s[6 + i] + η * s[9 + i] for i in range(3)]
    Q = [s[12 + i] + s[14] * (η * J[0, i] - ξ * J[1, i]) for i in (0, 1)]
    return ufl.as_vector([s[0], s[1], s[2], *M, *Q])


QUADRILATERAL = StressModes(14, quadrilateral_stress)
TRIANGLE = StressModes(15, triangle_stress)
