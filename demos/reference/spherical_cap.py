"""Snap of a clamped spherical cap by ordinary differential equations along its meridian.

:func:`reissner` is the theory of shallow shells, :func:`exact` has finite rotations, shear and a
pressure that follows. Both are solved at growing deflections of the centre.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_bvp

import fem_lie as fl

RISE, RIM = 0.05, 1.0
MATERIAL = fl.Material(1.0, 0.3, 1.0)
SHELL = np.sqrt(3 * (1 - MATERIAL.nu**2))
RADIUS = (RIM**2 + RISE**2) / (2 * RISE)


def thickness_of(number: float) -> float:
    """That of the cap with this s."""
    return float(RISE * 4 * SHELL / number**2)


def classical(thickness: float) -> float:
    """Pressure at which the whole sphere buckles."""
    return float(2 * MATERIAL.E * thickness**2 / (RADIUS**2 * SHELL))


def reissner(thickness: float) -> tuple[np.ndarray, np.ndarray]:
    """Deflections of the centre over t, and pressures over the classical one."""
    E, nu, p_c = MATERIAL.E, MATERIAL.nu, classical(thickness)
    D = E * thickness**3 / (12 * (1 - nu**2))
    r = np.linspace(1e-4 * RIM, RIM, 60)

    def rates(r: np.ndarray, y: np.ndarray, q: np.ndarray) -> np.ndarray:
        b, db, n, dn, _ = y
        slope = -2 * RISE * r / RIM**2
        bend = (n * (slope + b) / r - q[0] * p_c * r / 2) / D
        stretch = -E * thickness * (slope * b + b * b / 2) / r
        return np.array([db, bend - db / r + b / r**2, dn, stretch - dn / r + n / r**2, b])

    def ends(w: float) -> Callable[..., np.ndarray]:
        return lambda a, b, q: np.array([a[0], a[2], a[4] + w, b[0], RIM * b[3] - nu * b[2], b[4]])

    return pressures_at(r, np.zeros((5, len(r))), rates, ends, thickness)


def pressures_at(
    x: np.ndarray,
    guess: np.ndarray,
    rates: Callable[..., np.ndarray],
    ends: Callable[[float], Callable[..., np.ndarray]],
    thickness: float,
) -> tuple[np.ndarray, np.ndarray]:
    """Solutions at growing deflections of the centre, each from the last one."""
    deflections, pressures, q = np.linspace(0.05, 3.0, 60) * thickness, [], np.array([0.01])
    for w in deflections:
        found = solve_bvp(rates, ends(w), x, guess, p=q, tol=1e-6, max_nodes=20000)
        if not found.success:
            break
        guess, q = found.sol(x), found.p
        pressures.append(float(q[0]))
    return deflections[: len(pressures)] / thickness, np.array(pressures)


def largest(deflections: np.ndarray, pressures: np.ndarray) -> float:
    """The first maximum, of the polynomial through the five values around it."""
    k = int(np.argmax(np.diff(pressures) < 0))
    x, p = deflections[k - 2 : k + 3] - deflections[k], pressures[k - 2 : k + 3]
    return float(np.polyval(np.polyfit(x, p, 4), np.linspace(x[1], x[3], 1001)).max())


def exact(thickness: float) -> tuple[np.ndarray, np.ndarray]:
    """As :func:`reissner`, with finite rotations and a pressure that follows."""
    E, nu, p_c = MATERIAL.E, MATERIAL.nu, classical(thickness)
    C, G = E * thickness / (1 - nu**2), 5 / 6 * MATERIAL.G * thickness
    D = C * thickness**2 / 12
    s = np.linspace(1e-4, np.arcsin(RIM / RADIUS), 60) * RADIUS
    s[0] = 1e-4 * RIM

    def strains(s: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, ...]:
        """``r0``, strain, bending and shear along the meridian, stretch and bending around."""
        r, _, f, A, B, m = y
        r0, slope = RADIUS * np.sin(s / RADIUS), -s / RADIUS
        around, bent = r / r0 - 1, (np.sin(f) - np.sin(slope)) / r0
        along = (A * np.cos(f) + B * np.sin(f)) / (r0 * C) - nu * around
        shear = (B * np.cos(f) - A * np.sin(f)) / (r0 * G)
        return r0, along, m / (r0 * D) - nu * bent, shear, around, bent

    def rates(s: np.ndarray, y: np.ndarray, q: np.ndarray) -> np.ndarray:
        r, f = y[0], y[2]
        r0, e, k, g, around, bent = strains(s, y)
        dr = (1 + e) * np.cos(f) - g * np.sin(f)
        dz = (1 + e) * np.sin(f) + g * np.cos(f)
        N, N_t = C * (e + nu * around), C * (around + nu * e)
        dm = D * (bent + nu * k) * np.cos(f) - r0 * ((1 + e) * G * g - g * N)
        p = q[0] * p_c
        return np.array([dr, dz, k - 1 / RADIUS, N_t - p * r * dz, p * r * dr, dm])

    def ends(w: float) -> Callable[..., np.ndarray]:
        def conditions(a: np.ndarray, b: np.ndarray, q: np.ndarray) -> np.ndarray:
            r0, e, k, _, around, bent = strains(s[0], a)
            top = [e - around, k - bent, a[4] / C - q[0] * p_c * r0**2 / (2 * C), a[1] - RISE + w]
            return np.array([*top, b[0] - RIM, b[1], b[2] + s[-1] / RADIUS])

        return conditions

    r, z = RADIUS * np.sin(s / RADIUS), RADIUS * (np.cos(s / RADIUS) - 1) + RISE
    guess = np.vstack([r, z, -s / RADIUS, np.zeros((3, len(s)))])
    return pressures_at(s, guess, rates, ends, thickness)
