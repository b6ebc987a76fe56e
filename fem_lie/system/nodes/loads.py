"""Nodal loads at one time, as compiled sums take them."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

from fem_lie._arrays import Array

PlainLoads: TypeAlias = tuple[Array, Array, Array]
""":class:`Loads` at the door from Python: compiled functions are quicker to call so."""


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

    @property
    def plain(self) -> PlainLoads:
        """As compiled functions are quicker to call with."""
        return (*self,)
