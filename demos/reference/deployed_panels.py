"""Two panels on springs and latches: equations of their angles, with the momenta by hand.

SciPy integrates them and finds the times of latching. A latch is a plastic impact: the moment of
momentum that belongs to the angle that stays free is conserved.
"""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

M, J, K = 5.0, 5.0 / 12.0, 0.5
REST, STOP = np.radians([108.0, 200.0]), np.radians([90.0, 180.0])
"""Mass and moment of inertia of a panel of 1 m, stiffness; relaxed and latched angles, rad."""


def inertia(angle: float) -> np.ndarray:
    """Mass matrix of both angles; it depends on the second one."""
    own, arm = M / 4 + J, -M / 2 * np.cos(angle)
    return np.array([[2 * own + M + 2 * arm, own + arm], [own + arm, own]])


def latched(angle: float, v: np.ndarray, free: np.ndarray) -> tuple[np.ndarray, float]:
    """Rates after a latching that leaves some angles free, by hand, and the energy that it takes.

    Args:
        angle: Second angle.
        v: Rates before, (2,).
        free: Which angles stay free, (2,).
    """
    matrix, after = inertia(angle), np.zeros(2)
    if free.any():
        after[free] = np.linalg.solve(matrix[np.ix_(free, free)], (matrix @ v)[free])
    return after, 0.5 * float(v @ matrix @ v - after @ matrix @ after)


def latchings() -> list[tuple[float, int, float]]:
    """Time, panel and lost energy of each latching."""
    free, found, time, state = np.array([True, True]), [], 0.0, np.zeros(4)

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        q, v, a = y[:2], y[2:], np.zeros(2)
        turning = M / 2 * np.sin(q[1]) * np.array([2 * v[0] * v[1] + v[1] ** 2, -(v[0] ** 2)])
        forces, matrix = -K * (q - REST) - turning, inertia(q[1])
        a[free] = np.linalg.solve(matrix[np.ix_(free, free)], forces[free])
        return np.concatenate([v, a])

    while free.any():
        latch = [lambda t, y, k=k: y[k] - STOP[k] for k in np.flatnonzero(free)]
        for each in latch:
            each.terminal = True
        end = solve_ivp(rate, (time, 99.0), state, "DOP853", events=latch, rtol=1e-12, atol=1e-13)
        k = int(np.flatnonzero(free)[int(np.argmax([len(t) for t in end.t_events]))])
        time, state = float(end.t[-1]), end.y[:, -1]
        free[k] = False
        state[2:], lost = latched(state[1], state[2:], free)
        found.append((time, k, lost))
    return found
