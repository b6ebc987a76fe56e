"""How far schemes without exponential maps rotate bodies in a step, and a warning where it matters.

A body that rotates at a constant rate ``ω`` should rotate by ``θ = h ω`` in a step. Neither energy
nor momenta show that it does not, because they are those of ``ω``.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from math import asin, atan, degrees, radians

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.lie.node_types import POSITION_GRADIENT

_log = logging.getLogger(__name__)

_FAR, _STRETCHED = radians(10.0), 1e-4
"""Rotation in a step, and strain of elastic bodies by it, above which a warning is logged."""


def by_rates(angle: float) -> float:
    """Rotation by the Cayley map of ``θ``, for a constant rate: ``2 atan(θ/2)``, too small."""
    return 2.0 * atan(0.5 * angle)


def by_momenta(angle: float) -> float:
    """Rotation by the Cayley map for a constant discrete momentum: ``asin θ``, too large.

    No step rotates by more than a quarter of a turn.
    """
    return asin(min(angle, 1.0))


class Rotations:
    """Largest rotation in a step of a run."""

    def __init__(self, made: Callable[[float], float]) -> None:
        """Start with no rotation.

        Args:
            made: Rotation that the scheme makes for a rotation ``h ω``, rad.
        """
        self._made, self._largest = made, 0.0

    def note(self, rotations: Array) -> None:
        """Take rotation vectors of nodes in a step, or ``h ω``, into account.

        Args:
            rotations: Rotation vectors, shape (…, 3), rad.
        """
        squares = np.einsum("...i,...i->...", rotations, rotations)
        self._largest = max(self._largest, float(squares.max(initial=0.0)) ** 0.5)

    def note_velocities(self, h: float, v: Array, node_types: Indices) -> None:
        """Take the rotation of frames in a step of size ``h`` into account.

        Args:
            h: Step size.
            v: Velocities of nodes, shape (n, 6).
            node_types: Their types, shape (n,).
        """
        self.note(h * v[node_types < POSITION_GRADIENT, 3:])

    def report(self) -> None:
        """Log a warning if nodes rotate far in a step."""
        if self._largest <= _FAR:
            return
        error = self._made(self._largest) / self._largest - 1.0
        _log.warning(
            "bodies turn by up to %.3g° in a step, and %.2g %% too %s: take smaller steps, or "
            "GeneralisedAlpha, which turns them by exponential maps",
            *(degrees(self._largest), 100.0 * abs(error), "slowly" if error < 0.0 else "fast"),
        )


class MeanPositions(Rotations):
    """Rotations in a scheme whose forces are those of mean positions over a step.

    An elastic body that turns by θ is shorter there by ``θ²/8``, and its stress stretches it by as
    much. Its vibrations of the angular frequency ω grow if ``h ω θ > 4``.
    """

    def __init__(self, made: Callable[[float], float], elastic: Flags) -> None:
        """Start with no rotation.

        Args:
            made: Rotation that the scheme makes for a rotation ``h ω``, rad.
            elastic: Mask of the nodes that cells connect with others, shape (n,).
        """
        super().__init__(made)
        self._elastic, self._turned, self._step = elastic, 0.0, 0.0

    def note_velocities(self, h: float, v: Array, node_types: Indices) -> None:
        """Take the rotation of frames in a step of size ``h`` into account.

        Args:
            h: Step size.
            v: Velocities of nodes, shape (n, 6).
            node_types: Their types, shape (n,).
        """
        super().note_velocities(h, v, node_types)
        rates = v[self._elastic & (node_types < POSITION_GRADIENT), 3:]
        self._turned = max(self._turned, h * float(np.linalg.norm(rates, axis=1).max(initial=0.0)))
        self._step = h

    def report(self) -> None:
        """Log a warning if nodes rotate far in a step, and one if that stretches bodies."""
        super().report()
        strain = self._turned**2 / 8.0
        if strain > _STRETCHED:
            _log.warning(
                "elastic bodies that turn by up to %.3g° in a step are stretched by up to %.2g of "
                "their length, for forces are those of mean positions over a step, and vibrations "
                "of more than %.3g rad per time grow: take smaller steps, or EnergyMomentum or "
                "GeneralisedAlpha",
                *(degrees(self._turned), strain, 4.0 / (self._step * self._turned)),
            )
