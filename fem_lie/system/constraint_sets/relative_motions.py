"""Constraints, springs and dampers in the relative motion of two frames: most joints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.joints.connection import Connection, ConstraintDefinition, LostBranchError
from fem_lie.joints.equations import friction, terms, turns
from fem_lie.joints.equations.functions import ANGLE, COUNT, DISTANCE
from fem_lie.joints.equations.joint_arrays import JointArrays, PackedJoints, pack, views
from fem_lie.joints.equations.turns import spring_changes
from fem_lie.joints.joint import Joint
from fem_lie.joints.laws import ForceLawError
from fem_lie.linear.saddle_point import Incidences
from fem_lie.system.constraint_sets.constraint_set import (
    ConstrainedFrames,
    ConstraintSet,
    HistoryKey,
    Numbered,
    Place,
    Start,
    initial_frames,
    places,
    relative_frames,
    stacked,
)

_QUARTER = 0.5 * np.pi * (1.0 + 1e-9)
"""Largest change of an angle in one step, rad: half of what frames distinguish."""


class Branches:
    """Reference angles of pairs of frames in a step, and alignment of constrained axes."""

    def __init__(
        self, arrays: JointArrays, probes: JointArrays, labels: Sequence[str], item: Indices
    ) -> None:
        """Store the arrays of both sets.

        Args:
            arrays: Table of constraints and springs.
            probes: Table of the coordinates in results.
            labels: Names of items in messages.
            item: Item of each pair of ``arrays``, shape (j,).
        """
        self._table, self._probes = arrays, probes
        self._labels, self._item = labels, item
        self._accepted = arrays.turned.copy()
        bound = arrays.rows < len(arrays.targets)
        ends = list(zip(arrays.first[:-1], arrays.first[1:], strict=True))
        self._counted: Flags = np.array(
            [arrays.functions[a:b, ANGLE].any() for a, b in ends], dtype=bool
        )
        self._aligned = np.array(
            [turns.fixed_rotations(arrays.selection[a:b, 3:][bound[a:b]]) for a, b in ends]
        ).reshape(-1, 3, 3)
        self._any_aligned = bool(self._aligned.any())

    def move_reference_angles(self, H: Array, h: Array) -> None:
        """Move reference angles along the increment ``h`` (n, 6) of nodes, made from ``H``."""
        turns.foresee(H, h, self._table)
        turns.foresee(H, h, self._probes)

    def mark(self) -> None:
        """Take the reference angles as those of the accepted state."""
        self._accepted[:] = self._table.turned

    def check(self, H: Array) -> None:
        """Refuse a state in which an angle or axis may be on a wrong branch.

        Raises:
            LostBranchError: An angle has changed by more than a quarter turn, or axes are opposite.
        """
        arrays = self._table
        if self._counted.any():
            angles = np.empty(len(arrays.nodes))
            turns.angles(H, arrays, angles)
            change = np.where(self._counted, np.abs(angles - self._accepted), 0.0)
            self._refuse(change > _QUARTER, "rotates by more than a quarter turn in one step")
        if self._any_aligned:
            found = np.empty(len(arrays.nodes))
            turns.alignments(H, arrays, self._aligned, found)
            self._refuse(found < -0.5, "is half a turn away from where its axes are aligned")

    def _refuse(self, lost: Flags, how: str) -> None:
        if lost.any():
            raise LostBranchError(f"{self._labels[self._item[int(lost.argmax())]]} {how}")


class Pair(NamedTuple):
    """A constraint definition between two rows, perhaps with its sides exchanged.

    Attributes:
        definition: The definition.
        nodes: Rows of its sides A and B.
        rows: Constraint of each term, −1 for that of a spring.
        exchanged: Whether side A of the user is side B here.
    """

    definition: ConstraintDefinition
    nodes: tuple[int, int]
    rows: Sequence[int]
    exchanged: bool


class _Spring(NamedTuple):
    """A spring, damper, force law or friction along one term.

    Attributes:
        item: The connection.
        address: Address of its force law, 0: none.
        data: Data of its law or friction.
        joint: First pair of the joint whose friction it is, −1: none.
        bearing: Side of this pair to which the bearing is fixed.
    """

    item: Connection
    address: int
    data: Array
    joint: int
    bearing: int

    @classmethod
    def of(cls, item: Connection, pair: Pair, first_pair: Mapping[Connection, int]) -> _Spring:
        """The spring of a pair of an item, with the first pairs of all items of the set."""
        law, friction = item.force_law, item.friction
        if friction is not None:
            side = 0 if pair.exchanged else 1
            return cls(item, 0, friction.data, first_pair[friction.joint], side)
        if law is None:
            return cls(item, 0, np.empty(0), -1, 0)
        return cls(item, law.address, law.data, -1, 0)


class RelativeMotions(ConstraintSet):
    """First set of constraints, in relative motions, see :mod:`fem_lie.joints.equations.terms`.

    Attributes:
        arrays: Packed constraints and springs; ``packed``: the same for calls from Python.
        probes: Table whose constraints are the coordinates in results; ``packed_probes``: likewise.
        probed: Numbers of these among the coordinates of all sets, increasing, (p,).
        turns: Whether any angle is counted beyond a full turn.
        reported: Pairs whose forces results report, the side of each, and the item to whose force
            it adds.
    """

    what = "joints"

    def __init__(
        self, items: Sequence[Numbered], constrained: ConstrainedFrames, start: Start
    ) -> None:
        """Build the arrays of all definitions."""
        assert start.row == 0, "compiled sums over all nodes count its constraints from zero"
        self.start, self._count = start, constrained.count
        sizes = np.array([item.size for item, _, _ in items], dtype=np.int64)
        numbers = np.array([number for _, number, _ in items], dtype=np.int64)
        first = np.cumsum(sizes) - sizes
        groups = [
            [_pair(constrained, definition, int(row)) for definition in item.definitions()]
            for (item, _, _), row in zip(items, first, strict=True)
        ]
        pairs = [pair for group in groups for pair in group]
        touched: list[set[int]] = [set() for _ in range(int(sizes.sum()))]
        for pair in pairs:
            for row in pair.rows:
                if row >= 0:
                    touched[row].update(pair.nodes)
        self.owner = np.repeat(numbers, sizes)
        self.incidences = Incidences.of(touched, constrained.count)
        at = np.cumsum([0, *map(len, groups)])
        first_pair = {item: int(k) for (item, _, _), k in zip(items, at[:-1], strict=True)}
        springs = [
            _Spring.of(item, pair, first_pair)
            for (item, _, _), group in zip(items, groups, strict=True)
            for pair in group
            for row in pair.rows
            if row < 0
        ]
        self._has_friction = any(item.friction is not None for item, _, _ in items)
        self.laws = [
            (item.label, item.force_law) for item, _, _ in items if item.force_law is not None
        ]
        self.packed = _packed(constrained, pairs, self.m, springs, self.incidences, start.incidence)
        self.arrays = views(self.packed)
        points = [point for pair in pairs for point in (pair.definition.a, pair.definition.b)]
        self._initial = initial_frames(constrained, points)
        self.targets = self.arrays.targets
        # without definitions the compiled functions are not called: compiling them takes seconds
        self._ties = len(self.arrays.nodes) > 0
        self.angular = self._angles()
        a, b = self.arrays.nodes.T
        sides = np.stack([a, b], axis=1)
        self.pairs = (
            np.repeat(sides[:, :, np.newaxis], 2, axis=2),
            np.repeat(sides[:, np.newaxis], 2, axis=1),
        )
        self._keeps = np.array([not isinstance(item, Joint) for item, _, _ in items], dtype=bool)
        self._keeps = np.repeat(self._keeps, sizes)
        counts = np.array([len(group) for group in groups], dtype=np.int64)
        starts = np.cumsum(counts) - counts
        chosen = [
            (pair, groups[k][0].exchanged, numbers[k])
            for k, (item, _, _) in enumerate(items)
            for pair in range(starts[k], starts[k] + _reported(item, counts[k]))
        ]
        of_pairs, sides_of, items_of = np.array(chosen, dtype=np.int64).reshape(-1, 3).T.copy()
        self.reported = of_pairs, sides_of, items_of
        self._probe(items, constrained)
        labels = [item.label for item, _, _ in items]
        of = np.repeat(np.arange(len(items)), counts)
        self._branches = Branches(self.arrays, self.probes, labels, of)
        pairs_of = [
            key
            for (item, _, _), label, group in zip(items, labels, groups, strict=True)
            for key in _keys(item, label, group)
        ]
        coordinates = [c for item, _, _ in items for c in item.coordinates()]
        self._keys = pairs_of, [(c.joint.label, c.name) for c in coordinates]
        self._preloaded = np.array([spring.item.preloaded for spring in springs], dtype=bool)
        self._rest, self._start = self.arrays.springs[:, 2].copy(), np.empty(0)
        self._springs_of: dict[Connection, list[int]] = {}
        for k, spring in enumerate(springs):
            self._springs_of.setdefault(spring.item, []).append(k)

    def _probe(self, items: Sequence[Numbered], constrained: ConstrainedFrames) -> None:
        definitions = [
            (c.definition, at + k)
            for item, _, at in items
            for k, c in enumerate(item.coordinates())
        ]
        probes = [
            _pair(constrained, definition, row) for row, (definition, _) in enumerate(definitions)
        ]
        self.packed_probes: PackedJoints = _packed(constrained, probes, len(probes), [], None, 0)
        self.probes = views(self.packed_probes)
        self.probed: Indices = np.array([at for _, at in definitions], dtype=np.int64)
        self.turns = bool(self.arrays.functions.any() or self.probes.functions.any())

    def _angles(self) -> Flags:
        arrays, angular = self.arrays, np.ones(self.m, dtype=bool)
        lengths = arrays.selection[:, :3].any(axis=1) | (arrays.functions[:, DISTANCE] != 0.0)
        # the first term of a gear decides: its ratio converts the second term
        rows, first = np.unique(arrays.rows, return_index=True)
        angular[rows[lengths[first] & (rows < self.m)]] = False
        return angular

    @property
    def empty(self) -> bool:
        """Whether it has no constraint, spring or coordinate."""
        return len(self.arrays.nodes) == 0 and len(self.probes.nodes) == 0

    def evaluate(
        self, H: Array, v: Array, multipliers: Array, scale: Array, count: int, r: Array
    ) -> None:
        """Add constraint forces ``Bᵀλ`` and spring forces to ``r``; set its rows ``scale · Φ``."""
        if self._ties:
            terms.evaluate(H, v, self.arrays, multipliers, scale, count, r)

    def values(self, H: Array, v: Array, out: Array) -> None:
        """Set the violations ``Φ`` or ``W V`` in its rows of ``out``."""
        if self._ties:
            terms.violations(H, self.arrays, out)

    def jacobian(self, H: Array, rows: Array) -> None:
        """Add ``∂Φ/∂h``, one row of six per incidence, to the constraint Jacobian ``rows``."""
        if self._ties:
            terms.jacobian(H, self.arrays, rows)

    def geometric(self, H: Array, multipliers: Array, index: Indices, K: Array) -> None:
        """Add ``∂(Bᵀλ)/∂h`` to blocks ``K``, at ``index`` of each of ``pairs``, −1: none."""
        if self._ties:
            terms.geometric(H, self.arrays, multipliers, index, K)

    def rates(self, H: Array, v: Array, first: Array, second: Array) -> None:
        """Set first and second rates at constant twists and targets; of ``W V``: value and rate."""
        if self._ties:
            terms.rates(H, v, self.arrays, first, second)

    def initial(self, H: Array) -> Array:
        """Targets that keep initial values, shape (m,); zero for all other constraints."""
        values = np.zeros(self.m)
        if self._ties:
            pairs = np.arange(2 * len(self.arrays.nodes)).reshape(-1, 2)
            terms.violations(self._initial, self.arrays._replace(nodes=pairs), values)
        return np.where(self._keeps, values, 0.0)

    @property
    def depends_on_time(self) -> bool:
        """Whether force laws may depend on time: those without a potential."""
        return any(not law.has_potential for _, law in self.laws)

    def set_clock(self, time: float) -> None:
        """Set the time at which force laws are evaluated."""
        self.arrays.clock[0] = time

    def check_laws(self) -> None:
        """Raise the error of a force law, if there was one."""
        for label, law in self.laws:
            if error := law.failure():
                time = self.arrays.clock[0]
                what = f"{type(error).__name__}: {error}"
                raise ForceLawError(f"{label}: {what} (at time {time:g})") from error

    @property
    def springs(self) -> Array:
        """Stiffness, damping and rest value of each spring, shape (k, 3)."""
        return self.arrays.springs

    def scale_spring(self, item: Connection, factor: float) -> None:
        """Multiply the stiffness and damping of the scene, or the law, of an item by a factor."""
        for k in self._springs_of.get(item, []):
            assert item.spring is not None
            self.arrays.springs[k, :2] = factor * np.array(item.spring[:2])

    @property
    def sprung(self) -> Flags:
        """Whether springs couple each of :attr:`pairs`; of the same shape."""
        term = np.flatnonzero(self.arrays.rows >= self.m)
        found = np.zeros(self.pairs[0].shape, dtype=bool)
        found[np.searchsorted(self.arrays.first, term, side="right") - 1] = True
        return found

    def stiffen(
        self, H: Array, v: Array, index: Indices, stiff: float, damp: float, K: Array
    ) -> None:
        """Add ``(stiff k + damp c) bᵀb`` of springs and dampers to blocks, as :meth:`geometric`."""
        if len(self.arrays.springs):
            terms.add_springs(H, v, self.arrays, index, stiff, damp, K)

    def stretch_springs(self, H: Array, h: Array) -> None:
        """Change rest values of springs by the changes of coordinates along ``h`` (n, 6)."""
        if len(self.arrays.springs):
            changes = np.zeros(len(self._rest))
            spring_changes(H, h, self.arrays, changes)
            self.arrays.springs[:, 2] = self._rest - changes

    def spring_energy(self, H: Array) -> float:
        """Energy of all springs."""
        return terms.spring_energy(H, self.arrays) if len(self.arrays.springs) else 0.0

    def add_friction(
        self, H: Array, v: Array, multipliers: Array, index: Indices, factor: float, K: Array
    ) -> None:
        """Add derivatives of friction in twists to blocks, as :meth:`geometric`."""
        if self._has_friction:
            friction.add_tangent(H, v, self.arrays, multipliers, index, factor, K)

    def add_friction_columns(self, H: Array, v: Array, multipliers: Array, rows: Array) -> None:
        """Add derivatives of friction in multipliers to ``rows``, as :meth:`jacobian`."""
        if self._has_friction:
            friction.add_columns(H, v, self.arrays, multipliers, rows)

    def damper_loss(self, H: Array, v: Array, multipliers: Array) -> float:
        """Power dissipated by dampers and friction."""
        if not len(self.arrays.springs):
            return 0.0
        return float(terms.damper_loss(H, v, self.arrays, multipliers))

    def move_reference_angles(self, H: Array, h: Array) -> None:
        """Move reference angles along the increment ``h`` (n, 6) of nodes, made from ``H``."""
        if self.turns:
            self._branches.move_reference_angles(H, h)

    def mark(self) -> None:
        """Take the reference angles as those of the accepted state."""
        self._branches.mark()

    def check_branch(self, H: Array) -> None:
        """Refuse a state in which an angle or axis may be on a wrong branch."""
        if self._ties:
            self._branches.check(H)

    @property
    def preloaded(self) -> bool:
        """Whether there are springs with a prescribed rest value."""
        return bool(self._preloaded.any())

    def preload(self, H: Array, part: float) -> None:
        """Apply a fraction of the preload of springs with a prescribed rest value."""
        springs = self.arrays.springs
        if not len(self._start):
            # later the initial frames do not determine full turns
            self._start = np.zeros(len(springs))
            turns.spring_values(H, self.arrays, self._start)
        now = part * self._rest + (1.0 - part) * self._start
        springs[:, 2] = np.where(self._preloaded, now, self._rest)

    def accept(self, H: Array) -> None:
        """Update history variables that frames do not determine, at an accepted state."""
        if self.turns:
            terms.unwrap_both(H, self.packed, self.packed_probes)
            self._branches.mark()

    @property
    def history_variables(self) -> tuple[Array, ...]:
        """History variables that :meth:`accept` updates; arrays that may be written."""
        return self.arrays.turned, self.probes.turned

    @property
    def history_keys(self) -> tuple[list[HistoryKey], ...]:
        """Joint and coordinate of each history variable, independent of other items."""
        return self._keys

    def wrenches(self, H: Array, v: Array, multipliers: Array, out: Array) -> None:
        """Add force and moment on side A of each item, in its axes there, to the rows of items."""
        if not self._ties:
            return
        found = np.empty_like(out)
        terms.wrenches(H, v, self.arrays, multipliers, *self.reported, found)
        out += found

    def coordinates(self, H: Array, out: Array) -> None:
        """Set the coordinates of its items in ``out``, shape (c,)."""
        if not len(self.probed):
            return
        found: Array = np.empty(len(self.probes.targets))
        terms.violations(H, self.probes, found)
        out[self.probed] = found

    def places(self) -> dict[int, Place]:
        """Position on side A of each item, or on side B if A is ground, and axes of its force."""
        arrays, (pairs, sides, items) = self.arrays, self.reported
        own, first = np.unique(items, return_index=True)
        pairs, sides = pairs[first], sides[first]
        return places(own, arrays.nodes[pairs], arrays.frames[pairs], self._count, sides)

    @property
    def outward(self) -> bool:
        """Whether there are dampers, or connections to ground or prescribed motions."""
        arrays = self.arrays
        return bool((arrays.nodes >= self._count).any() or arrays.springs[:, 1].any())


def _reported(item: Connection, count: int) -> int:
    """Number of an item's pairs, from its first one, whose forces results report."""
    return int(count) if item.summed else min(int(count), 1)


def _keys(item: Connection, label: str, pairs: Sequence[Pair]) -> list[HistoryKey]:
    """Keys of the angles of an item's pairs: the coordinate along which it acts, or its own."""
    counted = [pair.definition.functions[:, ANGLE].any() for pair in pairs]
    if not any(counted):  # pairs without an angle have no history
        return [(label, "")] * len(pairs)
    coordinates = [] if isinstance(item, Joint) else list(item.coordinates())
    own = [(label, "angle")] * len(pairs)
    acts = [(c.joint.label, c.name) for c in coordinates]
    found = acts if len(acts) == len(pairs) else own
    return [key if c else (label, "") for key, c in zip(found, counted, strict=True)]


def _pair(constrained: ConstrainedFrames, definition: ConstraintDefinition, first: int) -> Pair:
    """Pair with a moving side A, where terms of ``Δ`` alone have a constant Jacobian."""
    nodes = constrained.of(definition.a), constrained.of(definition.b)
    numbers = [first + row if row >= 0 else -1 for row in definition.rows]
    if definition.reversible and constrained.still[nodes[0]] and not constrained.still[nodes[1]]:
        return Pair(definition.exchanged(), nodes[::-1], numbers, True)
    return Pair(definition, nodes, numbers, False)


def _packed(
    constrained: ConstrainedFrames,
    pairs: Sequence[Pair],
    m: int,
    springs: Sequence[_Spring],
    incidences: Incidences | None,
    incidence: int,
) -> PackedJoints:
    """Table of ``m`` constraints; all incidences are −1 if ``incidences`` is ``None``."""
    number = iter(range(m, m + len(springs)))
    terms_of = [row if row >= 0 else next(number) for pair in pairs for row in pair.rows]
    of_terms = np.array(terms_of, dtype=np.int64)
    both = [pair.nodes for pair in pairs for _ in pair.rows]
    nodes = np.array(both, dtype=np.int64).reshape(-1, 2)
    at = np.full_like(nodes, -1) if incidences is None else incidences.find(of_terms, nodes)
    of_pairs = np.array([pair.nodes for pair in pairs], dtype=np.int64).reshape(-1, 2)
    frames = np.array([pair.definition.frames for pair in pairs]).reshape(-1, 2, 4, 3)
    points = [point for pair in pairs for point in (pair.definition.a, pair.definition.b)]
    ends = np.cumsum([0, *(len(spring.data) for spring in springs)], dtype=np.int64)
    arrays = JointArrays(
        nodes=of_pairs,
        frames=relative_frames(constrained, points, frames),
        first=np.cumsum([0] + [len(pair.rows) for pair in pairs], dtype=np.int64),
        selection=stacked([pair.definition.selection for pair in pairs], 0, 12),
        functions=stacked([pair.definition.functions for pair in pairs], 0, COUNT),
        rows=of_terms,
        incidences=np.where(at >= 0, at + incidence, -1),
        angle=np.array([pair.definition.angle for pair in pairs]).reshape(-1, 2, 12),
        curved=np.array([pair.definition.functions.any() for pair in pairs], dtype=np.int64),
        turned=np.zeros(len(pairs)),
        targets=np.zeros(m),
        springs=np.array([spring.item.spring for spring in springs], dtype=np.float64).reshape(
            -1, 3
        ),
        laws=np.array(
            [
                (spring.address, *ends[k : k + 2], spring.joint, spring.bearing)
                for k, spring in enumerate(springs)
            ],
            dtype=np.int64,
        ).reshape(-1, 5),
        data=np.concatenate([np.empty(0), *(spring.data for spring in springs)]),
        clock=np.zeros(1),
    )
    return pack(arrays)
