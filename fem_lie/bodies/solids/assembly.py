"""The elements of one solid, assembled on its own mesh."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.elements.solids.element import SolidFormulation
from fem_lie.forms.assembly import Assembly, NodalInertia
from fem_lie.forms.frames import NodalFrames
from fem_lie.mesh.volumes import VolumeMesh, VolumeRule
from fem_lie.sections.material import Damping
from fem_lie.sections.solid_materials import SolidMaterial


class SolidData(Protocol):
    """What the assembly asks of a solid, see :class:`~fem_lie.Solid`."""

    frames: Array
    mesh: VolumeMesh
    degree: int
    connectivity: Indices
    material: SolidMaterial
    parameters: Array
    density: Array
    has_mass: bool
    formulation: SolidFormulation
    damping: Damping
    rule: VolumeRule


class SolidAssembly(Assembly):
    """One solid; its nodes' axes follow the mean deformation of the cells around them."""

    def __init__(self, body: SolidData) -> None:
        """Build the forms.

        Args:
            body: The solid; its unloaded places are those of its mesh.
        """
        nodal = NodalFrames(body.mesh.mesh, body.degree)
        cells = nodal.function.function_space.dofmap.list
        order = np.empty(len(body.frames), dtype=np.int64)
        order[body.connectivity] = cells
        forms = body.formulation.forms(nodal, body.degree, body.material, body.parameters)
        super().__init__(nodal, forms, order, np.arange(len(cells)), None)
        slopes = body.rule.mean_slopes
        self.around = np.zeros((len(self.indices), 3))
        at = self._pattern.place.reshape(len(cells), slopes.shape[1], -1)
        # each node of a cell sees the cell's mean deformation
        shared = np.broadcast_to(slopes[:, np.newaxis], (*at.shape, 3))
        np.add.at(self.around, at, shared)
        if body.has_mass:
            mass = self.summed(_element_inertia(body))
            damping = body.damping.mass * mass if body.damping.mass else None
            self.inertia = NodalInertia(mass, damping)


def _element_inertia(body: SolidData) -> Array:
    """Consistent mass of the places of each cell's nodes, shape (m, k, 4, k, 4)."""
    N = body.rule.values
    weights = body.density[:, np.newaxis] * body.rule.volumes
    m, k = body.connectivity.shape
    blocks = np.zeros((m, k, 4, k, 4))
    blocks[:, :, 0, :, 0] = np.einsum("gi,gj,mg->mij", N, N, weights, optimize=True)
    return blocks
