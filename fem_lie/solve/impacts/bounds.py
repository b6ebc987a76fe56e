"""Bounds on gaps and velocities at the end of a step, and on the energy of restitution.

Newton's law of restitution is for the normal velocity of one contact. If several contacts interact
in a step, if normals rotate within it, or if positions are corrected against a force, it may give
more energy than there was before the impacts. The restitution is then reduced until no energy is
gained.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.contact.cones.jacobian import BlockRows
from fem_lie.contact.impact.velocities import set_bounds
from fem_lie.solve.impacts.delassus import Delassus


class Chosen(NamedTuple):
    """Active contacts of a step, k of them.

    Attributes:
        pairs: Indices among all pairs, shape (k,).
        axis: Axes that define the tangents.
        closed: Whether they were closed at the start.
        before: Contact Jacobian at the start.
        operator: Delassus operator.
        speed: Normal velocity at the start.
        gaps: Gaps at the start.
        smooth: Gaps at the end without contacts.
        friction: Friction coefficient μ.
        restitution: Coefficient of restitution e.
    """

    pairs: Indices
    axis: Indices
    closed: Flags
    before: BlockRows
    operator: Delassus
    speed: Array
    gaps: Array
    smooth: Array
    friction: Array
    restitution: Array


class Bounds(NamedTuple):
    """Bounds from the law of impact.

    Attributes:
        velocity: Least normal velocity at the end, shape (k,).
        incoming: Normal velocity at the impact.
        rest: Fraction of the step after it.
    """

    velocity: Array
    incoming: Array
    rest: Array

    def gaps(self, h: float, velocity: Array, chosen: Chosen) -> Array:
        """Least gaps at the end of a step of size ``h``, for a normal velocity there."""
        away = 0.5 * (velocity - chosen.restitution * self.incoming)
        return np.where(chosen.closed, 0.0, np.maximum(0.0, away * self.rest * h))


def bounds_of(h: float, chosen: Chosen, free: Array) -> Bounds:
    """Bounds of all active contacts.

    Args:
        h: Step size.
        chosen: The contacts.
        free: Normal velocities at the end without contacts, shape (k,).
    """
    found, gaps = np.empty((len(free), 3)), (chosen.gaps, chosen.smooth)
    set_bounds(h, gaps, chosen.closed, chosen.speed, free, chosen.restitution, found)
    velocity, incoming, part = found.T
    return Bounds(velocity, incoming, 1.0 - part)


_TRIES, _ENOUGH = 8, 1e-3
"""Number of tried fractions of the restitution between all and none; and an energy loss, over the
gain of the full restitution, that is small enough."""


def allowed_part(gain: Callable[[float], float], whole: float, allowed: float) -> float:
    """A fraction of the restitution, near the largest, without a gain of energy.

    Args:
        gain: Energy gain of a step as a function of the fraction.
        whole: Energy gain of the full restitution, more than allowed.
        allowed: Energy gain that is round-off.

    Returns:
        The fraction; 1 if energy is gained without restitution, too, which is then not its cause.
    """
    least, below, most = 0.0, gain(0.0), 1.0
    if below > allowed:
        return 1.0
    low, high, side = below, whole, 0  # Illinois method: halve the value at an end that stays
    for _ in range(_TRIES):
        if -below <= max(allowed, _ENOUGH * whole):
            break
        part = least - low * (most - least) / (high - low)
        here = gain(part)
        if here <= allowed:
            least, below, low = part, here, min(here, -allowed)
            high, side = 0.5 * high if side < 0 else high, -1
        else:
            most, high = part, here
            low, side = 0.5 * low if side > 0 else low, 1
    return least
