"""The loop over the steps of any run: start, steps, rows of results, checkpoints.

How a step is made, and how large it is, belongs to what is driven.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, Generic, TypeVar

from fem_lie._arrays import Array
from fem_lie._state import Stateful
from fem_lie.bodies.turning import FoldedElementError
from fem_lie.linear.direct import ConvergenceError
from fem_lie.results import Result
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.plan import Plan
from fem_lie.solve.recording.recorder import History
from fem_lie.solve.stopwatch import Stopwatch
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
