"""Points along seams of thin shells, as a term of a system; see :mod:`.seam_kernels`."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.elements.rods.springs import Springs
from fem_lie.elements.thin_shells.seam_kernels import (
    STRESS,
    carry_stress,
    energy_kernel,
    force_kernel,
    matrix_kernel,
)
from fem_lie.forms.cell_sums import CarryingCellTerm


class SeamPoints(NamedTuple):
    """Points along seams.

    Attributes:
        nodes: Of the cell on one side, then of that on the other, shape (b, 16).
        sizes: Of both cells, see :mod:`.rows`, shape (b, 6).
        shapes: Of ``r``, ``r₁``, ``r₂`` of one side, then of the other, shape (b, 6, 16).
        taken: ``D`` and ``C``, shape (b, 6).
        stiffness: ``w N`` and ``w M``, shape (b, 2).
    """

    nodes: Indices
    sizes: Array
    shapes: Array
    taken: Array
    stiffness: Array

    @classmethod
    def joined(cls, parts: list[SeamPoints]) -> SeamPoints:
        """All of several."""
        return cls(*(np.concatenate(column) for column in zip(*parts, strict=True)))


class SeamSprings(CarryingCellTerm, Springs):
    """Points along seams, on the nodes of their assembly."""

    label = "seams"

    def __init__(self, points: SeamPoints, count: int) -> None:
        """Pack the points, on the nodes of an assembly of so many."""
        b = len(points.nodes)
        parts = points.sizes, points.shapes.reshape(b, -1), points.taken, points.stiffness
        values = np.hstack([*parts, np.zeros((b, 6))])
        super().__init__((energy_kernel, force_kernel, matrix_kernel), values, points, count)
        self._stress = self._matrix.values[:, STRESS:]

    def carry(self, H: Array, h: Array) -> None:
        """Carry the stress on to the end of the increment ``h`` (count, 6) from frames ``H``."""
        values = self._matrix.values
        carry_stress(H, h.reshape(-1, 6), self.springs.nodes, (values.ctypes.data, values.shape[1]))
