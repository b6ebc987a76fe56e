"""The loop over the steps of any run: start, steps, rows of results, checkpoints.

The driven run makes the steps and chooses their sizes. Base classes for runs with constant steps
are here, too.
"""

from __future__ import annotations

import logging
from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, Generic, TypeVar

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._state import HasState, Stateful, attributes
from fem_lie.bodies.model import FoldedElementError
from fem_lie.forms.abilities import PassedThroughError
from fem_lie.joints.connection import LostBranchError
from fem_lie.joints.laws import ForceLawError
from fem_lie.linear.direct import ConvergenceError
from fem_lie.results import Result
from fem_lie.solve.division import HALVINGS, Division
from fem_lie.solve.motion.policies import RefactorisationPolicy
from fem_lie.solve.progress_bars import Stopwatch
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.plan import Plan
from fem_lie.solve.recording.recorder import History
from fem_lie.solve.recording.whole_state import NO_CELLS, MovingState
from fem_lie.solve.running_state import EventError
from fem_lie.system.equations import Equations

HistoryT = TypeVar("HistoryT", bound=History)


class Driver(ABC, Stateful, Generic[HistoryT]):
    """One run, whose results go into a history of type ``HistoryT``.

    Attributes:
        equations: Equations of the scene.
    """

    equations: Equations

    @abstractmethod
    def history(self, plan: Any, progress: bool | None, store: Checkpoints | None) -> HistoryT:
        """Create the history for the results.

        Args:
            plan: Plan of the run, a :class:`~fem_lie.solve.recording.plan.Plan`.
            progress: Show a bar; ``None``: if standard error is a terminal.
            store: File of results and checkpoints; ``None``: keep results in memory.
        """

    @abstractmethod
    def start(self) -> None:
        """Make the state consistent at time 0."""

    @property
    @abstractmethod
    def frames(self) -> Array:
        """Current frames of all nodes, ground and prescribed motions."""

    @property
    @abstractmethod
    def index(self) -> int:
        """Number of steps made, including the current one."""

    def _finished(self, history: HistoryT) -> bool:
        """Whether the end of the run is reached."""
        return self.index >= history.steps

    @abstractmethod
    def _advance(self, history: HistoryT) -> bool:
        """Advance to the next step with something to do; return whether it was reached."""

    @abstractmethod
    def _record(self, history: HistoryT) -> bool:
        """Record the current state if it is due; return whether it was."""

    @abstractmethod
    def _result(self, history: HistoryT) -> Result:
        """Result of the states recorded so far."""

    @abstractmethod
    def _failure(self, steps: int) -> str:
        """Error message if the current one of ``steps`` has failed."""

    def _save(self, history: HistoryT) -> None:
        """Write a checkpoint."""
        history.save(self.index, self)

    def divided_state(self) -> dict[str, Array]:
        """State of the part of a divided scene: what moves, and what all ranks have in common.

        What moves has the names of :class:`~fem_lie.solve.recording.whole_state.MovingState`.
        Schemes that divide scenes define it.
        """
        raise TypeError(f"{type(self).__name__} does not divide scenes among ranks")

    @property
    def cell_pairs(self) -> Indices:
        """Pairs of cells and nodes of which :meth:`divided_state` has something; default: none."""
        return NO_CELLS

    def restart(self, state: MovingState, common: Mapping[str, Array]) -> None:
        """Restart from the state of a scene that was divided, as :meth:`divided_state`.

        Args:
            state: What moves in the equations of this run.
            common: What all ranks had in common.
        """
        raise TypeError(f"{type(self).__name__} does not divide scenes among ranks")

    def run(self, plan: Plan, progress: bool | None, store: Checkpoints | None) -> Result:
        """Make all steps from the start, or from the checkpoint of a store.

        Args:
            plan: Plan of the run.
            progress: Whether a progress bar is shown.
            store: File of results and checkpoints, or ``None``.

        Raises:
            ConvergenceError: A step failed; its ``result`` holds the states computed so far.
        """
        history = self.history(plan, progress, store)
        if not history.fresh:
            assert store is not None
            store.restore(self)
        return self.integrate(history)

    def integrate(self, history: HistoryT) -> Result:
        """Make all remaining steps; see :meth:`run`.

        Args:
            history: Where results go.
        """
        if history.fresh:
            self.start()
            self._keep(history)
        watch = Stopwatch(history.seconds)
        with history:
            while not self._finished(history):
                done = self._advance_or_fail(history)
                history.seconds = watch.seconds
                if not done:
                    raise ConvergenceError(self._failure(history.steps), self._result(history))
                if history.checkpoint_due(self.index):
                    self._save(history)
        return self._result(history)

    def _advance_or_fail(self, history: HistoryT) -> bool:
        """:meth:`_advance` and record; errors of functions of the user end the run.

        Raises:
            ConvergenceError: A force law or an event failed; its ``result`` holds the states so
                far.
        """
        try:
            done = self._advance(history)
            if done:
                self._keep(history)
            else:
                self.equations.check_laws()
        except (ForceLawError, EventError) as error:
            text = f"step {self.index} failed: {error}"
            raise ConvergenceError(text, self._result(history)) from error
        return done

    def _keep(self, history: HistoryT) -> None:
        """Record the current state if it is due; raise if an element has folded."""
        if not self._record(history) or not self.equations.shared.any(history.turns_far):
            return
        time = float(history.times[history.row - 1])
        try:
            self.equations.report(self.frames).check_rotations(time)
        except FoldedElementError as error:
            raise ConvergenceError(f"an element folds: {error}", self._result(history)) from None


_log = logging.getLogger(__name__)


class Integration(Driver[HistoryT]):
    """Run with steps of one size.

    Attributes:
        h: Step size.
        decisions: Decisions of the refactorisation policy.
        reason: Why the last step failed, if there is a more specific reason than no convergence.
        matrix_terms: Terms of the iteration matrix.
        equations_state: State of the equations apart from frames and velocities; by default with
            the matrix.
    """

    STATE = attributes("decisions", "equations_state")

    def __init__(
        self,
        policy: RefactorisationPolicy,
        equations: Equations,
        step: float,
        *,
        bound: bool = False,
    ) -> None:
        """Set up a run without computing anything.

        Args:
            policy: When to refactorise.
            equations: Equations of the scene.
            step: Step size.
            bound: Whether the constraint Jacobian may be updated separately.
        """
        self.equations, self.h, self.decisions = equations, float(step), policy.begin(bound)
        self.equations_state: HasState = equations.history_variables.with_matrix
        self.reason = ""
        spin = equations.shared.largest(float(np.abs(equations.start.velocities[:, 3:]).max()))
        self.matrix_terms = equations.scene.matrix_terms.resolve(spin * step)
        summary = equations.unknowns.summary, self.matrix_terms, type(policy).__name__
        _log.info("%s; %s; matrix: %s", *summary)

    @property
    def _between(self) -> float:
        """Time between accepted states; default: the step size."""
        return self.h

    def _accept_history(self, start: Array | None, middle: Array | None = None) -> bool:
        """Accept the current frames; return whether surfaces and joints admit them.

        Args:
            start: Frames at the start of the step; without them surfaces are not checked.
            middle: Frames at which forces act in the step; default: at both ends.
        """
        try:
            if start is not None:
                self.equations.history_variables.check_passage(start, self.frames)
            self.equations.history_variables.accept(self.frames, start)
        except (PassedThroughError, LostBranchError) as error:
            self.reason = str(error)
            return False
        if start is not None:
            self.equations.history_variables.watch(start, self.frames, self._between, middle)
        return True

    def _surfaces_stay_separate(self, start: Array, end: Array) -> bool:
        """Whether no surfaces pass through each other in a step that is not yet accepted.

        If they do, :attr:`reason` names them.

        Args:
            start: Frames of all nodes, ground and prescribed motions at its start.
            end: Frames of all nodes, ground and prescribed motions at its end.
        """
        self.reason = ""
        try:
            self.equations.history_variables.check_passage(start, end)
        except PassedThroughError as error:
            self.reason = str(error)
        return not self.reason

    def _because(self, text: str, steps: int, index: int) -> str:
        """Error message: :attr:`reason` if it is known, else ``text``."""
        return (
            f"step {index} of {steps} (h = {self.h:g}) failed: {self.reason}"
            if self.reason
            else text
        )


class Divided(Driver[HistoryT]):
    """Run that divides steps that do not converge.

    Attributes:
        h: Step size.
        reason: Why the last step failed, if smaller steps would fail, too.
        division: Division into sub-steps.
        begun: Number of steps before the current one; a sub-step counts as one while it is made.
    """

    STATE = attributes("division")

    h: float
    reason: str

    def __init__(self, policy: RefactorisationPolicy, step: float) -> None:
        """Start before the first step.

        Args:
            policy: Whether failed steps may be repeated or divided.
            step: Step size.
        """
        self.h, self.reason = float(step), ""
        self.division, self._may_fall_back, self.begun = Division(), policy.full_newton_fallback, 0

    def _cover(self) -> bool:
        """Make the next step by :meth:`attempt`, divided if needed; return whether it was made."""
        self.begun = self.index
        start, end = self.index * self.h, (self.index + 1) * self.h
        return self.division.cover(self, start, end, self.h)

    def _divide(self) -> bool:
        """Make the next step, which failed as a whole, in sub-steps; return whether it was made."""
        self.division.halve(self, self.index * self.h, self.h)
        return self._cover()

    @property
    def part_size(self) -> float:
        """Size of the current step or sub-step, without the round-off of differences of times."""
        return self.h / self.division.parts

    def _nor_in_parts(self, text: str) -> str:
        """The message ``text``, and that sub-steps failed, too, if there were any."""
        return f"{text}. Nor did it in {2**HALVINGS} sub-steps" if self.divides else text

    @property
    def divides(self) -> bool:
        """Whether a failed step may be divided.

        Not if the policy asks for an error, or if smaller steps would fail for the same reason.
        """
        return self._may_fall_back and not self.reason

    @property
    def divisible(self) -> bool:
        """Whether the current step or sub-step may be divided further if it fails."""
        return self.divides and self.division.level < HALVINGS

    @abstractmethod
    def resize(self, time: float, size: float) -> None:
        """Start steps of another size, see :class:`~fem_lie.solve.division.Divisible`.

        Args:
            time: Time.
            size: Step size.
        """

    @abstractmethod
    def attempt(self, start: float, end: float) -> bool:
        """Make a step, see :class:`~fem_lie.solve.division.Divisible`.

        Args:
            start: First point, shape (3,).
            end: Last point, shape (3,).
        """


class DividedIntegration(Integration[HistoryT], Divided[HistoryT]):
    """Integration with constant steps that divides steps that do not converge."""

    def __init__(
        self,
        policy: RefactorisationPolicy,
        equations: Equations,
        step: float,
        *,
        bound: bool = False,
    ) -> None:
        """Set up a run whose failed steps are divided."""
        Divided.__init__(self, policy, step)
        super().__init__(policy, equations, step, bound=bound)
