"""The sub-steps of which a composed step is made, and runs of one size of them.

Of which parts a step is composed, so that the errors of a symmetric scheme cancel.

A symmetric scheme of second order has, over a step h, an error in odd powers of h alone. Steps of
the sizes ``γₖ h`` one after the other, the same from either end, are of fourth order if::

    Σ γₖ = 1,      Σ γₖ³ = 0.

So at least one of them goes back. (Yoshida, Phys. Lett. A 150 (1990) 262; Suzuki, Phys. Lett. A 146
(1990) 319; Hairer, Lubich & Wanner, Geometric Numerical Integration, chapters II.4 and V.3.)

What a scheme for constraints gives is symmetric, but not near the identity: velocities, and rates
of directors, that break what is constrained, by the order h², change their sign in each of its
steps. Two steps are near the identity. So each part is made in two halves.
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
from fem_lie.solve.conserving.step import corrections, loop
from fem_lie.solve.conserving.step.packing import PackedModel
from fem_lie.system.equations import Equations

_TRIPLE = 1.0 / (2.0 - 2.0 ** (1.0 / 3.0))
_FIVE = 1.0 / (4.0 - 4.0 ** (1.0 / 3.0))


class Composition(ABC):
    """Parts of a step."""

    @property
    @abstractmethod
    def parts(self) -> tuple[float, ...]:
        """Their sizes, of that of the step, in order; they are the same from either end."""

    @property
    def halves(self) -> tuple[float, ...]:
        """Sizes of the steps that are made."""
        return tuple(0.5 * part for part in self.parts for _ in range(2))


@dataclass(frozen=True)
class TripleJump(Composition):
    """Three parts: 1.35, −1.70 and 1.35 of a step.

    It goes ahead of the end of the step by 0.35 of it, and behind its start by as much: functions
    of time must be defined there.
    """

    @property
    def parts(self) -> tuple[float, ...]:
        """See the base class."""
        return _TRIPLE, 1.0 - 2.0 * _TRIPLE, _TRIPLE


@dataclass(frozen=True)
class FiveStages(Composition):
    """Five parts: 0.41, 0.41, −0.66, 0.41 and 0.41 of a step.

    It stays between the ends of the step, and its error is some hundred times less than that of
    :class:`TripleJump` with the same step.
    """

    @property
    def parts(self) -> tuple[float, ...]:
        """See the base class."""
        return _FIVE, _FIVE, 1.0 - 4.0 * _FIVE, _FIVE, _FIVE


@dataclass(frozen=True)
class NineStages(Composition):
    """Nine parts: four of a sixth of the step, one back by a third, and four of a sixth.

    As :class:`FiveStages` it stays between the ends of the step. Of as many parts in all its error
    is half of that in smooth motions, for it goes back less; steps are to be 1.8 times as large.
    """

    @property
    def parts(self) -> tuple[float, ...]:
        """See the base class."""
        return (*[1.0 / 6.0] * 4, -1.0 / 3.0, *[1.0 / 6.0] * 4)


class Part(Run):
    """They have a matrix of their own, and all sizes have one state.

    Attributes:
        share: Size over that of the whole step; it may be negative.
    """

    follows = False  # all parts have one state, and matrices with constraints of their own

    def __init__(
        self,
        options: Options,
        equations: Equations,
        whole: float,
        share: float,
        per_step: int,
        shared: Part | None,
    ) -> None:
        """Allocate everything; nothing is computed yet.

        Args:
            options: Of the scheme.
            equations: Of the scene.
            whole: Size of the whole step.
            share: What part of it this is.
            per_step: How many such there are in it.
            shared: The part whose state is that of all; default: this one.
        """
        super().__init__(options, equations, share * whole, shared)
        self.share, self._per_step = share, per_step

    def start_as(self, other: Part) -> None:
        """Start where another part was started."""
        self.model.scale[:] = other.model.scale
        self._set_loads(0.0)
        self.numbers[corrections.EXCESS] = np.inf

    @property
    def factors(self) -> PlainFactors | None:
        """Those that are kept, if there are any."""
        return None if self._factors is None else self._factors.plain

    @property
    def compiled_model(self) -> PackedModel:
        """What compiled code knows of the scene and the size."""
        return self._packed.model

    @property
    def compiled_state(self) -> tuple[Indices, Indices]:
        """Where state and step are, the same for all parts."""
        return self._packed.state, self._packed.step

    @property
    def compiled_options(self) -> tuple[float, int, int, float, float]:
        """What the loop is told, if the policy is a rule."""
        assert self.rule is not None
        return self._given(self.rule, self.options.max_iterations)

    @property
    def still(self) -> bool:
        """Whether the next steps of this size are to begin without a prediction."""
        return self.unpredicted > 0

    def make(self, start: float, end: float) -> bool:
        """Make the next step of this size; whether it is made."""
        return self._go_to(self.index + 1, start, end)

    def resize_whole(self, whole: float, *, shared: bool = False) -> None:
        """Make steps those of whole steps of another size.

        Args:
            whole: That size.
            shared: Whether the state was changed with another part.
        """
        h, ratio = self.share * whole, self.share * whole / self.size
        if shared:
            self.numbers[corrections.MOTION] *= ratio
            self.numbers[corrections.FLOOR] = 0.0
            self._set_size(h)
        else:
            self._resize(h)
        self._forget_iteration()

    def _set_size(self, h: float) -> None:
        super()._set_size(h)
        self.h = h

    def keep_old_matrix(self) -> None:
        """After steps were taken back: no matrix is younger than the state."""
        self.counts[1] = min(int(self.counts[1]), self.index)

    def go_on(self, code: int, start: float, end: float) -> bool:
        """End a step with which the loop came back; whether it is made."""
        if code == loop.FAILED:
            return self._rescues and self._rescued()
        try:
            self._factorise()
        except SingularMatrixError:
            self.numbers[corrections.INCREMENT] = np.inf
            return self._rescues and self._rescued()
        return self.make(start, end)

    @property
    def divides(self) -> bool:
        """Not here: half a step is none of its composition."""
        return False

    def _age(self) -> float:
        """Counted in whole steps, and a part may go back."""
        return super()._age() / (self.share * self._per_step)

    # --- checkpoints ---

    def memory(self) -> dict[str, Array]:
        """With the factors: there is one matrix for all sizes."""
        kept = super().memory()
        return kept if self._factors is None else kept | self._factors.arrays()

    def _kept_factors(self, kept: Mapping[str, Array]) -> Factors | None:
        return Factors.of(kept)
