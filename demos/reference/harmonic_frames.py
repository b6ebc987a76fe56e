"""Harmonic response of plane frames of Euler-Bernoulli members, by the dynamic stiffness method."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np


def member(frequency: float, length: float, EA: complex, EI: complex, mass: float) -> np.ndarray:
    """Exact stiffness (6, 6) of a member on (u, w, w') at both ends, in its own axes.

    The solutions are cos and sin of a x along it, and cos, sin, cosh, sinh of b x across it.
    """
    a, b = np.sqrt(mass * frequency**2 / EA), (mass * frequency**2 / EI) ** 0.25
    ends, forces = np.zeros((6, 6), dtype=complex), np.zeros((6, 6), dtype=complex)
    for row, (x, outward) in zip((0, 3), ((0.0, -1.0), (length, 1.0)), strict=True):
        c, s, ch, sh = np.cos(b * x), np.sin(b * x), np.cosh(b * x), np.sinh(b * x)
        ends[row, :2] = np.cos(a * x), np.sin(a * x)
        forces[row, :2] = outward * EA * a * np.array([-np.sin(a * x), np.cos(a * x)])
        ends[row + 1, 2:] = c, s, ch, sh
        ends[row + 2, 2:] = b * np.array([-s, c, sh, ch])
        forces[row + 1, 2:] = -outward * EI * b**3 * np.array([s, -c, sh, ch])
        forces[row + 2, 2:] = outward * EI * b**2 * np.array([-c, -s, ch, sh])
    return np.asarray(forces @ np.linalg.inv(ends))


def chain(
    frequency: float, points: Sequence[tuple[float, float]], EA: complex, EI: complex, mass: float
) -> np.ndarray:
    """Compliance (3, 3) at the end of rigidly joined members in the plane, clamped at the start.

    Args:
        frequency: Angular frequency.
        points: Ends of the members.
        EA: Complex axial stiffness, with damping.
        EI: Complex bending stiffness.
        mass: Mass per length.
    """
    size = 3 * len(points)
    K = np.zeros((size, size), dtype=complex)
    for k, (start, end) in enumerate(pairwise(points)):
        along = np.subtract(end, start)
        length = float(np.hypot(*along))
        c, s = along / length
        axes = np.kron(np.eye(2), np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]))
        here = slice(3 * k, 3 * k + 6)
        K[here, here] += axes.T @ member(frequency, length, EA, EI, mass) @ axes
    return np.asarray(np.linalg.inv(K[3:, 3:])[-3:, -3:])


def loaded(
    points: Sequence[tuple[float, float]],
    omega: np.ndarray,
    EA: float,
    EI: float,
    mass: float,
    tau: float,
) -> np.ndarray:
    """Displacement of the end along its second axis under a unit force there, for all ``omega``.

    Args:
        points: Ends of the members.
        omega: Angular frequencies.
        EA: Axial stiffness.
        EI: Bending stiffness.
        mass: Mass per length.
        tau: Relaxation time.
    """
    factors = zip(omega, 1 + 1j * omega * tau, strict=True)
    return np.array([chain(w, points, EA * k, EI * k, mass)[1, 1] for w, k in factors])


def shaken(omega: np.ndarray, EI: float, mass: float, tau: float) -> np.ndarray:
    """Displacement of the tip relative to the base of a cantilever of length 1, for all ``omega``.

    The base has a unit acceleration across, which is a uniform load -m: the fourth derivative of
    the deflection times EI is m (omega^2 w - 1), with the solution 1/omega^2 and those without
    load.
    """
    found = []
    for w, k in zip(omega, 1 + 1j * omega * tau, strict=True):
        b, shift = (mass * w**2 / (EI * k)) ** 0.25, 1.0 / w**2
        c, s, ch, sh = np.cos(b), np.sin(b), np.cosh(b), np.sinh(b)
        ends = np.array([[1, 0, 1, 0], [0, 1, 0, 1], [-c, -s, ch, sh], [s, -c, sh, ch]])
        found.append(shift + np.linalg.solve(ends, [-shift, 0, 0, 0]) @ [c, s, ch, sh])
    return np.array(found)
