"""Springs and dampers along the coordinates of joints.

Their forces, and what becomes of these as coordinates turn, are summed with those of the joints, in
one loop over one table (:mod:`fem_lie.system.constraint_sets`); here they stand by themselves.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie.forms.abilities import ViscousForces
from fem_lie.forms.term import Pairs, Term
from fem_lie.system.constraint_sets.constraint_set import ConstraintSet


class _Along(Term):
    """What acts along coordinates: a set of constraints whose multipliers are zero."""

    within_joints, conserved = True, True

    def __init__(self, joints: ConstraintSet, count: int, m: int) -> None:
        """Find the pairs of nodes.

        Args:
            joints: The set that has the springs.
            count: Nodes that move.
            m: Constraints of all sets.
        """
        self._joints, self._count, self._none = joints, count, np.zeros(m)
        rows, columns = joints.pairs
        moves = (rows < count) & (columns < count) & joints.sprung
        self._pairs = rows[moves], columns[moves]
        self._place = np.where(moves, np.cumsum(moves).reshape(moves.shape) - 1, -1)

    @property
    def pairs(self) -> Pairs:
        """Those of the joints that have any."""
        return self._pairs

    def _forces(self, H: Array, v: Array) -> Array:
        r = np.zeros(6 * self._count + len(self._none))
        self._joints.evaluate(H, v, self._none, self._none, self._count, r)
        return r[: 6 * self._count].reshape(-1, 6)

    def _blocks(self) -> Array:
        return np.zeros((len(self._pairs[0]), 6, 6))


class Springs(_Along):
    """All springs of a set of joints."""

    label = "springs"

    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """See the base class."""
        out[: self._count] += self._forces(H, np.zeros((self._count, 6)))

    def tangent(self, H: Array, kept: Array) -> Array:
        """``k bᵀb`` with the derivatives ``b`` of the coordinates."""
        blocks = self._blocks()
        self._joints.stiffen(H, self._place, 1.0, 0.0, blocks)
        return blocks

    def geometric(self, H: Array) -> Array:
        """``k (q − q₀) ∂b/∂h``."""
        blocks = self._blocks()
        self._joints.geometric(H, self._none, self._place, blocks)
        return blocks

    def energy(self, H: Array) -> float:
        """``½ k (q − q₀)²``."""
        return self._joints.spring_energy(H)


class Dampers(_Along, ViscousForces):
    """All dampers of a set of joints."""

    label = "dampers"

    @property
    def viscosity(self) -> ViscousForces:
        """All forces."""
        return self

    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """There are none at rest."""

    def tangent(self, H: Array, kept: Array) -> Array:
        """Zero."""
        return self._blocks()

    def add_viscous_forces(self, H: Array, v: Array, out: Array) -> None:
        """See the base class."""
        still = np.zeros((self._count, 6))
        out[: self._count] += self._forces(H, v) - self._forces(H, still)

    def viscous_tangent(self, H: Array, v: Array) -> tuple[Array, Array | None]:
        """``c bᵀb``; how ``b`` turns is left out."""
        blocks = self._blocks()
        self._joints.stiffen(H, self._place, 0.0, 1.0, blocks)
        return blocks, None
