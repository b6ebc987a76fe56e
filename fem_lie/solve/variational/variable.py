"""The variational scheme with variable steps.

Between two steps the state is frames and momenta, which belong to no step size: each step is
symplectic and conserves momenta, whatever its size and that of the previous one. The energy has no
drift if the sizes are chosen symmetrically (:mod:`fem_lie.solve.symmetric_steps`). At a
discontinuity of a load or of a drive nothing has to be made consistent: loads act at the midpoints
of steps, which end at it, and the impulse of a drive is that of the multipliers of the next step.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress

import numpy as np

from fem_lie._arrays import Array
from fem_lie._state import Stateful, attributes, put_back, saved
from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.linear.factors import Factors
from fem_lie.linear.levels import Levels
from fem_lie.solve.motion.growing import GrowingRecorder
from fem_lie.solve.motion.step_log import StepError
from fem_lie.solve.motion.variable_steps import side
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.plan import ChosenSteps
from fem_lie.solve.step_control import SAME_SIZE
from fem_lie.solve.symmetric_steps import SymmetricControl
from fem_lie.solve.variational import momenta
from fem_lie.solve.variational.run import CHANGED, VariationalRun
from fem_lie.solve.variational.run_state import Options
from fem_lie.solve.variational.speed import kinetic
from fem_lie.system.equations import Equations

_UNKNOWN = StepError(np.nan, np.nan, 0, 0)
"""Error of a step that is not chosen by it."""


class VariationalSteps(VariationalRun):
    """Variational scheme with variable steps; see :class:`~.variable_steps.Stepper`."""

    STATE = attributes("h", "size", "_seen", "_unit")

    make_many = None

    def __init__(self, options: Options, equations: Equations, control: SymmetricControl) -> None:
        """Set up without computing anything; ``control`` gets the kinetic energy of each step."""
        super().__init__(options, equations, control.size)
        self.control, self._seen = control, 0.0
        self._levels = Levels[Factors](rigid=equations.unknowns.rigid)
        self._total = self._total_mass()
        # scale of constraints for steps of size 1
        self._unit: Array = np.ones_like(self.scale)

    def _total_mass(self) -> float:
        """Mass of all moving nodes: their momentum if all move along x at unit speed."""
        unknowns, n = self.equations.unknowns, self._n
        lengths = np.repeat(unknowns.lengths, 3, axis=1)
        along, free = np.zeros((n, 6)), np.zeros((n, 6), dtype=np.int64)
        along[:, [0, 3]] = unknowns.lengths
        v = np.empty((n, 6))
        momenta.to_local(unknowns.kinds, self.H, along, free, v)
        return float((self._momenta(self.H, v) * along)[lengths].sum())

    @property
    def increment(self) -> float:
        """Size of the last increment of the iteration."""
        return self._increment

    @property
    def factorisations(self) -> int:
        """Number of factorisations so far."""
        return self._factorisations

    @property
    def divides(self) -> bool:
        """Not supported: the step size control chooses smaller steps."""
        return False

    # --- the size of the step ---

    def begin(self, h: float) -> None:
        """Start at time 0; the size is that of the initial speed."""
        v = self.equations.start.velocities
        rates, _ = self._ends.accelerations(self.H, v, 0.0)
        moving = v[: self._n]
        self.control.begin(self._mean(moving, moving), 2.0 * self._mean(moving, rates))
        self._take_size(self.control.size)
        self.start()
        self._unit[:] = self.scale * self.size**2

    def _mean(self, v: Array, w: Array) -> float:
        """Product of two motions (n, 6) weighted by the inertia, over the mass; of one it is v²."""
        unknowns, p = self.equations.unknowns, np.empty((self._n, 6))
        momenta.to_local(unknowns.kinds, self.H, self._momenta(self.H, w), unknowns.held, p)
        return float((v * p).sum()) / self._total

    def _take_size(self, size: float) -> None:
        super()._take_size(size)
        self.h = size

    def set_step(self, time: float, h: float) -> None:
        """Set the state at ``time`` as the start of a step of size ``h``."""
        if abs(h / self.size - 1.0) > SAME_SIZE:
            self._take_size(h)
        levels = self._levels
        levels.use(4.0 / h**2)
        self._factors = levels.present
        if self._factors is not None:
            self.scale[:] = levels.scale()
            diagonal = levels.factor * self._factors.diagonal
            self._factors = self._factors._replace(diagonal=diagonal)

    def _factorise(self) -> None:
        before = self.scale.copy()
        self.scale[:] = self._unit / self.size**2
        self._r[6 * self._n :] *= self.scale / before
        self._levels.release()
        super()._factorise()
        assert self._factors is not None
        self._levels.keep(self._factors, self.scale)

    def refactorise_at(self, time: float) -> None:
        """Drop all matrices and factorise that of the current state."""
        self._levels = Levels[Factors](rigid=self._levels.rigid)
        self._levels.use(4.0 / self.size**2)
        self._reset_coordinates()
        if self._changing:
            self.equations.prescribed(time, self.size).act()
        # a step from a singular configuration factorises its own matrix
        with suppress(SingularMatrixError):
            self._factorise()

    def pass_event(self, time: float, restitution: Array | None = None) -> None:
        """Choose the size anew: drives may change velocities at once."""
        assert restitution is None, "the variational scheme has no limits"
        self._seen = time
        v = self._ends.velocities(self.H, self.before, time)[: self._n]
        self.control.begin(self._mean(v, v), 0.0)

    def damp_oscillations(self, time: float, h: float) -> None:
        """No effect: the energy of unresolved oscillations is conserved."""

    # --- steps ---

    def step_to(self, start: float, end: float, index: int, lands: bool) -> int:
        """Make step ``index``; return its iterations, 0 if it failed."""
        self._seen = end - side(end, self.size) if lands else end
        before, spent = self.before.copy(), self._iterations
        self.begun = index - 1
        made = self.attempt(start, self._seen)
        if made:
            kinds = self.equations.unknowns.kinds
            found = kinetic(kinds, self.step, self.size, before, self.after)
            self._speed = found[0] / self._total, found[1] / self._total
        return max(1, self._iterations - spent) if made else 0

    @property
    def time(self) -> float:
        """Time of the current state."""
        return self._seen

    def _accept_history(self, start: Array | None, middle: Array | None = None) -> bool:
        """Left to the run, which may reject the step."""
        return True

    def estimate(self, before: Mapping[str, Array], start: float, end: float) -> StepError:
        """Report the kinetic energy of the step, by which the next ones are chosen."""
        self.control.observe(*self._speed)
        return _UNKNOWN

    def saved(self) -> dict[str, Array]:
        """A copy of the state that a step changes."""
        return saved(self, (*CHANGED, "coordinates", "twists", "balance"))

    def take_back(self, state: Mapping[str, Array]) -> None:
        """Restore a saved state."""
        put_back(self, (*CHANGED, "coordinates", "twists", "balance"), state)

    def restore_from(self, other: VariationalSteps, state: Mapping[str, Array]) -> None:
        """Take the state that another stepper has saved."""
        self.take_back(state)
        self._take_size(other.size)

    # --- results ---

    def recorder(
        self, plan: ChosenSteps, progress: bool | None, store: Checkpoints | None
    ) -> GrowingRecorder:
        """Create the history of results."""
        return GrowingRecorder(self.equations, plan, progress, store)

    def leave_balance(self) -> None:
        """Skip the energy balance."""
        self.balance.rest()

    def record(self, recorder: GrowingRecorder, index: int, iterations: int) -> None:
        """Record the current state in the next row."""
        with self.equations.history_variables.unchanged():
            self.record_state(recorder, self._seen, moved=index > 0)

    def saved_state(self) -> dict[str, Array]:
        """State on which the next steps depend, except matrices."""
        return Stateful.saved_state(self)

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Restore the state that :meth:`saved_state` returned, without matrices."""
        Stateful.restore(self, kept)
        self._take_size(self.size)
