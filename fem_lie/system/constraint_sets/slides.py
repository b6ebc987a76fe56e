"""Constraints of what slides along flexible beams, over all of their elements."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie.joints import SlidingTie
from fem_lie.joints.equations import sliding
from fem_lie.joints.equations.sliding import SlidingTable
from fem_lie.linear.bordered import Border
from fem_lie.system.constraint_sets.constraint_set import (
    ConstraintSet,
    MemoryKey,
    Numbered,
    Rows,
    Start,
    in_rows,
    stacked,
)


class Slides(ConstraintSet):
    """See :mod:`fem_lie.joints.equations.sliding`.

    Attributes:
        table: Of all of them.
    """

    what = "joints that slide along a beam (Sliding, Collar, Sleeve)"

    def __init__(self, items: Sequence[Numbered], rows: Rows, start: Start) -> None:
        """Table what slides."""
        found = [(given, tie) for given in items if (tie := given.item.sliding_tie())]
        self.start, self._count = start, rows.count
        self._items: Indices = np.array([given.number for given, _ in found], dtype=np.int64)
        self._place: Indices = np.array([given.coordinate for given, _ in found], dtype=np.int64)
        self._labels = [given.item.label for given, _ in found]
        ties = [tie for _, tie in found]
        sizes = [len(tie.selection) for tie in ties]
        self.owner = np.repeat(self._items, sizes)
        touched = [_touched(rows, tie) for tie in ties for _ in tie.selection]
        self.border = Border.of(touched, rows.count)
        self.table = _table(rows, ties, self.border, start)
        self.targets = self.table.targets
        table = self.table
        self.angular = ~(table.selection[:, :3].any(axis=1) | (table.advance != 0.0))
        # the frame and both ends, for each element
        of = np.repeat(table.nodes, np.diff(table.elements))
        three = np.repeat(np.column_stack([of, table.ends])[:, :, np.newaxis], 3, axis=2)
        self.pairs = three, three.transpose(0, 2, 1)

    @property
    def empty(self) -> bool:
        """See the base class."""
        return len(self.table.nodes) == 0

    def evaluate(
        self, H: Array, v: Array, weights: Array, scale: Array, count: int, r: Array
    ) -> None:
        """See the base class."""
        sliding.evaluate(H, self.table, weights, scale, count, r)

    def values(self, H: Array, v: Array, out: Array) -> None:
        """See the base class."""
        sliding.state(H, self.table, np.empty(len(self._items)), out)

    def jacobian(self, H: Array, legs: Array) -> None:
        """See the base class."""
        sliding.jacobian(H, self.table, legs)

    def geometric(self, H: Array, weights: Array, place: Indices, K: Array) -> None:
        """See the base class."""
        sliding.geometric(H, self.table, weights, place, K)

    def rates(self, H: Array, v: Array, first: Array, second: Array) -> None:
        """The second by differences of the first along the motion."""
        border, own = self.border, self.own
        legs = np.zeros((self.start.leg + len(border.nodes), 6))
        speeds = np.abs(v[:, 3:]).max(), np.abs(v[:, :3]).max() / self.table.lengths.min()
        time = 1e-5 / max(float(max(speeds)), 1e-300)
        for ahead in (0.0, time, -time):
            moved = H.copy()
            moved[: len(v)] = lie.se3_retract(H[: len(v)], ahead * v)
            legs[:] = 0.0
            sliding.jacobian(moved, self.table, legs)
            work = np.einsum("lk,lk->l", legs[self.start.leg :], v[border.nodes])
            rate = np.bincount(border.rows, work, minlength=self.m)
            if ahead == 0.0:
                first[own], second[own] = rate, 0.0
            else:
                second[own] += rate / (2.0 * ahead)

    def accept(self, H: Array) -> None:
        """See the base class."""
        table, last = self.table, self.table.elements[1:] - 1
        sliding.state(H, table, table.arclength, np.zeros(self.own.stop))
        ends = table.starts[last] + table.lengths[last]
        off = (table.arclength < 0.0) | (table.arclength > ends)
        if off.any():
            k = int(np.flatnonzero(off)[0])
            raise ValueError(
                f"{self._labels[k]} slid off its beam: arclength {table.arclength[k]:g} of "
                f"{ends[k]:g}"
            )

    @property
    def memory(self) -> tuple[Array, ...]:
        """See the base class."""
        return (self.table.arclength,)

    @property
    def memory_keys(self) -> tuple[list[MemoryKey], ...]:
        """See the base class."""
        return ([(label, "arclength") for label in self._labels],)

    def wrenches(self, H: Array, v: Array, weights: Array, out: Array) -> None:
        """See the base class."""
        sliding.wrenches(H, self.table, weights, self._items, out)

    def coordinates(self, H: Array, out: Array) -> None:
        """See the base class."""
        places = np.empty(len(self._items))
        sliding.state(H, self.table, places, np.zeros(self.own.stop))
        out[self._place] = places

    def drawn(self) -> dict[int, tuple[int, Array]]:
        """Where the frame is that slides."""
        found = zip(self._items, self.table.nodes, self.table.frames[:, 0], strict=True)
        return {int(item): (int(node), np.asarray(place)) for item, node, place in found}

    @property
    def outward(self) -> bool:
        """See the base class."""
        return bool((self.table.nodes >= self._count).any())


def _touched(rows: Rows, tie: SlidingTie) -> set[int]:
    """The frame and all ends of elements."""
    return {rows.of(tie.b), *(int(row) for row in rows.ends(tie.beam)[0].ravel())}


def _table(rows: Rows, ties: Sequence[SlidingTie], border: Border, start: Start) -> SlidingTable:
    first = np.cumsum([0] + [len(tie.selection) for tie in ties], dtype=np.int64)
    nodes = np.array([rows.of(tie.b) for tie in ties], dtype=np.int64)
    frames = np.array([tie.frame for tie in ties]).reshape(-1, 4, 3)
    ends = [rows.ends(tie.beam) for tie in ties]
    # legs of one tie's constraints are alike: all are counted from the first leg of each
    slider = [
        _from_first(border, int(row), [int(node)]) for row, node in zip(first, nodes, strict=False)
    ]
    of_elements = [
        _from_first(border, int(row), both.ravel())
        for row, (both, _) in zip(first, ends, strict=False)
    ]
    return SlidingTable(
        nodes=nodes,
        frames=in_rows(rows, nodes, frames),
        elements=np.cumsum([0] + [len(tie.starts) for tie in ties], dtype=np.int64),
        ends=np.concatenate([np.empty((0, 2), dtype=np.int64), *(both for both, _ in ends)]),
        offsets=stacked([offsets for _, offsets in ends], 0, 2, 4, 3),
        starts=stacked([tie.starts for tie in ties], 0),
        lengths=stacked([tie.beam.lengths for tie in ties], 0),
        first=first,
        selection=stacked([tie.selection for tie in ties], 0, 12),
        advance=stacked([tie.advance for tie in ties], 0),
        targets=np.zeros(first[-1]),
        legs=border.ptr[:-1] + start.leg,
        slider_leg=np.array(slider, dtype=np.int64).ravel(),
        element_legs=np.array(
            [leg for legs in of_elements for leg in legs], dtype=np.int64
        ).reshape(-1, 2),
        arclength=np.array([tie.arclength for tie in ties], dtype=np.float64),
        start=np.array([start.row], dtype=np.int64),
    )


def _from_first(border: Border, row: int, nodes: Sequence[int] | Indices) -> list[int]:
    """Legs of a constraint at nodes, counted from its first one; −1 where there is none."""
    legs = [border.leg(int(row), int(node)) for node in nodes]
    return [leg - int(border.ptr[row]) if leg >= 0 else -1 for leg in legs]
