"""Assembly of the elements of one solid on its own mesh."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.elements.solids.element import SolidFormulation
from fem_lie.elements.solids.stretch import StressFreeStretch
from fem_lie.forms.assembly import Assembly, NodalInertia
from fem_lie.forms.frames import NodalFrames
from fem_lie.mesh.volumes import VolumeMesh, VolumeRule
from fem_lie.sections.material import Damping
from fem_lie.sections.solid_materials import SolidMaterial


class SolidData(Protocol):
    """Data of a solid that the assembly reads, see :class:`~fem_lie.Solid`."""

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
    strained: bool

    @property
    def label(self) -> str:
        """Name in messages."""


class SolidAssembly(Assembly):
    """Assembly of one solid; nodal axes rotate with the mean deformation of the adjacent cells."""

    def __init__(self, body: SolidData) -> None:
        """Build the forms.

        Args:
            body: The solid; its unloaded positions are those of its mesh.
        """
        nodal = NodalFrames(body.mesh.mesh, body.degree)
        cells = nodal.function.function_space.dofmap.list
        order = np.empty(len(body.frames), dtype=np.int64)
        order[body.connectivity] = cells
        material, relaxation = (body.material, body.parameters), body.damping.relaxation_time
        # elements of users may have forms without such a stretch
        free = StressFreeStretch(body.mesh.mesh, body.label) if body.strained else None
        stretch = () if free is None else (free.inverse,)
        forms = body.formulation.forms(nodal, body.degree, *material, relaxation, *stretch)
        set_strains = None if free is None else free.set
        super().__init__(nodal, forms, order, np.arange(len(cells)), set_strains)
        self.require_no_stress(body.formulation, body.material.law)
        slopes = body.rule.mean_slopes
        self.around = np.zeros((len(self.indices), 3))
        at = self._pattern.pair_index.reshape(len(cells), slopes.shape[1], -1)
        # all nodes of a cell have the mean deformation of the cell
        shared = np.broadcast_to(slopes[:, np.newaxis], (*at.shape, 3))
        np.add.at(self.around, at, shared)
        if body.has_mass:
            mass = self.summed(_element_inertia(body))
            damping = body.damping.mass * mass if body.damping.mass else None
            self.inertia = NodalInertia(mass, damping)


def _element_inertia(body: SolidData) -> Array:
    """Consistent mass matrix in the nodal coordinates of each cell, shape (m, k, 4, k, 4), kg."""
    N = body.rule.values
    weights = body.density[:, np.newaxis] * body.rule.volumes
    m, k = body.connectivity.shape
    blocks = np.zeros((m, k, 4, k, 4))
    blocks[:, :, 0, :, 0] = np.einsum("gi,gj,mg->mij", N, N, weights, optimize=True)
    return blocks
