"""Discretisation error in space of one state of a body, by elements, in the energy norm.

Of a shell, say::

    found = fl.adaptivity.space_error(result, shell, scene)
    print(found)                           # 3.1 % of the energy norm, in 256 cells
    found.elements, found.total            # square roots of energies
    found.worst(0.5)                       # the fewest elements with half of the error
    found.picture("error.png")

By default it is ``η² = ∫ (σ* − σ)·D⁻¹(σ* − σ)``: the difference of the stress resultants σ of the
elements and recovered ones σ*, which are more accurate by one order (O. C. Zienkiewicz & J. Z.
Zhu, IJNME 24 (1987) 337). Both are in local frames, in which neighbours can be compared for any
rotation of the body; so the estimate is valid in any state of statics, of a path and of dynamics.
Other estimates are :class:`~fem_lie.adaptivity.estimates.estimate.ErrorEstimate` objects, too.
"""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np

from fem_lie._arrays import Array, Indices, instance, number, positive
from fem_lie._summary import Summarised
from fem_lie.adaptivity.estimates.estimate import ErrorEstimate, Estimated
from fem_lie.adaptivity.estimates.lines import successive
from fem_lie.adaptivity.estimates.recovery import RecoveryEstimate
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.gradients.ancf_beam import AncfBeam
from fem_lie.bodies.gradients.ancf_shell import AncfShell
from fem_lie.bodies.rods.cable_body import CableBody
from fem_lie.bodies.shells.shell import Shell
from fem_lie.bodies.solids.solid import Solid
from fem_lie.bodies.thin_shells.thin_shell import ThinShell
from fem_lie.mesh.bicubic import hermite
from fem_lie.pictures.bodies import DrawnSurface, draw_values
from fem_lie.pictures.diagrams import COLOURS, figure_of_rows, saved
from fem_lie.pictures.stage import SI, Canvas, Units, target_of
from fem_lie.pictures.vtk import CellKind
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.history import Result
from fem_lie.results.states import nodes_in
from fem_lie.scene import Scene


@dataclass(frozen=True)
class _Quadrilateral:
    """Quadrilateral pieces of cells on smooth patches."""

    cell: str = "quadrilateral"
    degree: int = 1


_LEAST = 1e-6  # relative to the largest density
_PIECES = 8  # pieces of a cell on a smooth patch in either direction


def draw_error(
    body: Estimated,
    frames: Array,
    squares: Array,
    path: str | os.PathLike[str],
    title: str,
    units: Units,
) -> None:
    """Draw squared errors (m,) of a body with nodes at ``frames`` (n, 4, 3).

    Raises:
        ValueError: The name does not end in ``.png``.
    """
    target_of(path, ".png")
    match body:
        case Beam() | AncfBeam() | CableBody():
            _over_arc(body, np.sqrt(squares / body.model.lengths), path, title, units)
        case Solid():
            _on_boundary(body, frames, squares, path, title, units)
        case _:
            _in_colours(body, frames, squares, path, title, units)


def _over_arc(
    body: Beam | AncfBeam | CableBody,
    density: Array,
    path: str | os.PathLike[str],
    title: str,
    units: Units,
) -> None:
    figure, (axes,) = figure_of_rows(1, title, units)
    start = 0.0
    for k, (_, cells) in enumerate(successive(body)):
        ends = start + np.cumsum([0.0, *body.model.lengths[cells]])
        arc = np.repeat(ends, 2)[1:-1]
        axes.plot(arc, np.repeat(density[cells], 2), color=COLOURS[k % len(COLOURS)])
        start = float(ends[-1])
    axes.set_ylabel(f"error [√({units.energy}/{units.length})]")
    axes.set_xlabel(f"arc length [{units.length}]")
    saved(figure, path)


def _on_boundary(
    solid: Solid,
    frames: Array,
    squares: Array,
    path: str | os.PathLike[str],
    title: str,
    units: Units,
) -> None:
    """Means of the density over the cells at each node, on the boundary."""
    model, count = solid.model, len(frames)
    volumes = model.rule.volumes.sum(axis=1)
    each = np.ones(model.connectivity.shape[1])
    total, volume = (
        np.bincount(model.connectivity.ravel(), np.outer(of, each).ravel(), count)
        for of in (squares, volumes)
    )
    values, label = _colours(np.sqrt(total / volume), f"√({units.energy}/{units.length}³)")
    skin = model.boundary
    surface = DrawnSurface(skin, skin.nodes, model.positions)
    draw_values(path, surface, frames[:, 0], values, label, Canvas(title, units))


def _colours(density: Array, unit: str) -> tuple[Array, str]:
    """Logarithmic colours, in which zero is drawn as the least value; and their label."""
    least = _LEAST * float(density.max()) or 1.0
    return np.log10(np.maximum(density, least)), f"log₁₀ error [{unit}]"


def _in_colours(
    shell: Shell | ThinShell | AncfShell,
    frames: Array,
    squares: Array,
    path: str | os.PathLike[str],
    title: str,
    units: Units,
) -> None:
    # disconnected, so that each cell has one colour and visible edges
    if not isinstance(shell, Shell):
        kind: CellKind = _Quadrilateral()
        areas = shell.model.cell_quadrature().weights.sum(axis=1)
        positions, pieces = _curved(shell, frames)
    else:
        kind, areas = shell.model.cut_mesh, shell.model.areas().sum(axis=1)
        positions = frames[shell.model.cut_mesh.cells, 0]
        pieces = np.arange(positions.shape[1])[np.newaxis]
    m, k, _ = positions.shape
    density = np.sqrt(squares / areas)
    points = positions.reshape(m * k, 3)
    cells = k * np.arange(m)[:, np.newaxis, np.newaxis] + pieces
    surface = DrawnSurface(kind, cells.reshape(-1, cells.shape[2]), points)
    values, label = _colours(np.repeat(density, k), f"√{units.energy}/{units.length}")
    draw_values(path, surface, points, values, label, Canvas(title, units))


def _curved(shell: ThinShell | AncfShell, frames: Array) -> tuple[Array, Indices]:
    """Positions in each cell (m, p, 3), so that edges of cells of several sizes match; pieces."""
    x: Array = np.arange(_PIECES + 1.0) / _PIECES
    table = type(shell.model).table(hermite.products(x, x))[:, hermite.VALUE]
    positions = np.einsum("ga,maj->mgj", table, shell.model.hermite_vectors(frames))
    number = np.arange(len(table)).reshape(len(x), len(x))
    corners = number[:-1, :-1], number[1:, :-1], number[:-1, 1:], number[1:, 1:]
    return positions, np.stack(corners, axis=-1).reshape(-1, 4)


def space_error(
    result: Result | StaticResult,
    body: Estimated,
    scene: Scene,
    state: int = -1,
    *,
    estimate: ErrorEstimate | None = None,
) -> SpaceError:
    """Estimate the discretisation error in space of one state of a body.

    Args:
        result: Result of dynamics, of statics or of a path, of a scene with the body.
        body: A beam, shell, cable or solid; cables have elements of cubics.
        scene: The scene that was solved.
        state: Index of the state; default: the last.
        estimate: Error estimate; default:
            :class:`~fem_lie.adaptivity.estimates.recovery.RecoveryEstimate`.

    Raises:
        ValueError: The body is not in that scene or result, it or its elements are not supported by
            the estimate, or there is no such state.
    """
    instance(estimate, ErrorEstimate | None, "estimate", "a Recovery, a Residual or None")
    (found,) = (estimate or RecoveryEstimate()).errors(result, body, scene, [state])
    frames = result.frames[state][nodes_in(result.info, body)]
    return SpaceError(body, frames, found.squares, found.energy)


@dataclass(frozen=True, eq=False, repr=False)
class SpaceError(Summarised):
    """Estimated error of a body in one state; made by :func:`space_error`.

    Attributes:
        body: The body, of m elements.
        frames: Frames of its nodes in that state, shape (n, 4, 3).
        squares: Squared error of each element, an energy, shape (m,).
        energy: Squared norm of the stress, ``∫ σ·D⁻¹σ``: twice the elastic energy.
    """

    body: Estimated
    frames: Array
    squares: Array
    energy: float

    @property
    def elements(self) -> Array:
        """Error of each element, shape (m,)."""
        return np.sqrt(self.squares)

    @property
    def total(self) -> float:
        """Error of the body."""
        return float(np.sqrt(self.squares.sum()))

    @property
    def relative(self) -> float:
        """Error relative to the norm of the stress; 0 without strain."""
        return self.total / float(np.sqrt(self.energy)) if self.energy > 0 else 0.0

    def effectivity(self, error: float) -> float:
        """Effectivity index: estimated over exact error, ideally 1.

        Args:
            error: Exact error in the energy norm, as :attr:`total`.

        Raises:
            ValueError: The error is not positive.
        """
        return self.total / positive(error, "error")

    def worst(self, part: float = 0.5) -> Indices:
        """Numbers of the fewest elements with this fraction of the squared error, largest first.

        (W. Dörfler, SIAM J. Numer. Anal. 33 (1996) 1106.)

        Args:
            part: Fraction, above 0 and at most 1.

        Raises:
            ValueError: The fraction is out of range.
        """
        return worst(self.squares, part)

    def picture(self, path: str | os.PathLike[str], *, title: str = "", units: Units = SI) -> None:
        """Draw the error: along lines over arc length, else in colours.

        The density of the error is drawn, the square root of energy per length, area or volume, so
        that it does not depend on the sizes of elements.

        Args:
            path: Name of the ``.png`` file.
            title: Title of the picture; default: description of the error.
            units: Units of the axes.

        Raises:
            ValueError: The name does not end in ``.png``.
        """
        draw_error(self.body, self.frames, self.squares, path, title or str(self), units)

    def __str__(self) -> str:
        """One line."""
        return (
            f"error in space of {self.body.label}: {100 * self.relative:.2g} % of the energy norm, "
            f"{len(self.squares)} elements"
        )


def worst(squares: Array, part: float) -> Indices:
    """Indices of the largest of positive values that together have a fraction of the sum."""
    if not 0.0 < number(part, "part") <= 1.0:
        raise ValueError(f"part must be above 0 and at most 1, got {part!r}")
    order = np.argsort(-squares, kind="stable")
    total = np.cumsum(squares[order])
    count = int(np.searchsorted(total, part * total[-1] * (1 - 1e-12))) + 1
    return np.asarray(order[:count], dtype=np.int64)
