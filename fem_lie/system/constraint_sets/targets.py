"""What constraints are to be, as a function of time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array, Indices, at_time
from fem_lie.joints import Connection
from fem_lie.joints.histories import declared, until_next

_FORWARD = np.array(
    [
        [-137 / 60, 5, -5, 10 / 3, -5 / 4, 1 / 5],
        [15 / 4, -77 / 6, 107 / 6, -13, 61 / 12, -5 / 6],
    ]
)
"""First and second derivative of a polynomial of fifth degree from values at 0, 1, … 5."""


class Targets:
    """Of all constraints: those of drives change, those of gears and links stay.

    Attributes:
        driven: Whether any depends on time.
    """

    def __init__(self, items: Sequence[Connection], owner: Indices, base: Array) -> None:
        """Collect the drives; of an item with a history the last constraint is driven.

        Args:
            items: All of them.
            owner: Of each constraint, shape (m,).
            base: Those that stay, shape (m,).
        """
        self._items, self._owner, self._base = items, owner, base
        self._drives = [
            (int(np.flatnonzero(owner == k)[-1]), item.history)
            for k, item in enumerate(items)
            if item.history is not None
        ]
        self._breaks = declared((history for _, history in self._drives), kinks=True)
        self.driven = bool(self._drives)

    def at(self, time: float) -> Array:
        """What the constraints are to be at ``time``, shape (m,).

        Raises:
            ValueError: A drive is not finite then.
        """
        values = self._base.copy()
        for row, history in self._drives:
            label = self._items[self._owner[row]].label
            values[row] = at_time(history, time, label)
            if not np.isfinite(values[row]):
                raise ValueError(f"{label} is {values[row]} at time {time:g}")
        return values

    def rates(self, time: float, step: float) -> tuple[Array, Array]:
        """First and second rates of the targets, (m,), at ``time``, by five later times.

        These lie before the next jump, and so may be nearer than ``step``.
        """
        step = min(step, until_next(self._breaks, time) / 5.0)
        values = [self.at(time + k * step) for k in range(6)]
        first, second = np.tensordot(_FORWARD, values, axes=1)
        return first / step, second / step**2
