"""The drilling rotation of a six-parameter shell, tied to the rotation of its mid-surface.

With orthonormal reference coordinates and tangents ``a_i = R A_i`` that nodes carry, ``R`` turns
with the mid-surface, as the polar decomposition of its deformation says, exactly if
``c = a₁·x,₂ − a₂·x,₁ = 0``. (Fox & Simo, CMAME 98 (1992) 329.) Two values of a cell are made zero,
by a stress τ each (perturbed Lagrangian ``τ c − τ²/2γ``; Hughes & Brezzi, CMAME 72 (1989) 105):

- ``c`` at the centre. There are fewer cells than nodes, and drilling enters nothing else: with it
  alone the membrane would deform as with five parameters, whatever γ is.
- the alternating part ``a₁,ξη·x,₂ − a₂,ξη·x,₁``, the only drilling that the centre does not see:
  for a four-node cell, a mode without energy otherwise. A small γ holds it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import ufl
from ufl.core.expr import Expr

from fem_lie.elements.shell_strains import CENTRE, Surface


@dataclass(frozen=True)
class DrillingStiffness:
    """γ of the two constraints, force per length like the membrane's.

    Attributes:
        mean: Of the mean drilling, ``G t`` for instance.
        alternating: Of the alternating part, ``1e-3 G t`` for instance.
    """

    mean: float | Expr
    alternating: float | Expr

    def energy(self, c: Expr) -> Expr:
        """``½ γ c²``."""
        return 0.5 * (self.mean * c[0] ** 2 + self.alternating * c[1] ** 2)

    def perturbed_lagrangian(self, tau: Expr, c: Expr) -> Expr:
        """``τ c − τ²/2γ``."""
        flexibility = tau[0] ** 2 / self.mean + tau[1] ** 2 / self.alternating
        return ufl.inner(tau, c) - 0.5 * flexibility


def drilling(s: Surface, first: Sequence[Expr], second: Sequence[Expr]) -> Expr:
    """The two values of ``c`` of a four-node quadrilateral, shape (2,).

    Args:
        s: The cell.
        first: Tangents ``a₁`` that the nodes carry.
        second: Tangents ``a₂``.
    """
    inverse, g = ufl.inv(s.jacobian), (s.dx(0, CENTRE), s.dx(1, CENTRE))
    x1, x2 = (inverse[i, 0] * g[0] + inverse[i, 1] * g[1] for i in (0, 1))

    def product(a1: Expr, a2: Expr) -> Expr:
        return ufl.dot(a1, x2) - ufl.dot(a2, x1)

    def mean(a: Sequence[Expr]) -> Expr:
        return (a[0] + a[1] + a[2] + a[3]) / 4

    def alternating(a: Sequence[Expr]) -> Expr:
        return (a[0] - a[1] - a[2] + a[3]) / 4

    return ufl.as_vector(
        [product(mean(first), mean(second)), product(alternating(first), alternating(second))]
    )
