"""Pictures of sections: warping function as colours, regions, centre points and axes."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import numpy as np

from fem_lie.plot import COLOURS
from fem_lie.section import Array
from fem_lie.warping import Warping

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_CHORDS = 5  # points of a curved edge


def picture(warping: Warping, path: str | os.PathLike[str] | None = None) -> Figure:
    """A figure of its own, written to a file if one is given."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 5.5), dpi=150, layout="constrained")
    FigureCanvasAgg(figure)
    draw(warping, figure.subplots())
    if path is not None:
        figure.savefig(path)
    return figure


def draw(warping: Warping, axes: Axes) -> None:
    """Draw into given axes: e₂ to the right, e₃ upwards, seen against e₁."""
    from matplotlib.collections import LineCollection

    properties, largest = warping.properties, np.abs(warping.function).max()
    y, z = warping.points.T
    size = float(np.linalg.norm(np.ptp(warping.points, axis=0)))
    # a section that does not warp is one colour, not rounding errors in all colours
    limit = max(largest, 1e-3 * size**2)
    colours = axes.tripcolor(
        y,
        z,
        warping.triangles,
        warping.function,
        shading="gouraud",
        cmap="RdBu_r",
        vmin=-limit,
        vmax=limit,
    )
    bar = axes.figure.colorbar(colours, ax=axes, shrink=0.8)
    bar.set_label("warping function [length²]")
    bar.formatter.set_powerlimits((-2, 3))
    axes.add_collection(LineCollection(_curves(warping.mesh.borders()), colors="k", linewidths=0.8))
    _axes_of(axes, properties.centroid, properties.principal_angle, 0.25 * size)
    axes.plot(*properties.centroid, "o", color="k", markersize=5, label="centroid")
    axes.plot(
        *properties.shear_centre,
        "X",
        color=COLOURS[2],
        markeredgecolor="w",
        markersize=9,
        label="shear centre",
    )
    axes.set_aspect("equal")
    axes.set(xlabel="$y$ (along $e_2$)", ylabel="$z$ (along $e_3$)")
    axes.margins(0.08)
    axes.autoscale_view()
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, 1.12), ncols=3, frameon=False)


def _curves(edges: Array) -> Array:
    """Points of parabolas through starts, middles and ends, shape (e, _CHORDS, 2)."""
    t = np.linspace(0.0, 1.0, _CHORDS)
    shape = np.array([(1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1)])
    return np.asarray(np.einsum("pk,epj->ekj", shape, edges))


def _axes_of(axes: Axes, centre: Array, angle: float, length: float) -> None:
    """Cross of the principal axes, the one of the larger ∫η² drawn through."""
    for turned, style, label in ((0.0, "-", "principal axes"), (0.5 * np.pi, "--", None)):
        direction = length * np.array([np.cos(angle + turned), np.sin(angle + turned)])
        line = np.array([centre - direction, centre + direction]).T
        axes.plot(*line, style, color="k", linewidth=0.9, label=label)
