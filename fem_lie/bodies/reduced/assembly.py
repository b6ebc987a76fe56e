"""Reduced bodies of the same numbers of nodes, assembled together."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from fem_lie._arrays import Array
from fem_lie.bodies.reduced import kernels
from fem_lie.forms.body_term import BodyTerm, NodalInertia
from fem_lie.forms.cell_sums import CellSum, CellTerm


class ReducedData(Protocol):
    """What the assembly asks of a reduced body."""

    frames: Array
    within: Array
    stiffness: Array
    quadratic: Array
    density: Array


class ReducedAssembly(CellTerm, BodyTerm):
    """Bodies as cells of all their nodes; nodes are as in the bodies, one after the other."""

    label, within_frames = "reduced bodies", True

    def __init__(self, bodies: Sequence[ReducedData]) -> None:
        """Pack stiffness, and inertia of the frames."""
        count, k = len(bodies), len(bodies[0].frames)
        others, m = len(bodies[0].within), len(bodies[0].stiffness)
        cells = np.arange(count * k).reshape(count, k)
        super().__init__(cells, np.arange(count * k), np.arange(count))
        rows = [np.zeros((count, 12 * k))]
        rows += [np.array(each) for each in zip(*map(_packed, bodies), strict=True)]
        self._values = np.hstack(rows)
        self._sizes, nowhere = np.array([k, others, m], dtype=np.float64), np.zeros((count, 1))
        self._energy, self._forces, self._matrix = (
            CellSum(cells, kernel.address, self._values, self._sizes, nowhere)
            for kernel in (kernels.energy_kernel, kernels.force_kernel, kernels.matrix_kernel)
        )
        mass = np.zeros((count, k, 4, k, 4))
        mass[:, 0, :, 0] = [body.density[:4, :4] for body in bodies]
        self.inertia = NodalInertia(self.summed(mass))

    @property
    def contents(self) -> tuple[str, Array]:
        """What the energy is."""
        return "reduced body", self._values[:, 12 * self.cells.shape[1] :].copy()


def _packed(body: ReducedData) -> tuple[Array, Array, Array]:
    """As :mod:`.kernels` wants them."""
    last_first = body.quadratic.transpose(2, 0, 1)
    return body.within.ravel(), body.stiffness.ravel(), last_first.ravel()
