"""All joints, springs, drives, gears and prescribed motions of a scene: one object for the system.

Constraints of joints come first, then those of what slides along beams, then those of velocities.
"""

from __future__ import annotations

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Indices, at_time
from fem_lie.bodies.catalogue import JointInfo
from fem_lie.joints import Connection, Fixed, Joint
from fem_lie.joints.equations import rolling, sliding, terms
from fem_lie.joints.equations.functions import DISTANCE
from fem_lie.joints.equations.table import PackedJoints, views
from fem_lie.joints.histories import declared, until_next
from fem_lie.scene import Scene
from fem_lie.system.joint_tables import Pair, Tables
from fem_lie.system.nodes.numbering import Numbering
from fem_lie.system.outer_forces import joint_reactions

_FORWARD = np.array(
    [
        [-137 / 60, 5, -5, 10 / 3, -5 / 4, 1 / 5],
        [15 / 4, -77 / 6, 107 / 6, -13, 61 / 12, -5 / 6],
    ]
)
"""First and second derivative of a polynomial of fifth degree from values at 0, 1, … 5."""


class _Carried(Fixed):
    """To a prescribed motion; its axes are those of the node that is moved."""

    def frame(self) -> Array:
        """That of the node that is moved."""
        return self.a.frame


class Connections:
    """Numbers the constraints, evaluates them, and says what results report of them.

    Attributes:
        items: Joints, what acts along them, and prescribed motions as fixed joints.
        table: Of constraints of joints, and springs; ``packed``: the same for calls from Python.
        sliding: Of what slides along beams.
        rolling: Of constraints of velocities, ``of_velocities`` at the end.
        border: Which nodes the constraints touch.
        owner: The item of each constraint, shape (m,).
        m: Number of all constraints.
        probes: A table whose constraints are the coordinates that results report;
            ``packed_probes``: the same.
    """

    def __init__(self, scene: Scene, numbering: Numbering, frames: Array, held: Flags) -> None:
        """Build the tables.

        Args:
            scene: What there is.
            numbering: Of its nodes.
            frames: Initial frames of all rows: moving nodes, ground, prescribed motions.
            held: Which unknowns of the moving nodes are zero, shape (n, 6).
        """
        tables = Tables(numbering, frames, held)
        self._numbering, self._frames = numbering, frames
        self.items: list[Connection] = [*scene.joints, *scene.connections]
        motions = [
            _Carried(motion.point, motion.point, name=f"motion of {motion.point.label}")
            for motion in scene.motions
        ]
        self.items += motions
        sizes = np.array([item.size for item in self.items], dtype=np.int64)
        first = np.cumsum(sizes) - sizes
        groups = [
            [tables.pair(tie, int(row)) for tie in item.ties()]
            for item, row in zip(self.items, first, strict=True)
        ]
        for k in range(len(motions)):
            j = len(self.items) - len(motions) + k
            (pair,) = groups[j]
            groups[j] = [pair._replace(nodes=(pair.nodes[0], numbering.count + 1 + k))]
        self._number(tables, groups, sizes)
        self._drives = [
            (int(np.flatnonzero(self.owner == k)[-1]), item.history)
            for k, item in enumerate(self.items)
            if item.history is not None
        ]
        self._breaks = declared((history for _, history in self._drives), kinks=True)
        self._base = np.zeros(self.m)
        self._base[: len(self.table.targets)] = self._initial()
        self.set_time(0.0)
        counts = np.array([len(group) for group in groups], dtype=np.int64)
        self._tied = np.flatnonzero(counts)
        self._reported = (np.cumsum(counts) - counts)[self._tied]
        exchanged = [groups[k][0].exchanged for k in self._tied]
        self._exchanged = np.array(exchanged, dtype=np.int64)
        coordinates = [c.tie for item in self.items for c in item.coordinates()]
        names = [len(item.coordinate_names) for item in self.items]
        slides = np.repeat(np.isin(np.arange(len(names)), self._slides), names)
        self._place_probes, self._place_slides = np.flatnonzero(~slides), np.flatnonzero(slides)
        probes = [tables.pair(tie, row) for row, tie in enumerate(coordinates)]
        self.packed_probes: PackedJoints = tables.joints(probes, len(probes), [])
        self.probes = views(self.packed_probes)
        self._turns = bool(self.table.functions.any() or self.probes.functions.any())

    def _number(self, tables: Tables, groups: list[list[Pair]], sizes: Indices) -> None:
        """Constraints of joints, of what slides along beams, and of velocities."""
        pairs = [pair for group in groups for pair in group]
        slides = [(k, t) for k, item in enumerate(self.items) if (t := item.sliding_tie())]
        rolls = [(k, tie) for k, item in enumerate(self.items) for tie in item.velocity_ties()]
        touched: list[set[int]] = [set() for _ in range(int(sizes.sum()))]
        for pair in pairs:
            for row in pair.rows:
                if row >= 0:
                    touched[row].update(pair.nodes)
        owner = list(np.repeat(np.arange(len(sizes)), sizes))
        joints = len(owner)
        for k, slide in slides:
            owner += [k] * len(slide.selection)
            touched += [tables.sliding_nodes(slide)] * len(slide.selection)
        positions = len(owner)
        for k, roll in rolls:
            owner += [k] * len(roll.selection)
            touched += [set(tables.nodes(roll.a, roll.b))] * len(roll.selection)
        self.owner: Indices = np.array(owner, dtype=np.int64)
        self.m, self.of_velocities = len(owner), len(owner) - positions
        self.border = tables.border(touched)
        springs = [item.spring for item in self.items if item.spring is not None]
        self.packed = tables.joints(pairs, joints, springs, self.border)
        self.table = views(self.packed)
        self.sliding = tables.sliding([tie for _, tie in slides], joints, self.border)
        self.rolling = tables.rolling([tie for _, tie in rolls], positions, self.border)
        self._slides = np.array([k for k, _ in slides], dtype=np.int64)
        self._rolls = np.array([k for k, _ in rolls], dtype=np.int64)

    def _initial(self) -> Array:
        """Targets of what keeps its initial value: those of drives without history and of gears."""
        values = np.zeros(len(self.table.targets))
        terms.violations(self._frames, self.table, values)
        keeps = [not isinstance(self.items[k], Joint) for k in self.owner[: len(values)]]
        return np.where(keeps, values, 0.0)

    @property
    def angular(self) -> Flags:
        """Which constraints are angles and not lengths, shape (m,)."""
        table, angular = self.table, np.ones(self.m, dtype=bool)
        lengths = table.selection[:, :3].any(axis=1) | (table.functions[:, DISTANCE] != 0.0)
        # of a gear the first term says so: a ratio converts the second
        rows, first = np.unique(table.rows, return_index=True)
        angular[rows[lengths[first] & (rows < len(table.targets))]] = False
        slides, positions = self.sliding.selection, self.m - self.of_velocities
        places = slides[:, :3].any(axis=1) | (self.sliding.advance != 0.0)
        angular[len(table.targets) : positions] = ~places
        # an edge binds a velocity of a place, a disc both
        angular[positions:] = False
        return angular

    @property
    def joined(self) -> Flags:
        """Which constraints go on from the one before, shape (m,).

        Those of one item along lengths are one vector, and those of its angles another, whose size
        does not depend on the joint's axes.
        """
        same = np.diff(self.owner, prepend=-1) == 0
        return same & (np.diff(self.angular.astype(np.int8), prepend=-1) == 0)

    # --- equations ---

    @property
    def of_joints_only(self) -> bool:
        """Whether there is nothing but what ``table`` has."""
        return self.m == len(self.table.targets)

    def add_others(
        self, H: Array, v: Array, weights: Array, scale: Array, factor: float, r: Array
    ) -> None:
        """Forces and violations of what ``table`` has not, to the residual ``r``.

        Violations are times ``scale``, those of velocities times ``factor``, too.
        """
        count = self._numbering.count
        sliding.evaluate(H, self.sliding, weights, scale, count, r)
        rolling.evaluate(H, v, self.rolling, weights, scale, factor, count, r)

    def reactions(self, H: Array, v: Array, weights: Array) -> tuple[Array, float]:
        """What ground and prescribed frames do on the joints, and what dampers take.

        Args:
            H: Frames of all rows.
            v: Twists of the moving nodes, shape (n, 6).
            weights: Multipliers, shape (m,).

        Returns:
            Forces and moments in the frames that do not move by themselves, shape (p + 1, 6), and
            the power lost.
        """
        rows, free = len(H), self._numbering.count
        r, scale = np.empty(6 * rows + self.m), np.ones(self.m)
        loss = joint_reactions(H, v, self.packed, weights, scale, r)
        if not self.of_joints_only:
            sliding.evaluate(H, self.sliding, weights, scale, rows, r)
            rolling.evaluate(H, v, self.rolling, weights, scale, 1.0, rows, r)
        return r[6 * free : 6 * rows].reshape(-1, 6), float(loss)

    @property
    def outward(self) -> bool:
        """Whether there are dampers, or joints with what does not move by itself."""
        free, ties = self._numbering.count, (self.table, self.sliding, self.rolling)
        grounded = any((tie.nodes >= free).any() for tie in ties)
        return grounded or bool(self.table.springs[:, 1].any())

    @property
    def present_targets(self) -> Array:
        """What the constraints are to be at the time that was set, shape (m,)."""
        still = np.zeros(self.of_velocities)
        return np.concatenate([self.table.targets, self.sliding.targets, still])

    def sliding_pairs(self) -> tuple[Indices, Indices]:
        """Rows and columns of node pairs: the frame and both ends, for each element, (e, 3, 3)."""
        table = self.sliding
        of = np.repeat(table.nodes, np.diff(table.elements))
        three = np.column_stack([of, table.ends])
        rows = np.repeat(three[:, :, np.newaxis], 3, axis=2)
        return rows, rows.transpose(0, 2, 1)

    def jacobian(self, H: Array, rows: Array) -> None:
        """Derivative of all constraints, or of their rates, at the border's legs, (legs, 6)."""
        rows[:] = 0.0
        terms.jacobian(H, self.table, rows)
        if not self.of_joints_only:
            sliding.jacobian(H, self.sliding, rows)
            rolling.jacobian(H, self.rolling, rows)

    def rates(self, H: Array, v: Array) -> tuple[Array, Array]:
        """First and second rates of constraints of positions, (m,), at constant twists and targets.

        Of constraints of velocities: what is bound, and its first rate.
        """
        first, second = np.zeros(self.m), np.zeros(self.m)
        terms.rates(H, v, self.table, first, second)
        rolling.rates(H, v, self.rolling, first, second)
        if len(self._slides):
            self._sliding_rates(H, v, first, second)
        return first, second

    def _sliding_rates(self, H: Array, v: Array, first: Array, second: Array) -> None:
        """Of what slides: the second by differences of the first along the motion."""
        border, rows = self.border, np.zeros((len(self.border.nodes), 6))
        speeds = np.abs(v[:, 3:]).max(), np.abs(v[:, :3]).max() / self.sliding.lengths.min()
        time = 1e-5 / max(float(max(speeds)), 1e-300)
        where = np.isin(
            border.rows, np.arange(len(self.table.targets), self.m - self.of_velocities)
        )
        for ahead in (0.0, time, -time):
            moved = H.copy()
            moved[: len(v)] = lie.se3_retract(H[: len(v)], ahead * v)
            rows[:] = 0.0
            sliding.jacobian(moved, self.sliding, rows)
            work = np.einsum("lk,lk->l", rows, v[border.nodes])[where]
            rate = np.bincount(border.rows[where], work, minlength=self.m)
            if ahead == 0.0:
                first += rate
            else:
                second += rate / (2.0 * ahead)

    # --- time ---

    @property
    def driven(self) -> bool:
        """Whether targets depend on time."""
        return bool(self._drives)

    def targets(self, time: float) -> Array:
        """What the constraints are to be at ``time``, shape (m,).

        Raises:
            ValueError: A drive is not finite then.
        """
        values = self._base.copy()
        for row, history in self._drives:
            values[row] = at_time(history, time, self.items[self.owner[row]].label)
            if not np.isfinite(values[row]):
                label = self.items[self.owner[row]].label
                raise ValueError(f"{label} is {values[row]} at time {time:g}")
        return values

    def set_time(self, time: float) -> None:
        """Set the targets of ``time``; errors as for :meth:`targets`."""
        values, k = self.targets(time), len(self.table.targets)
        self.table.targets[:] = values[:k]
        self.sliding.targets[:] = values[k : self.m - self.of_velocities]

    def target_rates(self, time: float, step: float) -> tuple[Array, Array]:
        """First and second rates of the targets, (m,), at ``time``, by five later times.

        These lie before the next jump, and so may be nearer than ``step``.
        """
        step = min(step, until_next(self._breaks, time) / 5.0)
        values = [self.targets(time + k * step) for k in range(6)]
        first, second = np.tensordot(_FORWARD, values, axes=1)
        return first / step, second / step**2

    def accept(self, H: Array) -> None:
        """Remember angles and places on beams of an accepted state.

        Raises:
            ValueError: Something slid off its beam.
        """
        if len(self._slides):
            sliding.state(H, self.sliding, self.sliding.arclength, np.zeros(self.m))
            self._check_on_beams()
        if self._turns:
            terms.unwrap_both(H, self.packed, self.packed_probes)

    def _check_on_beams(self) -> None:
        table, last = self.sliding, self.sliding.elements[1:] - 1
        ends = table.starts[last] + table.lengths[last]
        off = (table.arclength < 0.0) | (table.arclength > ends)
        if off.any():
            k = int(np.flatnonzero(off)[0])
            label = self.items[self._slides[k]].label
            raise ValueError(
                f"{label} slid off its beam: arclength {table.arclength[k]:g} of {ends[k]:g}"
            )

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

    def _remembered(self) -> tuple[Array, ...]:
        return self.table.turned, self.probes.turned, self.sliding.arclength

    # --- results ---

    @property
    def reported(self) -> tuple[Indices, Indices, Indices]:
        """Pairs and their sides whose forces results report, and the item of each constraint."""
        return self._reported, self._exchanged, self.owner

    def report(self, H: Array, v: Array, weights: Array) -> tuple[Array, Array, Array]:
        """What results say of the items at twists ``v`` of the moving nodes.

        Returns:
            Force and moment of each on its point ``a``, in its axes there, shape (j, 6); relative
            coordinates of all, one after the other, shape (c,); the largest violation of a
            constraint of each, of position or velocity, shape (j,).
        """
        forces: Array = np.empty((len(self._tied), 6))
        coordinates: Array = np.empty(len(self.probes.targets))
        values, largest = np.zeros(self.m), np.zeros(len(self.items))
        found = forces, coordinates, values, largest
        terms.report(H, v, self.packed, self.packed_probes, weights, *self.reported, *found)
        if not self.of_joints_only:
            forces, coordinates = self._report_others(H, v, weights, forces, coordinates, values)
            np.maximum.at(largest, self.owner, np.abs(values))
        return forces, coordinates, largest

    def _report_others(
        self, H: Array, v: Array, weights: Array, tied: Array, probed: Array, values: Array
    ) -> tuple[Array, Array]:
        """Forces and coordinates of all items; sets the ``values`` of their constraints."""
        forces, k = np.zeros((len(self.items), 6)), len(self.table.targets)
        forces[self._tied] = tied
        sliding.wrenches(H, self.sliding, weights, self._slides, forces)
        rolling.wrenches(H, self.rolling, weights, self._rolls, forces)
        others, places = np.zeros(self.m), np.empty(len(self._slides))
        rolling.rates(H, v, self.rolling, others, np.zeros(self.m))
        sliding.state(H, self.sliding, places, others)
        values[k:] = others[k:]
        coordinates = np.empty(len(probed) + len(places))
        coordinates[self._place_probes], coordinates[self._place_slides] = probed, places
        return forces, coordinates

    def info(self) -> tuple[JointInfo, ...]:
        """For results, in the numbering of all nodes."""
        first = np.cumsum([0] + [len(item.coordinate_names) for item in self.items])
        joints = []
        pairs = {int(k): int(pair) for k, pair in zip(self._tied, self._reported, strict=True)}
        sliders = {int(k): j for j, k in enumerate(self._slides)}
        for k, item in enumerate(self.items):
            slides = k in sliders
            node, offset = self._drawn_slider(sliders[k]) if slides else self._drawn_pair(pairs[k])
            joints.append(
                JointInfo(
                    name=item.label,
                    kind="PrescribedMotion" if isinstance(item, _Carried) else type(item).__name__,
                    node=node,
                    offset=offset,
                    coordinates=item.coordinate_names,
                    first=int(first[k]),
                )
            )
        return tuple(joints)

    def _drawn_slider(self, j: int) -> tuple[int, Array]:
        """Node that what slides is drawn at, and where in its frame."""
        leaders = self._numbering.attachment.leaders
        node, offset = int(self.sliding.nodes[j]), self.sliding.frames[j, 0]
        return (int(leaders[node]), offset) if node < len(leaders) else (-1, np.zeros(3))

    def _drawn_pair(self, pair: int) -> tuple[int, Array]:
        """The same of a pair of frames: on its side A, or on B if A is ground."""
        leaders, table = self._numbering.attachment.leaders, self.table
        side = int(table.nodes[pair, 0] >= self._numbering.count)
        return int(leaders[table.nodes[pair, side]]), table.frames[pair, side, 0]


def refuse(redundant: Indices, connections: Connections) -> None:
    """Raise ``ValueError`` that names the joints of redundant constraints if there are any."""
    if len(redundant):
        owner = dict.fromkeys(connections.owner[redundant])
        names = "; ".join(connections.items[int(k)].label for k in owner)
        raise ValueError(
            f"{len(redundant)} of {len(connections.owner)} constraints are redundant, they follow "
            f"from the other joints and clamps: {names}. Replace a joint by one with fewer "
            "constraints (e.g. Spherical instead of Revolute) or remove it, or see "
            "Scene(redundant=...)"
        )
