"""Law of threads: they resist stretch and bending, and may slacken.

Where a cable is pushed it buckles within its elements, and its matrix is singular where
tension vanishes. With ``slack``, a strain ``δ``, it is a weak spring there that pulls its ends
together::

    N = EA ε (ε > 3/2 δ),    N = k |x′| (ε < ½ δ),    k = EA δ/(1 + δ),

and a parabola between. Below, the force ``k x′`` is linear in the places, and everywhere the energy
is convex in them but for the bending: under dead loads there is one equilibrium, its matrix is
definite, and Newton's method finds it from wherever a cable is laid. (Not so across joints, whose
forces turn with the tangents while they are sought.) The price is a tension of about ``EA δ`` where
there was none.
"""

from __future__ import annotations

import numpy as np
import ufl
from ufl.core.expr import Expr

from fem_lie._arrays import Array

_ALIKE = 1e-9  # relative, as sections that are meant to be round


def stretch_energy(strain: Expr, slack: float | None) -> Expr:
    """``W/EA``; without slack it is ``½ ε²``.

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


def check_section(stiffness: Array) -> None:
    """Raise ``ValueError`` if a section has directions across, or couples stretch and bending."""
    EA, EI, other = (float(stiffness[k, k]) for k in (0, 4, 5))
    if abs(EI - other) > _ALIKE * max(EI, other):
        raise ValueError(
            "a Cable has no direction across, so its section must bend alike about all axes, "
            f"got EI = {EI:g} and {other:g}"
        )
    coupling = np.abs(stiffness[[0, 0, 4], [4, 5, 5]]).max()
    if coupling > _ALIKE * max(EI, np.sqrt(EA * EI)):
        raise ValueError(
            "a Cable is stretched along its centre: its section must not couple stretch and "
            f"bending, got the stiffness\n{stiffness}"
        )
