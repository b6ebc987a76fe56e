"""Sub-steps of the variational scheme: one by one, and all in one compiled loop.

The state between sub-steps is frames and momenta. Only admissible momenta matter, and a sub-step
maps them symmetrically and close to the identity, so that sub-steps need not be halved as those of
the conserving scheme (:mod:`.parts`).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, linked
from fem_lie._jit.records import Record, record_type
from fem_lie._state import attributes, put_back, saved
from fem_lie.linear.factors import PlainFactors
from fem_lie.results import Result
from fem_lie.solve.conserving.step import loop
from fem_lie.solve.conserving.step.corrections import progress_of
from fem_lie.solve.conserving.step.packing import state_of
from fem_lie.solve.convergence import failure
from fem_lie.solve.motion.integration import DividedIntegration
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.plan import EqualSteps
from fem_lie.solve.recording.recorder import Recorder
from fem_lie.solve.variational.ends import Ends
from fem_lie.solve.variational.limit import DIVIDES
from fem_lie.solve.variational.run import VariationalRun
from fem_lie.solve.variational.run_state import Options
from fem_lie.system.equations import Equations

POSITION = record_type(made=int, part=int, chosen=int)
"""Position of a run: whole steps made, sub-steps of the current one, and the size of the frozen
state, 0 or 1."""


@compiled
def resize(last_residual: Array, before: float, h: float) -> None:
    """Rescale forces left over by round-off: they are impulses, which depend on the step size."""
    ratio = before / h
    for i in range(last_residual.shape[0]):
        for k in range(last_residual.shape[1]):
            last_residual[i, k] *= ratio


@linked
def run(
    models: tuple[Indices, Indices],
    starts: Indices,
    steps: Indices,
    factors: tuple[PlainFactors, PlainFactors],
    options: tuple[float, int, int, float, float],
    progresses: tuple[Indices, Indices],
    sizes: tuple[Array, Indices],
    position: Record,
    last: int,
) -> int:
    """Advance to step ``last``, or until a sub-step needs a new matrix or fails.

    Args:
        models: Packed model for each of the two sizes, see
            :class:`~fem_lie.solve.conserving.step.packing.Packed`.
        starts: The state.
        steps: The current sub-step.
        factors: Factors of the matrix of each size.
        options: See :func:`fem_lie.solve.conserving.step.loop.run`.
        progresses: Address of the progress for each size, see
            :data:`~fem_lie.solve.conserving.step.corrections.PROGRESS`; updated.
        sizes: Both sizes, and the index of the size of each sub-step, (2,) and (parts,).
        position: Position of the run, see :data:`POSITION`; updated.
        last: Number of whole steps to be made.
    """
    h, order = sizes
    while position.made < last:
        while position.part < order.shape[0]:
            k = order[position.part]
            if position.chosen != k:
                resize(state_of(starts).last_residual, h[position.chosen], h[k])
                position.chosen = k
            to = progress_of(progresses[k]).progress[0].steps + 1
            given = starts, steps, factors[k], options
            code = loop.run(models[k], *given, progresses[k], to)
            if code != loop.DONE:
                return code
            position.part += 1
        position.part = 0
        position.made += 1
    return loop.DONE


_SHARED = "H", "rest", "rates", "before", "gap", "balance", "multipliers", "earlier"
"""State shared by sub-steps of all sizes."""


class MomentumPart(VariationalRun):
    """Sub-steps of one size, with matrices of their own; all sizes share one state.

    The compiled loop makes one at a time; the energy balance is updated over whole steps.

    Attributes:
        whole_divisible: Whether the step of which this is a part may be divided.
    """

    def __init__(
        self, options: Options, equations: Equations, step: float, shared: MomentumPart | None
    ) -> None:
        """Allocate all arrays without computing anything.

        Args:
            options: Options of the scheme.
            equations: Equations of the scene.
            step: Size, which may be negative.
            shared: The run whose state is shared; default: this one.
        """
        super().__init__(options, equations, step)
        self._ends = Ends(equations, abs(step), sweeps=2)
        self._start, self.whole_divisible = 0.0, True
        if shared is not None:
            for name in _SHARED:
                setattr(self, name, getattr(shared, name))

    @property
    def time(self) -> float:
        """Time at the start of the current sub-step."""
        return self._start

    def start_as_shared(self) -> None:
        """Take the initial state of the run that owns the state."""
        self._reset_coordinates()
        self.scale[:] = self._fill(None)

    def set_size(self, size: float) -> None:
        """Change the size; earlier steps keep their own sizes."""
        self.h = self.size = size
        self._ends.h = abs(size)

    def forget_matrix(self) -> None:
        """Drop the matrix, which belongs to another size."""
        self._factors = None

    def make(self, start: float, last: float, earlier: float) -> bool:
        """Make the next sub-step of this size; return whether it converged.

        Args:
            start: Time at its start.
            last: Size of the step before it.
            earlier: Size of the one before that.
        """
        self._start, h = start, self.h
        # rates of two steps of this size, from which this one is extrapolated linearly
        change = self.rates[0] - self.rates[1]
        self.rates[1] = self.rates[0] - change * (h + last) / (last + earlier)
        # multipliers act at the end of one step and the start of the next
        self.multipliers *= (last * (h + last)) / (h * (last + earlier))
        self.earlier[:] = self.multipliers
        self.begun = self.index
        return self.attempt(start, start + h)

    @property
    def divisible(self) -> bool:
        """Whether the step of which this is a part may be divided."""
        return self.whole_divisible

    @property
    def _balance_in_loop(self) -> bool:
        return False

    @property
    def divides(self) -> bool:
        """Not supported: half a sub-step is not part of its composition."""
        return False

    def _add_to_balance(self, time: float, multipliers: Array) -> None:
        """No effect: the energy balance is updated over whole steps."""

    def add_to_balance(self, h: float, time: float) -> None:
        """Account for a whole step of size ``h``, by the trapezoidal rule."""
        if not self.balance.empty:
            v, rates, multipliers = self.at_end(time)
            self.balance.add(h, time, self.H, v[: self._n], rates, multipliers)

    def at_end(self, time: float) -> tuple[Array, Array, Array]:
        """Twists, their rates and multipliers; each call needs two factorisations."""
        v = self._ends.velocities(self.H, self.before, time)
        return v, *self._ends.accelerations(self.H, v, time)

    @property
    def iterations(self) -> int:
        """Number of iterations of all sub-steps of this size."""
        return self._iterations

    @property
    def factorisations(self) -> int:
        """Number of factorisations of its matrix."""
        return self._factorisations

    @property
    def left(self) -> tuple[float, float]:
        """The last increment, and the largest residual."""
        return self._increment, float(np.abs(self._r).max(initial=0.0))


_OWN = "_made", "twists", "coordinates"
"""State of a size that its sub-steps change."""


class MomentumRun(DividedIntegration[Recorder]):
    """Run of composed steps of the variational scheme."""

    STATE = attributes("_made", "_sizes", "_parts")

    def __init__(
        self, options: Options, equations: Equations, step: float, shares: tuple[float, ...]
    ) -> None:
        """Set up without computing anything.

        Args:
            options: Options of the scheme of the sub-steps.
            equations: Equations of the scene.
            step: Size of the whole steps.
            shares: Sizes of the sub-steps over that of the step; two of them differ.
        """
        super().__init__(options.policy, equations, step)
        self.equations_state = equations.history_variables
        self.options, self._shares = options, shares
        sizes = list(dict.fromkeys(shares))
        first = MomentumPart(options, equations, step * sizes[0], None)
        others = (MomentumPart(options, equations, step * size, first) for size in sizes[1:])
        self._parts = first, *others
        self._order = [sizes.index(share) for share in shares]
        self._ends = np.cumsum([0.0, *shares])
        self._sizes = np.array([first.h, first.h])
        self._made, self._part = 0, 0

    def history(
        self, plan: EqualSteps, progress: bool | None, store: Checkpoints | None
    ) -> Recorder:
        """Create the history of results."""
        return self._parts[0].history(plan, progress, store)

    def start(self) -> None:
        """Compute the initial state."""
        first, *others = self._parts
        first.start()
        for part in others:
            part.start_as_shared()

    @property
    def frames(self) -> Array:
        """Current frames of all nodes, ground and prescribed motions."""
        return self._parts[0].frames

    @property
    def index(self) -> int:
        """Number of steps made, including the current one."""
        return self._made

    def _advance(self, history: Recorder) -> bool:
        made = self._cover()
        history.count = self._iterations
        return made

    def attempt(self, start: float, end: float) -> bool:
        """Make a step; return whether it converged."""
        self._made, size = self.begun, self.part_size
        known = self, ("_sizes", "equations.history_variables")
        changed = known, (self._parts[0], _SHARED), *((part, _OWN) for part in self._parts)
        before = [saved(owner, names) for owner, names in changed]
        for at, k in enumerate(self._order):
            part, self._part = self._parts[k], at
            part.whole_divisible = self.divisible
            if not part.make(start + float(self._ends[at]) * size, *self._sizes.tolist()):
                for (owner, names), kept in zip(changed, before, strict=True):
                    put_back(owner, names, kept)
                return False
            self._sizes[:] = part.h, self._sizes[0]
        self._made += 1
        self._parts[0].add_to_balance(size, end)
        return True

    def resize(self, time: float, size: float) -> None:
        """Start steps of another size."""
        self._set_sizes()
        for part in self._parts:
            part.start_as_shared()
            part.forget_matrix()

    def _set_sizes(self) -> None:
        for part, share in zip(self._parts, dict.fromkeys(self._shares), strict=True):
            part.set_size(share * self.part_size)

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Restore the state that :meth:`saved_state` returned."""
        super().restore(kept)
        self._set_sizes()

    @property
    def _iterations(self) -> int:
        return sum(part.iterations for part in self._parts)

    def _failure(self, steps: int) -> str:
        options, part = self.options, self._parts[self._order[self._part]]
        numbers = options.max_iterations, *part.left, options.tolerance
        text = failure(self.index + 1, steps, self.h, *numbers, options.policy.full_newton_fallback)
        text = f"sub-step {self._part + 1} of {text}"
        return self._nor_in_parts(text)

    def _record(self, history: Recorder) -> bool:
        history.show_progress(self.index)
        wanted = history.wants(self.index)
        if wanted:
            self._parts[0].record_state(history, self.index * self.h, moved=self.index > 0)
        return wanted

    def _result(self, history: Recorder) -> Result:
        made = sum(part.factorisations for part in self._parts)
        self.division.report(self.index, DIVIDES)
        return history.result(made, history.seconds, divided=self.division.divided)
