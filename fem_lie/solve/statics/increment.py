"""Moving the nodes in statics."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fem_lie._arrays import Array
from fem_lie.lie.kinds import advance

if TYPE_CHECKING:
    from fem_lie.system.equations import Equations


def move(equations: Equations, H: Array, x: Array, *, carried: bool) -> float:
    """Move nodes by ``−x``.

    Args:
        equations: Of the scene.
        H: Frames of all rows, changed.
        x: Solution of the equations, in the nodes' frames, (≥ 6 n,).
        carried: Whether the stress is carried along.

    Returns:
        The largest increment, over the unit of its unknown.
    """
    unknowns = equations.unknowns
    equations.memory.follow(H, -x[: 6 * unknowns.moving])
    if carried:
        equations.memory.carry(H, -x[: 6 * unknowns.moving])
    ways = unknowns.held, unknowns.uncoupled, unknowns.straight
    advance(unknowns.kinds, H, x, *ways)
    equations.memory.turn_axes(H)
    return float(np.abs(x[: 6 * unknowns.moving] / unknowns.units).max(initial=0.0))
