"""Coulomb's law with springs that hold until they slip: the return mapping of all contacts."""

from __future__ import annotations

from typing import NamedTuple

from fem_lie._jit import inlined_uncounted


class CoulombLaw(NamedTuple):
    """Constants of a contact by penalty with friction, for a weight of one.

    Attributes:
        k: Normal stiffness.
        μ: Coefficient of friction.
        holding: Stiffness of the springs across the normal.
    """

    k: float
    μ: float
    holding: float


@inlined_uncounted
def limit(law: CoulombLaw, depth: float) -> float:
    """The largest traction at an overlap."""
    return law.μ * law.k * depth


@inlined_uncounted
def returned(law: CoulombLaw, stretch: float, most: float) -> tuple[float, bool]:
    """Size of the traction of a spring, and whether it slips.

    Args:
        law: Constants.
        stretch: Of the spring, not negative.
        most: The :func:`limit`.
    """
    trial = law.holding * stretch
    if trial <= most or stretch == 0.0:
        return trial, False
    return most, True
