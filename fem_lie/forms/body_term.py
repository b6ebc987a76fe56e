"""All bodies of one kind as one term on their nodes, wherever its sums over cells come from."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices
from fem_lie.forms.cell_sums import Pattern
from fem_lie.forms.term import Pairs, Term, add_at


@dataclass(frozen=True, eq=False)
class NodalInertia:
    """Constant blocks of (x, d₁, d₂, d₃) in the pattern of a :class:`BodyTerm`.

    Attributes:
        mass: Shape (nnz, r, r), of the first ``r`` of these rows where others have none.
        damping: The same of mass-proportional damping, or ``None`` without.
    """

    mass: Array
    damping: Array | None = None


class BodyTerm(Term):
    """Elastic forces, tangent, energy and inertia of all bodies of one kind.

    Attributes:
        cells: Nodes of each cell, shape (m, k).
        count: Number of nodes.
        order: Node of this term for each node of the bodies, one body after the other.
        cell_order: Likewise its cells.
        indptr: Rows of the pattern of node pairs, with ``indices``.
        inertia: In that pattern, or ``None`` without mass.
        around: If the axes of its nodes are to follow the motion, factors ``b_ik`` of each pair in
            that pattern, shape (nnz, 3): around node i the mean deformation is ``Σ x_k ⊗ b_ik``.
        beside: Other terms on its nodes.
    """

    label, of_bodies = "elements", True

    def __init__(
        self, cells: npt.NDArray[np.integer[Any]], order: Indices, cell_order: Indices
    ) -> None:
        """Find the pattern; for the arguments see the class."""
        self.cells, self.order, self.cell_order = cells, order, cell_order
        self.count = len(order)
        self.inertia: NodalInertia | None = None
        self.around: Array | None = None
        self.beside: list[Term] = []
        self._pattern = Pattern.of(cells, self.count)
        self.indptr, self.indices = self._pattern.indptr, self._pattern.indices

    @cached_property
    def pairs(self) -> Pairs:
        """Those of the pattern."""
        rows = np.repeat(np.arange(self.count), np.diff(self.indptr))
        return rows, self.indices.astype(np.int64)

    def summed(self, elements: Array) -> Array:
        """Blocks of element matrices (m, k, b, k, b) in the pattern, shape (nnz, b, b)."""
        size = elements.shape[2]
        blocks = np.zeros((len(self.indices), size, size))
        pairs = elements.transpose(0, 1, 3, 2, 4).reshape(-1, size, size)
        add_at(blocks, self._pattern.place, pairs)
        return blocks

    @property
    def carried_stress(self) -> Array:
        """A copy of its stress, flat; empty without."""
        update = self.stress_update
        return np.empty(0) if update is None else update.carried.copy()

    def reset(self, carried: Array) -> None:
        """Be as when it was made; ``carried``: :attr:`carried_stress` then."""
        if self.stress_update is not None:
            self.stress_update.restore(carried)
        for term in self.beside:
            if term.stress_update is not None:
                term.stress_update.clear_stress()

    def set_eigenstrain(self, values: Array) -> None:
        """Strains without stress of the bodies' cells, one body after the other.

        Raises:
            NotImplementedError: The bodies have no eigenstrain.
        """
        raise NotImplementedError(
            f"{type(self).__name__} ({self.label}) has no eigenstrain: expected bodies along lines"
        )
