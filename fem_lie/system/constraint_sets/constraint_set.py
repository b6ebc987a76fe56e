"""Base class of sets of constraints: all that the equations know of joints.

A set takes its connections from the items of a scene (joints, springs, drives and so on), numbers
their constraints, and works on arrays of the whole system: frames and twists of all nodes, of
ground and of prescribed motions, Lagrange multipliers, the constraint Jacobian. A new type of
constraint is one file with such a class, and an entry in :mod:`.kinds`.

All constraints are equalities, ``Φ = 0`` or ``W V = 0``. Inequalities would need a *bound* of each
constraint, in addition to ``angular`` and ``owner``: "equal", "not negative" or "in the cone of the
next ones"; iterations and the saddle-point matrix would read it.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import NamedTuple, Protocol, TypeAlias

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Indices, at_time
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.body import Point
from fem_lie.joints.connection import Connection
from fem_lie.joints.histories import declared, difference_step
from fem_lie.linear.saddle_point import Incidences
from fem_lie.system.nodes.numbering import Numbering


class ConstrainedFrames(Protocol):
    """Frames on which constraints act: independent ones first, then ground and prescribed motions.

    Attributes:
        count: Number of independent frames.
        frames: Initial frames, shape (L, 4, 3).
        still: Whether nothing can move a frame, shape (L,).
        held: Unknowns of the independent frames that are zero, shape (count, 6).
    """

    count: int
    frames: Array
    still: Flags
    held: Flags

    def of(self, point: Point) -> int:
        """Number of the frame of a point."""

    def initial(self, point: Point) -> Array:
        """That frame where the node of the point is in the initial configuration, (4, 3).

        It is not that of :attr:`frames` if the node is attached in another configuration.
        """

    def ends(self, beam: Beam) -> tuple[Indices, Array]:
        """Frames at both ends of a beam's elements.

        Args:
            beam: A beam with e elements.

        Returns:
            Their numbers, shape (e, 2), and the end frames relative to them, (e, 2, 4, 3).
        """


class SystemFrames:
    """Frames of a system: master nodes, ground, and prescribed motions.

    Attributes:
        numbering: Numbering of the nodes.
    """

    def __init__(
        self, numbering: Numbering, frames: Array, held: Flags, motions: Mapping[Point, int]
    ) -> None:
        """Store the frames of a system.

        Args:
            numbering: Numbering of the nodes.
            frames: Initial frames of all nodes, ground and prescribed motions.
            held: Unknowns of the moving nodes that are zero, shape (n, 6).
            motions: Frame number of each point with a prescribed motion.
        """
        self.numbering, self.count, self.frames = numbering, numbering.count, frames
        self.held = held
        self.still = np.append(held.all(axis=1), [True] * (len(frames) - numbering.count))
        self._motions = motions

    def of(self, point: Point) -> int:
        """Number of the frame of a point."""
        number = self._motions.get(point)
        return self.numbering.node(point) if number is None else number

    def initial(self, point: Point) -> Array:
        """That frame where the node of the point is in the initial configuration, (4, 3)."""
        if point in self._motions or point.body is None:
            return np.asarray(self.frames[self.of(point)])
        node = self.numbering.nodes[point.body][point.node]
        offset = self.numbering.master_map.offset[node]
        return lie.se3_compose(point.body.frames[point.node], lie.se3_inverse(offset))

    def ends(self, beam: Beam) -> tuple[Indices, Array]:
        """Frames at both ends of a beam's elements.

        Args:
            beam: A beam with e elements.

        Returns:
            Their numbers, shape (e, 2), and the end frames relative to them, (e, 2, 4, 3).
        """
        master_map = self.numbering.master_map
        both = self.numbering.nodes[beam][beam.model.elements[:, :2]]
        return master_map.master[both], master_map.offset[both]


def initial_frames(constrained: ConstrainedFrames, points: Sequence[Point]) -> Array:
    """Initial constrained frames of some points, shape (k, 4, 3)."""
    return np.array([constrained.initial(point) for point in points]).reshape(-1, 4, 3)


def relative_frames(
    constrained: ConstrainedFrames, points: Sequence[Point], frames: Array
) -> Array:
    """Global frames (…, 4, 3) relative to the initial constrained frames of their points."""
    initial = initial_frames(constrained, points).reshape(frames.shape)
    return lie.se3_compose(lie.se3_inverse(initial), frames)


_FORWARD = np.array(
    [
        [-137 / 60, 5, -5, 10 / 3, -5 / 4, 1 / 5],
        [15 / 4, -77 / 6, 107 / 6, -13, 61 / 12, -5 / 6],
    ]
)
"""First and second derivative of a polynomial of fifth degree from its values at 0, 1, … 5."""


class Targets:
    """Prescribed values of all constraints: those of drives depend on time, those of gears do not.

    Attributes:
        driven: Whether any target depends on time.
        base: Constant parts of the targets, shape (m,).
    """

    def __init__(self, items: Sequence[Connection], owner: Indices, base: Array) -> None:
        """Collect the drives; a history of an item belongs to its last constraint.

        Args:
            items: All items.
            owner: Item of each constraint, shape (m,).
            base: Constant targets, shape (m,).
        """
        self._items, self._owner, self.base = items, owner, base.copy()
        self._drives = [
            (int(np.flatnonzero(owner == k)[-1]), item.history)
            for k, item in enumerate(items)
            if item.history is not None
        ]
        self.base[[row for row, _ in self._drives]] = 0.0
        self._breaks = declared((history for _, history in self._drives), kinks=True)
        self.driven = bool(self._drives)

    def at(self, time: float) -> Array:
        """Targets at ``time``, shape (m,).

        Raises:
            ValueError: A drive is not finite then.
        """
        values = self.base.copy()
        for row, history in self._drives:
            label = self._items[self._owner[row]].label
            values[row] += at_time(history, time, label)
            if not np.isfinite(values[row]):
                raise ValueError(f"{label} is {values[row]} at time {time:g}")
        return values

    def shift(self, violations: Array, which: Flags) -> None:
        """Add violations to the targets of some constraints, which are then closed.

        Args:
            violations: Violations of all constraints, shape (m,).
            which: Mask of these constraints, shape (m,).
        """
        self.base[which] += violations[which]

    def rates(self, time: float, step: float, last: float) -> tuple[Array, Array]:
        """First and second time derivatives of the targets at ``time``, shape (m,).

        They are differences over five later times before the next jump, which may be closer than
        ``step``, or over five earlier ones if the run ends before, at ``last``.
        """
        if not self.driven:
            return np.zeros_like(self.base), np.zeros_like(self.base)
        step = difference_step(self._breaks, time, step, 5, last)
        values = [self.at(time + k * step) for k in range(6)]
        first, second = np.tensordot(_FORWARD, values, axes=1)
        return first / step, second / step**2


HistoryKey: TypeAlias = tuple[str, str]
"""Label of a joint, and name of its coordinate."""


class Numbered(NamedTuple):
    """An item of the scene with its numbers.

    Attributes:
        item: Joint, spring and so on.
        number: Number among all items.
        coordinate: Number of its first coordinate among those in results.
    """

    item: Connection
    number: int
    coordinate: int


class Means(NamedTuple):
    """Mean coordinates of averaging attachments, ``s = Σ S h`` over the nodes of each.

    Attributes:
        nodes: Node of each entry, shape (e,).
        of: Attachment of each entry, shape (e,).
        each: Number r of coordinates of an attachment.
    """

    nodes: Indices
    of: Indices
    each: int


class Start(NamedTuple):
    """Position of a set among all constraints.

    Attributes:
        row: Number of its first constraint.
        incidence: Number of its first incidence.
    """

    row: int = 0
    incidence: int = 0


class ConstraintSet(ABC):
    """Constraints of one type. Arrays are those of the system, of which a set uses some rows.

    Attributes:
        what: Description for messages of schemes that do not support the set.
        of_velocities: Whether the set constrains velocities instead of positions.
        start: Numbers of its first constraint and incidence.
        incidences: Incidences of its constraints with nodes.
        owner: Number of the item of each constraint, shape (m,).
        angular: Whether a constraint is an angle instead of a length, shape (m,).
        pairs: Rows and columns of the node pairs of its geometric stiffness, two arrays of any
            shape.
        targets: Prescribed values, shape (m,), updated in place.
    """

    what: str
    of_velocities: bool = False
    start: Start
    incidences: Incidences
    owner: Indices
    angular: Flags
    pairs: tuple[Indices, Indices]
    targets: Array

    @abstractmethod
    def __init__(
        self, items: Sequence[Numbered], constrained: ConstrainedFrames, start: Start
    ) -> None:
        """Take the connections of this type from the items."""

    @property
    def m(self) -> int:
        """Number of constraints."""
        return len(self.owner)

    @property
    def own(self) -> slice:
        """Its constraints among all."""
        return slice(self.start.row, self.start.row + self.m)

    @property
    @abstractmethod
    def empty(self) -> bool:
        """Whether it has no constraint, spring or coordinate."""

    @property
    def held(self) -> Indices:
        """Rows on which it acts, each at least once."""
        return np.concatenate([self.pairs[0].ravel(), self.incidences.nodes])

    @property
    def bound(self) -> Indices:
        """Rows on which it acts and whose axes matter to it."""
        return self.held

    # --- equations ---

    @abstractmethod
    def evaluate(
        self, H: Array, v: Array, multipliers: Array, scale: Array, count: int, r: Array
    ) -> None:
        """Add constraint forces ``Bᵀλ`` and spring forces to ``r``; set its rows ``scale · Φ``.

        Args:
            H: Frames of all nodes, ground and prescribed motions.
            v: Twists, shape (≥ n, 6); further rows are at rest.
            multipliers: Lagrange multipliers λ of all constraints, shape (m of all,).
            scale: Scale factor of each constraint, shape (m of all,).
            count: Number of rows with forces; constraints start at ``6 count`` in ``r``.
            r: Residual, shape (6 count + m of all,), updated.
        """

    @abstractmethod
    def values(self, H: Array, v: Array, out: Array) -> None:
        """Set the violations ``Φ`` or ``W V`` in its rows of ``out``."""

    @abstractmethod
    def jacobian(self, H: Array, rows: Array) -> None:
        """Add ``∂Φ/∂h``, one row of six per incidence, to the constraint Jacobian ``rows``."""

    @abstractmethod
    def geometric(self, H: Array, multipliers: Array, index: Indices, K: Array) -> None:
        """Add ``∂(Bᵀλ)/∂h`` to blocks ``K``, at ``index`` of each of ``pairs``, −1: none."""

    @property
    def means(self) -> Means | None:
        """Mean coordinates of averaging attachments, which couple the last of :attr:`pairs`."""
        return None

    @property
    def sparse(self) -> tuple[Indices, Indices]:
        """:attr:`pairs` without those of :attr:`means`; :meth:`geometric` takes either."""
        return self.pairs

    def mean_stiffness(self, H: Array, multipliers: Array) -> tuple[Array, Array]:
        """``S`` (e, r, 6), and the core ``C`` (w, r, w, r) of the geometric stiffness ``Sᵀ C S``.

        :meth:`geometric` adds it to the pairs that are not :attr:`sparse`.
        """
        raise NotImplementedError

    @abstractmethod
    def rates(self, H: Array, v: Array, first: Array, second: Array) -> None:
        """Set first and second rates at constant twists and targets; of ``W V``: value and rate."""

    def initial(self, H: Array) -> Array:
        """Targets that keep initial values, shape (m,); zero for all other constraints."""
        return np.zeros(self.m)

    # --- springs and dampers along coordinates ---

    @property
    def depends_on_time(self) -> bool:
        """Whether force laws may depend on time."""
        return False

    def set_clock(self, time: float) -> None:
        """Set the time at which force laws are evaluated.

        Args:
            time: Time, or load factor in statics.
        """
        return  # most sets have none

    def check_laws(self) -> None:
        """Raise the error of a force law, if there was one.

        Raises:
            ForceLawError: A law of the user has failed since the last call.
        """
        return  # most sets have none

    @property
    def springs(self) -> Array:
        """Stiffness, damping and rest value of each spring, shape (k, 3)."""
        return np.empty((0, 3))

    def scale_spring(self, item: Connection, factor: float) -> None:
        """Multiply the stiffness and damping of the scene, or the law, of an item by a factor.

        Args:
            item: An item of any set.
            factor: The factor.
        """
        return  # most sets have none

    @property
    def sprung(self) -> Flags:
        """Whether springs couple each of :attr:`pairs`; of the same shape."""
        return np.ones(self.pairs[0].shape, dtype=bool)

    def stiffen(
        self, H: Array, v: Array, index: Indices, stiff: float, damp: float, K: Array
    ) -> None:
        """Add ``(stiff k + damp c) bᵀb`` of springs and dampers to blocks, as :meth:`geometric`.

        Args:
            H: Frames of all nodes.
            v: Twists of the moving nodes, at which force laws are differentiated; fewer rows: the
                other nodes are at rest.
            index: Block of each of :attr:`pairs`, −1: none.
            stiff: Factor of the stiffness ``k``.
            damp: Factor of the damping ``c``.
            K: Blocks, shape (any, 6, 6).
        """
        return  # most sets have none

    def stretch_springs(self, H: Array, h: Array) -> None:
        """Change rest values of springs by the changes of coordinates along ``h`` (n, 6).

        The changes are of first order and start from the rest values of the scene, so that springs
        at frames ``H`` have the forces of the end of ``h``.
        """
        return  # most sets have none

    def spring_energy(self, H: Array) -> float:
        """Energy of all springs."""
        return 0.0

    def add_friction(
        self, H: Array, v: Array, multipliers: Array, index: Indices, factor: float, K: Array
    ) -> None:
        """Add derivatives of friction in twists, times ``factor``, to blocks, as :meth:`geometric`.

        Args:
            H: Frames of all nodes.
            v: Twists of the moving nodes.
            multipliers: Lagrange multipliers of all constraints.
            index: Block of each of :attr:`pairs`, −1: none.
            factor: Factor of the derivatives.
            K: Blocks, shape (any, 6, 6).
        """
        return  # most sets have none

    def add_friction_columns(self, H: Array, v: Array, multipliers: Array, rows: Array) -> None:
        """Add derivatives of friction in multipliers to ``rows``, as :meth:`jacobian`.

        Args:
            H: Frames of all nodes.
            v: Twists of the moving nodes.
            multipliers: Lagrange multipliers of all constraints.
            rows: One row of six per incidence, updated.
        """
        return  # most sets have none

    def damper_loss(self, H: Array, v: Array, multipliers: Array) -> float:
        """Power dissipated by dampers and friction."""
        return 0.0

    # --- rotations within a step ---

    def move_reference_angles(self, H: Array, h: Array) -> None:
        """Move reference angles along the increment ``h`` (n, 6) of nodes, made from ``H``."""
        return  # most sets have no angles

    def mark(self) -> None:
        """Take the reference angles as those of the accepted state."""
        return

    def check_branch(self, H: Array) -> None:
        """Refuse a state in which an angle or axis may be on a wrong branch.

        Raises:
            LostBranchError: An angle has changed by more than a quarter turn since the accepted
                state, or aligned axes are opposite.
        """
        return

    @property
    def preloaded(self) -> bool:
        """Whether there are springs with a prescribed rest value."""
        return False

    def preload(self, H: Array, part: float) -> None:
        """Apply a fraction of the preload of springs with a prescribed rest value.

        Args:
            H: Initial frames.
            part: Fraction of the difference between rest and initial values.
        """
        return

    # --- history variables ---

    def accept(self, H: Array) -> None:
        """Update history variables that frames do not determine, at an accepted state.

        Raises:
            ValueError: The state is invalid.
        """
        return  # most sets have no history variables

    @property
    def history_variables(self) -> tuple[Array, ...]:
        """History variables that :meth:`accept` updates; arrays that may be written."""
        return ()

    @property
    def history_keys(self) -> tuple[list[HistoryKey], ...]:
        """Joint and coordinate of each history variable, independent of other items."""
        return ()

    # --- results ---

    @abstractmethod
    def wrenches(self, H: Array, v: Array, multipliers: Array, out: Array) -> None:
        """Add force and moment on side A of each item, in its axes there, to the rows of items."""

    def coordinates(self, H: Array, out: Array) -> None:
        """Set the coordinates of its items in ``out``, shape (c,)."""
        return  # most items have none

    @abstractmethod
    def places(self) -> dict[int, Place]:
        """Where each item is drawn, and the axes of its force, by item number."""

    @property
    @abstractmethod
    def outward(self) -> bool:
        """Whether there are dampers, or connections to ground or prescribed motions."""


class Place(NamedTuple):
    """Where an item is drawn, and the axes of the force that results report.

    Attributes:
        row: Row of the frame with which it is drawn.
        offset: Its position in that frame, shape (3,).
        side: Row of the frame with which the axes of the force rotate; ``None`` if no row does, as
            on an attachment or where a frame slides.
        axes: These axes as rows, in the frame of ``side``, shape (3, 3).
    """

    row: int
    offset: Array
    side: int | None
    axes: Array


def places(
    items: Indices, nodes: Indices, frames: Array, count: int, sides: Indices | None = None
) -> dict[int, Place]:
    """Position on side A of each item, or on side B if A is ground, and axes of its force.

    Args:
        items: Numbers of the items, shape (k,).
        nodes: Rows of the frames of both sides, shape (k, 2).
        frames: Frames of both sides in those, shape (k, 2, 4, 3).
        count: Number of moving rows.
        sides: Side in whose axes the force is, 0 or 1, shape (k,); without it 0.
    """
    drawn = (nodes[:, 0] >= count).astype(np.int64)
    own = np.zeros_like(drawn) if sides is None else sides
    return {
        int(item): Place(int(nodes[k, d]), frames[k, d, 0], int(nodes[k, s]), frames[k, s, 1:])
        for k, (item, d, s) in enumerate(zip(items, drawn, own, strict=True))
    }


def stacked(parts: Sequence[Array], *shape: int) -> Array:
    """Concatenate along the first axis; an empty array of the given shape if there are no parts."""
    return np.concatenate([np.empty(shape), *parts])
