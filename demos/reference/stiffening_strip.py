"""Pure bending of a strip whose moment is M = EI κ + c κ³: an arc (the demo own_energy)."""

from math import asinh, sinh, sqrt

import numpy as np


def curvature(moment: float, bending: float, stiffening: float) -> float:
    """The real root of EI κ + c κ³ = M."""
    scale = sqrt(bending / (3 * stiffening))
    return 2 * scale * sinh(asinh(1.5 * moment / (bending * scale)) / 3)


def position(moment: float, s: float | np.ndarray, bending: float, stiffening: float) -> np.ndarray:
    """Points of the arc that begins at the origin along x, shape (3, …)."""
    kappa = curvature(moment, bending, stiffening)
    return np.array([np.sin(kappa * s), 1 - np.cos(kappa * s), 0 * s]) / kappa
