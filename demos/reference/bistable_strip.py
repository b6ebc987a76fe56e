"""Forces at which a shallow clamped arch snaps, by the modes of a straight strip.

J. Qiu, J. H. Lang & A. H. Slocum, J. Microelectromech. Syst. 13 (2004) 137. Forces over EI h/L^3.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq


def first_mode(q: float, d: float) -> float:
    """F1."""
    r = np.sqrt(0.25 - 4 / (3 * q**2))
    return float(1.5 * np.pi**4 * q**2 * d * (d - 1.5 + r) * (d - 1.5 - r))


def second_mode(d: float) -> float:
    """F2."""
    return float((4.18 - 2.18 * d) * np.pi**4)


def third_mode(d: float) -> float:
    """F3."""
    return float((8.0 - 6.0 * d) * np.pi**4)


def theory(q: float) -> dict[str, float]:
    """Largest and smallest force of a strip whose middle does not turn, and where it rests."""
    gap = lambda d: first_mode(q, d) - third_mode(d)  # noqa: E731
    top, bottom = brentq(gap, 0.0, 0.5), brentq(gap, 1.5, 2.2)
    turning = brentq(lambda d: first_mode(q, d) - second_mode(d), 0.0, 0.3)
    return {
        "top": third_mode(top),
        "bottom": third_mode(bottom),
        "rest": 1.5 + float(np.sqrt(0.25 - 4 / (3 * q**2))),
        "turning": second_mode(turning),
    }


def force(q: float, d: np.ndarray) -> np.ndarray:
    """Of a strip whose middle does not turn, at deflections ``d`` over h."""
    first, third = (np.array([f(x) for x in d]) for f in (lambda x: first_mode(q, x), third_mode))
    return np.where(d < 1.0, np.minimum(first, third), np.maximum(first, third))
