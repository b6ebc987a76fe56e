"""Springs between nodes of rods, three each, as a term of a system."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.forms.cell_forms import FormTable
from fem_lie.forms.cell_sums import CellSum, Pattern
from fem_lie.forms.term import Pairs, Term


class _Data(Protocol):
    @property
    def nodes(self) -> Indices:
        """Of each spring, shape (b, 3)."""


class Springs(Term):
    """What kernels of energy, forces and matrix sum over nodes.

    Attributes:
        springs: What they are.
    """

    of_bodies = True

    def __init__(self, kernels: Sequence[Any], values: Array, springs: _Data, count: int) -> None:
        """Bind the kernels.

        Args:
            kernels: Compiled functions for energy, forces and matrix.
            values: Of each spring, behind room for the rows of its nodes, shape (b, any).
            springs: What they are.
            count: Number of nodes of the assembly.
        """
        nodes = springs.nodes
        none = np.zeros(1), np.zeros((len(nodes), 1))
        self._energy, self._forces, self._matrix = (
            CellSum(nodes, kernel.address, values.copy(), *none) for kernel in kernels
        )
        self._pattern = Pattern.of(nodes, count)
        self.springs, self._count = springs, count

    @property
    def pairs(self) -> Pairs:
        """Nodes of each spring with each other."""
        rows = np.repeat(np.arange(self._count), np.diff(self._pattern.indptr))
        return rows, self._pattern.indices

    @property
    def tables(self) -> tuple[FormTable, FormTable]:
        """Forces and energy."""
        return self._forces.table, self._energy.table

    @property
    def contents(self) -> _Data:
        """The springs."""
        return self.springs

    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """Add the forces of all springs."""
        self._forces.add_vector(H, out.reshape(-1))

    def tangent(self, H: Array, kept: Array) -> Array:
        """Their derivative at frames ``H``."""
        return self._matrix.matrix(H, self._pattern)

    def add_tangent(self, H: Array, kept: Array, place: Indices, K: Array) -> None:
        """See the base class."""
        self._matrix.add_matrix(H, self._pattern, place, K)

    def energy(self, H: Array) -> float:
        """Of all springs."""
        return self._energy.scalar(H)
