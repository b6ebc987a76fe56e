"""Springs between nodes of rods, three each, as a term of a system."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.forms.cell_sums import CellSum, CellTerm, Pattern


class _Data(Protocol):
    @property
    def nodes(self) -> Indices:
        """Of each spring, shape (b, 3)."""


class Springs(CellTerm):
    """What kernels of energy, forces and matrix sum over nodes.

    Attributes:
        springs: What they are.
    """

    of_bodies = True

    def __init__(self, kernels: Sequence[Any], values: Array, springs: _Data, count: int) -> None:
        """Bind the kernels.

        Args:
            kernels: Compiled functions for energy, forces and matrix.
            values: Of each spring, which come behind the rows of its nodes, shape (b, any).
            springs: What they are.
            count: Number of nodes of the assembly.
        """
        nodes, data = springs.nodes, np.ascontiguousarray(values, dtype=np.float64)
        none = np.zeros(1), np.zeros((len(nodes), 1))
        self._energy, self._forces, self._matrix = (
            CellSum(nodes, kernel.address, data, *none, apart=True) for kernel in kernels
        )
        self._pattern = Pattern.of(nodes, count)
        self.springs = springs

    @property
    def contents(self) -> _Data:
        """The springs."""
        return self.springs
