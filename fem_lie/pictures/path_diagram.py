"""Diagrams of paths of equilibrium: what is stable, what is not, and where that changes."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fem_lie.pictures.diagrams import COLOURS
from fem_lie.pictures.units import Units

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fem_lie._arrays import Array
    from fem_lie.results.path import EquilibriumPath

_MARKS = {"limit point": "o", "bifurcation": "D"}


def plot_paths(
    paths: Sequence[tuple[EquilibriumPath, Array]],
    path: str | os.PathLike[str] | None,
    labels: tuple[str, str],
    load: float,
    *,
    reference: tuple[Array, Array, str] | None = None,
    shape: bool = True,
    units: Units,
) -> Figure:
    """Load over a quantity for one or several paths.

    Args:
        paths: Paths and the quantity at their states.
        path: Name of the file if it is to be saved.
        labels: Of the quantity and of the load.
        load: At factor 1.
        reference: Values, loads and name of points to be drawn with them.
        shape: Whether to draw the last state of the first path beside the diagram.
        units: For the axes of that picture.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.0 if shape else 6.5, 4.5), dpi=150, layout="constrained")
    FigureCanvasAgg(figure)
    axes = list(figure.subplots(1, 2 if shape else 1, squeeze=False)[0])
    curve = axes[0]
    for colour, (result, values) in zip(_cycle(len(paths)), paths, strict=True):
        _draw(curve, result, values, load, colour)
    if reference is not None:
        curve.plot(*reference[:2], "+", color="black", markersize=6, label=reference[2])
    _explain(curve, [result for result, _ in paths])
    curve.set(xlabel=labels[0], ylabel=labels[1])
    curve.grid(color="#DDDDDD", linewidth=0.6)
    curve.spines[["top", "right"]].set_visible(False)
    if shape:
        _shape(axes[1], paths[0][0], units)
    if path is not None:
        figure.savefig(path)
    return figure


def _cycle(count: int) -> list[str]:
    return [COLOURS[k % len(COLOURS)] for k in range(count)]


def _draw(ax: Axes, result: EquilibriumPath, values: Array, load: float, colour: str) -> None:
    """Pieces between states; a piece is unstable where one of its ends is, critical ones apart."""
    loads, counts = load * result.factors, result.negative_pivots
    # a critical state belongs to the piece before it
    unstable = counts[1:] > 0
    starts = np.flatnonzero(np.diff(unstable.astype(int))) + 1
    for first, last in zip([0, *starts], [*starts, len(unstable)], strict=True):
        if last > first:
            style = "--" if unstable[first] else "-"
            piece = slice(first, last + 1)
            ax.plot(values[piece], loads[piece], style, color=colour, linewidth=1.5)
    for point in result.critical:
        x, y = values[point.index], load * point.factor
        ax.plot([x], [y], _MARKS[point.kind.value], color=colour, markerfacecolor="white")


def _explain(ax: Axes, results: list[EquilibriumPath]) -> None:
    """A legend of what occurs."""
    if any(result.stable.any() for result in results):
        ax.plot([], [], "-", color="black", label="stable")
    if any(not result.stable.all() for result in results):
        ax.plot([], [], "--", color="black", label="unstable")
    kinds = dict.fromkeys(point.kind.value for result in results for point in result.critical)
    for kind in kinds:
        ax.plot([], [], _MARKS[kind], color="black", markerfacecolor="white", label=kind)
    ax.legend(frameon=False)


def _shape(ax: Axes, result: EquilibriumPath, units: Units) -> None:
    """The unloaded, the critical and the last state, as a picture in the diagram."""
    from matplotlib.image import imread

    from fem_lie.pictures.bodies import draw

    rows = sorted({0, *(point.index for point in result.critical), len(result) - 1})
    with tempfile.TemporaryDirectory() as folder:
        name = Path(folder) / "shape.png"
        # as many pixels as it is given, and numbers as large as those of the curve
        draw(result.info, result.frames[rows], name, units=units, size=(900, 700), text=20)
        ax.imshow(imread(name))
    ax.set_axis_off()
