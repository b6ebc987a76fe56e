"""Constraints of frames that slide along flexible beams, across element boundaries."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie.joints.connection import LostBranchError, SlidingConstraintDefinition
from fem_lie.joints.equations import sliding
from fem_lie.joints.equations.sliding import SlidingArrays
from fem_lie.linear.saddle_point import Incidences
from fem_lie.system.constraint_sets.constraint_set import (
    ConstrainedFrames,
    ConstraintSet,
    HistoryKey,
    Numbered,
    Place,
    Start,
    relative_frames,
    stacked,
)


class Slides(ConstraintSet):
    """Set of sliding constraints, see :mod:`fem_lie.joints.equations.sliding`.

    Attributes:
        arrays: Packed arrays of all of them.
    """

    what = "joints that slide along a beam (Sliding, Collar, Sleeve)"

    def __init__(
        self, items: Sequence[Numbered], constrained: ConstrainedFrames, start: Start
    ) -> None:
        """Build the arrays of all sliding joints."""
        found = [
            (given, definition)
            for given in items
            if (definition := given.item.sliding_definition())
        ]
        self.start, self._count = start, constrained.count
        self._items: Indices = np.array([given.number for given, _ in found], dtype=np.int64)
        self._index: Indices = np.array([given.coordinate for given, _ in found], dtype=np.int64)
        self._labels = [given.item.label for given, _ in found]
        definitions = [definition for _, definition in found]
        sizes = [len(definition.selection) for definition in definitions]
        self.owner = np.repeat(self._items, sizes)
        touched = [
            _touched(constrained, definition)
            for definition in definitions
            for _ in definition.selection
        ]
        self.incidences = Incidences.of(touched, constrained.count)
        self.arrays = _table(constrained, definitions, self.incidences, start)
        self.targets = self.arrays.targets
        arrays = self.arrays
        self.angular = ~(arrays.selection[:, :3].any(axis=1) | (arrays.advance != 0.0))
        # the sliding frame and both ends, for each element
        of = np.repeat(arrays.nodes, np.diff(arrays.elements))
        three = np.repeat(np.column_stack([of, arrays.ends])[:, :, np.newaxis], 3, axis=2)
        self.pairs = three, three.transpose(0, 2, 1)

    @property
    def empty(self) -> bool:
        """Whether it has no constraint, spring or coordinate."""
        return len(self.arrays.nodes) == 0

    def evaluate(
        self, H: Array, v: Array, multipliers: Array, scale: Array, count: int, r: Array
    ) -> None:
        """Add constraint forces ``Bᵀλ`` and spring forces to ``r``; set its rows ``scale · Φ``."""
        sliding.evaluate(H, self.arrays, multipliers, scale, count, r)

    def values(self, H: Array, v: Array, out: Array) -> None:
        """Set the violations ``Φ`` or ``W V`` in its rows of ``out``."""
        sliding.state(H, self.arrays, np.empty(len(self._items)), out)

    def jacobian(self, H: Array, rows: Array) -> None:
        """Add ``∂Φ/∂h``, one row of six per incidence, to the constraint Jacobian ``rows``."""
        sliding.jacobian(H, self.arrays, rows)

    def geometric(self, H: Array, multipliers: Array, index: Indices, K: Array) -> None:
        """Add ``∂(Bᵀλ)/∂h`` to blocks ``K``, at ``index`` of each of ``pairs``, −1: none."""
        sliding.geometric(H, self.arrays, multipliers, index, K)

    def rates(self, H: Array, v: Array, first: Array, second: Array) -> None:
        """Set first rates, and second rates by differences of the first along the motion."""
        incidences, own = self.incidences, self.own
        rows = np.zeros((self.start.incidence + len(incidences.nodes), 6))
        speeds = np.abs(v[:, 3:]).max(), np.abs(v[:, :3]).max() / self.arrays.lengths.min()
        time = 1e-5 / max(float(max(speeds)), 1e-300)
        for ahead in (0.0, time, -time):
            moved = H.copy()
            moved[: len(v)] = lie.se3_retract(H[: len(v)], ahead * v)
            rows[:] = 0.0
            sliding.jacobian(moved, self.arrays, rows)
            work = np.einsum("lk,lk->l", rows[self.start.incidence :], v[incidences.nodes])
            rate = np.bincount(incidences.rows, work, minlength=self.m)
            if ahead == 0.0:
                first[own], second[own] = rate, 0.0
            else:
                second[own] += rate / (2.0 * ahead)

    def accept(self, H: Array) -> None:
        """Update history variables that frames do not determine, at an accepted state."""
        arrays, last = self.arrays, self.arrays.elements[1:] - 1
        sliding.state(H, arrays, arrays.arclength, np.zeros(self.own.stop))
        ends = arrays.starts[last] + arrays.lengths[last]
        off = (arrays.arclength < 0.0) | (arrays.arclength > ends)
        if off.any():
            k = int(np.flatnonzero(off)[0])
            raise LostBranchError(
                f"{self._labels[k]} slid off its beam: arclength {arrays.arclength[k]:g} of "
                f"{ends[k]:g}"
            )

    @property
    def history_variables(self) -> tuple[Array, ...]:
        """History variables that :meth:`accept` updates; arrays that may be written."""
        return (self.arrays.arclength,)

    @property
    def history_keys(self) -> tuple[list[HistoryKey], ...]:
        """Joint and coordinate of each history variable, independent of other items."""
        return ([(label, "arclength") for label in self._labels],)

    def wrenches(self, H: Array, v: Array, multipliers: Array, out: Array) -> None:
        """Add force and moment on side A of each item, in its axes there, to the rows of items."""
        sliding.wrenches(H, self.arrays, multipliers, self._items, out)

    def coordinates(self, H: Array, out: Array) -> None:
        """Set the coordinates of its items in ``out``, shape (c,)."""
        coordinates = np.empty(len(self._items))
        sliding.state(H, self.arrays, coordinates, np.zeros(self.own.stop))
        out[self._index] = coordinates

    def places(self) -> dict[int, Place]:
        """Position of the sliding frame; the axes of its force are those of the section there."""
        found = zip(self._items, self.arrays.nodes, self.arrays.frames[:, 0], strict=True)
        return {
            int(item): Place(int(row), np.asarray(offset), None, np.eye(3))
            for item, row, offset in found
        }

    @property
    def outward(self) -> bool:
        """Whether there are dampers, or connections to ground or prescribed motions."""
        return bool((self.arrays.nodes >= self._count).any())


def _touched(constrained: ConstrainedFrames, definition: SlidingConstraintDefinition) -> set[int]:
    """Rows of the sliding frame and of all ends of elements."""
    return {
        constrained.of(definition.b),
        *(int(row) for row in constrained.ends(definition.beam)[0].ravel()),
    }


def _table(
    constrained: ConstrainedFrames,
    definitions: Sequence[SlidingConstraintDefinition],
    incidences: Incidences,
    start: Start,
) -> SlidingArrays:
    first = np.cumsum(
        [0] + [len(definition.selection) for definition in definitions], dtype=np.int64
    )
    nodes = np.array([constrained.of(definition.b) for definition in definitions], dtype=np.int64)
    frames = np.array([definition.frame for definition in definitions]).reshape(-1, 4, 3)
    ends = [constrained.ends(definition.beam) for definition in definitions]
    # constraints of one definition have the same incidences, counted from the first of each
    slider = [
        _from_first(incidences, int(row), [int(node)])
        for row, node in zip(first, nodes, strict=False)
    ]
    of_elements = [
        _from_first(incidences, int(row), both.ravel())
        for row, (both, _) in zip(first, ends, strict=False)
    ]
    return SlidingArrays(
        nodes=nodes,
        frames=relative_frames(constrained, [each.b for each in definitions], frames),
        elements=np.cumsum(
            [0] + [len(definition.starts) for definition in definitions], dtype=np.int64
        ),
        ends=np.concatenate([np.empty((0, 2), dtype=np.int64), *(both for both, _ in ends)]),
        offsets=stacked([offsets for _, offsets in ends], 0, 2, 4, 3),
        starts=stacked([definition.starts for definition in definitions], 0),
        lengths=stacked([definition.beam.model.lengths for definition in definitions], 0),
        first=first,
        selection=stacked([definition.selection for definition in definitions], 0, 12),
        advance=stacked([definition.advance for definition in definitions], 0),
        targets=np.zeros(first[-1]),
        incidences=incidences.ptr[:-1] + start.incidence,
        slider_incidence=np.array(slider, dtype=np.int64).ravel(),
        element_incidences=np.array(
            [incidence for each in of_elements for incidence in each], dtype=np.int64
        ).reshape(-1, 2),
        arclength=np.array([definition.arclength for definition in definitions], dtype=np.float64),
        start=np.array([start.row], dtype=np.int64),
    )


def _from_first(incidences: Incidences, row: int, nodes: Sequence[int] | Indices) -> list[int]:
    """Incidences of a constraint with nodes, counted from its first; −1 where there is none."""
    found = [incidences.at(int(row), int(node)) for node in nodes]
    return [incidence - int(incidences.ptr[row]) if incidence >= 0 else -1 for incidence in found]
