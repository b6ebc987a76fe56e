"""Linear theory of a load on a heavy cable under a trolley, with a force that is set at samples."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial
from scipy.integrate import cumulative_simpson
from scipy.linalg import expm

TERMS, SMOOTH = 6, 12
"""Terms of the series of a motion that is planned; its smoothness at both ends."""


@dataclass(frozen=True)
class Crane:
    """Masses of trolley and load, mass of the cable per length, its length, and gravity."""

    trolley: float
    load: float
    line: float
    length: float
    gravity: float = 9.81

    def weights(self) -> tuple[np.ndarray, np.ndarray]:
        """Factors of ``y^(2k)`` in the position of the trolley, of ``y^(2k + 2)`` in the force."""
        z = np.linspace(0.0, self.length, 2001)
        c, position, force = np.ones_like(z), [], []
        for _ in range(TERMS):
            momentum = self.load * c[0] + self.line * cumulative_simpson(c, x=z, initial=0.0)
            position.append(c[-1])
            force.append(self.trolley * c[-1] + momentum[-1])
            tension = self.gravity * (self.load + self.line * z)
            c = cumulative_simpson(momentum / tension, x=z, initial=0.0)
        return np.array(position), np.array(force)

    def motion(
        self,
        pull: float,
        control: Callable[[float, np.ndarray], float],
        period: float,
        samples: int,
        elements: int = 400,
    ) -> np.ndarray:
        """Position of the load at the samples, exact in time.

        Args:
            pull: Horizontal force that holds the load aside until the start.
            control: Force on the trolley for time, and (position and rate of the trolley, sway).
            period: Time between samples.
            samples: Their number.
            elements: Number of linear elements of the cable.
        """
        h, n = self.length / elements, elements + 1
        M, K = np.zeros((n, n)), np.zeros((n, n))
        M[0, 0], M[-1, -1] = self.trolley, self.load
        for k in range(elements):
            own, below = slice(k, k + 2), self.line * (self.length - (k + 0.5) * h)
            M[own, own] += self.line * h / 6 * np.array([[2.0, 1.0], [1.0, 2.0]])
            tension = self.gravity * (self.load + below)
            K[own, own] += tension / h * np.array([[1.0, -1.0], [-1.0, 1.0]])
        A = np.zeros((2 * n + 1, 2 * n + 1))
        A[:n, n:-1], A[n:-1, :n] = np.eye(n), -np.linalg.solve(M, K)
        A[n:-1, -1] = np.linalg.solve(M, np.eye(n)[0])
        over, state, found = expm(period * A), np.zeros(2 * n + 1), []
        state[1:n] = np.linalg.solve(K[1:, 1:], pull * np.eye(n)[-1, 1:])
        for k in range(samples):
            found.append(state[n - 1])
            measured = np.array([state[0], state[n], state[n - 1] - state[0]])
            state[-1] = control(k * period, measured)
            state = over @ state
        return np.array(found)


class Control:
    """Force on the trolley as a function of time and what is measured."""

    def __init__(self, crane: Crane, way: float, time: float, gains: Sequence[float]) -> None:
        """Plan a smooth motion of the load over ``way`` in ``time``, with all derivatives needed.

        Args:
            crane: The crane.
            way: Displacement of the load.
            time: Its duration.
            gains: Of position and rate of the trolley, and of the sway.
        """
        bump = Polynomial([0.0, 1.0]) ** SMOOTH * Polynomial([1.0, -1.0]) ** SMOOTH
        rise = bump.integ() / bump.integ()(1.0)
        self._way, self._time, self._gains = way, time, np.array(gains)
        self._y = [rise.deriv(k) for k in range(2 * TERMS + 1)]
        self._position, self._force = crane.weights()

    def __call__(self, time: float, measured: np.ndarray) -> float:
        """Force, for position and rate of the trolley, and sway of the load."""
        part = min(time / self._time, 1.0)
        y = np.array([each(part) * self._way / self._time**k for k, each in enumerate(self._y)])
        top, rate = self._position @ y[:-1:2], self._position @ y[1::2]
        return float(self._force @ y[2::2] + self._gains @ ([top, rate, y[0] - top] - measured))
