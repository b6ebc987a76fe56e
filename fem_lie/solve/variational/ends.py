"""Constraints, loads and momenta at the ends of steps of the variational scheme."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie.lie.node_types import POSITION_GRADIENT
from fem_lie.linear.direct import DirectSolver
from fem_lie.solve.motion.consistent import accelerations
from fem_lie.solve.variational import momenta
from fem_lie.system.equations import Equations, Plan, TimeState


class Binding:
    """Constraints that a table of pairs of frames does not have: on attachment frames and beams."""

    def __init__(self, equations: Equations) -> None:
        """No step has begun."""
        self._equations = equations
        self._ahead: Array = np.zeros(equations.unknowns.m)

    def begin(self, H: Array, start: float, h: float) -> None:
        """A step begins.

        Args:
            H: Rows of all nodes at its start, (N, 4, 3).
            start: When that is.
            h: Step size.
        """
        equations = self._equations
        self._start, self._jacobian = H.copy(), equations.constraints(H).jacobian
        if equations.unknowns.driven:
            middle, end = (equations.prescribed(start + part * h) for part in (0.5, 1.0))
            self._ahead = end.targets - middle.targets

    def constrain(self, end: Array, weights: Array, gap: Array, out: tuple[Array, Array]) -> None:
        """Increments of the constraints over the step, and their forces at its start.

        Args:
            end: Rows of all nodes at the end, (N, 4, 3).
            weights: Multipliers, (m,).
            gap: What constraints violate at the start, (m,).
            out: The increments, (m,), and forces in global components, (n, 6); overwritten.
        """
        change, forces = out
        change[:] = self._equations.constraints(end).values - self._ahead - gap
        local = (self._jacobian.T @ weights).reshape(-1, 6)
        momenta.to_space(self._equations.unknowns.kinds, self._start, local, forces)


PREFIX = "fem_lie_dynamics_"
_UNFILTERED = 1e-6
"""Size of steps, over the true one, whose matrix finds velocities from momenta."""


class Ends:
    """What results and books want to know there."""

    def __init__(self, equations: Equations, step: float, sweeps: int = 1) -> None:
        """Nothing is factorised yet.

        Args:
            equations: Of the scene.
            step: Step size.
            sweeps: Of :func:`~fem_lie.solve.motion.consistent.accelerations`.
        """
        n, m = equations.unknowns.moving, equations.unknowns.m
        self.equations, self.h, self._n, self._sweeps = equations, step, n, sweeps
        self._still, self._none = np.zeros((n, 6)), np.zeros(m)
        self._work = np.zeros(equations.unknowns.size)
        self._made: DirectSolver | None = None

    @property
    def _solver(self) -> DirectSolver:
        if self._made is None:
            self._made = DirectSolver(self.equations.matrix, PREFIX)
        return self._made

    def velocities(self, H: Array, spatial: Array, time: float) -> Array:
        """Twists of all rows that have the momenta and that constraints allow, shape (N, 6).

        Args:
            H: All rows, shape (N, 4, 3).
            spatial: Momenta, shape (n, 6).
            time: When.
        """
        equations, n, solver = self.equations, self._n, self._solver
        v = equations.start.velocities.copy()
        v[:n] = 0.0
        given = equations.prescribed(time, self.h)
        v[n + 1 :] = given.velocities
        r = solver.right_hand_side
        held = equations.unknowns.held
        momenta.to_local(equations.unknowns.kinds, H, spatial, held, r[: 6 * n].reshape(n, 6))
        plan = Plan(self._still, at_rest=_UNFILTERED * self.h)
        scale = equations.fill(TimeState(H, self._still, self._still, self._none), None, plan)
        moved, _ = equations.constraints(H).rates(v)
        r[6 * n :] = scale * (given.target_rates[0] - moved)
        solver.factorise()
        solver.solve()
        v[:n] = solver.solution[: 6 * n].reshape(n, 6)
        return v

    def accelerations(self, H: Array, v: Array, time: float) -> tuple[Array, Array]:
        """Accelerations, shape (n, 6), and multipliers, shape (m,).

        Args:
            H: All rows, shape (N, 4, 3).
            v: Their twists, shape (N, 6).
            time: When.
        """
        equations, n = self.equations, self._n
        now = TimeState(H, v[:n], self._still, self._none)
        # elements' own unknowns are those half-way
        equations.residual(now, np.ones(len(self._none)), self._work)
        return accelerations(equations, self._solver, H, v, time, self.h, self._sweeps)

    def through(self, H: Array, steps: Array, time: float, changing: bool) -> tuple[Array, Array]:
        """Twists, shape (N, 6), and their rates, shape (n, 6), of a line through two steps.

        Args:
            H: All rows at the end of the last step, shape (N, 4, 3).
            steps: It and the one before, shape (2, n, 6).
            time: When it ends.
            changing: Whether anything is prescribed in time.
        """
        equations, n, h = self.equations, self._n, self.h
        twists = equations.start.velocities.copy()
        spatial = (1.5 * steps[0] - 0.5 * steps[1]) / h
        kinds, held = equations.unknowns.kinds, equations.unknowns.held
        momenta.to_local(kinds, H, spatial, held, twists[:n])
        if changing:
            twists[n + 1 :] = equations.prescribed(time, h).velocities
        rates = np.empty((n, 6))
        change = (steps[0] - steps[1]) / h**2
        momenta.to_local(kinds, H, change, held, rates)
        frames = np.flatnonzero(kinds < POSITION_GRADIENT)
        rates[frames, :3] -= np.cross(twists[frames, 3:], twists[frames, :3])
        momenta.subtract_turning(kinds, H, twists, rates)
        return twists, rates


def prescribe(
    equations: Equations,
    H: Array,
    start: float,
    h: float,
    rows: tuple[Array, Array, Array, Array],
    given: tuple[Array, Array],
) -> None:
    """Set loads of the middle of the step, drives and prescribed motions at its end, too.

    Args:
        equations: Of the scene; their time becomes that of the middle.
        H: All rows at the start, shape (N, 4, 3).
        start: When it begins.
        h: Step size.
        rows: Their change, mean, those at the end and half-way; prescribed ones are set.
        given: By how much drives go on, shape (m,), and twists, shape (N, 6), whose prescribed ones
            are set; results.
    """
    n, (driven, twists) = equations.unknowns.moving, given
    end, between = start + h, equations.prescribed(start + 0.5 * h, h)
    if equations.unknowns.driven:
        at = [equations.prescribed(time).targets for time in (start, end)]
        driven[:] = at[1] - at[0]
    if len(H) > n + 1:
        delta, mean, last, half_way = rows
        after = equations.prescribed(end)
        delta[n + 1 :] = after.frames - H[n + 1 :]
        mean[n + 1 :] = 0.5 * (after.frames + H[n + 1 :])
        last[n + 1 :], half_way[n + 1 :] = after.frames, between.frames
        twists[n + 1 :] = between.velocities
    between.act()
