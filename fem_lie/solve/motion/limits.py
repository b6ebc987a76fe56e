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
from fem_lie.solve.running_state import RunningState, WatchedScene

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

    def __init__(self, scene: WatchedScene) -> None:
        """Collect the limits of the scene.

        Args:
            scene: The scene.
        """
        equations = self._equations = scene.equations
        items, part = [*scene.scene.joints, *scene.scene.connections], equations.part
        found: list[tuple[Connection, Bounds]] = [
            (item, bounds) for item in items if (bounds := item.bounds) is not None
        ]
        self.items = [item for item, _ in found]
        owner: Indices = np.array([items.index(item) for item in self.items], dtype=np.int64)
        owners = equations.arrays.owner
        if part is not None:
            owners = part.connections[owners]
        # a limit is one constraint, of the rank that owns its joint
        row_of = {int(k): row for row, k in enumerate(owners)}
        self._here: Flags = np.isin(owner, owners)
        self._rows: Indices = np.array([row_of[int(k)] for k in owner[self._here]], dtype=np.int64)
        self._coordinates = np.array(
            [scene.info.coordinate(item, None) for item in self.items], dtype=np.int64
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

    def values(self, state: RunningState) -> Array:
        """The watched number of each stop, shape (2 l,); all ranks together.

        Args:
            state: The state.
        """
        found = np.empty(len(self))
        stops = self._plain(self._coordinates, np.arange(len(self.items)))
        watch(state.coordinates, stops, self._forces(state.multipliers), found)
        return found

    def _forces(self, multipliers: Array) -> Array:
        """Multiplier of each limit, shape (l,), from those of the part, (m,)."""
        found = np.zeros(len(self.items))
        found[self._here] = multipliers[self._rows]
        return self._equations.shared.total(found)

    def spread(self, values: Array) -> Array:
        """Values of limits, shape (l,), as those of all constraints of the part, (m,)."""
        found = np.zeros(self._equations.unknowns.m)
        found[self._rows] = values[self._here]
        return found

    def _plain(self, coordinates: Indices, rows: Indices) -> PlainStops:
        return coordinates, self._stops, rows, self.closed

    def among(self, coordinates: Indices) -> PlainStops | None:
        """The limits for compiled loops; ``None`` if a coordinate is not among the given ones.

        Args:
            coordinates: Numbers of coordinates that the loop evaluates, in increasing order.
        """
        if not np.isin(self._coordinates, coordinates).all():
            return None
        return self._plain(np.searchsorted(coordinates, self._coordinates), self._rows)

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
            Coefficient of restitution of each limit, shape (l,).
        """
        factors = np.zeros(len(self.items))
        for k, side in zip(*np.nonzero(fired.reshape(-1, 2)), strict=True):
            if self.closed[k]:
                self._open(k, H)
                continue
            self._equations.history_variables.switch(self.items[k], H, active=True)
            self.closed[k] = int(self._signs[side])
            factors[k] = self._restitution[k] if rebound else 0.0
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
            multipliers: Lagrange multipliers of the part after it, shape (m,).
            resting: Limits that stay closed for one step, even if their stop pulls at its start,
                shape (l,): without them they would be beyond the stop at its end.
        """
        pulls = (self.closed * self._forces(multipliers) < 0.0) & ~resting
        leaving = (self.closed != 0) & ((factors > 0.0) | pulls)
        for k in np.flatnonzero(leaving):
            self._open(int(k), H)
        return bool(leaving.any())

    def _open(self, k: int, H: Array) -> None:
        self._equations.history_variables.switch(self.items[k], H, active=False)
        self.closed[k] = 0
