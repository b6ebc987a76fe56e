"""Run of generalised-α with constant steps.

Formulas are in :mod:`fem_lie.solve.alpha.generalised_alpha`. One compiled loop makes the steps, see
:mod:`fem_lie.solve.alpha.step.loop`, and returns to this module for whatever it does not support;
such steps are iterated by :mod:`fem_lie.solve.alpha.newton`.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from functools import cached_property
from typing import TypeAlias

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit.packed_arrays import PackedArrays
from fem_lie._jit.records import block_of
from fem_lie._state import attributes
from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.linear.factors import PlainSolution, Solution
from fem_lie.results import Result
from fem_lie.results.record import with_others
from fem_lie.solve.alpha.newton import Newton
from fem_lie.solve.alpha.options import DAMPED, Options
from fem_lie.solve.alpha.step import loop
from fem_lie.solve.alpha.step.loop import BETWEEN, Packed, PlainSteps, Steps
from fem_lie.solve.alpha.step.node import PlainScheme
from fem_lie.solve.alpha.step.nodes import WRITTEN, to_increments
from fem_lie.solve.convergence import failure
from fem_lie.solve.impacts.contacts import CoupledContacts
from fem_lie.solve.impacts.step_end import Factors, Rule, StepEnd
from fem_lie.solve.motion.policies import EveryIteration
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.plan import EqualSteps
from fem_lie.solve.recording.recorder import Recorder
from fem_lie.solve.refactorisation import PlainRule, Refactorisation
from fem_lie.system.equations import Equations, TimeState

_log = logging.getLogger(__name__)

_AT_A_TIME = 20_000
"""Steps times unknowns (some milliseconds) after which the loop returns, so that it can be
interrupted."""

_NOTHING: Indices = np.empty(0, dtype=np.int64)
_NOWHERE: Indices = np.empty((0, 5), dtype=np.int64)


def _damping(radius: float) -> list[str]:
    """Advice for long chains, whose fast oscillations need more damping."""
    return [f"more damping of fast motions (radius={DAMPED:g})"] if radius > DAMPED else []


CompiledLoop: TypeAlias = Callable[[PlainScheme, PlainSolution, PlainSteps, PlainRule], int]
"""A compiled loop over steps, which returns why it returned."""


class Run(Newton):
    """Run with constant steps."""

    STATE = attributes("_contacts")

    _contacts: CoupledContacts | None = None
    """Contacts by impacts, which change the ends of steps."""

    def __init__(self, options: Options, equations: Equations, step: float) -> None:
        """Start the run of a scene from its initial state."""
        super().__init__(options, equations, step)
        known, rule = equations.arrays, self.decisions.rule
        # the only condition for steps in the compiled loop
        compiled = rule is not None and not self._projects and not self._turned
        compiled = compiled and not equations.shared.several
        self._rule = rule.plain if compiled and rule is not None else None
        # and those for the stages of a step that the loop does itself
        statistics = any(term.passage or term.path for term in known.terms)
        self._remembers = statistics or known.drills or equations.unknowns.other_constraints
        self._fills = known.stored is not None
        self._most = max(1, _AT_A_TIME // equations.unknowns.size)
        self._filled, self._taken = -1, 0
        # time at step 0, for force laws in the compiled loop
        self._began = equations.scene.began.time
        if contacts := equations.scene.impacts:
            unknowns, factors = equations.unknowns, None
            if not unknowns.rigid or len(known.terms):
                renew, solve = self._factorise_for_contacts, self._solve_for_contacts
                factors = Factors(renew, solve, self.r, self.dx, self.scale)
            self._contacts = CoupledContacts(contacts, equations, self._end_rule, factors)

    def _factorise_for_contacts(self) -> None:
        """Factorise the matrix at the end of the step."""
        self._refactorise(Refactorisation.ALL, self.s.H1)

    def _solve_for_contacts(self) -> None:
        """Solve for the motion by contact forces; free rigid bodies move as those alone do.

        The matrix has their mass: in increments with gyroscopic terms, else in twists.
        """
        self._solve(self.solver.solve)
        if self.matrix_terms.gyroscopic:
            to_increments(self.s.kinds, self.s.inverse, self.dx)

    @property
    def _end_rule(self) -> Rule:
        return Rule(self.p.h, self.p.mass, self.p.damping)

    def _set_size(self, h: float) -> None:
        super()._set_size(h)
        if self._contacts is not None:
            self._contacts.set_rule(self._end_rule)

    @property
    def _idle(self) -> Indices:
        """Equations of unknowns that are held, and of constraints that do not act."""
        held, inactive = self.equations.unknowns.held, self.equations.matrix.inactive
        return np.append(np.flatnonzero(held), held.size + np.flatnonzero(inactive))

    @cached_property
    def _packed(self) -> PackedArrays:
        known, s, balance = self.equations.arrays, self.s, self.balance
        forces = _NOWHERE if self.forces.addresses is None else self.forces.addresses
        stored = (_NOWHERE, _NOTHING) if known.stored is None else known.stored
        packed = Packed(
            *s.plain,
            self._elastic,
            self._fixed,
            self.multipliers,
            self._first,
            *self._sizes,
            self._idle,
            self.r,
            self.dx,
            forces,
            balance.addresses,
            balance.total,
            balance.targets,
            (known.joints, known.probes),
            stored,
            known.around,
            self.progress,
            self.decisions.known,
        )
        return PackedArrays(packed)

    @property
    def _ends(self) -> bool:
        """Whether the compiled loop ends steps itself."""
        balance = self.balance
        ends = not self._remembers and self._contacts is None
        return ends and (balance.empty or balance.compiled)

    def _compile(self) -> None:
        if self._rule is not None:
            self._go(self.index, _NOTHING, (_NOWHERE, _NOWHERE), ends=False)

    def history(
        self, plan: EqualSteps, progress: bool | None, store: Checkpoints | None
    ) -> Recorder:
        """Create a history that takes its rows from the equations."""
        if not plan.saving.with_balance:
            self.balance.rest()
        if self._contacts is not None:
            self._contacts.history.begin(plan.steps)
        return Recorder(self.equations, plan, progress, store)

    # --- steps ---

    def _advance(self, history: Recorder) -> bool:
        if self._rule is not None and self._ends and not self.division.level:
            return self._make_in_loop(history)
        return self._in_parts(history)

    def _in_parts(self, history: Recorder) -> bool:
        """Make the next step, divided if necessary; return whether it was made."""
        self._taken = 0
        if self._contacts is not None:
            self._contacts.history.begin_step(self.index + 1)
        made = self._cover()
        history.count += self._taken
        return made

    def attempt(self, start: float, end: float) -> bool:
        """Make a step, see :class:`~fem_lie.solve.division.Divisible`."""
        self.progress.step, self._end = self.begun, end
        before, motion = self.s.H.copy(), None
        if self._contacts is not None:
            motion = self.s.motion.copy()
            self._contacts.begin(before, self.s.twist1, start)
        self._go_to_time(end)
        iterations = self._take_step()
        self._taken += iterations
        if iterations and self._contacts is not None:
            assert motion is not None
            if not self._touch(self._contacts, end):
                self.s.H[:], self.s.motion[:] = before, motion
                self.multipliers[:] = self._first
                return False
            return self._accept_history(before)
        if iterations:
            self._turn()
            return self._close(end, before)
        self.multipliers[:] = self._first
        return False

    def _touch(self, contacts: CoupledContacts, end: float) -> bool:
        """Apply contact impulses at the end of an accepted step, and account for their work.

        Returns whether contacts were solved.
        """
        s = self.s
        changed = contacts.resolve(StepEnd(s.H, s.twist1, end))
        if contacts.failure:
            contacts.abandon()
            return False
        self.balance.add(self.p.h, end, *self._accepted)
        if changed is not None:
            before = self._accepted._replace(H=s.H.copy(), v=s.twist1.copy())
            s.change_end(changed.frames, changed.twists, changed.rates)
            self.multipliers += changed.multipliers
            lost = self.balance.collide(end, before, self._accepted, contacts.work)
            contacts.statistics.impact = -lost - contacts.statistics.friction
        contacts.history.add(self.index, block_of(contacts.statistics))
        self.reason = contacts.passed(s.H)
        self._turn()
        return not self.reason

    def _make_in_loop(self, history: Recorder) -> bool:
        """Make as many steps as the loop can make and record by itself, at least one."""
        progress, index, most = self.progress, self.index, 1 if self._prescribes else self._most
        self.reason = ""
        if history.whole and self._fills:
            last, wanted = history.steps_in_loop(index, most)
        else:
            last, wanted = min(history.next_stop(index), index + most), _NOTHING
        self._go_to_time((index + 1) * self.h)
        progress.row, progress.wanted, progress.total = history.row, 0, history.count
        made = self._go(last, wanted, (history.scene, history.arrays.addresses), ends=True)
        filled = progress.wanted
        self._filled = int(wanted[filled - 1]) if filled else -1
        history.row, history.count = int(progress.row), int(progress.total)
        history.turns_far = bool(progress.near)
        self._end = self.index * self.h
        if not made:
            iterations = self._fallback_converged()
            history.count += iterations
            if iterations:
                self._turn()
                return self._close(self._end)
            if not self.divides:
                return False
            self.progress.step -= 1
            self.multipliers[:] = self._first
            self.division.halve(self, self.index * self.h, self.h)
            return self._in_parts(history)
        return True

    def _go(
        self, last: int, wanted: Indices, results: tuple[Indices, Indices], *, ends: bool
    ) -> bool:
        """Advance to the end of step ``last`` in the compiled loop.

        Return whether it was reached.
        """
        addresses = self._packed.addresses

        def call(
            scheme: PlainScheme, solution: PlainSolution, steps: PlainSteps, rule: PlainRule
        ) -> int:
            return loop.run(addresses, scheme, solution, steps, rule, results, wanted, last)

        return self._serve(call, ends)

    def _serve(self, call: CompiledLoop, ends: bool) -> bool:
        """Call a compiled loop until it is done, and serve its requests.

        Return whether all could be served.

        Args:
            call: The loop, which returns why it returned.
            ends: Whether it ends steps itself.
        """
        assert self._rule is not None
        while True:
            here = self._guided or self._secants is not None
            solution = Solution.none() if here else self.solver.by_call
            code = call(self._plain[0], solution.plain, self._how(ends), self._rule)
            if code in (loop.DONE, loop.EVENT):
                return True
            if code == loop.FAILED or not self._served(code):
                return False

    def _how(self, ends: bool) -> PlainSteps:
        options, balance = self.options, self.balance
        return Steps(
            tolerance=options.tolerance,
            finest=self._finest,
            limit=options.max_iterations,
            factor=self._factor,
            summed=self.equations.arrays.in_one_sum,
            missing=self._missing,
            checked=self.equations.matrix.redundant,
            ended=ends,
            turns=self.equations.arrays.turns,
            accounts=not balance.empty,
            loads=balance.looks[0],
            joints=balance.looks[1],
            began=self._began,
        ).plain

    def _served(self, code: int) -> bool:
        """Serve a request of the loop; return whether the step may continue."""
        progress = self.progress
        if code == loop.RESIDUAL:
            self._find(self._end_instant)
            return True
        if code == loop.QUESTION:
            iterations, ratio = int(progress.iteration), float(progress.ratio)
            self.decisions.answer(iterations, ratio, self._staleness())
            return True
        if code == loop.CHECK:
            return not self._contradicts(self._tolerance(), stagnant=False)
        try:
            if code == loop.MATRIX:
                self._refactorise(Refactorisation(progress.update), self.s.H1)
            self._solve(self.solver.correct)
        except SingularMatrixError:
            progress.increment, progress.phase = np.inf, BETWEEN
            return False
        return True

    def _take_step(self) -> int:
        """Make one step; return its iterations, failed ones included; 0 if all attempts failed."""
        self.reason = ""
        if self._rule is None:
            self.progress.step += 1
            self._first[:] = self.multipliers
            count = self._iterate(self.decisions, linearised=False)
        else:
            self.progress.total = 0
            none = _NOTHING, (_NOWHERE, _NOWHERE)
            made = self._go(self.index + 1, *none, ends=False)
            count = int(self.progress.total) if made else 0
        return count or self._fallback_converged()

    def _turn(self) -> None:
        self.equations.history_variables.rotate_axes(self.s.H, self.s.motion, WRITTEN)

    def _fallback_converged(self) -> int:
        """Repeat a step that failed with the frozen matrix; return all its iterations, or 0.

        It is repeated with a new matrix in every iteration and with linearised stress updates.
        """
        if not self._may_fall_back:
            return 0
        in_vain = int(self.progress.iteration)
        _log.info("step %d: frozen matrix diverges, full Newton iteration", self.index)
        self.multipliers[:] = self._first
        # the predicted end of the step may be far off: its stress is not a good initial guess
        self.equations.history_variables.update_stress(self.s.H)
        count = self._iterate(EveryIteration().begin(bound=False), linearised=True)
        # its matrices had all terms
        self._outgrown = self._may_correct
        return count + in_vain if count else 0

    def _close(self, end: float, start: Array | None = None) -> bool:
        """Update the state of the equations after an accepted step, and the energy balance.

        Returns whether it stays accepted: no surfaces passed through each other since ``start``.
        """
        if not self._accept_history(start):
            return False
        self.balance.add(self.p.h, end, *self._accepted)
        return True

    # --- results ---

    def _record(self, history: Recorder) -> bool:
        if self._filled == self.index > 0:
            history.show_progress(self.index)
            return True
        kept = history.record(self.index, *self._recorded, self.balance.so_far)
        if kept and self.index and self._contacts is not None:
            self._contacts.record(self.s.H, self.index * self.h)
        return kept

    @property
    def _recorded(self) -> TimeState:
        """The current state for results; joint forces include impulses over the last step."""
        impulses = self.impulses
        if self._contacts is not None:
            impulses = impulses + self._contacts.reactions
        return self._accepted._replace(multipliers=self.multipliers + impulses / self.p.h)

    def _result(self, history: Recorder) -> Result:
        solver = self.solver
        self.division.report(self.index)
        counts = solver.refreshes, self.division.divided
        others: dict[str, object] = {"subdomains": solver.subdomains}
        if self._contacts is not None:
            others["contacts"] = steps = self._contacts.history.result(self.h)
            history.add(steps)
        made = history.result(solver.factorisations, history.seconds, *counts)
        return with_others(made, others)

    def _failure(self, steps: int) -> str:
        limit, tolerance = self.options.max_iterations, self.options.tolerance
        residual = float(np.abs(self.r).max())
        wedged = "" if self._contacts is None else self._contacts.failure
        if reason := self.reason or wedged:
            text = f"step {self.index} of {steps} (time {self._end:g}) failed: {reason}"
            return self._nor_in_parts(text)
        after_fallback, reached = self._may_fall_back, float(self.progress.increment)
        of_step = self.index, steps, self.h, limit, reached, residual, tolerance, after_fallback
        text = failure(*of_step, *_damping(self.options.radius))
        return self._nor_in_parts(text)
