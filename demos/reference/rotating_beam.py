"""Frequencies of a beam that rotates, by Chebyshev collocation."""

from __future__ import annotations

import numpy as np


def flapping(speed: float, count: int, degree: int = 40) -> np.ndarray:
    """Flap frequencies for EI = rho A = L = 1 and W = speed, by Chebyshev collocation.

    L. N. Trefethen, *Spectral Methods in MATLAB* (2000), ch. 6 and 14.
    """
    x = np.cos(np.pi * np.arange(degree + 1) / degree)
    c = np.r_[2, np.ones(degree - 1), 2] * (-1.0) ** np.arange(degree + 1)
    gaps = x[:, np.newaxis] - x + np.eye(degree + 1)
    D = np.outer(c, 1 / c) / gaps
    D = 2 * (D - np.diag(D.sum(axis=1)))  # of s = (x + 1)/2; the tip comes first
    tension = 0.5 * speed**2 * (1 - (0.5 * (x + 1)) ** 2)
    A = np.linalg.matrix_power(D, 4) - D @ (tension[:, np.newaxis] * D)
    edges = np.array([0, 1, degree - 1, degree])
    inner = np.arange(2, degree - 1)
    ends = np.array([np.eye(degree + 1)[-1], D[-1], (D @ D)[0], (D @ D @ D)[0]])
    follow = -np.linalg.solve(ends[:, edges], ends[:, inner])
    squares = np.linalg.eigvals(A[np.ix_(inner, inner)] + A[np.ix_(inner, edges)] @ follow)
    real = squares.real[np.abs(squares.imag) < 1e-6 * np.abs(squares)]
    return np.asarray(np.sqrt(np.sort(real)[:count]))
