"""The drilling rotation of a six-parameter shell, tied to the rotation of its mid-surface.

With orthonormal reference coordinates and tangents ``a_i = R A_i`` that nodes carry, ``R`` turns
with the mid-surface, as the polar decomposition of its deformation says, exactly if
``c = a₁·x,₂ − a₂·x,₁ = 0``. (Fox & Simo, CMAME 98 (1992) 329.) A stress τ, bilinear in each cell,
makes it so weakly (perturbed Lagrangian ``τ c − τ²/2γ``; Hughes & Brezzi, CMAME 72 (1989) 105).
Fewer parameters of τ leave drilling that alternates from node to node without energy.

The drilling is continuous and the rotation of the mid-surface is not; the energy of the difference
is γ times its square. So γ belongs to the scale of bending, ``G t³/h²`` for cells of size h, or
below: with the often recommended ``G t``, thin shells lock.
"""

from __future__ import annotations

from collections.abc import Sequence

import ufl
from ufl.core.expr import Expr

from fem_lie.elements.shell_strains import Point, Surface

STRESSES = 4


def drilling(
    s: Surface, p: Point, inverse: Expr, first: Sequence[Expr], second: Sequence[Expr]
) -> Expr:
    """``c = a₁·x,₂ − a₂·x,₁``.

    Args:
        s: The cell.
        p: Point.
        inverse: ``J⁻¹`` there, see :func:`fem_lie.elements.shell_strains.local_jacobian`.
        first: Tangents ``a₁`` that the nodes carry.
        second: Tangents ``a₂``.
    """
    g = s.dx(0, p), s.dx(1, p)
    x1, x2 = (inverse[i, 0] * g[0] + inverse[i, 1] * g[1] for i in (0, 1))
    a1, a2 = s.shapes.combine(first, p), s.shapes.combine(second, p)
    return ufl.dot(a1, x2) - ufl.dot(a2, x1)


def perturbed_lagrangian(tau: Expr, p: Point, c: Expr, stiffness: Expr) -> Expr:
    """``τ c − τ²/2γ``.

    Args:
        tau: Four parameters of a cell.
        p: Point.
        c: Drilling there.
        stiffness: γ.
    """
    ξ, η = p[0] - 0.5, p[1] - 0.5
    τ = tau[0] + ξ * tau[1] + η * tau[2] + ξ * η * tau[3]
    return τ * c - τ**2 / (2 * stiffness)
