"""What can be asked of a shell's resultants by name: components, principal values, stresses."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fem_lie._arrays import Array
from fem_lie.pictures.units import Units

COMPONENTS = ("N11", "N22", "N12", "M11", "M22", "M12", "Q1", "Q2")


@dataclass(frozen=True)
class Quantity:
    """A number made of the eight components.

    Attributes:
        name: How it is called.
        of: From components (..., 8) and thickness (...) to values (...).
        unit: Its unit in the user's units.
        turns: Whether it depends on the axes.
        layer: Whether it supposes a homogeneous layer.
    """

    name: str
    of: Callable[[Array, Array], Array]
    unit: Callable[[Units], str]
    turns: bool = False
    layer: bool = False


def _per_length(units: Units) -> str:
    return f"{units.force}/{units.length}"


def _moment_per_length(units: Units) -> str:
    return f"{units.force} {units.length}/{units.length}"


def _per_area(units: Units) -> str:
    return f"{units.force}/{units.length}²"


def _component(i: int) -> Quantity:
    unit = _moment_per_length if 3 <= i < 6 else _per_length
    return Quantity(COMPONENTS[i], lambda values, t: values[..., i], unit, turns=True)


def _principal(name: str, start: int, which: int) -> Quantity:
    def of(values: Array, thickness: Array) -> Array:
        return principal(values[..., start : start + 3])[which]

    return Quantity(name, of, _moment_per_length if start else _per_length)


def _outer(name: str, side: float) -> Quantity:
    def of(values: Array, thickness: Array) -> Array:
        t = thickness[..., np.newaxis]
        return mises(values[..., :3] / t + side * 6.0 * values[..., 3:6] / t**2)

    return Quantity(name, of, _per_area, layer=True)


_ALL = (
    *(_component(i) for i in range(8)),
    _principal("N max", 0, 0),
    _principal("N min", 0, 1),
    _principal("M max", 3, 0),
    _principal("M min", 3, 1),
    Quantity("Q", lambda values, t: np.hypot(values[..., 6], values[..., 7]), _per_length),
    _outer("mises top", 1.0),
    _outer("mises bottom", -1.0),
)
QUANTITIES = {each.name: each for each in _ALL}


def quantity(name: str) -> Quantity:
    """What is called so.

    Raises:
        ValueError: Nothing is; the message lists what there is.
    """
    if name not in QUANTITIES:
        raise ValueError(f"there is no resultant {name!r}; there are: {', '.join(QUANTITIES)}")
    return QUANTITIES[name]


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
