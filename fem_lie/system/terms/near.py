"""Forces of terms on some of the master nodes, from the cells around these alone."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.forms.cell_forms import FormTable, add_cells
from fem_lie.forms.term import NearCells
from fem_lie.system.nodes.sums import PlainAttached, add_attached


class AttachedCells:
    """Cells whose nodes follow others.

    Attributes:
        plain: For :func:`~fem_lie.system.nodes.sums.add_following`.
    """

    def __init__(self, table: FormTable, master: Indices, offset: Array) -> None:
        """Keep the master nodes of their nodes.

        Args:
            table: The cells.
            master: Of all nodes that the table numbers, shape (k,).
            offset: Frames of these in their master nodes' frames, shape (k, 4, 3).
        """
        used, nodes = np.unique(table.nodes, return_inverse=True)
        frames, forces = np.empty((len(used), 4, 3)), np.empty((len(used), 6))
        cells = table.rows, nodes.ravel().astype(np.int64)
        self.plain: PlainAttached = master[used], offset[used], frames, forces, *cells

    def add_forces(self, H: Array, out: Array) -> None:
        """See the protocol."""
        if len(self.plain[0]):
            add_attached(H, self.plain, out.reshape(-1))


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
