"""Constraints at one place: their Jacobian, their rates, and whether they contradict each other."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from fem_lie._arrays import Array
from fem_lie.linear.redundancy import IdleMultipliers
from fem_lie.system.small_motions.rigid_motions import RigidMotions, rigid_motions
from fem_lie.system.system import System

_INVOLVED = 1e-2  # of the largest part of what cannot be mended


class ConstraintsAt:
    """All constraints ``Φ`` at frames ``H``."""

    def __init__(self, system: System, H: Array) -> None:
        """Nothing is found yet.

        Args:
            system: The equations.
            H: Frames of all rows.
        """
        self._system, self._H = system, H

    @property
    def jacobian(self) -> sp.csr_matrix:
        """``B`` in the twists of the moving nodes without what is held, (m, 6 n)."""
        return self._system.tangent.jacobian(self._H)

    @property
    def values(self) -> Array:
        """What constraints of positions violate, at their present targets, (m,)."""
        return self._system.connections.values(self._H)

    def rates(self, v: Array) -> tuple[Array, Array]:
        """``dΦ/dt`` and ``d²Φ/dt²`` at constant twists ``v`` of all rows, targets at rest, (m,)."""
        return self._system.connections.rates(self._H, v)

    def rigid_motions(self, weight: Array) -> list[RigidMotions]:
        """Of pieces that elements connect, what is held leaves these.

        See :func:`~fem_lie.system.small_motions.rigid_motions.rigid_motions`.
        """
        return rigid_motions(self._system, self._H, weight)

    def contradiction(self, values: Array, bound: float) -> str:
        """What to say of joints that contradict each other: no motion can mend what is violated.

        It is empty where motions can mend all but ``bound`` of it.

        With redundant constraints the iteration leaves alone what multipliers without force would
        have to meet. In a mechanism that can move there is nothing of that. In one that cannot, and
        is driven all the same, increments end while the constraints stay violated.

        Args:
            values: Of the constraints.
            bound: Over the length of the model, or rad.
        """
        system = self._system
        connections = system.connections
        units = np.asarray(system.units / system.length)
        idle = IdleMultipliers.of(self.jacobian, units, system.kkt.measure)
        # lengths over that of the model beside angles
        left = idle.part(values)
        sizes = np.abs(left) * np.where(connections.angular, 1.0, 1.0 / system.length)
        if sizes.max(initial=0.0) <= bound:
            return ""
        owners = dict.fromkeys(connections.owner[sizes > _INVOLVED * sizes.max(initial=0.0)])
        names = ", ".join(connections.items[int(k)].label for k in owners)
        worst = int(sizes.argmax())
        unit = "rad" if connections.angular[worst] else "length"
        return (
            f"{names} contradict each other: no motion can mend a violation of "
            f"{abs(left[worst]):.2e} ({unit}). The mechanism cannot move as it is driven; check "
            "the axes of its joints, or give it joints with fewer constraints"
        )
