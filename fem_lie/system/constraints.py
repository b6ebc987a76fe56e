"""All joints, springs, drives, gears and prescribed motions of a scene, as sets of constraints.

The class here numbers the constraints set by set and loops over the sets.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.bodies.body import Point
from fem_lie.bodies.catalogue import JointInfo
from fem_lie.joints.connection import Connection
from fem_lie.joints.equations.joint_arrays import JointArrays, PackedJoints
from fem_lie.joints.joint import RedundantConstraints
from fem_lie.joints.kinds import Fixed
from fem_lie.lie.node_types import POSITION_GRADIENT
from fem_lie.linear.saddle_point import Incidences
from fem_lie.scene import Scene
from fem_lie.system.constraint_sets.all_pairs import AllPairs, all_pairs
from fem_lie.system.constraint_sets.constraint_set import (
    ConstraintSet,
    HistoryKey,
    Numbered,
    Place,
    SystemFrames,
    Targets,
)
from fem_lie.system.constraint_sets.kinds import sets_of
from fem_lie.system.nodes.numbering import Numbering

_CLOSED = 1e-6
"""Largest violation, rad or over the size of the bodies, of constraints that are activated."""


class _Carried(Fixed):
    """Rigid connection to a prescribed motion, with the axes of the moved node."""

    def frame(self) -> Array:
        """Frame of the moved node."""
        return self.a.frame


def _check_friction(scene: Scene) -> None:
    """Raise ``ValueError`` if forces of a joint with friction are not unique, or may be switched.

    Raises:
        ValueError: The message names the friction.
    """
    for item in scene.connections:
        friction = item.friction
        if friction is None:
            continue
        if scene.redundant is RedundantConstraints.MINIMUM_NORM:
            raise ValueError(
                f"{item.label}: redundant constraints leave the forces of joints open, on which "
                "friction depends; expected a scene without redundant=..., such as with joints "
                "that constrain less"
            )
        if friction.joint in scene.switched:
            raise ValueError(
                f"{item.label}: an event switches {friction.joint.label}, which has friction; "
                "switch the friction by fl.schemes.Scale and hold the joint by a Drive instead"
            )


class Connections:
    """All sets of constraints of a system.

    Attributes:
        items: Joints, springs, drives and gears, and prescribed motions as fixed joints.
        first: The set that the compiled sums over all nodes include.
        sets: ``first``, and all other sets that are not empty.
        incidences: Incidences of all constraints with nodes.
        owner: The item of each constraint, shape (m,).
        angular: Whether a constraint is an angle instead of a length, shape (m,).
        m: Number of all constraints; the last ``of_velocities`` of them constrain velocities.
    """

    def __init__(self, scene: Scene, numbering: Numbering, frames: Array, held: Flags) -> None:
        """Build the sets.

        Args:
            scene: The scene.
            numbering: Numbering of its nodes.
            frames: Initial frames of moving nodes, ground and prescribed motions.
            held: Unknowns of the moving nodes that are zero, shape (n, 6).
        """
        _check_friction(scene)
        self._numbering = numbering
        motions = [
            _Carried(motion.point, Point(None), name=f"motion of {motion.point.label}")
            for motion in scene.motions
        ]
        fixed = {motion.b: numbering.count + 1 + k for k, motion in enumerate(motions)}
        self.items: list[Connection] = [*scene.joints, *scene.connections, *motions]
        names = [len(item.coordinate_names) for item in self.items]
        self._coordinates = np.cumsum([0, *names])
        numbered = [
            Numbered(item, k, int(at))
            for k, (item, at) in enumerate(zip(self.items, self._coordinates, strict=False))
        ]
        constrained = SystemFrames(numbering, frames, held, fixed)
        self.first, others = sets_of(numbered, constrained)
        self.sets: list[ConstraintSet] = [self.first, *others]
        self.owner: Indices = np.concatenate([each.owner for each in self.sets]).astype(np.int64)
        self.angular: Flags = np.concatenate([each.angular for each in self.sets]).astype(bool)
        self.incidences = _joined([each.incidences for each in self.sets])
        self.m = len(self.owner)
        self.of_velocities = sum(each.m for each in self.sets if each.of_velocities)
        base = np.concatenate([each.initial(frames) for each in self.sets])
        self._targets = Targets(self.items, self.owner, base)
        self._preload = 1.0
        active = np.array([item.active for item in self.items], dtype=bool)
        self.inactive: Flags = ~active[self.owner]
        self.set_time(0.0)

    @property
    def table(self) -> JointArrays:
        """Table of the first set."""
        return self.first.arrays

    @property
    def packed(self) -> PackedJoints:
        """Packed arrays of the first set, for calls from Python."""
        return self.first.packed

    @property
    def packed_probes(self) -> PackedJoints:
        """Packed arrays of the first set whose constraints are the coordinates in results."""
        return self.first.packed_probes

    @property
    def joined(self) -> Flags:
        """Whether a constraint belongs to the same vector as the one before, shape (m,).

        Length constraints of one item are one vector, and its angular constraints another. The norm
        of a vector does not depend on the axes of the joint.
        """
        same = np.diff(self.owner, prepend=-1) == 0
        return same & (np.diff(self.angular.astype(np.int8), prepend=-1) == 0)

    @property
    def of_joints_only(self) -> bool:
        """Whether the first set is the only one."""
        return len(self.sets) == 1

    @property
    def others(self) -> list[str]:
        """Descriptions of the other sets, for messages of schemes that support the first only."""
        return [each.what for each in self.sets[1:]]

    @property
    def nodes(self) -> Indices:
        """Rows on which any connection acts, in ascending order."""
        return np.unique(np.concatenate([each.held for each in self.sets]))

    @property
    def bound(self) -> Indices:
        """Rows on which any connection acts and whose axes matter to it."""
        return np.unique(np.concatenate([each.bound for each in self.sets]))

    def all_pairs(self, frames: Array, kinds: Indices) -> AllPairs | None:
        """Relative motions in one record, see :func:`~.constraint_sets.all_pairs.all_pairs`.

        ``None`` if all nodes are frames.
        """
        if (kinds < POSITION_GRADIENT).all():
            return None
        return all_pairs(self.sets, self._numbering, frames, kinds)

    # --- equations ---

    def add_others(
        self, H: Array, v: Array, multipliers: Array, scale: Array, factor: float, r: Array
    ) -> None:
        """Add constraint forces and violations of all sets but the first to the residual ``r``.

        Violations are times ``scale``, those of velocity constraints times ``factor`` as well.
        """
        if self.of_velocities:
            scale = scale.copy()
            scale[self.m - self.of_velocities :] *= factor
        for each in self.sets[1:]:
            each.evaluate(H, v, multipliers, scale, self._numbering.count, r)

    def reactions(self, H: Array, v: Array, multipliers: Array) -> tuple[Array, float]:
        """Forces of ground and prescribed frames on the joints, and the power of dampers.

        Args:
            H: Frames of all nodes, ground and prescribed motions.
            v: Twists of the moving nodes, shape (n, 6).
            multipliers: Lagrange multipliers, shape (m,).

        Returns:
            Forces and moments in the frames that do not move by themselves, shape (p + 1, 6), and
            the dissipated power.
        """
        rows, free = len(H), self._numbering.count
        r, scale = np.zeros(6 * rows + self.m), np.ones(self.m)
        for each in self.sets:
            each.evaluate(H, v, multipliers, scale, rows, r)
        loss = sum(each.damper_loss(H, v, multipliers) for each in self.sets)
        return r[6 * free : 6 * rows].reshape(-1, 6), float(loss)

    @property
    def outward(self) -> bool:
        """Whether there are dampers, or connections to ground or prescribed motions."""
        return any(each.outward for each in self.sets)

    def jacobian(self, H: Array, rows: Array) -> None:
        """Set the constraint Jacobian, one row of six per incidence, shape (incidences, 6)."""
        rows[:] = 0.0
        for each in self.sets:
            each.jacobian(H, rows)

    def values(self, H: Array) -> Array:
        """Violations of all constraints at the current targets, at rest, shape (m,)."""
        found, still = np.zeros(self.m), np.zeros((len(H), 6))
        for each in self.sets:
            each.values(H, still, found)
        found[self.inactive] = 0.0
        return found

    def rates(self, H: Array, v: Array) -> tuple[Array, Array]:
        """First and second rates of position constraints at constant twists and targets, (m,).

        For velocity constraints: the constrained velocity and its first rate.
        """
        first, second = np.zeros(self.m), np.zeros(self.m)
        for each in self.sets:
            each.rates(H, v, first, second)
        first[self.inactive] = second[self.inactive] = 0.0
        return first, second

    def other_spring_energy(self, H: Array) -> float:
        """Energy of the springs that are not in the first set."""
        return sum(each.spring_energy(H) for each in self.sets[1:])

    # --- time ---

    @property
    def driven(self) -> bool:
        """Whether targets depend on time."""
        return self._targets.driven

    @property
    def present_targets(self) -> Array:
        """Targets at the time that was set last, shape (m,)."""
        return np.concatenate([each.targets for each in self.sets])

    def targets(self, time: float) -> Array:
        """Targets at ``time``, see :meth:`~.constraint_sets.constraint_set.Targets.at`."""
        return self._targets.at(time)

    def set_time(self, time: float) -> None:
        """Set the targets at ``time``; errors as for :meth:`targets`."""
        values = self.targets(time)
        for each in self.sets:
            each.targets[:] = values[each.own]

    @property
    def has_laws(self) -> bool:
        """Whether there are force laws."""
        return any(item.force_law is not None for item in self.items)

    @property
    def has_friction(self) -> bool:
        """Whether joints have friction."""
        return any(item.friction is not None for item in self.items)

    @property
    def laws_depend_on_time(self) -> bool:
        """Whether force laws may depend on time."""
        return any(each.depends_on_time for each in self.sets)

    def set_clock(self, time: float) -> None:
        """Set the time at which force laws are evaluated."""
        for each in self.sets:
            each.set_clock(time)

    def check_laws(self) -> None:
        """Raise the error of a force law, if there was one."""
        for each in self.sets:
            each.check_laws()

    def scale_spring(self, item: Connection, factor: float) -> None:
        """Multiply the stiffness and damping of the scene, or the law, of an item by a factor."""
        for each in self.sets:
            each.scale_spring(item, factor)

    def target_rates(self, time: float, step: float, last: float) -> tuple[Array, Array]:
        """Rates of targets, see :meth:`~.constraint_sets.constraint_set.Targets.rates`."""
        first, second = self._targets.rates(time, step, last)
        first[self.inactive] = second[self.inactive] = 0.0
        return first, second

    def switch(self, item: Connection, H: Array, *, active: bool) -> None:
        """Activate or deactivate the constraints of an item.

        Args:
            item: The item.
            H: Frames of all nodes, ground and prescribed motions.
            active: Whether its constraints act from now on.

        Raises:
            ValueError: They are to act, and are not closed.
        """
        own = self.owner == self.items.index(item)
        self.inactive[own] = not active
        if not active:
            return
        found, still = np.zeros(self.m), np.zeros((len(H), 6))
        for each in self.sets:
            each.values(H, still, found)
        size = max(point.size for point in item.points if not point.is_ground)
        gaps = np.abs(found) / np.where(self.angular, 1.0, size)
        if not item.holds and float(gaps[own].max()) > _CLOSED:
            self.inactive[own] = True
            raise ValueError(
                f"locking {item.label} contradicts the state: expected its constraints to be "
                f"closed to {_CLOSED:g} (rad, or of the size of its bodies), got "
                f"{gaps[own].max():.2g}"
            )
        # what is left open stays as it is: closing it in one step would be a jump
        self._targets.shift(found, own)
        if not self.driven:
            self.set_time(0.0)

    @property
    def activity(self) -> dict[str, Array]:
        """Which constraints act, and the constant parts of all targets."""
        return {"inactive": self.inactive.astype(np.float64), "base": self._targets.base.copy()}

    @activity.setter
    def activity(self, kept: dict[str, Array]) -> None:
        self.inactive[:], self._targets.base[:] = kept["inactive"] != 0.0, kept["base"]
        if not self.driven:
            self.set_time(0.0)

    def move_reference_angles(self, H: Array, h: Array) -> None:
        """Move reference angles along the increment ``h`` (n, 6) of nodes, made from ``H``."""
        for each in self.sets:
            each.move_reference_angles(H, h)

    def check_branch(self, H: Array) -> None:
        """Refuse a state on a wrong branch, see :meth:`~.ConstraintSet.check_branch`."""
        for each in self.sets:
            each.check_branch(H)

    @property
    def preloaded(self) -> bool:
        """Whether there are springs with a prescribed rest value."""
        return any(each.preloaded for each in self.sets)

    def preload(self, H: Array, part: float) -> None:
        """Apply a fraction of the preload of springs with a prescribed rest value."""
        if part != self._preload:
            self._preload = part
            for each in self.sets:
                if each.preloaded:
                    each.preload(H, part)

    def accept(self, H: Array) -> None:
        """Update history variables at an accepted state: angles, arc lengths on beams.

        Raises:
            LostBranchError: The state of an item is ambiguous, or beyond its range.
        """
        for each in self.sets:
            each.accept(H)

    @property
    def history_variables(self) -> Array:
        """History variables that frames do not determine: full turns, arc lengths on beams."""
        return np.concatenate(self._history_parts())

    @history_variables.setter
    def history_variables(self, values: Array) -> None:
        parts = self._history_parts()
        for part, value in zip(
            parts, np.split(values, np.cumsum([len(p) for p in parts])[:-1]), strict=True
        ):
            part[:] = value
        for each in self.sets:
            each.mark()

    def remember(self, values: Array | None) -> None:
        """Set the history variables to those of the run that this one continues, if there is one.

        Raises:
            ValueError: It has another number of joint angles.
        """
        if values is None:
            return
        if values.shape != self.history_variables.shape:
            raise ValueError(
                f"the scene has joints with {len(self.history_variables)} pairs of frames, and "
                f"continues a state with {len(values)}: add all joints before "
                "fl.adaptivity.transfer, which sets the state"
            )
        self.history_variables = values

    @property
    def keyed_history_variables(self) -> dict[HistoryKey, float]:
        """History variables by joint and coordinate, for other scenes with the same joints."""
        return dict(zip(self._history_keys, map(float, self.history_variables), strict=True))

    def history_from(self, values: Mapping[HistoryKey, float]) -> Array:
        """History variables of this scene from those of another; others stay as they are."""
        pairs = zip(self._history_keys, map(float, self.history_variables), strict=True)
        return np.array([values.get(key, own) for key, own in pairs])

    @property
    def _history_keys(self) -> list[HistoryKey]:
        return [key for each in self.sets for part in each.history_keys for key in part]

    def _history_parts(self) -> list[Array]:
        return [part for each in self.sets for part in each.history_variables]

    # --- results ---

    @property
    def reported(self) -> tuple[Indices, Indices, Indices, Indices]:
        """Pairs of the first set whose forces results report, sides and items; all owners."""
        return *self.first.reported, self.owner

    def wrenches(self, H: Array, v: Array, multipliers: Array) -> Array:
        """Force and moment of each item on its point ``a``, in its axes there, shape (j, 6)."""
        found = np.zeros((len(self.items), 6))
        for each in self.sets:
            each.wrenches(H, v, multipliers, found)
        return found

    def violations(self, H: Array, v: Array) -> Array:
        """Largest constraint violation of each item at twists of the moving nodes, shape (j,)."""
        values, largest = np.zeros(self.m), np.zeros(len(self.items))
        for each in self.sets:
            each.values(H, v, values)
        values[self.inactive] = 0.0
        np.maximum.at(largest, self.owner, np.abs(values))
        return largest

    def coordinates(self, H: Array) -> Array:
        """Relative coordinates of all items, shape (c,)."""
        found = np.zeros(self._coordinates[-1])
        for each in self.sets:
            each.coordinates(H, found)
        return found

    def info(self) -> tuple[JointInfo, ...]:
        """Names, types and coordinates for results, in the numbering of all nodes."""
        found: dict[int, Place] = {}
        for each in reversed(self.sets):
            found |= each.places()
        return tuple(self._info(k, found[k]) for k in range(len(self.items)))

    def _info(self, k: int, place: Place) -> JointInfo:
        """Record of item k at its place."""
        item, masters = self.items[k], self._numbering.master_map.masters
        node, side = (
            int(masters[row]) if row is not None and row < len(masters) else -1
            for row in (place.row, place.side)
        )
        return JointInfo(
            name=item.label,
            kind="PrescribedMotion" if isinstance(item, _Carried) else type(item).__name__,
            node=node,
            offset=place.offset if node >= 0 else np.zeros(3),
            coordinates=item.coordinate_names,
            first=int(self._coordinates[k]),
            side=side,
            axes=None if place.side is None else place.axes,
        )


def _joined(parts: Sequence[Incidences]) -> Incidences:
    """Concatenate the incidences of successive sets."""
    lengths = [np.diff(incidences.ptr) for incidences in parts]
    ptr = np.cumsum(np.concatenate([[0], *lengths]), dtype=np.int64)
    return Incidences(
        ptr, np.concatenate([incidences.nodes for incidences in parts]).astype(np.int64)
    )
