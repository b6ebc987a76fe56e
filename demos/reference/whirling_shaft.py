"""Whirl of a circular shaft with a disc in the fixed frame, by the transfer matrix method."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy.linalg
from scipy.optimize import brentq


@dataclass(frozen=True)
class Shaft:
    """Euler-Bernoulli shaft of length 1 with a disc, for motions ``y + i z = w exp(i k t)``.

    Attributes:
        EI: Bending stiffness.
        line: Mass per length.
        rotary: Moment of inertia of the section per length about a diameter.
        disc: Mass of the disc, moments of inertia about its axis and about a diameter.
        overhung: Whether the start is clamped and the disc at the free end; otherwise both ends are
            pinned and the disc is in the middle.
        friction: Force per length and velocity in space, over the mass per length.
    """

    EI: float
    line: float
    rotary: float
    disc: tuple[float, float, float]
    overhung: bool
    friction: float = 0.0

    def _transfer(self, k: complex, spin: float) -> np.ndarray:
        """Transfer of (w, w', M/EI, V/EI) from the start to the end."""
        A, station = np.zeros((4, 4), dtype=complex), np.eye(4, dtype=complex)
        A[0, 1], A[1, 2], A[2, 3] = 1.0, 1.0, -1.0
        A[2, 1] = -self.rotary * k * (k - 2.0 * spin) / self.EI
        A[3, 0] = -self.line * k * (k - 1j * self.friction) / self.EI
        mass, polar, across = self.disc
        station[2, 1] = -k * (across * k - polar * spin) / self.EI
        station[3, 0] = -mass * k**2 / self.EI
        if self.overhung:
            return np.asarray(station @ scipy.linalg.expm(A))
        half = scipy.linalg.expm(0.5 * A)
        return np.asarray(half @ station @ half)

    def _determinant(self, k: float, spin: float) -> float:
        """Zero at whirl frequencies, without friction."""
        zero, unknown = ([2, 3], [2, 3]) if self.overhung else ([0, 2], [1, 3])
        return float(np.linalg.det(self._transfer(k, spin)[np.ix_(zero, unknown)]).real)

    def whirl(self, speeds: npt.ArrayLike, count: int, sense: int) -> np.ndarray:
        """Slowest whirl frequencies in one sense, +1 or -1, shape (speeds, count)."""
        found = [
            roots(lambda k, spin=spin: self._determinant(sense * k, spin), count)
            for spin in np.asarray(speeds)
        ]
        return sense * np.array(found)

    def critical_speed(self) -> float:
        """Slowest speed of synchronous forward whirl."""
        return float(roots(lambda k: self._determinant(k, k), 1)[0])

    def unbalanced(self, spin: float, moment: float) -> complex:
        """Deflection at the free end of an overhung shaft with an unbalance there."""
        T = self._transfer(spin, spin)
        start = np.linalg.solve(T[2:, 2:], [0.0, moment * spin**2 / self.EI])
        return complex(T[0, 2:] @ start)


def massless(
    EI: float, disc: tuple[float, float, float], spin: float, overhung: bool
) -> np.ndarray:
    """Whirl frequencies of a disc on a shaft of length 1 without mass, ascending."""
    mass, polar, across = disc
    shift, tilt, both = (12.0, 4.0, -6.0) if overhung else (48.0, 12.0, 0.0)
    moving = np.polynomial.Polynomial([shift * EI, 0.0, -mass])
    turning = np.polynomial.Polynomial([tilt * EI, polar * spin, -across])
    return np.asarray(np.sort((moving * turning - (both * EI) ** 2).roots().real))


def roots(function: Callable[[float], float], count: int) -> np.ndarray:
    """Positive zeros, by a search with steps that grow."""
    found: list[float] = []
    x, value = 1e-3, function(1e-3)
    while len(found) < count:
        ahead = 1.01 * x + 1e-3
        following = function(ahead)
        if value * following < 0.0:
            found.append(float(brentq(function, x, ahead, xtol=1e-14 * ahead, rtol=1e-14)))
        x, value = ahead, following
    return np.array(found)
