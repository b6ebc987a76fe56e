"""What :meth:`~fem_lie.Result.plot` draws: quantities by name, each with its components."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from fem_lie._arrays import shown
from fem_lie.pictures.diagrams import VectorSeries

if TYPE_CHECKING:
    from fem_lie._arrays import Array
    from fem_lie.pictures.stage import Units

Quantity = Literal["position", "displacement", "joint_force", "reaction"]
"""Name of the method of a result whose values are drawn."""

Curves: TypeAlias = "tuple[tuple[Array, str, str], list[VectorSeries]]"
"""Times or load factors, their name and unit; vectors over them."""


def label_of(item: object) -> str:
    """Label of a point, joint or support in diagrams."""
    return item if isinstance(item, str) else str(getattr(item, "label", f"node {item}"))


def _length(symbol: str) -> Callable[[str, Array, Units], list[VectorSeries]]:
    def series(label: str, values: Array, units: Units) -> list[VectorSeries]:
        return [VectorSeries(f"{label} [{units.length}]", symbol, values)]

    return series


def _wrench(label: str, values: Array, units: Units) -> list[VectorSeries]:
    return [
        VectorSeries(f"{label} [{units.force}]", "F", values[:, :3]),
        VectorSeries(f"{label} [{units.force} {units.length}]", "M", values[:, 3:]),
    ]


_SERIES: dict[str, Callable[[str, Array, Units], list[VectorSeries]]] = {
    "position": _length(""),
    "displacement": _length("u"),
    "joint_force": _wrench,
    "reaction": _wrench,
}
_OPTIONS: dict[str, dict[str, str]] = {"joint_force": {"axes": "global"}}


def plotted(result: object, of: Sequence[Any], quantity: str, units: Units) -> list[VectorSeries]:
    """Components in all states, forces along global axes.

    Args:
        result: A result, which has a method of the quantity's name.
        of: Points, joints or supports.
        quantity: Name of the quantity.
        units: Units, for labels.

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
        for series in _SERIES[quantity](label_of(item), values(item, **options), units)
    ]
