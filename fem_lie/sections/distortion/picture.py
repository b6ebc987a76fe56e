"""Pictures of the fields of a section: displacement in its plane, or warping as colours."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Protocol

import numpy as np

from fem_lie._arrays import Array, Indices

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_MOVED = 0.12  # of the size of the section
_COLUMNS = 4
_GREY, _BLUE = "#cccccc", "#0072B2"


class Distorting(Protocol):
    """A section and its fields, see :class:`~fem_lie.sections.Distortion`."""

    points: Array
    cells: Indices
    fields: Array
    plane: int


def picture(section: Distorting, path: str | os.PathLike[str] | None = None) -> Figure:
    """Figure of all fields, written to a file if ``path`` is given."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.collections import PolyCollection
    from matplotlib.figure import Figure

    count, size = len(section.fields), float(np.linalg.norm(np.ptp(section.points, axis=0)))
    columns, rows = min(count, _COLUMNS), -(-count // _COLUMNS)
    figure = Figure(figsize=(2.8 * columns, 3.0 * rows), dpi=150, layout="constrained")
    FigureCanvasAgg(figure)
    corners = section.cells[:, :3]
    if section.cells.shape[1] == 9:
        corners = section.cells[:, [0, 1, 3, 2]]
    for k in range(count):
        field: Array = section.fields[k]
        axes = figure.add_subplot(rows, columns, k + 1)
        if k < section.plane:
            moved = section.points + _MOVED * size / np.abs(field).max() * field[:, 1:]
            for points, colour in ((section.points, _GREY), (moved, _BLUE)):
                cells = PolyCollection(list(points[corners]), facecolors=colour, edgecolors=colour)
                axes.add_collection(cells)
            axes.set_title(f"distortion {k + 1}")
        else:
            cells = PolyCollection(list(section.points[corners]), cmap="RdBu_r", edgecolors="face")
            cells.set_array(field[corners, 0].mean(axis=1))
            limit = float(np.abs(field[:, 0]).max())
            cells.set_clim(-limit, limit)
            axes.add_collection(cells)
            axes.set_title(f"warping {k + 1 - section.plane}")
        axes.autoscale_view()
        axes.set_aspect("equal")
        axes.set_axis_off()
    if path is not None:
        figure.savefig(path)
    return figure
