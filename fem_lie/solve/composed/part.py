"""Steps of one size, of which some are parts of each composed step."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.linear.factors import Factors, PlainFactors
from fem_lie.solve.conserving.run import Run
from fem_lie.solve.conserving.run_state import Options
from fem_lie.solve.conserving.step import corrections, loop
from fem_lie.solve.conserving.step.packing import PackedModel
from fem_lie.system.equations import Equations


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
