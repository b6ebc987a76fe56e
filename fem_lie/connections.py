"""All joints, springs, drives, gears and prescribed motions of a scene as tables of numbers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from fem_lie import constraints, lie
from fem_lie._jit import Array, Indices
from fem_lie.constraints import JointTable
from fem_lie.info import JointInfo
from fem_lie.joint_functions import DISTANCE
from fem_lie.joints import Connection, Fixed, Joint, Tie
from fem_lie.numbering import Numbering
from fem_lie.scene import Scene

Flags = npt.NDArray[np.bool_]


class Border(NamedTuple):
    """Which moving nodes each constraint touches: its legs, in the order of the nodes.

    Attributes:
        ptr: First leg of each constraint and their number at the end, shape (m + 1,).
        nodes: Node of each leg.
    """

    ptr: Indices
    nodes: Indices

    @property
    def rows(self) -> Indices:
        """Constraint of each leg."""
        return np.repeat(np.arange(len(self.ptr) - 1), np.diff(self.ptr))

    @classmethod
    def of(cls, touched: Sequence[set[int]], count: int) -> Border:
        """From the nodes of each constraint; those from ``count`` on do not move."""
        legs = [sorted(node for node in nodes if node < count) for nodes in touched]
        ptr = np.concatenate([[0], np.cumsum([len(nodes) for nodes in legs], dtype=np.int64)])
        nodes = np.array([node for group in legs for node in group], dtype=np.int64)
        return cls(ptr.astype(np.int64), nodes)

    def leg(self, row: int, node: int) -> int:
        """Of a constraint at a node, −1 if the node does not move."""
        nodes = self.nodes[self.ptr[row] : self.ptr[row + 1]]
        found = np.flatnonzero(nodes == node)
        return int(self.ptr[row] + found[0]) if len(found) else -1


_FORWARD = np.array(
    [
        [-137 / 60, 5, -5, 10 / 3, -5 / 4, 1 / 5],
        [15 / 4, -77 / 6, 107 / 6, -13, 61 / 12, -5 / 6],
    ]
)
"""First and second derivative of a polynomial of fifth degree from values at 0, 1, … 5."""


class _Pair(NamedTuple):
    """A tie between two nodes, perhaps with its sides exchanged."""

    tie: Tie
    nodes: tuple[int, int]
    exchanged: bool


class Connections:
    """Numbers the constraints, and says what results report of them.

    Attributes:
        items: Joints, what acts along them, and prescribed motions as fixed joints.
        table: Of constraints and springs.
        border: Which nodes the constraints touch.
        owner: The item of each constraint, shape (m,).
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
        self._numbering, self._frames = numbering, frames
        self._still = np.append(held.all(axis=1), [True] * (len(frames) - numbering.count))
        self.items: list[Connection] = [*scene.joints, *scene.connections]
        groups = [[self._pair(tie) for tie in item.ties()] for item in self.items]
        for k, motion in enumerate(scene.motions):
            point = motion.point
            joint = Fixed(point, point, name=f"motion of {point.label}")
            nodes = (numbering.node(point), numbering.count + 1 + k)
            self.items.append(joint)
            groups.append([_Pair(joint.ties()[0], nodes, False)])
        sizes = [item.size for item in self.items]
        self.owner: Indices = np.repeat(np.arange(len(sizes)), np.array(sizes, dtype=np.int64))
        springs = [item.spring for item in self.items]
        self.table, self.border = self._tabulate(groups, sizes, springs)
        self._drives = [
            (int(np.searchsorted(self.owner, k)), item.history)
            for k, item in enumerate(self.items)
            if item.history is not None
        ]
        self.table.targets[:] = self._initial()
        self._reported = np.array([len(group) for group in groups], dtype=np.int64).cumsum()
        self._reported -= np.array([len(group) for group in groups], dtype=np.int64)
        self._exchanged = np.array([group[0].exchanged for group in groups], dtype=np.int64)
        probes = [self._pair(c.tie) for item in self.items for c in item.coordinates()]
        self.probes, _ = self._tabulate([[pair] for pair in probes], [1] * len(probes))
        self._turns = bool(self.table.functions.any() or self.probes.functions.any())

    # --- tables ---

    def _pair(self, tie: Tie) -> _Pair:
        """With a side that moves as A: what touches ``Δ`` alone has a constant Jacobian there."""
        nodes = self._numbering.node(tie.a), self._numbering.node(tie.b)
        if tie.reversible and self._still[nodes[0]] and not self._still[nodes[1]]:
            return _Pair(tie.exchanged(), nodes[::-1], True)
        return _Pair(tie, nodes, False)

    def _tabulate(
        self,
        groups: Sequence[Sequence[_Pair]],
        sizes: Sequence[int],
        springs: Sequence[tuple[float, float, float] | None] = (),
    ) -> tuple[JointTable, Border]:
        """Pairs, terms and constraints of the items, one after the other."""
        starts, m = np.cumsum([0, *sizes]), sum(sizes)
        given = [spring for spring in springs if spring is not None]
        touched: list[set[int]] = [set() for _ in range(m)]
        pairs, rows, spring = [], [], m
        for k, group in enumerate(groups):
            for pair in group:
                pairs.append(pair)
                for local in pair.tie.rows:
                    rows.append(int(starts[k]) + local if local >= 0 else spring)
                    spring += local < 0
                    if local >= 0:
                        touched[rows[-1]].update(pair.nodes)
        border = Border.of(touched, self._numbering.count)
        terms = [pair for pair in pairs for _ in pair.tie.rows]
        legs = [
            [border.leg(row, node) if row < m else -1 for node in pair.nodes]
            for row, pair in zip(rows, terms, strict=True)
        ]
        functions = _stacked([pair.tie.functions for pair in pairs], (0, 3))
        return JointTable(
            nodes=np.array([pair.nodes for pair in pairs], dtype=np.int64).reshape(-1, 2),
            frames=np.array([self._in_nodes(pair) for pair in pairs]).reshape(-1, 2, 4, 3),
            first=np.cumsum([0] + [len(pair.tie.rows) for pair in pairs], dtype=np.int64),
            selection=_stacked([pair.tie.selection for pair in pairs], (0, 12)),
            functions=functions,
            rows=np.array(rows, dtype=np.int64),
            legs=np.array(legs, dtype=np.int64).reshape(-1, 2),
            angle=np.array([pair.tie.angle for pair in pairs]).reshape(-1, 2, 12),
            curved=np.array([pair.tie.functions.any() for pair in pairs], dtype=bool),
            turned=np.zeros(len(pairs)),
            targets=np.zeros(m),
            springs=np.array(given, dtype=np.float64).reshape(-1, 3),
        ), border

    def _in_nodes(self, pair: _Pair) -> list[Array]:
        """Frames of a pair in those of its nodes."""
        return [
            lie.se3_compose(lie.se3_inverse(self._frames[node]), frame)
            for node, frame in zip(pair.nodes, pair.tie.frames, strict=True)
        ]

    def _initial(self) -> Array:
        """Targets of what keeps its initial value: those of drives without history and of gears."""
        values = np.zeros(len(self.owner))
        constraints.violations(self._frames, self.table, values)
        keeps = [not isinstance(self.items[k], Joint) for k in self.owner]
        return np.where(keeps, values, 0.0)

    @property
    def angular(self) -> Flags:
        """Which constraints are of rotations alone, shape (m,)."""
        table, angular = self.table, np.ones(len(self.owner), dtype=bool)
        lengths = table.selection[:, :3].any(axis=1) | (table.functions[:, DISTANCE] != 0.0)
        angular[table.rows[lengths & (table.rows < len(angular))]] = False
        return angular

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
        """First and second rates of the targets at ``time``, by five later times."""
        values = [self.targets(time + k * step) for k in range(6)]
        first, second = np.tensordot(_FORWARD, values, axes=1)
        return first / step, second / step**2

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
        return forces

    def coordinates(self, H: Array) -> Array:
        """Relative coordinates of all items, one after the other, shape (c,)."""
        values = np.empty(len(self.probes.targets))
        constraints.violations(H, self.probes, values)
        return values

    def violations(self, H: Array) -> Array:
        """Largest violation of a constraint of each item, shape (j,)."""
        values, largest = np.zeros(len(self.owner)), np.zeros(len(self.items))
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


def _stacked(parts: Sequence[Array], shape: tuple[int, int]) -> Array:
    return np.concatenate([np.empty(shape), *parts])
