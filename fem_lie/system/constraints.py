"""All joints, springs, drives, gears and prescribed motions of a scene: one object for the system.

It numbers the constraints, set by set, and goes over the sets; what they are it does not know.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.bodies.body import Point
from fem_lie.bodies.catalogue import JointInfo
from fem_lie.joints import Connection, Fixed
from fem_lie.joints.equations.table import JointTable, PackedJoints
from fem_lie.lie.node_types import POSITION_GRADIENT
from fem_lie.linear.saddle_point import Incidences
from fem_lie.scene import Scene
from fem_lie.system.constraint_sets.all_pairs import AllPairs, all_pairs
from fem_lie.system.constraint_sets.constraint_set import (
    ConstraintSet,
    MemoryKey,
    Numbered,
    SystemRows,
    Targets,
)
from fem_lie.system.constraint_sets.kinds import sets_of
from fem_lie.system.nodes.numbering import Numbering


class _Carried(Fixed):
    """To a prescribed motion; its axes are those of the node that is moved."""

    def frame(self) -> Array:
        """That of the node that is moved."""
        return self.a.frame


class Connections:
    """Goes over the sets of constraints, and says what results report of them.

    Attributes:
        items: Joints, what acts along them, and prescribed motions as fixed joints.
        first: The set that compiled sums over all nodes know.
        sets: That one, and all others that are not empty.
        incidences: Which nodes the constraints touch.
        owner: The item of each constraint, shape (m,).
        angular: Which constraints are angles and not lengths, shape (m,).
        m: Number of all constraints, ``of_velocities`` at the end.
    """

    def __init__(self, scene: Scene, numbering: Numbering, frames: Array, held: Flags) -> None:
        """Make the sets.

        Args:
            scene: What there is.
            numbering: Of its nodes.
            frames: Initial frames of all rows: moving nodes, ground, prescribed motions.
            held: Which unknowns of the moving nodes are zero, shape (n, 6).
        """
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
        rows = SystemRows(numbering, frames, held, fixed)
        self.first, others = sets_of(numbered, rows)
        self.sets: list[ConstraintSet] = [self.first, *others]
        self.owner: Indices = np.concatenate([each.owner for each in self.sets]).astype(np.int64)
        self.angular: Flags = np.concatenate([each.angular for each in self.sets]).astype(bool)
        self.incidences = _joined([each.incidences for each in self.sets])
        self.m = len(self.owner)
        self.of_velocities = sum(each.m for each in self.sets if each.of_velocities)
        base = np.concatenate([each.initial(frames) for each in self.sets])
        self._targets = Targets(self.items, self.owner, base)
        self._preload = 1.0
        self.set_time(0.0)

    @property
    def table(self) -> JointTable:
        """Of the first set."""
        return self.first.table

    @property
    def packed(self) -> PackedJoints:
        """The same for calls from Python."""
        return self.first.packed

    @property
    def packed_probes(self) -> PackedJoints:
        """A table of the first set whose constraints are coordinates that results report."""
        return self.first.packed_probes

    @property
    def joined(self) -> Flags:
        """Which constraints go on from the one before, shape (m,).

        Those of one item along lengths are one vector, and those of its angles another, whose size
        does not depend on the joint's axes.
        """
        same = np.diff(self.owner, prepend=-1) == 0
        return same & (np.diff(self.angular.astype(np.int8), prepend=-1) == 0)

    @property
    def of_joints_only(self) -> bool:
        """Whether there is nothing but the first set."""
        return len(self.sets) == 1

    @property
    def others(self) -> list[str]:
        """What the other sets are, for messages of schemes that know the first one alone."""
        return [each.what for each in self.sets[1:]]

    @property
    def nodes(self) -> Indices:
        """Rows that anything holds on to, in increasing order."""
        return np.unique(np.concatenate([each.held for each in self.sets]))

    @property
    def bound(self) -> Indices:
        """Those of them whose own axes matter, as not to attachments on places."""
        return np.unique(np.concatenate([each.bound for each in self.sets]))

    def all_pairs(self, frames: Array, kinds: Indices) -> AllPairs | None:
        """See :func:`~.constraint_sets.all_pairs.all_pairs`; ``None`` if all nodes are frames."""
        if (kinds < POSITION_GRADIENT).all():
            return None
        return all_pairs(self.sets, self._numbering, frames, kinds)

    # --- equations ---

    def add_others(
        self, H: Array, v: Array, multipliers: Array, scale: Array, factor: float, r: Array
    ) -> None:
        """Forces and violations of all sets but the first, to the residual ``r``.

        Violations are times ``scale``, those of velocities times ``factor``, too.
        """
        if self.of_velocities:
            scale = scale.copy()
            scale[self.m - self.of_velocities :] *= factor
        for each in self.sets[1:]:
            each.evaluate(H, v, multipliers, scale, self._numbering.count, r)

    def reactions(self, H: Array, v: Array, multipliers: Array) -> tuple[Array, float]:
        """What ground and prescribed frames do on the joints, and what dampers take.

        Args:
            H: Frames of all rows.
            v: Twists of the moving nodes, shape (n, 6).
            multipliers: Multipliers, shape (m,).

        Returns:
            Forces and moments in the frames that do not move by themselves, shape (p + 1, 6), and
            the power lost.
        """
        rows, free = len(H), self._numbering.count
        r, scale = np.zeros(6 * rows + self.m), np.ones(self.m)
        for each in self.sets:
            each.evaluate(H, v, multipliers, scale, rows, r)
        loss = sum(each.damper_loss(H, v) for each in self.sets)
        return r[6 * free : 6 * rows].reshape(-1, 6), float(loss)

    @property
    def outward(self) -> bool:
        """Whether there are dampers, or joints with what does not move by itself."""
        return any(each.outward for each in self.sets)

    def jacobian(self, H: Array, rows: Array) -> None:
        """Derivative of all constraints, or of their rates, at the border's legs, (legs, 6)."""
        rows[:] = 0.0
        for each in self.sets:
            each.jacobian(H, rows)

    def values(self, H: Array) -> Array:
        """What constraints violate at present targets, at rest, (m,)."""
        found, still = np.zeros(self.m), np.zeros((len(H), 6))
        for each in self.sets:
            each.values(H, still, found)
        return found

    def rates(self, H: Array, v: Array) -> tuple[Array, Array]:
        """First and second rates of constraints of positions, (m,), at constant twists and targets.

        Of constraints of velocities: what is bound, and its first rate.
        """
        first, second = np.zeros(self.m), np.zeros(self.m)
        for each in self.sets:
            each.rates(H, v, first, second)
        return first, second

    def other_spring_energy(self, H: Array) -> float:
        """Of all springs that are not in the first set."""
        return sum(each.spring_energy(H) for each in self.sets[1:])

    # --- time ---

    @property
    def driven(self) -> bool:
        """Whether targets depend on time."""
        return self._targets.driven

    @property
    def present_targets(self) -> Array:
        """What the constraints are to be at the time that was set, shape (m,)."""
        return np.concatenate([each.targets for each in self.sets])

    def targets(self, time: float) -> Array:
        """See :meth:`~.constraint_sets.constraint_set.Targets.at`."""
        return self._targets.at(time)

    def set_time(self, time: float) -> None:
        """Set the targets of ``time``; errors as for :meth:`targets`."""
        values = self.targets(time)
        for each in self.sets:
            each.targets[:] = values[each.own]

    def target_rates(self, time: float, step: float) -> tuple[Array, Array]:
        """See :meth:`~.constraint_sets.constraint_set.Targets.rates`."""
        return self._targets.rates(time, step)

    def follow(self, H: Array, h: Array) -> None:
        """See :meth:`~.constraint_sets.constraint_set.ConstraintSet.follow`."""
        for each in self.sets:
            each.follow(H, h)

    def check_branch(self, H: Array) -> None:
        """See :meth:`~.constraint_sets.constraint_set.ConstraintSet.check_branch`."""
        for each in self.sets:
            each.check_branch(H)

    @property
    def preloaded(self) -> bool:
        """Whether there are springs with a rest value of their own."""
        return any(each.preloaded for each in self.sets)

    def preload(self, H: Array, part: float) -> None:
        """See :meth:`~.constraint_sets.constraint_set.ConstraintSet.preload`."""
        if part != self._preload:
            self._preload = part
            for each in self.sets:
                if each.preloaded:
                    each.preload(H, part)

    def accept(self, H: Array) -> None:
        """Remember what frames do not tell of an accepted state: angles, places on beams.

        Raises:
            ValueError: Something slid off its beam.
        """
        for each in self.sets:
            each.accept(H)

    @property
    def memory(self) -> Array:
        """What the frames do not tell of the last accepted state: full turns, places on beams."""
        return np.concatenate(self._remembered())

    @memory.setter
    def memory(self, values: Array) -> None:
        parts = self._remembered()
        for part, value in zip(
            parts, np.split(values, np.cumsum([len(p) for p in parts])[:-1]), strict=True
        ):
            part[:] = value
        for each in self.sets:
            each.mark()

    def remember(self, values: Array | None) -> None:
        """Set :attr:`memory` to that of a run that this one goes on from, if there is one.

        Raises:
            ValueError: It is none of these joints.
        """
        if values is None:
            return
        wanted = self.memory.shape
        if values.shape != wanted:
            raise ValueError(
                f"a scene that goes on must have the joints of the one before: it remembers "
                f"{values.shape} angles of joints, wanted {wanted}"
            )
        self.memory = values

    @property
    def keyed_memory(self) -> dict[MemoryKey, float]:
        """:attr:`memory` by what its entries belong to, for other scenes with the same joints."""
        return dict(zip(self._memory_keys, map(float, self.memory), strict=True))

    def remembering(self, values: Mapping[MemoryKey, float]) -> Array:
        """:attr:`memory` of another scene for this one; what that did not have stays as it is."""
        pairs = zip(self._memory_keys, map(float, self.memory), strict=True)
        return np.array([values.get(key, own) for key, own in pairs])

    @property
    def _memory_keys(self) -> list[MemoryKey]:
        return [key for each in self.sets for part in each.memory_keys for key in part]

    def _remembered(self) -> list[Array]:
        return [part for each in self.sets for part in each.memory]

    # --- results ---

    @property
    def reported(self) -> tuple[Indices, Indices, Indices]:
        """Pairs of the first set and their sides whose forces results report; all owners."""
        return *self.first.reported, self.owner

    def report(self, H: Array, v: Array, multipliers: Array) -> tuple[Array, Array, Array]:
        """What results say of the items at twists ``v`` of the moving nodes.

        Returns:
            Force and moment of each on its point ``a``, in its axes there, shape (j, 6); relative
            coordinates of all, one after the other, shape (c,); the largest violation of a
            constraint of each, of position or velocity, shape (j,).
        """
        forces, coordinates = np.zeros((len(self.items), 6)), np.zeros(self._coordinates[-1])
        values, largest = np.zeros(self.m), np.zeros(len(self.items))
        for each in self.sets:
            each.wrenches(H, v, multipliers, forces)
            each.coordinates(H, coordinates)
            each.values(H, v, values)
        np.maximum.at(largest, self.owner, np.abs(values))
        return forces, coordinates, largest

    def info(self) -> tuple[JointInfo, ...]:
        """For results, in the numbering of all nodes."""
        drawn: dict[int, tuple[int, Array]] = {}
        for each in reversed(self.sets):
            drawn |= each.drawn()
        return tuple(self._info(k, *drawn[k]) for k in range(len(self.items)))

    def _info(self, k: int, row: int, place: Array) -> JointInfo:
        """Of item k, drawn at a place in the frame of a row."""
        item, masters = self.items[k], self._numbering.master_map.masters
        moves = row < len(masters)
        return JointInfo(
            name=item.label,
            kind="PrescribedMotion" if isinstance(item, _Carried) else type(item).__name__,
            node=int(masters[row]) if moves else -1,
            offset=place if moves else np.zeros(3),
            coordinates=item.coordinate_names,
            first=int(self._coordinates[k]),
        )


def _joined(parts: Sequence[Incidences]) -> Incidences:
    """Of constraints one after the other."""
    lengths = [np.diff(incidences.ptr) for incidences in parts]
    ptr = np.cumsum(np.concatenate([[0], *lengths]), dtype=np.int64)
    return Incidences(
        ptr, np.concatenate([incidences.nodes for incidences in parts]).astype(np.int64)
    )
