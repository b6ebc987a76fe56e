"""A hinged beam that is driven at its root, for small amplitudes, in closed form."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

LENGTH, CHORD, THICKNESS = 0.3, 0.15, 1e-3
E, DENSITY = 3e9, 1200.0
AREAL = DENSITY * THICKNESS
INERTIA = AREAL * LENGTH**3 / 3 + DENSITY * THICKNESS**3 * LENGTH / 12  # about the hinge, per chord
BENDING = E * THICKNESS**3 / 12  # per chord
ROOTS = [
    brentq(lambda b: np.sin(b) * np.cosh(b) - np.cos(b) * np.sinh(b), s, s + 1.5)
    for s in np.pi * np.arange(1, 9) + 0.1
]
FIRST = ROOTS[0] ** 2 * np.sqrt(BENDING / AREAL) / LENGTH**2
BEAT = 0.15 * FIRST  # W


def beam_tip(amplitude: float, times: np.ndarray) -> np.ndarray:
    """Height of the tip for small amplitudes, closed form, shape (T,)."""
    m0 = amplitude * INERTIA * BEAT**2
    total = amplitude * LENGTH * np.sin(BEAT * times)
    nodes, weights = np.polynomial.legendre.leggauss(80)
    x = 0.5 * (nodes + 1)
    for b in ROOTS:
        phi = np.sin(b * x) / np.sin(b) + np.sinh(b * x) / np.sinh(b)
        mass = AREAL * LENGTH * 0.5 * weights @ phi**2
        slope = b / LENGTH * (1 / np.sin(b) + 1 / np.sinh(b))
        w = b**2 * np.sqrt(BENDING / AREAL) / LENGTH**2
        shape = (np.sin(BEAT * times) - BEAT / w * np.sin(w * times)) / (w**2 - BEAT**2)
        total -= 2.0 * slope * m0 / mass * shape  # phi(L) = 2
    return total
