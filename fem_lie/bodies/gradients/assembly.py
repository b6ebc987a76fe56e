"""All beams of places and three slopes, assembled together."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.beams.assembly import Damping
from fem_lie.elements.gradients import cells as kernels
from fem_lie.elements.gradients.ancf import AncfElement
from fem_lie.elements.gradients.strains import NODES, STRAINS, STRESS_AT
from fem_lie.forms.body_term import BodyTerm, NodalInertia
from fem_lie.forms.cell_sums import CarryingCellTerm, CellSum


class GradientData(Protocol):
    """What the assembly asks of a beam, see :class:`~fem_lie.AncfBeam`."""

    frames: Array
    unloaded: Array
    elements: Indices
    lengths: Array
    ends: Array
    stiffness: Array
    poisson: Array
    density: Array
    formulation: AncfElement
    damping: Damping
    has_mass: bool


class GradientAssembly(CarryingCellTerm, BodyTerm):
    """Beams of one element; nodes and cells are as in the bodies, one after the other."""

    def __init__(self, bodies: Sequence[GradientData]) -> None:
        """Put the data of all cells together; coincident nodes stay apart."""
        starts = np.cumsum([0] + [len(body.frames) for body in bodies])
        pairs = zip(bodies, starts[:-1], strict=True)
        cells = np.concatenate([body.elements + start for body, start in pairs])
        super().__init__(cells, np.arange(starts[-1]), np.arange(len(cells)))

        def gathered(name: str) -> Array:
            return np.concatenate([getattr(body, name) for body in bodies])

        element, lengths, unloaded = bodies[0].formulation, gathered("lengths"), self._new(STRAINS)
        kernels.unloaded_strains(gathered("unloaded"), lengths, cells, unloaded)
        C = element.stiffness(gathered("stiffness"), gathered("poisson"), gathered("ends"), lengths)
        self._contents = np.concatenate(
            [lengths[:, np.newaxis], unloaded, C.reshape(len(cells), -1)], axis=1
        )
        rows, stress = self._new(12 * NODES), self._new(STRAINS)
        self._values = np.concatenate([rows, self._contents, stress], axis=1)
        self._nothing, nowhere = np.zeros(1), self._new(1)

        def summed(kernel: int) -> CellSum:
            return CellSum(cells, kernel, self._values, self._nothing, nowhere)

        self._energy = summed(kernels.energy_kernel.address)
        self._forces = summed(kernels.force_kernel.address)
        self._matrix = summed(kernels.tangent_kernel.address)
        self._stress = self._values[:, STRESS_AT:]
        self._place = cells, (self._values.ctypes.data, self._values.shape[1])
        if all(body.has_mass for body in bodies):
            elements = element.inertia(gathered("density"), lengths)
            rates = np.concatenate([np.full(len(b.lengths), b.damping.mass) for b in bodies])
            rates = rates.reshape(-1, 1, 1, 1, 1)
            damping = self.summed(rates * elements) if rates.any() else None
            self.inertia = NodalInertia(self.summed(elements), damping)

    def _new(self, size: int) -> Array:
        return np.zeros((len(self.cells), size))

    @property
    def contents(self) -> tuple[str, list[Array], list[Array]]:
        """What the energy is: its name, no tables, and the data of the cells."""
        return "beam of places and three slopes", [], [self._contents]

    def strains(self, H: Array) -> Array:
        """All strains of each cell, shape (m, 18), see the element."""
        found = self._new(STRAINS)
        kernels.all_strains(H, *self._place, found)
        return found

    def carry(self, H: Array, h: Array) -> None:
        """See the base class."""
        kernels.carry_stress(H, h.reshape(-1, 6), *self._place)
