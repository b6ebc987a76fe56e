"""When contacts meet within a step, and which velocities and gaps they are to have at its end."""

from __future__ import annotations

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
