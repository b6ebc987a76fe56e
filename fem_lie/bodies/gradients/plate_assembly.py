"""All plates of places and three slopes, assembled together."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.beams.assembly import Damping
from fem_lie.elements.gradients import plate_cells as kernels
from fem_lie.elements.gradients.plate import AncfPlate
from fem_lie.elements.thin_shells.rows import NODES
from fem_lie.forms.body_term import BodyTerm, NodalInertia
from fem_lie.forms.cell_sums import CarryingCellTerm, CellSum


class PlateData(Protocol):
    """What the assembly asks of a shell, see :class:`~fem_lie.AncfShell`."""

    frames: Array
    connectivity: Indices
    sizes: Array
    stiffness: Array
    axes: Array
    formulation: AncfPlate
    damping: Damping
    has_mass: bool

    def vectors(self) -> Array:
        """Vectors of the interpolation of each cell, shape (m, 16, 3)."""

    def element_inertia(self) -> Array:
        """Constant matrix of the rows of each cell's nodes, shape (m, 8, 4, 8, 4)."""


class PlateAssembly(CarryingCellTerm, BodyTerm):
    """Plates of one element; nodes and cells are as in the bodies, one after the other."""

    def __init__(self, bodies: Sequence[PlateData]) -> None:
        """Put the data of all cells together; coincident nodes stay apart."""
        starts = np.cumsum([0] + [len(body.frames) for body in bodies])
        pairs = zip(bodies, starts[:-1], strict=True)
        cells = np.concatenate([body.connectivity + start for body, start in pairs])
        super().__init__(cells, np.arange(starts[-1]), np.arange(len(cells)))
        q = np.concatenate([body.vectors() for body in bodies])
        along, D, sizes = (
            np.concatenate([getattr(body, name) for body in bodies])
            for name in ("axes", "stiffness", "sizes")
        )
        C = bodies[0].formulation.stiffness(q, along, D)
        self._contents = np.concatenate(
            [sizes, kernels.strains_of(q), C.reshape(len(cells), -1)], axis=1
        )
        rows, stress = self._new(12 * NODES), self._new(kernels.STRAINS)
        self._values = np.concatenate([rows, self._contents, stress], axis=1)
        self._nothing, nowhere = np.zeros(1), self._new(1)

        def summed(kernel: int) -> CellSum:
            return CellSum(cells, kernel, self._values, self._nothing, nowhere)

        self._energy = summed(kernels.energy_kernel.address)
        self._forces = summed(kernels.force_kernel.address)
        self._matrix = summed(kernels.tangent_kernel.address)
        self._stress = self._values[:, kernels.STRESS_AT :]
        self._place = cells, (self._values.ctypes.data, self._values.shape[1])
        if all(body.has_mass for body in bodies):
            parts = [body.element_inertia() for body in bodies]
            rates = [body.damping.mass for body in bodies]
            damped = [rate * part for rate, part in zip(rates, parts, strict=True)]
            damping = self.summed(np.concatenate(damped)) if any(rates) else None
            self.inertia = NodalInertia(self.summed(np.concatenate(parts)), damping)

    def _new(self, size: int) -> Array:
        return np.zeros((len(self.cells), size))

    @property
    def contents(self) -> tuple[str, list[Array], list[Array]]:
        """What the energy is: its name, no tables, and the data of the cells."""
        return "plate of places and three slopes", [], [self._contents]

    def carry(self, H: Array, h: Array) -> None:
        """See the base class."""
        kernels.carry_stress(H, h.reshape(-1, 6), *self._place)
