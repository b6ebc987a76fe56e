"""Conserving schemes with variable steps.

Energy and momenta are functions of frames and velocities at one time, and each step conserves them,
whatever its size and that of the previous step. So a change of the size must not change the state,
except for quantities that belong to the size and not to the motion: the filter state of order h
(:mod:`.step.dissipation`), and the force left over by round-off, whose impulse is what counts. When
h becomes ``r h``::

    w ← r w          last_residual ← last_residual / r
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array
from fem_lie._state import put_back, saved
from fem_lie.bodies.balances import BY_REACTIONS, WORK
from fem_lie.lie.node_types import inertia, push_all_forward
from fem_lie.linear.direct import DirectSolver
from fem_lie.linear.factors import Factors, solve
from fem_lie.linear.levels import Levels
from fem_lie.solve.conserving.mean_error import End, MeanError
from fem_lie.solve.conserving.midpoint.products import products_at
from fem_lie.solve.conserving.run import Run
from fem_lie.solve.conserving.run_state import PREFIX, Options
from fem_lie.solve.motion.consistent import accelerations, allowed_velocities
from fem_lie.solve.motion.growing import GrowingHistory
from fem_lie.solve.motion.step_log import StepError
from fem_lie.solve.motion.variable_steps import side
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.plan import ChosenSteps
from fem_lie.solve.step_control import Control
from fem_lie.system.equations import Equations

_USUAL = 4
"""Usual iterations of a step with a matrix recent enough for the error estimate."""


class _Frozen(NamedTuple):
    """Frozen matrix of a step size.

    Attributes:
        factors: Factors for the compiled steps.
        solver: Solver of all ranks together, if the scene is divided.
    """

    factors: Factors
    solver: DirectSolver | None


class ConservingSteps(Run):
    """Conserving scheme with variable steps; see :class:`~.variable_steps.Stepper`."""

    make_many = None
    current_jacobian = False  # the matrix of each step size has its own constraint Jacobian
    endures = (
        False  # the error estimate uses the same matrix, and needs the current constraint Jacobian
    )

    def __init__(self, options: Options, equations: Equations, control: Control) -> None:
        """Set up without computing anything; ``control`` holds the level of the step size."""
        super().__init__(options, equations, control.size)
        self.control = control
        self.levels = Levels[_Frozen](rigid=equations.unknowns.rigid)
        self._scales = dict[int, Array]()
        self._error = MeanError(equations, self.model.inertia, self.model.bodies)
        self._solution = np.zeros((3, equations.unknowns.size))

    def _set_size(self, h: float) -> None:
        super()._set_size(h)
        self.h = h

    @property
    def twists(self) -> Array:
        """Current velocities of the moving nodes along their axes, (n, 6)."""
        return self.local(self.s.V[: self.moving], self.s.H)

    @property
    def multipliers(self) -> Array:
        """Current Lagrange multipliers, (m,)."""
        return self.s.multipliers

    @property
    def increment(self) -> float:
        """Size of the last increment of the iteration."""
        return float(self.progress.increment)

    @property
    def factorisations(self) -> int:
        """Number of factorisations so far."""
        return int(self.counts[0])

    # --- the size of the step ---

    def begin(self, h: float) -> None:
        """Start at time 0 with steps of size ``h``."""
        self._set_size(h)
        self.start()

    def set_step(self, time: float, h: float) -> None:
        """Set the state at ``time`` as the start of a step of size ``h``."""
        s, r = self.s, h / self.size
        if abs(r - 1.0) > 1e-12:
            self._resize(h)
        self.levels.use(4.0 / ((1.0 + self.options.dissipation * s.filter_state.active) * h) ** 2)
        present, factor, self._factors = self.levels.present, self.levels.factor, None
        if present is not None:
            self.model.scale[:] = self.levels.scale()
            own, solver = present
            self._factors = own._replace(diagonal=factor * own.diagonal)
            if self._ranks is not None:
                self._ranks.use(solver, factor)

    def _factorise(self) -> None:
        level = self.control.level
        if level not in self._scales:
            self._scales[level] = self._fill_here(None)
        self.model.scale[:] = self._scales[level]
        replaced = self.levels.release()
        if self._ranks is not None:
            self._ranks.use(None if replaced is None else replaced.solver)
        super()._factorise()
        self.progress.fewest = _USUAL
        assert self._factors is not None
        solver = None if self._ranks is None else self._ranks.solver
        self.levels.keep(_Frozen(self._factors, solver), self.model.scale)

    def pass_event(self, time: float, restitution: Array | None = None) -> None:
        """Reset the filter state; driven unknowns get their new velocity by an impulse."""
        assert restitution is None, "conserving schemes have no limits"
        s, self._end = self.s, time
        s.filter_state.active, s.filter_state.length, s.w[:], s.w_F[:], s.sizes[:] = (
            0.0,
            0.0,
            0.0,
            0.0,
            0.0,
        )
        s.cell_forces[1] = s.within[:] = 0.0
        if self.equations.unknowns.driven or len(s.H) > self.moving + 1:
            self._kick(time)
        if self._held:
            self._restart_rates(time)

    def _restart_rates(self, time: float) -> None:
        """Accelerations after a discontinuity, for reactions."""
        equations, s, n = self.equations, self.s, self.moving
        v = equations.start.velocities.copy()
        v[:n] = self.local(s.V[:n], s.H)
        solver = DirectSolver(equations.matrix, PREFIX)
        found = accelerations(equations, solver, s.H, v, time, self.size)[0]
        s.rates[:] = self.spatial(s.H, v, found)

    def _kick(self, time: float) -> None:
        """Make velocities satisfy drives and motions after ``time``.

        The work enters the balance.
        """
        equations, s, n = self.equations, self.s, self.moving
        v, change = equations.start.velocities.copy(), np.empty_like(s.V)
        v[:n] = self.local(s.V[:n], s.H)
        solver = DirectSolver(equations.matrix, PREFIX)
        after = allowed_velocities(equations, solver, s.H, v, time, self.size)
        push_all_forward(self._kinds, s.H, np.ascontiguousarray(after[:n] - v[:n]), change[:n])
        self._push_products(s.H, change)
        before = self._invariants()
        s.V[:] += change
        gain = self._invariants() - before
        s.balance[WORK] += gain[0]
        s.balance[BY_REACTIONS:] += gain[1:]

    def _invariants(self) -> Array:
        """Kinetic energy and momenta, shape (7,)."""
        s, n, work = self.s, self.moving, np.empty_like(self.s.V)
        rows = work.copy()
        rows[:n] = s.H[:n]
        products_at(*self.model.bodies, s.H, rows[n:])
        mass = self.model.inertia
        return np.array(inertia.invariants_of_rates(self._kinds, rows, s.V, *mass, work))

    def damp_oscillations(self, time: float, h: float) -> None:
        """No effect: the energy of unresolved oscillations is conserved."""

    # --- steps ---

    _common = (*Run._common, "_end")

    @property
    def _now(self) -> float:
        return self._end

    @property
    def divides(self) -> bool:
        """Not supported: the step size control chooses smaller steps."""
        return False

    def step_to(self, start: float, end: float, index: int, lands: bool) -> int:
        """Make step ``index``; return its iterations, 0 if it failed."""
        done = self._go_to(self.index + 1, start, end)
        return int(self.progress.last) if done else 0

    def saved(self) -> dict[str, Array]:
        """A copy of the state that a step changes."""
        return super().saved() | saved(self, ["unpredicted"])

    def take_back(self, state: Mapping[str, Array]) -> None:
        """Restore a saved state; the iteration history stays."""
        progress, kept = self.progress, saved(self, ["progress"])
        super().take_back(state)
        restored = progress.steps, progress.total, progress.motion
        put_back(self, ["progress"], kept)
        progress.steps, progress.total, progress.motion = restored
        progress.iteration = progress.asked = 0
        self.unpredicted = int(state["unpredicted"])

    def restore_from(self, other: ConservingSteps, state: Mapping[str, Array]) -> None:
        """Take the state that another stepper has saved."""
        self.take_back(state)
        self._set_size(other.size)

    def estimate(self, before: Mapping[str, Array], start: float, end: float) -> StepError:
        """Error of the step that was made from the state ``before``."""
        s, h, V = self.s, self.size, before["s.V"]
        ends = End(before["s.H"], V, start + side(start, h)), End(s.H, s.V, end - side(end, h))
        r, y, x = self._solution
        self._error.load(h, *ends, self.this.moved, s.multipliers, self.levels.mass, r)
        present = self.levels.present
        assert present is not None
        if self._ranks is None:
            solve(present.factors.plain, r, y, x)
        else:
            x[:] = self._ranks.solution(r)
        return self._error.of(x)

    def recorder(
        self, plan: ChosenSteps, progress: bool | None, store: Checkpoints | None
    ) -> GrowingHistory:
        """Create the history of results."""
        return GrowingHistory(self.equations.info, plan, progress, store, self.equations.part)

    def leave_balance(self) -> None:
        """No effect: the energy balance is part of the sums of a step."""

    def _frozen_factors(self, kept: Mapping[str, Array]) -> None:
        """``None``: checkpoints contain no factors, because the step size varies."""

    def refactorise_at(self, time: float) -> None:
        """Drop all matrices and factorise that of the current state."""
        self.levels = Levels[_Frozen](rigid=self.levels.rigid)
        self._scales.clear()
        self._factors = None

    def record(self, recorder: GrowingHistory, index: int, iterations: int) -> None:
        """Record the current state in the next row."""
        self.keep(recorder)
