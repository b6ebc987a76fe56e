"""Bodies whose steps have one size, over a whole step, under given forces of those around them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._state import attributes
from fem_lie.linear.factors import Factors
from fem_lie.solve.conserving.run import Run
from fem_lie.solve.conserving.run_state import Options
from fem_lie.solve.conserving.step import corrections
from fem_lie.solve.conserving.step.records import State
from fem_lie.system.equations import Equations


class Domain(Run):
    """Its steps are those of energy-momentum; a whole step can be made again from its start.

    Attributes:
        rows: Its moving nodes, of those of the whole scene.
        count: Steps in a whole one.
        before: The state from which whole steps are made.
    """

    STATE = attributes("h")

    before: State

    def __init__(
        self, options: Options, equations: Equations, whole: float, count: int, rows: Indices
    ) -> None:
        """Nothing is computed yet.

        Args:
            options: Of the scheme.
            equations: Of the bodies and what is between them.
            whole: Size of a whole step.
            count: Steps in it.
            rows: Moving nodes, of those of the whole scene.
        """
        self._acting = np.zeros((equations.unknowns.moving, 4, 3))
        super().__init__(options, equations, whole / count)
        self.count, self.rows = count, rows
        self._own: dict[str, Array] = {}
        self._pushed_before = self._pushes.memory()
        self._V1, self._first = self.this.V1.copy(), 0

    @property
    def divides(self) -> bool:
        """Not here: whole steps are made in parts."""
        return False

    def begin(self) -> None:
        """Keep the present state: whole steps are made from it until this is called again."""
        self.before = State(*(array.copy() for array in self.s))
        self._own, self._V1, self._first = self.cells.memory(), self.this.V1.copy(), self.index
        self._pushed_before = self._pushes.memory()

    def go_back(self) -> None:
        """Return to the state that is kept."""
        for array, value in zip(self.s, self.before, strict=True):
            array[:] = value
        self.this.V1[:] = self._V1
        self.cells.restore(self._own)
        self._pushes.restore(self._pushed_before)
        counters = self.counters
        counters[corrections.STEPS] = self._first
        counters[corrections.ITERATION] = counters[corrections.ASKED] = 0
        # no matrix is younger than the state
        self.counts[1] = min(int(self.counts[1]), self._first)

    def go(self, forces: Array, start: float) -> bool:
        """A whole step from the state that is kept; whether it is made.

        Args:
            forces: On ``(x, d₁, d₂, d₃)`` of all moving nodes of the scene, (n, 4, 3), which stay
                the same in all its steps. Their work is in the books.
            start: Time of that state.
        """
        self.go_back()
        self._acting[:] = forces[self.rows]
        self._take_loads()
        last, each = self._first + self.count, 1 if self._changing else self.count
        while self.index < last:
            time = start + (self.index - self._first) * self.h
            if not self._go_to(self.index + each, time, time + self.h):
                return False
        return True

    def resize_whole(self, size: float) -> None:
        """Make the state that of the start of a whole step of another size."""
        self.h = size / self.count
        self._resize(self.h)
        self._forget_iteration()

    def _take_loads(self) -> None:
        super()._take_loads()
        self.model.loads.dead[: self.moving] += self._acting

    @property
    def stored(self) -> float:
        """Energy of cells and of contacts."""
        return float(self.s.W.sum()) + self._pushes.energy + self._pushes.held

    @property
    def moved(self) -> Array:
        """What a whole step has changed of (x, d₁, d₂, d₃), (n, 4, 3)."""
        return np.asarray(self.s.H[: self.moving] - self.before.H[: self.moving])

    # --- checkpoints ---

    def memory(self) -> dict[str, Array]:
        """With the factors, which are those of no state in particular."""
        kept = super().memory()
        return kept if self._factors is None else kept | self._factors.arrays()

    def _kept_factors(self, kept: Mapping[str, Array]) -> Factors | None:
        return Factors.of(kept)
