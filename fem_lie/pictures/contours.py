"""Pictures of deformed surfaces coloured by a value. Works without a display."""

from __future__ import annotations

import os
from typing import NamedTuple

import numpy as np

from fem_lie import _compat
from fem_lie._arrays import Array, Indices
from fem_lie.pictures.stage import INK, Canvas, add_frame, plotting, target_of
from fem_lie.pictures.vtk_grids import CellKind, surface_grid

# of both signs: blue and red about zero; of one sign: from dark to bright
_SIGNED, _PLAIN = "RdBu_r", "viridis"
_COLOURS = 256
_AMBIENT = 0.7  # so much that a colour is the same on all sides, nearly
_SUBDIVISION = 2  # of cells of second degree
_ONE_SIGN = 0.02  # of the largest; less of the other sign is none


class DrawnSurface(NamedTuple):
    """Cells of a surface.

    Attributes:
        mesh: What the cells are.
        cells: Points of each cell in DOLFINx's order, shape (m, k).
        unloaded: Places of the points, shape (p, 3).
    """

    mesh: CellKind
    cells: Indices
    unloaded: Array


def draw_values(
    path: str | os.PathLike[str],
    surface: DrawnSurface,
    points: Array,
    values: Array,
    label: str,
    canvas: Canvas,
) -> None:
    """Draw a surface in colours, with their scale, and the outline of the unloaded one.

    Args:
        path: Name of the ``.png`` file.
        surface: What is drawn.
        points: Places to be drawn, shape (p, 3).
        values: Values at the points, shape (p,).
        label: What they are, and their unit.
        canvas: What it is drawn on.

    Raises:
        ValueError: The name does not end in ``.png``.
        RuntimeError: There is no display, and no Xvfb to stand in.
    """
    target = target_of(path, ".png")
    mesh, cells, unloaded = surface
    size, grid = canvas.size, surface_grid(points, cells, mesh)
    grid.point_data[label] = values
    drawn = _compat.drawn_surface(grid, _SUBDIVISION)
    rim = _compat.drawn_surface(surface_grid(unloaded, cells, mesh), 1).extract_feature_edges()
    with plotting((), canvas) as plotter:
        plotter.add_mesh(
            drawn,
            scalars=label,
            clim=_limits(values),
            cmap=_SIGNED if _signed(values) else _PLAIN,
            n_colors=_COLOURS,
            smooth_shading=True,
            split_sharp_edges=True,
            ambient=_AMBIENT,
            diffuse=1.0 - _AMBIENT,
            scalar_bar_args={
                "title": label + "\n",
                "vertical": True,
                "position_x": 0.9,
                "position_y": 0.2,
                "height": 0.6,
                "width": 0.05,
                "color": INK,
                # what is beside the bar on its right is all the room that half a title has
                "title_font_size": size[0] // max(60, round(3.4 * len(label))),
                "label_font_size": size[0] // 70,
                "fmt": "%.3g",
            },
        )
        if rim.n_points:
            plotter.add_mesh(rim, color=INK, line_width=size[0] / 800)
        both = np.stack([unloaded, points])[:, :, np.newaxis]
        add_frame(plotter, both, (), canvas)
        plotter.screenshot(target)


def _signed(values: Array) -> bool:
    low, high = float(values.min()), float(values.max())
    return min(-low, high) > _ONE_SIGN * max(-low, high)


def _limits(values: Array) -> tuple[float, float]:
    if not _signed(values):
        return float(values.min()), float(values.max())
    largest = float(np.abs(values).max())
    return -largest, largest
