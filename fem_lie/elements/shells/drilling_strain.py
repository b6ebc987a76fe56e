"""The drilling rotation of a six-parameter shell, tied to the rotation of its mid-surface.

With orthonormal reference coordinates and tangents ``a_i = R A_i`` that nodes carry, ``R`` turns
with the mid-surface, as the polar decomposition of its deformation says, exactly if
``c = a₁·x,₂ − a₂·x,₁ = 0``. (Fox & Simo, CMAME 98 (1992) 329.) A stress τ with as
many parameters in a cell as it has nodes makes it so weakly (perturbed Lagrangian ``τ c − τ²/2γ``;
Hughes & Brezzi, CMAME 72 (1989) 105). Fewer leave drilling that alternates from node to node
without energy. Elements without fields of their own have ``½ γ c²`` at the points of integration.

The drilling is continuous and the rotation of the mid-surface is not; the energy of the difference
is γ times its square. So γ belongs to the scale of bending, ``G t³/h²`` for cells of size h, or
below: with the often recommended ``G t``, thin shells lock.
"""

from __future__ import annotations

from collections.abc import Sequence

import basix
import ufl
from ufl.core.expr import Expr

from fem_lie.elements.shells.strains import Point, Surface


def stress_modes(cell: basix.CellType, p: Point) -> list[Expr]:
    """Functions whose combinations are τ: linear on triangles, bilinear on quadrilaterals.

    Args:
        cell: Of first degree.
        p: Point.
    """
    centre = 1 / 3 if cell == basix.CellType.triangle else 1 / 2
    ξ, η = p[0] - centre, p[1] - centre
    linear = [ufl.as_ufl(1.0), ξ, η]
    return linear if cell == basix.CellType.triangle else [*linear, ξ * η]


def drilling(
    s: Surface, p: Point, inverse: Expr, first: Sequence[Expr], second: Sequence[Expr]
) -> Expr:
    """``c = a₁·x,₂ − a₂·x,₁``.

    Args:
        s: The cell.
        p: Point.
        inverse: ``J⁻¹`` there, see :func:`fem_lie.elements.shells.strains.local_jacobian`.
        first: Tangents ``a₁`` that the nodes carry.
        second: Tangents ``a₂``.
    """
    g = s.dx(0, p), s.dx(1, p)
    x1, x2 = (inverse[i, 0] * g[0] + inverse[i, 1] * g[1] for i in (0, 1))
    a1, a2 = s.shapes.combine(first, p), s.shapes.combine(second, p)
    return ufl.dot(a1, x2) - ufl.dot(a2, x1)


def perturbed_lagrangian(tau: Expr, modes: Sequence[Expr], c: Expr, stiffness: Expr) -> Expr:
    """``τ c − τ²/2γ``.

    Args:
        tau: Parameters of a cell.
        modes: See :func:`stress_modes`.
        c: Drilling there.
        stiffness: γ.
    """
    τ = sum(tau[i] * mode for i, mode in enumerate(modes))
    return τ * c - τ**2 / (2 * stiffness)
