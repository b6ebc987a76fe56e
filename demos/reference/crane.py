"""Linear theory of a load on a heavy cable under a trolley, with a force that is set at samples."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.linalg import expm


def motion(
    masses: tuple[float, float, float],
    length: float,
    gravity: float,
    pull: float,
    control: Callable[[float, np.ndarray], float],
    period: float,
    samples: int,
    elements: int = 400,
) -> np.ndarray:
    """Position of the load at the samples, exact in time.

    Args:
        masses: Of the trolley, of the load, and of the cable per length.
        length: Of the cable.
        gravity: Acceleration.
        pull: Horizontal force that holds the load aside until the start.
        control: Force on the trolley for time, and (position and rate of the trolley, sway).
        period: Time between samples.
        samples: Their number.
        elements: Number of linear elements of the cable.
    """
    (trolley, load, line), h, n = masses, length / elements, elements + 1
    M, K = np.zeros((n, n)), np.zeros((n, n))
    M[0, 0], M[-1, -1] = trolley, load
    for k in range(elements):
        own, tension = slice(k, k + 2), gravity * (load + line * (length - (k + 0.5) * h))
        M[own, own] += line * h / 6 * np.array([[2.0, 1.0], [1.0, 2.0]])
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
