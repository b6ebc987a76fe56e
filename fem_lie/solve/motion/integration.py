"""The steps of one run with a constant step, and what the next ones depend on.

What all schemes have in common: the clock, results, checkpoints. How a step is made is theirs.
"""

from __future__ import annotations

import logging
from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Generic, TypeVar

import numpy as np

from fem_lie._arrays import Array
from fem_lie.bodies.turning import FoldedElementError
from fem_lie.forms.term import PassedThroughError
from fem_lie.linear.direct import ConvergenceError
from fem_lie.results import Result
from fem_lie.solve.motion.division import Division
from fem_lie.solve.motion.policies import Policy
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.recorder import History
from fem_lie.solve.recording.saving import Saving
from fem_lie.solve.stopwatch import Stopwatch
from fem_lie.system.equations import Equations

_log = logging.getLogger(__name__)

Kept = TypeVar("Kept", bound=History)


class Integration(ABC, Generic[Kept]):
    """State of one integration, whose results go into a history of the kind ``Kept``.

    Attributes:
        equations: Of the scene.
        h: Step size.
        decisions: When to factorise.
        reason: Why the last step failed, where more is known than that it did not converge.
        choices: What the matrix takes in.
    """

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
        self.reason = ""
        spin = float(np.abs(equations.start.velocities[:, 3:]).max())
        self.choices = equations.scene.choices.resolve(spin * step)
        told = equations.unknowns.told, self.choices, type(policy).__name__
        _log.info("%s; %s; matrix: %s", *told)

    @abstractmethod
    def history(
        self, steps: int, saving: Saving, progress: bool | None, store: Checkpoints | None
    ) -> Kept:
        """Where results go; see :class:`~fem_lie.solve.recording.recorder.History`."""

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

    def integrate(self, history: Kept) -> Result:
        """All steps from the present one on.

        Raises:
            ConvergenceError: A step failed; its ``result`` holds what was computed.
        """
        if history.fresh:
            self.start()
            self._keep(history)
        watch = Stopwatch(history.seconds)
        with history:
            while self.index < history.steps:
                done = self._advance(history)
                history.seconds = watch.seconds
                if not done:
                    raise ConvergenceError(self._failure(history.steps), self._result(history))
                self._keep(history)
                if history.checkpoint_due(self.index):
                    history.write_checkpoint(self.index, self.memory())
        return self._result(history)

    def _keep(self, history: Kept) -> None:
        """Keep the present state, if it is one to be kept; its elements must not have folded."""
        if not self._record(history):
            return
        if not history.turns_far:
            return
        time = float(history.times[history.row - 1])
        try:
            self.equations.report(self.frames).check_turns(time)
        except FoldedElementError as error:
            raise ConvergenceError(f"an element folds: {error}", self._result(history)) from None

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

    def memory(self) -> dict[str, Array]:
        """All that the next steps depend on."""
        learned = self.decisions.memory()
        policy = {f"policy.{name}": value for name, value in learned.items()}
        return self.equations.memory.saved(matrix=True) | policy

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Be as when :meth:`memory` was called."""
        self.equations.memory.restore(kept)
        self.decisions.restore({name: kept[f"policy.{name}"] for name in self.decisions.memory()})


class DividedIntegration(Integration[Kept]):
    """One whose steps are made in parts where no solution is found in full.

    Attributes:
        division: Into how many parts.
    """

    def __init__(
        self, policy: Policy, equations: Equations, step: float, *, bound: bool = False
    ) -> None:
        """As the base class."""
        super().__init__(policy, equations, step, bound=bound)
        self.division, self._rescues = Division(), policy.rescue

    def _cover(self) -> bool:
        """Make the next step by :meth:`attempt`, in parts if it takes these; whether it is made."""
        return self.division.cover(self, self.index * self.h, (self.index + 1) * self.h)

    @property
    def divides(self) -> bool:
        """Whether a step that failed may be made in parts.

        Not by policies that want an error, and smaller steps have the same contradictions.
        """
        return self._rescues and not self.reason

    @abstractmethod
    def resize(self, time: float, size: float) -> None:
        """See :class:`~fem_lie.solve.motion.division.Divisible`."""

    @abstractmethod
    def attempt(self, start: float, end: float) -> bool:
        """See :class:`~fem_lie.solve.motion.division.Divisible`."""

    def memory(self) -> dict[str, Array]:
        """See the base class."""
        return super().memory() | self.division.memory()

    def restore(self, kept: Mapping[str, Array]) -> None:
        """See the base class."""
        super().restore(kept)
        self.division.restore(kept)
