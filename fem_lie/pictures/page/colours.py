"""Values at the nodes of bodies, to be seen as colours."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from fem_lie._arrays import Array, Indices

_SIGNED, _PLAIN = "RdBu_r", "viridis"
_ONE_SIGN = 0.02  # of the largest; less of the other sign is none
_STEPS = 255


@dataclass(frozen=True, eq=False)
class NodalColours:
    """A quantity of one body in all states of a result.

    Attributes:
        body: Name of the body in the scene.
        values: At its nodes, shape (k, n); nan where there is none.
        label: What it is, and its unit. What is drawn together has one label.
    """

    body: str
    values: Array
    label: str

    def rows(self, rows: Indices, states: int) -> NodalColours:
        """Those of some of the states.

        Args:
            rows: Numbers of the states that are drawn.
            states: Number of all states.

        Raises:
            ValueError: There are values of another number of states.
        """
        if len(self.values) != states:
            raise ValueError(
                f"colours of {self.body} are of {len(self.values)} states, the result has {states}"
            )
        return replace(self, values=self.values[rows])


def at_nodes(values: Array, nodes: Indices, count: int) -> Array:
    """Means at ``count`` nodes of values (k, v) that belong to nodes (v,); nan where none does."""
    uses = np.bincount(nodes, minlength=count)
    total = np.array([np.bincount(nodes, row, count) for row in values])
    return np.where(uses > 0, total / np.maximum(uses, 1), np.nan)


@dataclass(frozen=True)
class Scale:
    """Which colour is which value.

    Attributes:
        label: What the values are.
        low: Value of the first colour.
        high: Value of the last.
        names: Colours from low to high, as browsers call them.
    """

    label: str
    low: float
    high: float
    names: tuple[str, ...]

    @classmethod
    def of(cls, colours: Sequence[NodalColours]) -> Scale:
        """One scale for all.

        Raises:
            ValueError: They have several labels.
        """
        from matplotlib import colormaps
        from matplotlib.colors import to_hex

        labels = list(dict.fromkeys(one.label for one in colours))
        if len(labels) > 1:
            raise ValueError(f"one page shows one quantity in colours, got {', '.join(labels)}")
        low = min(float(np.nanmin(one.values)) for one in colours)
        high = max(float(np.nanmax(one.values)) for one in colours)
        signed = min(-low, high) > _ONE_SIGN * max(-low, high)
        if signed:
            high = max(-low, high)
            low = -high
        shades = colormaps[_SIGNED if signed else _PLAIN](np.linspace(0.0, 1.0, _STEPS + 1))
        return cls(labels[0], low, high, tuple(to_hex(shade) for shade in shades))

    def steps(self, values: Array) -> Indices:
        """Numbers of the colours of values; where there is none, that of the lowest."""
        part = (values - self.low) / ((self.high - self.low) or 1.0)
        return np.rint(_STEPS * np.nan_to_num(np.clip(part, 0.0, 1.0))).astype(np.int64)
