"""Diagrams of results over time. Works without a display and leaves pyplot's state alone."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fem_lie.pictures.units import SI

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fem_lie._arrays import Array
    from fem_lie.bodies.body import Point
    from fem_lie.pictures.units import Units
    from fem_lie.results.equilibrium import StaticResult
    from fem_lie.results.history import Result

# Okabe & Ito's colours, told apart by everyone
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")


def energies(
    result: Result, path: str | os.PathLike[str] | None = None, *, units: Units = SI
) -> Figure:
    """Energies, and below them the change of their sum, over time.

    An elastic energy that is too small to be seen beside the others has a diagram of its own.
    """
    total = result.total_energy
    small = 0.0 < np.ptp(result.elastic) < 0.05 * np.abs(total).max()
    figure, axes = figure_of_rows(3 if small else 2, "Energy", units)
    for colour, name in zip(COLOURS, ("kinetic", "elastic", "potential"), strict=False):
        if np.any(getattr(result, name)):
            axes[0].plot(result.times, getattr(result, name), color=colour, label=name)
    axes[0].plot(result.times, total, color="black", linestyle="--", label="total")
    axes[0].set_ylabel(f"energy [{units.energy}]")
    _legend(axes[0])
    if small:
        axes[1].plot(result.times, result.elastic, color=COLOURS[1])
        axes[1].set_ylabel(f"elastic [{units.energy}]")
    axes[-1].plot(result.times, total - total[0], color="black")
    axes[-1].set_ylabel(f"total − start [{units.energy}]")
    return saved(figure, path)


def momenta(
    result: Result, path: str | os.PathLike[str] | None = None, *, units: Units = SI
) -> Figure:
    """Components of momentum and angular momentum over time."""
    figure, (above, below) = figure_of_rows(2, "Momentum", units)
    _components(above, result.times, result.momentum, "p")
    above.set_ylabel(f"momentum [{units.momentum}]")
    _components(below, result.times, result.angular_momentum, "L")
    below.set_ylabel(f"angular momentum\nabout the origin [{units.angular_momentum}]")
    return saved(figure, path)


def positions(
    result: Result,
    points: Sequence[Point | str | int],
    path: str | os.PathLike[str] | None = None,
    *,
    units: Units = SI,
) -> Figure:
    """Components of the positions of points over time, one diagram for each point.

    Raises:
        ValueError: No point is given, or there is no such point.
    """
    if not points:
        raise ValueError("give at least one point whose position is to be plotted")
    figure, axes = figure_of_rows(len(points), "Position", units)
    for ax, point in zip(axes, points, strict=True):
        _components(ax, result.times, result.position(point), "")
        label = point if isinstance(point, str) else getattr(point, "label", f"node {point}")
        ax.set_ylabel(f"{label} [{units.length}]")
    return saved(figure, path)


def displacements(
    result: StaticResult,
    points: Sequence[Point | str],
    path: str | os.PathLike[str] | None = None,
    *,
    units: Units = SI,
) -> Figure:
    """Components of the displacements of points over the load factor, one diagram for each point.

    Raises:
        ValueError: No point is given, or there is no such point.
    """
    if not points:
        raise ValueError("give at least one point whose displacement is to be plotted")
    figure, axes = figure_of_rows(len(points), "Displacement", units)
    factors = np.concatenate([[0.0], result.factors])
    for ax, point in zip(axes, points, strict=True):
        moved = result.position(point) - result.initial[result.info.node(point), 0]
        _components(ax, factors, np.vstack([np.zeros(3), moved]), "u", marker="o")
        label = point if isinstance(point, str) else point.label
        ax.set_ylabel(f"{label} [{units.length}]")
    axes[-1].set_xlabel("load factor")
    return saved(figure, path)


def figure_of_rows(rows: int, title: str, units: Units) -> tuple[Figure, list[Axes]]:
    """Diagrams one below the other over a common axis, labelled as time."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 1.2 + 2.4 * rows), dpi=150, layout="constrained")
    FigureCanvasAgg(figure)
    axes = list(figure.subplots(rows, 1, sharex=True, squeeze=False)[:, 0])
    figure.suptitle(title)
    figure.align_ylabels(axes)
    for ax in axes:
        ax.grid(color="#DDDDDD", linewidth=0.6)
        ax.set_axisbelow(True)
        ax.spines[["top", "right"]].set_visible(False)
        ax.margins(x=0.01)
        ax.ticklabel_format(axis="y", scilimits=(-3, 4), useMathText=True)
    axes[-1].set_xlabel(f"time [{units.time}]")
    return figure, axes


def _components(ax: Axes, times: Array, vectors: Array, symbol: str, marker: str = "") -> None:
    for colour, index, values in zip(COLOURS, "xyz", vectors.T, strict=False):
        label = f"${symbol}_{index}$" if symbol else f"${index}$"
        ax.plot(times, values, color=colour, label=label, marker=marker)
    _legend(ax)


def _legend(ax: Axes) -> None:
    ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)


def saved(figure: Figure, path: str | os.PathLike[str] | None) -> Figure:
    """The figure, written to a file if there is a path."""
    if path is not None:
        figure.savefig(path)
    return figure
