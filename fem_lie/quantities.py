"""What can be asked of a shell's resultants by name: components, principal values, stresses."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fem_lie._lines import Array
from fem_lie.plane_tensors import mises, principal
from fem_lie.plot import Units

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
