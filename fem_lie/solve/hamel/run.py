"""A run of Hamel's form: the compiled steps, results and checkpoints."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._state import attributes, put_back, saved
from fem_lie.bodies.balances import BY_LOADS, BY_REACTIONS, TOTAL
from fem_lie.linear.direct import DirectSolver
from fem_lie.results import Result
from fem_lie.results.record import Record
from fem_lie.solve.division import HALVINGS
from fem_lie.solve.hamel import step
from fem_lie.solve.motion.consistent import accelerations, check_velocities
from fem_lie.solve.motion.integration import DividedIntegration
from fem_lie.solve.motion.policies import Automatic
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.plan import EqualSteps
from fem_lie.solve.recording.recorder import Recorder
from fem_lie.system.equations import Equations

PREFIX = "fem_lie_dynamics_"
_AT_A_TIME = 20_000
"""Steps times bodies after which the loop comes back to be interrupted."""


_CHANGED = "H", "s", "impulses"
"""What a step changes."""


class HamelRun(DividedIntegration[Recorder]):
    """One integration."""

    STATE = attributes("H", "s", "impulses", "_made")

    def __init__(self, equations: Equations, size: float, bodies: step.Bodies) -> None:
        """Nothing is computed yet.

        Args:
            equations: Of the scene.
            size: Step size.
            bodies: What stays the same of them.
        """
        super().__init__(Automatic(), equations, size)
        self._bodies, n = bodies, equations.unknowns.moving
        self.H, self.s = equations.start.frames.copy(), np.zeros((n, 6))
        self.impulses, self._made = np.zeros((2, 6)), 0
        self._solver: DirectSolver | None = None

    def history(
        self, plan: EqualSteps, progress: bool | None, store: Checkpoints | None
    ) -> Recorder:
        """See the base class."""
        return Recorder(self.equations, plan, progress, store)

    def start(self) -> None:
        """See the base class."""
        check_velocities(self.equations, self.h)
        self.s[:] = self.equations.start.velocities[: len(self.s)]
        rolls = self._bodies.radius > 0.0
        self.s[rolls, :3] = self._rolling[rolls]

    @property
    def _rolling(self) -> Array:
        """Velocities in space of mass centres whose discs do not slip, (n, 3); of others any."""
        bodies, found = self._bodies, np.zeros((len(self.s), 3))
        for i in np.flatnonzero(bodies.radius > 0.0):
            arm = step.contact(self.H[i], bodies.disc[i], bodies.normal[i], bodies.radius[i])
            found[i] = np.cross(arm, self.s[i, 3:] @ self.H[i, 1:])
        return found

    @property
    def frames(self) -> Array:
        """See the base class."""
        return self.H

    @property
    def index(self) -> int:
        """See the base class."""
        return self._made

    def _advance(self, history: Recorder) -> bool:
        most = max(1, _AT_A_TIME // len(self.s))
        last = min(history.next_stop(self._made), self._made + most)
        whole = not self.division.level and self._go(self.h, last - self._made)
        # steps before one that fails are made again, one at a time
        made = whole or self._cover()
        history.count = self._made
        return made

    def _go(self, h: float, count: int) -> bool:
        """Make so many steps of a size; whether all were, otherwise none is."""
        before = saved(self, _CHANGED)
        step.run(self.H, self.s, (*self._bodies,), h, count, self.impulses)
        if not np.isfinite(self.s).all():
            put_back(self, _CHANGED, before)
            return False
        self._made += count
        return True

    def attempt(self, start: float, end: float) -> bool:
        """See the base class."""
        self._made = self.begun
        return self._go(self.part_size, 1)

    def resize(self, time: float, size: float) -> None:
        """See the base class; velocities are of no size."""

    def _failure(self, steps: int) -> str:
        return (
            f"step {self.index + 1} of {steps} (h = {self.h:g}) failed: no velocity was found, or "
            f"a disc lies in its plane. Nor was it in {2**HALVINGS} parts; a smaller step may help"
        )

    # --- results ---

    def _record(self, history: Recorder) -> bool:
        history.show_progress(self._made)
        wanted = history.wants(self._made)
        if wanted:
            equations, n = self.equations, len(self.s)
            v = equations.start.velocities.copy()
            rates: Array = np.zeros((n, 6))
            rolls = self._bodies.radius > 0.0
            v[:n] = self.s
            v[:n][rolls, :3] = np.einsum("nai,ni->na", self.H[:n, 1:], self._rolling)[rolls]
            weights: Array = np.zeros(equations.unknowns.m)
            time = self._made * self.h
            if Record.FORCES in history.filled and len(weights):
                solver = self._solver or DirectSolver(equations.matrix, PREFIX)
                self._solver = solver
                rates, weights = accelerations(equations, solver, self.H, v, time, self.h)
            booked = np.zeros(TOTAL)
            booked[BY_LOADS:BY_REACTIONS], booked[BY_REACTIONS:] = self.impulses
            history.fill(time, self.H, v[:n], rates, weights, booked)
        return wanted

    def _result(self, history: Recorder) -> Result:
        self.division.report(self.index)
        return history.result(0, history.seconds, divided=self.division.divided)
