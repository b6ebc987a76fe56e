"""Twist and lateral buckling of a cantilever of thin walls that is kept from warping."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_bvp

import fem_lie as fl

LENGTH, LONG = 2.0, 4.0  # the long one buckles
HEIGHT, WIDTH = 0.2, 0.1  # height between the mid-surfaces of the flanges
FLANGE, WEB = 0.006, 0.003
STEEL = fl.Material(E=210e9, nu=0.3, density=7850)
TORQUE = 50.0


def vlasov(shape: fl.sections.SectionShape) -> float:
    """Angle of twist under the torque, both ends without warping."""
    GJ = STEEL.G * shape.warping(STEEL).properties.torsion_constant
    k = np.sqrt(GJ / (STEEL.E * FLANGE * WIDTH**3 * HEIGHT**2 / 24))
    return float(TORQUE / GJ * (LENGTH - 2 / k * np.tanh(k * LENGTH / 2)))


def tipping_load(shape: fl.sections.SectionShape) -> float:
    """Force at the end at which the long beam buckles laterally, with warping."""
    GJ = STEEL.G * shape.warping(STEEL).properties.torsion_constant
    EI = STEEL.E * FLANGE * WIDTH**3 / 6
    EI_w, x = EI * HEIGHT**2 / 4, np.linspace(0, LONG, 50)

    def rates(x: np.ndarray, y: np.ndarray, p: np.ndarray) -> np.ndarray:
        return np.array([y[1], y[2], y[3], (GJ * y[2] + (p[0] * x) ** 2 / EI * y[0]) / EI_w])

    def ends(a: np.ndarray, b: np.ndarray, p: np.ndarray) -> np.ndarray:
        return np.array([a[0] - 1, a[1], a[3], b[0], b[1]])

    wave = np.pi * x / (2 * LONG)
    guess = np.array([np.cos(wave) ** 2, -np.pi / (2 * LONG) * np.sin(2 * wave), 0 * x, 0 * x])
    found = solve_bvp(rates, ends, x, guess, p=[4 * np.sqrt(EI * GJ) / LONG**2], tol=1e-6)
    return float(found.p[0])
