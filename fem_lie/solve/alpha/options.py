"""Choices of the time integration."""

from __future__ import annotations

from enum import IntEnum


class Components(IntEnum):
    """In which components the iteration matrix is kept; the solution is the same.

    ``LOCAL``: along the nodes' own axes, where it hardly changes. ``INERTIAL``: along fixed axes,
    where it turns with the bodies, as in formulations with rotation vectors in the inertial frame:
    slower, there to compare with.
    """

    LOCAL = 0
    INERTIAL = 1


class Index(IntEnum):
    """Which constraints hold at the end of each step, to the tolerance of the iteration.

    ``THREE``: those of positions; velocities satisfy them to second order. ``STABILISED_TWO``:
    velocities, too, see :mod:`fem_lie.solve.alpha.projection`.
    """

    THREE = 3
    STABILISED_TWO = 2
