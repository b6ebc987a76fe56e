"""Content of a page as its script draws it: bodies, joints, paths and axes."""

from __future__ import annotations

import base64
import json
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.pictures.bodies import BALL
from fem_lie.pictures.diagrams import COLOURS
from fem_lie.pictures.page.colours import NodalColours, Scale
from fem_lie.pictures.shapes import Shape, joint_positions, scene_size, shapes, with_sharp_edges
from fem_lie.pictures.stage import Units, round_box

Packed = dict[str, str]

_KINDS = {"u1": "u1", "i2": "<i2", "u4": "<u4", "f4": "<f4"}
LARGEST = 32767
"""Largest integer of two bytes."""


def packed(values: npt.NDArray[Any], kind: str) -> Packed:
    """An array for the script: kind (NumPy's name of the type) and data."""
    data = np.ascontiguousarray(values, dtype=_KINDS[kind])
    return {"kind": kind, "data": base64.b64encode(data.tobytes()).decode("ascii")}


def quantised(positions: Array, middle: Array, unit: float) -> Packed:
    """Positions as multiples of ``unit`` from a centre, in two bytes; outliers are clipped."""
    steps = np.rint((positions - middle) / unit)
    return packed(np.clip(steps, -LARGEST, LARGEST), "i2")


def unit_of(positions: list[Array]) -> tuple[Array, float]:
    """Centre of the bounding box of positions (..., 3), and the unit for two bytes."""
    low = np.min([x.reshape(-1, 3).min(axis=0) for x in positions], axis=0)
    high = np.max([x.reshape(-1, 3).max(axis=0) for x in positions], axis=0)
    return 0.5 * (low + high), float((high - low).max()) / (2 * LARGEST) or 1.0


def json_text(content: object) -> str:
    """JSON that is safe inside an element of a page."""
    return json.dumps(content, ensure_ascii=False, allow_nan=False).replace("<", "\\u003c")


class Corners(NamedTuple):
    """Corners of triangles.

    Attributes:
        points: Index of the shape's point of each corner, shape (c,).
        triangles: Corners of the triangles, shape (t, 3).
    """

    points: Indices
    triangles: Indices

    @classmethod
    def of(cls, shape: Shape, frames: Array) -> Corners:
        """Corners of a body; sharp edges and coincident points are those in frames (N, 4, 3)."""
        import pyvista

        surface = pyvista.PolyData(shape.points(frames), shape.faces)
        surface.point_data["point"] = np.arange(surface.n_points)
        split = with_sharp_edges(surface).triangulate()
        points = np.asarray(split.point_data["point"]).astype(np.int64)
        return cls(points, split.faces.reshape(-1, 4)[:, 1:])


Content = dict[str, object]
_TRACE_STEP = (
    2e-3  # distance of points of a path, relative to the size of the scene: at most two pixels
)


def drawn(
    info: SceneInfo,
    frames: Array,
    paths: Sequence[Array],
    colours: Sequence[NodalColours],
    units: Units,
) -> Content:
    """Content of a scene in k states.

    Args:
        info: Bodies and joints.
        frames: Frames of all nodes, shape (k, N, 4, 3).
        paths: Lines to draw, each of shape (t, 3).
        colours: Nodal values of bodies in these states; other bodies have a single colour.
        units: Units of the axes.

    Raises:
        ValueError: Colours are of an unknown body, of another number of nodes or states, or of
            several quantities.
    """
    size = scene_size(frames)
    bodies = shapes(info, frames)
    rings = [np.array([shape.rings(step) for step in frames]) for shape in bodies]
    balls = np.array([joint_positions(info, step) for step in frames])
    middle, unit = unit_of([*(one[:, :, 0] for one in rings), *([balls] if balls.size else [])])
    scale = Scale.of(colours) if colours else None
    values = {one.body: _checked(one, info, len(frames)) for one in colours}

    def body(k: int) -> Content:
        found = _surface(bodies[k], rings[k], frames[0], size)
        found["colour"] = COLOURS[k % len(COLOURS)]
        found["places"] = quantised(rings[k][:, :, 0], middle, unit)
        nodal = values.get(info.bodies[k].name)
        if nodal is not None and scale is not None:
            shown = np.array([bodies[k].values(step) for step in nodal])
            found["values"] = packed(scale.steps(shown), "u1")
        return found

    return {
        "unit": unit / size,
        "bodies": [body(k) for k in range(len(bodies))],
        "joints": {
            "count": balls.shape[1],
            "radius": BALL,
            "places": quantised(balls, middle, unit),
        }
        if balls.size
        else None,
        "traces": [packed(_thinned(np.asarray((line - middle) / size)), "f4") for line in paths],
        "axes": list(_axes(frames, paths, middle, size, units)),
        "colours": None if scale is None else _legend(scale),
    }


def _surface(shape: Shape, rings: Array, unloaded: Array, size: float) -> Content:
    """Triangles, offsets of their corners from the rings, and the rings' directors."""
    corners = Corners.of(shape, unloaded)
    offset = shape.offset[corners.points]
    used = np.flatnonzero(np.any(offset != 0.0, axis=0))
    directors = rings[:, :, 1 + used]
    longest = float(np.abs(directors).max(initial=1.0))
    return {
        "rings": rings.shape[1],
        "triangles": packed(corners.triangles, "u4"),
        "ring": packed(shape.ring[corners.points], "u4"),
        "offset": packed(longest * offset[:, used] / size, "f4"),
        "directors": quantised(directors, np.zeros(3), longest / LARGEST),
    }


def _thinned(line: Array) -> Array:
    """Points of a line, (t, 3), some pixels apart, and its ends."""
    step = np.linalg.norm(np.diff(line, axis=0, prepend=line[:1]), axis=1)
    piece = np.floor(np.cumsum(step) / _TRACE_STEP)
    kept = np.append(True, np.diff(piece) > 0.0)
    kept[-1] = True
    return line[kept]


def _checked(colours: NodalColours, info: SceneInfo, states: int) -> Array:
    """Values in the states that are drawn, shape (k, n)."""
    wanted = (states, len(info.body(colours.body).nodes))
    if colours.values.shape != wanted:
        raise ValueError(
            f"colours of {colours.body} must have shape {wanted} (states, nodes), "
            f"got {colours.values.shape}"
        )
    return colours.values


def _axes(
    frames: Array, paths: Sequence[Array], middle: Array, size: float, units: Units
) -> Iterator[Content]:
    """Ticks along x, y and z, and their labels."""
    low, high, step, flat = round_box(frames, paths)
    for i, name in enumerate("xyz"):
        ticks = step * np.arange(np.rint(low[i] / step), np.rint(high[i] / step) + 1)
        yield {
            "label": f"{name} [{units.length}]",
            "flat": i in flat,
            "ticks": ((ticks - middle[i]) / size).tolist(),
            "texts": [f"{tick:.6g}" for tick in ticks],
        }


def _legend(scale: Scale) -> Content:
    return {
        "label": scale.label,
        "names": scale.names,
        "low": f"{scale.low:.3g}",
        "high": f"{scale.high:.3g}",
    }
