"""Joints that contradict each other: what is violated, and no motion can mend.

With redundant constraints the iteration leaves alone what multipliers without force would have to
meet. In a mechanism that can move there is nothing of that. In one that cannot, and is driven all
the same, increments end while the constraints stay violated.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie.linear.idle_multipliers import IdleMultipliers
from fem_lie.system.system import System

_INVOLVED = 1e-2  # of the largest part of what cannot be mended


def contradiction(system: System, H: Array, values: Array) -> str:
    """What to say of violated constraints: the joints that contradict each other.

    Args:
        system: The equations.
        H: Frames of all rows.
        values: Of the constraints.
    """
    connections, kkt = system.connections, system.kkt
    idle = IdleMultipliers.of(system.tangent.jacobian(H), system.length, kkt.measure)
    # lengths over that of the model beside angles
    sizes = np.abs(idle.part(values)) * np.where(connections.angular, 1.0, 1.0 / system.length)
    owners = dict.fromkeys(connections.owner[sizes > _INVOLVED * sizes.max(initial=0.0)])
    names = ", ".join(connections.items[int(k)].label for k in owners)
    worst = int(sizes.argmax())
    unit = "rad" if connections.angular[worst] else "length"
    return (
        f"{names} contradict each other: no motion can mend a violation of {abs(values[worst]):.2e}"
        f" ({unit}). The mechanism cannot move as it is driven; check the axes of its joints, or "
        "give it joints with fewer constraints"
    )
