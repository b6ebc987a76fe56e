"""What :meth:`~fem_lie.Result.plot` draws: quantities by name, each with its components."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np

from fem_lie._arrays import shown
from fem_lie.pictures.diagrams import VectorSeries

if TYPE_CHECKING:
    from fem_lie._arrays import Array
    from fem_lie.pictures.stage import Units

Quantity = Literal["position", "displacement", "joint_force", "reaction"]
"""Name of the method of a result whose values are drawn."""

Curves: TypeAlias = "tuple[tuple[Array, str, str], list[VectorSeries]]"
"""Times or load factors, their name and unit; vectors over them."""


Series: TypeAlias = "Callable[[str, Array, Units, float], list[VectorSeries]]"
"""Diagrams of a label, the values of a quantity, units and the size of a scene."""

_ROUND_OFF = 1e-6  # part of the size of a scene, or of the moment of its forces, that is round-off


def label_of(item: object) -> str:
    """Label of a point, joint or support in diagrams."""
    return item if isinstance(item, str) else str(getattr(item, "label", f"node {item}"))


def _length(symbol: str) -> Series:
    def series(label: str, values: Array, units: Units, size: float) -> list[VectorSeries]:
        return [VectorSeries(f"{label} [{units.length}]", symbol, values, _ROUND_OFF * size)]

    return series


def _wrench(label: str, values: Array, units: Units, size: float) -> list[VectorSeries]:
    F, M = values[:, :3], values[:, 3:]
    force, moment = np.abs(F).max(), np.abs(M).max()
    return [
        VectorSeries(f"{label} [{units.force}]", "F", F, _ROUND_OFF * moment / size),
        VectorSeries(f"{label} [{units.force} {units.length}]", "M", M, _ROUND_OFF * force * size),
    ]


_SERIES: dict[str, Series] = {
    "position": _length(""),
    "displacement": _length("u"),
    "joint_force": _wrench,
    "reaction": _wrench,
}
_OPTIONS: dict[str, dict[str, str]] = {"joint_force": {"axes": "global"}}


def plotted(
    result: object, of: Sequence[Any], quantity: str, units: Units, size: float
) -> list[VectorSeries]:
    """Components in all states, forces along global axes.

    Args:
        result: A result, which has a method of the quantity's name.
        of: Points, joints or supports.
        quantity: Name of the quantity.
        units: Units, for labels.
        size: Size of the scene.

    Raises:
        ValueError: There is no such quantity, nothing it is to be drawn of, or no such point.
    """
    if quantity not in _SERIES:
        known = ", ".join(map(repr, _SERIES))
        raise ValueError(f"plot: quantity: expected one of {known}, got {shown(quantity)}")
    if not of:
        raise ValueError(
            f"plot: expected at least one point, joint or support whose {quantity} is to be drawn"
        )
    values, options = getattr(result, quantity), _OPTIONS.get(quantity, {})
    return [
        series
        for item in of
        for series in _SERIES[quantity](label_of(item), values(item, **options), units, size)
    ]
