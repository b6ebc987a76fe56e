"""Koiter's theory of thin cylinders under axial compression; radius 1."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

import fem_lie as fl

MATERIAL = fl.Material(1.0, 0.3, 1.0)
KOITER = np.sqrt(3 * (1 - MATERIAL.nu**2))


def half_wave(thickness: float) -> float:
    """Of the ring mode; the radius is 1."""
    return float(np.pi * np.sqrt(thickness) / (12 * (1 - MATERIAL.nu**2)) ** 0.25)


def koiter(relative: float) -> float:
    """Part of the classical load that is left with ring imperfections, over the thickness."""
    return float(brentq(lambda x: (1 - x) ** 2 - 1.5 * KOITER * relative * x, 0.0, 1.0))
