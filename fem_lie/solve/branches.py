"""From a bifurcation onto the path that crosses there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fem_lie._jit import Array
from fem_lie.buckling_modes import chosen
from fem_lie.scene import Scene
from fem_lie.solve.arc_length import ArcLength
from fem_lie.solve.controls import Along, Arc
from fem_lie.solve.follow import check_proportion
from fem_lie.solve.linear import ConvergenceError
from fem_lie.solve.path_result import CriticalPoint
from fem_lie.solve.stability import StableEquilibrium
from fem_lie.solve.walk import LostError, Station, Walker

_AMPLITUDE = 0.005  # of the diameter
_CHANGE = 0.05  # of the load factor, where the other path goes on with the load
_HALVINGS = 12


def branch(
    scene: Scene,
    critical: CriticalPoint,
    *,
    mode: int = 1,
    side: int = 1,
    amplitude: float | None = None,
    petsc_options_prefix: str = "fem_lie_path_",
) -> Station:
    """A state on the path that crosses at a bifurcation, to begin with there.

    The bifurcation is left along a critical mode, and the amplitude of that mode is held while
    equilibrium and load factor are found: ``fl.follow_path(scene, start=fl.branch(scene, point))``.

    Where the path itself is one that branches off there, and its load turns without a pivot, the
    other path goes on with the load: it is entered along the response of what the mode leaves.

    Args:
        scene: That of the path.
        critical: The bifurcation.
        mode: Which critical mode, counted from 1; more than the first matter where several
            coincide.
        side: 1 along the mode, −1 against it.
        amplitude: Largest displacement of the mode; default: 0.005 of the model, less if there is
            no such state.
        petsc_options_prefix: Prefix for the choice of the linear solver.

    Raises:
        ValueError: Bad scene or options, no such mode, a mode without displacements, or a
            bifurcation of another scene.
        ConvergenceError: There is no equilibrium with any amplitude down to 1e-5 of the model.
    """
    check_proportion(scene)
    if side not in (-1, 1) or (amplitude is not None and not amplitude > 0):
        raise ValueError(
            f"wanted side 1 or −1 and an amplitude > 0, got {side!r} and {amplitude!r}"
        )
    shape = chosen(critical.shapes, mode)
    model = StableEquilibrium(scene, petsc_options_prefix)
    station, leaders = critical.station, model.system.numbering.attachment.leaders
    if len(critical.frames) != model.system.numbering.total:
        raise ValueError(
            f"the bifurcation is one of a scene with {len(critical.frames)} nodes, this one has "
            f"{model.system.numbering.total}"
        )
    model.restore(station.state)
    h: Array = np.zeros(model.system.size)
    h[: 6 * len(leaders)] = shape[leaders].ravel()
    size = _AMPLITUDE * model.diameter
    if critical.crossed:
        h, size = _beside(model, station, h)
    u = model.translations(h)
    square = float(np.sum(u * u))
    if not square > 1e-12 * len(leaders):
        raise ValueError(f"mode {mode} has no displacements; it turns only")
    walker = Walker(model, ArcLength(), max(abs(station.factor), 1e-3))
    arc, control = Arc(0.1 * model.diameter, walker.load), Along(np.asarray(u / square), 1.0)
    size = side * (size if amplitude is None else amplitude)
    for _ in range(1 if amplitude is not None else _HALVINGS):
        model.restore(station.state)
        model.move(size * h)
        beside = replace(station, state=model.state())
        try:
            return walker.step(station, control, size, arc, begin=beside)
        except LostError:
            size /= 2
    raise ConvergenceError(
        f"no equilibrium beside the {critical.kind.value} at load factor {critical.factor:g} with "
        f"an amplitude of mode {mode} down to {abs(2 * size):.1e}"
    )


def _beside(model: StableEquilibrium, station: Station, h: Array) -> tuple[Array, float]:
    """Response to the load without its part along a mode, and the first step along it.

    Its largest displacement is 1.
    """
    weight = np.zeros(len(h))
    weight[: len(model.weight)] = 1.0 / model.weight**2
    rest = station.response - h * float((h * weight) @ station.response) / float((h * weight) @ h)
    largest = float(np.linalg.norm(model.translations(rest), axis=1).max())
    return np.asarray(rest / largest), _CHANGE * largest
