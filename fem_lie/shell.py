"""Shells: positions and directors on surface meshes, five unknowns at each node."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence

import basix
import numpy as np
import numpy.typing as npt
from dolfinx import fem

from fem_lie import _compat
from fem_lie._jit import Array, Indices
from fem_lie.assembly import Assembly, NodalInertia
from fem_lie.bodies import Body, Point, vector
from fem_lie.elements.shell_cells import ShellCells
from fem_lie.elements.shell_formulation import HellingerReissner, ShellFormulation
from fem_lie.frames import NodalFrames
from fem_lie.groups import Group
from fem_lie.shell_section import ShellSection
from fem_lie.surface import KINK_ANGLE, SurfaceMesh

ShellSections = ShellSection | Mapping[str, ShellSection] | Callable[[Array], ShellSection]
Director = Callable[[Array], npt.ArrayLike]

_FIVE = 5
_LOCAL_ITERATIONS, _SETTLED = 20, 1e-13


class ShellAssembly(Assembly):
    """All shells of one formulation and kind of cell, on one surface mesh."""

    def __init__(self, bodies: Sequence[Shell]) -> None:
        """Merge the bodies' meshes and build the forms; coincident nodes stay apart."""
        first = bodies[0]
        starts = np.cumsum([0] + [len(body.frames) for body in bodies])
        frames = np.concatenate([body.frames for body in bodies])
        cells = np.concatenate(
            [body.mesh.cells + start for body, start in zip(bodies, starts[:-1], strict=True)]
        )
        cell, degree = first.mesh.cell, first.mesh.degree
        mesh = _compat.create_surface_mesh(frames[:, 0].copy(), cells, cell, degree)
        permutation = mesh.topology.original_cell_index
        nodal = NodalFrames(mesh, degree)
        order = np.empty(len(frames), dtype=np.int64)
        given = mesh.geometry.input_global_indices[_compat.geometry_dofmap(mesh)]
        order[given] = nodal.function.function_space.dofmap.list
        nodal.frames[order] = frames
        stiffness = np.concatenate([body.stiffness for body in bodies])[permutation]
        axes = np.concatenate([body.axes for body in bodies])[permutation]
        measures = first.formulation.measures_for(cell, degree)
        forms = first.formulation.forms(ShellCells(nodal, measures, directions=axes), stiffness)
        super().__init__(nodal, forms, order, np.argsort(permutation), None)
        plain = first.formulation.quadratic and measures.intermediate is None
        self._settles = forms.local is not None and not plain
        if all(body.has_mass for body in bodies):
            elements = np.concatenate([body.element_inertia() for body in bodies])
            # as the cells of the bodies, and their nodes, are ordered there
            self.inertia = NodalInertia(self.summed(elements[permutation]))

    def add_forces(self, H: Array, out: Array) -> None:
        """See the base class; what the cells carry is a coefficient and is packed anew."""
        self._frames.frames[:] = H
        forces = fem.assemble_vector(self._forms.residual).array
        out.reshape(-1, 6)[:, :_FIVE] += forces.reshape(-1, _FIVE)

    def energy(self, H: Array) -> float:
        """See the base class; mixed fields become those of these frames before."""
        if self._forms.local is not None:
            self.reset_stress(H)
        self._frames.frames[:] = H
        return float(fem.assemble_scalar(self._forms.energy))

    def _blocks(self, H: Array, form: fem.Form) -> Array:
        blocks = np.zeros((len(self.indices), 6, 6))
        five = self._assembled(H, form).reshape(-1, _FIVE, _FIVE)
        blocks[:, :_FIVE, :_FIVE] = five
        return blocks

    def settle(self, H: Array) -> None:
        """See the base class."""
        if self._settles:
            self.reset_stress(H)

    def reset_stress(self, H: Array) -> None:
        """See the base class; Newton's method in each cell where one solution is not enough."""
        for _ in range(_LOCAL_ITERATIONS if self._settles else 1):
            before = self.carried.copy()
            super().reset_stress(H)
            change = np.abs(self.carried - before).max(initial=0.0)
            if change <= _SETTLED * np.abs(before).max(initial=0.0):
                return

    def carry(self, H: Array, h: Array) -> None:
        """See the base class."""
        super().carry(H, h.reshape(-1, 6)[:, :_FIVE].ravel())


class Shell(Body):
    """A shell of any 8×8 section on a smooth surface.

    A node has a position and a director, which may tilt against the surface; turning about the
    director is no unknown. Its frame has the director third.

    Attributes:
        mesh: The surface.
        stiffness: Section stiffness of each cell, shape (m, 8, 8).
        density: Gram matrix of inertia per area of each cell, shape (m, 2, 2).
        axes: Vector in each cell whose projection onto the surface is e₁ of its strains, (m, 3).
        formulation: The element.
    """

    uncoupled = True
    drills = False

    def __init__(
        self,
        mesh: SurfaceMesh,
        section: ShellSections,
        *,
        director: Director | None = None,
        along: npt.ArrayLike | Director | None = None,
        formulation: ShellFormulation | None = None,
        kink_angle: float = KINK_ANGLE,
        group: Group = Group.R3xSO3,
        name: str = "",
    ) -> None:
        """Place nodal frames.

        Args:
            mesh: The surface.
            section: One for all cells, one for each named group of cells, or a function of the
                centre of a cell, shape (3,) (varying thickness).
            director: Unit normal as a function of the place, shape (3,), to the side of the cells'
                normals; default: the mean of the mesh's normals.
            along: e₁ of the sections' axes before projection onto the surface: one vector, or a
                function of the centre of a cell; default: from the first to the second corner.
            formulation: The element; default: :class:`HellingerReissner`.
            kink_angle: Largest angle, rad, between neighbouring cells that is still smooth.
            group: On which the nodes move in time integration.
            name: For messages and results.

        Raises:
            ValueError: A cell without section, an element that is not for these cells, a kink, or a
                director that is not finite, lies in the surface or points to the other side.
        """
        self.mesh = mesh
        self.formulation = HellingerReissner() if formulation is None else formulation
        self.formulation.measures_for(mesh.cell, mesh.degree)
        centres = mesh.points[mesh.corners].mean(axis=1)
        sections = _section_per_cell(mesh, centres, section)
        self.stiffness = np.array([s.stiffness for s in sections])
        self.density = np.array([s.inertia for s in sections])
        self.has_mass = all(s.inertia[0, 0] > 0 for s in sections)
        self.axes = _axes(mesh, centres, along)
        directors = mesh.directors(kink_angle) if director is None else _given(mesh, director)
        super().__init__(
            _frames(mesh.points, directors),
            cells=np.empty((0, 2), dtype=np.int64),
            outline=None,
            size=float(np.linalg.norm(np.ptp(mesh.points, axis=0))),
            points={key: int(p[0]) for key, p in mesh.named_points.items() if len(p) == 1},
            group=group,
            name=name,
        )
        self.faces = mesh.corners
        self.thickness = np.array([s.thickness for s in sections], dtype=np.float64)
        self.held[:, 5] = True

    @property
    def kind(self) -> Hashable:
        """Shells of one formulation and kind of cell are assembled together."""
        return type(self), self.formulation, self.mesh.cell, self.mesh.degree

    @classmethod
    def assemble(cls, bodies: Sequence[Shell]) -> Assembly:
        """See the base class."""
        return ShellAssembly(bodies)

    def points(self, name: str) -> list[Point]:
        """All nodes of a named curve, group of cells or group of points.

        Raises:
            ValueError: There is nothing of this name; the message lists what exists.
        """
        return [self.node(int(i)) for i in self._nodes(name)]

    def clamp(self, name: str) -> None:
        """Hold places and directors of a named curve, group of cells or group of points.

        Raises:
            ValueError: There is nothing of this name; the message lists what exists.
        """
        self.held[self._nodes(name)] = True

    def hinge(self, name: str) -> None:
        """Hold the places, not the directors, of a named curve or group.

        Raises:
            ValueError: There is nothing of this name; the message lists what exists.
        """
        self.held[self._nodes(name), :3] = True

    def symmetry(self, name: str, normal: npt.ArrayLike) -> None:
        """Let the nodes of a named curve lie on a plane of symmetry.

        Nodal frames are turned about their directors until e₁, or e₂ where two planes meet, is the
        normal; they keep it, so that no translation along it and no tilt towards it is held exactly
        in every state.

        Args:
            name: A named curve or group.
            normal: Of the plane, global components.

        Raises:
            ValueError: There is nothing of this name, the nodes are not in one plane with that
                normal, a director is not in that plane, or a node is on planes that are not
                perpendicular to each other.
        """
        nodes, n = self._nodes(name), vector(normal, 3, f"normal of symmetry {name!r}")
        if not n.any():
            raise ValueError(f"the normal of symmetry {name!r} must not be zero")
        n = n / np.linalg.norm(n)
        heights, tilts = self.frames[nodes, 0] @ n, self.frames[nodes, 3] @ n
        if np.ptp(heights) > 1e-6 * self.size or np.abs(tilts).max() > 1e-6:
            raise ValueError(
                f"{name!r} of {self.label} is not on a plane of symmetry with the normal {n}: "
                f"places vary by {np.ptp(heights):.2e} along it, directors by "
                f"{np.abs(tilts).max():.2e}; give an exact director"
            )
        for node in nodes:
            self._bind(int(node), n)

    def guide(self, name: str, normal: npt.ArrayLike) -> None:
        """Hold displacements along a direction fixed in space; directors stay free.

        Args:
            name: A named point, curve or group.
            normal: The direction, global components.

        Raises:
            ValueError: There is nothing of this name, the direction is zero, or it is held already.
        """
        nodes, n = self._nodes(name), vector(normal, 3, f"direction of guide {name!r}")
        for node in nodes:
            self._hold_along(int(node), n)

    def _hold_along(self, node: int, direction: Array) -> None:
        """Hold one more translation of a node, along axes fixed in space from here on."""
        held, axes = self.held[node], self.supports[node]
        own = axes if np.isfinite(axes[0, 0]) else self.frames[node, 1:]
        before = own[held[:3]]
        rest = direction - before.T @ (before @ direction)
        if not np.linalg.norm(rest) > 1e-9 * np.linalg.norm(direction):
            raise ValueError(
                f"node {node} of {self.label} is held along {direction} already, or that is zero"
            )
        known = np.vstack([before, rest / np.linalg.norm(rest)])
        # the others are any that are perpendicular
        free = np.linalg.svd(known)[2][len(known) :]
        self.supports[node] = np.vstack([known, free])
        held[:3] = np.arange(3) < len(known)

    def edges(self, name: str) -> tuple[Indices, Array]:
        """Nodes of the edges of a named curve, and the length that each carries, both (e, 2 or 3).

        Raises:
            ValueError: There is no such curve; the message lists those that exist.
        """
        edges = self.mesh.curve(name)
        x = self.frames[edges, 0]
        if edges.shape[1] == 2:
            length = np.linalg.norm(x[:, 1] - x[:, 0], axis=1)
            return edges, np.outer(length, [0.5, 0.5])
        # the parabola through three points, by three points of Gauss
        s, w = np.polynomial.legendre.leggauss(3)
        N = np.array([0.5 * s * (s - 1), 0.5 * s * (s + 1), 1 - s * s])
        dN = np.array([s - 0.5, s + 0.5, -2 * s])
        speed = np.linalg.norm(np.einsum("kg,ekj->egj", dN, x), axis=2)
        return edges, np.einsum("g,kg,eg->ek", w, N, speed)

    def areas(self) -> Array:
        """Area that each node of each cell carries, shape (m, k)."""
        shapes, weights = self._measure()
        return np.einsum("gk,mg->mk", shapes, weights)

    def element_inertia(self) -> Array:
        """Constant matrix of (x, d₁, d₂, d₃) of each cell's nodes, shape (m, k, 4, k, 4)."""
        shapes, weights = self._measure()
        blocks = np.zeros((*self.mesh.cells.shape, 4, self.mesh.cells.shape[1], 4))
        mass = np.einsum("gi,gj,mg,mab->miajb", shapes, shapes, weights, self.density)
        for a, row in enumerate((0, 3)):
            for b, column in enumerate((0, 3)):
                blocks[:, :, row, :, column] = mass[:, :, a, :, b]
        return blocks

    def cells_of(self, group: str | None = None) -> Indices:
        """Cells of a named group (default: all).

        Raises:
            ValueError: There is no such group; the message lists those that exist.
        """
        return np.arange(len(self.mesh.cells)) if group is None else self.mesh.group(group)

    def _nodes(self, name: str) -> Indices:
        return self.mesh.nodes(name)

    def _bind(self, node: int, normal: Array) -> None:
        """Turn the frame of a node and hold what leaves the plane."""
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
        held[tilt] = True
        if np.isfinite(self.supports[node, 0, 0]):
            self._hold_along(node, normal)
        else:
            held[4 - tilt] = True

    def _measure(self) -> tuple[Array, Array]:
        """Shape functions (g, k) and weights times area (m, g) at points of integration."""
        element = basix.create_element(
            basix.ElementFamily.P,
            basix.CellType[self.mesh.cell],
            self.mesh.degree,
            basix.LagrangeVariant.gll_warped,
        )
        rule = basix.make_quadrature(basix.CellType[self.mesh.cell], 2 * self.mesh.degree + 2)
        points, w = (np.asarray(part, dtype=np.float64) for part in rule)
        table = np.asarray(element.tabulate(1, points), dtype=np.float64)[..., 0]
        x = self.frames[self.mesh.cells, 0]
        g1, g2 = np.einsum("agk,mkj->amgj", table[1:], x)
        return table[0], w * np.linalg.norm(np.cross(g1, g2), axis=-1)


def _section_per_cell(
    mesh: SurfaceMesh, centres: Array, section: ShellSections
) -> list[ShellSection]:
    if isinstance(section, ShellSection):
        return [section] * len(mesh.cells)
    if not isinstance(section, Mapping):
        return [section(centre) for centre in centres]
    chosen: list[ShellSection | None] = [None] * len(mesh.cells)
    for group, value in section.items():
        for cell in mesh.group(group):
            chosen[cell] = value
    missing = [i for i, value in enumerate(chosen) if value is None]
    if missing:
        raise ValueError(f"{len(missing)} cells have no section, the first is cell {missing[0]}")
    return [value for value in chosen if value is not None]


def _axes(mesh: SurfaceMesh, centres: Array, along: npt.ArrayLike | Director | None) -> Array:
    """See :attr:`Shell.axes`."""
    if along is None:
        x = mesh.points[mesh.cells]
        return np.asarray(x[:, 1] - x[:, 0])
    values = [along(centre) for centre in centres] if callable(along) else [along] * len(centres)
    axes = np.array([vector(value, 3, "along") for value in values])
    normals = mesh.normals.mean(axis=1)
    across = np.linalg.norm(np.cross(normals, axes), axis=1)
    bad = np.flatnonzero(~(across > 1e-6 * np.linalg.norm(normals, axis=1) * 1.0))
    if len(bad):
        raise ValueError(
            f"along must not be normal to the surface; in cell {bad[0]}, at {centres[bad[0]]}, "
            f"it is {axes[bad[0]]}"
        )
    return axes


def _given(mesh: SurfaceMesh, director: Director) -> Array:
    """Directors from the user's function, checked against the cells' normals."""
    found = np.array([vector(director(x), 3, f"director at {x}") for x in mesh.points])
    size = np.linalg.norm(found, axis=1, keepdims=True)
    bad = np.flatnonzero(np.abs(size - 1.0) > 1e-6)
    if len(bad):
        raise ValueError(
            f"a director must be a unit vector; at {mesh.points[bad[0]]} it is {found[bad[0]]}"
        )
    found = found / size
    cosine = np.einsum("mkj,mkj->mk", mesh.normals, found[mesh.cells])
    if cosine.min() < 0.1:
        point = mesh.cells.ravel()[cosine.argmin()]
        raise ValueError(
            f"the director at {mesh.points[point]} is {found[point]}: it must point to the side of "
            "the cells' normals; its cosine with one of them is "
            f"{cosine.min():.2f}. Turn the director or the cells round"
        )
    return np.asarray(found)


def _frames(points: Array, directors: Array) -> Array:
    """Frames with given third directors; e₁ nearest to the axis that is least along them."""
    H = np.empty((len(points), 4, 3))
    H[:, 0], H[:, 3] = points, directors
    axis = np.eye(3)[np.abs(directors).argmin(axis=1)]
    e1 = axis - np.einsum("nj,nj->n", axis, directors)[:, np.newaxis] * directors
    H[:, 1] = e1 / np.linalg.norm(e1, axis=1, keepdims=True)
    H[:, 2] = np.cross(directors, H[:, 1])
    return H
