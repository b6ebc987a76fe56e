"""Nodal values of bodies, and the colour scale."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from fem_lie._arrays import Array, Indices

_SIGNED, _PLAIN = "RdBu_r", "viridis"
_ONE_SIGN = 0.02  # fraction of the largest value below which values of the other sign are ignored
_STEPS = 255


@dataclass(frozen=True, eq=False)
class NodalColours:
    """A nodal quantity of one body in all states of a result, for colours of a page.

    Attributes:
        body: Name of the body in the scene.
        values: Values at its nodes, shape (k, n); nan if undefined.
        label: Name of the quantity, and its unit. Quantities on the same page have the same label.
    """

    body: str
    values: Array
    label: str

    def rows(self, rows: Indices, states: int) -> NodalColours:
        """Values in some of the states.

        Args:
            rows: Numbers of the states that are drawn.
            states: Number of all states.

        Raises:
            ValueError: The number of states does not agree.
        """
        if len(self.values) != states:
            raise ValueError(
                f"colours of {self.body} are of {len(self.values)} states, the result has {states}"
            )
        return replace(self, values=self.values[rows])


def at_nodes(values: Array, nodes: Indices, count: int) -> Array:
    """Means at ``count`` nodes of values (k, v) at nodes (v,); nan at nodes without a value."""
    uses = np.bincount(nodes, minlength=count)
    total = np.array([np.bincount(nodes, row, count) for row in values])
    return np.where(uses > 0, total / np.maximum(uses, 1), np.nan)


@dataclass(frozen=True)
class Scale:
    """Colour scale.

    Attributes:
        label: Name of the quantity, and its unit.
        low: Value of the first colour.
        high: Value of the last colour.
        names: Colours from low to high, as CSS colours.
    """

    label: str
    low: float
    high: float
    names: tuple[str, ...]

    @classmethod
    def of(cls, colours: Sequence[NodalColours]) -> Scale:
        """A common scale for all quantities.

        Raises:
            ValueError: The quantities have several labels.
        """
        from matplotlib import colormaps
        from matplotlib.colors import to_hex

        labels = list(dict.fromkeys(one.label for one in colours))
        if len(labels) > 1:
            raise ValueError(
                f"expected one quantity for the colours of a page, got {', '.join(labels)}"
            )
        low = min(float(np.nanmin(one.values)) for one in colours)
        high = max(float(np.nanmax(one.values)) for one in colours)
        signed = min(-low, high) > _ONE_SIGN * max(-low, high)
        if signed:
            high = max(-low, high)
            low = -high
        shades = colormaps[_SIGNED if signed else _PLAIN](np.linspace(0.0, 1.0, _STEPS + 1))
        return cls(labels[0], low, high, tuple(to_hex(shade) for shade in shades))

    def steps(self, values: Array) -> Indices:
        """Indices of the colours of values; undefined values have the lowest colour."""
        part = (values - self.low) / ((self.high - self.low) or 1.0)
        return np.rint(_STEPS * np.nan_to_num(np.clip(part, 0.0, 1.0))).astype(np.int64)
