"""State of the cells between steps by their nodes, from which other ranks restart.

Frames without the digits beyond double precision do not determine energies and forces, nor the work
on a cell that differs from its energy, which later steps correct, nor the filter states of forces.
They belong to pairs of a cell and one of its nodes, see
:class:`~fem_lie.solve.recording.whole_state.MovingState`; energy and work to node -1.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.forms.cells import Cells
from fem_lie.lie.node_types.floating import nodes_of
from fem_lie.solve.conserving.step.records import State
from fem_lie.solve.conserving.vector_cells.cell_arrays import VectorCells
from fem_lie.system.equations import Equations

_ROWS = 2
"""Rows of twelve numbers for the 13 filter states of a modal coordinate and its products."""


class CellState:
    """State of all cells and reduced-order bodies of a scene or a part.

    Attributes:
        pairs: Nodes of the cell and the node of each pair, in the numbering of all nodes, shape (c,
            w + 1). Cells of other parts are left out.
    """

    def __init__(
        self,
        equations: Equations,
        cells: Cells,
        vector_cells: VectorCells,
        s: State,
        *,
        dissipates: bool,
    ) -> None:
        """Find the pairs.

        Args:
            equations: Equations of the scene or part.
            cells: Cells of frames.
            vector_cells: Cells of nodes other than frames.
            s: State between steps.
            dissipates: Whether forces have filter states.
        """
        self._s, self._dissipates = s, dissipates
        masters, modes = equations.unknowns.masters, equations.arrays.floating
        firsts = [int(nodes_of(modes.integers, body)[0]) for body in range(len(modes.sizes))]
        reduced = masters[np.array(firsts, dtype=np.int64)]
        tables = (
            (cells.table.first, cells.table.nodes),
            (vector_cells.first, masters[vector_cells.nodes]),
            (np.arange(len(reduced) + 1), reduced),
        )
        width = max(int(np.diff(first).max(initial=0)) for first, _ in tables)
        found = [_nodes_of_cells(first, nodes, width) for first, nodes in tables]
        whole = np.concatenate(found)
        parts = [np.column_stack([whole, np.full(len(whole), -1)])]
        if dissipates:
            times = np.diff(tables[0][0]), np.diff(tables[1][0]), _ROWS * modes.sizes
            at = tables[0][1], tables[1][1], np.repeat(reduced, times[2])
            each = zip(found, times, at, strict=True)
            parts += [np.column_stack([np.repeat(a, k, axis=0), b]) for a, k, b in each]
        every = np.concatenate(parts)
        self._own = ~_among(every[:, :-1], _neighbours(equations, width))
        self.pairs: Indices = every[self._own]

    @property
    def values(self) -> Array:
        """State of each pair, (c, 12)."""
        s = self._s
        whole = np.zeros((len(s.W), 12))
        whole[:, 0], whole[:, 1] = s.account, s.W
        if not self._dissipates:
            return whole[self._own]
        p = len(s.within)
        modal = np.zeros((p, 12 * _ROWS))
        modal[:, :12], modal[:, 12] = s.w[len(s.w) - p :].reshape(p, 12), s.within
        vectors = np.concatenate([*s.cell_forces.reshape(2, -1, 6)], axis=1)
        frames, modal = np.hstack([s.F, s.w_F]), modal.reshape(-1, 12)
        return np.concatenate([whole, frames, vectors, modal])[self._own]

    def restore(self, values: Array) -> None:
        """Set the state of each pair, (c, 12)."""
        s, p = self._s, len(self._s.within)
        ends = np.cumsum([len(s.W), len(s.w_F), s.cell_forces.shape[1]])
        every = np.zeros((len(self._own), 12))
        every[self._own] = values
        whole, of_frames, of_vectors, modal = np.split(every, ends)
        s.account[:], s.W[:] = whole[:, 0], whole[:, 1]
        if self._dissipates:
            s.F[:], s.w_F[:] = np.hsplit(of_frames, 2)
            s.cell_forces[:] = of_vectors.reshape(-1, 2, 2, 3).swapaxes(0, 1)
            modal = modal.reshape(p, 12 * _ROWS)
            s.w[len(s.w) - p :], s.within[:] = modal[:, :12].reshape(p, 4, 3), modal[:, 12]


def _nodes_of_cells(first: Indices, nodes: Indices, width: int) -> Indices:
    """Nodes of each cell, -1 where it has fewer than ``width``, shape (M, width).

    Args:
        first: Index of the first node of each cell in ``nodes``, shape (M + 1,).
        nodes: Nodes of the cells.
        width: Largest number of nodes of a cell.
    """
    cell = np.repeat(np.arange(len(first) - 1), np.diff(first))
    found = np.full((len(first) - 1, width), -1)
    found[cell, np.arange(len(nodes)) - first[cell]] = nodes
    return found


def _neighbours(equations: Equations, width: int) -> Indices:
    """Nodes of cells that are those of other parts, as :func:`_nodes_of_cells`."""
    bodies = zip(equations.scene.bodies, equations.info.bodies, strict=True)
    found = [np.empty((0, width), dtype=np.int64)]
    for body, info in bodies:
        cells = info.nodes[body.model.neighbour_cells]
        missing = np.full((len(cells), width - cells.shape[1]), -1)
        found.append(np.column_stack([cells, missing]))
    return np.concatenate(found)


def _among(cells: Indices, others: Indices) -> Flags:
    """Which cells have the same nodes as one of the others, shape (c,)."""
    both = np.sort(np.concatenate([cells, others]), axis=1)
    numbers = np.unique(both, axis=0, return_inverse=True)[1].ravel()
    return np.isin(numbers[: len(cells)], numbers[len(cells) :])
