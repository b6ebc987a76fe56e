"""Warning of velocities that violate the velocity constraints, which index 3 does not impose.

Their error alternates from step to step in long chains of bodies, and grows where the damping of
fast oscillations is too weak, until steps fail. Sub-steps start with admissible velocities and do
not remove the cause.
"""

from __future__ import annotations

import logging

import numpy as np

from fem_lie._arrays import Array
from fem_lie.solve.alpha.options import DAMPED

_log = logging.getLogger(__name__)

_LARGE = 0.1
"""Violation that is large, relative to the velocities."""


class ViolationWarning:
    """Logs a warning once per run."""

    def __init__(self, scaling: Array, radius: float) -> None:
        """Warn of the velocities of one run.

        Args:
            scaling: Norm weights of both halves of the velocity of each node, shape (n, 2).
            radius: Spectral radius of the scheme.
        """
        self._weights, self._radius = np.repeat(scaling, 3, axis=1), radius
        self._issued = False

    def check(self, time: float, computed: Array, admissible: Array) -> None:
        """Log a warning if it is the first one, and the velocities are far from admissible ones.

        Args:
            time: Time of both.
            computed: Velocities at the end of a step, shape (n, 6).
            admissible: The velocities closest to them that satisfy the constraints, shape (n, 6).
        """
        off = float(np.linalg.norm(self._weights * (computed - admissible)))
        size = float(np.linalg.norm(self._weights * admissible))
        if self._issued or not off > _LARGE * size > 0.0:
            return
        self._issued = True
        remedy = "index=fl.schemes.ConstraintIndex.STABILISED_TWO"
        if self._radius > DAMPED:
            remedy = f"radius={DAMPED:g} or {remedy}"
        _log.warning(
            "at time %g a step failed, and the velocities before it violate the velocity "
            "constraints of the joints by %.2g times their norm, which index 3 does not prevent: "
            "use %s",
            *(time, off / size, remedy),
        )
