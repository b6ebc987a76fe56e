"""How far nodes turn in a step of a conserving scheme, and how much too slowly.

A node that turns at a constant rate ``ω`` is turned by the Cayley map of ``h ω`` in a step, by the
angle ``2 atan(h ω/2)`` instead of ``h ω``: ``(h ω)²/12`` of it is missing. Energy and momenta do
not show it, for they are those of ``ω``.
"""

from __future__ import annotations

import logging
from math import atan, degrees, radians

import numpy as np

from fem_lie._arrays import Array

_log = logging.getLogger(__name__)

_FAR = radians(10.0)
"""Rotation in a step from which on it is reported."""


class Turning:
    """The largest rotation in a step of a run."""

    def __init__(self) -> None:
        """Nothing has turned yet."""
        self._largest = 0.0

    def note(self, rotations: Array) -> None:
        """Take rotation vectors of nodes in a step, or ``h ω``, into account.

        Args:
            rotations: Shape (…, 3), rad.
        """
        squares = np.einsum("...i,...i->...", rotations, rotations)
        self._largest = max(self._largest, float(squares.max(initial=0.0)) ** 0.5)

    def report(self) -> None:
        """Log a warning if nodes turn far in a step."""
        if self._largest <= _FAR:
            return
        missing = 1.0 - 2.0 * atan(0.5 * self._largest) / self._largest
        _log.warning(
            "bodies turn by up to %.3g° in a step, and %.2g %% too slowly: take smaller steps, or "
            "GeneralisedAlpha, which turns them by exponential maps",
            *(degrees(self._largest), 100.0 * missing),
        )
