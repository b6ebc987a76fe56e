"""Which of the rotations that frames may mean are meant: angles within a step, bound axes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.joints.connection import LostBranchError
from fem_lie.joints.equations import turns
from fem_lie.joints.equations.functions import ANGLE
from fem_lie.joints.equations.table import JointTable

_QUARTER = 0.5 * np.pi * (1.0 + 1e-9)
"""Change of an angle in one step at most, rad: half of what frames tell apart."""


class Branches:
    """Reference angles of pairs of frames in a step, and the alignment of bound axes."""

    def __init__(
        self, table: JointTable, probes: JointTable, labels: Sequence[str], item: Indices
    ) -> None:
        """Of two tables.

        Args:
            table: Of constraints and springs.
            probes: Of coordinates that results report.
            labels: What items are called in messages.
            item: The item of each pair of ``table``, shape (j,).
        """
        self._table, self._probes = table, probes
        self._labels, self._item = labels, item
        self._accepted = table.turned.copy()
        bound = table.rows < len(table.targets)
        ends = list(zip(table.first[:-1], table.first[1:], strict=True))
        self._counted: Flags = np.array(
            [table.functions[a:b, ANGLE].any() for a, b in ends], dtype=bool
        )
        self._aligned = np.array(
            [turns.fixed_rotations(table.selection[a:b, 3:][bound[a:b]]) for a, b in ends]
        ).reshape(-1, 3, 3)
        self._any_aligned = bool(self._aligned.any())

    def follow(self, H: Array, h: Array) -> None:
        """Let reference angles follow the increment ``h`` (n, 6) of nodes, made from ``H``."""
        turns.foresee(H, h, self._table)
        turns.foresee(H, h, self._probes)

    def mark(self) -> None:
        """Take the reference angles as those of the accepted state."""
        self._accepted[:] = self._table.turned

    def check(self, H: Array) -> None:
        """See the base class of sets.

        Raises:
            LostBranchError: An angle has changed by more than a quarter turn, or axes are opposite.
        """
        table = self._table
        if self._counted.any():
            angles = np.empty(len(table.nodes))
            turns.angles(H, table, angles)
            change = np.where(self._counted, np.abs(angles - self._accepted), 0.0)
            self._refuse(change > _QUARTER, "rotates by more than a quarter turn in one step")
        if self._any_aligned:
            found = np.empty(len(table.nodes))
            turns.alignments(H, table, self._aligned, found)
            self._refuse(found < -0.5, "is half a turn away from where its axes are aligned")

    def _refuse(self, lost: Flags, how: str) -> None:
        if lost.any():
            raise LostBranchError(f"{self._labels[self._item[int(lost.argmax())]]} {how}")
