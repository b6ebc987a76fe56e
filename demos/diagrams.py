"""Diagrams of demos: a figure is opened, drawn into, and written."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from command_line import in_results
from matplotlib.figure import Figure

from fem_lie.extend import COLOURS

__all__ = ["COLOURS", "diagram"]


@contextmanager
def diagram(name: str, panels: int = 1) -> Iterator[Any]:
    """Axes to draw into, several side by side if asked for; then grid, legend and file."""
    figure = Figure(figsize=(6.0 if panels == 1 else 4.5 * panels, 4.0), dpi=150)
    figure.set_layout_engine("constrained")
    axes = figure.subplots(1, panels, squeeze=False)[0]
    yield axes[0] if panels == 1 else axes
    for one in axes:
        one.grid(color="#DDDDDD", linewidth=0.6)
        if one.get_legend() is None and one.get_legend_handles_labels()[0]:
            one.legend(frameon=False)
    figure.savefig(in_results(name))
