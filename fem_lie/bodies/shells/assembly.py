"""Assembly of all shells of one kind by DOLFINx, and of weighted cells."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np
from dolfinx import fem

from fem_lie import _compat
from fem_lie._arrays import Array, Indices
from fem_lie.elements.shells.cells import ShellCells
from fem_lie.elements.shells.drilling import DrillingAssembly
from fem_lie.elements.shells.element import ShellFormulation
from fem_lie.forms.assembly import Assembly, NodalInertia
from fem_lie.forms.frames import NodalFrames
from fem_lie.lie.motions import add_turnings
from fem_lie.mesh.surfaces import SurfaceMesh
from fem_lie.sections.material import Damping

if TYPE_CHECKING:
    import dolfinx

_FIVE = 5


class MergedSurface(NamedTuple):
    """One DOLFINx mesh of the cells of several bodies; coincident nodes stay separate.

    Attributes:
        mesh: The mesh; a single body that was made from a DOLFINx mesh has that mesh, if nodes and
            cells agree.
        nodal: Frames on it, those of the bodies.
        order: Node of the mesh for each node of the bodies, one body after the other.
        permutation: Cell of the bodies for each cell of the mesh.
    """

    mesh: dolfinx.mesh.Mesh
    nodal: NodalFrames
    order: Indices
    permutation: Indices


class OnSurface(Protocol):
    """Body on a surface mesh, as :func:`merged_surface` reads it."""

    frames: Array
    mesh: SurfaceMesh
    source: dolfinx.mesh.Mesh | None
    connectivity: Indices


def merged_surface(bodies: Sequence[OnSurface]) -> MergedSurface:
    """Mesh of the cells of bodies of one cell type.

    Args:
        bodies: The bodies.
    """
    first = bodies[0]
    starts = np.cumsum([0] + [len(body.frames) for body in bodies])
    frames = np.concatenate([body.frames for body in bodies])
    cells = np.concatenate(
        [body.connectivity + start for body, start in zip(bodies, starts[:-1], strict=True)]
    )
    cell, degree = first.mesh.cell, first.mesh.degree
    own = first.source if len(bodies) == 1 else None
    if own is not None and _compat.is_made_of(own, frames[:, 0], cells):
        mesh, permutation, given = own, np.arange(len(cells)), cells
    else:
        mesh = _compat.create_surface_mesh(frames[:, 0].copy(), cells, cell, degree)
        permutation = mesh.topology.original_cell_index
        given = mesh.geometry.input_global_indices[_compat.geometry_dofmap(mesh)]
    nodal = NodalFrames(mesh, degree)
    order = np.empty(len(frames), dtype=np.int64)
    order[given] = nodal.function.function_space.dofmap.list
    nodal.frames[order] = frames
    return MergedSurface(mesh, nodal, order, permutation)


class ShellData(OnSurface, Protocol):
    """Data of a shell that the assembly reads, see :class:`~fem_lie.Shell`."""

    stiffness: Array
    axes: Array
    formulation: ShellFormulation
    damping: Damping
    has_mass: bool

    @property
    def mass(self) -> float:
        """Total mass, kg."""

    def element_inertia(self) -> Array:
        """Mass matrix in (x, d₁, d₂, d₃) of each cell's nodes, shape (m, k, 4, k, 4)."""

    def element_drilling_inertia(self, drilling: Array) -> Array:
        """Rotary inertia of drilling rotations for stiffnesses γ (m,), shape (m, k, 4, k, 4)."""


class SurfaceAssembly(Assembly):
    """Assembly of all shells of one formulation and cell type, on one surface mesh.

    Attributes:
        mesh: Mesh of all shells, with nodes and cells in the order of DOLFINx.
        stress: Independent stress resultants ``(N, M, Q)`` at the quadrature points, in UFL, shape
            (8,).
    """

    def __init__(self, bodies: Sequence[ShellData], drilling: Array | None = None) -> None:
        """Merge the meshes of the bodies and build the forms; coincident nodes stay separate.

        Args:
            bodies: Shells of one formulation, damping and cell type.
            drilling: Drilling stiffness γ of all cells, shape (m,); default: no drilling rotation.
        """
        first = bodies[0]
        mesh, nodal, order, permutation = merged_surface(bodies)
        cell, degree = first.mesh.cell, first.mesh.degree
        stiffness = np.concatenate([body.stiffness for body in bodies])[permutation]
        axes = np.concatenate([body.axes for body in bodies])[permutation]
        measures = first.formulation.measures_for(cell, degree)
        relaxation = first.damping.relaxation_time
        shell_cells = ShellCells(nodal, measures, directions=axes, relaxation=relaxation)
        forms = first.formulation.forms(shell_cells, stiffness)
        self.mesh, self.stress = mesh, first.formulation.stress(shell_cells, forms, stiffness)
        cell_order = np.argsort(permutation)
        super().__init__(nodal, forms, order, cell_order, shell_cells.set_eigenstrain)
        self.require_no_stress(first.formulation)
        # a bubble makes W_ss depend on frames: updates between iterates follow it
        plain = first.formulation.quadratic and measures.intermediate is None
        self._nonlinear = forms.local is not None and not plain
        if drilling is not None and not first.formulation.whole_frames:
            moment = DrillingAssembly(
                nodal.frames.copy(),
                nodal.function.function_space.dofmap.list,
                measures.cell,
                degree,
                measures.quadrature_degree,
                axes,
                drilling[permutation],
            )
            self.further_terms.append(moment)
        rows = np.repeat(np.arange(self.count), np.diff(self.indptr))
        self._diagonal = np.flatnonzero(self.indices == rows)
        self._all = np.ones(self.count, dtype=bool)
        self._bodies, self._drilling, self._permutation = bodies, drilling, permutation

    @property
    def inertia(self) -> NodalInertia | None:  # type: ignore[override]
        """Mass matrix in the pattern, or ``None`` without mass, computed at each call."""
        bodies, drilling = self._bodies, self._drilling
        if not self._has_mass:
            return None
        # as the cells of the bodies, and their nodes, are ordered there
        elements = np.concatenate([body.element_inertia() for body in bodies])
        mass, rate = self.summed(elements[self._permutation]), bodies[0].damping.mass
        further = None
        if drilling is not None:
            each = np.split(drilling, np.cumsum([len(body.connectivity) for body in bodies])[:-1])
            given = zip(bodies, each, strict=True)
            rotary = np.concatenate([body.element_drilling_inertia(γ) for body, γ in given])
            further = self.summed(rotary[self._permutation])
        return NodalInertia(mass, rate * mass if rate else None, further)

    @property
    def _has_mass(self) -> bool:
        return all(body.has_mass for body in self._bodies)

    @property
    def mass(self) -> float:
        """Total mass, kg."""
        return sum(body.mass for body in self._bodies) if self._has_mass else 0.0


class ShellAssembly(SurfaceAssembly):
    """Assembly of shells whose cells have five unknowns per node."""

    @property
    def tables(self) -> None:
        """``None``: forces have five components per node; coefficients are packed at each call."""

    def workspace(self) -> Array:
        """Zero array for the forces of all nodes, shape (count, 6)."""
        return np.zeros((self.count, 6))

    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """Add elastic forces; independent fields are coefficients, packed at each call."""
        self._frames.frames[:] = H
        forces = fem.assemble_vector(self._forms.residual).array.reshape(-1, _FIVE)
        out.reshape(-1, 6)[:, :_FIVE] += forces
        if kept is not None:
            kept[:, :_FIVE] = forces

    def add_viscous_forces(self, H: Array, v: Array, out: Array) -> None:
        """Add the viscous forces at twists ``v``, of which five components move directors."""
        assert self._forms.viscous is not None
        self._frames.frames[:] = H
        self._forms.velocity.x.array[:] = v[: self.count, :_FIVE].ravel()
        forces = fem.assemble_vector(self._forms.viscous).array.reshape(-1, _FIVE)
        out.reshape(-1, 6)[:, :_FIVE] += forces

    def viscous_tangent(self, H: Array, v: Array) -> tuple[Array, Array | None]:
        """Derivative in the twists (nnz, 6, 6); that in frames is neglected."""
        blocks = np.zeros((len(self.indices), 6, 6))
        blocks[:, :_FIVE, :_FIVE] = super().viscous_tangent(H, v)[0]
        return blocks, None

    def energy(self, H: Array) -> float:
        """Strain energy; independent fields are first solved for these frames."""
        if self._forms.local is not None:
            self.reset_stress(H)
        self._frames.frames[:] = H
        return float(fem.assemble_scalar(self._forms.energy))

    def tangent(self, H: Array, kept: Array) -> Array:
        """Tangent stiffness in twists, (nnz, 6, 6), with the current independent stress."""
        blocks = np.zeros((len(self.indices), 6, 6))
        self.add_tangent(H, kept, np.arange(len(blocks)), blocks)
        return blocks

    def add_tangent(self, H: Array, kept: Array, index: Indices, K: Array) -> None:
        """Add the tangent stiffness at frames ``H`` to blocks ``K`` at ``index``."""
        super().add_tangent(H, kept, index, K)
        forces = kept * self._tangent.share(self.count)
        add_turnings(forces, -1.0, index[self._diagonal], self._all, K)

    def update_stress(self, H: Array, h: Array) -> None:
        """Update the independent stress or fields linearly for an increment."""
        super().update_stress(H, h.reshape(-1, 6)[:, :_FIVE])


@dataclass(eq=False)
class WeightedSurfaceCells:
    """Data of some cells of a shell, see :class:`~fem_lie.bodies.shells.assembly.ShellData`."""

    frames: Array
    mesh: SurfaceMesh
    connectivity: Indices
    stiffness: Array
    axes: Array
    formulation: ShellFormulation
    damping: Damping = field(default_factory=Damping)
    has_mass: bool = False
    mass: float = 0.0
    source: dolfinx.mesh.Mesh | None = None

    def element_inertia(self) -> Array:
        """Empty array: weighted cells have no inertia."""
        return np.empty((0, 0, 4, 0, 4))

    def element_drilling_inertia(self, drilling: Array) -> Array:
        """Empty array: weighted cells have no inertia."""
        return self.element_inertia()


def weighted_surface_cells(body: ShellData, cells: Indices, weights: Array) -> SurfaceAssembly:
    """Assembly of some cells with energies times weights (s,), on separate nodes.

    See :meth:`~.body.Body.weighted_cells`.
    """
    nodes = body.connectivity[cells]
    chosen = WeightedSurfaceCells(
        frames=body.frames[nodes.ravel()],
        mesh=body.mesh,
        connectivity=np.arange(nodes.size).reshape(nodes.shape),
        stiffness=weights[:, np.newaxis, np.newaxis] * body.stiffness[cells],
        axes=body.axes[cells],
        formulation=body.formulation,
    )
    return assembly_of([chosen])


def assembly_of(bodies: Sequence[ShellData], drilling: Array | None = None) -> SurfaceAssembly:
    """Assembly of shells of one formulation and cell type, see :class:`SurfaceAssembly`.

    Args:
        bodies: The shells.
        drilling: Drilling stiffness γ of all cells, shape (m,); default: no drilling rotation.
    """
    whole = bodies[0].formulation.whole_frames
    return (SurfaceAssembly if whole else ShellAssembly)(bodies, drilling)
