"""All beams of one formulation, assembled together by DOLFINx; some elements alone; damping."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

from mpi4py import MPI

import numpy as np

from fem_lie import _compat
from fem_lie._arrays import Array, Indices, instance
from fem_lie.elements.beams.element import CellData, Formulation, cellwise
from fem_lie.forms.assembly import Assembly, NodalInertia
from fem_lie.forms.frames import NodalFrames
from fem_lie.lie.node_types import TRAITS
from fem_lie.sections.material import Damping

if TYPE_CHECKING:
    import dolfinx


def mass_only(damping: Damping | None, what: str) -> Damping:
    """What is given, or none.

    Raises:
        ValueError: It damps strain.
        TypeError: It is no damping.
    """
    instance(damping, Damping | None, f"{what}: damping", "a Damping or None")
    given = Damping() if damping is None else damping
    if given.factors().any():
        raise ValueError(f"a {what} has damping with mass only, got Damping(stiffness=…)")
    return given


class BeamData(Protocol):
    """What the assembly asks of a beam, see :class:`~fem_lie.Beam`."""

    frames: Array
    elements: Indices
    lengths: Array
    slopes: Array
    stiffness: Array
    density: Array
    formulation: Formulation
    damping: Damping
    has_mass: bool
    source: dolfinx.mesh.Mesh | None


class BeamAssembly(Assembly):
    """All beams of one formulation, on one line mesh.

    A single one whose points and cells are those of a DOLFINx mesh that was given is on that mesh.
    """

    def __init__(self, bodies: Sequence[BeamData]) -> None:
        """Merge the bodies' meshes and build the forms; coincident nodes stay apart."""
        formulation = bodies[0].formulation
        starts = np.cumsum([0] + [len(body.frames) for body in bodies])
        frames = np.concatenate([body.frames for body in bodies])
        elements = np.concatenate(
            [body.elements + start for body, start in zip(bodies, starts[:-1], strict=True)]
        )
        own = bodies[0].source if len(bodies) == 1 else None
        nodal, order, permutation = _place(frames, elements, formulation.degree, own)
        mesh = nodal.function.function_space.mesh

        def gathered(name: str) -> Array:
            parts = [getattr(body, name) for body in bodies]
            if len(parts) == 1 and parts[0].strides[0] == 0:
                return np.asarray(parts[0])  # one for all, wherever they are
            return np.concatenate(parts)[permutation]

        lengths, eigenstrain = gathered("lengths"), cellwise(mesh, np.zeros((len(elements), 6)))
        viscosity = None
        if any(body.damping.factors().any() for body in bodies):
            viscosity = np.concatenate([b.damping.viscosity(b.stiffness) for b in bodies])
            viscosity = viscosity[permutation]
        stiffness, density, slopes = map(gathered, ("stiffness", "density", "slopes"))
        data = CellData(lengths, stiffness, density, eigenstrain, viscosity, slopes)
        forms = formulation.forms(nodal, data)
        super().__init__(nodal, forms, order, np.argsort(permutation), eigenstrain)
        self._tangent.used = TRAITS[formulation.node_type].unknowns
        if all(body.has_mass for body in bodies):
            elements = formulation.inertia(nodal, data)
            rates = np.concatenate([np.full(len(b.lengths), b.damping.mass) for b in bodies])
            rates = rates[permutation].reshape(-1, 1, 1, 1, 1)
            damping = self.summed(rates * elements) if rates.any() else None
            self.inertia = NodalInertia(self.summed(elements), damping)


def _place(
    frames: Array, elements: Indices, degree: int, own: dolfinx.mesh.Mesh | None
) -> tuple[NodalFrames, Indices, Indices]:
    """Nodal frames on a mesh of the elements, the place of each node there, and of each cell.

    It is the given one where that has these elements and nothing else.
    """
    corners = np.unique(elements[:, :2])
    number = np.full(len(frames), -1)
    number[corners] = np.arange(len(corners))
    points, cells = frames[corners, 0].copy(), number[elements[:, :2]]
    if own is not None and _compat.is_made_of(own, points, cells):
        mesh, given = own, corners[cells]
        permutation: Indices = np.arange(len(cells))
    else:
        mesh = _compat.create_line_mesh(MPI.COMM_SELF, points, cells)
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
    """See :class:`~fem_lie.bodies.beams.assembly.BeamData`."""

    frames: Array
    elements: Indices
    lengths: Array
    slopes: Array
    stiffness: Array
    density: Array
    formulation: Formulation
    damping: Damping = field(default_factory=Damping)
    has_mass: bool = False
    source: dolfinx.mesh.Mesh | None = None


def weighted_elements(body: BeamData, elements: Indices, weights: Array) -> BeamAssembly:
    """Some elements, their energy times weights (s,); see :meth:`~.body.Body.weighted_cells`."""
    nodes = body.elements[elements]
    apart = WeightedElements(
        frames=body.frames[nodes.ravel()],
        elements=np.arange(nodes.size).reshape(nodes.shape),
        lengths=body.lengths[elements],
        slopes=body.slopes[elements],
        stiffness=weights[:, np.newaxis, np.newaxis] * body.stiffness[elements],
        density=body.density[elements],
        formulation=body.formulation,
    )
    return BeamAssembly([apart])
