"""A run of a conserving scheme: state, matrices, loads in time, results and checkpoints."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie.bodies.balances import WORK
from fem_lie.forms.cells import Cells, evaluate
from fem_lie.forms.frames import push
from fem_lie.lie.motions import Group
from fem_lie.linear.direct import DirectSolver
from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.linear.factors import Factors, factorise
from fem_lie.results import Result
from fem_lie.scene.load import StrainLoad
from fem_lie.scene.pressure import Pressure
from fem_lie.solve.conserving.end_forces import at_end
from fem_lie.solve.conserving.end_rates import EndRates, local_rates, spatial
from fem_lie.solve.conserving.memory import across, model_of, room_for_step, start_state
from fem_lie.solve.conserving.step import loop, stopping
from fem_lie.solve.conserving.step.balance import packed_residual
from fem_lie.solve.conserving.step.dissipation import REMEMBERS
from fem_lie.solve.conserving.step.records import Packed, Scheme, Solution, Span
from fem_lie.solve.motion.convergence import failure
from fem_lie.solve.motion.integration import Integration
from fem_lie.solve.motion.policies import Policy
from fem_lie.solve.motion.start import accelerations, check_velocities
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.recorder import History
from fem_lie.solve.recording.result_row import ResultRow
from fem_lie.solve.recording.saving import Saving
from fem_lie.system import System
from fem_lie.system.nodes import inertia

_log = logging.getLogger(__name__)

PREFIX = "fem_lie_dynamics_"

_SHARE = 0.4
"""Of the cost of a matrix, what a step may go on for instead: the next steps gain by it, too."""


@dataclass(frozen=True)
class Options:
    """What a conserving scheme is told.

    Attributes:
        tolerance: See :class:`~fem_lie.solve.conserving.energy_momentum.EnergyMomentum`, likewise
            ``policy`` and ``max_iterations``.
        policy: When to factorise.
        max_iterations: More in one step are a failure.
        loss: χ of :mod:`fem_lie.solve.conserving.step.dissipation`.
        learning: μ.
    """

    tolerance: float
    policy: Policy
    max_iterations: int
    loss: float = 0.0
    learning: float = 1.0


class Run(Integration[History]):
    """State of one integration.

    Attributes:
        s: Between steps.
        this: The present step.
        endures: Whether a matrix is kept that makes a step slow, as long as another one costs more.
    """

    endures = True

    def __init__(self, options: Options, system: System, step: float) -> None:
        """Allocate everything; nothing is computed yet.

        Args:
            options: Of the scheme.
            system: The equations.
            step: Step size.
        """
        super().__init__(options.policy, system, step)
        self.options, self.rule = options, options.policy.rule()
        self._pressures = [p for p in system.pressures if isinstance(p, Pressure)]
        # translations are global, so the derivatives in velocities are those of R³×SO(3)
        system.kinds = np.full(system.count, int(Group.R3xSO3), dtype=np.int64)
        self.cells = Cells(system.numbering.assemblies)
        self._strained = any(
            isinstance(load, StrainLoad) and load.history is not None for load in system.scene.loads
        )
        self.s, self.this = start_state(system, self.cells), room_for_step(system, self.cells)
        scheme = Scheme(self.h, options.loss, options.learning)
        self.model = model_of(system, self.cells, self._pressures, scheme)
        self._packed = Packed(self.model, self.s, self.this)
        self.counters, self.numbers = np.zeros(7, dtype=np.int64), np.zeros(9)
        self.counts = np.zeros(2, dtype=np.int64)
        self._factors: Factors | None = None
        self._filled = ResultRow(system)
        self.rates, self._end = EndRates.at(np.zeros((system.count, 6))), 0.0

    def history(
        self, steps: int, saving: Saving, progress: bool | None, store: Checkpoints | None
    ) -> History:
        """See the base class."""
        return History(self.system.info(), steps, self.h, saving, progress, store)

    @property
    def index(self) -> int:
        """See the base class."""
        return int(self.counters[stopping.STEPS])

    # --- start ---

    def start(self) -> None:
        """Velocities, multipliers, energies and constraints at the start; scaling."""
        system, s, n = self.system, self.s, self.system.count
        check_velocities(system, self.h)
        push(system.frames[:n], system.velocities[:n], s.V)
        solver = DirectSolver(system.kkt, PREFIX)
        v = system.velocities
        vdot, s.weights[:] = accelerations(system, solver, s.H, v, 0.0, self.h)
        self.rates = EndRates.at(spatial(s.H[:n], v[:n], vdot))
        self._set_loads(0.0)
        s.account[:] = self._evaluate_start()
        r = np.empty(system.size)
        system.applied(s.H, v, vdot, s.weights, np.ones(system.m), r)
        s.gap[:] = r[6 * n :]
        self._fill(s.H, v[:n], vdot)
        self.model.scale[:] = system.tangent.constraint_scale(s.H)
        self.numbers[stopping.EXCESS] = np.inf

    def _evaluate_start(self) -> Array:
        """Forces and energies of the cells at the start of a step; returns the energies."""
        frames = self.system.numbering.attachment.frames(self.s.H)
        evaluate(self.cells.table, frames, np.zeros_like(frames), self.s.F, self.s.W)
        return self.s.W

    # --- steps ---

    def _advance(self, history: History) -> bool:
        last = history.next_stop(self.index)
        if self.rule is None or self.system.time_dependent:
            last = self.index + 1
        if len(self.system.supported) and last > self.index + 1:
            # reactions need the accelerations of the last two steps
            if not self._go_to(last - 1, self.index * self.h, (self.index + 1) * self.h):
                return False
            self._note_rates()
        done = self._go_to(last, self.index * self.h, (self.index + 1) * self.h)
        self._note_rates()
        return done

    def _note_rates(self) -> None:
        # reactions of supports are made of them
        if len(self.system.supported):
            self.rates = self.rates.after(2.0 * self.s.trend, self.h)

    def _go_to(self, last: int, start: float, end: float) -> bool:
        """Make all steps up to ``last``, the first from ``start`` to ``end``; whether they were."""
        self._end = end + (last - self.index - 1) * self.h
        if self.system.time_dependent:
            self._set_time(start, end)
        rule = (1, 0.0) if self.rule is None else self.rule
        code = self._go(last, rule)
        if code == loop.FAILED and self.options.policy.rescue:
            _log.info("step %d: kept matrix diverges, full iteration", self.index + 1)
            code = self._again()
        return code != loop.FAILED

    def _again(self) -> int:
        """The step that failed from its start, with a new matrix in each iteration."""
        self.s.weights[:] = self.this.weights
        self.counters[stopping.ITERATION] = self.counters[stopping.ASKED] = 0
        return self._go(self.index + 1, (1, 0.0), always=True)

    def _go(self, last: int, rule: tuple[int, float], *, always: bool = False) -> int:
        options, counters = self.options, self.counters
        spare = _SHARE * rule[1] if self.endures and np.isfinite(rule[1]) else 0.0
        given = (options.tolerance, options.max_iterations, *rule, spare)
        while True:
            packed = self._packed
            tables = packed.model, packed.state, packed.step
            if self._factors is None:
                code = loop.MATRIX
                if counters[stopping.ITERATION] == 0:
                    counters[stopping.ITERATION], counters[stopping.ASKED] = 1, 1
                    motion = loop.packed_begin(*tables)
                    self.numbers[stopping.MOTION] = max(motion, self.numbers[stopping.MOTION])
                    self.numbers[stopping.PREVIOUS] = self.numbers[stopping.LEAST] = np.inf
                    self.numbers[stopping.FELT] = 0.0
                    counters[stopping.STALLS] = 0
            else:
                factors = self._factors.plain
                code = loop.run(*tables, factors, given, counters, self.numbers, last)
            if code == loop.DONE and self.rule is None:
                self.decisions.after_step(int(counters[stopping.LAST]))
            if code != loop.MATRIX:
                return code
            iteration = int(counters[stopping.ITERATION])
            asked = always or self.rule is not None or self._factors is None
            if asked or self.decisions.before_iteration(iteration):
                try:
                    self._factorise()
                except SingularMatrixError:
                    self.numbers[stopping.INCREMENT] = np.inf
                    return loop.FAILED

    def _failure(self, steps: int) -> str:
        increment = float(self.numbers[stopping.INCREMENT])
        largest = float(np.abs(Solution(*self.this.r).residual).max())
        limit, tolerance = self.options.max_iterations, self.options.tolerance
        rescued = self.options.policy.rescue
        index = self.index + 1
        return failure(index, steps, self.h, limit, increment, largest, tolerance, rescued)

    # --- loads ---

    def _set_time(self, start: float, end: float) -> None:
        """Loads in the middle of the next step, prescribed motions at its end."""
        system, rows, n = self.system, Span(*self.this.rows), self.system.count
        self._set_loads(0.5 * (start + end))
        connections = system.connections
        if connections.driven:
            self.model.driven[:] = connections.targets(end) - connections.targets(start)
        if len(rows.end) > n + 1:
            before, after = self.s.H[n + 1 :], system.prescribed_frames(end)
            rows.end[n + 1 :], rows.middle[n + 1 :] = after, after
            rows.mean[n + 1 :], rows.delta[n + 1 :] = 0.5 * (before + after), after - before

    def _set_loads(self, time: float) -> None:
        """Forces of the loads at ``time``; strains without stress do work when they change."""
        self.system.set_time(time)
        for array, value in zip(self.model.loads, self.system.loads, strict=True):
            array[:] = value
        self.model.pressure.across[:] = across(self._pressures)
        if self._strained:
            before = self.s.W.copy()
            self.cells.pack()
            gain = self._evaluate_start() - before
            self.s.account[:] += gain
            self.s.books[WORK] += gain.sum()

    # --- matrix ---

    def _factorise(self) -> None:
        """New matrix at the present end of the step."""
        self._fill_here()
        self._factors = factorise(self.system.kkt)
        self.counts[:] = self.counts[0] + 1, self.index
        within = self.counters[stopping.ITERATION] > 1
        self.counters[stopping.BEST] = stopping.NEW if within else stopping.UNKNOWN
        self.numbers[stopping.EXCESS] = 0.0

    def _fill_here(self) -> None:
        """The matrix, not yet factorised: at the present end of the step, or at its start.

        An end that is only predicted has stresses that are not there.
        """
        s, this, n = self.s, self.this, self.system.count
        if self.counters[stopping.ITERATION] > 1:
            packed = self._packed
            packed_residual(packed.model, packed.state, packed.step)
            H = Span(*this.rows).end
            v, a = local(H[:n], 0.5 * (s.V + this.V1)), local(H[:n], (this.V1 - s.V) / self.h)
            age = 0.0
        else:
            H, v, age = s.H, local(s.H[:n], s.V), 1.0
            a = 2.0 * np.einsum("nij,nkj->nki", H[:n, 1:], s.trend.reshape(n, 2, 3)).reshape(n, 6)
        a[:, :3] -= np.cross(v[:, 3:], v[:, :3])
        # the constraints in the middle of the matrix's likely life: as old as the last one became
        age += (self.index - self.counts[1]) // 2
        self._fill(H, v, a, self._moved(H, v, age), self._moved(H, v, age - 0.5))

    def _moved(self, H: Array, v: Array, steps: float) -> Array:
        """Frames so many steps later."""
        n, ahead = self.system.count, H.copy()
        ahead[:n] = lie.se3_retract(H[:n], steps * self.h * v)
        return ahead

    def _fill(
        self,
        H: Array,
        v: Array,
        a: Array,
        joints_at: Array | None = None,
        forces_at: Array | None = None,
    ) -> None:
        """The matrix at frames ``H``.

        Constraints are to hold at the end of a step, ``joints_at``, by forces at its mean.
        """
        system, n = self.system, self.system.count
        twists = np.zeros_like(system.velocities)
        twists[:n] = v
        scale, r = self.model.scale, np.empty(system.size)
        system.applied(H, twists, a, self.s.weights, scale, r)
        if system.choices.geometric:
            system.elastic.reset_stress(H)
        else:
            system.elastic.clear_stress()
        # the first step conserves, see filtered
        h, still = (1.0 + self.options.loss * self.s.lag[REMEMBERS]) * self.h, np.zeros((n, 6))
        state = H, twists, a, self.s.weights, scale, still
        system.fill_matrix(*state, 4.0 / h**2, 2.0 / h, joints_at, forces_at=forces_at)

    # --- results ---

    def _record(self, history: History) -> bool:
        index = self.index
        wanted = history.wants(index)
        if wanted:
            self.keep(history)
        if index:
            history.update_if_due(index, int(self.counters[stopping.TOTAL]))
        return wanted

    def _result(self, history: History) -> Result:
        return history.result(int(self.counts[0]), history.seconds)

    def keep(self, history: History) -> None:
        """Keep the present state."""
        s, row, weights = self.s, history.row, self._end_weights()
        self._filled.by_rates(history, s.H, s.V, weights, s.books)
        if len(self.system.supported):
            history.reactions[row] = self._reactions(weights)
        history.elastic[row] += s.W.sum()
        history.keep(np.array([self.index]), self.counters[stopping.TOTAL : stopping.TOTAL + 1])

    def _end_weights(self) -> Array:
        """Multipliers at the end of the last step, see :mod:`.end_forces`.

        In the first two steps, and in those after an event, by the equations of motion.
        """
        system, s = self.system, self.s
        if system.m == 0 or self.index == 0:
            return s.weights
        if s.sizes[-1] > 0.0:
            return at_end(s.weights, s.earlier, s.sizes)
        v, matrix = system.velocities.copy(), system.kkt.csr[0].copy()
        v[: system.count] = local(s.H[: system.count], s.V)
        solver = DirectSolver(system.kkt, PREFIX)
        _, weights = accelerations(system, solver, s.H, v, self._end, self.h)
        # the kept factors are those of this matrix
        system.kkt.csr[0][:] = matrix
        return weights

    def _reactions(self, weights: Array) -> Array:
        """Of supports, by the equations of motion at the end of the step."""
        system, s = self.system, self.s
        if system.time_dependent:
            system.set_time(self._end)
        system.elastic.settle(s.H)
        n, v = system.count, local(s.H, s.V)
        return system.reactions(s.H, v, local_rates(s.H[:n], v[:n], self.rates.end()), weights)

    # --- checkpoints ---

    def memory(self) -> dict[str, Array]:
        """All that the next steps depend on."""
        kept: dict[str, Any] = {f"s.{name}": value for name, value in self.s._asdict().items()}
        kept |= {"V1": self.this.V1, "r": self.this.r, "scale": self.model.scale}
        kept |= {"counters": self.counters, "numbers": self.numbers, "counts": self.counts}
        kept |= {f"local.{k}": part for k, part in enumerate(self.cells.local_fields)}
        return super().memory() | kept

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Be as when :meth:`memory` was called."""
        for name, array in self.s._asdict().items():
            array[:] = kept[f"s.{name}"]
        self.this.V1[:], self.this.r[:] = kept["V1"], kept["r"]
        self.model.scale[:] = kept["scale"]
        self.counters[:], self.numbers[:] = kept["counters"], kept["numbers"]
        self.counts[:] = kept["counts"]
        if self.system.time_dependent:
            self.system.set_time(max(self.index - 0.5, 0.0) * self.h)
            self.cells.pack()
            for array, value in zip(self.model.loads, self.system.loads, strict=True):
                array[:] = value
        self.cells.restore([kept[f"local.{k}"] for k in range(len(self.cells.local_fields))])
        super().restore(kept)
        self._note_rates()
        self._factors = factorise(self.system.kkt)


def local(H: Array, V: Any) -> Array:
    """Twists in the frames of rates (n, 4, 3) of (x, d₁, d₂, d₃): ``(RᵀẊ, ½ Σ e_k × Rᵀḋ_k)``."""
    out = np.empty((len(V), 6))
    inertia.local_twists(H, V, out)
    return out
