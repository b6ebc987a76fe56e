"""Resultants of shells as tensors of the surface: turned axes, principal values, layers' stress.

Eight components ``(N₁₁, N₂₂, N₁₂, M₁₁, M₂₂, M₁₂, Q₁, Q₂)`` in an orthonormal pair of axes: two
symmetric tensors and a vector.
"""

from __future__ import annotations

import numpy as np

from fem_lie._lines import Array


def turned(values: Array, cosine: Array, sine: Array) -> Array:
    """Components along ``e₁' = c e₁ + s e₂`` and ``e₂' = −s e₁ + c e₂``.

    Args:
        values: Shape (..., 8).
        cosine: ``c``, shape (...).
        sine: ``s``, shape (...).
    """
    c, s = cosine, sine
    Q1, Q2 = values[..., 6], values[..., 7]
    out = np.empty(np.broadcast_shapes(values.shape, (*np.shape(c), 8)))
    for start in (0, 3):
        T11, T22, T12 = np.moveaxis(values[..., start : start + 3], -1, 0)
        out[..., start] = c * c * T11 + s * s * T22 + 2 * c * s * T12
        out[..., start + 1] = s * s * T11 + c * c * T22 - 2 * c * s * T12
        out[..., start + 2] = c * s * (T22 - T11) + (c * c - s * s) * T12
    out[..., 6], out[..., 7] = c * Q1 + s * Q2, c * Q2 - s * Q1
    return out


def principal(tensor: Array) -> tuple[Array, Array, Array]:
    """Larger and smaller principal value, and the angle from e₁ to the axis of the larger.

    Args:
        tensor: ``(T₁₁, T₂₂, T₁₂)``, shape (..., 3).

    Returns:
        Three arrays of shape (...); the angle is in rad, −π/2 … π/2.
    """
    T11, T22, T12 = np.moveaxis(tensor, -1, 0)
    mean, half = 0.5 * (T11 + T22), 0.5 * (T11 - T22)
    radius = np.hypot(half, T12)
    return mean + radius, mean - radius, 0.5 * np.arctan2(T12, half)


def mises(stress: Array) -> Array:
    """Von Mises' stress of a plane stress ``(σ₁₁, σ₂₂, σ₁₂)``, shape (..., 3)."""
    a, b, c = np.moveaxis(stress, -1, 0)
    return np.asarray(np.sqrt(a * a - a * b + b * b + 3 * c * c))
