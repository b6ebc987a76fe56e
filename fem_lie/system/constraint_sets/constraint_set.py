"""What a set of constraints does: all that equations know of joints.

A set takes from the items of a scene (joints, springs, drives and so on) what is its own, numbers
its constraints, and works on arrays of the whole system: rows of frames and twists, multipliers,
legs of the border. A new sort of constraint is one file with such a class, and a line in
:mod:`.kinds`.

All constraints are equalities so far, ``Φ = 0`` or ``W V = 0``. Contact will need to say more: a
*bound* of each constraint, beside ``angular`` and ``owner`` below, that is "equal", "not negative"
or "in the cone of those after it"; iterations and the bordered matrix read it, the sets' other
functions stay as they are.
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
from fem_lie.joints import Connection
from fem_lie.joints.histories import declared, until_next
from fem_lie.linear.saddle_point import Incidences
from fem_lie.system.nodes.numbering import Numbering


class Rows(Protocol):
    """Rows of frames: first those that move by themselves, then ground and prescribed motions.

    Attributes:
        count: Of those that move.
        frames: At the start, shape (L, 4, 3).
        still: Which of them nothing can move, shape (L,).
    """

    count: int
    frames: Array
    still: Flags

    def of(self, point: Point) -> int:
        """The row that a point is on."""

    def ends(self, beam: Beam) -> tuple[Indices, Array]:
        """Rows of both ends of a beam's elements (e, 2), and their frames there, (e, 2, 4, 3)."""


class SystemRows:
    """See :class:`Rows`: nodes that lead, ground, and prescribed motions.

    Attributes:
        numbering: Of the nodes.
    """

    def __init__(
        self, numbering: Numbering, frames: Array, held: Flags, motions: Mapping[Point, int]
    ) -> None:
        """Of a system.

        Args:
            numbering: Of its nodes.
            frames: Initial frames of all rows.
            held: Which unknowns of the moving nodes are zero, shape (n, 6).
            motions: Points that move as prescribed, and the row of each.
        """
        self.numbering, self.count, self.frames = numbering, numbering.count, frames
        self.still = np.append(held.all(axis=1), [True] * (len(frames) - numbering.count))
        self._motions = motions

    def of(self, point: Point) -> int:
        """See :class:`Rows`."""
        row = self._motions.get(point)
        return self.numbering.node(point) if row is None else row

    def ends(self, beam: Beam) -> tuple[Indices, Array]:
        """See :class:`Rows`."""
        master_map = self.numbering.master_map
        both = self.numbering.nodes[beam][beam.elements[:, :2]]
        return master_map.master[both], master_map.offset[both]


def in_rows(rows: Rows, at: Indices, frames: Array) -> Array:
    """Frames (…, 4, 3), given in space at the start, in those of the rows ``at`` (…)."""
    return lie.se3_compose(lie.se3_inverse(rows.frames[at]), frames)


_FORWARD = np.array(
    [
        [-137 / 60, 5, -5, 10 / 3, -5 / 4, 1 / 5],
        [15 / 4, -77 / 6, 107 / 6, -13, 61 / 12, -5 / 6],
    ]
)
"""First and second derivative of a polynomial of fifth degree from values at 0, 1, … 5."""


class Targets:
    """Of all constraints: those of drives change, those of gears and links stay.

    Attributes:
        driven: Whether any depends on time.
    """

    def __init__(self, items: Sequence[Connection], owner: Indices, base: Array) -> None:
        """Collect the drives; of an item with a history the last constraint is driven.

        Args:
            items: All of them.
            owner: Of each constraint, shape (m,).
            base: Those that stay, shape (m,).
        """
        self._items, self._owner, self._base = items, owner, base
        self._drives = [
            (int(np.flatnonzero(owner == k)[-1]), item.history)
            for k, item in enumerate(items)
            if item.history is not None
        ]
        self._breaks = declared((history for _, history in self._drives), kinks=True)
        self.driven = bool(self._drives)

    def at(self, time: float) -> Array:
        """What the constraints are to be at ``time``, shape (m,).

        Raises:
            ValueError: A drive is not finite then.
        """
        values = self._base.copy()
        for row, history in self._drives:
            label = self._items[self._owner[row]].label
            values[row] = at_time(history, time, label)
            if not np.isfinite(values[row]):
                raise ValueError(f"{label} is {values[row]} at time {time:g}")
        return values

    def rates(self, time: float, step: float) -> tuple[Array, Array]:
        """First and second rates of the targets, (m,), at ``time``, by five later times.

        These lie before the next jump, and so may be nearer than ``step``.
        """
        step = min(step, until_next(self._breaks, time) / 5.0)
        values = [self.at(time + k * step) for k in range(6)]
        first, second = np.tensordot(_FORWARD, values, axes=1)
        return first / step, second / step**2


MemoryKey: TypeAlias = tuple[str, str]
"""Label of a joint, and name of its coordinate."""


class Numbered(NamedTuple):
    """An item of the scene.

    Attributes:
        item: Joint, spring and so on.
        number: Among all.
        coordinate: Number of its first coordinate among those that results report.
    """

    item: Connection
    number: int
    coordinate: int


class Means(NamedTuple):
    """Mean coordinates of averaging attachments, ``s = Σ S h`` over the nodes of each.

    Attributes:
        nodes: Node of each entry, shape (e,).
        of: Attachment of each entry, shape (e,).
        each: Coordinates of an attachment, r.
    """

    nodes: Indices
    of: Indices
    each: int


class Start(NamedTuple):
    """Where a set begins.

    Attributes:
        row: Number of its first constraint.
        incidence: Number of its first leg in the border.
    """

    row: int = 0
    incidence: int = 0


class ConstraintSet(ABC):
    """Constraints of one sort. Arrays are those of the system, of which a set has some rows.

    Attributes:
        what: For messages of schemes that do not know the set.
        of_velocities: Whether velocities are bound and not positions.
        start: Where its constraints and legs begin among all.
        incidences: Legs of its own constraints alone.
        owner: Number of the item of each, shape (m,).
        angular: Which are angles and not lengths, shape (m,).
        pairs: Rows and columns of the node pairs that its geometric stiffness couples, of any
            shape.
        targets: What they are to be, shape (m,), to be written into.
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
    def __init__(self, items: Sequence[Numbered], rows: Rows, start: Start) -> None:
        """Take from the items what is of this set."""

    @property
    def m(self) -> int:
        """Number of its constraints."""
        return len(self.owner)

    @property
    def own(self) -> slice:
        """Its constraints among all."""
        return slice(self.start.row, self.start.row + self.m)

    @property
    @abstractmethod
    def empty(self) -> bool:
        """Whether there is nothing in it, not even a spring."""

    @property
    def held(self) -> Indices:
        """Rows that it holds on to, each at least once."""
        return np.concatenate([self.pairs[0].ravel(), self.incidences.nodes])

    @property
    def bound(self) -> Indices:
        """Those of them whose own axes it is written in."""
        return self.held

    # --- equations ---

    @abstractmethod
    def evaluate(
        self, H: Array, v: Array, multipliers: Array, scale: Array, count: int, r: Array
    ) -> None:
        """Add constraint forces ``Bᵀλ`` and spring forces to ``r``; set its rows ``scale · Φ``.

        Args:
            H: Frames of all rows.
            v: Twists, shape (≥ n, 6); rows beyond are at rest.
            multipliers: Multipliers, shape (m of all,).
            scale: Factor of each constraint, likewise.
            count: Rows with forces; constraints begin at ``6 count`` in ``r``.
            r: Shape (6 count + m of all,), updated.
        """

    @abstractmethod
    def values(self, H: Array, v: Array, out: Array) -> None:
        """What the constraints violate, ``Φ`` or ``W V``, into its rows of ``out``."""

    @abstractmethod
    def jacobian(self, H: Array, rows: Array) -> None:
        """Add the derivative of the constraints in twists to their legs, (all legs, 6)."""

    @abstractmethod
    def geometric(self, H: Array, multipliers: Array, place: Indices, K: Array) -> None:
        """Add ``∂(Bᵀλ)/∂h`` to blocks ``K``, at ``place`` of each of ``pairs``, −1: none."""

    @property
    def means(self) -> Means | None:
        """Of averaging attachments, by which the last of :attr:`pairs` are coupled."""
        return None

    @property
    def sparse(self) -> tuple[Indices, Indices]:
        """:attr:`pairs` without those that :attr:`means` couple; :meth:`geometric` takes either."""
        return self.pairs

    def mean_stiffness(self, H: Array, multipliers: Array) -> tuple[Array, Array]:
        """``S`` (e, r, 6), and the core ``C`` (w, r, w, r) of ``Sᵀ C S``.

        That is what :meth:`geometric` adds to pairs that are not :attr:`sparse`.
        """
        raise NotImplementedError

    @abstractmethod
    def rates(self, H: Array, v: Array, first: Array, second: Array) -> None:
        """First and second rate at constant twists, into its rows; of velocities: value and rate.

        Targets do not count.
        """

    def initial(self, H: Array) -> Array:
        """Targets of what stays as it is at the start, shape (m,); zero is all others'."""
        return np.zeros(self.m)

    # --- springs and dampers along coordinates ---

    @property
    def springs(self) -> Array:
        """Stiffness, damping and rest value of each, shape (k, 3)."""
        return np.empty((0, 3))

    @property
    def sprung(self) -> Flags:
        """Which of :attr:`pairs` they couple; of that shape."""
        return np.ones(self.pairs[0].shape, dtype=bool)

    def stiffen(self, H: Array, place: Indices, stiff: float, damp: float, K: Array) -> None:
        """Add ``(stiff k + damp c) bᵀb`` of springs and dampers to blocks, as :meth:`geometric`."""
        return  # most sets have none

    def stretch_springs(self, H: Array, h: Array) -> None:
        """Change rest values of springs by what ``h`` (n, 6) changes coordinates, to first order.

        From those of the scene on, so that the springs have the forces of the end of ``h`` at
        frames ``H``.
        """
        return  # most sets have none

    def spring_energy(self, H: Array) -> float:
        """Of all springs."""
        return 0.0

    def damper_loss(self, H: Array, v: Array) -> float:
        """Power that dampers take."""
        return 0.0

    # --- rotations within a step ---

    def follow(self, H: Array, h: Array) -> None:
        """Let reference angles follow the increment ``h`` (n, 6) of nodes, made from ``H``."""
        return  # most sets have no angles

    def mark(self) -> None:
        """Take the reference angles as those of the accepted state."""
        return

    def check_branch(self, H: Array) -> None:
        """Refuse a state in which an angle or an axis may not be the one that is meant.

        Raises:
            LostBranchError: Since the accepted state an angle has changed by more than a quarter
                turn, or bound axes point against each other.
        """
        return

    @property
    def preloaded(self) -> bool:
        """Whether there are springs with a rest value of their own."""
        return False

    def preload(self, H: Array, part: float) -> None:
        """Let such springs act with a part of what their rest value is away from the start.

        Args:
            H: Frames at the start.
            part: That part; 1 is all.
        """
        return

    # --- memory ---

    def accept(self, H: Array) -> None:
        """Remember what frames do not tell of an accepted state.

        Raises:
            ValueError: It is none.
        """
        return  # most sets remember nothing

    @property
    def memory(self) -> tuple[Array, ...]:
        """What :meth:`accept` remembers, to be written into."""
        return ()

    @property
    def memory_keys(self) -> tuple[list[MemoryKey], ...]:
        """What each entry of :attr:`memory` belongs to, whatever else is in a scene."""
        return ()

    # --- results ---

    @abstractmethod
    def wrenches(self, H: Array, v: Array, multipliers: Array, out: Array) -> None:
        """Add force and moment on the side A of items, in its axes there, to rows of items."""

    def coordinates(self, H: Array, out: Array) -> None:
        """Set those of the coordinates of all items that are in this set, shape (c,)."""
        return  # most items have none

    @abstractmethod
    def drawn(self) -> dict[int, tuple[int, Array]]:
        """Row at which each item is drawn, by its number, and where in that row's frame."""

    @property
    @abstractmethod
    def outward(self) -> bool:
        """Whether there are dampers, or what does not move by itself."""


def stacked(parts: Sequence[Array], *shape: int) -> Array:
    """Along the first axis; of the given shape if there are none."""
    return np.concatenate([np.empty(shape), *parts])
