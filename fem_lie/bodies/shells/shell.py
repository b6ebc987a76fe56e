"""Shells with shear: positions and directors on surface meshes, five or six unknowns at a node."""

from __future__ import annotations

import logging
from collections import Counter
from collections.abc import Callable, Hashable, Mapping, Sequence
from math import cos, degrees, pi, radians

import basix
import dolfinx
import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices, instance, log_coincident, number
from fem_lie.bodies.body import NO_HOLDS, Holds
from fem_lie.bodies.nodes import HeldRotation, Turning
from fem_lie.bodies.shells.assembly import ShellAssembly, weighted_surface_cells
from fem_lie.bodies.shells.placing import (
    Director,
    ShellSections,
    axes_along,
    frames_with,
    given_directors,
    own_mesh,
    section_per_cell,
)
from fem_lie.bodies.shells.supports import SupportedSurface
from fem_lie.elements.shells.drilling import drilling_stiffness
from fem_lie.elements.shells.element import HellingerReissner, ShellFormulation
from fem_lie.lie.motions import Group
from fem_lie.mesh.reading import surface_from_dolfinx
from fem_lie.mesh.shapes import rule, tabulated
from fem_lie.mesh.surfaces import KINK_ANGLE, SurfaceMesh
from fem_lie.sections.shell_section import ShellSection

_log = logging.getLogger(__name__)

_FACETS = radians(10.0)  # a circle of 18 cells


class Shell(SupportedSurface):
    """Shear-deformable shell with an 8×8 section stiffness on a surface, with kinks and branches.

    A node has a position and a director, which is the third axis of its frame and need not be
    normal to the surface. Rotation about the director, the drilling rotation, is an unknown of
    shells with ``drilling=True`` only, see :mod:`fem_lie.elements.shells.drilling`. At a kink or
    branch, each smooth side has its own nodes and directors; they are rigidly attached to the node
    of the first side.

    Attributes:
        connectivity: Nodes of each cell, shape (m, k).
        own_mesh: Surface mesh on these nodes, cut along kinks and branches.
        stiffness: Section stiffness of each cell, shape (m, 8, 8).
        density: Mass matrix per area in (position, director) of each cell, shape (m, 2, 2).
        axes: Vector in each cell whose projection onto the surface is e₁ of its strains, (m, 3).
        formulation: Finite element of the cells.
        drilling: Whether nodes have a drilling rotation; ``None``: only if something needs it.
        convected_axes: Whether frames rotate about their directors with the mid-surface.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> mesh = fl.mesh.parametric_surface(lambda a, b: np.array([a, b, 0.0]), (2, 2))
        >>> plate = fl.Shell(mesh, fl.ShellSection.layer(0.01, steel))
        >>> _ = plate.clamp("a=0")
        >>> plate.connectivity.shape
        (4, 4)
    """

    uncoupled = True
    group = Group.R3xSO3

    def __init__(
        self,
        mesh: SurfaceMesh | dolfinx.mesh.Mesh,
        section: ShellSections,
        *,
        director: Director | None = None,
        along: npt.ArrayLike | Director | None = None,
        formulation: ShellFormulation | None = None,
        kink_angle: float = KINK_ANGLE,
        drilling: bool | None = None,
        convected_axes: bool = False,
        name: str = "",
    ) -> None:
        """Create the nodes, with one director on each smooth side.

        Args:
            mesh: Surface mesh, or a DOLFINx mesh, see
                :func:`~fem_lie.mesh.reading.surface_from_dolfinx`.
            section: One for all cells, one for each named group of cells, or a function of the
                centre of a cell, shape (3,), for variable thickness.
            director: Unit director as a function of the position, shape (3,), on the side of the
                cells' normals and within ``kink_angle`` of them; only for surfaces without kinks
                and branches. Default: mean normal of the cells on each smooth side.
            along: Direction of e₁ of the section axes before projection onto the surface: one
                vector, or a function of the centre of a cell; default: from the first to the second
                corner.
            formulation: Finite element; default: :class:`HellingerReissner`.
            kink_angle: Largest angle between neighbouring cells of a smooth surface, rad.
            drilling: Whether nodes have the rotation about the director as a sixth unknown. Default
                ``None``: yes if a joint, link, prescribed motion or moment acts on the rotation of
                a node, or if the surface has kinks or branches.
            convected_axes: Rotate the frames about their directors with the mid-surface after each
                step. The motion does not depend on it, but the iteration matrix of a rotating shell
                stays valid longer. Only without drilling rotation.
            name: Name in messages and results.

        Raises:
            ValueError: A cell has no section, the element does not support the cells, a surface
                with ``drilling=False`` has a kink or branch, ``drilling`` and ``convected_axes``
                are both true, or a director is not finite, lies in the surface or points to the
                other side.
        """
        if isinstance(mesh, dolfinx.mesh.Mesh):
            mesh = surface_from_dolfinx(mesh)
        instance(
            mesh, SurfaceMesh, "Shell: mesh", "a SurfaceMesh, as of fl.mesh.parametric_surface()"
        )
        known = "a ShellSection, a dict of them by groups of cells or a function of the position"
        instance(section, ShellSection | Mapping | Callable, "Shell: section", known)
        instance(formulation, ShellFormulation | None, "Shell: formulation", "an element or None")
        number(kink_angle, "Shell: kink_angle")
        if director is not None:
            instance(director, Callable, "Shell: director", "a function of the position or None")
        self.mesh, self.source = mesh, mesh.source
        self.formulation = HellingerReissner() if formulation is None else formulation
        self.formulation.measures_for(mesh.cell, mesh.degree)
        centres = mesh.points[mesh.corners].mean(axis=1)
        sections = section_per_cell(mesh, centres, section)
        self.stiffness = np.array([s.stiffness for s in sections])
        self.density = np.array([s.inertia for s in sections])
        self.has_mass = all(s.inertia[0, 0] > 0 for s in sections)
        self.axes = axes_along(mesh, centres, along)
        instance(drilling, bool | None, "Shell: drilling", "True, False or None")
        instance(convected_axes, bool, "Shell: convected_axes", "True or False")
        if drilling and convected_axes:
            raise ValueError("expected convected_axes=True without drilling=True, got both")
        self.drilling, self.convected_axes = False if convected_axes else drilling, convected_axes
        patches = mesh.patches(kink_angle if director is None else pi)
        self.connectivity = patches.cells
        directors = (
            patches.directors
            if director is None
            else given_directors(mesh, director, patches, kink_angle)
        )
        super().__init__(
            frames_with(mesh.points[patches.places], directors),
            cells=np.empty((0, 2), dtype=np.int64),
            outline=None,
            size=float(np.linalg.norm(np.ptp(mesh.points, axis=0))),
            points={key: int(p[0]) for key, p in mesh.named_points.items() if len(p) == 1},
            masters=patches.places,
            name=name,
        )
        self.own_mesh = own_mesh(mesh, patches)
        log_coincident(self.label, mesh.points)
        self._log_turns(kink_angle)
        self.faces = mesh.corners_of(patches.cells)
        self.thickness = np.array([s.thickness for s in sections], dtype=np.float64)
        self._has_kinks = bool(len(patches.split))
        if self._has_kinks:
            self._refuse_with_five(f"the kink or branch at {mesh.points[patches.split[0]]}")

    @property
    def kind(self) -> Hashable:
        """Key of shells that are assembled together: same formulation and cell type."""
        return type(self), self.formulation, self.mesh.cell, self.mesh.degree

    def drills(self, holds: Sequence[HeldRotation] = ()) -> bool:
        """Whether nodes have a drilling rotation, given the rotations that joints and loads need.

        Args:
            holds: Rotations of nodes that joints, motions and moments act on.

        Raises:
            ValueError: The shell has ``drilling=False``, and one of them needs it.
        """
        needed = [hold for hold in holds if hold.needed]
        for hold in needed:
            if not (self._tilts(hold) and self.drilling is False):
                self._refuse_with_five(hold.what)
        if self.drilling is not None:
            return self.drilling
        return self._has_kinks or bool(needed)

    def drilling_given(self, holds: Sequence[HeldRotation]) -> tuple[bool, Array | None]:
        """Whether nodes have a drilling rotation for these holds, and its stiffness, shape (m,).

        Args:
            holds: Rotations of nodes that joints, motions and moments act on.
        """
        drills = self.drills(holds)
        return drills, self.drilling_stiffness(holds) if drills else None

    def drilling_stiffness(self, holds: Sequence[HeldRotation]) -> Array:
        """Drilling stiffness γ of each cell, :mod:`fem_lie.elements.shells.drilling`, (m,), N/m.

        Moments that a rigid part applies to several nodes act by forces, and do not raise γ.

        Args:
            holds: Rotations of nodes that joints, motions and moments act on.
        """
        bound: dict[int, set[Hashable]] = {}
        for hold in holds:
            if not self._tilts(hold):
                bound.setdefault(int(self.masters[hold.node]), set()).add(hold.other)
        held_by = Counter(other for others in bound.values() for other in others)
        alone = [
            node for node, others in bound.items() if any(held_by[other] == 1 for other in others)
        ]
        areas = self._measure()[1].sum(axis=1)
        return drilling_stiffness(self.stiffness, areas, self.mesh.cells, alone)

    def _log_turns(self, kink_angle: float) -> None:
        """Log the largest angle between normals of cells and the director that they share."""
        directors, normals = self.frames[self.connectivity, 3], self.mesh.normals
        cosine = np.einsum("mkj,mkj->mk", directors, normals)
        if cosine.min() < cos(_FACETS):
            position = self.frames[self.connectivity.ravel()[cosine.argmin()], 0]
            _log.info(
                "%s: normals of cells are up to %.0f° off their common director, at %s; neighbours "
                "within kink_angle = %.0f° of each other count as smooth",
                *(self.label, degrees(np.arccos(cosine.min())), position, degrees(kink_angle)),
            )

    def _tilts(self, hold: HeldRotation) -> bool:
        """Whether a moment about ``hold.axis`` is perpendicular to the director of its node."""
        axis = hold.axis
        if axis is None:
            return False
        return bool(abs(axis @ self.frames[hold.node, 3]) < 1e-9 * np.linalg.norm(axis))

    def _refuse_with_five(self, what: str) -> None:
        if self.drilling is False:
            raise ValueError(
                f"{what} needs nodes that rotate about all axes, but {self.label} has "
                "drilling=False: omit it, or pass drilling=True (Spherical and InPlane joints at "
                "a node itself need no drilling rotation)"
            )

    @classmethod
    def assemble(cls, bodies: Sequence[Shell], holds: Holds = NO_HOLDS) -> ShellAssembly:
        """Assemble all shells of one :attr:`kind`, with drilling if the first of them needs it."""
        if not bodies[0].drills(holds.get(bodies[0], ())):
            return ShellAssembly(bodies)
        each = [body.drilling_stiffness(holds.get(body, ())) for body in bodies]
        return ShellAssembly(bodies, np.concatenate(each))

    @property
    def elastic_cells(self) -> Indices:
        """Nodes of each cell with strain energy, shape (m, k)."""
        return self.connectivity

    def weighted_cells(self, cells: Indices, weights: Array) -> ShellAssembly:
        """Assembly of some cells with weighted energies, without drilling.

        Args:
            cells: Indices of the cells, shape (s,).
            weights: Factor of the energy of each, shape (s,).
        """
        return weighted_surface_cells(self, cells, weights)

    def edges(self, name: str) -> tuple[Indices, Array]:
        """Nodes of a named curve's edges and their consistent lengths, both (e, 2 or 3), m.

        Args:
            name: Name of the curve.

        Raises:
            ValueError: There is no such curve; the message lists those that exist.
        """
        edges = self.mesh.curve(name)
        x = self.frames[edges, 0]
        if edges.shape[1] == 2:
            length = np.linalg.norm(x[:, 1] - x[:, 0], axis=1)
            return edges, np.outer(length, [0.5, 0.5])
        # the parabola through three points, integrated by three Gauss points
        s, w = np.polynomial.legendre.leggauss(3)
        N = np.array([0.5 * s * (s - 1), 0.5 * s * (s + 1), 1 - s * s])
        dN = np.array([s - 0.5, s + 0.5, -2 * s])
        speed = np.linalg.norm(np.einsum("kg,ekj->egj", dN, x), axis=2)
        return edges, np.einsum("g,kg,eg->ek", w, N, speed)

    def turning(self) -> Turning:
        """Edges of the cells, along which rotations are limited."""
        ends = np.array(basix.topology(basix.CellType[self.mesh.cell])[1])
        along, limit = self.connectivity[:, ends], self._largest_turn()
        if self.mesh.degree == 2:
            corners = len(self.mesh.corners[0])
            inside = self.connectivity[:, corners : corners + len(ends), np.newaxis]
            along = np.concatenate([along[:, :, :1], inside, along[:, :, 1:]], axis=2)
        elements = np.repeat(np.arange(len(along)), len(ends))
        return Turning(along.reshape(len(elements), -1), elements, limit, whole=False)

    def _largest_turn(self) -> float:
        """Largest rotation along an edge of a cell that the element represents, rad."""
        return self.formulation.measures_for(self.mesh.cell, self.mesh.degree).largest_turn

    def areas(self) -> Array:
        """Consistent weights in area of the nodes of each cell, shape (m, k), m²."""
        shapes, weights = self._measure()
        return np.einsum("gk,mg->mk", shapes, weights)

    def element_inertia(self) -> Array:
        """Consistent mass matrix in (x, d₁, d₂, d₃) of each cell, shape (m, k, 4, k, 4)."""
        shapes, weights = self._measure()
        blocks = np.zeros((*self.mesh.cells.shape, 4, self.mesh.cells.shape[1], 4))
        mass = np.einsum("gi,gj,mg,mab->miajb", shapes, shapes, weights, self.density)
        for a, row in enumerate((0, 3)):
            for b, column in enumerate((0, 3)):
                blocks[:, :, row, :, column] = mass[:, :, a, :, b]
        return blocks

    def cells_of(self, group: str | None = None) -> Indices:
        """Cells of a named group (default: all cells).

        Args:
            group: Name of the group; default: all.

        Raises:
            ValueError: There is no such group; the message lists those that exist.
        """
        return np.arange(len(self.mesh.cells)) if group is None else self.mesh.group(group)

    def _measure(self) -> tuple[Array, Array]:
        """Shape functions (g, k), and quadrature weights times area (m, g)."""
        cell, degree = self.mesh.cell, self.mesh.degree
        points, w = rule(cell, 2 * degree + 2)
        table = tabulated(cell, degree, points)
        x = self.frames[self.mesh.cells, 0]
        g1, g2 = np.einsum("agk,mkj->amgj", table[1:], x)
        return table[0], w * np.linalg.norm(np.cross(g1, g2), axis=-1)
