"""Surfaces of bodies in given frames: swept sections, sheets of a thickness, boxes."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie.bodies.catalogue import BodyInfo, SceneInfo

# Slender members would vanish: nothing is drawn thinner than this part of the scene.
_THINNEST = 0.004
_STEP_ANGLE = np.radians(4.0)
_MOST_STEPS = 16
_CIRCLE = np.column_stack([f(2.0 * np.pi * np.arange(16) / 16) for f in (np.cos, np.sin)])
_CORNERS = np.array([[i, j, k] for i in (-0.5, 0.5) for j in (-0.5, 0.5) for k in (-0.5, 0.5)])
_FACES = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))


@dataclass(frozen=True, eq=False)
class Shape:
    """A surface that moves with its body.

    Attributes:
        faces: Polygons as VTK has them: number of corners, then the corners, again and again.
        body: What it belongs to.
        outline: Outline of each cell's section, enlarged if it is too thin to be seen, (m, k, 2).
        box: Edges of a rigid body's box, shape (3,).
        steps: Pieces in which a cell is drawn.
        sheet: Thickness of a shell at each of its nodes, enlarged likewise, shape (n,).
        skin: Whether the faces are those of a solid, without a thickness.
    """

    faces: Indices
    body: BodyInfo
    outline: Array
    box: Array
    steps: int
    sheet: Array = field(default_factory=lambda: np.empty(0))
    skin: bool = False

    def points(self, frames: Array) -> Array:
        """Corners of the polygons for the frames of all nodes, shape (N, 4, 3)."""
        if self.skin:
            return np.asarray(frames[self.body.nodes, 0])
        if len(self.body.faces):
            middle = frames[self.body.nodes]
            half = 0.5 * self.sheet[:, np.newaxis] * middle[:, 3]
            return np.concatenate([middle[:, 0] - half, middle[:, 0] + half])
        if not len(self.body.cells):
            centres = frames[self.body.nodes]
            corners = np.einsum("ck,nkj->ncj", _CORNERS * self.box, centres[:, 1:])
            return np.asarray(centres[:, :1] + corners).reshape(-1, 3)
        rings = _refined(frames, self.body.cells, self.steps)
        section = np.einsum("mpk,mskj->mspj", self.outline, rings[:, :, 2:])
        return np.asarray(rings[:, :, :1] + section).reshape(-1, 3)


def scene_size(frames: Array) -> float:
    """Diagonal of the box that holds all nodes at all times, (..., N, 4, 3); 1 if it is a point."""
    x = frames[..., 0, :].reshape(-1, 3)
    return float(np.linalg.norm(x.max(axis=0) - x.min(axis=0))) or 1.0


def shapes(info: SceneInfo, frames: Array) -> list[Shape]:
    """Surfaces of all bodies, fine enough for all the frames, shape (K, N, 4, 3)."""
    size = scene_size(frames)
    return [_shape(body, frames, size) for body in info.bodies]


def joint_places(info: SceneInfo, frames: Array) -> Array:
    """Places of the joints that move, for frames (N, 4, 3); shape (j, 3)."""
    places = [
        frames[joint.node, 0] + joint.offset @ frames[joint.node, 1:]
        for joint in info.joints
        if joint.node >= 0
    ]
    return np.array(places).reshape(-1, 3)


def _sheet(body: BodyInfo, size: float) -> Shape:
    """Both faces of a shell, and its rim."""
    number = np.full(body.nodes.max() + 1, -1)
    number[body.nodes] = np.arange(len(body.nodes))
    top, count = number[body.faces] + len(body.nodes), len(body.nodes)
    directed = np.stack([top, np.roll(top, -1, axis=1)], axis=2).reshape(-1, 2)
    _, first, uses = np.unique(
        np.sort(directed, axis=1), axis=0, return_index=True, return_counts=True
    )
    a, b = directed[first[uses == 1]].T
    rim = np.column_stack([a, a - count, b - count, b])
    faces = [_polygons(top), _polygons(top[:, ::-1] - count), _polygons(rim)]
    corners = (top - count).ravel()
    total = np.bincount(corners, np.repeat(body.thickness, top.shape[1]), count)
    sheet = total / np.maximum(1, np.bincount(corners, minlength=count))
    return Shape(
        np.concatenate(faces),
        body,
        np.empty((0, 0, 2)),
        np.zeros(3),
        1,
        np.maximum(sheet, _THINNEST * size),
    )


def _skin(body: BodyInfo) -> Shape:
    """The outside of a solid."""
    number = np.full(body.nodes.max() + 1, -1)
    number[body.nodes] = np.arange(len(body.nodes))
    faces = _polygons(number[body.faces])
    return Shape(faces, body, np.empty((0, 0, 2)), np.zeros(3), 1, skin=True)


def _shape(body: BodyInfo, frames: Array, size: float) -> Shape:
    if len(body.faces) and not body.thickness.any():
        return _skin(body)
    if len(body.faces):
        return _sheet(body, size)
    box: Array = np.full(3, 4.0 * _THINNEST * size)
    if body.box is not None:
        box = np.maximum(body.box, 2.0 * _THINNEST * size)
    if not len(body.cells):
        boxes = [8 * i + np.array(face) for i in range(len(body.nodes)) for face in _FACES]
        return Shape(_polygons(np.array(boxes)), body, np.empty((0, 0, 2)), box, 1)
    outline = _outlines(body, _THINNEST * size)
    ends = frames[:, body.cells]
    turn = np.linalg.norm(lie.se3_relative(ends[:, :, 0], ends[:, :, 1])[..., 3:], axis=-1).max()
    steps = int(np.clip(np.ceil(turn / _STEP_ANGLE), 1, _MOST_STEPS))
    return Shape(_tube_faces(body.cells, steps, outline), body, outline, box, steps)


def _outlines(body: BodyInfo, thinnest: float) -> Array:
    """Outline of each cell, shape (m, k, 2); a circle where there is none."""
    given = np.full((1, 2), np.nan) if body.outline is None else body.outline
    none = np.asarray(np.isnan(given).any(axis=(-2, -1)))
    corners = max(given.shape[-2], len(_CIRCLE) if none.any() else 0)
    outlines = np.empty((len(body.cells), corners, 2))
    circle = thinnest * _padded(_CIRCLE, corners)[:corners]
    outlines[:] = np.where(none[..., np.newaxis, np.newaxis], circle, _padded(given, corners))
    radius = np.linalg.norm(outlines, axis=-1).max(axis=1)
    return outlines * np.maximum(1.0, thinnest / radius)[:, np.newaxis, np.newaxis]


def _padded(outline: Array, corners: int) -> Array:
    """The last corner again and again, until there are so many."""
    again = np.repeat(outline[..., -1:, :], max(0, corners - outline.shape[-2]), axis=-2)
    return np.concatenate([outline, again], axis=-2)


def _refined(frames: Array, cells: Indices, steps: int) -> Array:
    """Frames along each cell on the geodesic between its ends, shape (m, steps + 1, 4, 3)."""
    a, b = frames[cells[:, 0]], frames[cells[:, 1]]
    s = np.linspace(0.0, 1.0, steps + 1)
    d = lie.se3_relative(a, b)
    return lie.se3_retract(a[:, np.newaxis], s[:, np.newaxis] * d[:, np.newaxis])


def _tube_faces(cells: Indices, steps: int, outlines: Array) -> Indices:
    """Sides of all cells, and caps where a line ends or its outline changes."""
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
    """VTK's list of polygons with equally many corners, from shape (f, c)."""
    return np.insert(corners, 0, corners.shape[1], axis=1).ravel()
