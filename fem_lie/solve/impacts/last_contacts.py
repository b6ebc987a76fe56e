"""What contacts by impacts did in the last step, as results show it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.contact.impact.observed import GAP, IMPULSE, PAIR, POSITION, SLIP, STICKS, TIME, WIDTH
from fem_lie.contact.impact.rows import show_places
from fem_lie.contact.impact.touching import Touching


class Last(NamedTuple):
    """What contacts did in the last step.

    Attributes:
        pairs: Which took part, shape (k,).
        axis: By which tangents were chosen.
        gaps: At the end.
        impulses: Along the normal and tangents, shape (k, 3).
        speeds: Along tangents at the end, shape (k, 2).
        sticks: Whether that is none.
    """

    pairs: Indices
    axis: Indices
    gaps: Array
    impulses: Array
    speeds: Array
    sticks: Flags

    @classmethod
    def nothing(cls) -> Last:
        """No contact took part."""
        none = np.zeros(0, dtype=np.int64)
        rows = np.zeros((0, 3)), np.zeros((0, 2))
        return cls(none, none, np.zeros(0), *rows, np.zeros(0, dtype=np.bool_))

    def shown(self, near: Touching, H: Array, time: float) -> Array:
        """What results have of them, as :meth:`.Touching.named`.

        Args:
            near: Of the run.
            H: Frames of all rows.
            time: End of the step.
        """
        pairs, axis, gaps, impulses, speeds, sticks = self
        at = np.empty((len(pairs), 4, 3))
        show_places(H, near.touch, pairs, axis, at)
        rows = np.empty((len(pairs), WIDTH))
        rows[:, TIME], rows[:, PAIR], rows[:, GAP], rows[:, STICKS] = time, pairs, gaps, sticks
        rows[:, POSITION:IMPULSE] = at[:, 0]
        rows[:, IMPULSE:SLIP] = np.einsum("km,kmx->kx", impulses, at[:, 1:])
        rows[:, SLIP:STICKS] = np.einsum("km,kmx->kx", speeds, at[:, 2:])
        return near.named(rows[impulses[:, 0] > 0.0])
