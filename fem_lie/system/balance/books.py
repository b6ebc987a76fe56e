"""Books of a run of generalised-α: what loads, drives and supports did, and what damping took.

What is booked is said in :mod:`fem_lie.bodies.balances`. Powers and forces are known at the ends
of the steps and are summed up by the trapezoidal rule, of second order as the scheme; of drives and
prescribed motions the increments are known exactly, and the mean of their forces does work on them.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._state import Stateful, attributes
from fem_lie.bodies.balances import BY_REACTIONS, DAMPING, TOTAL, WORK
from fem_lie.forms.fixed_arrays import FixedArrays
from fem_lie.system.balance.acting import Acting
from fem_lie.system.instant import Instant
from fem_lie.system.outer_forces import POWER, SIZE, Seen, look_and_sum_up, sum_up
from fem_lie.system.system import System


class Books(Stateful):
    """What has been booked up to the present time.

    Attributes:
        total: Work, damping, numerical loss (unknown: 0), impulses of loads and of reactions,
            shape (15,).
        empty: Whether there is never anything to book, or nobody asks.
        compiled: Whether :meth:`add` is :func:`~fem_lie.system.outer_forces.look_and_sum_up` alone.
        compiled_but_held: Whether all of it but impulses of what holds nodes is.
        looks: Whether that looks at loads, and whether at joints.
        table: What it is given.
    """

    STATE = attributes("total", "_stored", "_time", "_seen")

    def __init__(self, system: System) -> None:
        """Empty books of the equations ``system``."""
        self._system, self._acting = system, Acting(system)
        self.total = np.zeros(TOTAL)
        rows, z = len(system.frames) - system.count, np.zeros
        self._seen = Seen(
            row=z(SIZE),
            wrenches=z((rows, 6)),
            H=system.frames.copy(),
            v=z((system.count, 6)),
            weights=z(system.m),
            targets=z(system.m),
        )
        self._start = self._seen.plain
        self._fixed = FixedArrays([*self._acting.arrays, *self._seen, self.total])
        self.empty, self.compiled = not self._acting, self._acting.plain
        self._idle = False
        self.compiled_but_held = self._acting.plain_but_held
        self.looks, self.table = self._acting.looks, self._fixed.table
        self._row, self._wrenches = z(SIZE), z((rows, 6))
        self._undriven = z(system.m)
        self._stored, self._time = z(1), z(1)

    def rest(self) -> None:
        """Book nothing, for nobody asks."""
        self.empty = self._idle = True

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
        if self.empty:
            return
        seen = self._seen
        self._acting.look(H, v, a, weights, seen.row, seen.wrenches)
        seen.H[:], seen.v[:], seen.weights[:], seen.targets[:] = H, v, weights, self.targets
        self._note(time, H)

    def _note(self, time: float, H: Array) -> None:
        self._time[0] = time
        if self._acting.strained:
            self._stored[0] = self._system.elastic.energy(H)

    @property
    def targets(self) -> Array:
        """Of all constraints, shape (m,)."""
        connections = self._system.connections
        if not connections.driven:
            return self._undriven
        if connections.of_joints_only:
            return connections.table.targets
        return connections.present_targets

    def add(self, h: float, time: float, H: Array, v: Array, a: Array, weights: Array) -> None:
        """Book a step; the equations are at the time of its end, where the state is as given.

        Args:
            h: Size of the step.
            time: Of its end, on the step's side of what jumps there.
            H: Frames of all rows.
            v: Twists, shape (n, 6).
            a: Their rates.
            weights: Multipliers, shape (m,).
        """
        acting, total = self._acting, self.total
        if self.empty:
            return
        end = H, v, weights, self.targets
        if self.compiled:
            look_and_sum_up(h, end, *self.looks, self.table)
            return
        if acting.strained:
            total[POWER] += self._strain_work(time, H)
        acting.look(H, v, a, weights, self._row, self._wrenches)
        sum_up(h, end, self._row, self._wrenches, self._start, total)
        self._note(time, H)

    def _strain_work(self, time: float, H: Array) -> float:
        """Of strains without stress: energy that they change at each end, on the average."""
        system, elastic = self._system, self._system.elastic
        ahead = elastic.energy(self._seen.H) - self._stored[0]
        behind = elastic.energy(H)
        began = system.scene.began.time
        system.set_time(began + float(self._time[0]))
        behind -= elastic.energy(H)
        system.set_time(began + time)
        return float(0.5 * (ahead + behind))

    def jump(self, time: float, H: Array, v: Array, a: Array, weights: Array) -> None:
        """Book what an event has done at once: a change of velocities, and of strains.

        Arguments are those of :meth:`open`.
        """
        if self._idle:
            return
        system, seen, before, after = self._system, self._seen, np.empty(7), np.empty(7)
        system.report(seen.H, seen.v, before)
        system.report(H, v, after)
        stored = float(self._stored[0])
        self.look(time, H, v, a, weights)
        self.total[POWER] += after[0] - before[0] + float(self._stored[0]) - stored
        self.total[BY_REACTIONS:] += after[1:] - before[1:]

    def collide(self, time: float, before: Instant, after: Instant, work: float) -> float:
        """Book what impacts have done at the end of a step that was made and booked without them.

        Args:
            time: The end of the step.
            before: The state without them.
            after: The state that there is now.
            work: Of drives and prescribed motions by their impulses.

        Returns:
            Energy that they took, which is booked as damping's.
        """
        system, seen = self._system, (np.empty(7), np.empty(7))
        energies = [
            system.report(state.H, state.v, told) + system.terms.energy(state.H)
            for state, told in zip((before, after), seen, strict=True)
        ]
        lost = float(seen[0][0] + energies[0] - seen[1][0] - energies[1]) + work
        self.total[DAMPING] += lost
        self.total[WORK] += work
        self.total[BY_REACTIONS:] += seen[1][1:] - seen[0][1:]
        self.look(time, *after)
        return lost
