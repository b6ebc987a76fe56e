"""Branch switching: from a bifurcation onto the crossing path."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fem_lie._arrays import Array, instance, number
from fem_lie.linear.direct import ConvergenceError
from fem_lie.parts.part_scene import divided
from fem_lie.ranks.together import all_stay
from fem_lie.results.gathering import of_part
from fem_lie.results.path import CriticalPoint, Station
from fem_lie.scene import Scene
from fem_lie.solve.stability.equilibrium import StableEquilibrium
from fem_lie.solve.stability.path_options import Along, Arc
from fem_lie.solve.stability.path_step import LostError, Walker
from fem_lie.solve.stability.stations import own_station, whole_station
from fem_lie.solve.statics.arc_length import ArcLength, Dot
from fem_lie.solve.statics.follow import check_proportion

_AMPLITUDE = 0.005  # over the size of the body that moves most
_TURN = 1 / 60  # rad, largest rotation
_REACH = 20.0  # amplitudes: length scale of displacements in the search
_NIL = 1e-5  # over the largest displacement of a mode
_CHANGE = 0.05  # of the load factor, if the other path continues with the load
_HALVINGS = 12
_BESIDE = 0.2  # over the step: a state nearer to the tangent is on the same path


@all_stay("a change to a branch")
def switch_branch(
    scene: Scene,
    critical: CriticalPoint,
    *,
    mode: int = 1,
    side: int = 1,
    amplitude: float | None = None,
    petsc_options_prefix: str = "fem_lie_path_",
) -> Station:
    """A state on the path that crosses at a bifurcation, as the start of that path.

    The bifurcation is left along a critical mode; equilibrium and load factor are computed with a
    fixed amplitude of that mode:
    ``fl.follow_path(scene, start=fl.stability.switch_branch(scene, point))``. If the given path is
    itself a branch whose load turns there without a change of pivots, the other path continues with
    the load: it is entered along the response to the load without its part along the mode.

    Args:
        scene: The scene of the path.
        critical: The bifurcation.
        mode: Number of the critical mode, counted from 1; more than the first matter if several
            coincide.
        side: 1 along the mode, −1 against it.
        amplitude: Largest displacement of the mode; default: 0.005 of the body that moves most,
            with rotations of at most 1/60 rad, and less if there is no such state.
        petsc_options_prefix: Prefix for the choice of the linear solver.

    Raises:
        ValueError: Invalid scene or options, no such mode, a mode of rotations only, or a
            bifurcation of another scene.
        ConvergenceError: There is no equilibrium with the amplitude, or with any down to 1/2000 of
            the default, or only those of the given path.
    """
    check_proportion(scene)
    instance(critical, CriticalPoint, "critical", "a critical point of a path")
    if amplitude is not None:
        number(amplitude, "amplitude")
    if side not in (-1, 1) or (amplitude is not None and not amplitude > 0):
        raise ValueError(
            f"expected side 1 or −1 and an amplitude > 0, got {side!r} and {amplitude!r}"
        )
    shape = critical.displacing_shape(mode)
    nodes = sum(len(body.frames) for body in scene.bodies)
    if len(critical.frames) != nodes:
        raise ValueError(
            f"the bifurcation is one of a scene with {len(critical.frames)} nodes, this one has "
            f"{nodes}"
        )
    part = divided(scene, petsc_options_prefix)
    model = StableEquilibrium(scene, petsc_options_prefix, part)
    walker = Walker(model, ArcLength(), abs(critical.station.factor) or 1.0)
    station, unknowns = own_station(walker, critical.station), model.equations.unknowns
    own = of_part(shape[np.newaxis], critical.info, part, unknowns.bodies)[0]
    model.restore(station.state)
    h: Array = np.zeros(unknowns.size)
    h[: 6 * unknowns.moving] = own[unknowns.masters].ravel()
    size = _first_amplitude(scene, critical, shape)
    if critical.crossed:
        h, size = _step_off_the_path(model, station, h)
    u = model.translations(h)
    if not model.maximum(u) > _NIL:
        raise ValueError(f"mode {mode} moves only nodes that are attached rigidly to others")
    pattern: Array = np.asarray(u / model.dot(u, u))
    size = side * (size if amplitude is None else amplitude)
    returned = False
    for _ in range(1 if amplitude is not None else _HALVINGS):
        model.restore(station.state)
        model.move(size * h)
        displaced, unit = replace(station, state=model.state()), _REACH * abs(size)
        arc, control = Arc(unit, walker.load, model.dot), Along(pattern, unit, model)
        try:
            found = walker.step(station, control, size / unit, arc, begin=displaced)
        except LostError:
            size /= 2
            continue
        if not _on_path(station, found, model.dot):
            return whole_station(model, found)
        returned, size = True, size / 2
    if returned:
        raise ConvergenceError(
            f"at load factor {critical.factor:g} mode {mode} leads back onto its own path, "
            "and no other path crosses there along it"
        )
    raise ConvergenceError(
        f"no equilibrium beside the {critical.kind.value} at load factor {critical.factor:g} with "
        f"an amplitude of mode {mode} down to {abs(2 * size):.1e}"
    )


def _on_path(station: Station, found: Station, dot: Dot) -> bool:
    """Whether a state lies on the path through another one, as far as its tangent shows."""
    moved = found.positions - station.positions
    across = moved - (found.factor - station.factor) * station.velocity
    return dot(across, across) < _BESIDE**2 * dot(moved, moved)


def _first_amplitude(scene: Scene, critical: CriticalPoint, shape: Array) -> float:
    """Initial largest displacement of a mode."""
    node = int(np.linalg.norm(shape[:, :3], axis=1).argmax())
    label = next(body.name for body in critical.info.bodies if node in body.nodes)
    size = next(body.model.size for body in scene.bodies if body.name == label)
    turn = float(np.linalg.norm(shape[:, 3:], axis=1).max())
    return min(_AMPLITUDE * size, _TURN / turn if turn > 0 else np.inf)


def _step_off_the_path(model: StableEquilibrium, station: Station, h: Array) -> tuple[Array, float]:
    """Response to the load without its part along a mode, and the first step along it.

    Its largest displacement is 1.
    """
    mode = model.twists(h)
    along = model.dot(mode, model.twists(station.response)) / model.dot(mode, mode)
    rest = station.response - along * h
    largest = model.maximum(np.linalg.norm(model.translations(rest), axis=1))
    return np.asarray(rest / largest), _CHANGE * largest
