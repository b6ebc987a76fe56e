"""Books of a run of generalised-α: what loads, drives and supports did, and what damping took.

What is booked is said in :mod:`fem_lie.balances`. Powers and forces are known at the ends of the
steps and are summed up by the trapezoidal rule, of second order as the scheme; of drives and
prescribed motions the increments are known exactly, and the mean of their forces does work on them.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fem_lie import lie
from fem_lie._jit import Array
from fem_lie.acting import Acting
from fem_lie.balances import BY_LOADS, BY_REACTIONS, TOTAL
from fem_lie.outer_forces import LOADS, POWER, SIZE
from fem_lie.system import System


class Books:
    """What has been booked up to the present time.

    Attributes:
        total: Work, damping, numerical loss (unknown: 0), impulses of loads and of reactions,
            shape (15,).
    """

    def __init__(self, system: System) -> None:
        """Empty books of the equations ``system``."""
        self._system, self._acting = system, Acting(system)
        self.total = np.zeros(TOTAL)
        rows = len(system.frames) - system.count
        self._row, self._weights = np.zeros(SIZE), np.zeros(system.m)
        self._targets, self._wrenches = np.zeros(system.m), np.zeros((rows, 6))
        self._H, self._v = system.frames.copy(), np.zeros((system.count, 6))
        self._stored, self._time = np.zeros(1), np.zeros(1)

    def open(self, time: float, H: Array, v: Array, a: Array, weights: Array) -> None:
        """Start anew with what acts at the present time of the equations.

        Args:
            time: That time, on the side of what comes if something jumps then.
            H: Frames of all rows.
            v: Twists, shape (n, 6).
            a: Their rates.
            weights: Multipliers, shape (m,).
        """
        self.total[:] = 0.0
        self.look(time, H, v, a, weights)

    def look(self, time: float, H: Array, v: Array, a: Array, weights: Array) -> None:
        """See what acts at the present time of the equations."""
        system = self._system
        if not self._acting:
            return
        self._acting.look(H, v, a, weights, self._row, self._wrenches)
        if system.connections.driven:
            self._weights[:], self._targets[:] = weights, system.connections.present_targets
        self._time[0], self._H[:], self._v[:] = time, H, v
        if self._acting.strained:
            self._stored[0] = system.elastic.energy(H)

    def add(self, h: float, time: float, H: Array, v: Array, a: Array, weights: Array) -> None:
        """Book a step; the equations are at the time of its end, where the state is as given.

        Args:
            h: Size of the step.
            time: Of its end, on the step's side of what jumps there.
            H: Frames of all rows, and so on as in :meth:`open`.
            v: See there.
            a: See there.
            weights: See there.
        """
        system, total = self._system, self.total
        if not self._acting:
            return
        row, driven, first = self._row.copy(), system.connections.driven, system.count + 1
        if driven:
            old, targets = self._weights.copy(), self._targets.copy()
        if len(H) > first:
            wrenches, frames = self._wrenches.copy(), self._H[first:].copy()
        if self._acting.strained:
            total[POWER] += self._strain_work(time, H)
        self.look(time, H, v, a, weights)
        row += self._row
        row *= 0.5 * h
        total[:LOADS] += row[:LOADS]
        total[BY_LOADS:] += row[LOADS:]
        if driven:
            total[POWER] -= 0.5 * (old + self._weights) @ (self._targets - targets)
        if len(H) > first:
            moved = lie.se3_relative(frames, H[first:])
            total[POWER] += 0.5 * np.sum((wrenches + self._wrenches)[1:] * moved)

    def _strain_work(self, time: float, H: Array) -> float:
        """Of strains without stress: energy that they change at each end, on the average."""
        system, elastic = self._system, self._system.elastic
        ahead = elastic.energy(self._H) - self._stored[0]
        behind = elastic.energy(H)
        system.set_time(float(self._time[0]))
        behind -= elastic.energy(H)
        system.set_time(time)
        return float(0.5 * (ahead + behind))

    def jump(self, time: float, H: Array, v: Array, a: Array, weights: Array) -> None:
        """Book what an event has done at once: a change of velocities, and of strains.

        Arguments are those of :meth:`open`.
        """
        system, before, after = self._system, np.empty(7), np.empty(7)
        system.report(self._H, self._v, before)
        system.report(H, v, after)
        stored = float(self._stored[0])
        self.look(time, H, v, a, weights)
        self.total[POWER] += after[0] - before[0] + float(self._stored[0]) - stored
        self.total[BY_REACTIONS:] += after[1:] - before[1:]

    def memory(self) -> dict[str, Array]:
        """All that the next steps depend on."""
        return {f"books.{name}": value.copy() for name, value in self._arrays().items()}

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Be as when :meth:`memory` was called."""
        for name, value in self._arrays().items():
            value[:] = kept[f"books.{name}"]

    def _arrays(self) -> dict[str, Array]:
        return {name: value for name, value in vars(self).items() if isinstance(value, np.ndarray)}
