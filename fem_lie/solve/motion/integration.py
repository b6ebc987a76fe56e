"""The loop over the steps of any run, and what runs with constant steps have in common.

The loop over the steps of any run: start, steps, rows of results, checkpoints.

How a step is made, and how large it is, belongs to what is driven.
"""

from __future__ import annotations

import logging
from abc import ABC, abstractmethod
from typing import Any, Generic, TypeVar

import numpy as np

from fem_lie._arrays import Array
from fem_lie._state import HasState, Stateful, attributes
from fem_lie.bodies.nodes import FoldedElementError
from fem_lie.forms.abilities import PassedThroughError
from fem_lie.linear.direct import ConvergenceError
from fem_lie.results import Result
from fem_lie.solve.division import HALVINGS, Division
from fem_lie.solve.motion.policies import Policy
from fem_lie.solve.progress_bars import Stopwatch
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.plan import Plan
from fem_lie.solve.recording.recorder import History
from fem_lie.system.equations import Equations

Kept = TypeVar("Kept", bound=History)


class Driver(ABC, Stateful, Generic[Kept]):
    """One run, whose results go into a history of the kind ``Kept``.

    Attributes:
        equations: Of the scene.
    """

    equations: Equations

    @abstractmethod
    def history(self, plan: Any, progress: bool | None, store: Checkpoints | None) -> Kept:
        """Where results go.

        Args:
            plan: What the run is to do, a :class:`~fem_lie.solve.recording.plan.Plan`.
            progress: Show a bar; ``None``: if standard error is a terminal.
            store: Where results and checkpoints go, if not into memory.
        """

    @abstractmethod
    def start(self) -> None:
        """Make the state consistent at time 0."""

    @property
    @abstractmethod
    def frames(self) -> Array:
        """Of all rows, at the present state."""

    @property
    @abstractmethod
    def index(self) -> int:
        """Steps made, and the one that is being made."""

    def _finished(self, history: Kept) -> bool:
        """Whether the end is reached."""
        return self.index >= history.steps

    @abstractmethod
    def _advance(self, history: Kept) -> bool:
        """Go on to the next step at which there is something to do; whether it was reached."""

    @abstractmethod
    def _record(self, history: Kept) -> bool:
        """Keep the present state, if it is one to be kept; whether it was."""

    @abstractmethod
    def _result(self, history: Kept) -> Result:
        """What was kept so far."""

    @abstractmethod
    def _failure(self, steps: int) -> str:
        """What to say when the present one of ``steps`` has failed."""

    def _save(self, history: Kept) -> None:
        """Write a checkpoint."""
        history.write_checkpoint(self.index, self.memory())

    def run(self, plan: Plan, progress: bool | None, store: Checkpoints | None) -> Result:
        """All steps from the start on, or from the checkpoint that a store has.

        Raises:
            ConvergenceError: A step failed; its ``result`` holds what was computed.
        """
        history = self.history(plan, progress, store)
        if not history.fresh:
            assert store is not None
            self.restore(store.memory)
        return self.integrate(history)

    def integrate(self, history: Kept) -> Result:
        """All steps from the present one on; see :meth:`run`."""
        if history.fresh:
            self.start()
            self._keep(history)
        watch = Stopwatch(history.seconds)
        with history:
            while not self._finished(history):
                done = self._advance(history)
                history.seconds = watch.seconds
                if not done:
                    raise ConvergenceError(self._failure(history.steps), self._result(history))
                self._keep(history)
                if history.checkpoint_due(self.index):
                    self._save(history)
        return self._result(history)

    def _keep(self, history: Kept) -> None:
        """Keep the present state, if it is one to be kept; its elements must not have folded."""
        if not self._record(history) or not history.turns_far:
            return
        time = float(history.times[history.row - 1])
        try:
            self.equations.report(self.frames).check_turns(time)
        except FoldedElementError as error:
            raise ConvergenceError(f"an element folds: {error}", self._result(history)) from None


_log = logging.getLogger(__name__)


class Integration(Driver[Kept]):
    """A run whose steps have one size.

    Attributes:
        h: Step size.
        decisions: When to factorise.
        reason: Why the last step failed, where more is known than that it did not converge.
        choices: What the matrix takes in.
        carried: What equations remember beside the state; by default with the matrix.
    """

    STATE = attributes("decisions", "carried")

    def __init__(
        self, policy: Policy, equations: Equations, step: float, *, bound: bool = False
    ) -> None:
        """Nothing is computed yet.

        Args:
            policy: When to factorise.
            equations: Of the scene.
            step: Step size.
            bound: Whether the constraints may be refreshed by themselves.
        """
        self.equations, self.h, self.decisions = equations, float(step), policy.begin(bound)
        self.carried: HasState = equations.memory.with_matrix
        self.reason = ""
        spin = float(np.abs(equations.start.velocities[:, 3:]).max())
        self.choices = equations.scene.choices.resolve(spin * step)
        told = equations.unknowns.summary, self.choices, type(policy).__name__
        _log.info("%s; %s; matrix: %s", *told)

    def _remembered(self, start: Array | None, middle: Array | None = None) -> bool:
        """Go on from the present frames; whether surfaces did not go through each other.

        Args:
            start: Frames at the start of the step; without them it is not looked whether they did.
            middle: Frames at which forces act in the step; default: at both ends.
        """
        try:
            self.equations.memory.accept(self.frames, start)
        except PassedThroughError as error:
            self.reason = str(error)
            return False
        if start is not None:
            self.equations.memory.watch(start, self.frames, self.h, middle)
        return True

    def _keep_apart(self, start: Array, end: Array) -> bool:
        """Whether no surfaces go through each other in a step that is not yet accepted.

        If they do, :attr:`reason` names them.

        Args:
            start: Frames of all rows at its start.
            end: At its end.
        """
        self.reason = ""
        try:
            self.equations.memory.check_passage(start, end)
        except PassedThroughError as error:
            self.reason = str(error)
        return not self.reason

    def _because(self, text: str, steps: int, index: int) -> str:
        """What failed: :attr:`reason` if it is known, else ``text``."""
        return (
            f"step {index} of {steps} (h = {self.h:g}) failed: {self.reason}"
            if self.reason
            else text
        )


class Divided(Driver[Kept]):
    """A run whose steps are made in parts where no solution is found in full.

    Attributes:
        h: Step size.
        reason: Why the last step failed, where smaller ones would fail, too.
        division: Into how many parts.
        begun: Steps made before the present one, of which a part counts as one while it is made.
    """

    STATE = attributes("division")

    h: float
    reason: str

    def __init__(self, policy: Policy, step: float) -> None:
        """No step is made yet.

        Args:
            policy: Whether steps that failed are tried otherwise.
            step: Step size.
        """
        self.h, self.reason = float(step), ""
        self.division, self._rescues, self.begun = Division(), policy.rescue, 0

    def _cover(self) -> bool:
        """Make the next step by :meth:`attempt`, in parts if it takes these; whether it is made."""
        self.begun = self.index
        start, end = self.index * self.h, (self.index + 1) * self.h
        return self.division.cover(self, start, end, self.h)

    def _divide(self) -> bool:
        """Make the next step, which has failed in full, in parts; whether it is made."""
        self.division.halve(self, self.index * self.h, self.h)
        return self._cover()

    @property
    def part_size(self) -> float:
        """Of the present step or part, without the round-off of differences of times."""
        return self.h / self.division.parts

    def _nor_in_parts(self, text: str) -> str:
        """What failed, and that parts of it failed, too, if it was made in these."""
        return f"{text}. Nor did it in {2**HALVINGS} parts" if self.divides else text

    @property
    def divides(self) -> bool:
        """Whether a step that failed may be made in parts.

        Not by policies that want an error, and smaller steps have the same contradictions.
        """
        return self._rescues and not self.reason

    @abstractmethod
    def resize(self, time: float, size: float) -> None:
        """See :class:`~fem_lie.solve.division.Divisible`."""

    @abstractmethod
    def attempt(self, start: float, end: float) -> bool:
        """See :class:`~fem_lie.solve.division.Divisible`."""


class DividedIntegration(Integration[Kept], Divided[Kept]):
    """An integration whose steps are made in parts where no solution is found in full."""

    def __init__(
        self, policy: Policy, equations: Equations, step: float, *, bound: bool = False
    ) -> None:
        """As the base classes."""
        Divided.__init__(self, policy, step)
        super().__init__(policy, equations, step, bound=bound)
