"""A hinged sheet that is driven at its root: as a beam in closed form, and the work done on it."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

import fem_lie as fl

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


def moment(amplitude: float, time: float) -> float:
    """Per length of the root, about y: a positive amplitude lifts the tip."""
    return float(amplitude * INERTIA * BEAT**2 * np.sin(BEAT * time))


def energy_error(result: fl.Result, scene: fl.Scene, amplitude: float) -> float:
    """Energy against the work of the moment at the root, by the trapezoidal rule."""
    (wing,) = scene.bodies
    assert isinstance(wing, fl.Shell)
    root = wing.model.edge_quadrature("a=0")
    nodes = result.info.body("wing").nodes[root.nodes]
    axes, local = result.frames[:, nodes, 1:], result.velocities[:, nodes, 3:]
    rate = np.einsum("ek,teki,teki->t", root.lengths, axes[..., 1], local)
    power = rate * np.array([moment(amplitude, t) for t in result.times])
    steps = 0.5 * (power[1:] + power[:-1]) * np.diff(result.times)
    energy = result.kinetic + result.elastic
    gained = np.concatenate([[0.0], np.cumsum(steps)])
    return float(np.abs(energy - energy[0] - gained).max() / energy.max())
