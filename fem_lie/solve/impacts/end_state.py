"""Positions and velocities at the end of a step that satisfy the bounds of contacts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array
from fem_lie.contact.contact import Contact
from fem_lie.contact.impact import cones
from fem_lie.contact.impact.jacobian import BlockRows, slides
from fem_lie.contact.impact.records import FRICTION, RESIDUAL, SWEEPS
from fem_lie.contact.impact.records import REPORT_SIZE as SIZE
from fem_lie.contact.impact.sweeps import MOST_NEWTON, products
from fem_lie.lie.node_types import all_from_local, all_to_group
from fem_lie.solve.impacts.bodies import CoupledBodies, to_twists
from fem_lie.solve.impacts.bounds import Chosen, bounds_of
from fem_lie.solve.impacts.step_end import Factors, Rule
from fem_lie.system.equations import Equations

TOLERANCE, _ROUGH = 1e-9, 1e-6
"""Residual of the cones, and that with which positions begin."""

_EXACT, _ITERATIONS, _REEVALUATED = 1e-14, 30, 2
"""Part of the model's length by which places still change at the end; iterations at most, and in
how many of the first ones rows of forces are taken anew."""

_WITH_FRICTION = 6
"""Iterations of many contacts with friction, which is then held: cones of so many end with 1e-6."""

_SMALL = 1e-12
"""Part of the model's length below which places are known to round-off alone."""


class Aims(NamedTuple):
    """Where contacts are to be at the end.

    Attributes:
        gaps: Least ones, shape (k,).
        slides: How far they slide after they meet if nothing rubs, shape (k, 2).
    """

    gaps: Array
    slides: Array


class Moved(NamedTuple):
    """Where contacts move the end of a step.

    Attributes:
        H: Frames of all rows.
        d: By which increments, in the nodes' axes, shape (6 n,).
        r: Forces of contacts, shape (k, 3).
        rows: There.
        forces: Blocks of the rows of forces, shape (b, 3, 6).
        carried: By joints, forces of them, shape (m,).
        slips: How far contacts slide, shape (k, 2).
        sweeps: Over all cones.
        residual: What is left of these.
    """

    H: Array
    d: Array
    r: Array
    rows: BlockRows
    forces: Array
    carried: Array
    slips: Array
    sweeps: int
    residual: float


class CoupledPositions(CoupledBodies):
    """Bodies whose contacts move the end of a step."""

    def begin(self, H: Array, v: Array, time: float) -> None:
        """Remember where a step begins.

        Args:
            H: Frames of all rows.
            v: Twists of the moving nodes, shape (n, 6).
            time: Of the start.
        """
        self._H0, self._V0 = H.copy(), self._all_rows(v, time)
        speeds = np.linalg.norm(self._V0.reshape(-1, 2, 3), axis=2)
        far = self._h * float(speeds[:, 0].max() + self.near.arm * speeds[:, 1].max())
        self.near.update(H, far)

    def _slips(self, chosen: Chosen, H: Array, B: BlockRows, glide: Array) -> Array:
        """How far contacts slide in the step, of those that meet after it, shape (k, 2)."""
        total = np.empty((len(chosen.pairs), 3))
        slides((chosen.before, B), (self._H0, H), total)
        return np.where(chosen.closed[:, np.newaxis], total[:, 1:], glide)

    def part(self, chosen: Chosen, end: Array, aims: Aims, r: Array) -> Moved:
        """Part what overlaps, and hold what sticks.

        Args:
            chosen: Contacts that take part.
            end: Frames of all rows without contacts.
            aims: Of the contacts.
            r: Forces that may be near, shape (k, 3).
        """
        if self._kept is None:
            self._impulses.go_to(end)
        H, sweeps, before, k = end, 0, np.inf, len(chosen.pairs)
        d: Array = np.zeros(6 * self._n)
        joints: Array = np.zeros(6 * self._n)
        last: Array = np.zeros((k, 3))
        products_of_last: Array = np.empty((k, 3))
        each = np.diff(chosen.before.first)
        closed = np.repeat(chosen.closed, each)[:, np.newaxis, np.newaxis]
        held: Array = np.zeros((k, 3))
        friction, many, left = chosen.friction, k > MOST_NEWTON, 0.0
        for iteration in range(_ITERATIONS):
            if many and iteration == _WITH_FRICTION:  # gaps need more than cones end with
                held, r, friction = r * (0.0, 1.0, 1.0), r * (1.0, 0.0, 0.0), np.zeros(k)
                last = r.copy()
            B = self._rows_of(H, chosen.pairs, chosen.axis)
            if iteration < _REEVALUATED:
                mean = 0.5 * (chosen.before.values + B.values)
                forces = np.where(closed, mean, B.values)
                responses = chosen.operator.solve(forces, end, self._pushed)
            problem = chosen.operator.problem(B.values, responses, friction)
            glide = aims.slides + self._rates_of(B, end, d)[:, 1:]
            problem.q[:, 0] = self._gaps(H)[chosen.pairs] - aims.gaps
            problem.q[:, 1:] = self._slips(chosen, H, B, glide)
            products(problem, last, products_of_last)
            problem.q[:] -= products_of_last + problem.soft[:, np.newaxis] * last
            if self._m:
                more = self._closed(H)
                joints += more
                problem.q[:] += self._rates_of(B, end, more)
            problem.r[:], problem.least[0] = r, _SMALL * self._length
            tolerance = TOLERANCE if iteration else _ROUGH
            more_sweeps, _, residual = cones.solve(problem, k, tolerance)
            left = residual if not many or iteration < _WITH_FRICTION else left
            sweeps, r, here = sweeps + more_sweeps, problem.r, d
            last, d = r.copy(), responses.moved(r + held) + joints
            H = self._moved_by(end, d)
            change = self._size(d - here)
            if self._ends(iteration, change, before):
                break
            before = change
        rows = self._rows_of(H, chosen.pairs, chosen.axis)
        slips = self._slips(chosen, H, rows, glide)
        r = r + held
        carried = responses.reactions(r)
        return Moved(H, d, r, rows, forces, carried, slips, sweeps, left)

    def _size(self, d: Array) -> float:
        """Of an increment: the largest of any place, with turns by the model's length."""
        parts = np.abs(d.reshape(-1, 6))
        return max(float(parts[:, :3].max()), self._length * float(parts[:, 3:].max()))

    def _ends(self, iteration: int, change: float, before: float) -> bool:
        """Whether places change no more, or by round-off that does not get less."""
        exact = _EXACT * self._length
        turns = iteration > 5 and change > 0.5 * before and change < 1e3 * exact
        return change <= exact or turns


_TINY = 1e-6
"""Part of speeds below which they are known to round-off alone."""


class CoupledVelocities(CoupledPositions):
    """Bodies whose contacts change velocities at the end of a step.

    Attributes:
        statistics: What contacts did in the last step, see :mod:`fem_lie.contact.impact.records`.
        reactions: Impulses of the joints with those of contacts, over the step, shape (m,).
        work: Of drives and prescribed motions by these impulses.
        exchanged: What contacts took and gave at most in the last step.
    """

    def __init__(
        self, contacts: Sequence[Contact], equations: Equations, rule: Rule, kept: Factors | None
    ) -> None:
        """As the base class."""
        super().__init__(contacts, equations, rule, kept)
        self.statistics, self.reactions = np.zeros(SIZE), np.zeros(self._m)
        self.work = self.exchanged = 0.0
        # normal velocities that restitution gives, and by how much they change without contacts
        self._law: tuple[Array, Array] = np.zeros(0), np.zeros(0)

    def _throw(
        self,
        chosen: Chosen,
        moved: Moved,
        end: Array,
        V: Array,
        defect: Array,
        impulses: Array,
        time: float,
    ) -> tuple[Array, Array]:
        """Twists of the nodes at the end, and impulses of contacts (k, 3)."""
        B, H, k = moved.rows, moved.H, len(chosen.pairs)
        kinds, zero = self._kinds, np.zeros(6 * self._n)
        before, rate = np.empty_like(self._still), np.empty_like(self._still)
        all_from_local(kinds, end, V[: self._n], self._still, before, rate)
        v = before.copy()
        given: Array = np.zeros((k, 3))
        u_given: Array = np.empty((k, 3))
        self.reactions[:] = 0.0
        if self._kept is not None:
            by = moved.d.reshape(-1, 6).copy()
            all_to_group(kinds, end, by)
            v += self._rule.damping * by
            given = self._rule.damping / self._rule.mass * moved.r
            self.reactions[:] = self._rule.damping / self._rule.mass * moved.carried
        smooth, twist = np.empty_like(v), np.empty_like(v)
        to_twists(kinds, H, before, smooth)
        to_twists(kinds, H, v, twist)
        self._impulses.go_to(H)
        off = defect - self._rates(H, self._all_rows(twist, time), time)
        x, first = self._impulses.solve(zero, off)
        responses = chosen.operator.solve(moved.forces, H, self._impulses.solve)
        free = self._rates_of(B, H, self._all_rows(smooth, time))[:, 0]
        bounds = bounds_of(self._h, chosen, free)
        problem = chosen.operator.problem(B.values, responses, chosen.friction)
        twist += x.reshape(-1, 6)
        u = self._rates_of(B, H, self._all_rows(twist, time))
        products(problem, given, u_given)
        without = u - u_given
        problem.q[:] = without
        problem.q[:, 0] -= bounds.velocity
        gaps = self._gaps(H)[chosen.pairs]
        opens = (moved.r[:, 0] == 0.0) & (gaps > self.near.touch.closed[chosen.pairs])
        opens &= chosen.smooth > 0.0
        problem.q[opens, 0] = np.maximum(problem.q[opens, 0], 0.0) + 1e3 * np.abs(u).max()
        problem.r[:], problem.least[0] = impulses, _TINY * float(np.abs(V).max())
        memory = np.empty((k, 3)), np.empty((k, 3))
        sweeps, residual = cones.solve_exactly(problem, k, TOLERANCE, memory)
        self.statistics[SWEEPS] += sweeps
        self.statistics[RESIDUAL] = max(self.statistics[RESIDUAL], residual)
        P, change = problem.r, problem.r - given
        end_twist = twist + responses.moved(change).reshape(-1, 6)
        driven = 0.5 * (self._V0 + V)
        driven[: self._n + 1] = 0.0
        self.work = -float((P * self._rates_of(B, H, driven)).sum())
        self.exchanged = float(np.abs(P * without).sum())
        self._law = -chosen.restitution * bounds.incoming, free - chosen.speed
        self.reactions += first + responses.reactions(change)
        self.work -= float(self.reactions @ self._driven(time))
        mean = 0.5 * (without + self._rates_of(B, H, self._all_rows(end_twist, time)))
        # of what was closed by how far it slid, for that is nothing of what sticks
        slid = np.where(chosen.closed[:, np.newaxis], moved.slips / self._h, mean[:, 1:])
        self.statistics[FRICTION] = float((slid * P[:, 1:]).sum())
        return end_twist, P.copy()
