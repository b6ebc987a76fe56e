"""Axial law of cables, which may be tension-only.

Under compression a cable buckles within its elements, and its matrix is singular where tension
vanishes. With ``slack``, a strain ``δ``, it is replaced there by a weak spring that contracts it::

    N = EA ε (ε > 3/2 δ),    N = k |x′| (ε < ½ δ),    k = EA δ/(1 + δ),

with a parabola between. Below, the force ``k x′`` is linear in the positions, and the energy is
convex in them everywhere, except for bending: under dead loads there is one equilibrium, its matrix
is positive definite, and Newton's method finds it from any initial position. (This does not hold
across joints, whose forces rotate with the tangents during the iteration.) The price is a tension
of about ``EA δ`` where there was none.
"""

from __future__ import annotations

import numpy as np
import ufl
from ufl.core.expr import Expr

from fem_lie._arrays import Array

_ALIKE = 1e-9  # relative, as sections that are meant to be round


def stretch_energy(strain: Expr, slack: float | None) -> Expr:
    """Energy density ``W/EA``; without slack it is ``½ ε²``.

    Args:
        strain: ``ε``.
        slack: ``δ``, or ``None``.
    """
    if slack is None:
        return 0.5 * strain**2
    weak, width, beyond = slack / (1 + slack), 0.5 * slack, strain - slack
    between = (beyond + width) ** 3 / (12 * width)
    taut = 0.5 * beyond**2 + width**2 / 6
    more = ufl.conditional(ufl.gt(beyond, width), taut, between)
    return 0.5 * weak * (1 + strain) ** 2 + (1 - weak) * ufl.conditional(
        ufl.lt(beyond, -width), 0 * strain, more
    )


def stress_over_stiffness(strain: Array, slack: float | None) -> Array:
    """Axial force over ``EA``: the derivative of :func:`stretch_energy`.

    Args:
        strain: ``ε``, any shape.
        slack: ``δ``, or ``None``.
    """
    if slack is None:
        return strain
    weak, width, beyond = slack / (1 + slack), 0.5 * slack, strain - slack
    between = np.where(beyond < -width, 0.0, (beyond + width) ** 2 / (4 * width))
    return np.where(beyond > width, strain, weak * (1 + strain) + (1 - weak) * between)


def check_section(stiffness: Array) -> None:
    """Raise ``ValueError`` for unequal bending stiffness, or coupled stretch and bending."""
    EA, EI, other = (float(stiffness[k, k]) for k in (0, 4, 5))
    if abs(EI - other) > _ALIKE * max(EI, other):
        raise ValueError(
            "a Cable has no direction across, so its section must bend alike about all axes, "
            f"got EI = {EI:g} and {other:g}"
        )
    coupling = np.abs(stiffness[[0, 0, 4], [4, 5, 5]]).max()
    if coupling > _ALIKE * max(EI, np.sqrt(EA * EI)):
        raise ValueError(
            "a Cable is along the centre of its section, which must not couple stretch and "
            f"bending, got the stiffness\n{stiffness}"
        )
