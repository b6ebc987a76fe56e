"""State of a running scene, as conditions and actions of events, sensors and controllers see it.

Functions of users ask for points and coordinates of the whole scene, of which a rank may have a
part. All ranks call the same functions in the same order: the lowest rank that has what they ask
for sends it to all, and all take the value that the first rank computes from it.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any, TypeVar

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.body import Point
from fem_lie.bodies.catalogue import located_frame, located_twist
from fem_lie.joints.connection import Connection
from fem_lie.lie.node_types import retract_all
from fem_lie.parts.part_scene import whole_scene
from fem_lie.results.gathering import WholeScene
from fem_lie.system.equations import Equations

_DIFFERENCE = 1e-6
"""Rotation, or displacement over the length of the model, of differences for rates."""

Value = TypeVar("Value")


class EventError(RuntimeError):
    """A condition or an action failed, or an event happens without end."""


class WatchedScene:
    """The whole scene of a run, of which a rank may have a part.

    Attributes:
        equations: Equations of the part.
        scene: The scene.
        info: Bodies and joints of the scene.
    """

    def __init__(self, equations: Equations) -> None:
        """Number the nodes and coordinates; all ranks together.

        Args:
            equations: Equations of the scene, or of the part of this rank.
        """
        self.equations, self._shared = equations, equations.shared
        self.scene = whole_scene(equations.scene, equations.part)
        whole = WholeScene(equations.info, equations.part)
        self.info, self._gathering = whole.info, whole.gathering

    def alike(self, function: Callable[[], Value]) -> Value:
        """Value of a function that calls those of users: that of the first rank, on all.

        Args:
            function: The function; it may ask for :meth:`nodal` values, coordinates and the
                :meth:`largest` of all ranks.

        Raises:
            EventError: It failed on a rank.
        """
        with self._shared.errors(EventError):
            found = function()
        value: Value = self._shared.first(found)
        return value

    def nodal(self, what: str, values: Array, nodes: Indices) -> Array:
        """Values of some nodes of the scene, shape (k, …), from those of the nodes of the part.

        Args:
            what: What the values are.
            values: Those of the nodes of the part, shape (n, …).
            nodes: Numbers of the nodes in the scene.
        """
        if self._gathering is None:
            return np.asarray(values[nodes])
        own = self._own_nodes(nodes)
        here = own >= 0
        found = np.empty((len(nodes), *values.shape[1:]))
        pieces = self._shared.exchange(f"{what} of nodes {nodes}", (here, values[own[here]]))
        for at, rows in reversed(pieces):  # the lowest rank that has a node
            found[at] = rows
        return found

    def _own_nodes(self, nodes: Indices) -> Indices:
        """Numbers in the part of nodes of the scene; −1 where it has none."""
        order, known = self._sorted
        at = np.minimum(np.searchsorted(known, nodes), len(known) - 1)
        return np.where(known[at] == nodes, order[at], -1)

    @cached_property
    def _sorted(self) -> tuple[Indices, Indices]:
        """Nodes of the part in the order of their numbers in the scene, and these numbers."""
        assert self._gathering is not None
        order = np.argsort(self._gathering.nodes)
        return order, self._gathering.nodes[order]

    def coordinates(self, own: Array) -> Array:
        """Coordinates of all joints of the scene, shape (c,), from those of the part."""
        if self._gathering is None:
            return own
        pieces = self._shared.exchange("coordinates", (self._gathering.columns, own))
        found = np.empty(sum(len(columns) for columns, _ in pieces))
        for columns, values in pieces:
            found[columns] = values
        return found

    def largest(self, value: float) -> float:
        """Largest value of all ranks."""
        return float(max(self._shared.exchange("the largest velocity", value)))


class RunningState:
    """A state of a run, see :class:`~fem_lie.events.state.State`.

    Attributes:
        time: The time.
        multipliers: Lagrange multipliers of the part, shape (m,).
    """

    def __init__(
        self,
        scene: WatchedScene,
        time: float,
        H: Array,
        v: Array,
        multipliers: Array,
        step: float,
    ) -> None:
        """Store the state.

        Args:
            scene: The scene.
            time: The time.
            H: Frames of all nodes, ground and prescribed motions.
            v: Twists of the moving nodes.
            multipliers: Lagrange multipliers.
            step: Interval of differences for the rates of prescribed motions.
        """
        self.time, self.multipliers, self._step = time, multipliers, step
        self._scene, self._H, self._v = scene, H, v

    @cached_property
    def _report(self) -> Any:
        return self._scene.equations.report(self._H, self._v)

    @cached_property
    def _frames(self) -> Array:
        return np.asarray(self._report.frames)

    @cached_property
    def coordinates(self) -> Array:
        """Coordinates of all joints, shape (c,)."""
        return np.asarray(self._scene.coordinates(self._report.joints.coordinates))

    @cached_property
    def _rates(self) -> Array:
        """Rates of all coordinates, by central differences along the motion."""
        equations = self._scene.equations
        n = equations.unknowns.moving
        driven = equations.prescribed(self.time, self._step).velocities
        v = np.concatenate([self._v[:n], np.zeros((1, 6)), driven])
        types = np.append(equations.unknowns.kinds, np.zeros(len(v) - n, dtype=np.int64))
        units = np.repeat([equations.unknowns.length, 1.0], 3)
        h = _DIFFERENCE / max(self._scene.largest(float(np.abs(v / units).max())), 1e-300)
        ends = []
        for sign in (1.0, -1.0):
            H = self._H.copy()
            retract_all(types, self._H, sign * h * v, H)
            ends.append(equations.report(H).joints.coordinates)
        return self._scene.coordinates(np.asarray((ends[0] - ends[1]) / (2.0 * h)))

    def _frame(self, point: Point | str) -> Array:
        nodes, attachment = self._scene.info.located(point)
        return located_frame(attachment, self._scene.nodal("frames", self._frames, nodes))

    def position(self, point: Point | str) -> Array:
        """Position of a point, global components, shape (3,)."""
        return np.array(self._frame(point)[0])

    def rotation(self, point: Point | str) -> Array:
        """Rotation of a point's frame, local to global, shape (3, 3)."""
        return np.array(self._frame(point)[1:].T)

    def velocity(self, point: Point | str) -> Array:
        """Velocity of a point (translation, rotation) in its local frame, shape (6,)."""
        nodes, attachment = self._scene.info.located(point)
        given = (("frames", self._frames), ("twists", self._report.twists))
        frames, v = (self._scene.nodal(what, values, nodes) for what, values in given)
        return np.array(located_twist(attachment, frames, v))

    def coordinate(self, joint: Connection | str, name: str | None = None) -> float:
        """Relative coordinate of a joint: an unwrapped angle in rad, or a length."""
        return float(self.coordinates[self._scene.info.coordinate(joint, name)])

    def rate(self, joint: Connection | str, name: str | None = None) -> float:
        """Rate of a relative coordinate."""
        return float(self._rates[self._scene.info.coordinate(joint, name)])

    @property
    def kinetic(self) -> float:
        """Kinetic energy; all ranks together."""
        return float(self._scene.equations.shared.total(np.array(self._report.kinetic)))
