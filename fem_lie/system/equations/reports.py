"""What results tell of supports and joints."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie.linear.idle_multipliers import IdleMultipliers
from fem_lie.scene.choices import Redundant
from fem_lie.system.instant import Instant
from fem_lie.system.nodes.fixed_axes import wrenches
from fem_lie.system.system import System


def reactions(system: System, state: Instant) -> Array:
    """Force and moment of supports on the nodes that are held, about them, shape (s, 6).

    Global components.
    """
    if not len(system.supported):
        return np.zeros((0, 6))
    H, r = state.H, np.empty(system.size)
    # along the axes of supports, where there are any
    system.with_reactions(state, np.ones(system.m), r)
    local, held = r[: 6 * system.count].reshape(-1, 6), system.held
    if system.supports:
        local[~held] = 0.0
        system.supports.turn_back(H, local)
        held = np.ones_like(held)
    return wrenches(system.kinds, H, local, held, system.supported)


def joints(system: System, H: Array, v: Array, weights: Array) -> tuple[Array, Array, Array]:
    """See :meth:`~fem_lie.system.constraints.Connections.report`."""
    return system.connections.report(H, v, felt(system, H, weights))


def felt(system: System, H: Array, weights: Array) -> Array:
    """The multipliers that results report, shape (m,): the smallest, where that was chosen."""
    if system.scene.redundant is not Redundant.MINIMUM_NORM or not system.m:
        return weights
    B = system.tangent.jacobian(H)
    return IdleMultipliers.of(B, system.length, system.kkt.measure).remove(weights)
