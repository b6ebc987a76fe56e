"""All joints, springs, drives, gears and prescribed motions of a scene: one object for the system.

Constraints of positions come first, then those of velocities.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from fem_lie import constraints, rolling
from fem_lie._jit import Array, Indices
from fem_lie.info import JointInfo
from fem_lie.joint_functions import DISTANCE
from fem_lie.joints import Connection, Fixed, Joint
from fem_lie.numbering import Numbering
from fem_lie.scene import Scene
from fem_lie.tables import Pair, Tables

Flags = npt.NDArray[np.bool_]

_FORWARD = np.array(
    [
        [-137 / 60, 5, -5, 10 / 3, -5 / 4, 1 / 5],
        [15 / 4, -77 / 6, 107 / 6, -13, 61 / 12, -5 / 6],
    ]
)
"""First and second derivative of a polynomial of fifth degree from values at 0, 1, … 5."""


class Connections:
    """Numbers the constraints, evaluates them, and says what results report of them.

    Attributes:
        items: Joints, what acts along them, and prescribed motions as fixed joints.
        table: Of constraints of positions, and springs.
        rolling: Of constraints of velocities.
        border: Which nodes the constraints touch.
        owner: The item of each constraint, shape (m,).
        m: Number of all constraints.
        probes: A table whose constraints are the coordinates that results report.
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
            Fixed(motion.point, motion.point, name=f"motion of {motion.point.label}")
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
            (int(first[k]), item.history)
            for k, item in enumerate(self.items)
            if item.history is not None
        ]
        self.table.targets[:] = self._initial()
        counts = np.array([len(group) for group in groups], dtype=np.int64)
        self._reported = np.cumsum(counts) - counts
        self._exchanged = np.array([group[0].exchanged for group in groups], dtype=np.int64)
        coordinates = [c.tie for item in self.items for c in item.coordinates()]
        probes = [tables.pair(tie, row) for row, tie in enumerate(coordinates)]
        self.probes = tables.joints(probes, len(probes), [])
        self._turns = bool(self.table.functions.any() or self.probes.functions.any())

    def _number(self, tables: Tables, groups: list[list[Pair]], sizes: Indices) -> None:
        """Constraints of positions, then those of velocities."""
        pairs = [pair for group in groups for pair in group]
        ties = [(k, tie) for k, item in enumerate(self.items) for tie in item.velocity_ties()]
        counts = [len(tie.selection) for _, tie in ties]
        positions = np.repeat(np.arange(len(sizes)), sizes)
        velocities = np.repeat(np.array([k for k, _ in ties], dtype=np.int64), counts)
        self.owner: Indices = np.concatenate([positions, velocities]).astype(np.int64)
        self.m = len(self.owner)
        touched: list[set[int]] = [set() for _ in range(self.m)]
        for pair in pairs:
            for row in pair.rows:
                if row >= 0:
                    touched[row].update(pair.nodes)
        row = len(positions)
        for _, tie in ties:
            for _ in range(len(tie.selection)):
                touched[row].update(tables.nodes(tie.a, tie.b))
                row += 1
        self.border = tables.border(touched)
        springs = [item.spring for item in self.items if item.spring is not None]
        self.table = tables.joints(pairs, len(positions), springs, self.border)
        self.rolling = tables.rolling([tie for _, tie in ties], len(positions), self.border)
        self._rolls = np.array([k for k, _ in ties], dtype=np.int64)

    def _initial(self) -> Array:
        """Targets of what keeps its initial value: those of drives without history and of gears."""
        values = np.zeros(len(self.table.targets))
        constraints.violations(self._frames, self.table, values)
        keeps = [not isinstance(self.items[k], Joint) for k in self.owner[: len(values)]]
        return np.where(keeps, values, 0.0)

    @property
    def angular(self) -> Flags:
        """Which constraints are of rotations alone, shape (m,)."""
        table, angular = self.table, np.ones(self.m, dtype=bool)
        lengths = table.selection[:, :3].any(axis=1) | (table.functions[:, DISTANCE] != 0.0)
        angular[table.rows[lengths & (table.rows < len(table.targets))]] = False
        # an edge binds a velocity of a place, a disc both
        angular[len(table.targets) :] = False
        return angular

    # --- equations ---

    @property
    def of_velocities(self) -> int:
        """Number of constraints of velocities, the last ones."""
        return self.m - len(self.table.targets)

    def add_velocity_constraints(
        self, H: Array, v: Array, weights: Array, scale: Array, factor: float, r: Array
    ) -> None:
        """Their forces and, times ``scale · factor``, their violations to the residual ``r``."""
        rolling.evaluate(H, v, self.rolling, weights, scale, factor, self._numbering.count, r)

    def jacobian(self, H: Array, rows: Array) -> None:
        """Derivative of all constraints, or of their rates, at the border's legs, (legs, 6)."""
        rows[:] = 0.0
        constraints.jacobian(H, self.table, rows)
        if self.of_velocities:
            rolling.jacobian(H, self.rolling, rows)

    def rates(self, H: Array, v: Array) -> tuple[Array, Array]:
        """First and second rates of constraints of positions, (m,), at constant twists and targets.

        Of constraints of velocities: what is bound, and its first rate.
        """
        first, second = np.zeros(self.m), np.zeros(self.m)
        constraints.rates(H, v, self.table, first, second)
        rolling.rates(H, v, self.rolling, first, second)
        return first, second

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
        values = self.table.targets.copy()
        for row, history in self._drives:
            values[row] = history(time)
            if not np.isfinite(values[row]):
                label = self.items[self.owner[row]].label
                raise ValueError(f"{label} is {values[row]} at time {time:g}")
        return values

    def target_rates(self, time: float, step: float) -> tuple[Array, Array]:
        """First and second rates of the targets, (m,), at ``time``, by five later times."""
        values = [self.targets(time + k * step) for k in range(6)]
        rates = np.zeros((2, self.m))
        rates[:, : len(self.table.targets)] = np.tensordot(_FORWARD, values, axes=1)
        return rates[0] / step, rates[1] / step**2

    def accept(self, H: Array) -> None:
        """Remember the angles of an accepted state."""
        if self._turns:
            constraints.unwrap(H, self.table)
            constraints.unwrap(H, self.probes)

    # --- results ---

    def forces(self, H: Array, v: Array, weights: Array) -> Array:
        """Force and moment of each item on its point ``a``, in its axes there, shape (j, 6)."""
        forces = np.empty((len(self.items), 6))
        constraints.wrenches(H, v, self.table, weights, self._reported, self._exchanged, forces)
        rolling.wrenches(H, self.rolling, weights, self._rolls, forces)
        return forces

    def coordinates(self, H: Array) -> Array:
        """Relative coordinates of all items, one after the other, shape (c,)."""
        values = np.empty(len(self.probes.targets))
        constraints.violations(H, self.probes, values)
        return values

    def violations(self, H: Array, v: Array) -> Array:
        """Largest violation of a constraint of each item, of position or velocity, shape (j,)."""
        values, largest = np.zeros(self.m), np.zeros(len(self.items))
        if self.of_velocities:
            rolling.rates(H, v, self.rolling, values, np.zeros(self.m))
        constraints.violations(H, self.table, values)
        np.maximum.at(largest, self.owner, np.abs(values))
        return largest

    def info(self) -> tuple[JointInfo, ...]:
        """For results, in the numbering of all nodes."""
        leaders, table = self._numbering.attachment.leaders, self.table
        first = np.cumsum([0] + [len(item.coordinates()) for item in self.items])
        joints = []
        for k, item in enumerate(self.items):
            pair = self._reported[k]
            # drawn on its side A, or on B if A is ground
            side = int(table.nodes[pair, 0] >= self._numbering.count)
            joints.append(
                JointInfo(
                    name=item.label,
                    kind=type(item).__name__,
                    node=int(leaders[table.nodes[pair, side]]),
                    offset=table.frames[pair, side, 0],
                    coordinates=tuple(c.name for c in item.coordinates()),
                    first=int(first[k]),
                )
            )
        return tuple(joints)
