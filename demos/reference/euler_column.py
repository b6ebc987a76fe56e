"""Euler's loads of a column, and how far it is bent beyond them: the elastica."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipk

LENGTH = 1.0
BETA = {
    "fixed-free": np.pi / 2,
    "pinned-pinned": np.pi,
    "fixed-pinned": brentq(lambda x: np.tan(x) - x, 4.4, 4.6, xtol=1e-14),
    "fixed-fixed": 2 * np.pi,
}
"""Root of the critical load over EI/L^2."""
GROWS = {"fixed-free": 1.0, "pinned-pinned": 0.5, "fixed-fixed": 0.25}  # over L
FARTHEST = {"fixed-free": 1.0, "pinned-pinned": 0.5, "fixed-pinned": 0.5, "fixed-fixed": 0.5}
"""Where the deflection is largest, over L."""


def elastica(over: float, ends: str) -> float:
    """Largest deflection at ``over`` times the critical load."""
    m = brentq(lambda m: (2 * ellipk(m) / np.pi) ** 2 - over, 1e-12, 0.99)
    lever = GROWS[ends] * LENGTH * 2 * np.sqrt(m) / ellipk(m)
    # clamped at both ends it goes that far to either side of its inflections
    return float(2 * lever if ends == "fixed-fixed" else lever)


def deflection_error(deflection: float, over: float, ends: str) -> float | None:
    """Relative; None where the elastica is not known in closed form."""
    return deflection / elastica(over, ends) - 1.0 if ends in GROWS else None
