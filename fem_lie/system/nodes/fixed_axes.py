"""Supports along axes fixed in space, by transformed unknowns.

A node that moves by ``x + R u`` may have the unknowns ``w = A R u`` instead, along the rows of
``A``; holding some of them is exact, as the position is linear in them. Unlike constraints with
multipliers, such supports keep the matrix positive definite.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie.lie.node_types import wrench
from fem_lie.lie.tuples import store


@compiled
def wrenches(
    kinds: Indices, H: Array, local: Array, held: npt.NDArray[np.bool_], nodes: Indices
) -> Array:
    """Support reactions in global components, shape (s, 6).

    Args:
        kinds: Types of the nodes, (n,).
        H: Frames.
        local: Forces and moments in the nodal axes, (n, 6).
        held: Whether a component is a reaction, (n, 6).
        nodes: Supported nodes, (s,).
    """
    found, of_held = np.zeros((len(nodes), 6)), np.empty(6)
    for row, i in enumerate(nodes):
        for k in range(6):
            of_held[k] = local[i, k] if held[i, k] else 0.0
        force, moment = wrench(kinds[i], H[i], of_held)
        store(found[row], 0, force)
        store(found[row], 3, moment)
    return found


class Supports:
    """Transformation between local unknowns of supported nodes and those along fixed axes.

    Attributes:
        nodes: Supported nodes, shape (k,).
    """

    def __init__(self, axes: Array, constrained: Indices) -> None:
        """Find the supported nodes; :meth:`find` finds their blocks.

        Args:
            axes: Rows ``A`` of all nodes, nan where unknowns are local, shape (n, 3, 3).
            constrained: Node of each incidence of the constraints.
        """
        self.nodes: Indices = np.flatnonzero(np.isfinite(axes[:, 0, 0]))
        self._axes = axes[self.nodes]
        self._number = np.full(len(axes), -1)
        self._number[self.nodes] = np.arange(len(self.nodes))
        self.find_constraints(constrained)

    def find_constraints(self, constrained: Indices) -> None:
        """Find the supported nodes in the constraint Jacobian.

        Args:
            constrained: Node of each row of the constraint Jacobian.
        """
        of_nodes = self._number[constrained]
        self._constrained: Indices = np.flatnonzero(of_nodes >= 0)
        self._constrained_of = of_nodes[self._constrained]

    def find(self, indptr: Indices, indices: Indices) -> None:
        """Find the blocks of the nodes in a pattern.

        Args:
            indptr: First pair of each row of the pattern of node pairs, shape (n + 1,).
            indices: Column of each pair.
        """
        rows = self._number[np.repeat(np.arange(len(indptr) - 1), np.diff(indptr))]
        columns = self._number[indices]
        self._rows, self._columns = np.flatnonzero(rows >= 0), np.flatnonzero(columns >= 0)
        self._row_of, self._column_of = rows[self._rows], columns[self._columns]

    def __bool__(self) -> bool:
        """Whether there are supported nodes."""
        return len(self.nodes) > 0

    def rotate(self, H: Array, r: Array) -> None:
        """Transform translations of ``r`` (n, 6) from local components to those along the axes."""
        if self:
            r[self.nodes, :3] = np.einsum("kij,kj->ki", self._matrices(H), r[self.nodes, :3])

    def rotate_back(self, H: Array, d: Array) -> None:
        """Transform translations of ``d`` (n, 6) from components along the axes to local ones."""
        if self:
            d[self.nodes, :3] = np.einsum("kji,kj->ki", self._matrices(H), d[self.nodes, :3])

    def rotate_blocks(self, H: Array, blocks: Array) -> None:
        """Transform rows and columns of the matrix, blocks (nnz, 6, 6)."""
        Q = self._matrices(H)
        rows, columns = self._rows, self._columns
        blocks[rows, :3] = Q[self._row_of] @ blocks[rows, :3]
        blocks[columns, :, :3] = blocks[columns, :, :3] @ Q[self._column_of].transpose(0, 2, 1)

    def rotate_constraints(self, H: Array, rows: Array) -> None:
        """Transform the constraint Jacobian, one row of six per incidence."""
        if len(self._constrained):
            Q = self._matrices(H)[self._constrained_of]
            rows[self._constrained, :3] = np.einsum("kij,kj->ki", Q, rows[self._constrained, :3])

    def _matrices(self, H: Array) -> Array:
        """``A R`` of the supported nodes, shape (k, 3, 3)."""
        return self._axes @ H[self.nodes, 1:].transpose(0, 2, 1)
