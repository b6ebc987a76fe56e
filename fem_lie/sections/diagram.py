"""Pictures of sections: warping function as colours, regions, centre points and axes."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Protocol

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.sections.properties import SectionProperties
from fem_lie.sections.section_mesh import SectionMesh

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_CHORDS = 5  # points of a curved edge


_GREEN = "#009E73"  # colours of Okabe & Ito, which colour-blind readers can distinguish


class Warped(Protocol):
    """A section and its warping function, see :class:`~fem_lie.sections.Warping`."""

    mesh: SectionMesh
    properties: SectionProperties
    points: Array
    triangles: Indices
    function: Array


def picture(warping: Warped, path: str | os.PathLike[str] | None = None) -> Figure:
    """Figure of a section, written to a file if ``path`` is given."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 5.5), dpi=150, layout="constrained")
    FigureCanvasAgg(figure)
    draw(warping, figure.subplots())
    if path is not None:
        figure.savefig(path)
    return figure


def draw(warping: Warped, axes: Axes) -> None:
    """Draw a section into axes: e₂ to the right, e₃ upwards, seen against e₁."""
    from matplotlib.collections import LineCollection
    from matplotlib.ticker import ScalarFormatter
    from matplotlib.tri import Triangulation

    properties, largest = warping.properties, np.abs(warping.function).max()
    size = float(np.linalg.norm(np.ptp(warping.points, axis=0)))
    # a section that does not warp is one colour: round-off is not drawn
    limit = max(largest, 1e-3 * size**2)
    colours = axes.tripcolor(
        Triangulation(warping.points[:, 0], warping.points[:, 1], warping.triangles),
        warping.function,
        shading="gouraud",
        cmap="RdBu_r",
        vmin=-limit,
        vmax=limit,
    )
    powers = ScalarFormatter(useMathText=True)
    powers.set_powerlimits((-2, 3))
    bar = axes.figure.colorbar(colours, ax=axes, shrink=0.8, format=powers)
    bar.set_label("warping function [length²]")
    curves = list(_curves(warping.mesh.borders()))
    axes.add_collection(LineCollection(curves, colors="k", linewidths=0.8))
    _axes_of(axes, properties.centroid, properties.principal_angle, 0.25 * size)
    axes.plot(*properties.centroid, "o", color="k", markersize=5, label="centroid")
    axes.plot(
        *properties.shear_centre,
        "X",
        color=_GREEN,
        markeredgecolor="w",
        markersize=9,
        label="shear centre",
    )
    if len(warping.mesh.names) > 1:
        _names(axes, warping)
    axes.set_aspect("equal")
    axes.locator_params(axis="x", nbins=5)
    axes.set(xlabel="$y$ (along $e_2$)", ylabel="$z$ (along $e_3$)")
    axes.margins(0.08)
    axes.autoscale_view()
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, 1.12), ncols=3, frameon=False)


def _names(axes: Axes, warping: Warped) -> None:
    """Write the name of each region, to the right of its upper right cell."""
    mesh = warping.mesh
    middles = mesh.points[mesh.cells].mean(axis=1)
    for region, name in enumerate(mesh.names):
        own = middles[mesh.regions == region]
        axes.annotate(
            name,
            own[own.sum(axis=1).argmax()],
            xytext=(16, -16),
            textcoords="offset points",
            va="center",
            fontsize=9,
            bbox={"facecolor": "w", "edgecolor": "none", "alpha": 0.7, "pad": 1.0},
            arrowprops={"arrowstyle": "-", "linewidth": 0.6},
        )


def _curves(edges: Array) -> Array:
    """Points of parabolas through starts, middles and ends, shape (e, _CHORDS, 2)."""
    t = np.linspace(0.0, 1.0, _CHORDS)
    shape = np.array([(1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1)])
    return np.asarray(np.einsum("pk,epj->ekj", shape, edges))


def _axes_of(axes: Axes, centre: Array, angle: float, length: float) -> None:
    """Draw the cross of the principal axes; the axis of the larger ∫η² is a solid line."""
    for turned, style, label in ((0.0, "-", "principal axes"), (0.5 * np.pi, "--", None)):
        direction = length * np.array([np.cos(angle + turned), np.sin(angle + turned)])
        line = np.array([centre - direction, centre + direction]).T
        axes.plot(*line, style, color="k", linewidth=0.9, label=label)
