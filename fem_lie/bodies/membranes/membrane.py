"""Membranes: surfaces without bending stiffness, whose nodes have positions only."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from typing import Any, NamedTuple

import dolfinx
import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices, instance, log_coincident, numbers
from fem_lie.bodies.model import NO_HOLDS, HeldRotation, Holds
from fem_lie.bodies.position_model import PositionBody, PositionModel
from fem_lie.bodies.shells.assembly import merged_surface
from fem_lie.bodies.shells.placing import (
    Director,
    ShellSections,
    axes_along,
    frames_with,
    section_per_cell,
)
from fem_lie.bodies.surface_model import CellsOnSurface
from fem_lie.elements.membranes.element import LinearMembrane, MembraneFormulation
from fem_lie.forms.assembly import Assembly, NodalInertia
from fem_lie.mesh.reading import surface_from_dolfinx
from fem_lie.mesh.surfaces import SurfaceMesh
from fem_lie.sections.material import Damping
from fem_lie.sections.shell_section import ShellSection

_MEMBRANE, _COUPLING = np.s_[:3, :3], np.s_[:3, 3:6]  # of a section stiffness (8, 8)
_SYMMETRIC = 1e-9  # over the membrane stiffness times the thickness


class MembraneModel(CellsOnSurface, PositionModel):
    """Model of a membrane.

    Attributes:
        stiffness: Membrane stiffness of each cell, shape (m, 3, 3).
        has_mass: Whether all cells have a density.
        axes: Vector in each cell whose projection onto the surface is e₁ of its strains, (m, 3).
        prestress: Stress resultants of each cell in the unloaded configuration, shape (m, 3).
        formulation: Law.
        damping: Mass-proportional damping.
    """

    def __init__(
        self,
        mesh: SurfaceMesh,
        sections: Sequence[ShellSection],
        axes: Array,
        prestress: Array,
        formulation: MembraneFormulation,
        damping: Damping,
        class_name: str,
        name: str,
    ) -> None:
        """Create the nodes.

        Args:
            mesh: Surface mesh.
            sections: Section of each cell.
            axes: See :attr:`axes`.
            prestress: See :attr:`prestress`.
            formulation: Law.
            damping: Mass-proportional damping.
            class_name: Name of the class of the body.
            name: Name in messages and results.

        Raises:
            ValueError: The law does not support a section, or a section couples membrane forces and
                curvatures.
        """
        self.mesh, self.source, self.connectivity = mesh, mesh.source, mesh.cells
        self.formulation, self.damping = formulation, damping
        for section in {id(s): s for s in sections}.values():
            formulation.check(section.stiffness[_MEMBRANE])
            coupling = np.abs(section.stiffness[_COUPLING]).max()
            if coupling > _SYMMETRIC * section.stiffness[0, 0] * section.thickness:
                raise ValueError(
                    "Membrane: section: expected one without coupling of membrane forces and "
                    f"curvatures, such as a symmetric laminate, got {section}"
                )
        self.stiffness = np.array([s.stiffness[_MEMBRANE] for s in sections])
        self.density = np.zeros((len(sections), 2, 2))
        self.density[:, 0, 0] = [s.inertia[0, 0] for s in sections]
        self.has_mass = bool((self.density[:, 0, 0] > 0.0).all())
        self.axes, self.prestress = axes, prestress
        super().__init__(
            frames_with(mesh.points, _mean_normals(mesh)),
            class_name=class_name,
            size=float(np.linalg.norm(np.ptp(mesh.points, axis=0))),
            points={key: int(p[0]) for key, p in mesh.named_points.items() if len(p) == 1},
            name=name,
        )
        log_coincident(self.label, mesh.points)
        self.faces = mesh.corners
        self.thickness = np.array([s.thickness for s in sections], dtype=np.float64)

    @property
    def assembly_key(self) -> Hashable:
        """Key of membranes that are assembled together: same law and cell type."""
        return type(self), self.formulation, self.mesh.cell, self.mesh.degree

    @classmethod
    def assemble(cls, models: Sequence[Any], holds: Holds = NO_HOLDS) -> MembraneAssembly:
        """Assembly of membranes of one :attr:`assembly_key`."""
        return MembraneAssembly(models)

    def restricted(self, cells: Indices, holds: Sequence[HeldRotation]) -> tuple[Any, Indices]:
        """Model of some of its cells, see :class:`~fem_lie.bodies.model.BodyModel`."""
        part, nodes = super().restricted(cells, holds)
        part.mesh = self.mesh.restricted(cells)
        part.connectivity = np.searchsorted(nodes, self.connectivity[cells])
        for name in "stiffness", "density", "axes", "prestress":
            setattr(part, name, getattr(self, name)[cells])
        part.thickness = self.thickness[cells]
        return part, nodes


class MembraneAssembly(Assembly):
    """Assembly of all membranes of one law and cell type, on one surface mesh."""

    def __init__(self, bodies: Sequence[MembraneModel]) -> None:
        """Merge the meshes of the bodies and build the forms; coincident nodes stay separate.

        Args:
            bodies: Membranes of one law and cell type.
        """
        first = bodies[0]
        _, nodal, order, permutation = merged_surface(bodies)
        axes, stiffness, prestress = (
            np.concatenate([getattr(body, name) for body in bodies])[permutation]
            for name in ("axes", "stiffness", "prestress")
        )
        forms = first.formulation.forms(nodal, first.mesh.degree, axes, stiffness, prestress)
        super().__init__(nodal, forms, order, np.argsort(permutation), None)
        if all(body.has_mass for body in bodies):
            elements = [body.element_inertia() for body in bodies]
            mass = self.summed(np.concatenate(elements)[permutation])
            damped = [body.damping.mass * each for body, each in zip(bodies, elements, strict=True)]
            damping = self.summed(np.concatenate(damped)[permutation])
            self.inertia = NodalInertia(mass, damping if damping.any() else None)


class MembranePart(NamedTuple):
    """All cells of a membrane, as loads on surfaces see them.

    Attributes:
        shell: The membrane.
        nodes: Numbers of its nodes, shape (n,).
        points: Numbers of the points of its mesh, shape (n,).
    """

    shell: Membrane
    nodes: Indices
    points: Indices


class Membrane(PositionBody):
    """Membrane on a surface mesh: stretches in its surface, no bending stiffness.

    Its nodes have positions only, so there is no stiffness across a flat membrane without tension:
    give a ``prestress``, stretch it by its supports, or inflate it. Surfaces may have kinks and
    branches. ``formulation=fl.elements.TensionField()`` wrinkles instead of resisting compression.

    Example:
        >>> film = fl.ShellSection.layer(1e-4, fl.Material(E=3e9, nu=0.3, density=1400.0))
        >>> mesh = fl.mesh.parametric_surface(lambda a, b: np.array([a, b, 0.0]), (4, 4))
        >>> drum = fl.Membrane(mesh, film, prestress=(100.0, 100.0, 0.0))
        >>> _ = [drum.clamp(edge) for edge in ("a=0", "a=1", "b=0", "b=1")]
        >>> scene = fl.Scene()
        >>> _ = scene.add(drum)
        >>> modes = fl.vibrations(scene, 1)
    """

    model: MembraneModel

    def __init__(
        self,
        mesh: SurfaceMesh | dolfinx.mesh.Mesh,
        section: ShellSections,
        *,
        along: npt.ArrayLike | Director | None = None,
        prestress: npt.ArrayLike | Callable[[Array], npt.ArrayLike] = (0.0, 0.0, 0.0),
        formulation: MembraneFormulation | None = None,
        damping: Damping | None = None,
        name: str = "",
    ) -> None:
        """Create the nodes.

        Args:
            mesh: Surface mesh, or a DOLFINx mesh.
            section: One for all cells, one for each named group of cells, or a function of the
                centre of a cell, shape (3,); its membrane stiffness and mass count.
            along: Direction of e₁ of the section axes before projection onto the surface: one
                vector, or a function of the centre of a cell; default: from the first to the second
                corner.
            prestress: Stress resultants (N₁₁, N₂₂, N₁₂) in the unloaded configuration, force per
                length: three numbers, or a function of the centre of a cell.
            formulation: Law; default: :class:`~fem_lie.elements.LinearMembrane`.
            damping: Mass-proportional damping.
            name: Name in messages and results.

        Raises:
            ValueError: A cell has no section, the law does not support it, it couples membrane
                forces and curvatures, or a value is not finite.
            TypeError: An argument has an unexpected type.
        """
        if isinstance(mesh, dolfinx.mesh.Mesh):
            mesh = surface_from_dolfinx(mesh)
        expected = "a SurfaceMesh, as of fl.mesh.parametric_surface()"
        instance(mesh, SurfaceMesh, "Membrane: mesh", expected)
        wanted = MembraneFormulation | None
        instance(formulation, wanted, "Membrane: formulation", "a law of membranes or None")
        law = LinearMembrane() if formulation is None else formulation
        centres = mesh.points[mesh.corners].mean(axis=1)
        given = [prestress(x) for x in centres] if callable(prestress) else [prestress]
        tension = numbers(given, "Membrane: prestress")
        if tension.shape[1:] != (3,):
            raise ValueError(
                f"Membrane: prestress: expected (N11, N22, N12), 3 numbers, got {given[0]!r}"
            )
        super().__init__(
            MembraneModel(
                mesh,
                section_per_cell(mesh, centres, section),
                axes_along(mesh, centres, along),
                np.broadcast_to(tension, (len(mesh.cells), 3)).copy(),
                law,
                Damping.of_mass(damping, "Membrane"),
                type(self).__name__,
                name,
            )
        )

    @property
    def parts(self) -> tuple[MembranePart, ...]:
        """Cells of each type: itself, with all its nodes and points."""
        every = np.arange(len(self.frames))
        return (MembranePart(self, every, every),)


def _mean_normals(mesh: SurfaceMesh) -> Array:
    """Unit vectors near the mean normals at all points, shape (n, 3); axes of unknowns only."""
    total = np.zeros_like(mesh.points)
    np.add.at(total, mesh.cells, mesh.normals)
    first = np.zeros_like(total)
    first[mesh.cells] = mesh.normals
    size = np.linalg.norm(total, axis=1, keepdims=True)
    return np.where(size > 0.1, total / np.maximum(size, 0.1), first)
