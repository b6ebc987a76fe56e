"""Limits of coordinates in a run: gaps, impacts, rest and release.

Each limit has two stops, the upper and the lower one. A stop is watched by a number that is
negative while nothing happens: how far the coordinate is beyond it while the limit is open, the
pulling force while the limit is closed at this stop.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled
from fem_lie._jit.packed_arrays import Integers1, Numbers2
from fem_lie._state import Stateful, attributes
from fem_lie.joints.connection import Bounds, Connection
from fem_lie.system.equations import Equations

PlainStops: TypeAlias = tuple[Integers1, Numbers2, Integers1, Integers1]
"""Coordinate of each limit, its upper and lower stop (l, 2), its constraint, and the stop at which
it is closed; in a tuple for compiled functions."""


@compiled
def watch(coordinates: Array, of_limits: PlainStops, multipliers: Array, out: Array) -> None:
    """Watched numbers of the upper and lower stop of each limit, shape (2 l,).

    Args:
        coordinates: Coordinates, to which the limits refer.
        of_limits: See :data:`PlainStops`.
        multipliers: Lagrange multipliers, shape (m,).
        out: The numbers.
    """
    index, stops, rows, closed = of_limits
    for k in range(index.shape[0]):
        for side in range(2):
            sign = 1 - 2 * side
            if closed[k] == 0:
                out[2 * k + side] = sign * (coordinates[index[k]] - stops[k, side])
            elif closed[k] == sign:
                out[2 * k + side] = -sign * multipliers[rows[k]]
            else:
                out[2 * k + side] = -np.inf


_BEYOND = 1e-9
"""Distance beyond a stop, rad or over the size of the bodies, above which an open limit closes."""


class Limits(Stateful):
    """All limits of one run; stop 2 k is the upper one of limit k, stop 2 k + 1 the lower one.

    Attributes:
        closed: Stop at which each limit is closed: 1: upper, −1: lower, 0: none, shape (l,).
    """

    STATE = attributes("closed")

    def __init__(self, equations: Equations) -> None:
        """Collect the limits of the scene.

        Args:
            equations: Equations of the scene.
        """
        scene, self._equations = equations.scene, equations
        items = [*scene.joints, *scene.connections]
        found: list[tuple[Connection, Bounds]] = [
            (item, bounds) for item in items if (bounds := item.bounds) is not None
        ]
        self.items = [item for item, _ in found]
        owner = [items.index(item) for item in self.items]
        self.rows: Indices = np.searchsorted(equations.arrays.owner, owner).astype(np.int64)
        self._coordinates = np.array(
            [equations.info.coordinate(item, None) for item in self.items], dtype=np.int64
        )
        ends = [(bounds.upper, bounds.lower) for _, bounds in found]
        self._stops = np.array(ends, dtype=np.float64).reshape(-1, 2)
        self._signs = np.array([1.0, -1.0])
        self._restitution = np.array([bounds.restitution for _, bounds in found])
        self._slack = _BEYOND * np.array([bounds.unit for _, bounds in found])
        self.closed = np.zeros(len(found), dtype=np.int64)

    def __len__(self) -> int:
        """Number of stops."""
        return 2 * len(self.items)

    def values(self, coordinates: Array, multipliers: Array) -> Array:
        """The watched number of each stop, shape (2 l,).

        Args:
            coordinates: Coordinates of all connections.
            multipliers: Lagrange multipliers, shape (m,).
        """
        found = np.empty(len(self))
        watch(coordinates, self._plain(self._coordinates), multipliers, found)
        return found

    def _plain(self, coordinates: Indices) -> PlainStops:
        return coordinates, self._stops, self.rows, self.closed

    def among(self, coordinates: Indices) -> PlainStops | None:
        """The limits for compiled loops; ``None`` if a coordinate is not among the given ones.

        Args:
            coordinates: Numbers of coordinates that the loop evaluates, in increasing order.
        """
        if not np.isin(self._coordinates, coordinates).all():
            return None
        return self._plain(np.searchsorted(coordinates, self._coordinates))

    def entered(self, start: Array, end: Array) -> Flags:
        """Stops of open limits that a step leaves behind although it starts at them, (2 l,).

        Args:
            start: Watched numbers at the start of the step.
            end: Watched numbers at its end.
        """
        slack, free = np.repeat(self._slack, 2), np.repeat(self.closed == 0, 2)
        return np.asarray(free & (start >= 0.0) & (end > slack))

    def strike(self, fired: Flags, H: Array, *, rebound: bool) -> Array:
        """Close open limits at their stops, and open closed ones.

        Args:
            fired: Stops at which something happens, shape (2 l,).
            H: Frames of all nodes, ground and prescribed motions.
            rebound: Whether there is restitution.

        Returns:
            Coefficient of restitution of each constraint, shape (m,).
        """
        factors = np.zeros(self._equations.unknowns.m)
        for k, side in zip(*np.nonzero(fired.reshape(-1, 2)), strict=True):
            if self.closed[k]:
                self._open(k, H)
                continue
            self._equations.history_variables.switch(self.items[k], H, active=True)
            self.closed[k] = int(self._signs[side])
            factors[self.rows[k]] = self._restitution[k] if rebound else 0.0
        return factors

    def overdue(self, start: Array, end: Array) -> Flags:
        """Stops that pull at both ends of a step, and open at its end, shape (2 l,).

        Args:
            start: Watched numbers at the start of the step.
            end: Watched numbers at its end.
        """
        return np.asarray(np.repeat(self.closed != 0, 2) & (start >= 0.0) & (end >= 0.0))

    def separate(self, factors: Array, H: Array, multipliers: Array, resting: Flags) -> bool:
        """Open limits that rebound, and those whose stop would pull; return whether there are any.

        Args:
            factors: Coefficients of restitution of the last :meth:`strike`.
            H: Frames of all nodes, ground and prescribed motions.
            multipliers: Lagrange multipliers after it, shape (m,).
            resting: Limits that stay closed for one step, even if their stop pulls at its start,
                shape (l,): without them they would be beyond the stop at its end.
        """
        pulls = (self.closed * multipliers[self.rows] < 0.0) & ~resting
        leaving = (self.closed != 0) & ((factors[self.rows] > 0.0) | pulls)
        for k in np.flatnonzero(leaving):
            self._open(int(k), H)
        return bool(leaving.any())

    def _open(self, k: int, H: Array) -> None:
        self._equations.history_variables.switch(self.items[k], H, active=False)
        self.closed[k] = 0
