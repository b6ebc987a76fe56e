"""Beams: nodal frames along a line, sections per cell, and the SE(3) geodesic element."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from mpi4py import MPI

import basix.ufl
import numpy as np
import numpy.typing as npt
import ufl
from dolfinx import fem

from fem_lie import _compat, lie
from fem_lie._jit import Array
from fem_lie.assembly import Assembly, consistent_inertia
from fem_lie.bodies import Body, Point, vector
from fem_lie.elements.geodesic import GEODESIC, geodesic_energy, with_bending_flexibility
from fem_lie.frames import NodalFrames
from fem_lie.groups import Group
from fem_lie.kernel import LocalFrameForms
from fem_lie.mesh import LineMesh, curve, straight
from fem_lie.section import Section


class GeodesicBeams(Assembly):
    """All geodesic beams of a scene on one line mesh."""

    def __init__(self, bodies: Sequence[Beam]) -> None:
        """Merge the bodies' meshes and build the forms; coincident nodes of bodies stay apart."""
        starts = np.cumsum([0] + [len(body.frames) for body in bodies])
        frames = np.concatenate([body.frames for body in bodies])
        cells = np.concatenate(
            [body.cells + start for body, start in zip(bodies, starts[:-1], strict=True)]
        )
        mesh = _compat.create_line_mesh(MPI.COMM_SELF, frames[:, 0].copy(), cells)
        permutation = mesh.topology.original_cell_index
        nodal = NodalFrames(mesh)
        order = np.empty(len(frames), dtype=np.int64)
        given = mesh.geometry.input_global_indices[_compat.geometry_dofmap(mesh)]
        order[given] = nodal.function.function_space.dofmap.list
        nodal.frames[order] = frames

        ends = frames[cells[permutation]]
        relative = lie.se3_relative(ends[:, 0], ends[:, 1])
        length = np.concatenate([body.lengths for body in bodies])[permutation]
        stiffness = np.concatenate([body.effective_stiffness() for body in bodies])[permutation]

        def cellwise(values: Array) -> fem.Function:
            element = basix.ufl.element("DG", "interval", 0, shape=values.shape[1:])
            f = fem.Function(fem.functionspace(mesh, element))
            f.x.array[:] = values.ravel()
            return f

        d, d0, ell, D = (cellwise(a) for a in (relative, relative, length, stiffness))
        energy = geodesic_energy(d, d0, ell, D, mesh)
        forms = LocalFrameForms(energy, nodal.function, nodal.increment, GEODESIC, coordinates=d)
        super().__init__(nodal, forms, order, None)
        if all(body.has_mass for body in bodies):
            density = cellwise(np.concatenate([body.density for body in bodies])[permutation])
            matrix = consistent_inertia(density, ell / ufl.CellVolume(mesh))
            assert (matrix.indices == self.indices).all()
            self.inertia = matrix.data.reshape(-1, 4, 4).copy()


class Beam(Body):
    """A beam of any 6×6 section along a smooth line, straight or curved.

    Attributes:
        lengths: Arc length of each cell, unloaded.
        stiffness: Section stiffness of each cell, shape (m, 6, 6).
        density: Gram matrix of inertia per length of each cell, shape (m, 4, 4).
        has_mass: Whether all sections have inertia.
    """

    assembly = GeodesicBeams

    def __init__(
        self,
        mesh: LineMesh,
        section: Section | Mapping[str, Section],
        *,
        up: npt.ArrayLike | None = None,
        bending_flexibility: bool = True,
        group: Group = Group.SE3,
        name: str = "",
    ) -> None:
        """Place nodal frames: e₁ along the line, e₃ as near as can be to ``up``.

        Args:
            mesh: The line; its tangents at a node must agree.
            section: One for all cells, or one for each named group of cells.
            up: Approximate direction of e₃; default: global z, or x if the line begins along z.
            bending_flexibility: Add the residual bending flexibility (MacNeal 1978) to the shear
                flexibility: exact for small deflections with one element, and more accurate beyond.
            group: On which the nodes move in time integration.
            name: For messages and results.

        Raises:
            ValueError: A cell without section, a kink or a branch in the line, or ``up`` along it.
        """
        self._groups = dict(mesh.groups)
        sections = _section_per_cell(mesh, section)
        frames = _nodal_frames(mesh, up)
        ends = frames[mesh.cells]
        # the geodesic of an arc with tangent frames is the arc itself
        self.lengths = np.linalg.norm(lie.se3_relative(ends[:, 0], ends[:, 1])[:, :3], axis=1)
        self.stiffness = np.array([s.stiffness for s in sections])
        self.has_mass = all(s.inertia is not None for s in sections)
        self.density = np.array(
            [np.zeros((4, 4)) if s.inertia is None else s.inertia for s in sections]
        )
        self._bending_flexibility = bending_flexibility
        named = {key: int(nodes[0]) for key, nodes in mesh.named_points.items() if len(nodes) == 1}
        super().__init__(
            frames,
            cells=mesh.cells,
            outline=sections[0].outline,
            size=float(self.lengths.sum()),
            points=named,
            group=group,
            name=name,
        )

    @classmethod
    def straight(
        cls,
        start: npt.ArrayLike,
        end: npt.ArrayLike,
        section: Section,
        *,
        cells: int,
        up: npt.ArrayLike | None = None,
        bending_flexibility: bool = True,
        group: Group = Group.SE3,
        name: str = "",
    ) -> Beam:
        """Straight beam with ``cells`` equal elements; points "start" and "end"."""
        mesh = straight(start, end, cells)
        return cls(
            mesh,
            section,
            up=up,
            bending_flexibility=bending_flexibility,
            group=group,
            name=name,
        )

    @classmethod
    def curve(
        cls,
        function: Callable[[float], npt.ArrayLike],
        section: Section,
        *,
        cells: int,
        up: npt.ArrayLike | None = None,
        bending_flexibility: bool = True,
        group: Group = Group.SE3,
        name: str = "",
    ) -> Beam:
        """Beam along ``function(s)``, s from 0 to 1; points "start" and "end"."""
        mesh = curve(function, cells)
        return cls(
            mesh,
            section,
            up=up,
            bending_flexibility=bending_flexibility,
            group=group,
            name=name,
        )

    @property
    def start(self) -> Point:
        """The point named "start"."""
        return self["start"]

    @property
    def end(self) -> Point:
        """The point named "end"."""
        return self["end"]

    def effective_stiffness(self) -> Array:
        """Stiffness of each element, with the bending flexibility if it is on, (m, 6, 6)."""
        if not self._bending_flexibility:
            return self.stiffness
        return with_bending_flexibility(self.stiffness, self.lengths)

    def cell_lengths(self, group: str | None = None) -> tuple[npt.NDArray[np.int64], Array]:
        """Cells of a named group (default: all), and their lengths.

        Raises:
            ValueError: There is no such group; the message lists those that exist.
        """
        if group is None:
            return np.arange(len(self.cells)), self.lengths
        if group not in self._groups:
            known = ", ".join(sorted(self._groups)) or "none"
            raise ValueError(f"{self.label} has no group of cells {group!r}; it has: {known}")
        index = self._groups[group]
        return index, self.lengths[index]


def _section_per_cell(mesh: LineMesh, section: Section | Mapping[str, Section]) -> list[Section]:
    if isinstance(section, Section):
        return [section] * len(mesh.cells)
    chosen: list[Section | None] = [None] * len(mesh.cells)
    for group, value in section.items():
        if group not in mesh.groups:
            known = ", ".join(sorted(mesh.groups)) or "none"
            raise ValueError(f"the mesh has no group of cells {group!r}; it has: {known}")
        for cell in mesh.groups[group]:
            chosen[cell] = value
    missing = [i for i, value in enumerate(chosen) if value is None]
    if missing:
        raise ValueError(f"{len(missing)} cells have no section, the first is cell {missing[0]}")
    return [value for value in chosen if value is not None]


def _nodal_frames(mesh: LineMesh, up: npt.ArrayLike | None) -> Array:
    """Frames with e₁ along the tangent and e₃ nearest to ``up``, shape (n, 4, 3)."""
    n = len(mesh.points)
    if np.bincount(mesh.cells.ravel(), minlength=n).max() > 2:
        raise ValueError(
            "the line branches; make one beam of each branch and join them with Fixed joints"
        )
    tangents = np.zeros((n, 3))
    tangents[mesh.cells] = mesh.tangents
    gap = np.linalg.norm(tangents[mesh.cells] - mesh.tangents, axis=-1)
    if gap.max() > 1e-6:
        node = mesh.cells[np.unravel_index(gap.argmax(), gap.shape)]
        raise ValueError(
            f"the line has a kink at {mesh.points[node]} (or its cells point in opposite ways); "
            "make one beam of each part and join them with Fixed joints"
        )
    e1 = tangents / np.linalg.norm(tangents, axis=1)[:, np.newaxis]
    if up is None:
        direction = np.array([0.0, 0, 1]) if abs(e1[0, 2]) < 0.99 else np.array([1.0, 0, 0])
    else:
        direction = vector(up, 3, "up")
    e2 = np.cross(direction, e1)
    sine = np.linalg.norm(e2, axis=1)
    if sine.min() <= 1e-6 * np.linalg.norm(direction):
        raise ValueError(
            f"up = {direction} is along the line at {mesh.points[sine.argmin()]}: give another"
        )
    e2 /= sine[:, np.newaxis]
    return np.stack([mesh.points, e1, e2, np.cross(e1, e2)], axis=1)
