"""The elastic catenary, a parabola between its ends, and frequencies of a cable that hangs."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.optimize import brentq, fsolve
from scipy.special import j0, jn, y0, yn

LENGTH, SPAN, RISE, WEIGHT, STRETCH = 10.0, 8.0, 1.0, 10.0, 1e4
GRAVITY = 10.0  # a mass of one per length


def catenary(stiffness: float = STRETCH) -> tuple[Any, float, float]:
    """Places (k, 2) as a function of arc lengths, and both parts of the force at the start."""

    def positions(s: Any, H: float, V: float) -> np.ndarray:
        down = V - WEIGHT * s
        x = H / WEIGHT * (np.arcsinh(V / H) - np.arcsinh(down / H)) + H * s / stiffness
        z = (np.hypot(H, down) - np.hypot(H, V)) / WEIGHT
        return np.stack([x, z + (0.5 * WEIGHT * s**2 - V * s) / stiffness], axis=-1)

    end = np.array([SPAN, RISE])
    H, V = fsolve(lambda f: positions(LENGTH, *f) - end, (34.0, 44.0), xtol=1e-13)
    return (lambda s: positions(s, H, V)), float(H), float(V)


def parabola(longer: float) -> Any:
    """Between the ends, so many times as long as the cable; a function of s from 0 to 1."""

    def position(depth: float, s: Any) -> np.ndarray:
        return np.stack([SPAN * s, RISE * s - 4 * depth * s * (1 - s), 0 * s], axis=-1)

    s = np.linspace(0, 1, 10001)

    def gap(depth: float) -> float:
        return float(
            np.linalg.norm(np.diff(position(depth, s), axis=0), axis=1).sum() - longer * LENGTH
        )

    depth = brentq(gap, 0.1, LENGTH)
    return lambda s: position(depth, np.asarray(s))


def sag() -> float:
    """Largest depth of the catenary below its chord."""
    x, z = catenary()[0](np.linspace(0, LENGTH, 2001)).T
    return float((RISE / SPAN * x - z).max())


def exact_frequencies() -> np.ndarray:
    """The first three, rad per time, across the cable with its mass."""
    end, top = 0.1 * LENGTH / GRAVITY, 1.1 * LENGTH / GRAVITY

    def rest(omega: float) -> float:
        p, q = 2 * omega * np.sqrt([end, top])
        return float(yn(2, p) * j0(q) - jn(2, p) * y0(q))

    grid = np.linspace(0.1, 10.0, 500)
    signs = np.sign([rest(omega) for omega in grid])
    return np.array([brentq(rest, *grid[k : k + 2]) for k in np.flatnonzero(np.diff(signs))[:3]])
