"""Contact surface of a shell, which touches other shells, itself, balls and planes.

A shell occupies all points within half its thickness of the middle surface, with round edges. The
middle surface is interpolated by smooth patches, with the tangents of the nodal frames. The first
side of a contact consists of the Gauss points of each patch as balls, with their integration
weights (areas); the second side consists of patches. Each ball is repelled by the closest point on
the patches.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csr_array, vstack
from scipy.sparse.csgraph import dijkstra

from fem_lie._arrays import Array, Indices, flag, instance, positive, whole
from fem_lie.bodies.body import Body, Point
from fem_lie.bodies.shells.shell import Shell
from fem_lie.contact.sides.patches import (
    NET,
    ROWS,
    Patches,
    edge_ends,
    linear,
    set_nets,
    set_shapes,
)
from fem_lie.contact.sides.surfaces import MOST_NODES, ContactSurface
from fem_lie.contact.sides.table import UNUSED, Nodes, Side, empty_side
from fem_lie.mesh.shapes import rule

_PARTS = {
    ("triangle", 3): [[0, 1, 2]],
    ("quadrilateral", 4): [[0, 1, 2, 3]],
    ("triangle", 6): [[0, 5, 4], [5, 1, 3], [4, 3, 2], [5, 3, 4]],
    ("quadrilateral", 9): [[0, 4, 5, 8], [4, 1, 8, 6], [5, 8, 2, 7], [8, 6, 7, 3]],
}
"""Corner nodes of the patches of a cell, by cell shape and number of nodes."""

_SOURCES = 256
"""Number of sources whose shortest paths are computed together."""


@dataclass(frozen=True, eq=False)
class ShellSurface(ContactSurface):
    """Contact surface of a shell: both faces and the round edges.

    Contact forces are per area of the undeformed middle surface. They are integrated over the first
    of two shell surfaces, which should have the finer mesh. A surface that is given twice touches
    itself.

    A smooth surface has tangents that rotate with nodal frames, so its shell needs drilling
    rotations. A surface that is not smooth has bilinear patches between nodal positions, with kinks
    across edges. Its shell needs no drilling rotations unless the contact has friction, and
    conserving schemes support it.

    Attributes:
        shell: A shell of quadrilaterals or triangles.
        thickness: Thickness; default: that of its sections.
        gauss: Number of integration points along each axis of a patch; on triangles, points of the
            same order.
        smooth: Whether patches have tangents.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> mesh = fl.mesh.parametric_surface(lambda a, b: np.array([a, b, 0.0]), (2, 2))
        >>> sheet = fl.Shell(mesh, fl.ShellSection.layer(0.01, steel))
        >>> surface = fl.contact.ShellSurface(sheet)
        >>> scene = fl.Scene()
        >>> _ = scene.add(sheet)
        >>> _ = scene.add(fl.contact.Contact(surface, surface, fl.contact.Penalty(1e9)))
        >>> scene.drills(sheet)
        True
    """

    shell: Shell
    thickness: float | None = None
    gauss: int = 2
    smooth: bool = True

    def __post_init__(self) -> None:
        """Raise ``TypeError`` or ``ValueError`` if an argument has a wrong type or value."""
        instance(self.shell, Shell, "ShellSurface: shell", "a Shell")
        if self.thickness is not None:
            positive(self.thickness, "ShellSurface: thickness")
        whole(self.gauss, "ShellSurface: gauss")
        flag(self.smooth, "ShellSurface: smooth")

    @property
    def points(self) -> Sequence[Point]:
        """All nodes of the shell."""
        return [Point(self.shell, node) for node in range(len(self.shell.frames))]

    def rotating(self, friction: bool) -> Sequence[Body]:
        """The shell, if contact forces have moments that need drilling rotations.

        Args:
            friction: Coefficient of friction.
        """
        return [self.shell] if self.smooth or friction else []

    def contents(self, nodes: Nodes) -> list[Array | Indices]:
        """All that the contact forces depend on.

        Args:
            nodes: Gives the numbers of the nodes of a body in the scene.
        """
        patches = self.patches(nodes)
        _, _, areas = self.positions(patches)
        return [patches.nodes, patches.tangents, patches.radii, patches.corners, areas]

    def _parts(self, cells: Indices) -> Indices:
        """Corner nodes of all patches, shape (m, 3 or 4)."""
        parts = np.array(_PARTS[self.shell.mesh.cell, cells.shape[1]])
        return np.ascontiguousarray(cells[:, parts].reshape(-1, parts.shape[1]))

    @property
    def radii(self) -> Array:
        """Half of the thickness of each patch, shape (m,)."""
        cells = self.shell.connectivity
        parts = len(_PARTS[self.shell.mesh.cell, cells.shape[1]])
        thickness = self.shell.thickness if self.thickness is None else self.thickness
        return 0.5 * np.repeat(np.broadcast_to(thickness, len(cells)), parts)

    def patches(self, nodes: Nodes) -> Patches:
        """All patches in the initial configuration.

        Args:
            nodes: Gives the numbers of the nodes of a body in the scene.
        """
        own = self._parts(self.shell.connectivity)
        m, k = own.shape
        corners, numbers = np.full((m, MOST_NODES), -1), np.full((m, MOST_NODES), UNUSED)
        corners[:, :k], numbers[:, :k] = self._parts(self.shell.mesh.cells), own
        at_corners, at_edges = _counts(corners, k == 3)
        found = Patches(
            numbers,
            np.zeros((m, MOST_NODES, 2, 3)),
            self.radii,
            corners,
            at_corners,
            at_edges,
            np.zeros((m, NET, 3)),
            not self.smooth,
        )
        if self.smooth:
            found.tangents[:, :k] = _tangents(self.shell.frames, own)
        set_nets(self.shell.frames, found)
        known = nodes(self.shell)
        return found._replace(nodes=np.where(numbers < 0, numbers, known[numbers]))

    def positions(self, patches: Patches) -> tuple[Side, Side, Array]:
        """Gauss points as balls, material points that friction acts on, and areas of the points.

        Args:
            patches: Patches of the surface.
        """
        triangle = self.shell.mesh.cell == "triangle"
        at, parts = rule(self.shell.mesh.cell, 2 * self.gauss - (2 if triangle else 1))
        m, g = len(patches.nodes), len(at)
        found, areas, W = empty_side(m * g), np.empty((m, g)), np.zeros((ROWS, NET))
        fixed = np.zeros((m * g, MOST_NODES))
        for q in range(g):
            set_shapes(triangle, patches.straight, float(at[q, 0]), float(at[q, 1]), W)
            found.weights[q::g] = W[0, :MOST_NODES]
            for k in range(3 if triangle else 4):
                fixed[q::g, k] = linear(triangle, k, float(at[q, 0]), float(at[q, 1]))
            tangents = W[0, MOST_NODES:].reshape(MOST_NODES, 2, 1) * patches.tangents
            found.arms[q::g] = tangents.sum(axis=2)
            across = np.cross(W[1] @ patches.nets, W[2] @ patches.nets)
            areas[:, q] = parts[q] * np.linalg.norm(across, axis=1)
        used = patches.nodes[:, :3] if triangle else patches.nodes
        found.nodes[:, : used.shape[1]] = np.repeat(used, g, axis=0)
        found.radii[:] = np.repeat(patches.radii, g)
        found.owners[:] = found.nodes[:, 0]
        return found, found._replace(weights=fixed, arms=0.0 * found.arms), areas.ravel()

    def neighbours(self, patches: Patches) -> Indices:
        """Pairs of patches that are too close along the sheet to touch by folding, shape (m, 2).

        Args:
            patches: Patches of the surface.
        """
        triangle = self.shell.mesh.cell == "triangle"
        corners = patches.corners[:, : 3 if triangle else 4]
        m, n = len(corners), len(self.shell.mesh.points)
        reach = 2.0 * np.pi * float(patches.radii.max())
        near = _within(self.shell.mesh.points, corners, reach)
        ones = np.ones(corners.size)
        at = coo_array((ones, (corners.ravel(), np.repeat(np.arange(m), corners.shape[1]))), (n, m))
        both = (at.T @ near @ at).tocoo()
        return np.stack([both.row, both.col], axis=1).astype(np.int64)


def _tangents(frames: Array, cells: Indices) -> Array:
    """Tangents at corners in their frames, of the length of arcs, shape (m, 3 or 4, 2, 3)."""
    k = cells.shape[1]
    found = np.empty((len(cells), k, 2, 3))
    for i in range(k):
        H = frames[cells[:, i]]
        for a in range(2):
            if k == 3:
                other, sign = (i + 1 + a) % 3, 1.0
            else:
                other, sign = i ^ (1 + a), -1.0 if i & (1 + a) else 1.0
            chord = frames[cells[:, other], 0] - H[:, 0]
            local = np.einsum("mij,mj->mi", H[:, 1:], chord)
            length, off = np.linalg.norm(chord, axis=1), local[:, 2].copy()
            angle = np.arcsin(np.clip(np.abs(off) / length, 0.0, 1.0))
            local[:, 2] = 0.0
            arc = length / np.sinc(angle / np.pi)
            found[:, i, a] = sign * local * (arc / np.linalg.norm(local, axis=1))[:, np.newaxis]
    return found


def _counts(corners: Indices, triangle: bool) -> tuple[Indices, Indices]:
    """Number of patches that share each corner and each edge, both shape (m, 4)."""
    m, sides = len(corners), 3 if triangle else 4
    often = np.bincount(corners[corners >= 0])
    at_corners = np.where(corners >= 0, often[np.maximum(corners, 0)], 0)
    ends = np.array([edge_ends(triangle, e) for e in range(sides)])
    edges = np.sort(corners[:, ends].reshape(-1, 2), axis=1)
    _, which, often = np.unique(edges, axis=0, return_inverse=True, return_counts=True)
    at_edges = np.zeros((m, MOST_NODES), dtype=np.int64)
    at_edges[:, :sides] = often[which.ravel()].reshape(m, sides)
    return at_corners.astype(np.int64), at_edges


def _within(x: Array, cells: Indices, reach: float) -> csr_array:
    """Pairs of nodes that are closer than ``reach`` along edges and diagonals, shape (n, n)."""
    n, k = len(x), cells.shape[1]
    pairs = np.concatenate([cells[:, [i, j]] for i in range(k) for j in range(i)])
    pairs = np.unique(np.sort(pairs, axis=1), axis=0)
    lengths = np.linalg.norm(x[pairs[:, 0]] - x[pairs[:, 1]], axis=1)
    graph = coo_array((lengths, pairs.T), (n, n)).tocsr()
    found = []
    for first in range(0, n, _SOURCES):
        sources = np.arange(first, min(first + _SOURCES, n))
        ways = dijkstra(graph, directed=False, indices=sources, limit=reach)
        found.append(csr_array(np.isfinite(ways), dtype=np.float64))
    return vstack(found, format="csr")
