"""Assembly of all beams of one formulation by DOLFINx, of weighted elements, and damping."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

import numpy as np

from fem_lie import _compat
from fem_lie._arrays import Array, Indices
from fem_lie.elements.beams.element import BeamFormulation, CellData, cellwise
from fem_lie.forms.assembly import Assembly, NodalInertia
from fem_lie.forms.frames import NodalFrames
from fem_lie.lie.node_types import TRAITS, NodeType
from fem_lie.sections.material import Damping

if TYPE_CHECKING:
    import dolfinx


class BeamData(Protocol):
    """Data of a beam that the assembly reads, see :class:`~fem_lie.Beam`."""

    frames: Array
    elements: Indices
    lengths: Array
    slopes: Array
    stiffness: Array
    density: Array
    formulation: BeamFormulation
    damping: Damping
    has_mass: bool
    source: dolfinx.mesh.Mesh | None


class BeamAssembly(Assembly):
    """Assembly of all beams of one formulation, on one line mesh.

    A single beam that was made from a DOLFINx mesh is assembled on that mesh, if points and cells
    agree.
    """

    def __init__(self, bodies: Sequence[BeamData]) -> None:
        """Merge the meshes of the bodies and build the forms; coincident nodes stay separate."""
        formulation = bodies[0].formulation
        starts = np.cumsum([0] + [len(body.frames) for body in bodies])
        frames = np.concatenate([body.frames for body in bodies])
        elements = np.concatenate(
            [body.elements + start for body, start in zip(bodies, starts[:-1], strict=True)]
        )
        own = bodies[0].source if len(bodies) == 1 else None
        nodal, order, permutation = _number_nodes(frames, elements, formulation.degree, own)
        mesh = nodal.function.function_space.mesh

        def gathered(name: str) -> Array:
            parts = [getattr(body, name) for body in bodies]
            if len(parts) == 1 and parts[0].strides[0] == 0:
                return np.asarray(parts[0])  # one value for all elements, in any order
            return np.concatenate(parts)[permutation]

        lengths, eigenstrain = gathered("lengths"), cellwise(mesh, np.zeros((len(elements), 6)))
        viscosity = None
        if any(body.damping.factors().any() for body in bodies):
            viscosity = np.concatenate([b.damping.viscosity(b.stiffness) for b in bodies])
            viscosity = viscosity[permutation]
        stiffness, density, slopes = map(gathered, ("stiffness", "density", "slopes"))
        data = CellData(lengths, stiffness, density, eigenstrain, viscosity, slopes)
        forms = formulation.forms(nodal, data)

        def set_strains(values: Array) -> None:
            eigenstrain.x.array[:] = values.ravel()

        super().__init__(nodal, forms, order, np.argsort(permutation), set_strains)
        # cables, whose nodes have no frames, may be created stretched
        if formulation.node_type is NodeType.FRAME:
            self.require_no_stress(formulation)
        self._tangent.used = TRAITS[formulation.node_type].unknowns
        if all(body.has_mass for body in bodies):
            elements = formulation.inertia(nodal, data)
            rates = np.concatenate([np.full(len(b.lengths), b.damping.mass) for b in bodies])
            rates = rates[permutation].reshape(-1, 1, 1, 1, 1)
            damping = self.summed(rates * elements) if rates.any() else None
            self.inertia = NodalInertia(self.summed(elements), damping)


def _number_nodes(
    frames: Array, elements: Indices, degree: int, own: dolfinx.mesh.Mesh | None
) -> tuple[NodalFrames, Indices, Indices]:
    """Nodal frames on a mesh of the elements, and its index of each node and of each cell.

    The mesh is ``own`` if that has these elements and no others.
    """
    corners = np.unique(elements[:, :2])
    number = np.full(len(frames), -1)
    number[corners] = np.arange(len(corners))
    points, cells = frames[corners, 0].copy(), number[elements[:, :2]]
    if own is not None and _compat.is_made_of(own, points, cells):
        mesh, given = own, corners[cells]
        permutation: Indices = np.arange(len(cells))
    else:
        mesh = _compat.create_line_mesh(points, cells)
        permutation = mesh.topology.original_cell_index.astype(np.int64)
        given = corners[mesh.geometry.input_global_indices[_compat.geometry_dofmap(mesh)]]
    nodal = NodalFrames(mesh, degree)
    dofs = nodal.function.function_space.dofmap.list
    order = np.empty(len(frames), dtype=np.int64)
    order[given] = dofs[:, :2]
    for k in range(2, degree + 1):
        order[elements[permutation, k]] = dofs[:, k]
    nodal.frames[order] = frames
    return nodal, order, permutation


@dataclass(eq=False)
class WeightedElements:
    """Data of some elements, see :class:`~fem_lie.bodies.beams.assembly.BeamData`."""

    frames: Array
    elements: Indices
    lengths: Array
    slopes: Array
    stiffness: Array
    density: Array
    formulation: BeamFormulation
    damping: Damping = field(default_factory=Damping)
    has_mass: bool = False
    source: dolfinx.mesh.Mesh | None = None


def weighted_elements(body: BeamData, elements: Indices, weights: Array) -> BeamAssembly:
    """Assembly of some elements with energies times weights (s,), on separate nodes.

    See :meth:`~.body.Body.weighted_cells`.
    """
    nodes = body.elements[elements]
    chosen = WeightedElements(
        frames=body.frames[nodes.ravel()],
        elements=np.arange(nodes.size).reshape(nodes.shape),
        lengths=body.lengths[elements],
        slopes=body.slopes[elements],
        stiffness=weights[:, np.newaxis, np.newaxis] * body.stiffness[elements],
        density=body.density[elements],
        formulation=body.formulation,
    )
    return BeamAssembly([chosen])
