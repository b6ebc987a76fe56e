"""What a page's script draws: bodies, joints, traces and axes, in lengths of the scene."""

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
from fem_lie.pictures.shapes import Shape, joint_places, scene_size, shapes, with_sharp_edges
from fem_lie.pictures.stage import Units, round_box

Packed = dict[str, str]

_KINDS = {"u1": "u1", "i2": "<i2", "u4": "<u4", "f4": "<f4"}
LARGEST = 32767
"""Of whole numbers of two bytes."""


def packed(values: npt.NDArray[Any], kind: str) -> Packed:
    """An array as the script takes it: kind (bytes of a number, as NumPy calls them) and data."""
    data = np.ascontiguousarray(values, dtype=_KINDS[kind])
    return {"kind": kind, "data": base64.b64encode(data.tobytes()).decode("ascii")}


def whole_places(places: Array, middle: Array, unit: float) -> Packed:
    """Places in whole units from a middle, in two bytes; what lies beyond is set to the rim."""
    steps = np.rint((places - middle) / unit)
    return packed(np.clip(steps, -LARGEST, LARGEST), "i2")


def unit_of(places: list[Array]) -> tuple[Array, float]:
    """Middle of the box about places (..., 3), and the unit in which two bytes reach its rim."""
    low = np.min([x.reshape(-1, 3).min(axis=0) for x in places], axis=0)
    high = np.max([x.reshape(-1, 3).max(axis=0) for x in places], axis=0)
    return 0.5 * (low + high), float((high - low).max()) / (2 * LARGEST) or 1.0


def json_text(content: object) -> str:
    """As JSON that can stand in an element of a page."""
    return json.dumps(content, ensure_ascii=False, allow_nan=False).replace("<", "\\u003c")


class Corners(NamedTuple):
    """Corners of triangles.

    Attributes:
        points: Which of the shape's points each corner is, shape (c,).
        triangles: Shape (t, 3).
    """

    points: Indices
    triangles: Indices

    @classmethod
    def of(cls, shape: Shape, frames: Array) -> Corners:
        """Those of a body; what is sharp and what coincides is so in the frames (N, 4, 3)."""
        import pyvista

        surface = pyvista.PolyData(shape.points(frames), shape.faces)
        surface.point_data["point"] = np.arange(surface.n_points)
        split = with_sharp_edges(surface).triangulate()
        points = np.asarray(split.point_data["point"]).astype(np.int64)
        return cls(points, split.faces.reshape(-1, 4)[:, 1:])


Content = dict[str, object]
_TRACE_STEP = 2e-3  # between points of a trace, part of the scene: two pixels or less


def drawn(
    info: SceneInfo,
    frames: Array,
    paths: Sequence[Array],
    colours: Sequence[NodalColours],
    units: Units,
) -> Content:
    """What is seen of a scene in k states.

    Args:
        info: Bodies and joints.
        frames: Shape (k, N, 4, 3).
        paths: Lines to draw with them, each of shape (t, 3).
        colours: Values of bodies in these states; others have a colour of their own.
        units: For the axes.

    Raises:
        ValueError: Colours are of a body that is not there, of another number of nodes or states,
            or of several quantities.
    """
    size = scene_size(frames)
    bodies = shapes(info, frames)
    rings = [np.array([shape.rings(step) for step in frames]) for shape in bodies]
    balls = np.array([joint_places(info, step) for step in frames])
    middle, unit = unit_of([*(one[:, :, 0] for one in rings), *([balls] if balls.size else [])])
    scale = Scale.of(colours) if colours else None
    values = {one.body: _checked(one, info, len(frames)) for one in colours}

    def body(k: int) -> Content:
        found = _surface(bodies[k], rings[k], frames[0], size)
        found["colour"] = COLOURS[k % len(COLOURS)]
        found["places"] = whole_places(rings[k][:, :, 0], middle, unit)
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
            "places": whole_places(balls, middle, unit),
        }
        if balls.size
        else None,
        "traces": [packed(_thinned(np.asarray((line - middle) / size)), "f4") for line in paths],
        "axes": list(_axes(frames, paths, middle, size, units)),
        "colours": None if scale is None else _legend(scale),
    }


def _surface(shape: Shape, rings: Array, unloaded: Array, size: float) -> Content:
    """Triangles, where their corners are beside their rings, and the rings' directors."""
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
        "directors": whole_places(directors, np.zeros(3), longest / LARGEST),
    }


def _thinned(line: Array) -> Array:
    """Points of a line, (t, 3), some pixels apart along it, and its ends."""
    step = np.linalg.norm(np.diff(line, axis=0, prepend=line[:1]), axis=1)
    piece = np.floor(np.cumsum(step) / _TRACE_STEP)
    kept = np.append(True, np.diff(piece) > 0.0)
    kept[-1] = True
    return line[kept]


def _checked(colours: NodalColours, info: SceneInfo, states: int) -> Array:
    """Values of the states that are drawn, shape (k, n)."""
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
    """Ticks along x, y and z, and the numbers there."""
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
