"""Surfaces of bodies in given frames: swept sections, sheets with a thickness, convex hulls."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie.bodies.catalogue import BodyInfo, SceneInfo, box_corners

# least drawn thickness, relative to the size of the scene, so that slender members are visible
_THINNEST = 0.004
_SAME_POINT = 1e-7  # relative to the size of the body
_EDGE_ANGLE = 35.0  # degrees; a circle of sixteen corners is smooth
_STEP_ANGLE = np.radians(4.0)
_MOST_STEPS = 16
_SEEN = 3e-4  # tolerated error of outlines over the size of the scene: a quarter of a pixel
_CIRCLE = np.column_stack([f(2.0 * np.pi * np.arange(16) / 16) for f in (np.cos, np.sin)])


@dataclass(frozen=True, eq=False)
class Shape:
    """A surface that moves with its body: each corner belongs to a ring, which is a frame.

    Rings are the n nodes of the body and, after these, ``steps − 1`` frames for each cell, on the
    geodesic between its nodes.

    Attributes:
        faces: Polygons in VTK's format: number of corners, then the corners, for each polygon.
        body: The body.
        ring: Ring of each corner, shape (p,).
        offset: Offset of the corner from the ring, along its directors, shape (p, 3).
        steps: Number of drawn pieces of a cell.
    """

    faces: Indices
    body: BodyInfo
    ring: Indices
    offset: Array
    steps: int = 1

    def rings(self, frames: Array) -> Array:
        """Frames of the rings, shape (r, 4, 3), from those of all nodes, (N, 4, 3)."""
        nodes = frames[self.body.nodes]
        if self.steps == 1:
            return np.asarray(nodes)
        between = _between(frames, self.body.cells, self.steps).reshape(-1, 4, 3)
        return np.concatenate([nodes, between])

    def points(self, frames: Array) -> Array:
        """Positions of the corners, from the frames of all nodes, shape (N, 4, 3)."""
        at = self.rings(frames)[self.ring]
        return np.asarray(at[:, 0] + np.einsum("pk,pkj->pj", self.offset, at[:, 1:]))

    def values(self, nodal: Array) -> Array:
        """Values at the rings, from those at the body's n nodes, shape (n,)."""
        if self.steps == 1:
            return nodal
        a, b = nodal[_own(self.body, self.body.cells)].T[:, :, np.newaxis]
        between = a + _inside(self.steps) * (b - a)
        return np.concatenate([nodal, between.ravel()])


def scene_size(frames: Array) -> float:
    """Diagonal of the bounding box of all nodes at all times, (..., N, 4, 3); 1 for a point."""
    x = frames[..., 0, :].reshape(-1, 3)
    return float(np.linalg.norm(x.max(axis=0) - x.min(axis=0))) or 1.0


def shapes(info: SceneInfo, frames: Array) -> list[Shape]:
    """Surfaces of all bodies, with a resolution for all of the frames, shape (K, N, 4, 3)."""
    size = scene_size(frames)
    return [_shape(body, frames, size) for body in info.bodies]


def joint_positions(info: SceneInfo, frames: Array) -> Array:
    """Positions of the joints that move, for frames (N, 4, 3); shape (j, 3)."""
    positions = [
        frames[joint.node, 0] + joint.offset @ frames[joint.node, 1:]
        for joint in info.joints
        if joint.node >= 0
    ]
    return np.array(positions).reshape(-1, 3)


def with_sharp_edges(surface: Any) -> Any:
    """A PyVista surface with duplicated points and discontinuous normals at sharp edges."""
    return surface.clean(
        tolerance=_SAME_POINT, absolute=False, polys_to_lines=False, lines_to_points=False
    ).compute_normals(cell_normals=False, split_vertices=True, feature_angle=_EDGE_ANGLE)


def _own(body: BodyInfo, nodes: Indices) -> Indices:
    """Numbers in the body of nodes of the system."""
    number = np.full(body.nodes.max() + 1, -1)
    number[body.nodes] = np.arange(len(body.nodes))
    return np.asarray(number[nodes])


def _sheet(body: BodyInfo, size: float) -> Shape:
    """Both faces of a shell, and its edges."""
    count = len(body.nodes)
    top = _own(body, body.faces) + count
    directed = np.stack([top, np.roll(top, -1, axis=1)], axis=2).reshape(-1, 2)
    directed = directed[directed[:, 0] != directed[:, 1]]  # triangles among quadrilaterals
    _, first, uses = np.unique(
        np.sort(directed, axis=1), axis=0, return_index=True, return_counts=True
    )
    a, b = directed[first[uses == 1]].T
    rim = np.column_stack([a, a - count, b - count, b])
    faces = [_polygons(top), _polygons(top[:, ::-1] - count), _polygons(rim)]
    corners = (top - count).ravel()
    total = np.bincount(corners, np.repeat(body.thickness, top.shape[1]), count)
    thickness = total / np.maximum(1, np.bincount(corners, minlength=count))
    half = 0.5 * np.maximum(thickness, _THINNEST * size)
    offset = np.concatenate([-half, half])[:, np.newaxis] * [0.0, 0.0, 1.0]
    return Shape(np.concatenate(faces), body, np.tile(np.arange(count), 2), offset)


def _boundary(body: BodyInfo) -> Shape:
    """Boundary of a solid."""
    faces = _polygons(_own(body, body.faces))
    return Shape(faces, body, np.arange(len(body.nodes)), np.zeros((len(body.nodes), 3)))


def _hulls(body: BodyInfo, size: float) -> Shape:
    """Convex hull of the corners at each node; a small box without corners."""
    least = 2.0 * _THINNEST * size
    corners = box_corners(np.full(3, 2.0 * least)) if body.corners is None else body.corners
    # the signs of zeros tell the corners of a flat box apart
    missing = np.maximum(0.0, least - np.ptp(corners, axis=0))
    corners = corners + np.copysign(0.5 * missing, corners)
    hull = ConvexHull(corners)
    outward = np.einsum("fi,fi->f", _normals(hull), hull.equations[:, :3]) > 0.0
    faces = np.where(outward[:, np.newaxis], hull.simplices, hull.simplices[:, ::-1])
    count = len(body.nodes)
    each = len(corners) * np.arange(count)[:, np.newaxis, np.newaxis]
    ring = np.repeat(np.arange(count), len(corners))
    return Shape(_polygons((each + faces).reshape(-1, 3)), body, ring, np.tile(corners, (count, 1)))


def _normals(hull: ConvexHull) -> Array:
    """Normals of the faces of a hull by the order of their corners, of any length, shape (f, 3)."""
    a, b, c = np.moveaxis(hull.points[hull.simplices], 1, 0)
    return np.asarray(np.cross(b - a, c - a))


def _tube(body: BodyInfo, frames: Array, size: float) -> Shape:
    """Sections swept along lines."""
    outline = _outlines(body, _THINNEST * size)
    ends = frames[:, body.cells]
    turn = np.linalg.norm(lie.se3_relative(ends[:, :, 0], ends[:, :, 1])[..., 3:], axis=-1).max()
    steps = int(np.clip(np.ceil(turn / _STEP_ANGLE), 1, _MOST_STEPS))
    a, b = _own(body, body.cells).T
    between = len(body.nodes) + np.arange(len(a) * (steps - 1)).reshape(len(a), -1)
    rings = np.column_stack([a, between, b])
    corners = outline.shape[1]
    section = np.broadcast_to(outline[:, np.newaxis], (len(a), steps + 1, corners, 2))
    offset = np.insert(section.reshape(-1, 2), 0, 0.0, axis=1)
    faces = _tube_faces(body.cells, steps, outline)
    return Shape(faces, body, np.repeat(rings.ravel(), corners), offset, steps)


def _shape(body: BodyInfo, frames: Array, size: float) -> Shape:
    if len(body.faces):
        return _sheet(body, size) if body.thickness.any() else _boundary(body)
    return _tube(body, frames, size) if len(body.cells) else _hulls(body, size)


def _outlines(body: BodyInfo, thinnest: float) -> Array:
    """Outline of each cell, shape (m, k, 2); a circle if there is none."""
    given = np.full((1, 2), np.nan) if body.outline is None else body.outline
    given = _coarse(given, _SEEN / _THINNEST * thinnest)
    none = np.asarray(np.isnan(given).any(axis=(-2, -1)))
    corners = max(given.shape[-2], len(_CIRCLE) if none.any() else 0)
    outlines = np.empty((len(body.cells), corners, 2))
    circle = thinnest * _padded(_CIRCLE, corners)[:corners]
    outlines[:] = np.where(none[..., np.newaxis, np.newaxis], circle, _padded(given, corners))
    radius = np.linalg.norm(outlines, axis=-1).max(axis=1)
    return outlines * np.maximum(1.0, thinnest / radius)[:, np.newaxis, np.newaxis]


def _coarse(outlines: Array, seen: float) -> Array:
    """Every other corner of round outlines, (..., k, 2), where the difference is not visible."""
    corners = outlines.shape[-2]
    if corners < 2 * len(_CIRCLE) or corners % 2:
        return outlines
    kept, left_out = outlines[..., ::2, :], outlines[..., 1::2, :]
    middle = 0.5 * (kept + np.roll(kept, -1, axis=-2))
    missed = np.linalg.norm(left_out - middle, axis=-1)
    return kept if np.nanmax(missed, initial=0.0) < seen else outlines


def _padded(outline: Array, corners: int) -> Array:
    """Repeat the last corner up to this number of corners."""
    again = np.repeat(outline[..., -1:, :], max(0, corners - outline.shape[-2]), axis=-2)
    return np.concatenate([outline, again], axis=-2)


def _between(frames: Array, cells: Indices, steps: int) -> Array:
    """Frames within each cell on the geodesic between its ends, shape (m, steps − 1, 4, 3)."""
    a, b = frames[cells[:, 0]], frames[cells[:, 1]]
    d = lie.se3_relative(a, b)[:, np.newaxis]
    return lie.se3_retract(a[:, np.newaxis], _inside(steps)[:, np.newaxis] * d)


def _inside(steps: int) -> Array:
    """Parameters of the interior frames of a cell, shape (steps − 1,)."""
    return np.arange(1, steps) / np.float64(steps)


def _tube_faces(cells: Indices, steps: int, outlines: Array) -> Indices:
    """Lateral faces of all cells, and caps where a line ends or its outline changes."""
    corners = outlines.shape[1]
    ring = np.arange(corners)
    following = np.roll(ring, -1)
    side = np.column_stack([ring, following, following + corners, ring + corners])
    start = corners * np.arange(steps)[:, np.newaxis, np.newaxis]
    cell = corners * (steps + 1) * np.arange(len(cells))[:, np.newaxis, np.newaxis, np.newaxis]
    sides = (side + start + cell).reshape(-1, 4)
    _, kind = np.unique(outlines.reshape(len(cells), -1), axis=0, return_inverse=True)
    low, high = np.full(cells.max() + 1, len(cells)), np.full(cells.max() + 1, -1)
    np.minimum.at(low, cells, kind.reshape(-1, 1))
    np.maximum.at(high, cells, kind.reshape(-1, 1))
    open_ = ((np.bincount(cells.ravel()) == 1) | (low != high))[cells]
    first = cell.ravel()[open_[:, 0], np.newaxis] + ring[::-1]
    last = cell.ravel()[open_[:, 1], np.newaxis] + corners * steps + ring
    return np.concatenate([_polygons(sides), _polygons(np.concatenate([first, last]))])


def _polygons(corners: Indices) -> Indices:
    """VTK's list of polygons with equal numbers of corners, from shape (f, c)."""
    return np.insert(corners, 0, corners.shape[1], axis=1).ravel()
