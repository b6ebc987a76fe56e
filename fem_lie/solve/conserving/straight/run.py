"""A run of the conserving scheme on nodes of any kind: its steps, results, checkpoints."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from typing import Any

import numpy as np

from fem_lie._arrays import Array
from fem_lie.lie.kinds import placed
from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.linear.factors import Factors
from fem_lie.results import Result
from fem_lie.solve.conserving.between.end_forces import at_end
from fem_lie.solve.conserving.step.dissipation import LENGTH
from fem_lie.solve.conserving.straight import nodes as motion
from fem_lie.solve.conserving.straight.acceptance import accept
from fem_lie.solve.conserving.straight.any_state import AnyState
from fem_lie.solve.conserving.straight.patience import (
    ASTRAY,
    PATIENCE,
    is_lost,
    lags,
    round_off,
    stalls,
)
from fem_lie.solve.conserving.straight.records import ENERGY
from fem_lie.solve.motion.convergence import ROUND_OFF, estimate, failure
from fem_lie.solve.motion.policies import Decisions, EveryIteration, Never, Policy
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.recorder import Recorder
from fem_lie.solve.recording.saving import Saving
from fem_lie.solve.secants import Secants
from fem_lie.system.equations import Equations

_log = logging.getLogger(__name__)

HALVINGS = 6
"""Of a step that has no solution in full."""
_SAME = 1e-9
"""Of the step, by which its size differs from itself."""
_LEARNT, _SPIRALS = 8, 10.0
"""Corrections that one learns from where the matrix alone fails, and the most that they may grow
by."""
_CANCELLED = 1e-13
"""Of the largest energy of a run, errors of energies that are reported."""


class StraightRun(AnyState):
    """One integration."""

    def __init__(
        self,
        policy: Policy,
        equations: Equations,
        step: float,
        told: tuple[float, int],
        loss: float = 0.0,
    ) -> None:
        """Allocate everything; nothing is computed yet.

        Args:
            policy: When to factorise.
            equations: Of the scene.
            step: Step size.
            told: Tolerance, and most iterations, of
                :class:`~fem_lie.solve.conserving.energy_momentum.EnergyMomentum`.
            loss: χ of :mod:`fem_lie.solve.conserving.step.dissipation`.
        """
        super().__init__(policy, equations, step, loss)
        self._tolerance, self._limit = told
        self._rescues, self._iterations = policy.rescue, 0
        self._increment, self._before = np.inf, np.zeros(equations.unknowns.m)
        self._divided = self._parts = 0

    def history(
        self, steps: int, saving: Saving, progress: bool | None, store: Checkpoints | None
    ) -> Recorder:
        """See the base class."""
        return Recorder(self.equations, steps, self.h, saving, progress, store)

    # --- steps ---

    def _advance(self, history: Recorder) -> bool:
        before, divided = self._iterations, self._parts
        made = self._go(self.index * self.h, (self.index + 1) * self.h, HALVINGS)
        history.count += self._iterations - before
        self._turning.note(self.this.step[self._frames, 3:])
        if made:
            self._made += 1
            self._divided += self._parts > divided
        return made

    def _go(self, start: float, end: float, halvings: int) -> bool:
        """Go from one time to another in a step, or in as many as it takes; whether that is done.

        Args:
            start: Time at which the step begins.
            end: At which it ends.
            halvings: How often it may be halved.
        """
        self._resize(end - start)
        self._set_step(start, end)
        self._before[:] = self.s.weights
        self.reason = ""
        if self._step() and self._stays_apart():
            self._accept()
            return True
        if not self._rescues or halvings == 0:
            return False
        self._parts += 1
        self.s.weights[:] = self._before
        middle = 0.5 * (start + end)
        return self._go(start, middle, halvings - 1) and self._go(middle, end, halvings - 1)

    def _stays_apart(self) -> bool:
        """Whether no surfaces go through each other in the step that has converged."""
        H = self.s.H.copy()
        H[: self._n], H[self._n + 1 :] = self.this.end, self.joints.moved[1]
        return self._keep_apart(self.s.H, H)

    def _resize(self, size: float) -> None:
        """Let steps have this size; what is left over is an impulse."""
        if abs(size - self.size) > _SAME * self.h:
            share, s = size / self.size, self.s
            for memory in (s.w, s.w_F, s.lasting[1]):
                memory *= share
            s.lag[LENGTH] *= share * share
            s.carry[:] *= 1.0 / share
            self.size, self._factors = size, None

    def _accept(self) -> None:
        """Make the end of the step the start of the next one."""
        s = self.s
        accept(self.model, s, self.this, self.size)
        s.earlier[1], s.earlier[0] = s.earlier[0].copy(), self._before
        s.H[self._n + 1 :] = self.joints.moved[1]
        self._rates[1], self._rates[0] = self._rates[0], 2.0 * s.trend
        self._sizes[1:], self._sizes[0] = self._sizes[:2].copy(), self.size
        self.equations.memory.accept(s.H)
        self.joints.accept(s.H, s.gap)
        if self._pushes:
            self._pushes.go_on()
            if not self._pushed.any():
                self._pushes.overlap(s.H)
        self.equations.memory.turn_axes(s.H)

    def _set_step(self, start: float, end: float) -> None:
        """Loads in the middle of the next step, targets and prescribed motions at both its ends."""
        if not self._changing:
            return
        self._set_time(0.5 * (start + end))
        before, after = (self.equations.prescribed(time) for time in (start, end))
        if self.equations.unknowns.driven:
            self.joints.driven[:] = after.targets - before.targets
        self.joints.moved[0], self.joints.moved[1] = self.s.H[self._n + 1 :], after.frames

    def _step(self) -> bool:
        """Make the step from its start; whether it converges."""
        if self._made_with(self.decisions, still=False):
            return True
        if not self._rescues:
            return False
        if self._made_learning():
            return True
        _log.info("step %d: kept matrix diverges, new matrices", self.index + 1)
        return any(
            self._made_with(EveryIteration().begin(bound=False), still=still)
            for still in (False, True)
        )

    def _made_learning(self) -> bool:
        """The same with one new matrix, whose corrections learn from each other.

        What cells feel of the rotation of a step is not in the matrix: a few directions, in which
        no matrix helps.
        """
        kept, measure = self._secants, np.append(self._measure, np.zeros(len(self.s.weights)))
        self._secants, self._factors = Secants(_LEARNT, measure, growth=_SPIRALS), None
        made = self._made_with(Never().begin(bound=False), still=False)
        self._secants = kept
        return made

    def _begin(self, *, still: bool) -> float:
        """Where the iteration begins; the size of the largest motion."""
        if self._secants is not None:
            self._secants.forget()
        motion.predict(self.model, self.s, self.this, self.size)
        if still:
            self.this.step[:] = 0.0
        self.s.weights[:] = self._before
        self.joints.begin(self.s.H)
        return float(np.abs(self.this.step.ravel() * self._measure).max(initial=0.0))

    def _made_with(self, decisions: Decisions, *, still: bool) -> bool:
        """The same with matrices as they say; ``still``: without a prediction."""
        s, this, model, largest = self.s, self.this, self.model, self._begin(still=still)
        previous, ratio, needed, seen = np.inf, 1.0, 1, list[float]()
        unknowns = self.equations.unknowns
        least = round_off(s.H[: self._n][placed(unknowns.kinds), 0], unknowns.length)
        for iteration in range(1, self._limit + 1):
            self._iterations += 1
            self._evaluate()
            # at the last digits no matrix helps: they are told neither of late nor of many of these
            fine = previous <= least
            asked = iteration == 1 or (not fine and lags(decisions, previous, ratio, least))
            due = asked and decisions.before_iteration(iteration)
            if self._factors is None or due:
                try:
                    self._factorise()
                except SingularMatrixError:
                    return False
            self._solve()
            needed = needed if fine else iteration
            # multipliers are linear, and follow
            moved = self._x[: 6 * self._n] * self._measure
            increment = float(np.abs(moved).max(initial=0.0))
            ratio, remaining = estimate(increment, previous, ratio)
            self._increment, largest = increment, max(largest, increment)
            seen.append(increment)
            if not increment < ASTRAY or (increment > least and is_lost(seen)):
                return False
            noise = increment <= least and stalls(seen, PATIENCE)
            if noise or increment <= ROUND_OFF or remaining <= self._tolerance * largest:
                if not noise:
                    motion.correct(model, s, this, self._x)
                    self._evaluate()
                decisions.after_step(needed)
                return True
            motion.correct(model, s, this, self._x)
            previous = increment
        return False

    def _failure(self, steps: int) -> str:
        left = float(np.abs(self.this.r).max(initial=0.0))
        numbers = self._limit, self._increment, left, self._tolerance
        text = failure(self.index + 1, steps, self.h, *numbers, self._rescues)
        text = self._because(text, steps, self.index + 1)
        return f"{text}. Nor did it in {2**HALVINGS} parts" if self._rescues else text

    # --- results ---

    def _record(self, history: Recorder) -> bool:
        history.show_progress(self.index)
        wanted = history.wants(self.index)
        if wanted:
            time = self.index * self.h
            v, rates = np.empty((2, self._n, 6))
            # along the line through the middles of the last two steps
            share, s = self._sizes[0] / (self._sizes[0] + self._sizes[1]), self.s
            last = self._rates[0] + share * (self._rates[0] - self._rates[1])
            motion.twists(self.model, s.H, s.V, last, v, rates)
            if self._changing:
                self._set_time(time)
            moved, stored = (s.V, v, rates), float(s.W.sum()) + self.joints.energy(s.H)
            stored += self._pushes.energy + self._pushes.held
            history.fill_rates(time, s.H, moved, stored, self._end_weights(), s.books)
        return wanted

    def _end_weights(self) -> Array:
        """Multipliers at the end of the last step; in the first two those over it."""
        s = self.s
        if self.index < 3:
            return s.weights
        return at_end(s.weights, s.earlier, self._sizes)

    def _result(self, history: Recorder) -> Result:
        self._turning.report()
        if self._divided:
            _log.warning(
                "%d of %d steps were made in parts, where no solution was found in full",
                *(self._divided, self.index),
            )
        cancels, most = self.model.cells.cancels, float(self.s.told[ENERGY])
        error = float(np.linalg.norm(cancels))
        if error > _CANCELLED * most:
            _log.warning(
                "energies of %d cells are differences of larger numbers, and known to %.1e of %.1e "
                "only: energy is conserved no better. Write the law with fem_lie.log1p, expm1 and "
                "det_minus_one, which keep all digits of small strains",
                *(np.count_nonzero(cancels), error, most),
            )
        return history.result(self._factorisations, history.seconds, divided=self._divided)

    # --- checkpoints ---

    def memory(self) -> dict[str, Array]:
        """All that the next steps depend on."""
        kept: dict[str, Any] = {f"s.{name}": value for name, value in self.s._asdict().items()}
        kept |= {"middle": self.this.middle, "rates": self._rates}
        kept |= {"pushes": self._pushes.saved}
        kept |= {"turned": self.joints.turned.copy(), "reached": self.joints.reached}
        counts = self._made, self._factorisations, self._iterations, self._divided
        kept |= {"counts": np.array(counts), "sizes": self._sizes}
        kept |= super().memory()
        kept |= {f"local.{k}": part for k, part in enumerate(self.framed.local_fields)}
        return kept if self._factors is None else kept | self._factors.arrays()

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Be as when :meth:`memory` was called."""
        for name, array in self.s._asdict().items():
            array[:] = kept[f"s.{name}"]
        self.this.middle[:], self._rates[:] = kept["middle"], kept["rates"]
        self.joints.turned[:], self.joints.reached[:] = kept["turned"], kept["reached"]
        self._pushes.restore(kept["pushes"])
        counts = (int(count) for count in kept["counts"])
        self._made, self._factorisations, self._iterations, self._divided = counts
        self._sizes[:], self.size = kept["sizes"], float(kept["sizes"][0])
        self.framed.restore([kept[f"local.{k}"] for k in range(len(self.framed.local_fields))])
        super().restore(kept)
        self._factors = Factors.of(kept)
