"""Collapse of an elastic ring under pressure, with opposite sides in contact.

With lengths in radii and the pressure p in EI/R³, of a quarter from the point of contact (0, z) to
the side (x, 0), θ the angle of the tangent and N the force with which opposite sides push::

    θ'' = −cos θ (p x − N/2) − sin θ p z,   x' = cos θ,   z' = sin θ

They are apart up to p = 5.247 (of a ring without thickness), touch at a point up to 10.34 and along
a flat part beyond: J. E. Flaherty, J. B. Keller, S. I. Rubinow, SIAM J. Appl. Math. 23 (1972) 446.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_bvp

QUARTER = 0.5 * np.pi


class Collapsed(NamedTuple):
    """A state: half the height in the middle, half the width, force N, half of the flat part."""

    height: float
    width: float
    force: float
    flat: float


def _solved(p: float, z: float, unknown: int, guess: tuple) -> tuple:
    """Grid, functions and unknown N and flat part, of which none, one or both are sought."""

    def rates(s: np.ndarray, y: np.ndarray, more: np.ndarray) -> np.ndarray:
        force, flat = (*more, 0.0, 0.0)[:2]
        θ, κ, x, h = y
        bent = -np.cos(θ) * (p * x - 0.5 * force) - np.sin(θ) * p * h
        return (QUARTER - flat) * np.array([κ, bent, np.cos(θ), np.sin(θ)])

    def ends(a: np.ndarray, b: np.ndarray, more: np.ndarray) -> np.ndarray:
        flat = more[1] if unknown == 2 else 0.0
        wanted = [a[0], a[2] - flat, b[0] + QUARTER, b[3], a[3] - z, a[1]]
        return np.array(wanted[: 4 + unknown])

    s, y, more = guess
    start = np.append(more, [0.1, 0.01])[:unknown]
    if unknown:
        found = solve_bvp(rates, ends, s, y, p=start, tol=1e-7, max_nodes=20000)
        return found.x, found.y, found.p
    none = np.empty(0)
    found = solve_bvp(lambda s, y: rates(s, y, none), lambda a, b: ends(a, b, none), s, y, tol=1e-7)
    return found.x, found.y, none


def collapse(pressures: np.ndarray, distance: float) -> list[Collapsed]:
    """States at increasing pressures above 3, with middle lines that come so near each other."""
    s = np.linspace(0.0, 1.0, 101)
    a = QUARTER * s
    y = np.array([-a + 0.3 * np.sin(2 * a), 0.6 * np.cos(2 * a) - 1, np.sin(a), np.cos(a)])
    state, unknown, states = (s, y, np.empty(0)), 0, {}
    for p in np.union1d(np.arange(3.05, max(pressures), 0.1), pressures):
        state = _solved(p, 0.5 * distance, unknown, state)
        apart, bent = 2.0 * state[1][3, 0] - distance, state[1][1, 0]
        if (unknown == 0 and apart < 0.0) or (unknown == 1 and bent < 0.0):
            unknown += 1
            state = _solved(p, 0.5 * distance, unknown, state)
        force, flat = (*state[2], 0.0, 0.0)[:2]
        states[p] = Collapsed(float(state[1][3, 0]), float(state[1][2, -1]), force, flat)
    return [states[p] for p in pressures]
