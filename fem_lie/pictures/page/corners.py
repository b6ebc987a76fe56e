"""Triangles of a body, with corners of their own on both sides of a sharp edge."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.pictures.shapes import Shape, with_sharp_edges


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
