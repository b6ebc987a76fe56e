"""Tables of the blade of demos/turbine_blade.py, as functions of arc length."""

from __future__ import annotations

import numpy as np
from reference.spinning_blade import Blade
from reference.tables import table
from scipy.interpolate import CubicSpline, interp1d

ORDER = [2, 0, 1, 5, 3, 4]
"""Axes e1, e2, e3 of fem_lie are z, x, y of BeamDyn."""
X, Z, TWIST = table("blade_axis").T
AXIS, ANGLE = CubicSpline(Z, X), CubicSpline(Z, -np.radians(TWIST))
DENSE = np.linspace(0.0, Z[-1], 20_001)
ARC = CubicSpline(DENSE, np.sqrt(1.0 + AXIS(DENSE, 1) ** 2)).antiderivative()
HEIGHT, LENGTH = CubicSpline(ARC(DENSE), DENSE), float(ARC(Z[-1]))
STATIONS = table("blade_sections")


def stiffness() -> np.ndarray:
    """At the stations, (11, 6, 6)."""
    found = np.zeros((len(STATIONS), 6, 6))
    rows, columns = np.triu_indices(6)
    found[:, rows, columns] = STATIONS[:, 1:22]
    found = found + np.swapaxes(np.triu(found, 1), 1, 2)
    return found[:, ORDER][:, :, ORDER]


def mass() -> np.ndarray:
    """Mass matrices of (x, d1, d2, d3) at the stations, (11, 4, 4)."""
    m, my, mx, yy, xx, xy = STATIONS[:, 22:].T
    found = np.zeros((len(m), 4, 4))
    found[:, 0, 0], found[:, 2, 2], found[:, 3, 3] = m, xx, yy
    for (i, j), value in {(0, 2): mx, (0, 3): -my, (2, 3): -xy}.items():
        found[:, i, j] = found[:, j, i] = value
    return found


K = interp1d(LENGTH * STATIONS[:, 0], stiffness(), axis=0, fill_value="extrapolate")
G = interp1d(LENGTH * STATIONS[:, 0], mass(), axis=0, fill_value="extrapolate")


def curvature(s: np.ndarray) -> np.ndarray:
    """Of the blade at rest in axes of its sections, (n, 3)."""
    z = HEIGHT(s)
    slope, φ = AXIS(z, 1), ANGLE(z)
    bend = AXIS(z, 2) / (1.0 + slope**2) ** 1.5
    return np.stack([ANGLE(z, 1) * HEIGHT(s, 1), bend * np.sin(φ), bend * np.cos(φ)], axis=1)


def inertia(s: np.ndarray) -> np.ndarray:
    """Mass matrices of twists (v, w) in axes of the sections, (n, 6, 6)."""
    found, g = np.zeros((len(s), 6, 6)), G(s)
    found[:, [0, 1, 2], [0, 1, 2]] = g[:, :1, 0]
    y, z, yy, zz, yz = g[:, 0, 2], g[:, 0, 3], g[:, 2, 2], g[:, 3, 3], g[:, 2, 3]
    for (i, j), value in {(0, 4): z, (0, 5): -y, (1, 3): -z, (2, 3): y, (4, 5): -yz}.items():
        found[:, i, j] = found[:, j, i] = value
    found[:, 3, 3], found[:, 4, 4], found[:, 5, 5] = yy + zz, zz, yy
    return found


def position(s: float) -> np.ndarray:
    """Of the axis, relative to the clamp, (3,)."""
    return np.array([AXIS(HEIGHT(s)), 0.0, HEIGHT(s)])


def twist(s: float) -> float:
    """Rotation of a section about the axis, rad."""
    return float(ANGLE(HEIGHT(s)))


def eigenvalues(root: np.ndarray, spin: np.ndarray, near: np.ndarray) -> np.ndarray:
    """Those next to frequencies (k,), for the frame (4, 3) of the clamped section, (k,)."""
    blade = Blade(LENGTH * STATIONS[:, 0], lambda s: np.linalg.inv(K(s)), inertia, curvature)
    x, axes = root[0], root[1:]
    steady = blade.steady(np.concatenate([axes @ np.cross(spin, x), axes @ spin]))
    return np.array([blade.eigenvalue(steady, 1j * each) for each in near])
