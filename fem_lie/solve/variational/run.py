"""Run of the variational scheme: steps, results and checkpoints."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from functools import cached_property

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit.packed_arrays import PackedArrays
from fem_lie._jit.records import block_of
from fem_lie._state import put_back, saved
from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.linear.factors import Factors
from fem_lie.results import Result
from fem_lie.results.record import Record, with_others
from fem_lie.solve.conserving.midpoint.cayley import advance
from fem_lie.solve.convergence import Verdict, failure
from fem_lie.solve.impacts.contacts import CoupledContacts
from fem_lie.solve.impacts.step_end import StepEnd
from fem_lie.solve.iteration import Iterated, LinearRate, iterate
from fem_lie.solve.motion.policies import EveryIteration, PolicyState
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.plan import EqualSteps
from fem_lie.solve.recording.recorder import Recorder
from fem_lie.solve.refactorisation import Refactorisation
from fem_lie.solve.variational import kinematics, loop, momenta
from fem_lie.solve.variational.ends import prescribe
from fem_lie.solve.variational.limit import DIVIDES, vibrations_grow
from fem_lie.solve.variational.loop import Packed
from fem_lie.solve.variational.run_state import RunState
from fem_lie.system.equations import TimeState


class Newton(RunState, Iterated):
    """Run of the variational scheme whose steps are iterated from Python.

    The compiled loop does not support constraints outside of the compiled joints, and the first
    step, which has no matrix yet.
    """

    _motion: float
    _rate: LinearRate

    def _made_with(self, decisions: PolicyState) -> bool:
        """Make the step from its start; return whether it converged."""
        unknowns = self.equations.unknowns
        given = unknowns.kinds, self.H, unknowns.held, self.rates, self.size
        kinematics.predict(*given, self.step)
        self.multipliers[:] = self.earlier
        motion = float(np.abs(self.step.ravel() * self._measure[: self.step.size]).max(initial=0.0))
        tolerance, self._motion = self.options.tolerance, motion
        self._rate = LinearRate(lambda _: tolerance * self._motion, 1.0, loop.ROUND_OFF_LEVEL)
        ended = iterate(self, self.options.max_iterations, decisions)
        self._increment = ended.size
        return ended.converged

    # --- one iteration, see :class:`~fem_lie.solve.iteration.Iterated` ---

    def evaluate(self, iteration: int) -> bool:
        """Evaluate the residual, which alone does not end the iteration."""
        self._iterations += 1
        self._residual()
        return False

    @property
    def missing(self) -> bool:
        """Whether there is no matrix yet."""
        return self._factors is None

    def refactorise(self, update: Refactorisation) -> None:
        """Assemble and factorise the matrix."""
        self._factorise()

    def correct(self) -> float:
        """Solve for a correction; return its size."""
        self._solve()
        return float(np.abs(self._x * self._measure).max(initial=0.0))

    def judge(self, size: float) -> Verdict:
        """Verdict by the linear convergence rate."""
        self._increment, self._motion = size, max(self._motion, size)
        return self._rate.judge(size)

    def apply(self, verdict: Verdict) -> None:
        """Apply the correction, unless it is round-off: the accepted state is consistent."""
        if verdict == Verdict.STAGNANT:
            return
        self._correct()
        if verdict == Verdict.CONVERGED:
            self._residual()


_log = logging.getLogger(__name__)

CHANGED = "H", "rest", "rates", "before", "multipliers", "earlier", "gap", "_made"
"""State that the acceptance of a step changes."""

_AT_A_TIME = 20_000
"""Steps times unknowns (some milliseconds) after which the loop returns, so that it can be
interrupted."""


class VariationalRun(Newton):
    """Run of the variational scheme."""

    def history(
        self, plan: EqualSteps, progress: bool | None, store: Checkpoints | None
    ) -> Recorder:
        """Create the history of results."""
        if not plan.saving.with_balance:
            self.balance.rest()
        if self._contacts is not None:
            self._contacts.history.begin(plan.steps)
        return Recorder(self.equations, plan, progress, store)

    @property
    def frames(self) -> Array:
        """Current frames of all nodes, ground and prescribed motions."""
        return self.H

    @property
    def index(self) -> int:
        """Number of steps made, including the current one."""
        return self._made

    @property
    def time(self) -> float:
        """Time of the current state."""
        return self.index * self.h

    # --- steps ---

    def _advance(self, history: Recorder) -> bool:
        before = self._iterations
        if self._contacts is not None:
            self._contacts.history.begin_step(self.index + 1)
        if self._alone and self.division.level == 0:
            made = self._in_loop(history.next_stop(self.index)) or (self.divides and self._divide())
        else:
            made = self._cover()
        history.count += self._iterations - before
        return made

    def attempt(self, start: float, end: float) -> bool:
        """Make a step; return whether it converged."""
        self._made, self.reason = self.begun, ""
        if self._changing:
            given = self._driven, self.twists
            prescribe(self.equations, self.H, start, self.size, self.coordinates, given)
        if self._binding is not None:
            self._binding.begin(self.H, start, self.size)
        if self._contacts is not None:
            self._contacts.begin(self.H, self._v, start)
        if self._compiled:
            return self._in_loop(self.begun + 1, end)
        return (self._made_with(self.decisions) or self._fallback_converged()) and self._accept(end)

    def _fallback_converged(self) -> bool:
        """Repeat the failed step with new matrices."""
        if not self._may_fall_back:
            return False
        _log.info("step %d: frozen matrix diverges, new matrices", self.index + 1)
        return self._made_with(EveryIteration().begin(bound=False))

    @property
    def _compiled(self) -> bool:
        """Whether a compiled loop can iterate; the first step has no matrix yet."""
        known = self._factors is not None and self.decisions.rule is not None
        return known and self.equations.arrays.in_one_sum and self._binding is None

    @property
    def _alone(self) -> bool:
        """Whether the compiled loop can make many steps."""
        balance = self.balance
        needs_python = self._changing or self._convects_axes or self._contacts is not None
        return self._compiled and not needs_python and (balance.empty or balance.compiled)

    @property
    def _balance_in_loop(self) -> bool:
        """Whether the compiled loop updates the energy balance."""
        return True

    def _in_loop(self, stop: int, end: float | None = None) -> bool:
        """Make whole steps, or parts of one, in the compiled loop; return whether all are made.

        Args:
            stop: Number of the last step.
            end: Time at its end; default: that of steps of one size.
        """
        rule, packed, balance, alone = self.decisions.rule, self._packed, self.balance, self._alone
        assert rule is not None
        progress, first, options = packed.progress, self.index, self.options
        last = min(stop, first + max(1, _AT_A_TIME // len(self._r)))
        steps = loop.Steps(
            h=self.size,
            tolerance=options.tolerance,
            most=options.max_iterations,
            viscous=self._viscous,
            limited=self.divisible,
            accepts=alone,
            turns=self.equations.arrays.turns,
            accounts=self._balance_in_loop and not balance.empty,
            loads=balance.looks[0],
            joints=balance.looks[1],
        )
        progress.made, progress.iteration, progress.total = first, 0, self._iterations
        code, asked = loop.MATRIX, False
        while code == loop.MATRIX:
            assert self._factors is not None
            how = self._factors.plain, rule.plain, (*steps,), last, asked
            code = loop.run(self._fixed.addresses, *how)
            self._made, self._iterations = int(progress.made), int(progress.total)
            self._increment, asked = float(packed.progress.increment), True
            if code == loop.MATRIX and not self._refactorised():
                code = loop.FAILED
        end = self.time + self.size if end is None else end
        if code == loop.FAILED:
            return self._fallback_converged() and self._accept(end)
        return code == loop.DONE and (alone or self._accept(end))

    def _refactorised(self) -> bool:
        """Factorise a new matrix; return whether it is regular."""
        try:
            self._factorise()
        except SingularMatrixError:
            return False
        return True

    @cached_property
    def _packed(self) -> Packed:
        """Packed arrays for the compiled loop, once the state is set."""
        table = self._found.addresses
        assert table is not None
        n, m = self._n, len(self.multipliers)
        return Packed(
            self.H,
            self.rest,
            self.rates,
            self.step,
            self.before,
            self.after,
            self.multipliers,
            self.earlier,
            self.gap,
            *self.coordinates,
            self.twists,
            np.zeros((len(self.H), 6)),
            np.zeros(m),
            self._driven,
            self._change,
            self._forces,
            self._constraints,
            self._r,
            self._x,
            self._y,
            self._work,
            self.scale,
            self._measure,
            self.equations.unknowns.held.astype(np.int64).reshape(n, 6),
            self._mass,
            self.equations.arrays.joints,
            self.decisions.known,
            loop.PROGRESS(),
            table,
            self.balance.addresses,
            np.zeros((n, 6)),
            np.zeros((n, 6)),
            np.zeros(m),
            self.balance.targets,
            self.equations.unknowns.kinds,
            self._inside,
            self.equations.arrays.probes,
            self._q,
            *self._pairs,
        )

    @cached_property
    def _fixed(self) -> PackedArrays:
        return PackedArrays(self._packed)

    def _accept(self, time: float) -> bool:
        """Make the end of the step, at ``time``, the start of the next.

        Returns whether vibrations do not grow, and no surfaces passed through each other.
        """
        delta, _, end, middle = self.coordinates
        # parts of the step may be stable
        if self.divisible and vibrations_grow(*self._pairs, self.H, end, self.size):
            return False
        n, start = self._n, self.H.copy()
        was = None if self._contacts is None else saved(self, CHANGED)
        advance(self.H[:n], self.rest, delta[:n])
        kinds = self.equations.unknowns.kinds
        momenta.keep_axes(kinds, end, self.H)
        self.H[n:] = end[n:]
        self.gap += self._change
        self.before[:] = self.after
        kinematics.keep_rates(kinds, self.step, self.twists, self.size, self.rates)
        ahead = 2.0 * self.multipliers - self.earlier if self.index else self.multipliers.copy()
        self.earlier[:] = self.multipliers
        self._made += 1
        if self._contacts is not None and not self._touch(self._contacts, time, ahead):
            assert was is not None
            put_back(self, CHANGED, was)
            return False
        if not self._accept_history(start, middle):
            return False
        if self._convects_axes:
            self._convect_axes()
        if self._contacts is None and not self.balance.empty:
            self._add_to_balance(time, ahead)
        return True

    def _touch(self, contacts: CoupledContacts, time: float, ahead: Array) -> bool:
        """Apply contact impulses at the end of a step; return whether contacts were solved.

        Args:
            contacts: Contacts by impacts.
            time: Time at the end.
            ahead: Lagrange multipliers there, shape (m,).
        """
        equations, n = self.equations, self._n
        if self._changing:
            equations.prescribed(time).act()
        v = self._ends.velocities(self.H, self.before, time)[:n]
        changed = contacts.resolve(StepEnd(self.H, v, time))
        if contacts.failure:
            contacts.abandon()
            return False
        if not self.balance.empty:
            _, rates = self._ends.through(self.H, self.rates, time, self._changing)
            self.balance.add(self.size, time, self.H, v, rates, ahead)
        if changed is not None:
            was = TimeState(self.H.copy(), v, changed.rates[0], ahead)
            change = self._momenta(changed.frames, changed.twists) - self._momenta(self.H, v)
            self.before += change
            self.H[:n], v = changed.frames[:n], changed.twists
            self.rest[:] = 0.0
            self._set_rates(v, changed.rates[1])
            self.multipliers += changed.multipliers
            self.earlier[:] = self.multipliers
            now = TimeState(self.H, v, changed.rates[1], ahead + changed.multipliers)
            equations.residual(now, np.ones(len(self.multipliers)), self._work)
            self.gap[:] = self._work[6 * n :]
            lost = self.balance.collide(time, was, now, contacts.work)
            contacts.statistics.impact = -lost - contacts.statistics.friction
        self._v[:] = v
        contacts.history.add(self.index, block_of(contacts.statistics))
        self.reason = contacts.passed(self.H)
        return not self.reason

    def _convect_axes(self) -> None:
        """Update convected axes at the accepted state, and the spins of frames along them."""
        kinds, before = self.equations.unknowns.kinds, self.H.copy()
        self.equations.history_variables.rotate_axes(self.H)
        momenta.turn_with(kinds, before, self.H, self.before)
        kinematics.rotate_axes(kinds, before, self.H, self.rates)

    def _add_to_balance(self, time: float, multipliers: Array) -> None:
        """Update the energy balance by the trapezoidal rule.

        Velocities are those of a line through the last two steps.
        """
        if self._changing:
            self.equations.prescribed(time).act()
        twists, rates = self._ends.through(self.H, self.rates, time, self._changing)
        self.balance.add(self.size, time, self.H, twists[: self._n], rates, multipliers)

    def _failure(self, steps: int) -> str:
        options = self.options
        left = float(np.abs(self._r).max(initial=0.0))
        numbers = options.max_iterations, self._increment, left, options.tolerance
        text = failure(self.index + 1, steps, self.h, *numbers, options.policy.full_newton_fallback)
        if self._contacts is not None:
            self.reason = self.reason or self._contacts.failure
        text = self._because(text, steps, self.index)
        return self._nor_in_parts(text)

    # --- results ---

    def _record(self, history: Recorder) -> bool:
        history.show_progress(self.index)
        wanted = history.wants(self.index)
        if wanted:
            with self.equations.history_variables.unchanged():
                self.record_state(history, self.time, moved=self.index > 0)
            if self._contacts is not None and self.index:
                self._contacts.record(self.H, self.time)
        return wanted

    def record_state(self, history: Recorder, time: float, moved: bool) -> None:
        """Record the current state.

        Args:
            history: History of results.
            time: Time of the state.
            moved: Whether velocities are no longer the initial ones.
        """
        n, v = self._n, self.equations.start.velocities
        rates: Array = np.zeros((n, 6))
        multipliers: Array = self.multipliers
        # each of the two needs a factorisation
        if moved and history.filled & ~Record.COORDINATES:
            v = self._ends.velocities(self.H, self.before, time)
        if Record.FORCES in history.filled:
            rates, multipliers = self._ends.accelerations(self.H, v, time)
            if self._contacts is not None:
                multipliers = multipliers + self._contacts.reactions / self.size
        self._rotations.note_velocities(self.size, v[:n], self.equations.unknowns.kinds)
        history.fill(time, self.H, v[:n], rates, multipliers, self.balance.total)

    def _result(self, history: Recorder) -> Result:
        self._rotations.report()
        self.division.report(self.index, DIVIDES)
        divided, others = self.division.divided, {}
        if self._contacts is not None:
            others["contacts"] = steps = self._contacts.history.result(self.h)
            history.add(steps)
        made = history.result(self._factorisations, history.seconds, divided=divided)
        return with_others(made, others)

    # --- checkpoints ---

    def saved_state(self) -> dict[str, Array]:
        """State of the run, with the factors of the matrix, which belong to no particular state."""
        kept = super().saved_state()
        return kept if self._factors is None else kept | self._factors.arrays()

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Restore the state that :meth:`saved_state` returned."""
        super().restore(kept)
        self._take_size(self.part_size)
        self._factors = Factors.of(kept)
