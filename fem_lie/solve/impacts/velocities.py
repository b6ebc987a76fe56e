"""Velocities at the end of a step: impulses by the mass matrix and the joints."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array
from fem_lie.contact.contact import Contact
from fem_lie.contact.impact import cones
from fem_lie.contact.impact.records import FRICTION, RESIDUAL, SWEEPS
from fem_lie.contact.impact.records import TOLD as SIZE
from fem_lie.contact.impact.sweeps import products
from fem_lie.lie.kinds import all_from_local, all_to_group
from fem_lie.solve.impacts.bodies import to_twists
from fem_lie.solve.impacts.bounds import Chosen, bounds_of
from fem_lie.solve.impacts.positions import TOLERANCE, CoupledPlaces, Moved
from fem_lie.solve.impacts.step_end import Factors, Rule
from fem_lie.system.equations import Equations

_TINY = 1e-6
"""Part of speeds below which they are known to round-off alone."""


class CoupledVelocities(CoupledPlaces):
    """Bodies whose contacts change velocities at the end of a step.

    Attributes:
        told: What contacts did in the last step, see :mod:`fem_lie.contact.impact.records`.
        reactions: Impulses of the joints with those of contacts, over the step, shape (m,).
        work: Of drives and prescribed motions by these impulses.
        exchanged: What contacts took and gave at most in the last step.
    """

    def __init__(
        self, contacts: Sequence[Contact], equations: Equations, rule: Rule, kept: Factors | None
    ) -> None:
        """As the base class."""
        super().__init__(contacts, equations, rule, kept)
        self.told, self.reactions = np.zeros(SIZE), np.zeros(self._m)
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
        self.told[SWEEPS] += sweeps
        self.told[RESIDUAL] = max(self.told[RESIDUAL], residual)
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
        self.told[FRICTION] = float((slid * P[:, 1:]).sum())
        return end_twist, P.copy()
