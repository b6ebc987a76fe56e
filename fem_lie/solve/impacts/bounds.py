"""Bounds on gaps and velocities at the end of a step, and on the energy of restitution.

How much of the restitution a step may have without a gain of energy.

Newton's law is for the normal velocity of one contact. Where several meet in a step, where normals
turn within it or positions are corrected against a force, it may give more energy than impacts had.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.contact.impact.jacobian import BlockRows
from fem_lie.contact.impact.velocities import set_bounds
from fem_lie.solve.impacts.delassus import Delassus


class Chosen(NamedTuple):
    """Contacts that take part in a step, k of them.

    Attributes:
        pairs: Which of all pairs, shape (k,).
        axis: By which tangents are chosen.
        closed: Whether they were closed at the start.
        before: Rows at the start.
        operator: What their impulses do.
        speed: Along the normal at the start.
        gaps: At the start.
        smooth: At the end without contacts.
        friction: μ.
        restitution: e.
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
    """What impacts ask for.

    Attributes:
        velocity: Least normal velocity at the end, shape (k,).
        incoming: That at the impact.
        rest: Part of the step after it.
    """

    velocity: Array
    incoming: Array
    rest: Array

    def gaps(self, h: float, velocity: Array, chosen: Chosen) -> Array:
        """Least gaps at the end of a step of size ``h``, with a normal velocity there."""
        away = 0.5 * (velocity - chosen.restitution * self.incoming)
        return np.where(chosen.closed, 0.0, np.maximum(0.0, away * self.rest * h))


def bounds_of(h: float, chosen: Chosen, free: Array) -> Bounds:
    """Bounds of all contacts.

    Args:
        h: Size of the step.
        chosen: The contacts.
        free: Normal velocities at the end without contacts, shape (k,).
    """
    found, gaps = np.empty((len(free), 3)), (chosen.gaps, chosen.smooth)
    set_bounds(h, gaps, chosen.closed, chosen.speed, free, chosen.restitution, found)
    velocity, incoming, part = found.T
    return Bounds(velocity, incoming, 1.0 - part)


_TRIES, _ENOUGH = 8, 1e-3
"""Parts of the restitution that are tried beside all and none; loss of energy, over what all of it
would gain, that is small enough."""


def allowed_part(gain: Callable[[float], float], whole: float, allowed: float) -> float:
    """A part of the restitution, near the largest, with which no energy is gained.

    Args:
        gain: Energy that a step gains with a part of the restitution.
        whole: That with all of it, more than allowed.
        allowed: Gain that is round-off.

    Returns:
        The part; 1 if energy is gained without restitution, too, for it is not what gives it.
    """
    least, below, most = 0.0, gain(0.0), 1.0
    if below > allowed:
        return 1.0
    low, high, side = below, whole, 0  # Illinois method: an end that stays twice weighs half
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
