"""Diagrams over time, drawn without a display and without changing pyplot's state."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fem_lie.pictures.stage import SI

if TYPE_CHECKING:
    import numpy.typing as npt
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fem_lie._arrays import Array
    from fem_lie.pictures.stage import Units

# colours of Okabe & Ito, distinguishable with colour vision deficiency
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")


_NIL = 1e-9  # of the largest component
_MARKED = 30  # states: each of more is not marked in a curve


def energies(
    times: Array,
    kinetic: Array,
    elastic: Array,
    potential: Array,
    path: str | os.PathLike[str] | None = None,
    *,
    units: Units = SI,
) -> Figure:
    """Energies (T,), and below them the change of their sum, over time.

    A small elastic energy, which would not be visible among the others, has a diagram of its own.
    """
    parts = {"kinetic": kinetic, "elastic": elastic, "potential": potential}
    total = kinetic + elastic + potential
    small = 0.0 < np.ptp(elastic) < 0.05 * np.abs(total).max()
    figure, axes = figure_of_rows(3 if small else 2, "Energy", units)
    for colour, (name, values) in zip(COLOURS, parts.items(), strict=False):
        if np.any(values):
            axes[0].plot(times, values, color=colour, label=name)
    axes[0].plot(times, total, color="black", linestyle="--", label="total")
    axes[0].set_ylabel(f"energy [{units.energy}]")
    _legend(axes[0])
    if small:
        axes[1].plot(times, elastic, color=COLOURS[1])
        axes[1].set_ylabel(f"elastic [{units.energy}]")
    axes[-1].plot(times, total - total[0], color="black")
    axes[-1].set_ylabel(f"total − start [{units.energy}]")
    return saved(figure, path)


def momenta(
    times: Array,
    momentum: Array,
    angular_momentum: Array,
    path: str | os.PathLike[str] | None = None,
    *,
    units: Units = SI,
) -> Figure:
    """Components of momentum and angular momentum, shape (T, 3), over time."""
    figure, (above, below) = figure_of_rows(2, "Momentum", units)
    _components(above, times, momentum, "p")
    above.set_ylabel(f"momentum [{units.momentum}]")
    _components(below, times, angular_momentum, "L")
    below.set_ylabel(f"angular momentum\nabout the origin [{units.angular_momentum}]")
    return saved(figure, path)


class VectorSeries(NamedTuple):
    """Components of a vector in k states.

    Attributes:
        label: What it belongs to, and its unit.
        symbol: Symbol of the components; empty: their axes alone.
        values: Shape (k, 3).
        least: Smallest magnitude to which the axis reaches, so that round-off looks like zero.
    """

    label: str
    symbol: str
    values: Array
    least: float = 0.0


def components(
    along: tuple[Array, str, str],
    series: Sequence[VectorSeries],
    title: str,
    path: str | os.PathLike[str] | None = None,
    *,
    units: Units = SI,
) -> Figure:
    """Components of vectors over time or load factor, one diagram for each vector.

    Args:
        along: Times or load factors, shape (k,), their name, and unit.
        series: The vectors.
        title: Title of the figure.
        path: Name of the file if it is to be saved.
        units: Units of the axes.
    """
    figure, axes = figure_of_rows(len(series), title, units)
    values, name, unit = along
    marker = "" if len(values) > _MARKED else "o"
    for ax, (label, symbol, vectors, least) in zip(axes, series, strict=True):
        _components(ax, values, vectors, symbol, marker)
        ax.set_ylabel(label)
        if np.ptp(vectors) < least:
            ax.set_ylim(vectors.min() - least, vectors.max() + least)
    axes[-1].set_xlabel(f"{name} [{unit}]" if unit else name)
    return saved(figure, path)


def responses(
    frequencies: Array,
    amplitudes: npt.NDArray[np.complex128],
    label: str,
    path: str | os.PathLike[str] | None = None,
    *,
    units: Units = SI,
) -> Figure:
    """Modulus and phase of the components of a displacement over frequency.

    Args:
        frequencies: Angular frequencies, shape (k,).
        amplitudes: Complex amplitudes, shape (k, 3).
        label: Name of the point.
        path: Name of the file if it is to be saved.
        units: Units of the axes.
    """
    figure, (above, below) = figure_of_rows(2, "Frequency response", units)
    size = np.abs(amplitudes).max(axis=0)
    for index in np.flatnonzero(size > _NIL * size.max()):
        values, colour = amplitudes[:, index], COLOURS[index]
        above.semilogy(frequencies, np.abs(values), color=colour, label=f"$u_{'xyz'[index]}$")
        below.plot(frequencies, np.degrees(np.unwrap(np.angle(values))), color=colour)
    above.set_ylabel(f"{label} [{units.length}]")
    _legend(above)
    below.set(xlabel=f"angular frequency [rad/{units.time}]", ylabel="phase [°]")
    return saved(figure, path)


def campbell(
    speeds: Array,
    lines: Mapping[str, Array],
    critical: Array,
    path: str | os.PathLike[str] | None = None,
    *,
    units: Units = SI,
) -> Figure:
    """Whirl frequencies over the speed of a rotor, and where they are synchronous.

    Args:
        speeds: Shape (k,).
        lines: Frequencies of the lines of each direction by its name, shape (k, p).
        critical: Critical speeds.
        path: Name of the file if it is to be saved.
        units: Units of the axes.
    """
    figure, (axes,) = figure_of_rows(1, "Campbell diagram", units)
    figure.set_size_inches(6.5, 4.5)
    for colour, (name, values) in zip(COLOURS, lines.items(), strict=False):
        drawn = axes.plot(speeds, values, color=colour)
        drawn[0].set_label(name)
    axes.plot(speeds, speeds, ":", color="#777777", label="synchronous")
    if len(critical):
        axes.plot(critical, critical, "o", color="black", markersize=4, label="critical")
    axes.set(xlabel=f"speed [rad/{units.time}]", ylabel=f"frequency [rad/{units.time}]")
    _legend(axes)
    return saved(figure, path)


def figure_of_rows(rows: int, title: str, units: Units) -> tuple[Figure, list[Axes]]:
    """Diagrams one below the other with a common time axis."""
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
    """The figure; it is written to a file if there is a path."""
    if path is not None:
        figure.savefig(path)
    return figure
