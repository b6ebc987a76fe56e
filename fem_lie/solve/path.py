"""Whole paths of equilibrium: through limit points, snap-through and snap-back, with stability.

Every state is polished, and the steps are those of the wanted resolution: along the path in the
plane of load and displacement, and in its bends, where successive tangents keep a small angle. The
scale of displacements is what the path has seen so far. All defaults are meant to be kept.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from math import acos, inf, sqrt
from time import perf_counter

import numpy as np

from fem_lie.scene import Scene
from fem_lie.solve.arc_length import ArcLength
from fem_lie.solve.controls import Arc, Control, DisplacementControl, Load, LoadControl
from fem_lie.solve.follow import _check
from fem_lie.solve.locate import Bracket, bisect, critical, hidden
from fem_lie.solve.path_result import (
    Critical,
    CriticalPoint,
    EquilibriumPath,
    PathState,
)
from fem_lie.solve.rotation import Rotation
from fem_lie.solve.stability import StableEquilibrium
from fem_lie.solve.walk import LostError, Station, Walker

Observer = Callable[[PathState], float]

_SCALE = 0.1  # of the diameter: displacements below are small, whatever the path has seen
_BEGIN = 0.25  # of the resolution: the first step
_TURN = 0.35  # rad: wanted angle between successive tangents
_SHARP = 1.0  # rad: larger angles are not accepted …
_CORNER = 1 / 64  # … unless steps are as short as this, over the resolution
_AHEAD = 0.2  # cosine between the tangent and the way of a step: never less
_SMALLEST = 1e-4  # of the resolution: shorter steps are given up
_MODES = 2


@dataclass(frozen=True)
class _Ends:
    """Where a path ends, as far as it was asked for."""

    until: float | None
    low: float
    high: float
    stop: Observer | None
    steps: int
    critical: int | None


def follow_path(
    scene: Scene,
    until: float | None = None,
    *,
    resolution: float = 0.05,
    steps: int = 300,
    load_range: tuple[float, float] = (-inf, inf),
    stop: Observer | None = None,
    critical_points: int | None = None,
    observe: Mapping[str, Observer] | None = None,
    control: DisplacementControl | LoadControl | None = None,
    start: Station | None = None,
    backwards: bool = False,
    locate: float | None = 1e-6,
    carried_stress: bool = True,
    options: ArcLength | None = None,
    petsc_options_prefix: str = "fem_lie_path_",
) -> EquilibriumPath:
    """Follow the path of equilibrium of a scene, and tell where it is stable.

    All loads, and gravity, grow in proportion to the load factor. A path that cannot go on returns
    what it has; ``reason`` says why.

    Args:
        scene: What there is.
        until: Load factor at which the path ends, when it gets there; default: 1, or none if there
            is a ``stop`` or a displacement to go to.
        resolution: Largest step over the range of loads and displacements.
        steps: At most so many.
        load_range: The path ends where it leaves these load factors.
        stop: Function of the state; the path ends where it becomes positive.
        critical_points: The path ends when so many limit points and bifurcations are found.
        observe: Functions of the state that are recorded, with their names.
        control: Steps of displacement or load; default: of arc length.
        start: State to begin with, of a path of this scene; default: unloaded.
        backwards: Go the other way.
        locate: Relative tolerance of the load at limit points and bifurcations, or ``None`` to
            leave them between the states.
        carried_stress: Carry the stress as an iterate; otherwise plain Newton.
        options: Tolerance and largest number of iterations.
        petsc_options_prefix: Prefix for the choice of the linear solver.

    Raises:
        ValueError: Bad scene or options, no load, loads that are not in proportion to the load
            factor, a start outside of the range or with a singular tangent.
    """
    _check(scene)
    if until is None and stop is None and not isinstance(control, DisplacementControl):
        until = 1.0
    ends = _Ends(until, *load_range, stop, steps, critical_points)
    _check_options(ends, resolution, locate, start, control)
    model = StableEquilibrium(scene, petsc_options_prefix, carried_stress=carried_stress)
    load = abs(until) if until else 1.0
    walker = Walker(model, ArcLength() if options is None else options, load)
    begin = perf_counter()
    follower = _Follower(walker, ends, resolution, locate, control)
    follower.run(start, backwards)
    return follower.result(observe or {}, perf_counter() - begin)


def _check_options(
    ends: _Ends,
    resolution: float,
    locate: float | None,
    start: Station | None,
    control: DisplacementControl | LoadControl | None,
) -> None:
    if not 0 < resolution <= 1 or ends.steps < 1:
        raise ValueError(
            f"wanted 0 < resolution ≤ 1 and steps ≥ 1, got {resolution!r} and {ends.steps!r}"
        )
    if ends.critical is not None and (ends.critical < 1 or locate is None):
        raise ValueError(
            f"critical_points must be 1 or more, and located, got {ends.critical!r} and "
            f"locate={locate!r}"
        )
    if locate is not None and not 0 < locate < 1:
        raise ValueError(f"locate must be a relative tolerance between 0 and 1, got {locate!r}")
    factor = 0.0 if start is None else start.factor
    if not ends.low < ends.high or not ends.low <= factor <= ends.high:
        raise ValueError(
            f"the path leaves the range of load factors where it begins: {factor:g} is not in "
            f"{(ends.low, ends.high)}"
        )
    if ends.until is not None and (not np.isfinite(ends.until) or ends.until == factor):
        raise ValueError(
            f"the load factor at which the path ends must be finite and not where it begins, got "
            f"{ends.until!r}"
        )
    if isinstance(control, DisplacementControl):
        control.check()


@dataclass
class _Record:
    """What has been found."""

    stations: list[Station] = field(default_factory=list)
    critical: list[tuple[Bracket, int]] = field(default_factory=list)
    failed_steps: int = 0
    failed_iterations: int = 0
    locating: int = 0
    complete: bool = False
    reason: str = ""


class _Follower:
    """One run."""

    def __init__(
        self,
        walker: Walker,
        ends: _Ends,
        resolution: float,
        locate: float | None,
        control: DisplacementControl | LoadControl | None,
    ) -> None:
        self._walker, self._model, self._ends = walker, walker.model, ends
        self._resolution, self._locate = resolution, locate
        system = self._model.system
        self._attachment, self._info = system.numbering.attachment, system.info()
        self._initial = self._attachment.frames(system.frames).copy()
        self._places = system.frames[: system.count, 0].copy()
        self._scale = _SCALE * self._model.diameter
        self._fixed: Control | None = None
        self._to = inf
        if isinstance(control, DisplacementControl):
            node = system.numbering.node(control.point)
            self._fixed, self._to = control.along(system.count, node), 1.0
        elif isinstance(control, LoadControl):
            self._fixed = Load(walker.load)
        self._found = _Record()

    def run(self, start: Station | None, backwards: bool) -> None:
        """Step until an end is reached."""
        if start is not None and start.places.shape != self._places.shape:
            raise ValueError(
                f"start=... must be a state of this scene with {len(self._places)} nodes, got "
                f"{len(start.places)}"
            )
        here = self._begin(start, backwards)
        found, length = self._found, _BEGIN * self._resolution
        found.stations.append(here)
        count = 0
        while not found.reason:
            if count == self._ends.steps:
                found.reason = f"the largest number of steps, {count}, is reached"
                break
            arc = self._arc(here)
            length = min(length, self._room(here))
            new = self._step(here, arc, length)
            if new is None:
                length /= 2
                if length < _SMALLEST * self._resolution:
                    found.reason = (
                        f"steps of {2 * length:.1e} still fail beyond load factor {here.factor:g}"
                    )
                continue
            count += 1
            used = length
            length = min(self._resolution, used * self._growth(here, new, arc))
            whole = Bracket(here, self._control(arc), arc, (0.0, used), (here, new))
            here = self._accept(whole)
            if self._ends.critical is not None and len(found.critical) >= self._ends.critical:
                found.complete = True
                found.reason = f"{len(found.critical)} critical points are found"

    def _begin(self, start: Station | None, backwards: bool) -> Station:
        model, ends = self._model, self._ends
        if start is None:
            model.check_start(0.0)
            first = self._walker.start(0.0, -1.0 if (ends.until or 1.0) < 0 else 1.0)
        else:
            model.restore(start.state)
            model.check_start(start.factor)
            first = start
        if self._fixed is not None and not isinstance(self._fixed, Load):
            first = replace(first, sign=float(np.sign(self._fixed.rate(first.velocity, 1.0))))
        return replace(first, sign=-first.sign, iterations=0) if backwards else first

    def _arc(self, here: Station) -> Arc:
        """The metric of a step: displacements over the largest so far."""
        moved = here.places - self._places
        self._scale = max(self._scale, sqrt(float(np.sum(moved * moved)) / len(moved)))
        return Arc(self._scale, self._walker.load)

    def _control(self, arc: Arc) -> Control:
        return arc if self._fixed is None else self._fixed

    def _room(self, here: Station) -> float:
        """Length that is left to the wanted displacement."""
        if self._to == inf or self._fixed is None:
            return inf
        return self._to - self._fixed.distance(here.places - self._places, 0.0)

    def _step(self, here: Station, arc: Arc, length: float) -> Station | None:
        """The next state, or ``None`` if there is none or the path bends too much."""
        try:
            new = self._walker.step(here, self._control(arc), length, arc)
        except LostError as error:
            self._found.failed_steps += 1
            self._found.failed_iterations += error.iterations + 1
            return None
        if self._fixed is None and self._bends(here, new, arc, length):
            self._found.failed_steps += 1
            self._found.failed_iterations += new.iterations
            return None
        return new

    def _bends(self, here: Station, new: Station, arc: Arc, length: float) -> bool:
        """Whether a step bends too much; backwards is too much however short it is."""
        way = new.places - here.places, new.factor - here.factor
        ahead = arc.inner(*way, *here.direction(arc)) / arc.norm(*way)
        short = length <= _CORNER * self._resolution
        return ahead < _AHEAD or not (short or self._angle(here, new, arc) <= _SHARP)

    def _angle(self, here: Station, new: Station, arc: Arc) -> float:
        """Between two tangents, or a tangent and the way between the states."""
        way = new.places - here.places, new.factor - here.factor
        unit = arc.norm(*way)
        ends = [here.direction(arc), new.direction(arc)]
        cosines = [arc.inner(*ends[0], *ends[1])]
        cosines += [arc.inner(*way, *end) / unit for end in ends]
        return acos(max(-1.0, min(1.0, min(cosines))))

    def _growth(self, here: Station, new: Station, arc: Arc) -> float:
        growth = sqrt(self._walker.options.good_iterations / new.iterations)
        if self._fixed is None:
            growth = min(growth, _TURN / max(self._angle(here, new, arc), 1e-3))
        return min(2.0, max(0.5, growth))

    def _accept(self, whole: Bracket) -> Station:
        """Keep the end of a step, and what happens on the way; or where the path ends in it."""
        found, before = self._found, self._walker.iterations
        stations = found.stations
        whole = self._ended(whole)
        if self._locate is not None:
            self._look_between(whole, self._locate)
        found.locating += self._walker.iterations - before
        stations.append(whole.ends[1])
        return stations[-1]

    def _look_between(self, whole: Bracket, tolerance: float) -> None:
        """Keep the critical points of a step, and the states that were made to find them."""
        found, (here, new) = self._found, whole.ends
        between = hidden(self._walker, whole)
        places = [whole.at[0], *(at for at, _ in between), whole.at[1]]
        states = [here, *(station for _, station in between), new]
        for k, state in enumerate(states[1:]):
            part = replace(whole, at=(places[k], places[k + 1]), ends=(states[k], state))
            for bracket in critical(self._walker, part, tolerance):
                if bracket.ends[0] is not states[k]:
                    found.stations.append(replace(bracket.ends[0], iterations=0))
                found.critical.append((bracket, len(found.stations) - 1))
            if state is not new:
                found.stations.append(replace(state, iterations=0))

    def _ended(self, whole: Bracket) -> Bracket:
        """The part of a step up to the end of the path, if that is in it."""
        ends, found, (here, new) = self._ends, self._found, whole.ends
        levels = [(ends.until, True), (ends.low, False), (ends.high, False)]
        for level, wanted in levels:
            if level is None or not np.isfinite(level) or here.factor == level:
                continue
            if (here.factor - level) * (new.factor - level) <= 0.0:
                found.complete = wanted
                found.reason = f"the load factor {level:g} is reached"
                if not wanted:
                    found.reason = f"the path leaves the range of load factors at {level:g}"
                return self._at_level(whole, level)
        stop = ends.stop
        if stop is not None and stop(self._observed(new)) > 0.0 >= stop(self._observed(here)):
            found.complete, found.reason = True, "the wanted state is reached"
            return bisect(
                self._walker,
                whole,
                lambda station: stop(self._observed(station)) <= 0.0,
                lambda station: stop(self._observed(station)),
                1e-9,
            )
        if self._to < inf and self._room(new) <= 1e-9:
            found.complete, found.reason = True, "the wanted displacement is reached"
        return whole

    def _at_level(self, whole: Bracket, level: float) -> Bracket:
        """The part of a step up to a load factor."""
        walker, (here, _) = self._walker, whole.ends
        side = np.sign(here.factor - level)
        narrow = bisect(
            walker,
            whole,
            lambda station: np.sign(station.factor - level) == side,
            lambda station: station.factor - level,
            1e-3,
        )
        near = narrow.ends[1]
        control, length = Load(walker.load), abs(level - here.factor) / walker.load
        try:
            last = walker.step(here, control, length, whole.arc, begin=near)
        except LostError:
            last = near
        else:
            last = replace(last, factor=level, iterations=near.iterations)
        return replace(narrow, at=(0.0, narrow.at[1]), ends=(here, last))

    def _observed(self, station: Station) -> PathState:
        frames = self._attachment.frames(station.state.frames).copy()
        return PathState(station.factor, frames, self._initial, station.negative, self._info)

    def result(self, observe: Mapping[str, Observer], seconds: float) -> EquilibriumPath:
        """What was found."""
        found, model = self._found, self._model
        states = [self._observed(station) for station in found.stations]
        forces = [
            model.system.joint_forces(s.state.frames, s.state.multipliers) for s in found.stations
        ]
        observed = {
            name: np.array([function(state) for state in states], dtype=np.float64)
            for name, function in observe.items()
        }
        return EquilibriumPath(
            factors=np.array([state.factor for state in states]),
            frames=np.array([state.frames for state in states]),
            joint_forces=np.array(forces).reshape(
                len(states), len(model.system.connections.items), 6
            ),
            iterations=np.array([s.iterations for s in found.stations], dtype=np.int64),
            failed_iterations=found.failed_iterations,
            info=self._info,
            initial=self._initial,
            steady_rotation=Rotation.of((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
            seconds=seconds,
            negative_pivots=np.array([s.negative for s in found.stations], dtype=np.int64),
            critical=tuple(self._critical(bracket, index) for bracket, index in found.critical),
            observed=observed,
            complete=found.complete,
            reason=found.reason,
            failed_steps=found.failed_steps,
            locating_iterations=found.locating,
            stations=tuple(found.stations),
        )

    def _critical(self, bracket: Bracket, index: int) -> CriticalPoint:
        """The modes at a critical point, and what kind it is."""
        model, (first, last) = self._model, bracket.ends
        model.restore(first.state)
        values, shapes = model.critical_modes(first.factor, _MODES, "fem_lie_path_modes_")
        # where a path crosses another one symmetrically its load turns, too, but no pivot does
        limit = first.sign != last.sign and first.negative != last.negative
        extremum = max if first.sign > 0 else min
        factors = first.factor, last.factor
        return CriticalPoint(
            kind=Critical.LIMIT if limit else Critical.BIFURCATION,
            factor=extremum(factors) if first.sign != last.sign else sum(factors) / 2,
            bracket=factors,
            negative_pivots=(first.negative, last.negative),
            eigenvalues=values,
            shapes=model.all_nodes(shapes),
            station=first,
            index=index,
            frames=self._attachment.frames(first.state.frames).copy(),
            info=self._info,
        )
