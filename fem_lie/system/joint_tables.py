"""Tables of numbers for compiled loops from the ties of joints and what acts along them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Flags
from fem_lie.bodies.body import Point
from fem_lie.joints import SlidingTie, Tie, VelocityTie
from fem_lie.joints.equations.rolling import RollingTable
from fem_lie.joints.equations.sliding import SlidingTable
from fem_lie.joints.equations.table import JointTable, PackedJoints, pack
from fem_lie.linear.bordered import Border
from fem_lie.system.nodes.numbering import Numbering


class Pair(NamedTuple):
    """A tie between two nodes, perhaps with its sides exchanged, and the rows of its terms.

    Attributes:
        tie: What is tied.
        nodes: Of its sides A and B.
        rows: Constraint of each term, −1 for that of a spring.
        exchanged: Whether the user's side A is B here.
    """

    tie: Tie
    nodes: tuple[int, int]
    rows: Sequence[int]
    exchanged: bool


class Tables:
    """Makes tables from ties.

    Args:
        numbering: Of the nodes.
        frames: Initial frames of all rows: moving nodes, ground, prescribed motions.
        held: Which unknowns of the moving nodes are zero, shape (n, 6).
    """

    def __init__(self, numbering: Numbering, frames: Array, held: Flags) -> None:
        self._numbering, self._frames = numbering, frames
        self._still = np.append(held.all(axis=1), [True] * (len(frames) - numbering.count))

    def pair(self, tie: Tie, first: int) -> Pair:
        """With a side that moves as A: what touches ``Δ`` alone has a constant Jacobian there."""
        nodes = self.nodes(tie.a, tie.b)
        rows = [first + row if row >= 0 else -1 for row in tie.rows]
        if tie.reversible and self._still[nodes[0]] and not self._still[nodes[1]]:
            return Pair(tie.exchanged(), nodes[::-1], rows, True)
        return Pair(tie, nodes, rows, False)

    def nodes(self, a: Point, b: Point) -> tuple[int, int]:
        """Of two points."""
        return self._numbering.node(a), self._numbering.node(b)

    def border(self, touched: Sequence[set[int]]) -> Border:
        """From the nodes that each constraint touches."""
        return Border.of(touched, self._numbering.count)

    def joints(
        self,
        pairs: Sequence[Pair],
        m: int,
        springs: Sequence[tuple[float, float, float]],
        border: Border | None = None,
    ) -> PackedJoints:
        """Of ``m`` constraints; without a border there are no legs."""
        number = iter(range(m, m + len(springs)))
        rows = [row if row >= 0 else next(number) for pair in pairs for row in pair.rows]
        terms = np.array(rows, dtype=np.int64)
        both = [pair.nodes for pair in pairs for _ in pair.rows]
        nodes = np.array(both, dtype=np.int64).reshape(-1, 2)
        legs = np.full_like(nodes, -1) if border is None else border.legs(terms, nodes)
        table = JointTable(
            nodes=np.array([pair.nodes for pair in pairs], dtype=np.int64).reshape(-1, 2),
            frames=self._in_nodes([(pair.nodes, pair.tie.frames) for pair in pairs]),
            first=np.cumsum([0] + [len(pair.rows) for pair in pairs], dtype=np.int64),
            selection=_stacked([pair.tie.selection for pair in pairs], (0, 12)),
            functions=_stacked([pair.tie.functions for pair in pairs], (0, 3)),
            rows=terms,
            legs=legs,
            angle=np.array([pair.tie.angle for pair in pairs]).reshape(-1, 2, 12),
            curved=np.array([pair.tie.functions.any() for pair in pairs], dtype=np.int64),
            turned=np.zeros(len(pairs)),
            targets=np.zeros(m),
            springs=np.array(springs, dtype=np.float64).reshape(-1, 3),
        )
        return pack(table)

    def rolling(self, ties: Sequence[VelocityTie], start: int, border: Border) -> RollingTable:
        """Of the constraints of velocities, which begin at ``start``."""
        nodes = [self.nodes(tie.a, tie.b) for tie in ties]
        first = np.cumsum([0] + [len(tie.selection) for tie in ties], dtype=np.int64)
        owner = np.repeat(np.arange(len(ties)), np.diff(first))
        legs = [[border.leg(start + row, n) for n in nodes[k]] for row, k in enumerate(owner)]
        return RollingTable(
            nodes=np.array(nodes, dtype=np.int64).reshape(-1, 2),
            frames=self._in_nodes(list(zip(nodes, (tie.frames for tie in ties), strict=True))),
            first=first,
            selection=_stacked([tie.selection for tie in ties], (0, 6)),
            radius=np.array([tie.radius for tie in ties], dtype=np.float64),
            legs=np.array(legs, dtype=np.int64).reshape(-1, 2),
            start=np.array([start], dtype=np.int64),
        )

    def sliding(self, ties: Sequence[SlidingTie], start: int, border: Border) -> SlidingTable:
        """Of the constraints of sliding frames, which begin at ``start``."""
        attachment, first = self._numbering.attachment, [0]
        nodes, frames, legs, slider_legs = [], [], [], []
        ends, offsets, element_legs = [], [], []
        for tie in ties:
            row = start + first[-1]
            node = self._numbering.node(tie.b)
            nodes.append(node)
            frames.append(lie.se3_compose(lie.se3_inverse(self._frames[node]), tie.frame))
            legs += [int(border.ptr[row + k]) for k in range(len(tie.selection))]
            leg = border.leg(row, node)
            slider_legs.append(leg - legs[-len(tie.selection)] if leg >= 0 else -1)
            both = self._numbering.nodes[tie.beam][tie.beam.elements[:, :2]]
            ends.append(attachment.leader[both])
            offsets.append(attachment.offset[both])
            element_legs.append(
                [[border.leg(row, n) - border.ptr[row] for n in e] for e in ends[-1]]
            )
            first.append(first[-1] + len(tie.selection))
        counts = [len(tie.starts) for tie in ties]
        k = first[-1]
        return SlidingTable(
            nodes=np.array(nodes, dtype=np.int64),
            frames=np.array(frames).reshape(-1, 4, 3),
            elements=np.cumsum([0, *counts], dtype=np.int64),
            ends=np.concatenate([np.empty((0, 2), dtype=np.int64), *ends]),
            offsets=np.concatenate([np.empty((0, 2, 4, 3)), *offsets]),
            starts=np.concatenate([np.empty(0), *(tie.starts for tie in ties)]),
            lengths=np.concatenate([np.empty(0), *(tie.beam.lengths for tie in ties)]),
            first=np.array(first, dtype=np.int64),
            selection=_stacked([tie.selection for tie in ties], (0, 12)),
            advance=np.concatenate([np.empty(0), *(tie.advance for tie in ties)]),
            targets=np.zeros(k),
            legs=np.array(legs, dtype=np.int64),
            slider_leg=np.array(slider_legs, dtype=np.int64),
            element_legs=np.array(
                [e for group in element_legs for e in group], dtype=np.int64
            ).reshape(-1, 2),
            arclength=np.array([tie.arclength for tie in ties], dtype=np.float64),
            start=np.array([start], dtype=np.int64),
        )

    def sliding_nodes(self, tie: SlidingTie) -> set[int]:
        """Of the frame and all ends of elements."""
        leader = self._numbering.attachment.leader
        beam = leader[self._numbering.nodes[tie.beam][tie.beam.elements[:, :2]]]
        return {self._numbering.node(tie.b), *(int(n) for n in beam.ravel())}

    def _in_nodes(self, pairs: Sequence[tuple[tuple[int, int], tuple[Array, Array]]]) -> Array:
        """Frames of pairs in those of their nodes, shape (j, 2, 4, 3)."""
        nodes = np.array([nodes for nodes, _ in pairs], dtype=np.int64).reshape(-1, 2)
        frames = np.array([frames for _, frames in pairs]).reshape(-1, 2, 4, 3)
        return lie.se3_compose(lie.se3_inverse(self._frames[nodes]), frames)


def _stacked(parts: Sequence[Array], shape: tuple[int, int]) -> Array:
    return np.concatenate([np.empty(shape), *parts])
