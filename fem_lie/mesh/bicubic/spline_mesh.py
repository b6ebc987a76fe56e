"""Hierarchical bicubic splines: smooth patches with cells of several sizes.

Bicubics with continuous gradients on a grid are splines with double knots, and nested: a cell can
be divided into four. Functions of a level are active at points where all adjacent cells have this
level or a finer one. They are truncated, so that they vanish with their gradients at all points of
finer levels (C. Giannelli, B. Jüttler & H. Speleers, CAGD 29 (2012) 485). So each function is one
in one vector of one point and zero in all others: a surface is still given by position, gradients
and mixed derivative at its points, with ``4 (points that do not hang)`` functions, as J. Deng et
al., Graphical Models 70 (2008) 76, count them. A hanging node, at the midpoint of an edge of a
larger cell, has the values of that edge (:mod:`fem_lie.elements.thin_shells.nodal_coordinates`).

Adjacent cells differ by at most one level, so that the ends of an edge with a hanging node do not
hang.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from fem_lie._arrays import Array, Flags, Indices, flag, instance, text
from fem_lie._summary import Summarised
from fem_lie.mesh.bicubic import hermite
from fem_lie.mesh.bicubic.patch_coupling import Edge, Joined, PatchCoupling
from fem_lie.mesh.bicubic.patch_coupling import joined as put_together
from fem_lie.mesh.bicubic.smooth_patch import SmoothPatch

_Numbers = TypeVar("_Numbers", Array, Indices)

_EDGES = np.array([[0, 1], [2, 3], [0, 2], [1, 3]])
"""Corners of a cell's edges; the first two are along u."""
_NEW = np.array([[0.5, 0.0], [0.5, 1.0], [0.0, 0.5], [1.0, 0.5], [0.5, 0.5]])
"""New points of a divided cell: the midpoints of its edges, and its centre."""
_QUARTERS = np.array([[0, 4, 6, 8], [4, 1, 8, 7], [6, 8, 2, 5], [8, 7, 5, 3]])
"""Corners of the four quarters, as indices of the cell's corners and new points."""


@dataclass(frozen=True, eq=False, repr=False)
class SplineMesh(Summarised):
    """Cells of several levels on smooth patches: :func:`spline_mesh`, ``fl.adaptivity.refine``.

    Attributes:
        nodal_vectors: Position, ∂u, ∂v and ∂u∂v of each point, hanging ones included, (n, 4, 3).
        cells: Corners of each cell: (0, 0), (1, 0), (0, 1), (1, 1), shape (m, 4).
        sizes: Sizes along u and v, shape (m, 2).
        levels: Level of each cell, shape (m,).
        quarters: Quarter of its parent that each cell is, −1 for cells of level 0, shape (m,).
        parents: Corners of the parent cell, shape (m, 4).
        cuts: Both ends of each divided edge, and its midpoint, shape (c, 3).
        edges: Edges by name.
        named: Corners of the patches by name.
        groups: Cells of each patch by name.

    Example:
        >>> mesh = fl.mesh.spline_mesh(fl.mesh.smooth_patch(lambda a, b: (a, b, 0), (2, 2)))
        >>> finer = fl.adaptivity.refine(mesh, [0])
        >>> len(finer.cells), len(fl.adaptivity.refine(finer, [0]).cells)
        (7, 10)
    """

    nodal_vectors: Array
    cells: Indices
    sizes: Array
    levels: Indices
    quarters: Indices
    parents: Indices
    cuts: Indices
    edges: dict[str, Edge]
    named: dict[str, int]
    groups: dict[str, Indices]

    def middles(self, ends: Indices) -> Indices:
        """Midpoints of edges (…, 2), −1 for edges that are not divided.

        Args:
            ends: Numbers of the two end points, shape (…, 2).
        """
        if not len(self.cuts):
            return np.full(ends.shape[:-1], -1)
        known = _keys(self.cuts[:, :2], len(self.nodal_vectors))
        order = np.argsort(known)
        keys = _keys(ends, len(self.nodal_vectors))
        at = order[np.minimum(np.searchsorted(known, keys, sorter=order), len(order) - 1)]
        return np.where(known[at] == keys, self.cuts[at, 2], -1)

    def hanging(self) -> Indices:
        """Cell on whose edge each point hangs, −1 for regular points, shape (n,)."""
        found = np.full(len(self.nodal_vectors), -1)
        middles = self.middles(self.cells[:, _EDGES])
        cell, edge = np.nonzero(middles >= 0)
        found[middles[cell, edge]] = cell
        return found

    def cut(self, marked: Indices) -> SplineMesh:
        """Divide cells into four, and neighbours that would differ by more than one level.

        Args:
            marked: Numbers of the cells to be cut.
        """
        found = self
        while len(marked):
            found = _cut(found, marked)
            marked = _too_large(found)
        return found

    def surface(self) -> Joined:
        """Points that do not hang, and cells in terms of these."""
        hang = self.hanging() >= 0
        own = np.arange(len(self.cells))
        flags, cells = [], self.cells.copy()
        for step in (1, 2):
            corner = np.where(self.quarters < 0, 0, self.quarters) ^ step
            flags.append((self.quarters >= 0) & hang[self.cells[own, corner]])
            # replaced by the end of the edge
            cells[own, corner] = np.where(flags[-1], self.parents[own, corner], cells[own, corner])
        number = np.cumsum(~hang) - 1
        return Joined(
            self.nodal_vectors[~hang],
            number[cells],
            self.sizes,
            {name: _of_points(edge, hang, number) for name, edge in self.edges.items()},
            {name: int(number[point]) for name, point in self.named.items()},
            self.groups,
            hanging_code(self.quarters, *flags),
        )


def spline_mesh(
    patches: SmoothPatch | Mapping[str, SmoothPatch], *, joined: bool | None = None
) -> SplineMesh:
    """Hierarchical mesh of patches for refinement cell by cell.

    ``fl.adaptivity.refine`` and ``fl.adaptivity.adapt`` refine it.

    The surface does not depend on the refinement: it is exactly that of the patches.

    Args:
        patches: One patch, or several by names, as for a :class:`~fem_lie.ThinShell`.
        joined: Whether coincident edges are joined smoothly; default: if there are several patches.

    Raises:
        ValueError: There is no patch, parametrisations of joined edges do not agree, or a closed
            patch has only two cells around.
        TypeError: An argument has an unexpected type.
    """
    if isinstance(patches, SplineMesh):
        raise TypeError("spline_mesh: patches must be a list of SmoothPatch, got a SplineMesh")
    surface = surface_of(patches, joined, (), "spline_mesh")
    _check_edges(surface.corners, len(surface.nodal_vectors))
    m = len(surface.corners)
    return SplineMesh(
        surface.nodal_vectors,
        surface.corners,
        surface.sizes,
        np.zeros(m, dtype=np.int64),
        np.full(m, -1),
        np.full((m, 4), -1),
        np.empty((0, 3), dtype=np.int64),
        surface.edges,
        surface.named,
        surface.groups,
    )


def _check_edges(cells: Indices, count: int) -> None:
    """Check that two ends define one edge, which is the upper one of at most one cell."""
    for first, second in (_EDGES[:2], _EDGES[2:]):
        for ends in (first, second):
            keys = _keys(cells[:, ends], count)
            if len(np.unique(keys)) < len(keys):
                raise ValueError(
                    "two edges of cells have the same ends: a closed spline mesh needs three "
                    "cells around, or more"
                )


def _keys(ends: Indices, count: int) -> Indices:
    return np.asarray(ends.min(axis=-1) * count + ends.max(axis=-1))


def _too_large(mesh: SplineMesh) -> Indices:
    """Cells with an edge that is divided twice, or with a hanging corner of a smaller quarter."""
    ends = mesh.cells[:, _EDGES]
    middle = mesh.middles(ends)
    segments = np.stack([ends, np.broadcast_to(middle[..., np.newaxis], ends.shape)], axis=-1)
    twice = (middle >= 0) & (mesh.middles(segments) >= 0).any(axis=-1)
    hanging = mesh.hanging()
    quarter = mesh.quarters >= 0
    at_own = hanging[mesh.cells[quarter, mesh.quarters[quarter]]]
    return np.unique(np.concatenate([np.flatnonzero(twice.any(axis=1)), at_own[at_own >= 0]]))


def _cut(mesh: SplineMesh, marked: Indices) -> SplineMesh:
    """Divide the marked cells into four, without their neighbours."""
    points, nodal_vectors, cuts = _with_middles(mesh, marked)
    corners, pieces = mesh.cells[marked], np.tile(np.arange(4), len(marked))
    kept = np.delete(np.arange(len(mesh.cells)), marked)
    parents = np.concatenate([kept, np.repeat(marked, 4)])
    order = np.argsort(parents, kind="stable")
    parents = parents[order]

    def joined(old: _Numbers, new: _Numbers) -> _Numbers:
        return np.concatenate([old[kept], new])[order]

    cells = joined(mesh.cells, points[:, _QUARTERS].reshape(-1, 4))
    return SplineMesh(
        nodal_vectors,
        cells,
        joined(mesh.sizes, np.repeat(0.5 * mesh.sizes[marked], 4, axis=0)),
        joined(mesh.levels, np.repeat(mesh.levels[marked] + 1, 4)),
        joined(mesh.quarters, pieces),
        joined(mesh.parents, np.repeat(corners, 4, axis=0)),
        cuts,
        {name: _of_quarters(edge, cells, parents) for name, edge in mesh.edges.items()},
        mesh.named,
        {name: np.flatnonzero(np.isin(parents, own)) for name, own in mesh.groups.items()},
    )


def _with_middles(mesh: SplineMesh, marked: Indices) -> tuple[Indices, Array, Indices]:
    """Corners and new points of cells (c, 9); coordinates of all points; all divided edges."""
    n, corners = len(mesh.nodal_vectors), mesh.cells[marked]
    ends = corners[:, _EDGES]
    before = mesh.middles(ends).ravel()
    _, first, same = np.unique(_keys(ends, n), return_index=True, return_inverse=True)
    fresh = before[first] < 0
    number = np.where(fresh, n + np.cumsum(fresh) - 1, before[first])
    inner = n + int(fresh.sum()) + np.arange(len(marked))
    points = np.column_stack([corners, number[same].reshape(-1, 4), inner])
    nodal_vectors = np.concatenate(
        [mesh.nodal_vectors, np.empty((int(fresh.sum()) + len(marked), 4, 3))]
    )
    # cells on both sides of an edge give the same values
    nodal_vectors[points[:, 4:]] = _between(mesh.nodal_vectors[corners], mesh.sizes[marked])
    cuts = np.column_stack([ends.reshape(-1, 2)[first[fresh]], number[fresh]])
    return points, nodal_vectors, np.concatenate([mesh.cuts, cuts])


def _between(corners: Array, sizes: Array) -> Array:
    """Coordinates of the new points of cells with corners (c, 4, 4, 3), shape (c, 5, 4, 3)."""
    ones = np.ones(len(sizes))
    scales = np.column_stack([ones, sizes, sizes.prod(axis=1)])[:, np.newaxis, :, np.newaxis]
    orders = [hermite.VALUE, hermite.ALONG, hermite.ACROSS, hermite.TWISTED]
    table = hermite.table(_NEW)[:, orders]
    vectors = (corners * scales).reshape(len(sizes), -1, 3)
    return np.asarray(np.einsum("gka,caj->cgkj", table, vectors) / scales)


def _of_quarters(edge: Edge, cells: Indices, parents: Indices) -> Edge:
    """Edge after division of its cells, with the quarters along it in order."""
    start, step = (edge.side, 2) if edge.along else (2 * edge.side, 1)
    first = np.searchsorted(parents, edge.cells)
    whole = np.searchsorted(parents, edge.cells, "right") - first == 1
    both = np.column_stack([first + np.where(whole, 0, start), first + start + step])
    found = both[np.column_stack([np.ones(len(whole), dtype=np.bool_), ~whole])]
    points = np.append(cells[found[:1], start], cells[found, start + step])
    return Edge(points, edge.along, found, edge.side)


def _of_points(edge: Edge, hang: Flags, number: Indices) -> Edge:
    return edge._replace(points=number[edge.points[~hang[edge.points]]])


def surface_of(
    patches: SmoothPatch | Mapping[str, SmoothPatch] | SplineMesh,
    joined: bool | None,
    couplings: Sequence[PatchCoupling],
    label: str,
) -> Joined:
    """Points and cells of the surface of a body.

    Raises:
        ValueError: There is no patch, patches do not agree, or couplings are given for a spline
            mesh.
        TypeError: ``patches`` has an unexpected type.
    """
    known = "a SmoothPatch, a dict of them by names, or a SplineMesh"
    instance(patches, SmoothPatch | Mapping | SplineMesh, f"{label}: patches", known)
    if joined is not None:
        flag(joined, f"{label}: joined")
    if isinstance(patches, SplineMesh):
        if joined is not None or len(couplings):
            raise ValueError(
                f"{label} is on a SplineMesh, which defines what is joined: omit joined "
                "and couplings"
            )
        return patches.surface()
    given = {"": patches} if isinstance(patches, SmoothPatch) else dict(patches)
    if not given:
        raise ValueError(f"{label} needs at least one patch, got none")
    for key, patch in given.items():
        text(key, f"{label}: the name of a patch")
        instance(patch, SmoothPatch, f"{label}: patch {key!r}", "a SmoothPatch")
    one = len(given) > 1 if joined is None else joined
    return put_together(given, one=one, label=label, couplings=couplings)


def hanging_code(quarter: Indices, along: Flags, across: Flags) -> Array:
    """Code in the last of a cell's sizes: its quarter, and which corners next to its own hang."""
    return np.where(along | across, quarter + 4 * along + 8 * across, 0).astype(np.float64)
