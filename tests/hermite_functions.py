"""Bicubic Hermite functions of a cell, by polynomials of their own."""

import numpy as np

CUBICS = [
    np.polynomial.Polynomial(c)
    for c in ([1, 0, -3, 2], [0, 1, -2, 1], [0, 0, 3, -2], [0, 0, -1, 1])
]
"""Value and slope at the first end, then at the second."""


def bicubic(at, along: int = 0, across: int = 0) -> np.ndarray:
    """Sixteen functions, or derivatives of them, at points (g, 2) of the unit square, (g, 16).

    Corner by corner, with ξ first; at each of them value, ξ, η, ξη.
    """
    ξ, η = np.asarray(at, dtype=float).T
    first = np.array([c.deriv(along)(ξ) for c in CUBICS])
    second = np.array([c.deriv(across)(η) for c in CUBICS])
    return np.array(
        [
            first[2 * i + j] * second[2 * k + m]
            for k in (0, 1)
            for i in (0, 1)
            for m in (0, 1)
            for j in (0, 1)
        ]
    ).T


def gauss_points(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Points (count², 2) and weights of the Gauss rule on the unit square."""
    x, w = np.polynomial.legendre.leggauss(count)
    first, second = np.meshgrid(0.5 * (1 + x), 0.5 * (1 + x), indexing="ij")
    return np.stack([first.ravel(), second.ravel()], axis=1), 0.25 * np.outer(w, w).ravel()
