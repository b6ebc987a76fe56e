"""Forces of terms on some master nodes, from the cells around these only."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.forms.cell_forms import FormArrays, add_forces
from fem_lie.forms.term import NearCells
from fem_lie.system.nodes.sums import PlainAttached, add_attached


class AttachedCells:
    """Cells with rigidly attached nodes.

    Attributes:
        plain: Arrays for :func:`~fem_lie.system.nodes.sums.add_attached`.
    """

    def __init__(self, table: FormArrays, master: Indices, offset: Array) -> None:
        """Store the master nodes.

        Args:
            table: The cells.
            master: Master node of each node in the numbering of the table, shape (k,).
            offset: Frames of these in those of their master nodes, shape (k, 4, 3).
        """
        used, nodes = np.unique(table.nodes, return_inverse=True)
        frames, forces = np.empty((len(used), 4, 3)), np.empty((len(used), 6))
        cells = table.rows, nodes.ravel().astype(np.int64)
        self.plain: PlainAttached = master[used], offset[used], frames, forces, *cells

    def add_forces(self, H: Array, out: Array) -> None:
        """Add the forces of the cells to ``out``."""
        if len(self.plain[0]):
            add_attached(H, self.plain, out.reshape(-1))


class NearTerms:
    """Cells of several terms around some nodes."""

    def __init__(self, cells: FormArrays, others: Sequence[NearCells]) -> None:
        """Store the cells.

        Args:
            cells: Cells of master nodes.
            others: All other cells.
        """
        self._cells, self._others = (cells.rows, cells.nodes), tuple(others)

    def add_forces(self, H: Array, out: Array) -> None:
        """Add the forces of the cells to ``out``."""
        if len(self._cells[0]):
            add_forces(H, self._cells, out.reshape(-1))
        for other in self._others:
            other.add_forces(H, out)
