"""Sub-steps of composed steps, and runs of one size of them.

The error of a symmetric second-order scheme over a step h has odd powers of h only. Sub-steps of
the sizes ``γₖ h`` in a symmetric sequence are of fourth order if::

    Σ γₖ = 1,      Σ γₖ³ = 0.

So at least one of them goes back in time. (Yoshida, Phys. Lett. A 150 (1990) 262; Suzuki, Phys.
Lett. A 146 (1990) 319; Hairer, Lubich & Wanner, Geometric Numerical Integration, chapters II.4 and
V.3.)

With constraints the conserving scheme is symmetric, but not close to the identity: velocities, and
rates of directors, that violate constraints by the order h² change their sign in each step. Two
steps are close to the identity. So each sub-step is made in two halves.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.linear.factors import Factors, PlainFactors
from fem_lie.solve.conserving.run import Run
from fem_lie.solve.conserving.run_state import Options
from fem_lie.solve.conserving.step import loop
from fem_lie.system.equations import Equations

_TRIPLE = 1.0 / (2.0 - 2.0 ** (1.0 / 3.0))
_FIVE = 1.0 / (4.0 - 4.0 ** (1.0 / 3.0))


class Composition(ABC):
    """Composition of a step of sub-steps."""

    @property
    @abstractmethod
    def parts(self) -> tuple[float, ...]:
        """Sizes of the sub-steps over that of the step, in order; the sequence is symmetric."""

    @property
    def halves(self) -> tuple[float, ...]:
        """Sizes of the halves of all sub-steps."""
        return tuple(0.5 * part for part in self.parts for _ in range(2))


@dataclass(frozen=True)
class TripleJump(Composition):
    """Three sub-steps: 1.35, −1.70 and 1.35 of a step.

    It goes beyond the end of the step by 0.35 of it, and before its start by as much: functions of
    time must be defined there.
    """

    @property
    def parts(self) -> tuple[float, ...]:
        """Sizes of the sub-steps."""
        return _TRIPLE, 1.0 - 2.0 * _TRIPLE, _TRIPLE


@dataclass(frozen=True)
class FiveStages(Composition):
    """Five sub-steps: 0.41, 0.41, −0.66, 0.41 and 0.41 of a step.

    It stays between the ends of the step, and its error is some hundred times smaller than that of
    :class:`TripleJump` with the same step.
    """

    @property
    def parts(self) -> tuple[float, ...]:
        """Sizes of the sub-steps."""
        return _FIVE, _FIVE, 1.0 - 4.0 * _FIVE, _FIVE, _FIVE


@dataclass(frozen=True)
class NineStages(Composition):
    """Nine sub-steps: four of a sixth of the step, one back by a third, and four of a sixth.

    Like :class:`FiveStages` it stays between the ends of the step. For the same total number of
    sub-steps (steps 1.8 times as large) its error is half of that in smooth motions, because it
    goes back less.
    """

    @property
    def parts(self) -> tuple[float, ...]:
        """Sizes of the sub-steps."""
        return (*[1.0 / 6.0] * 4, -1.0 / 3.0, *[1.0 / 6.0] * 4)


class Part(Run):
    """Sub-steps of one size, with a matrix of their own; all sizes share one state.

    Attributes:
        share: Size over that of the whole step; it may be negative.
    """

    current_jacobian = (
        False  # all sizes share one state, and have matrices with constraints of their own
    )

    def __init__(
        self,
        options: Options,
        equations: Equations,
        whole: float,
        share: float,
        per_step: int,
        shared: Part | None,
    ) -> None:
        """Allocate all arrays without computing anything.

        Args:
            options: Options of the scheme.
            equations: Equations of the scene.
            whole: Size of the whole step.
            share: Size of the sub-step over that of the step.
            per_step: Number of sub-steps of this size in a step.
            shared: The run whose state is shared; default: this one.
        """
        super().__init__(options, equations, share * whole, shared)
        self.share, self._per_step = share, per_step

    def start_as(self, other: Part) -> None:
        """Take the initial state of another run."""
        self.model.scale[:] = other.model.scale
        self._set_loads(0.0)
        self.progress.excess = np.inf

    @property
    def factors(self) -> PlainFactors | None:
        """The frozen factors, if there are any."""
        return None if self._factors is None else self._factors.plain

    @property
    def compiled_model(self) -> Indices:
        """Packed model of the scene with this size, for compiled code."""
        return self._packed.model

    @property
    def compiled_state(self) -> tuple[Indices, Indices]:
        """Packed state and step, the same for all sizes."""
        return self._packed.state, self._packed.step

    @property
    def progress_at(self) -> Indices:
        """Address of the progress of sub-steps of this size."""
        return self._progress_at

    @property
    def compiled_options(self) -> tuple[float, int, int, float, float]:
        """Options for the loop, if the policy is a rule."""
        assert self.rule is not None
        return self._given(self.rule, self.options.max_iterations)

    @property
    def still(self) -> bool:
        """Whether the next sub-steps of this size begin without a prediction."""
        return self.unpredicted > 0

    def make(self, start: float, end: float) -> bool:
        """Make the next sub-step of this size; return whether it converged."""
        return self._go_to(self.index + 1, start, end)

    def resize_whole(self, whole: float, *, shared: bool = False) -> None:
        """Change the size of whole steps.

        Args:
            whole: The new size.
            shared: Whether the state was already changed with another run.
        """
        h, ratio = self.share * whole, self.share * whole / self.size
        if shared:
            self.progress.motion *= ratio
            self.progress.floor = 0.0
            self._set_size(h)
        else:
            self._resize(h)
        self._forget_iteration()

    def _set_size(self, h: float) -> None:
        super()._set_size(h)
        self.h = h

    def keep_old_matrix(self) -> None:
        """Keep the matrix after steps were taken back: no matrix is newer than the state."""
        self.counts[1] = min(int(self.counts[1]), self.index)

    def go_on(self, code: int, start: float, end: float) -> bool:
        """Complete a sub-step after the loop returned; return whether it converged."""
        if code == loop.FAILED:
            return self._may_fall_back and self._fallback_converged()
        try:
            self._factorise()
        except SingularMatrixError:
            self.progress.increment = np.inf
            return self._may_fall_back and self._fallback_converged()
        return self.make(start, end)

    @property
    def divides(self) -> bool:
        """Not supported: half a sub-step is not part of its composition."""
        return False

    def _age(self) -> float:
        """Position in whole steps; a sub-step may go back in time."""
        return super()._age() / (self.share * self._per_step)

    # --- checkpoints ---

    def saved_state(self) -> dict[str, Array]:
        """State with the factors of the frozen matrix."""
        kept = super().saved_state()
        return kept if self._factors is None else kept | self._factors.arrays()

    def _frozen_factors(self, kept: Mapping[str, Array]) -> Factors | None:
        return Factors.of(kept)
