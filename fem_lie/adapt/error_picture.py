"""Pictures of errors: densities over arc length, or in the colours of cells."""

from __future__ import annotations

import os

import numpy as np

from fem_lie._arrays import Array
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.shells.shell import Shell
from fem_lie.pictures.contours import DrawnSurface, draw_values
from fem_lie.pictures.diagrams import COLOURS, figure_of_rows, saved
from fem_lie.pictures.stage import Canvas, target_of
from fem_lie.pictures.units import Units

_LEAST = 1e-6  # of the largest density


def draw_error(
    body: Beam | Shell,
    frames: Array,
    squares: Array,
    path: str | os.PathLike[str],
    title: str,
    units: Units,
) -> None:
    """Draw squares of errors (m,) of a body with nodes at ``frames`` (n, 4, 3).

    Raises:
        ValueError: The name does not end in ``.png``.
    """
    target_of(path, ".png")
    if isinstance(body, Beam):
        _over_arc(body, np.sqrt(squares / body.lengths), path, title, units)
    else:
        _in_colours(body, frames, squares, path, title, units)


def _over_arc(
    beam: Beam, density: Array, path: str | os.PathLike[str], title: str, units: Units
) -> None:
    figure, (axes,) = figure_of_rows(1, title, units)
    chains, start = beam.chains, 0.0
    for number, cells in enumerate(np.split(chains.order, chains.first[1:])):
        arc = start + chains.arc[cells]
        axes.plot(arc.ravel(), np.repeat(density[cells], 2), color=COLOURS[number % len(COLOURS)])
        start = float(arc.max())
    axes.set_ylabel(f"error [√({units.energy}/{units.length})]")
    axes.set_xlabel(f"arc length [{units.length}]")
    saved(figure, path)


def _in_colours(
    shell: Shell,
    frames: Array,
    squares: Array,
    path: str | os.PathLike[str],
    title: str,
    units: Units,
) -> None:
    mesh = shell.own_mesh
    m, k = mesh.cells.shape
    density = np.sqrt(squares / shell.areas().sum(axis=1))
    # torn apart, so that each cell has one colour, and its edges are seen
    points = frames[mesh.cells, 0].reshape(m * k, 3)
    surface = DrawnSurface(mesh, np.arange(m * k).reshape(m, k), points)
    # over powers of ten, as errors are; nothing is drawn as the least of them
    least = _LEAST * float(density.max()) or 1.0
    values = np.repeat(np.log10(np.maximum(density, least)), k)
    label = f"log₁₀ error [√{units.energy}/{units.length}]"
    draw_values(path, surface, points, values, label, Canvas(title, units))
