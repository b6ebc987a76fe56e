"""Constraints, loads and momenta at the ends of steps of the variational scheme."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie.joints.equations.joint_arrays import joint_arrays
from fem_lie.linear.direct import DirectSolver
from fem_lie.solve.impacts.impulses import massless
from fem_lie.solve.motion.consistent import accelerations
from fem_lie.solve.variational import kinematics, momenta
from fem_lie.system.equations import Equations, Plan, TimeState


class Binding:
    """Constraints outside of the compiled joints: on attachment frames and along beams."""

    def __init__(self, equations: Equations) -> None:
        """Set up before the first step."""
        self._equations = equations
        self._ahead: Array = np.zeros(equations.unknowns.m)

    def begin(self, H: Array, start: float, h: float) -> None:
        """Begin a step.

        Args:
            H: Nodal coordinates of all nodes at its start, (N, 4, 3).
            start: Time at its start.
            h: Step size.
        """
        equations = self._equations
        self._start, self._jacobian = H.copy(), equations.constraints(H).jacobian
        if equations.unknowns.driven:
            middle, end = (equations.prescribed(start + part * h) for part in (0.5, 1.0))
            self._ahead = end.targets - middle.targets

    def constrain(
        self, end: Array, multipliers: Array, gap: Array, out: tuple[Array, Array]
    ) -> None:
        """Increments of the constraints over the step, and their forces at its start.

        Args:
            end: Nodal coordinates of all nodes at the end, (N, 4, 3).
            multipliers: Lagrange multipliers, (m,).
            gap: Constraint violations at the start, (m,).
            out: The increments, (m,), and forces in global components, (n, 6); overwritten.
        """
        change, forces = out
        change[:] = self._equations.constraints(end).values - self._ahead - gap
        local = (self._jacobian.T @ multipliers).reshape(-1, 6)
        momenta.to_space(self._equations.unknowns.kinds, self._start, local, forces)


PREFIX = "fem_lie_dynamics_"
_UNFILTERED = 1e-6
"""Step size, over the true one, of the matrix that computes velocities from momenta, if the mass
matrix is singular."""


class Ends:
    """Velocities, accelerations and multipliers at ends of steps, for results."""

    def __init__(self, equations: Equations, step: float, sweeps: int = 1) -> None:
        """Set up without factorising.

        Args:
            equations: Equations of the scene.
            step: Step size.
            sweeps: As in :func:`~fem_lie.solve.motion.consistent.accelerations`.
        """
        n, m = equations.unknowns.moving, equations.unknowns.m
        self.equations, self.h, self._n, self._sweeps = equations, step, n, sweeps
        self._still, self._none = np.zeros((n, 6)), np.zeros(m)
        self._work = np.zeros(equations.unknowns.size)
        self._made: DirectSolver | None = None
        unknowns, known = equations.unknowns, equations.arrays
        light = massless(known.inertia, unknowns.kinds, unknowns.held).count_nonzero() > 0
        self._unfiltered = _UNFILTERED if light else 0.0
        # without stiffness accelerations have the matrix of velocities
        springs = len(joint_arrays(known.joints).springs)
        self._one_matrix = not (light or springs or len(known.terms))
        # frames and scale of the constraints of the matrix that is factorised
        self._known: tuple[Array, Array] | None = None

    @property
    def _solver(self) -> DirectSolver:
        if self._made is None:
            self._made = DirectSolver(self.equations.matrix, PREFIX)
        return self._made

    def velocities(self, H: Array, spatial: Array, time: float) -> Array:
        """Admissible twists of all nodes with given momenta, shape (N, 6).

        Args:
            H: Nodal coordinates of all nodes, shape (N, 4, 3).
            spatial: Momenta in global components, shape (n, 6).
            time: Time.
        """
        equations, n, solver = self.equations, self._n, self._solver
        v = equations.start.velocities.copy()
        v[:n] = 0.0
        given = equations.prescribed(time, self.h)
        v[n + 1 :] = given.velocities
        r = solver.right_hand_side
        held = equations.unknowns.held
        momenta.to_local(equations.unknowns.kinds, H, spatial, held, r[: 6 * n].reshape(n, 6))
        plan = Plan(self._still, at_rest=self._unfiltered * self.h)
        scale = equations.fill(TimeState(H, self._still, self._still, self._none), None, plan)
        moved, _ = equations.constraints(H).rates(v)
        r[6 * n :] = scale * (given.target_rates[0] - moved)
        solver.factorise()
        solver.solve()
        v[:n] = solver.solution[: 6 * n].reshape(n, 6)
        self._known = (H.copy(), scale) if self._one_matrix else None
        return v

    def accelerations(self, H: Array, v: Array, time: float) -> tuple[Array, Array]:
        """Accelerations, shape (n, 6), and Lagrange multipliers, shape (m,).

        Args:
            H: Nodal coordinates of all nodes, shape (N, 4, 3).
            v: Their twists, shape (N, 6).
            time: Time.
        """
        equations, n = self.equations, self._n
        now = TimeState(H, v[:n], self._still, self._none)
        # internal unknowns of elements are those of the midpoint
        equations.residual(now, np.ones(len(self._none)), self._work)
        known, self._known = self._known, None
        scale = known[1] if known is not None and np.array_equal(known[0], H) else None
        given = H, v, time, self.h, self._sweeps
        return accelerations(equations, self._solver, *given, scale=scale)

    def through(self, H: Array, rates: Array, time: float, changing: bool) -> tuple[Array, Array]:
        """Twists, shape (N, 6), and their rates, shape (n, 6), of a line through two steps.

        Args:
            H: Nodal coordinates of all nodes at the end of the last step, shape (N, 4, 3).
            rates: Rates in the last step and the one before, see
                :func:`~.kinematics.set_rates`, shape (2, n, 6).
            time: Time at its end.
            changing: Whether there are prescribed motions.
        """
        equations, n, h = self.equations, self._n, self.h
        twists, change = equations.start.velocities.copy(), np.empty((n, 6))
        kinds, held = equations.unknowns.kinds, equations.unknowns.held
        kinematics.at_end(kinds, H, held, rates, h, (twists[:n], change))
        if changing:
            twists[n + 1 :] = equations.prescribed(time, h).velocities
        return twists, change


def prescribe(
    equations: Equations,
    H: Array,
    start: float,
    h: float,
    coordinates: tuple[Array, Array, Array, Array],
    given: tuple[Array, Array],
) -> None:
    """Set loads at the midpoint of the step, drives and prescribed motions, also at its end.

    Args:
        equations: Equations of the scene; their time becomes that of the midpoint.
        H: Nodal coordinates of all nodes at the start, shape (N, 4, 3).
        start: Time at the start.
        h: Step size.
        coordinates: Increments, means, ends, midpoints of nodes; set for prescribed nodes.
        given: Increments of drives, shape (m,), and twists, shape (N, 6), of which those of
            prescribed nodes are set; results.
    """
    n, (driven, twists) = equations.unknowns.moving, given
    end, between = start + h, equations.prescribed(start + 0.5 * h, h)
    if equations.unknowns.driven:
        at = [equations.prescribed(time).targets for time in (start, end)]
        driven[:] = at[1] - at[0]
    if len(H) > n + 1:
        delta, mean, last, midpoint_frames = coordinates
        after = equations.prescribed(end)
        delta[n + 1 :] = after.frames - H[n + 1 :]
        mean[n + 1 :] = 0.5 * (after.frames + H[n + 1 :])
        last[n + 1 :], midpoint_frames[n + 1 :] = after.frames, between.frames
        twists[n + 1 :] = between.velocities
    between.act()
