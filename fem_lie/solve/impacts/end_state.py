"""Positions and velocities at the end of a step that satisfy the bounds of contacts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit.records import Record
from fem_lie.contact.cones import solver
from fem_lie.contact.cones.jacobian import BlockRows, slides
from fem_lie.contact.cones.sweeps import MOST_NEWTON, products
from fem_lie.contact.contact import Contact
from fem_lie.contact.impact.records import STEP_REPORT
from fem_lie.lie.node_types import (
    all_from_local,
    all_to_global_components,
    all_to_group,
    all_to_local,
    all_to_nodal_components,
    pull_all_back,
    push_all_forward,
)
from fem_lie.lie.node_types.inertia import multiply
from fem_lie.lie.node_types.node_type import POSITION_GRADIENT
from fem_lie.solve.impacts.bodies import CoupledBodies
from fem_lie.solve.impacts.bounds import Chosen, bounds_of
from fem_lie.solve.impacts.step_end import Factors, Rule
from fem_lie.system.equations import Equations

TOLERANCE, _ROUGH = 1e-9, 1e-6
"""Residual of the cones, and the one for the first iterations of positions."""

_EXACT, MOST_ITERATIONS, _REEVALUATED = 1e-14, 30, 2
"""Change of positions over the length of the model at convergence; largest number of iterations;
and number of the first iterations in which force rows are re-evaluated."""

_WITH_FRICTION = 6
"""Largest number of iterations with friction if there are many contacts, whose friction is then
frozen: cones of this size converge to 1e-6 only."""

_SMALL = 1e-12
"""Positions over the length of the model below which only round-off is known."""


class Aims(NamedTuple):
    """Targets of contacts at the end.

    Attributes:
        gaps: Least gaps, shape (k,).
        slides: Sliding distance after the impact without friction, shape (k, 2).
    """

    gaps: Array
    slides: Array


class Moved(NamedTuple):
    """End of a step moved by contacts.

    Attributes:
        H: Frames of all nodes, ground and prescribed motions.
        d: Increments, in the nodes' axes, shape (6 n,).
        r: Contact forces, shape (k, 3).
        rows: Contact Jacobian there.
        forces: Blocks of the force rows, shape (b, 3, 6).
        reactions: Constraint forces of joints, shape (m,).
        slips: Sliding distances, shape (k, 2).
        sweeps: Number of sweeps over all cones.
        residual: Remaining residual of the cones.
    """

    H: Array
    d: Array
    r: Array
    rows: BlockRows
    forces: Array
    reactions: Array
    slips: Array
    sweeps: int
    residual: float


class CoupledPositions(CoupledBodies):
    """Bodies whose contacts move the end of a step."""

    def begin(self, H: Array, v: Array, time: float) -> None:
        """Store the start of a step.

        Args:
            H: Frames of all nodes, ground and prescribed motions.
            v: Twists of the moving nodes, shape (n, 6).
            time: Time at the start.
        """
        self._H0, self._V0 = H.copy(), self._all_rows(v, time)
        speeds = np.linalg.norm(self._V0.reshape(-1, 2, 3), axis=2)
        far = self._h * float(speeds[:, 0].max() + (self.near.arms * speeds[:, 1]).max())
        self.near.update(H, far)

    def _slips(self, chosen: Chosen, H: Array, B: BlockRows, glide: Array) -> Array:
        """Sliding distances in the step of contacts that close in it, shape (k, 2)."""
        total = np.empty((len(chosen.pairs), 3))
        slides((chosen.before, B), self._all_kinds, (self._H0, H), total)
        return np.where(chosen.closed[:, np.newaxis], total[:, 1:], glide)

    def part(
        self, chosen: Chosen, end: Array, aims: Aims, r: Array, most: int = MOST_ITERATIONS
    ) -> Moved:
        """Separate overlapping pairs, and fix sticking ones.

        Args:
            chosen: Active contacts.
            end: Frames of all nodes, ground and prescribed motions without contacts.
            aims: Targets of the contacts.
            r: Initial guess of forces, shape (k, 3).
            most: Largest number of iterations.
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
        friction, left, frozen, slow = chosen.friction, 0.0, False, False
        for iteration in range(most):
            if k > MOST_NEWTON and not frozen and (slow or iteration == _WITH_FRICTION):
                # gaps need more than cones reach
                held, r, friction = r * (0.0, 1.0, 1.0), r * (1.0, 0.0, 0.0), np.zeros(k)
                last, frozen = r.copy(), True
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
            more_sweeps, _, residual = solver.solve(problem, k, tolerance)
            left = left if frozen else residual
            sweeps, r, here = sweeps + more_sweeps, problem.r, d
            last, d = r.copy(), responses.moved(r + held) + joints
            H = self._moved_by(end, d)
            change = self._size(d - here)
            if self._ends(iteration, change, before):
                break
            before, slow = change, iteration >= _REEVALUATED and change > 0.5 * before
        rows = self._rows_of(H, chosen.pairs, chosen.axis)
        slips = self._slips(chosen, H, rows, glide)
        r = r + held
        reactions = responses.reactions(r)
        return Moved(H, d, r, rows, forces, reactions, slips, sweeps, left)

    def _size(self, d: Array) -> float:
        """Norm of an increment.

        Largest displacement of any point, with rotations times the model's length.
        """
        parts = np.abs(d.reshape(-1, 6))
        return max(float(parts[:, :3].max()), self._length * float(parts[:, 3:].max()))

    def _ends(self, iteration: int, change: float, before: float) -> bool:
        """Whether positions no longer change, or only by round-off that does not decrease."""
        exact = _EXACT * self._length
        turns = iteration > 5 and change > 0.5 * before and change < 1e3 * exact
        return change <= exact or turns


_TINY = 1e-6
"""Speeds below this fraction of the largest are round-off."""


class CoupledVelocities(CoupledPositions):
    """Bodies whose contacts change velocities at the end of a step.

    Attributes:
        statistics: Contact statistics of the last step, see :mod:`fem_lie.contact.impact.records`.
        reactions: Joint impulses including those of contacts, over the step, shape (m,).
        work: Work of drives and prescribed motions by these impulses.
        exchanged: Largest energy exchanged by contacts in the last step.
    """

    def __init__(
        self, contacts: Sequence[Contact], equations: Equations, rule: Rule, kept: Factors | None
    ) -> None:
        """Set up the contacts of a scene for impacts at the ends of steps."""
        super().__init__(contacts, equations, rule, kept)
        self._turns = self._kinds < POSITION_GRADIENT
        self.statistics: Record = STEP_REPORT()
        self.reactions = np.zeros(self._m)
        self.work = self.exchanged = 0.0
        # normal velocities by restitution, and their changes without contacts
        self._law: tuple[Array, Array] = np.zeros(0), np.zeros(0)

    def _momenta(self, H: Array, v: Array) -> Array:
        """Momenta of the nodes, shape (n, 6): moments of frames in their axes, all else global."""
        q, p, found = np.empty((self._n, 4, 3)), np.empty((self._n, 4, 3)), np.zeros(6 * self._n)
        push_all_forward(self._kinds, H, v, q)
        multiply(*self._equations.arrays.inertia, q, p)
        pull_all_back(self._kinds, H, p, 1.0, found)
        return self._except_moments(all_to_global_components, H, found)

    def _except_moments(
        self, turn: Callable[[Indices, Array, Array], object], H: Array, forces: Array
    ) -> Array:
        """Forces on the nodes (6 n,) in other components, but for moments on frames, (n, 6)."""
        given, found = forces.reshape(-1, 6), forces.copy()
        turn(self._kinds, H, found)
        turned = found.reshape(-1, 6)
        turned[self._turns, 3:] = given[self._turns, 3:]
        return turned

    def _keep_momenta(self, momenta: Array, H: Array, twist: Array) -> None:
        """Change twists at frames ``H`` to those of given momenta, see :meth:`_momenta`.

        Momenta of a node depend on the axes of its neighbours, which contacts have turned.
        """
        missing = (momenta - self._momenta(H, twist)).ravel()
        left = self._except_moments(all_to_nodal_components, H, missing)
        left[~self._free.reshape(-1, 6)] = 0.0
        twist += self._impulses.solve(left.ravel())[0].reshape(-1, 6)

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
        """Twists of the nodes at the end, and contact impulses (k, 3)."""
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
            self.reactions[:] = self._rule.damping / self._rule.mass * moved.reactions
        smooth, twist = np.empty_like(v), np.empty_like(v)
        all_to_local(kinds, H, before, self._still, smooth, rate)
        all_to_local(kinds, H, v, self._still, twist, rate)
        self._impulses.go_to(H)
        if self._kept is not None:
            thrown = V[: self._n] + self._rule.damping * moved.d.reshape(-1, 6)
            self._keep_momenta(self._momenta(end, thrown), H, twist)
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
        workspace = np.empty((k, 3)), np.empty((k, 3))
        sweeps, residual = solver.solve_exactly(problem, k, TOLERANCE, workspace)
        self.statistics.sweeps += sweeps
        self.statistics.residual = max(self.statistics.residual, residual)
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
        # closed contacts by their sliding distance, which is zero for sticking ones
        slid = np.where(chosen.closed[:, np.newaxis], moved.slips / self._h, mean[:, 1:])
        self.statistics.friction = float((slid * P[:, 1:]).sum())
        return end_twist, P.copy()
