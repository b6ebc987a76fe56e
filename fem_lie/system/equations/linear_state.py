"""Stress and forces of linear theory, while the nodes stay where they are."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie.system.equations.memory import Memory
from fem_lie.system.instant import Forces
from fem_lie.system.system import System


class LinearState:
    """What increments of the nodes make of stress and forces, to first order.

    At nodes whose translations do not turn with them the tangent stiffness has terms of the forces
    of shells and of all forces on the node. Those of the present frames are none of linear theory.

    Attributes:
        multipliers: Of the constraints, in their units in the matrix, shape (m,).
    """

    def __init__(self, system: System, memory: Memory, H: Array, dx: Array, forces: Forces) -> None:
        """Find the forces.

        Args:
            system: The equations.
            memory: What carries stress.
            H: Frames of all rows.
            dx: Local increments of the moving nodes from there, and multipliers, shape (6 n + m,).
            forces: That the residual has found there.
        """
        self._memory, self._H = memory, H
        self._h, self.multipliers = np.split(dx.copy(), [6 * system.count])
        memory.carry(H)
        self._start = memory.memory()
        nodal = self._h.reshape(-1, 6)
        self._own = [
            term.linear_forces(H, kept, nodal)
            for term, kept in zip(system.terms, forces.own, strict=True)
        ]
        self._inner = np.zeros_like(nodal)
        for term, kept in zip(system.terms, forces.own, strict=True):
            if not term.within_joints:
                rows, columns = term.pairs
                pulled = np.einsum("pij,pj->pi", term.tangent(H, kept), nodal[columns])
                np.add.at(self._inner, rows, pulled)

    def carry(self, factor: float) -> None:
        """Carry the stress of ``factor`` times the increments, and give springs their forces."""
        h = factor * self._h
        # cells' own unknowns are carried on from what they are
        self._memory.restore(self._start)
        self._memory.carry(self._H, h)
        self._memory.stretch_springs(self._H, h)

    def add_forces(self, factor: float, forces: Forces) -> None:
        """Add the forces of ``factor`` times the increments to those at the frames."""
        forces.inner += factor * self._inner
        for kept, own in zip(forces.own, self._own, strict=True):
            kept += factor * own
