"""Contact surfaces that consist of patches: faces of solids, of shells without shear, of polyhedra.

A surface of patches with a radius occupies all points within the radius of the patches, with round
edges. As first side of a contact it is its Gauss points, balls with the radius and with areas as
integration weights; as second side it is the patches. Each ball is repelled by the closest point on
the patches.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.sparse import coo_array, csr_array, vstack
from scipy.sparse.csgraph import dijkstra

from fem_lie._arrays import Array, Indices, instance, positive, whole
from fem_lie.bodies.body import Body, Point
from fem_lie.contact.convex.polyhedron import hull_of
from fem_lie.contact.sides.patches import (
    NET,
    ROWS,
    Patches,
    edge_ends,
    linear,
    set_nets,
    set_shapes,
)
from fem_lie.contact.sides.surfaces import (
    MOST_NODES,
    ContactSurface,
    PolyhedralSurface,
    Polyhedron,
    initial_frame,
)
from fem_lie.contact.sides.table import UNUSED, Nodes, Samples, empty_side, number_of
from fem_lie.mesh.shapes import rule

_SOURCES = 256
"""Number of sources whose shortest paths are computed together."""

_SAME = 1e-9
"""Distance relative to the size of a body within which corners coincide."""


class PatchSurface(ContactSurface):
    """Patches with a radius.

    Attributes:
        gauss: Number of integration points along each axis of a patch; on triangles, points of the
            same order.
    """

    gauss: int

    @abstractmethod
    def patches(self, nodes: Nodes) -> Patches:
        """All patches in the initial configuration.

        Args:
            nodes: Gives the numbers of the nodes of a body in the scene.
        """

    @property
    def sheet(self) -> bool:
        """Whether the patches are the middle of a sheet with directors as third axes of frames."""
        return False

    def samples(self, patches: Patches) -> Samples:
        """Gauss points of the patches, with half of the thickness as radius, and their areas.

        Args:
            patches: Patches of the surface.
        """
        triangle = bool((patches.corners[:, 3] < 0).all())
        cell, k = ("triangle", 3) if triangle else ("quadrilateral", 4)
        at, parts = rule(cell, 2 * self.gauss - (2 if triangle else 1))
        m, g = len(patches.nodes), len(at)
        found, areas, W = empty_side(m * g), np.empty((m, g)), np.zeros((ROWS, NET))
        fixed = np.zeros((m * g, MOST_NODES))
        for q in range(g):
            u, v = (float(x) for x in at[q])
            set_shapes(triangle, patches.straight, u, v, W)
            found.weights[q::g] = W[0, :MOST_NODES]
            fixed[q::g, :k] = [linear(triangle, corner, u, v) for corner in range(k)]
            tangents = W[0, MOST_NODES:].reshape(MOST_NODES, 2, 1) * patches.tangents
            found.arms[q::g] = tangents.sum(axis=2)
            across = np.cross(W[1] @ patches.nets, W[2] @ patches.nets)
            areas[:, q] = parts[q] * np.linalg.norm(across, axis=1)
        found.nodes[:, :k] = np.repeat(patches.nodes[:, :k], g, axis=0)
        found.radii[:] = np.repeat(patches.radii, g)
        found.owners[:] = found.nodes[:, 0]
        found.normals[:, 2] = self.sheet
        material = found._replace(weights=fixed, arms=0.0 * found.arms)
        return Samples(found, material, areas.ravel())

    def neighbours(self, patches: Patches) -> Indices:
        """Pairs of patches that are too close along the sheet to touch by folding, shape (m, 2).

        Args:
            patches: Patches of the surface.
        """
        k = 3 if (patches.corners[:, 3] < 0).all() else 4
        corners, m = patches.corners[:, :k], len(patches.corners)
        x = np.zeros((1 + corners.max(), 3))
        x[corners] = patches.nets[:, :k]
        near = _within(x, corners, 2.0 * np.pi * float(patches.radii.max()))
        ones, n = np.ones(corners.size), len(x)
        at = coo_array((ones, (corners.ravel(), np.repeat(np.arange(m), k))), (n, m))
        both = (at.T @ near @ at).tocoo()
        return np.stack([both.row, both.col], axis=1).astype(np.int64)


@dataclass(frozen=True, eq=False)
class Facets(PatchSurface):
    """Contact surface of the faces of a body: of a solid, a thin shell or an ANCF shell.

    The surface is a layer about the faces: all points within half its thickness of the bilinear
    patches between nodal positions. The surface of a solid is therefore outside of its mesh by half
    the thickness, and another body must not penetrate by more than that. Contact forces are per
    area of the undeformed faces. They act on nodal positions only; friction needs a second surface
    on ground or on nodes with frames, which has its moments.

    Attributes:
        body: A body with faces.
        thickness: Thickness of the layer; default: that of the sections of a shell.
        gauss: Number of integration points along each axis of a patch; on triangles, points of the
            same order.

    Example:
        >>> rubber = fl.sections.NeoHooke(1e6, 0.45, 1100.0)
        >>> block = fl.Solid.brick((1, 1, 1), rubber, cells=(1, 1, 1))
        >>> surface = fl.contact.Facets(block, thickness=0.02)
        >>> surface.label
        'Facets on Solid'
    """

    body: Body
    thickness: float | None = None
    gauss: int = 2

    def __post_init__(self) -> None:
        """Raise ``TypeError`` or ``ValueError`` if an argument has a wrong type or value."""
        instance(self.body, Body, "Facets: body", "a Solid, ThinShell or AncfShell")
        whole(self.gauss, "Facets: gauss")
        if not len(self.body.model.faces):
            raise ValueError(f"Facets: body must have faces, got {self.body.label}, which has none")
        if self.thickness is not None:
            positive(self.thickness, "Facets: thickness")
        elif not (self._thickness > 0.0).all():
            raise ValueError(
                f"Facets: thickness: give the thickness of the layer, for the faces of "
                f"{self.body.label} have none"
            )

    @property
    def _thickness(self) -> Array:
        given = self.body.model.thickness if self.thickness is None else self.thickness
        return np.broadcast_to(np.asarray(given, dtype=np.float64), len(self.body.model.faces))

    @property
    def points(self) -> Sequence[Point]:
        """All nodes at corners of faces."""
        return [Point(self.body, int(node)) for node in np.unique(self.body.model.faces)]

    @property
    def rotation_invariant(self) -> bool:
        """True: forces act on nodal positions only."""
        return True

    def patches(self, nodes: Nodes) -> Patches:
        """Bilinear patches between nodal positions.

        Args:
            nodes: Gives the numbers of the nodes of a body in the scene.
        """
        faces = self.body.model.faces
        cells = faces[:, [0, 1, 3, 2]] if faces.shape[1] == 4 else faces
        places = np.round(self.body.frames[:, 0] / (_SAME * self.body.model.size))
        _, corners = np.unique(places, axis=0, return_inverse=True)
        own = nodes(self.body)[cells]
        found = patches_of(own, corners.ravel()[cells], 0.5 * self._thickness, straight=True)
        set_nets(_frames(self.body, nodes), found)
        return found


def _frames(body: Body, nodes: Nodes) -> Array:
    """Initial frames of a body at the numbers of its nodes."""
    numbers = nodes(body)
    H = np.zeros((1 + int(numbers.max()), 4, 3))
    H[numbers] = body.frames
    return H


def patches_of(own: Indices, places: Indices, radii: Array, *, straight: bool) -> Patches:
    """Patches between nodes, without tangents yet.

    Args:
        own: Nodes of the corners, shape (m, 3 or 4).
        places: Numbers of the corners, equal for equal positions, shape (m, 3 or 4).
        radii: Half of the thickness, shape (m,).
        straight: Whether the patches are bilinear.
    """
    m, k = own.shape
    corners, numbers = np.full((m, MOST_NODES), -1), np.full((m, MOST_NODES), UNUSED)
    corners[:, :k], numbers[:, :k] = places, own
    return Patches(
        numbers,
        np.tile(np.arange(MOST_NODES), (m, 1)),
        np.zeros((m, MOST_NODES, 3)),
        np.zeros((m, MOST_NODES, 2, 3)),
        radii,
        corners,
        *_counts(corners, k == 3),
        np.zeros((m, NET, 3)),
        straight,
    )


def polyhedral_patches(surface: PolyhedralSurface, nodes: Nodes, *, straight: bool) -> Patches:
    """Triangles of the faces of a polyhedron, as patches with zero radius on its frame.

    Args:
        surface: The polyhedron.
        nodes: Gives the numbers of the nodes of a body in the scene.
        straight: Whether patches have no tangents; else these are along the edges.
    """
    polyhedron = surface.polyhedron()
    hull, node = hull_of(polyhedron.corners), number_of(*polyhedron.owner, nodes)
    cells = np.array([(loop[0], *pair) for loop in hull.loops for pair in pairwise(loop[1:])])
    m = len(cells)
    found = patches_of(np.full((m, 3), node), cells, np.zeros(m), straight=straight)
    found.slots[:] = 0
    x = hull.corners[cells]
    found.offsets[:, :3] = x
    for i in range(0 if straight else 3):
        for a in range(2):
            found.tangents[:, i, a] = x[:, (i + 1 + a) % 3] - x[:, i]
    H = np.zeros((max(node, 0) + 1, 4, 3))
    H[node if node >= 0 else 0] = initial_frame(*polyhedron.owner)
    set_nets(H, found)
    return found


def corner_areas(polyhedron: Polyhedron) -> Array:
    """Area of a face that belongs to each corner of a polyhedron: mean over its faces, (n,)."""
    hull = hull_of(polyhedron.corners)
    total, count = np.zeros(len(hull.corners)), np.zeros(len(hull.corners))
    for loop in hull.loops:
        X = hull.corners[loop]
        across = np.cross(X[1:-1] - X[0], X[2:] - X[0]).sum(axis=0)
        total[loop] += 0.5 * np.linalg.norm(across) / len(loop)
        count[loop] += 1.0
    return np.asarray(total / count)


def joined_patches(a: Patches, b: Patches) -> Patches:
    """Patches of two surfaces, of the same interpolation, as one."""
    corners = np.where(b.corners < 0, b.corners, b.corners + 1 + a.corners.max())
    parts = zip(a[:-1], b._replace(corners=corners)[:-1], strict=True)
    return Patches._make([*(np.concatenate(each) for each in parts), a.straight])


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
