"""Refinement of meshes: of marked cells, or to given target sizes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import sqrt
from typing import NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from fem_lie import _compat, lie
from fem_lie._arrays import Array, Indices, indices_of, instance, vectors_at
from fem_lie.adaptivity.estimates.estimate import Estimated
from fem_lie.adaptivity.quadrilaterals import cut_quadrilaterals
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.gradients.ancf_beam import AncfBeam
from fem_lie.bodies.gradients.ancf_shell import AncfShell
from fem_lie.bodies.rods.cable_body import CableBody
from fem_lie.bodies.solids.solid import Solid
from fem_lie.bodies.thin_shells.thin_shell import ThinShell
from fem_lie.mesh.bicubic.spline_mesh import SplineMesh
from fem_lie.mesh.lines import LineMesh
from fem_lie.mesh.shapes import cell_normals
from fem_lie.mesh.surfaces import SurfaceMesh

Refinable = TypeVar("Refinable", LineMesh, SurfaceMesh, SplineMesh)
Onto = Callable[[Array], npt.ArrayLike]
"""Projects a point (3,) near the exact line or surface onto it."""

_SAME_PLACE = 1e-9  # relative to the length of the shortest edge


def refine(mesh: Refinable, cells: npt.ArrayLike, *, onto: Onto | None = None) -> Refinable:
    """Refine cells, and neighbours of surface cells as needed to avoid hanging nodes.

    Lines are cut at the midpoint of the arc between the tangents at both ends. Triangles are cut by
    DOLFINx, by the algorithm of A. Plaza & G. F. Carey, Appl. Numer. Math. 32 (2000) 195: each
    marked one into four, with the fewest neighbours. Quadrilaterals are cut into nine, and their
    neighbours by patterns, see :mod:`fem_lie.adaptivity.quadrilaterals`. Cells of spline meshes are
    cut into four, and neighbours that would differ by two levels, too; the surface does not change.
    Points keep their numbers and new ones follow; groups, curves and named points are kept and
    refined with the cells.

    Args:
        mesh: Lines, triangles or quadrilaterals of first degree, or smooth patches.
        cells: Numbers of the cells to be cut.
        onto: Projects new points onto the exact line or surface; default: midpoints of arcs and
            edges.

    Raises:
        ValueError: There is no such cell, the mesh is a surface of second degree, or ``onto`` is
            given for smooth patches.
    """
    check_refinable(mesh, onto)
    marked = np.unique(indices_of(np.atleast_1d(cells), len(mesh.cells), "cells"))
    if isinstance(mesh, SplineMesh):
        return mesh.cut(marked)
    if isinstance(mesh, LineMesh):
        return _refined_lines(mesh, marked, onto)
    if not len(marked):
        return mesh
    refined = _refined_triangles if mesh.cell == "triangle" else _refined_quadrilaterals
    return refined(mesh, marked, onto)


def check_refinable(mesh: object, onto: object) -> None:
    """Check that :func:`refine` supports a mesh and a projection; nothing is refined.

    Raises:
        ValueError: The mesh is a surface of second degree, or ``onto`` is given for smooth patches.
        TypeError: An argument has another type.
    """
    instance(mesh, LineMesh | SurfaceMesh | SplineMesh, "mesh", "a Line-, Surface- or SplineMesh")
    instance(onto, Callable | None, "onto", "a function of a position, or None")
    if isinstance(mesh, SplineMesh) and onto is not None:
        raise ValueError("onto: a SplineMesh is refined on its own surface: omit onto")
    if isinstance(mesh, SurfaceMesh) and mesh.degree != 1:
        raise ValueError(
            f"expected cells of degree 1 to refine, got {mesh.cell}s of degree {mesh.degree}"
        )


# --- lines ---


def _refined_lines(mesh: LineMesh, marked: Indices, onto: Onto | None) -> LineMesh:
    n, m, new = len(mesh.points), len(mesh.cells), len(marked)
    new_points, tangent = _arc_middles(mesh, marked)
    cells, tangents = np.concatenate([mesh.cells, mesh.cells[marked]]), mesh.tangents
    tangents = np.concatenate([tangents, tangents[marked]])
    behind, middle = m + np.arange(new), n + np.arange(new)
    cells[marked, 1], cells[behind, 0] = middle, middle
    tangents[marked, 1], tangents[behind, 0] = tangent, tangent
    # in the order of the line: the second half of a cell follows the first
    order = np.argsort(np.concatenate([np.arange(m), marked + 0.5]), kind="stable")
    parents = np.concatenate([np.arange(m), marked])[order]
    return LineMesh(
        np.concatenate([mesh.points, _moved(new_points, onto)]),
        cells[order],
        tangents[order],
        _children(mesh.groups, parents),
        dict(mesh.named_points),
    )


def _arc_middles(mesh: LineMesh, marked: Indices) -> tuple[Array, Array]:
    """Positions and tangents at the midpoints of cells, on the geodesic between frames of the ends.

    The second frame is the first one, rotated by the smallest rotation from tangent to tangent: on
    circles the geodesic is the circle.
    """
    a, b = (mesh.points[mesh.cells[marked, i]] for i in (0, 1))
    t, u = mesh.tangents[marked, 0], mesh.tangents[marked, 1]
    axis = np.cross(t, u)
    sine = np.linalg.norm(axis, axis=1, keepdims=True)
    angle = np.arctan2(sine, np.einsum("mj,mj->m", t, u)[:, np.newaxis])
    turn = axis * np.divide(angle, sine, out=np.ones_like(angle), where=sine > 0)
    half = lie.so3_exp(0.5 * turn)
    first = np.concatenate([a[:, np.newaxis], np.broadcast_to(np.eye(3), (len(a), 3, 3))], axis=1)
    second = np.concatenate([b[:, np.newaxis], np.swapaxes(lie.so3_exp(turn), 1, 2)], axis=1)
    middle = lie.se3_retract(first, 0.5 * lie.se3_relative(first, second))
    return middle[:, 0], np.einsum("mij,mj->mi", half, t)


# --- triangles ---


def _refined_triangles(mesh: SurfaceMesh, marked: Indices, onto: Onto | None) -> SurfaceMesh:
    cells, parents, cut = _cut_triangles(mesh, marked)
    middles = mesh.points[cut].mean(axis=1)
    points = np.concatenate([mesh.points, _moved(middles, onto)])
    # normals of the parent, interpolated at midpoints of edges
    weights = _weights(mesh.cells[parents], cells, cut, len(mesh.points))
    normals = _between(weights, mesh.normals[parents])
    before = np.concatenate([mesh.points, middles])
    across = np.einsum("mkj,mkj->mk", cell_normals(before, cells, mesh.cell), normals)
    turned = across[:, 0] < 0
    cells[turned] = cells[turned][:, ::-1]
    normals[turned] = normals[turned][:, ::-1]
    return SurfaceMesh(
        points,
        cells,
        mesh.cell,
        normals,
        _children(mesh.groups, parents),
        {name: _cut_edges(edges, cut, len(mesh.points)) for name, edges in mesh.curves.items()},
        dict(mesh.named_points),
    )


def _cut_triangles(mesh: SurfaceMesh, marked: Indices) -> tuple[Indices, Indices, Indices]:
    """New cells (m, 3), the parent of each (m,), and the edges (e, 2) that are cut.

    New points are numbered after the old ones, in the order of these edges.
    """
    given = _compat.create_surface_mesh(mesh.points, mesh.cells, mesh.cell, 1)
    which = np.argsort(given.topology.original_cell_index)[marked]
    fine, parents = _compat.refined(given, which.astype(np.int32))
    n, x = len(mesh.points), fine.geometry.x
    edges = np.unique(
        np.sort(mesh.cells[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0
    )
    ends = mesh.points[edges]
    known = np.concatenate([mesh.points, ends.mean(axis=1)])
    far, found = cKDTree(known).query(x)
    shortest = float(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).min())
    if far.max() > _SAME_PLACE * shortest:
        raise RuntimeError(
            f"a new point is at a distance of {far.max():g} from the midpoints of all edges"
        )
    cut = np.unique(found[found >= n])
    number = np.concatenate([np.arange(n), np.full(len(edges), -1)])
    number[cut] = n + np.arange(len(cut))
    cells = number[found][_compat.geometry_dofmap(fine)]
    own = given.topology.original_cell_index[parents]
    return cells.astype(np.int64), own.astype(np.int64), edges[cut - n]


def _weights(parents: Indices, cells: Indices, cut: Indices, old: int) -> Array:
    """Weights of the corners of a parent in the normals at the nodes of its parts, (m, 3, 3)."""
    new = cells >= old
    ends = cut[np.where(new, cells - old, 0)]
    ends = np.where(new[..., np.newaxis], ends, cells[..., np.newaxis])
    same = ends[..., np.newaxis] == parents[:, np.newaxis, np.newaxis]
    return np.asarray(same.mean(axis=2))


def _cut_edges(edges: Indices, cut: Indices, old: int) -> Indices:
    """Edges (e, 2); those with a new point are cut in two consecutive edges."""
    pairs = np.concatenate([np.sort(cut, axis=1), np.sort(edges, axis=1)])
    _, kind = np.unique(pairs, axis=0, return_inverse=True)
    middle = np.full(kind.max(initial=-1) + 1, -1)
    middle[kind[: len(cut)]] = old + np.arange(len(cut))
    new = middle[kind[len(cut) :]]
    halves = np.stack([edges[:, 0], new, new, edges[:, 1]], axis=1).reshape(-1, 2, 2)
    whole = new < 0
    halves[whole, 0] = edges[whole]
    kept = np.column_stack([np.ones(len(edges), dtype=np.bool_), ~whole])
    return np.asarray(halves[kept], dtype=np.int64)


# --- quadrilaterals ---


def _refined_quadrilaterals(mesh: SurfaceMesh, marked: Indices, onto: Onto | None) -> SurfaceMesh:
    cut = cut_quadrilaterals(mesh.points, mesh.cells, marked)
    return SurfaceMesh(
        np.concatenate([mesh.points, _moved(cut.positions, onto)]),
        cut.cells,
        mesh.cell,
        _between(cut.weights, mesh.normals[cut.parents]),
        _children(mesh.groups, cut.parents),
        {name: cut.pieces(edges) for name, edges in mesh.curves.items()},
        dict(mesh.named_points),
    )


# --- all ---


def _between(weights: Array, normals: Array) -> Array:
    """Unit normals (m, k, 3) with weights (m, k, k) of those at the corners of parents."""
    found = np.einsum("mki,mij->mkj", weights, normals)
    return np.asarray(found / np.linalg.norm(found, axis=2, keepdims=True))


def _children(groups: Mapping[str, Indices], parents: Indices) -> dict[str, Indices]:
    return {name: np.flatnonzero(np.isin(parents, cells)) for name, cells in groups.items()}


def _moved(points: Array, onto: Onto | None) -> Array:
    if onto is None:
        return points
    return vectors_at(onto, points, 3, "onto")


_MEAN = 0.85  # mean of sizes over target sizes
_FINER, _COARSER = (
    0.125,
    8.0,
)  # bounds of the change of size in one step, beyond which an estimate is unreliable
_LEVELS = 40
_SMALLER = 0.9  # factor of target sizes that change no element
_OF_CUBICS = 2  # order of curvatures
_OF_ANCF = 1  # order of their means


class Sizes(NamedTuple):
    """Target sizes of elements at points.

    Attributes:
        middles: The points, shape (m, 3).
        target: Target sizes, shape (m,).
    """

    middles: Array
    target: Array

    @classmethod
    def of(
        cls, mesh: LineMesh | SurfaceMesh | SplineMesh, squares: Array, allowed: float, order: int
    ) -> Sizes:
        """Sizes for which all elements have equal errors, and the total error is the allowed one.

        With errors of the order p in d dimensions ``η² ~ h^(2p + d)`` for an element. (O. C.
        Zienkiewicz & J. Z. Zhu, IJNME 24 (1987) 337.)

        Args:
            mesh: Mesh on which the error was estimated.
            squares: Squared error of each element, shape (m,).
            allowed: Allowed total error.
            order: p.
        """
        middles, sizes = _middles(mesh)
        d = 1 if isinstance(mesh, LineMesh) else 2
        power = 2 * order + d
        total = float((squares ** (d / power)).sum())
        if total == 0.0:
            return cls(middles, _COARSER * sizes)
        each = (allowed**2 / total) ** (power / (power - d))
        with np.errstate(divide="ignore"):
            change = np.minimum((each / squares) ** (1.0 / power), _COARSER)
        return cls(middles, np.maximum(change, _FINER) * sizes)

    def mesh(
        self,
        coarse: Refinable,
        *,
        ahead: float = 0.0,
        onto: Onto | None = None,
        mean: float = _MEAN,
    ) -> Refinable:
        """Refine a coarse mesh until sizes are on average the target sizes in and around elements.

        Elements are cut in k along each edge, so their sizes are between the largest one and 1/k of
        it.

        Args:
            coarse: The initial mesh.
            ahead: Distance around elements within which target sizes apply.
            onto: Projects new points onto the exact line or surface.
            mean: Geometric mean of the smallest and the largest size, relative to the target size.
        """
        largest = mean * sqrt(_cuts(coarse))
        tree, found = cKDTree(self.middles), coarse
        nearest = min(2, len(self.middles))
        for _ in range(_LEVELS):
            middles, sizes = _middles(found)
            _, closest = tree.query(middles, k=nearest)
            least = self.target[np.reshape(closest, (len(middles), -1))].min(axis=1)
            within = tree.query_ball_point(middles, 0.5 * sizes + ahead)
            least = [
                min(low, self.target[inside].min(initial=np.inf))
                for low, inside in zip(least, within, strict=True)
            ]
            large = np.flatnonzero(sizes > largest * np.array(least))
            if not len(large):
                break
            found = refine(found, large, onto=onto)
        return found

    def other_mesh(
        self,
        coarse: Refinable,
        known: Sequence[Refinable],
        *,
        onto: Onto | None = None,
        mean: float = _MEAN,
    ) -> Refinable:
        """Mesh of these sizes, or of smaller ones if it is known to be too coarse.

        Elements that are slightly too large may remain, since cutting makes them much smaller.

        Args:
            coarse: The initial mesh.
            known: Meshes whose error is too large.
            onto: As for :meth:`mesh`.
            mean: As for :meth:`mesh`.
        """
        sizes = self
        while any(
            same_mesh(made := sizes.mesh(coarse, onto=onto, mean=mean), one) for one in known
        ):
            sizes = sizes._replace(target=_SMALLER * sizes.target)
        return made


def same_mesh(one: Refinable, other: Refinable) -> bool:
    """Whether two meshes that were refined from the same one are equal."""
    shapes = one.cells.shape == other.cells.shape and one.points.shape == other.points.shape
    return shapes and np.array_equal(one.points, other.points)


def _cuts(mesh: LineMesh | SurfaceMesh | SplineMesh) -> int:
    """Number of parts of each edge of a refined element."""
    return 3 if isinstance(mesh, SurfaceMesh) and mesh.cell == "quadrilateral" else 2


def order_of(body: Estimated) -> int:
    """Order of convergence of the error in the energy norm in the size of elements."""
    match body:
        case ThinShell() | CableBody():
            return _OF_CUBICS
        case AncfBeam() | AncfShell():
            return _OF_ANCF
        case Beam():
            return body.model.elements.shape[1] - 1
        case Solid():
            return body.model.degree
    return body.model.mesh.degree


def _middles(mesh: LineMesh | SurfaceMesh | SplineMesh) -> tuple[Array, Array]:
    """Centres of all cells (m, 3) and their sizes, (m,)."""
    if isinstance(mesh, SplineMesh):
        corners = mesh.nodal_vectors[mesh.cells[:, [0, 1, 3, 2]], 0]
    else:
        corners = mesh.points[mesh.cells if isinstance(mesh, LineMesh) else mesh.corners]
    edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    return corners.mean(axis=1), edges.max(axis=1)
