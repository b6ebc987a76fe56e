"""Location of events between two states of a path: limit points, bifurcations, requested values.

If the number of negative pivots or the direction of the load differ between two states, there is a
critical point between them. It is bracketed by these marks, which is robust, and approached by the
secant method for a function that is zero there: the rate of the load along the path at a limit
point, the smallest eigenvalue of the tangent stiffness at a bifurcation. (R. Seydel, Practical
Bifurcation and Stability Analysis, 2010, ch. 5.)

Close to a bifurcation the tangent stiffness is nearly singular, and residuals within the tolerance
leave a part of the critical mode in a state. The next state, if it started there, would converge to
the crossing path. All states are therefore computed from others whose smallest eigenvalue is not
small.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from fem_lie.results.path import Station
from fem_lie.solve.stability.path_options import Arc, Control
from fem_lie.solve.stability.path_step import LostError, Walker

_TRIALS = 60
_WIDTH = 1e-3  # over the step: accuracy at a load without slope
_SLOW = 3  # successive secants that do not halve the bracket, after which it is halved
_SINGULAR = 1e-2  # over the largest eigenvalue of the states of a step: start from none below

Mark = Callable[[Station], Any]
Value = Callable[[Station], float]


@dataclass(frozen=True, eq=False)
class Bracket:
    """Two states of a step with an event between them.

    Attributes:
        origin: Start of the step.
        control: Measure of distance.
        arc: Metric that determines the forward direction and the largest distance.
        at: Distances of the two states from the origin.
        ends: The states.
        known: All states of the step so far, with their distances; shared by its brackets.
    """

    origin: Station
    control: Control
    arc: Arc
    at: tuple[float, float]
    ends: tuple[Station, Station]
    known: list[tuple[float, Station]]

    @classmethod
    def of_step(
        cls, here: Station, control: Control, arc: Arc, length: float, new: Station
    ) -> Bracket:
        """The bracket of a whole step of that length, from ``here`` to ``new``."""
        known = [(0.0, here), (length, new)]
        return cls(here, control, arc, (0.0, length), (here, new), known)

    def nearest(self, at: float) -> Station:
        """The nearest state to a distance whose smallest eigenvalue, if known, is not small."""
        tests = [abs(station.test) for _, station in self.known]
        largest = np.fmax.reduce([0.0, *tests])
        regular = [
            (abs(distance - at), k)
            for k, (distance, _) in enumerate(self.known)
            if not tests[k] < _SINGULAR * largest
        ]
        return self.known[min(regular)[1]][1]


def critical(walker: Walker, whole: Bracket, tolerance: float) -> list[Bracket]:
    """All critical points of a step, each between two states; the load to ``tolerance``.

    Points at which the iteration does not converge are bracketed as closely as possible.
    """
    found: list[Bracket] = []
    first, last = whole.ends
    while _mark(first) != _mark(last):
        turning = first.sign != last.sign
        part = replace(whole, at=(_reached(whole, found), whole.at[1]), ends=(first, last))
        narrow = bisect(
            walker,
            part,
            partial(_same, _mark(first)),
            _rate(whole.arc) if turning else (lambda station: station.test),
            tolerance,
            probe=not turning,
        )
        found.append(narrow)
        first = narrow.ends[1]
    return _merged(found)


def _merged(found: list[Bracket]) -> list[Bracket]:
    """Merge touching brackets into one point.

    Due to round-off the load may turn slightly before or after the pivot; and if an eigenvalue
    touches zero without changing its sign, the pivot may appear to change twice.
    """
    kept: list[Bracket] = []
    for bracket in found:
        if kept and _touch(kept[-1], bracket):
            before = kept.pop()
            bracket = replace(
                bracket, at=(before.at[0], bracket.at[1]), ends=(before.ends[0], bracket.ends[1])
            )
        kept.append(bracket)
    return [bracket for bracket in kept if _mark(bracket.ends[0]) != _mark(bracket.ends[1])]


def _touch(a: Bracket, b: Bracket) -> bool:
    width = max(abs(x.at[1] - x.at[0]) for x in (a, b))
    return abs(b.at[0] - a.at[1]) <= 2.0 * width


def _mark(station: Station) -> tuple[int, float]:
    return station.negative, station.sign


def _same(mark: tuple[int, float], station: Station) -> bool:
    return _mark(station) == mark


def _reached(whole: Bracket, found: list[Bracket]) -> float:
    return found[-1].at[1] if found else whole.at[0]


def _rate(arc: Arc) -> Value:
    return lambda station: station.direction(arc)[1]


def bisect(
    walker: Walker,
    bracket: Bracket,
    before: Mark,
    value: Value,
    tolerance: float,
    *,
    probe: bool = False,
) -> Bracket:
    """Narrow a bracket.

    Args:
        walker: Computes intermediate states.
        bracket: Initial bracket.
        before: Whether a state is before the event.
        value: Function that is zero at the event; nan where it is unknown.
        tolerance: Relative tolerance of the load factor; distances are located to a thousandth of
            the step.
        probe: Whether the value needs the smallest eigenvalue.
    """
    (a, b), (first, last) = bracket.at, bracket.ends
    fa, fb = value(first), value(last)
    width, size, slow = b - a, abs(b - a), 0
    for _ in range(_TRIALS):
        wanted = _wanted(walker, a, b, first, last, size, tolerance)
        if abs(b - a) <= wanted:
            break
        t = 0.5
        if slow < _SLOW and np.isfinite(fa) and np.isfinite(fb) and fa * fb < 0:
            # slightly beyond the estimate, so that the bracket closes from both sides
            pad = min(0.5, 0.4 * wanted / abs(b - a))
            t = fa / (fa - fb)
            t = float(np.clip(t + (pad if t < 0.5 else -pad), pad, 1.0 - pad))
        at = a + t * (b - a)
        near = bracket.nearest(at)
        try:
            station = walker.step(
                bracket.origin,
                bracket.control,
                at,
                bracket.arc,
                begin=None if near is bracket.origin else near,
                probe=probe,
            )
        except LostError:
            if t == 0.5:
                break
            slow = _SLOW
            continue
        bracket.known.append((at, station))
        if before(station):
            a, first, fa = at, station, value(station)
        else:
            b, last, fb = at, station, value(station)
        slow = slow + 1 if abs(b - a) > 0.5 * abs(width) else 0
        slow = 0 if slow > _SLOW else slow
        width = b - a
    return replace(bracket, at=(a, b), ends=(first, last))


def _wanted(
    walker: Walker,
    a: float,
    b: float,
    first: Station,
    last: Station,
    size: float,
    tolerance: float,
) -> float:
    """Width of the bracket at which the load has the requested accuracy."""
    change = abs(last.factor - first.factor)
    allowed = tolerance * max(abs(first.factor), abs(last.factor), 1e-3 * walker.load)
    return min(_WIDTH * size, allowed * abs(b - a) / change if change > 0 else np.inf)
