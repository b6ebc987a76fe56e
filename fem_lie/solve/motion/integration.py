"""What runs with constant steps have in common: policy, what elements remember, divided steps."""

from __future__ import annotations

import logging
from abc import abstractmethod

import numpy as np

from fem_lie._arrays import Array
from fem_lie._state import HasState, attributes
from fem_lie.forms.abilities import PassedThroughError
from fem_lie.solve.division import HALVINGS, Division
from fem_lie.solve.motion.driver import Driver, Kept
from fem_lie.solve.motion.policies import Policy
from fem_lie.system.equations import Equations

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
        told = equations.unknowns.told, self.choices, type(policy).__name__
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
