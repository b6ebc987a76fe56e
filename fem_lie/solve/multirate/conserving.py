"""Domain of energy-momentum steps."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._state import ChangingArrays, attributes
from fem_lie.linear.factors import Factors
from fem_lie.solve.conserving.energy_momentum import EnergyMomentum
from fem_lie.solve.conserving.run import Run
from fem_lie.system.equations import Equations


class ConservingDomain(Run):
    """Domain with energy-momentum steps, see :class:`~fem_lie.solve.multirate.domain.Domain`."""

    STATE = attributes("h")

    def __init__(
        self, scheme: EnergyMomentum, equations: Equations, whole: float, count: int, rows: Indices
    ) -> None:
        """Set up without computing anything.

        Args:
            scheme: The scheme.
            equations: Equations of the bodies and their connections.
            whole: Size of a whole step.
            count: Number of steps in it.
            rows: Indices of moving nodes among those of the scene.
        """
        self._acting = np.zeros((equations.unknowns.moving, 4, 3))
        super().__init__(scheme.options(), equations, whole / count)
        self.count, self.rows = count, rows
        self._own: dict[str, Array] = {}
        self._changing_state = ChangingArrays(self, ["s"])
        self._end_forces_before = self._end_forces.saved_state()
        self._V1, self._first = self.this.V1.copy(), 0

    @property
    def divides(self) -> bool:
        """Not supported: whole steps are divided instead."""
        return False

    def begin(self) -> None:
        """Save the current state: whole steps start from it until the next call."""
        self._before = self._changing_state.saved_state()
        self._own, self._V1, self._first = self.cells.saved_state(), self.this.V1.copy(), self.index
        self._end_forces_before = self._end_forces.saved_state()

    def go_back(self) -> None:
        """Restore the saved state."""
        self._changing_state.restore(self._before)
        self.this.V1[:] = self._V1
        self.cells.restore(self._own)
        self._end_forces.restore(self._end_forces_before)
        progress = self.progress
        progress.steps = self._first
        progress.iteration = progress.asked = 0
        # no matrix is newer than the state
        self.counts[1] = min(int(self.counts[1]), self._first)

    def go(self, forces: Array, start: float) -> bool:
        """Make a whole step from the saved state; return whether it converged."""
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
        """Set the state as the start of a whole step of another size."""
        self.h = size / self.count
        self._resize(self.h)
        self._forget_iteration()

    def _take_loads(self) -> None:
        super()._take_loads()
        self.model.loads.dead[: self.moving] += self._acting

    # --- the current state ---

    @property
    def now(self) -> Array:
        """Frames of the current state, (n, 4, 3)."""
        return self.s.H[: self.moving]

    @property
    def before(self) -> Array:
        """Frames of the saved state, (n, 4, 3)."""
        return self._before["s.H"][: self.moving]

    @property
    def rates(self) -> Array:
        """Rates of (x, d₁, d₂, d₃), then those of products of reduced bodies, (≥ n, 4, 3)."""
        return self.s.V

    @property
    def twists(self) -> Array:
        """Velocities along the axes of the nodes, (n, 6)."""
        return self.local(self.s.V[: self.moving], self.s.H)

    @property
    def so_far(self) -> Array:
        """Energy balance and impulses up to the current state, (15,)."""
        return self.s.balance

    @property
    def stored(self) -> float:
        """Stored energy of cells and contacts."""
        return float(self.s.W.sum()) + self._end_forces.energy + self._end_forces.held

    @property
    def matrices(self) -> int:
        """Number of matrices factorised."""
        return int(self.counts[0])

    # --- checkpoints ---

    def saved_state(self) -> dict[str, Array]:
        """State with the factors of the matrix, which belong to no particular state."""
        kept = super().saved_state()
        return kept if self._factors is None else kept | self._factors.arrays()

    def _frozen_factors(self, kept: Mapping[str, Array]) -> Factors | None:
        return Factors.of(kept)
