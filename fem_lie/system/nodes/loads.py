"""Nodal loads at one time, as compiled sums take them."""

from __future__ import annotations

from typing import NamedTuple

from fem_lie._arrays import Array


class Loads(NamedTuple):
    """Nodal loads at one time.

    Attributes:
        dead: Force on (x, d₁, d₂, d₃) fixed in space, gravity included, shape (n, 4, 3).
        moment: Moment fixed in space, shape (n, 3).
        following: Force and moment in the nodes' frames, shape (n, 6).
    """

    dead: Array
    moment: Array
    following: Array
