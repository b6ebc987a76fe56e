"""Places at the end of a step: forces that part what overlaps and hold what sticks."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array
from fem_lie.contact.impact import cones
from fem_lie.contact.impact.jacobian import BlockRows, slides
from fem_lie.contact.impact.sweeps import MOST_NEWTON, products
from fem_lie.solve.impacts.bodies import CoupledBodies
from fem_lie.solve.impacts.bounds import Chosen

TOLERANCE, _ROUGH = 1e-9, 1e-6
"""Residual of the cones, and that with which positions begin."""

_EXACT, _ITERATIONS, _ANEW = 1e-14, 30, 2
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


class CoupledPlaces(CoupledBodies):
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
            if iteration < _ANEW:
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
