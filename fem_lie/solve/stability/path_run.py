"""A path analysis: step lengths, events within steps, and end conditions.

Step lengths follow the requested resolution: along the path in the plane of load and displacement,
and in its bends, where successive tangents keep a small angle. The scale of displacements is the
largest one on the path so far.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import acos, inf, sqrt

import numpy as np

from fem_lie.forms.abilities import PassedThroughError
from fem_lie.results.path import PathState, Station
from fem_lie.solve.progress_bars import Advance, step_bar
from fem_lie.solve.stability.locate import Bracket, bisect, critical
from fem_lie.solve.stability.path_options import (
    Arc,
    Control,
    DisplacementControl,
    Load,
    LoadControl,
    PathEnds,
)
from fem_lie.solve.stability.path_step import FoldedStepError, LostError, Walker
from fem_lie.solve.stability.stations import own_station
from fem_lie.solve.statics.arc_length import rms

_SCALE = 0.1  # over the diameter: smaller displacements are small, whatever the path so far
_BEGIN = 0.25  # over the resolution: first step
_TURN = 0.35  # rad: target angle between successive tangents
_SHARP = 1.0  # rad: larger angles are not accepted …
_CORNER = 1 / 64  # … unless steps are this short, over the resolution
_FLAT = 0.8  # over the smaller rate of the load at the ends of a step: least rate in between
_AHEAD = 0.2  # least cosine between the tangent and the chord of a step
_SMALLEST = 1e-4  # over the resolution: shortest step


@dataclass
class Record:
    """States and events of a path so far."""

    stations: list[Station] = field(default_factory=list)
    critical: list[tuple[Bracket, int]] = field(default_factory=list)
    load_steps: int = 0
    failed_steps: int = 0
    failed_iterations: int = 0
    locating: int = 0
    complete: bool = False
    at_factor: bool = False
    reason: str = ""


class Pursuit:
    """One path analysis.

    Attributes:
        model: The loaded scene.
        info: Bodies and joints.
        found: States and events so far.
    """

    def __init__(
        self,
        walker: Walker,
        ends: PathEnds,
        resolution: float,
        locate: float | None,
        control: DisplacementControl | LoadControl | None,
    ) -> None:
        """Set up; the model is unloaded."""
        self._walker, self.model, self._ends = walker, walker.model, ends
        self._resolution, self._locate = resolution, locate
        equations, unknowns = self.model.equations, self.model.equations.unknowns
        unloaded, placed = equations.start.unloaded, self.model.placed
        self.info = self.model.whole.info
        self._positions = unloaded[: unknowns.moving, 0][placed]
        self._scale = _SCALE * self.model.diameter
        self._fixed: Control | None = None
        self._to, self._passed = inf, ""
        if isinstance(control, DisplacementControl):
            node = self.model.placed_node(control.point)
            away = 0.0 if node is None else self._positions[node] - control.point.position
            gap = self.model.maximum(np.asarray(away))
            if gap > 1e-9 * unknowns.length:
                raise ValueError(
                    f"displacement control at {control.point.label}, which is attached to another "
                    f"node rigidly {gap:g} away: control that one"
                )
            self._control_label = f"displacement control at {control.point.label}"
            self._fixed, self._to = control.along(self.model, len(self._positions), node), 1.0
        elif isinstance(control, LoadControl):
            self._fixed = Load(walker.load)
        self.found = Record()

    def follow(self, start: Station | None, backwards: bool) -> None:
        """Make steps until an end condition is met."""
        here = self._begin(start, backwards)
        self.found.stations.append(here)
        with step_bar("path", "step") as show:
            self._follow(here, show)

    def _follow(self, here: Station, show: Advance) -> None:
        found, length = self.found, _BEGIN * self._resolution
        while not found.reason:
            if found.load_steps == self._ends.steps:
                found.reason = f"the largest number of steps, {found.load_steps}, is reached"
                break
            arc = self._arc(here)
            length = min(length, self._remaining_length(here))
            new = self._step(here, arc, length)
            if new is None:
                length /= 2
                if length < _SMALLEST * self._resolution:
                    found.reason = (
                        f"steps of {2 * length:.1e} still fail beyond load factor {here.factor:g}"
                        f"{self._hint(here)}"
                    )
                continue
            found.load_steps += 1
            if found.load_steps == 1 and (free := self._free_motions(new)):
                raise ValueError(f"the path has no start: {free}")
            used = length
            length = min(self._resolution, used * self._growth(here, new, arc))
            whole = Bracket.of_step(here, self._control(arc), arc, used, new)
            here = self._accept(whole)
            show(f"load factor {here.factor:.4g}, {here.negative} negative pivots")
            wanted = self._ends.critical_points
            if wanted is not None and len(found.critical) >= wanted:
                found.complete, found.at_factor = True, False
                count = len(found.critical)
                found.reason = f"{count} critical point{'s are' if count > 1 else ' is'} found"

    def _begin(self, start: Station | None, backwards: bool) -> Station:
        model, ends = self.model, self._ends
        if start is None:
            factor = model.begin()
            model.check_start(factor)
            first = self._walker.start(factor, -1.0 if (ends.factor or 1.0) < factor else 1.0)
        else:
            first = own_station(self._walker, start)
            model.restore(first.state)
            model.check_start(first.factor)
        if self._fixed is not None and not isinstance(self._fixed, Load):
            rate = self._fixed.rate(first.velocity, 1.0)
            if not np.isfinite(rate):
                raise ValueError(
                    f"{self._control_label}: the load does not move the point in that direction at "
                    "the start; control a displacement that the load causes"
                )
            first = replace(first, sign=float(np.sign(rate)))
        return replace(first, sign=-first.sign, iterations=0) if backwards else first

    def _free_motions(self, station: Station) -> str:
        """Message on rigid motions that nothing resists in a state, if there are any."""
        self.model.restore(station.state)
        return self.model.free_motions(station.factor)

    def _hint(self, here: Station) -> str:
        """Message on the state beyond which the path could not be continued."""
        self.model.restore(here.state)
        hint = self.model.rotation_hint()
        return f".{hint}" if hint else self._passed

    def _arc(self, here: Station) -> Arc:
        """Metric of a step: displacements over the largest ones so far."""
        moved = here.positions - self._positions
        self._scale = max(self._scale, rms(moved, self.model.dot))
        return Arc(self._scale, self._walker.load, self.model.dot)

    def _control(self, arc: Arc) -> Control:
        return arc if self._fixed is None else self._fixed

    def _remaining_length(self, here: Station) -> float:
        """Remaining length to the displacement target."""
        if self._to == inf or self._fixed is None:
            return inf
        return self._to - self._fixed.distance(here.positions - self._positions, 0.0)

    def _step(self, here: Station, arc: Arc, length: float) -> Station | None:
        """The next state, or ``None`` if there is none or the path bends too much."""
        try:
            new = self._walker.step(here, self._control(arc), length, arc)
        except FoldedStepError as error:
            self.found.reason = f"an element folds: {error.what}"
            self.found.failed_iterations += error.iterations + 1
            return None
        except LostError as error:
            self.found.failed_steps += 1
            self.found.failed_iterations += error.iterations + 1
            return None
        self._passed = ""
        try:
            self.model.check_passage(here.state)
        except PassedThroughError as error:
            self._passed = f". {error}"
            self.found.failed_steps += 1
            self.found.failed_iterations += new.iterations
            return None
        if self._fixed is None and self._bends(here, new, arc, length):
            self.found.failed_steps += 1
            self.found.failed_iterations += new.iterations
            return None
        return new

    def _bends(self, here: Station, new: Station, arc: Arc, length: float) -> bool:
        """Whether a step bends too much; reversed steps do, however short they are.

        If the load is much flatter between the states than at them, it may turn twice unnoticed.
        """
        way = new.positions - here.positions, new.factor - here.factor
        ahead = arc.inner(*way, *here.direction(arc)) / arc.norm(*way)
        short = length <= _CORNER * self._resolution
        rates = here.direction(arc)[1], new.direction(arc)[1]
        if rates[0] * rates[1] > 0 and here.negative == new.negative:
            least = _flattest(rates, way[1] / length) * np.sign(rates[0])
            if least < _FLAT * min(map(abs, rates)):
                return True
        return ahead < _AHEAD or not (short or self._angle(here, new, arc) <= _SHARP)

    def _angle(self, here: Station, new: Station, arc: Arc) -> float:
        """Angle between two tangents, or a tangent and the chord between the states."""
        way = new.positions - here.positions, new.factor - here.factor
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
        """Record the end of a step and its events, or the point at which the path ends in it."""
        found, before = self.found, self._walker.iterations
        stations = found.stations
        whole = self._ended(whole)
        if self._locate is not None:
            self._look_between(whole, self._locate)
        found.locating += self._walker.iterations - before
        stations.append(whole.ends[1])
        return stations[-1]

    def _look_between(self, whole: Bracket, tolerance: float) -> None:
        """Record the critical points of a step."""
        found = self.found
        for bracket in critical(self._walker, whole, tolerance):
            if bracket.ends[0] is not whole.origin:
                found.stations.append(replace(bracket.ends[0], iterations=0))
            found.critical.append((bracket, len(found.stations) - 1))

    def _ended(self, whole: Bracket) -> Bracket:
        """The part of a step up to the end of the path, if that is in it."""
        ends, found, (here, new) = self._ends, self.found, whole.ends
        low, high = ends.load_range
        levels = [(ends.factor, True), (low, False), (high, False)]
        for level, wanted in levels:
            if level is None or not np.isfinite(level) or here.factor == level:
                continue
            if (here.factor - level) * (new.factor - level) <= 0.0:
                found.complete = found.at_factor = wanted
                found.reason = f"the load factor {level:g} is reached"
                if not wanted:
                    found.reason = f"the path leaves the range of load factors at {level:g}"
                return self._at_level(whole, level)
        stop = ends.stop
        if stop is not None and stop(self.observed(new)) > 0.0 >= stop(self.observed(here)):
            found.complete, found.reason = True, "the requested state is reached"
            return bisect(
                self._walker,
                whole,
                lambda station: stop(self.observed(station)) <= 0.0,
                lambda station: stop(self.observed(station)),
                1e-9,
            )
        if self._to < inf and self._remaining_length(new) <= 1e-9:
            found.complete, found.reason = True, "the requested displacement is reached"
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

    def observed(self, station: Station) -> PathState:
        """A state as passed to user functions."""
        frames = self.model.frames(station.state.frames)
        return PathState(station.factor, frames, station.negative, self.info)


def _flattest(rates: tuple[float, float], mean: float) -> float:
    """Least derivative, in the sense of its end values, of a cubic with these rates and mean."""
    first, last = rates
    # the derivative is a parabola
    middle = 1.5 * mean - 0.25 * (first + last)
    curvature = 2.0 * (first + last) - 4.0 * middle
    ends = min(first, last, key=abs)
    if curvature == 0.0:
        return ends
    part = (3.0 * first + last - 4.0 * middle) / (2.0 * curvature)
    if not 0.0 < part < 1.0:
        return ends
    value = first + (4.0 * middle - 3.0 * first - last) * part + curvature * part**2
    return min(value, ends) if first > 0 else max(value, ends)
