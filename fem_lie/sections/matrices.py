"""Checks of matrices of stiffness and inertia."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, numbers

_SYMMETRY = 1e-8  # tables of stiffness are given with at least as many digits


def _symmetric(value: Array, size: int, what: str) -> Array:
    matrix = numbers(value, what)
    if matrix.shape != (size, size) or not np.isfinite(matrix).all():
        raise ValueError(
            f"{what} must be a finite matrix of shape ({size}, {size}), got\n{value!r}"
        )
    scale = np.sqrt(np.abs(np.diag(matrix)))
    if (np.abs(matrix - matrix.T) > _SYMMETRY * np.outer(scale, scale)).any():
        raise ValueError(f"{what} must be symmetric, got\n{matrix}")
    return 0.5 * (matrix + matrix.T)


def _scaled_eigenvalues(matrix: Array) -> Array:
    """Eigenvalues after scaling the diagonal to one: entries differ in units."""
    scale = np.sqrt(np.where(np.diag(matrix) > 0, np.diag(matrix), 1.0))
    return np.asarray(np.linalg.eigvalsh(matrix / np.outer(scale, scale)), dtype=np.float64)


def definite(value: Array, size: int, what: str) -> Array:
    """A symmetric positive definite matrix, shape (size, size), that cannot be written to.

    Raises:
        ValueError: It has another shape, is not finite, not symmetric or not positive definite.
        TypeError: It is no array of numbers.
    """
    matrix = _symmetric(value, size, what)
    if not (np.diag(matrix) > 0).all() or not _scaled_eigenvalues(matrix)[0] > 1e-14:
        raise ValueError(f"{what} must be positive definite, got\n{matrix}")
    matrix.setflags(write=False)
    return matrix


def semidefinite(value: Array, size: int, what: str) -> Array:
    """A symmetric positive semidefinite matrix of inertia; errors as of :func:`definite`."""
    matrix = _symmetric(value, size, what)
    if (np.diag(matrix) < 0).any() or not _scaled_eigenvalues(matrix)[0] > -1e-12:
        raise ValueError(f"{what} must be positive semidefinite, got\n{matrix}")
    matrix.setflags(write=False)
    return matrix
