"""Forces of terms on some of the leaders, from the cells around these alone."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.forms.cell_forms import FormTable, add_cells
from fem_lie.forms.term import NearCells
from fem_lie.system.nodes.attachment import collect, expand


class FollowingCells:
    """Cells whose nodes follow others."""

    def __init__(self, table: FormTable, leader: Indices, offset: Array) -> None:
        """Keep the leaders of their nodes.

        Args:
            table: The cells.
            leader: Of all nodes that the table numbers, shape (k,).
            offset: Frames of these in their leaders' frames, shape (k, 4, 3).
        """
        used, nodes = np.unique(table.nodes, return_inverse=True)
        self._table = table.rows, nodes.ravel().astype(np.int64)
        self._leader, self._offset = leader[used], offset[used]
        self._frames, self._forces = np.empty((len(used), 4, 3)), np.empty((len(used), 6))

    def add_forces(self, H: Array, out: Array) -> None:
        """See the protocol."""
        expand(H, self._leader, self._offset, self._frames)
        self._forces[:] = 0.0
        add_cells(self._frames, self._table, 6, self._forces.reshape(-1))
        collect(self._forces, self._leader, self._offset, out)


class NearTerms:
    """Those of several terms."""

    def __init__(self, cells: FormTable, others: Sequence[NearCells]) -> None:
        """Keep them.

        Args:
            cells: Of nodes that lead.
            others: All others.
        """
        self._cells, self._others = (cells.rows, cells.nodes), tuple(others)

    def add_forces(self, H: Array, out: Array) -> None:
        """See the protocol."""
        if len(self._cells[0]):
            add_cells(H, self._cells, 6, out.reshape(-1))
        for other in self._others:
            other.add_forces(H, out)
