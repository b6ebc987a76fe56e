"""Pictures of errors: densities over arc length, or in the colours of cells."""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.shells.shell import Shell
from fem_lie.bodies.thin_shells.thin_shell import ThinShell
from fem_lie.elements.thin_shells import hermite
from fem_lie.pictures.contours import DrawnSurface, draw_values
from fem_lie.pictures.diagrams import COLOURS, figure_of_rows, saved
from fem_lie.pictures.stage import Canvas, target_of
from fem_lie.pictures.units import Units
from fem_lie.pictures.vtk_grids import CellKind


@dataclass(frozen=True)
class _Quadrilateral:
    """Pieces of cells of thin shells."""

    cell: str = "quadrilateral"
    degree: int = 1


_LEAST = 1e-6  # of the largest density
_PIECES = 8  # of a cell of a thin shell, in either direction


def draw_error(
    body: Beam | Shell | ThinShell,
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
    shell: Shell | ThinShell,
    frames: Array,
    squares: Array,
    path: str | os.PathLike[str],
    title: str,
    units: Units,
) -> None:
    # torn apart, so that each cell has one colour, and its edges are seen
    if isinstance(shell, ThinShell):
        kind: CellKind = _Quadrilateral()
        areas = shell.on_cells().weights.sum(axis=1)
        places, pieces = _curved(shell, frames)
    else:
        kind, areas = shell.own_mesh, shell.areas().sum(axis=1)
        places = frames[shell.own_mesh.cells, 0]
        pieces = np.arange(places.shape[1])[np.newaxis]
    m, k, _ = places.shape
    density = np.sqrt(squares / areas)
    points = places.reshape(m * k, 3)
    cells = k * np.arange(m)[:, np.newaxis, np.newaxis] + pieces
    surface = DrawnSurface(kind, cells.reshape(-1, cells.shape[2]), points)
    # over powers of ten, as errors are; nothing is drawn as the least of them
    least = _LEAST * float(density.max()) or 1.0
    values = np.repeat(np.log10(np.maximum(density, least)), k)
    label = f"log₁₀ error [√{units.energy}/{units.length}]"
    draw_values(path, surface, points, values, label, Canvas(title, units))


def _curved(shell: ThinShell, frames: Array) -> tuple[Array, Indices]:
    """Places in each cell (m, p, 3), so many that edges of cells of several sizes meet; pieces."""
    x: Array = np.arange(_PIECES + 1.0) / _PIECES
    table = hermite.table(hermite.products(x, x))[:, hermite.VALUE]
    places = np.einsum("ga,maj->mgj", table, shell.vectors(frames))
    number = np.arange(len(table)).reshape(len(x), len(x))
    corners = number[:-1, :-1], number[1:, :-1], number[:-1, 1:], number[1:, 1:]
    return places, np.stack(corners, axis=-1).reshape(-1, 4)
