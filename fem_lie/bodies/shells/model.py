"""Model of shells with shear: nodes, cells, drilling rotations, assembly."""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Sequence
from typing import Any

import basix
import numpy as np

from fem_lie._arrays import Array, Indices, log_coincident
from fem_lie.bodies.model import NO_HOLDS, BodyModel, HeldRotation, Holds, RotationLimit
from fem_lie.bodies.shells.assembly import (
    SurfaceAssembly,
    assembly_of,
    weighted_surface_cells,
)
from fem_lie.bodies.shells.placing import cut_mesh, frames_with
from fem_lie.elements.shells.drilling import (
    MEMBRANE_SHEAR,
    TWIST,
    drilling_inertia,
    drilling_stiffness,
)
from fem_lie.elements.shells.element import ShellFormulation
from fem_lie.lie.motions import Group
from fem_lie.mesh.patches import Patches
from fem_lie.mesh.shapes import rule, tabulated
from fem_lie.mesh.surfaces import SurfaceMesh
from fem_lie.sections.shell_section import ShellSection


class ShellModel(BodyModel):
    """Model of a shell with shear.

    Attributes:
        mesh: Surface mesh; its points are the first nodes of the body.
        connectivity: Nodes of each cell, shape (m, k).
        cut_mesh: Surface mesh on these nodes, cut along kinks and branches.
        stiffness: Section stiffness of each cell, shape (m, 8, 8).
        density: Mass matrix per area in (position, director) of each cell, shape (m, 2, 2).
        has_mass: Whether all cells have inertia.
        axes: Vector in each cell whose projection onto the surface is e₁ of its strains, (m, 3).
        formulation: Finite element of the cells.
        drilling: Whether nodes have a drilling rotation; ``None``: only if something needs it.
        convected_axes: Whether frames rotate about their directors with the mid-surface.
    """

    dimension = 2
    group = Group.R3xSO3
    _drilling_of_whole: Array | None = None
    """Drilling stiffness of each cell, if these are some cells of a shell."""

    def __init__(
        self,
        mesh: SurfaceMesh,
        patches: Patches,
        directors: Array,
        sections: Sequence[ShellSection],
        axes: Array,
        formulation: ShellFormulation,
        *,
        drilling: bool | None,
        convected_axes: bool,
        class_name: str,
        name: str,
    ) -> None:
        """Create the nodes and the data of the cells.

        Args:
            mesh: Surface mesh.
            patches: Smooth sides of the surface, and the nodes of each cell.
            directors: Director of each node, shape (n, 3).
            sections: Section of each cell.
            axes: See :attr:`axes`.
            formulation: Finite element.
            drilling: See :attr:`drilling`.
            convected_axes: See :attr:`convected_axes`.
            class_name: Name of the class of the body.
            name: Name in messages and results.

        Raises:
            ValueError: A surface with ``drilling=False`` has a kink or branch.
        """
        self.mesh, self.source, self.formulation = mesh, mesh.source, formulation
        self.stiffness = np.array([s.stiffness for s in sections])
        self.density = np.array([s.inertia for s in sections])
        self.has_mass = all(s.inertia[0, 0] > 0 for s in sections)
        self.axes, self.drilling, self.convected_axes = axes, drilling, convected_axes
        self.connectivity = patches.cells
        super().__init__(
            frames_with(mesh.points[patches.masters], directors),
            class_name=class_name,
            size=float(np.linalg.norm(np.ptp(mesh.points, axis=0))),
            points={key: int(p[0]) for key, p in mesh.named_points.items() if len(p) == 1},
            masters=patches.masters,
            name=name,
        )
        self.cut_mesh = cut_mesh(mesh, patches)
        log_coincident(self.label, mesh.points)
        self.faces = mesh.corners_of(patches.cells)
        self.thickness = np.array([s.thickness for s in sections], dtype=np.float64)
        self._has_kinks = bool(len(patches.split))
        if formulation.whole_frames:
            self._refuse_with_five(type(formulation).__name__)
        if self._has_kinks:
            self._refuse_with_five(f"the kink or branch at {mesh.points[patches.split[0]]}")

    @property
    def assembly_key(self) -> Hashable:
        """Key of shells that are assembled together: same formulation and cell type."""
        return type(self), self.formulation, self.mesh.cell, self.mesh.degree

    @property
    def separates_director(self) -> bool:  # type: ignore[override]
        """Whether statics moves the director before it drills."""
        return not self.formulation.whole_frames

    @property
    def divisible_cells(self) -> Indices | None:
        """Nodes of each cell."""
        return self.connectivity

    def restricted(self, cells: Indices, holds: Sequence[HeldRotation]) -> tuple[Any, Indices]:
        """Model of some of its cells, with the drilling rotations and their stiffness of all.

        Args:
            cells: Indices of the cells, ascending, shape (s,).
            holds: Rotations of nodes of the whole body that joints, motions and moments act on.
        """
        part, nodes = super().restricted(cells, holds)
        part.mesh = self.mesh.restricted(cells)
        part.connectivity = np.searchsorted(nodes, self.connectivity[cells])
        for name in "stiffness", "density", "axes":
            setattr(part, name, getattr(self, name)[cells])
        part.thickness = self.thickness[cells]
        part.drilling, stiffness = self.drilling_for(holds)
        part._drilling_of_whole = None if stiffness is None else stiffness[cells]
        part.cut_mesh = part.mesh  # of the whole shell for results
        return part, nodes

    def nodes(self, where: str) -> Indices:
        """Numbers of the nodes of a named curve, group of cells or group of points.

        Where the surface has a kink or branches, one node stands for all at a position: the others
        are rigidly attached to it.

        Args:
            where: Name of the point, curve, face or group.
        """
        return self.mesh.nodes(where)

    def hold_along(self, node: int, along: Array) -> None:
        """Hold one more translation of a node, along axes that are fixed in space.

        Args:
            node: Number of the node.
            along: Unit vector, global components, shape (3,).
        """
        held, axes = self.held[node], self.supports[node]
        own = axes if np.isfinite(axes[0, 0]) else self.frames[node, 1:]
        before = own[held[:3]]
        rest = along - before.T @ (before @ along)
        if np.linalg.norm(rest) <= 1e-9:
            return  # already held, as where a diaphragm meets a plane of symmetry
        known = np.vstack([before, rest / np.linalg.norm(rest)])
        # the others are any that are perpendicular
        free = np.linalg.svd(known)[2][len(known) :]
        self.supports[node] = np.vstack([known, free])
        held[:3] = np.arange(3) < len(known)

    def hold_rotations(self, node: int, normal: Array) -> None:
        """Rotate the frame of a node and hold rotations out of a plane, and the drilling rotation.

        Args:
            node: Number of the node.
            normal: Unit normal of the plane, perpendicular to the director, shape (3,).

        Raises:
            ValueError: The node is on another such plane that is not perpendicular.
        """
        H, held = self.frames[node], self.held[node]
        if held.all():
            return
        if held[4] and abs(H[2] @ normal) < 1.0 - 1e-6:
            raise ValueError(
                f"node {node} of {self.label} is on planes of symmetry that are not perpendicular"
            )
        tilt = 3 if held[4] else 4
        if tilt == 4:
            # the director stays as it is to the last digit
            e1 = normal - (normal @ H[3]) * H[3]
            H[1] = e1 / np.linalg.norm(e1)
            H[2] = np.cross(H[3], H[1])
        held[tilt] = held[5] = True

    def hold_normal(self, node: int, normal: Array) -> None:
        """Hold the translation of a node along the normal of :meth:`hold_rotations`."""
        H, held = self.frames[node], self.held[node]
        if np.isfinite(self.supports[node, 0, 0]):
            self.hold_along(node, normal)
        else:
            held[int(np.abs(H[1:3] @ normal).argmax())] = True

    def has_drilling(self, holds: Sequence[HeldRotation] = ()) -> bool:
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
        return self._has_kinks or bool(needed) or self.formulation.whole_frames

    def drilling_for(self, holds: Sequence[HeldRotation]) -> tuple[bool, Array | None]:
        """Whether nodes have a drilling rotation for these holds, and its stiffness, shape (m,).

        Args:
            holds: Rotations of nodes that joints, motions and moments act on.
        """
        drills = self.has_drilling(holds)
        return drills, self.drilling_stiffness(holds) if drills else None

    def drilling_stiffness(self, holds: Sequence[HeldRotation]) -> Array:
        """Drilling stiffness γ of each cell, :mod:`fem_lie.elements.shells.drilling`, (m,), N/m.

        Moments that a rigid part applies to several nodes act by forces, and do not raise γ.

        Args:
            holds: Rotations of nodes that joints, motions and moments act on.
        """
        if self._drilling_of_whole is not None:
            return self._drilling_of_whole
        if self.formulation.whole_frames:
            return self.stiffness[:, MEMBRANE_SHEAR, MEMBRANE_SHEAR]
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
    def assemble(cls, models: Sequence[ShellModel], holds: Holds = NO_HOLDS) -> SurfaceAssembly:
        """Assembly of shells of one :attr:`assembly_key`, with drilling if the first needs it."""
        if not models[0].has_drilling(holds.get(models[0], ())):
            return assembly_of(models)
        each = [model.drilling_stiffness(holds.get(model, ())) for model in models]
        return assembly_of(models, np.concatenate(each))

    @property
    def elastic_cells(self) -> Indices:
        """Nodes of each cell with strain energy, shape (m, k)."""
        return self.connectivity

    def weighted_cells(self, cells: Indices, weights: Array) -> SurfaceAssembly:
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

    def rotation_limit(self) -> RotationLimit:
        """Edges of the cells, along which rotations are limited."""
        ends = np.array(basix.topology(basix.CellType[self.mesh.cell])[1])
        along, limit = self.connectivity[:, ends], self._largest_turn()
        if self.mesh.degree == 2:
            corners = len(self.mesh.corners[0])
            inside = self.connectivity[:, corners : corners + len(ends), np.newaxis]
            along = np.concatenate([along[:, :, :1], inside, along[:, :, 1:]], axis=2)
        elements = np.repeat(np.arange(len(along)), len(ends))
        return RotationLimit(along.reshape(len(elements), -1), elements, limit, whole=False)

    def _largest_turn(self) -> float:
        """Largest rotation along an edge of a cell that the element represents, rad."""
        return self.formulation.measures_for(self.mesh.cell, self.mesh.degree).largest_turn

    def areas(self) -> Array:
        """Consistent weights in area of the nodes of each cell, shape (m, k), m²."""
        shapes, weights = self._measure()
        return np.einsum("gk,mg->mk", shapes, weights)

    def element_inertia(self) -> Array:
        """Consistent mass matrix in (x, d₁, d₂, d₃) of each cell, shape (m, k, 4, k, 4)."""
        density = np.zeros((len(self.density), 4, 4))
        density[:, ::3, ::3] = self.density
        return self._integrated(density)

    def element_drilling_inertia(self, drilling: Array) -> Array:
        """Rotary inertia of drilling rotations of each cell, shape (m, k, 4, k, 4).

        The rotary inertia about axes in the surface does not change.

        Args:
            drilling: Drilling stiffness γ of each cell, shape (m,), N/m.
        """
        areas, twist = self._measure()[1].sum(axis=1), self.stiffness[:, TWIST, TWIST]
        J = drilling_inertia(self.density, drilling, twist, areas)
        diagonal = np.array([0.0, 0.5, 0.5, -0.5])
        return self._integrated(J[:, np.newaxis, np.newaxis] * np.diag(diagonal))

    def _integrated(self, density: Array) -> Array:
        """Products of shape functions times densities (m, 4, 4), shape (m, k, 4, k, 4)."""
        shapes, weights = self._measure()
        return np.einsum("gi,gj,mg,mab->miajb", shapes, shapes, weights, density)

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
