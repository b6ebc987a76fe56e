"""Constraints of any kind over a step: their values at its end, and their forces at its start."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie.solve.variational import momenta
from fem_lie.system.equations import Equations


class Binding:
    """Constraints that a table of pairs of frames does not have: on attachment frames and beams."""

    def __init__(self, equations: Equations) -> None:
        """No step has begun."""
        self._equations = equations
        self._ahead: Array = np.zeros(equations.unknowns.m)

    def begin(self, H: Array, start: float, h: float) -> None:
        """A step begins.

        Args:
            H: Rows of all nodes at its start, (N, 4, 3).
            start: When that is.
            h: Step size.
        """
        equations = self._equations
        self._start, self._jacobian = H.copy(), equations.constraints(H).jacobian
        if equations.unknowns.driven:
            middle, end = (equations.prescribed(start + part * h) for part in (0.5, 1.0))
            self._ahead = end.targets - middle.targets

    def constrain(self, end: Array, weights: Array, gap: Array, out: tuple[Array, Array]) -> None:
        """Increments of the constraints over the step, and their forces at its start.

        Args:
            end: Rows of all nodes at the end, (N, 4, 3).
            weights: Multipliers, (m,).
            gap: What constraints violate at the start, (m,).
            out: The increments, (m,), and forces in global components, (n, 6); overwritten.
        """
        change, forces = out
        change[:] = self._equations.constraints(end).values - self._ahead - gap
        local = (self._jacobian.T @ weights).reshape(-1, 6)
        momenta.to_space(self._equations.unknowns.kinds, self._start, local, forces)
