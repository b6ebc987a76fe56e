"""Velocity constraints: rolling without slip, and knife edges."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.joints.connection import VelocityConstraintDefinition
from fem_lie.joints.equations import rolling
from fem_lie.joints.equations.rolling import RollingArrays
from fem_lie.linear.saddle_point import Incidences
from fem_lie.system.constraint_sets.constraint_set import (
    ConstrainedFrames,
    ConstraintSet,
    Numbered,
    Place,
    Start,
    places,
    relative_frames,
    stacked,
)


class Rolls(ConstraintSet):
    """Set of velocity constraints, see :mod:`fem_lie.joints.equations.rolling`.

    Attributes:
        arrays: Packed arrays of all of them.
    """

    what = "velocity constraints (KnifeEdge, RollingDisc)"
    of_velocities = True

    def __init__(
        self, items: Sequence[Numbered], constrained: ConstrainedFrames, start: Start
    ) -> None:
        """Build the arrays of all rolling discs and knife edges."""
        found = [
            (given.number, definition)
            for given in items
            for definition in given.item.velocity_definitions()
        ]
        self.start, self._count = start, constrained.count
        self._items: Indices = np.array([number for number, _ in found], dtype=np.int64)
        definitions = [definition for _, definition in found]
        self.owner = np.repeat(
            self._items, [len(definition.selection) for definition in definitions]
        )
        touched = [
            {constrained.of(definition.a), constrained.of(definition.b)}
            for definition in definitions
            for _ in definition.selection
        ]
        self.incidences = Incidences.of(touched, constrained.count)
        self.arrays = _table(constrained, definitions, self.incidences, start)
        self.targets = np.zeros(self.m)
        # all constrained velocities are those of points
        self.angular = np.zeros(self.m, dtype=bool)
        none = np.empty(0, dtype=np.int64)
        # the geometric stiffness of velocity constraints is left out
        self.pairs = none, none

    @property
    def empty(self) -> bool:
        """Whether it has no constraint, spring or coordinate."""
        return self.m == 0

    def evaluate(
        self, H: Array, v: Array, multipliers: Array, scale: Array, count: int, r: Array
    ) -> None:
        """Add constraint forces ``Bᵀλ`` and spring forces to ``r``; set its rows ``scale · Φ``."""
        rolling.evaluate(H, v, self.arrays, multipliers, scale, count, r)

    def values(self, H: Array, v: Array, out: Array) -> None:
        """Set the slip velocities ``W V`` in its rows of ``out``."""
        rolling.rates(H, v, self.arrays, out, np.empty_like(out))

    def jacobian(self, H: Array, rows: Array) -> None:
        """Add ``W``, one row of six per incidence, to the constraint Jacobian ``rows``."""
        rolling.jacobian(H, self.arrays, rows)

    def geometric(self, H: Array, multipliers: Array, index: Indices, K: Array) -> None:
        """Add nothing: the geometric stiffness of velocity constraints is left out."""

    def rates(self, H: Array, v: Array, first: Array, second: Array) -> None:
        """Set ``W V`` and its rate at constant twists in its rows."""
        rolling.rates(H, v, self.arrays, first, second)

    def wrenches(self, H: Array, v: Array, multipliers: Array, out: Array) -> None:
        """Add force and moment on side A of each item, in its axes there, to the rows of items."""
        rolling.wrenches(H, self.arrays, multipliers, self._items, out)

    def places(self) -> dict[int, Place]:
        """Position on side A of each item, or on side B if A is ground, and axes of its force."""
        return places(self._items, self.arrays.nodes, self.arrays.frames, self._count)

    @property
    def outward(self) -> bool:
        """Whether there are dampers, or connections to ground or prescribed motions."""
        return bool((self.arrays.nodes >= self._count).any())


def _table(
    constrained: ConstrainedFrames,
    definitions: Sequence[VelocityConstraintDefinition],
    incidences: Incidences,
    start: Start,
) -> RollingArrays:
    nodes = np.array(
        [
            (constrained.of(definition.a), constrained.of(definition.b))
            for definition in definitions
        ],
        dtype=np.int64,
    )
    nodes = nodes.reshape(-1, 2)
    frames = np.array([definition.frames for definition in definitions]).reshape(-1, 2, 4, 3)
    points = [point for each in definitions for point in (each.a, each.b)]
    first = np.cumsum(
        [0] + [len(definition.selection) for definition in definitions], dtype=np.int64
    )
    of_rows = np.repeat(nodes, np.diff(first), axis=0)
    at = incidences.find(np.arange(len(of_rows)), of_rows)
    return RollingArrays(
        nodes=nodes,
        frames=relative_frames(constrained, points, frames),
        first=first,
        selection=stacked([definition.selection for definition in definitions], 0, 6),
        radius=np.array([definition.radius for definition in definitions], dtype=np.float64),
        incidences=np.where(at >= 0, at + start.incidence, -1),
        start=np.array([start.row], dtype=np.int64),
    )
