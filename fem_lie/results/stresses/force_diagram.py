"""Diagrams of section forces over arc length."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fem_lie._arrays import Array
from fem_lie.bodies.beams.beam import Beam
from fem_lie.pictures.diagrams import COLOURS, figure_of_rows, saved
from fem_lie.pictures.units import Units
from fem_lie.results.stresses.beam_quantities import unit

if TYPE_CHECKING:
    from matplotlib.figure import Figure


_PALEST = 0.25
_HEIGHT = 1.5  # of a diagram, inches


def diagrams(
    beam: Beam,
    quantities: Sequence[tuple[str, Array]],
    steps: Sequence[int],
    path: str | os.PathLike[str] | None,
    units: Units,
) -> Figure:
    """One diagram for each quantity, one line for each smooth piece of the beam and each state.

    Pieces of a beam with kinks or branches are drawn one after the other.

    Args:
        beam: The beam; m elements.
        quantities: Name and values at both ends of each element, shape (T, m, 2), of each.
        steps: Which of the T states, the later the darker.
        path: Name of the picture; saved if there is one.
        units: For the labels.
    """
    figure, axes = figure_of_rows(len(quantities), f"Section forces of {beam.label}", units)
    figure.set_size_inches(8.0, 1.2 + _HEIGHT * len(quantities))
    chains = beam.chains
    pieces = np.split(chains.order, chains.first[1:])
    strengths = np.linspace(_PALEST, 1.0, len(steps)) if len(steps) > 1 else [1.0]
    for ax, (name, values) in zip(axes, quantities, strict=True):
        ax.axhline(0.0, color="#777777", linewidth=0.8)
        start = 0.0
        for number, cells in enumerate(pieces):
            colour = COLOURS[number % len(COLOURS)]
            for step, strength in zip(steps, strengths, strict=True):
                along = start + chains.arc[cells].ravel()
                ax.plot(along, values[step, cells].ravel(), color=colour, alpha=strength)
            start += float(chains.arc[cells].max())
        ax.set_ylabel(f"{name} [{unit(name, units)}]")
    axes[-1].set_xlabel(f"arc length [{units.length}]")
    return saved(figure, path)
