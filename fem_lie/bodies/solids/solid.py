"""Solid bodies: hexahedra or tetrahedra with nodal positions and convected axes."""

from __future__ import annotations

import logging
from collections.abc import Hashable, Mapping, Sequence
from functools import cached_property
from typing import Any

import dolfinx
import numpy as np
import numpy.typing as npt
from dolfinx import fem

from fem_lie._arrays import (
    Array,
    Indices,
    diameter,
    instance,
    log_coincident,
    numbers,
    text,
    whole,
)
from fem_lie.attachments.patch import in_the_mean
from fem_lie.bodies.beams.assembly import mass_only
from fem_lie.bodies.body import NO_HOLDS, Holds, Point, Where
from fem_lie.bodies.per_cell import of_groups
from fem_lie.bodies.solids.assembly import SolidAssembly
from fem_lie.bodies.solids.faces import Faces, SupportedSolid, faces_of, nodes_on
from fem_lie.elements.solids.element import SolidFormulation, default_formulation
from fem_lie.lie.node_types import NodeType
from fem_lie.mesh.volumes import VolumeMesh, VolumeRule, brick
from fem_lie.sections.material import Damping
from fem_lie.sections.solid_materials import SolidMaterial

_log = logging.getLogger(__name__)

_ORTHONORMAL = 1e-8

SolidMaterials = SolidMaterial | Mapping[str, SolidMaterial]


class Solid(SupportedSolid):
    """Solid of hexahedra or tetrahedra, of any hyperelastic material.

    Its nodes have positions. Their axes rotate with the adjacent cells when a state is accepted.
    The motion does not depend on these axes, but the matrix of a tumbling body changes less. Axes
    along which nodes are held, or to which joints are bound, do not rotate.

    Joints, springs, drives and moments act on a patch of nodes by :meth:`point`; forces and
    supports may act on nodes, too.

    Attributes:
        mesh: Unloaded mesh.
        degree: Degree of the interpolation of positions.
        connectivity: Nodes of each cell, shape (m, k).
        places: Unloaded positions of the nodes, shape (n, 3).
        material: Constitutive law of all cells.
        parameters: Parameters of the law in each cell, shape (m, p).
        density: Mass density of each cell, shape (m,).
        has_mass: Whether all cells have a density.
        formulation: Finite element.
        damping: Mass-proportional damping.
        rule: Quadrature rule of the cells.

    Example:
        >>> rubber = fl.sections.NeoHooke(E=1e6, nu=0.3)
        >>> block = fl.Solid.brick((1, 1, 2), rubber, cells=(1, 1, 2))
    """

    def __init__(
        self,
        mesh: VolumeMesh | dolfinx.mesh.Mesh,
        material: SolidMaterials,
        *,
        degree: int | None = None,
        formulation: SolidFormulation | None = None,
        damping: Damping | None = None,
        name: str = "",
    ) -> None:
        """Create the nodes.

        Args:
            mesh: Volume mesh, or a DOLFINx mesh.
            material: Material of all cells, or one for each named group, all of one law.
            degree: Degree of the interpolation, 1 or 2; default: that of the mesh.
            formulation: Finite element; default: :class:`~fem_lie.elements.MeanDilatation` for
                hexahedra of degree 1, else :class:`~fem_lie.elements.Isoparametric`.
            damping: Mass-proportional damping.
            name: Name in messages and results.

        Raises:
            ValueError: The mesh has no volume cells or inverted cells, a cell has no material or
                another law, the element does not support the cells, tetrahedra of degree 1 would
                lock, or there is damping of strain.
            TypeError: An argument has an unexpected type.
        """
        if isinstance(mesh, dolfinx.mesh.Mesh):
            mesh = VolumeMesh(mesh)
        instance(mesh, VolumeMesh, "Solid: mesh", "a VolumeMesh; see block(), read_gmsh_volume()")
        instance(formulation, SolidFormulation | None, "Solid: formulation", "an element or None")
        self.degree = mesh.degree if degree is None else whole(degree, "Solid: degree")
        if self.degree > 2:
            raise ValueError(f"Solid: degree must be 1 or 2, got {degree!r}")
        self.mesh, self.source = mesh, mesh.mesh
        materials = self._take(material)
        if formulation is None:
            formulation = default_formulation(mesh.cell, self.degree, materials)
        self.formulation = formulation
        self.formulation.check(mesh.cell, self.degree)
        self.damping = mass_only(damping, "Solid")
        self._space = fem.functionspace(mesh.mesh, ("P", self.degree))
        self.connectivity: Indices = self._space.dofmap.list.astype(np.int64)
        self.rule = VolumeRule.of(mesh.mesh, self.degree)
        places: Array = self._space.tabulate_dof_coordinates()
        self.places = places
        frames = np.concatenate([places[:, np.newaxis], np.tile(np.eye(3), (len(places), 1, 1))], 1)
        super().__init__(
            frames,
            cells=np.empty((0, 2), dtype=np.int64),
            outline=None,
            size=diameter(places),
            points=self._points_by_name(),
            name=name,
        )
        log_coincident(self.label, places)
        self.faces = self.skin.drawn()
        self.thickness = np.zeros(len(self.faces))
        if (mesh.cell, self.degree) == ("tetrahedron", 1):
            _log.warning(
                "%s has tetrahedra of degree 1, which are much too stiff in bending and lock with "
                "nearly incompressible material: Solid(…, degree=2) is not",
                self.label,
            )

    @classmethod
    def brick(
        cls,
        lengths: npt.ArrayLike,
        material: SolidMaterial,
        *,
        cells: tuple[int, int, int],
        origin: npt.ArrayLike = (0.0, 0.0, 0.0),
        cell: str = "hexahedron",
        degree: int = 1,
        formulation: SolidFormulation | None = None,
        damping: Damping | None = None,
        name: str = "",
    ) -> Solid:
        """Box with edges along the axes, divided into equal cells.

        Its faces are "a=0", "a=1", "b=0", … with a, b and c along x, y and z, its edges the curves
        "a=0,b=0" and so on, its corners the points "000" to "111".

        Args:
            lengths: Lengths of its edges, shape (3,).
            material: See :class:`Solid`.
            cells: Numbers of cells along x, y and z.
            origin: Corner with the smallest coordinates.
            cell: ``"hexahedron"`` or ``"tetrahedron"``.
            degree: Degree of the interpolation.
            formulation: Finite element.
            damping: Mass-proportional damping.
            name: Name in messages and results.
        """
        mesh = brick(lengths, cells, origin=origin, cell=cell)
        return cls(
            mesh, material, degree=degree, formulation=formulation, damping=damping, name=name
        )

    def _take(self, material: SolidMaterials) -> list[SolidMaterial]:
        """Set law, parameters and density of the cells; return the distinct materials."""
        count = self.mesh.cells
        if isinstance(material, Mapping):
            expected = "a SolidMaterial such as NeoHooke(E, nu, density)"
            kind: Any = SolidMaterial
            each = of_groups(material, kind, expected, count, self.mesh.group)
        else:
            instance(material, SolidMaterial, "Solid: material", "a SolidMaterial or one per group")
            each = [material] * count
        self.material = each[0]
        for other in each:
            alike = len(other.parameters) == len(self.material.parameters)
            if other.law != self.material.law or not alike:
                raise ValueError(
                    "all cells of a Solid have one law, and differ in its parameters and density: "
                    f"got {self.material} and {other}; join two Solids instead"
                )
        self.parameters = np.array([of.parameters for of in each], dtype=np.float64)
        self.has_mass = all(bool(of.density) for of in each)
        self.density = np.array([0.0 if of.density is None else of.density for of in each])
        return list({id(of): of for of in each}.values())

    def _points_by_name(self) -> dict[str, int]:
        """Nodes of the named points that are one node each."""
        named = {key: nodes_on(self._space, *self.mesh.part(key)) for key in self.mesh.named_points}
        return {key: int(nodes[0]) for key, nodes in named.items() if len(nodes) == 1}

    @cached_property
    def skin(self) -> Faces:
        """All facets of the boundary."""
        topology = self.mesh.mesh.topology
        topology.create_connectivity(2, 3)
        facets = dolfinx.mesh.exterior_facet_indices(topology)
        return faces_of(self._space, facets.astype(np.int64), self.degree)

    @property
    def node_type(self) -> NodeType:
        """Nodes with positions only."""
        return NodeType.POSITION

    @property
    def kind(self) -> Hashable:
        """The solid itself: each solid is assembled on its own mesh."""
        return self

    @classmethod
    def assemble(cls, bodies: Sequence[Any], holds: Holds = NO_HOLDS) -> SolidAssembly:
        """Assembly of the only body."""
        (body,) = bodies
        return SolidAssembly(body)

    @property
    def space(self) -> fem.FunctionSpace:
        """Lagrange space on the unloaded mesh whose nodes are those of the body."""
        return self._space

    @property
    def volume(self) -> float:
        """Unloaded volume."""
        return float(self.rule.volumes.sum())

    def nodes(self, where: str) -> Indices:
        """Numbers of the nodes of a named face, curve, point or group of cells.

        Args:
            where: Name of the point, curve, face or group.
        """
        text(where, f"the name of a set of points of {self.label}")
        return nodes_on(self._space, *self.mesh.part(where))

    def facets(self, name: str) -> Faces:
        """Facets of a named face, as surface cells.

        Args:
            name: Name of the face.

        Raises:
            ValueError: There is no such face; the message lists those that exist.
        """
        return faces_of(self._space, self.mesh.face(name), self.degree)

    def point(
        self,
        where: Where,
        *,
        tolerance: float | None = None,
        axes: npt.ArrayLike | None = None,
    ) -> Point:
        """Point with a name, at a node or at a position; for a named set, its mean frame.

        The mean frame is for joints, springs, drives, motions and loads. Its position is the mean
        of those of the nodes, on a face weighted by their consistent areas; its rotation is the
        mean rotation of the set, which may deform. Forces on it are distributed to the nodes with
        the same weights.

        Args:
            where: As of any body; or the name of a face, curve, group of cells, or several points.
            tolerance: As of any body, to the closest node.
            axes: Unloaded axes of the frame of a set as rows, shape (3, 3); default: global axes.

        Raises:
            ValueError: As of any body; or the nodes of a set are collinear, the axes are not
                right-handed and orthonormal, or axes are given for a single node.
            TypeError: As of any body.
        """
        if not isinstance(where, str):
            if axes is not None:
                raise ValueError(f"axes are those of a named set of {self.label}, got {where!r}")
            return super().point(where, tolerance=tolerance)
        nodes = self.nodes(where)
        if len(nodes) == 1 and axes is None:
            return Point(self, int(nodes[0]), where)
        return self._mean(where, nodes, np.eye(3) if axes is None else axes)

    def _mean(self, name: str, nodes: Indices, axes: npt.ArrayLike) -> Point:
        """Point with the mean frame of a named set."""
        weights: Array = np.ones(len(nodes))
        if name in self.mesh.faces:
            faces, total = self.facets(name), np.zeros(len(self.frames))
            np.add.at(total, faces.nodes, faces.consistent_areas(self.places))
            weights = total[nodes]
        chosen = numbers(axes, f"axes of {self.label}.{name}")
        if chosen.shape != (3, 3) or not _is_rotation(chosen):
            raise ValueError(
                f"axes of {self.label}.{name}: expected three orthonormal, right-handed rows, "
                f"got\n{chosen}"
            )
        attachment = in_the_mean([int(node) for node in nodes], self.places[nodes], weights, chosen)
        return Point(self, int(nodes[0]), name, attachment)

    def cells_of(self, group: str | None = None) -> Indices:
        """Cells of a named group (default: all).

        Args:
            group: Name of the group; default: all.

        Raises:
            ValueError: There is no such group; the message lists those that exist.
        """
        return np.arange(self.mesh.cells) if group is None else self.mesh.group(group)


def _is_rotation(axes: Array) -> bool:
    gap = np.abs(axes @ axes.T - np.eye(3)).max()
    return bool(gap <= _ORTHONORMAL and np.linalg.det(axes) > 0.0)
