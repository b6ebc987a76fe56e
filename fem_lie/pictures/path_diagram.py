"""Diagrams of equilibrium paths, with stability and critical points."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.pictures import bodies
from fem_lie.pictures.diagrams import COLOURS
from fem_lie.pictures.stage import Canvas, Units

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


_MARKS = {"limit point": "o", "bifurcation": "D"}


class PathCurve(NamedTuple):
    """One path in a diagram.

    Attributes:
        values: Values of the quantity at each state, shape (k,).
        factors: Load factors, shape (k,).
        negative_pivots: Number of negative pivots of the tangent stiffness at each state, shape
            (k,); a state with none is stable.
        critical: Index of the state, load factor and type of each critical point.
    """

    values: Array
    factors: Array
    negative_pivots: Indices
    critical: Sequence[tuple[int, float, str]]


def plot_paths(
    paths: Sequence[PathCurve],
    path: str | os.PathLike[str] | None,
    labels: tuple[str, str],
    load: float,
    *,
    reference: tuple[Array, Array, str] | None = None,
    states: tuple[SceneInfo, Array] | None = None,
    units: Units,
) -> Figure:
    """Plot load over a quantity for one or several paths.

    Args:
        paths: The paths.
        path: Name of the file if it is to be saved.
        labels: Labels of the quantity and of the load.
        load: Load at factor 1.
        reference: Values, loads and label of reference points.
        states: Scene and frames, shape (s, n, 4, 3), of states to be drawn next to the diagram.
        units: Units of the axes of that picture.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.5 if states is None else 11.0, 4.5), dpi=150, layout="constrained")
    FigureCanvasAgg(figure)
    axes = list(figure.subplots(1, 1 if states is None else 2, squeeze=False)[0])
    curve = axes[0]
    for colour, found in zip(_cycle(len(paths)), paths, strict=True):
        _draw(curve, found, load, colour)
    if reference is not None:
        curve.plot(*reference[:2], "+", color="black", markersize=6, label=reference[2])
    _explain(curve, paths)
    curve.set(xlabel=labels[0], ylabel=labels[1])
    curve.grid(color="#DDDDDD", linewidth=0.6)
    curve.spines[["top", "right"]].set_visible(False)
    if states is not None:
        _shape(axes[1], *states, units)
    if path is not None:
        figure.savefig(path)
    return figure


def _cycle(count: int) -> list[str]:
    return [COLOURS[k % len(COLOURS)] for k in range(count)]


def _draw(ax: Axes, found: PathCurve, load: float, colour: str) -> None:
    """Line segments between states; a segment is unstable if one of its ends is."""
    values, loads, counts = found.values, load * found.factors, found.negative_pivots
    # a critical state belongs to the segment before it
    unstable = counts[1:] > 0
    starts = np.flatnonzero(np.diff(unstable.astype(int))) + 1
    for first, last in zip([0, *starts], [*starts, len(unstable)], strict=True):
        if last > first:
            style = "--" if unstable[first] else "-"
            piece = slice(first, last + 1)
            ax.plot(values[piece], loads[piece], style, color=colour, linewidth=1.5)
    for index, factor, kind in found.critical:
        x, y = values[index], load * factor
        ax.plot([x], [y], _MARKS[kind], color=colour, markerfacecolor="white")


def _explain(ax: Axes, paths: Sequence[PathCurve]) -> None:
    """Legend of the line styles and marks that occur."""
    stable = np.concatenate([found.negative_pivots == 0 for found in paths])
    if stable.any():
        ax.plot([], [], "-", color="black", label="stable")
    if not stable.all():
        ax.plot([], [], "--", color="black", label="unstable")
    kinds = dict.fromkeys(kind for found in paths for _, _, kind in found.critical)
    for kind in kinds:
        ax.plot([], [], _MARKS[kind], color="black", markerfacecolor="white", label=kind)
    ax.legend(frameon=False)


def _shape(ax: Axes, info: SceneInfo, frames: Array, units: Units) -> None:
    """Picture of states inside the diagram."""
    from matplotlib.image import imread

    with tempfile.TemporaryDirectory() as folder:
        name = Path(folder) / "shape.png"
        # rendered at its final size, with labels as large as those of the curve
        canvas = Canvas(units=units, size=(900, 700), text=20)
        bodies.draw(info, frames, name, canvas=canvas)
        ax.imshow(imread(name))
    ax.set_axis_off()
