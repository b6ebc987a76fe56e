"""The woodpecker toy of Leine, Glocker & van Campen by Moreau's time-stepping of first order.

Coordinates are the height of the sleeve, its tilt and that of the bird; mass matrix, stiffness and
directions of contact forces are constant. Impulses of a step satisfy Coulomb's law and Newton's law
of impact to round-off, by projections onto the set of one contact after the other.
"""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np


@dataclass(frozen=True)
class Toy:
    """Published parameters in SI units, and the published state of the limit cycle."""

    m_M: float = 3e-4
    J_M: float = 5e-9
    m_S: float = 4.5e-3
    J_S: float = 7e-7
    c: float = 5.6e-3
    r_0: float = 2.5e-3
    r_M: float = 3.1e-3
    h_M: float = 5.8e-3
    l_M: float = 0.010
    l_G: float = 0.015
    h_S: float = 0.02
    l_S: float = 0.0201
    friction: float = 0.3

    @property
    def start(self) -> np.ndarray:
        """Coordinates and rates; the lower edge of the sleeve touches (published: -0.1036)."""
        return np.array([0.0, (self.r_0 - self.r_M) / self.h_M, -0.2788, -0.3411, 0.0, -7.4583])

    def moreau(self, duration: float, step: float) -> np.ndarray:
        """Time, angle of the bird, speed of the sleeve, rate of the bird, shape (n, 4)."""
        out = self.steps(duration, step, self.start)
        return np.stack([step * np.arange(len(out)), out[:, 2], out[:, 3], out[:, 5]], axis=1)

    def steps(self, duration: float, step: float, start: np.ndarray) -> np.ndarray:
        """Coordinates and rates at all steps, shape (n, 6), from ``start`` (6,)."""
        m, M, G, K = self.m_S, self.l_M, self.l_G, self.c
        mass = np.array([(self.m_M + m, m * M, m * G), (0, 0, 0), (0, 0, 0)])
        mass[1] = m * M, self.J_M + m * M**2, m * M * G
        mass[2] = m * G, m * M * G, self.J_S + m * G**2
        stiffness = np.array([(0, 0, 0), (0, K, -K), (0, -K, K)])
        weight = -9.81 * np.array([self.m_M + m, m * M, m * G])
        normal = np.array([(0, 0, -self.h_S), (0, self.h_M, 0), (0, -self.h_M, 0)])
        tangent = np.array([(1, M, G - self.l_S), (1, self.r_M, 0), (1, self.r_M, 0)])
        play = self.r_M - self.r_0
        gaps = np.array([M + G - self.l_S - self.r_0, play, play])
        out = np.empty((round(duration / step) + 1, 6))
        out[0] = start
        law = self.friction, np.array([0.5, 0.0, 0.0])
        ways = normal.astype(float), tangent.astype(float)
        _steps(out, step, np.linalg.inv(mass), stiffness.astype(float), weight, ways, gaps, law)
        return out


@numba.njit
def _steps(out, h, flexibility, stiffness, weight, ways, gaps, law):  # type: ignore[no-untyped-def]
    friction, restitution = law
    normal, tangent = ways
    for step in range(len(out) - 1):
        q, u = out[step, :3] + 0.5 * h * out[step, 3:], out[step, 3:]
        v = u + h * flexibility @ (weight - stiffness @ q)
        closed = gaps + normal @ q <= 0.0
        impulses = np.zeros((2, 3))
        for _ in range(500 if closed.any() else 0):
            change = 0.0
            for k in range(3):
                if closed[k]:
                    for part in range(2):
                        w = tangent[k] if part else normal[k]
                        rate = w @ v
                        if part == 0:
                            rate += restitution[k] * (w @ u)
                        new = impulses[part, k] - rate / (w @ flexibility @ w)
                        bound = friction * impulses[0, k]
                        new = max(new, 0.0) if part == 0 else min(max(new, -bound), bound)
                        v += flexibility @ w * (new - impulses[part, k])
                        change = max(change, abs(new - impulses[part, k]))
                        impulses[part, k] = new
            if change < 1e-16:
                break
        out[step + 1, :3], out[step + 1, 3:] = q + 0.5 * h * v, v


def passages(states: np.ndarray, angle: float = -0.2788) -> np.ndarray:
    """Time, speed and rate where the bird passes an angle downwards, (k, 3), from (t, angle, …)."""
    found = states[:, 1]
    k = np.flatnonzero((found[:-1] > angle) & (found[1:] <= angle))
    part = ((angle - found[k]) / (found[k + 1] - found[k]))[:, np.newaxis]
    both = (1 - part) * states[k] + part * states[k + 1]
    return np.asarray(both[:, [0, 2, 3]])


def limit(passages: np.ndarray) -> list[float]:
    """Speed and rate to which passages tend, whose errors are multiplied by one number each."""
    first, second = np.diff(passages[-3:, 1:], axis=0)
    return (passages[-3, 1:] + first**2 / (first - second)).tolist()
