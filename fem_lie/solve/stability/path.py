"""Complete equilibrium paths: through limit points, snap-through and snap-back, with stability.

Every state is polished, limit points and bifurcations are located, and the number of negative
pivots is counted at each state. All defaults are meant for general use.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from fem_lie._arrays import instance, number
from fem_lie.linear.direct import ConvergenceError
from fem_lie.parts.part_scene import divided
from fem_lie.ranks.together import all_stay
from fem_lie.results.gathering import gathered
from fem_lie.results.path import CriticalPoint, CriticalPointType, EquilibriumPath, Station
from fem_lie.scene import Scene
from fem_lie.scene.rotation import Rotation
from fem_lie.solve.progress_bars import Stopwatch
from fem_lie.solve.stability.equilibrium import StableEquilibrium
from fem_lie.solve.stability.locate import Bracket
from fem_lie.solve.stability.path_options import (
    DisplacementControl,
    LoadControl,
    Observer,
    PathEnds,
    PathOptions,
)
from fem_lie.solve.stability.path_run import Pursuit
from fem_lie.solve.stability.path_step import Walker
from fem_lie.solve.stability.stations import whole_station
from fem_lie.solve.statics.follow import check_proportion, friction_in

_MODES = 2

_log = logging.getLogger(__name__)


@all_stay("an equilibrium path")
def follow_path(
    scene: Scene,
    until: float | PathEnds | None = None,
    *,
    resolution: float = 0.05,
    observe: Mapping[str, Observer] | None = None,
    control: DisplacementControl | LoadControl | None = None,
    start: Station | None = None,
    backwards: bool = False,
    options: PathOptions | None = None,
) -> EquilibriumPath:
    """Follow the equilibrium path of a scene and determine where it is stable.

    All loads, and gravity, grow in proportion to the load factor. If the path cannot be continued,
    the states so far are returned; ``reason`` says why.

    Args:
        scene: The scene.
        until: Load factor at which the path ends, or all conditions that end it. Default: 1, or
            none if there is a displacement target, or a ``stop`` condition. A limit load above it
            is not reached: for the snap of a structure under a unit load give ``until`` a load that
            it cannot bear.
        resolution: Largest step over the range of loads and displacements.
        observe: Functions of the state that are recorded, by name.
        control: Steps of displacement or load; default: of arc length.
        start: Initial state, from a path of this scene; default: unloaded.
        backwards: Follow the path in the other direction.
        options: Options of the computation.

    Raises:
        ValueError: Invalid scene or options, no load, loads that are not in proportion to the load
            factor, a start outside of the range or with a singular tangent stiffness.
    """
    check_proportion(scene)
    ends = until if isinstance(until, PathEnds) else PathEnds(until)
    options = PathOptions() if options is None else options
    chosen = ends.factor is None and ends.stop is None
    chosen = chosen and not isinstance(control, DisplacementControl)
    if chosen:
        ends = replace(ends, factor=1.0)
    _check_options(ends, resolution, options, start, control)
    prefix, linearised = options.petsc_options_prefix, options.linearised_stress
    part = divided(scene, prefix)
    model = StableEquilibrium(scene, prefix, part, linearised_stress=linearised)
    walker = Walker(model, options.arc_length, abs(ends.factor) if ends.factor else 1.0)
    watch = Stopwatch()
    run = Pursuit(walker, ends, resolution, options.locate, control)
    run.follow(start, backwards)
    if chosen and run.found.at_factor:
        run.found.reason += ", where paths end by default: until=... goes on beyond, to loads above"
        _log.info("%s", run.found.reason)
    return _result(run, observe or {}, watch.seconds)


def _check_options(
    ends: PathEnds,
    resolution: float,
    options: PathOptions,
    start: Station | None,
    control: DisplacementControl | LoadControl | None,
) -> None:
    instance(options, PathOptions, "options", "PathOptions or None")
    instance(control, DisplacementControl | LoadControl | None, "control", "a control or None")
    number(resolution, "resolution")
    if not 0 < resolution <= 1:
        raise ValueError(f"expected 0 < resolution ≤ 1, got {resolution!r}")
    if ends.critical_points is not None and options.locate is None:
        raise ValueError(f"critical_points={ends.critical_points} must be located, got locate=None")
    ends.check_start(start)
    if isinstance(control, DisplacementControl):
        control.check()


def _result(run: Pursuit, observe: Mapping[str, Observer], seconds: float) -> EquilibriumPath:
    """Result of the path so far."""
    found, model = run.found, run.model
    states = [run.observed(station) for station in found.stations]
    forces = [model.joint_forces(s.state) for s in found.stations]
    observed = {
        name: np.array([function(state) for state in states], dtype=np.float64)
        for name, function in observe.items()
    }
    equations = model.equations
    frames = [equations.report(station.state.frames).frames.copy() for station in found.stations]
    result = EquilibriumPath(
        factors=np.array([state.factor for state in states]),
        frames=np.array(frames),
        joint_forces=np.array(forces),
        reactions=np.array([model.reactions(s.state, s.factor) for s in found.stations]),
        iterations=np.cumsum([s.iterations for s in found.stations], dtype=np.int64),
        failed_iterations=found.failed_iterations,
        info=equations.info,
        steady_rotation=Rotation.of((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
        seconds=seconds,
        factorisations=model.factorisations,
        negative_pivots=np.array([s.negative for s in found.stations], dtype=np.int64),
        critical=tuple(_critical(run, bracket, index) for bracket, index in found.critical),
        observed=observed,
        complete=found.complete,
        reason=found.reason,
        load_steps=found.load_steps,
        failed_steps=found.failed_steps,
        friction=friction_in(equations, [s.state for s in found.stations]),
        locating_iterations=found.locating,
        stations=tuple(whole_station(model, station) for station in found.stations),
    )
    return gathered(result, equations.part)


def _critical(run: Pursuit, bracket: Bracket, index: int) -> CriticalPoint:
    """Modes at a critical point, and its type."""
    model, (first, last) = run.model, bracket.ends
    model.restore(first.state)
    try:
        values, shapes = model.critical_modes(first.factor, _MODES, "fem_lie_path_modes_")
    except ConvergenceError as error:
        _log.warning("the critical modes at load factor %g: %s", first.factor, error)
        values, shapes = np.empty(0), np.empty((0, model.equations.unknowns.moving, 6))
    moved, rotation_only = model.all_nodes(shapes)
    # where a path crosses another one symmetrically its load turns, too, but no pivot changes
    limit = first.sign != last.sign and first.negative != last.negative
    extremum = max if first.sign > 0 else min
    factors = first.factor, last.factor
    return CriticalPoint(
        kind=CriticalPointType.LIMIT if limit else CriticalPointType.BIFURCATION,
        factor=extremum(factors) if first.sign != last.sign else sum(factors) / 2,
        bracket=factors,
        negative_pivots=(first.negative, last.negative),
        has_potential=model.equations.unknowns.has_potential,
        eigenvalues=values,
        shapes=moved,
        rotation_only=rotation_only,
        station=whole_station(model, first),
        index=index,
        frames=model.frames(first.state.frames),
        info=run.info,
    )
