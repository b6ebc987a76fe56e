"""A run of several sizes of steps: the domains, what is told at the ends of whole steps."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fem_lie._arrays import Array
from fem_lie._state import attributes
from fem_lie.linear.direct import DirectSolver
from fem_lie.results import Result
from fem_lie.results.record import Record
from fem_lie.solve.conserving.between.product_rows import product_numbers
from fem_lie.solve.conserving.outside.forces import joints_of
from fem_lie.solve.conserving.run_state import PREFIX, Options
from fem_lie.solve.motion.consistent import accelerations, check_velocities
from fem_lie.solve.motion.integration import DividedIntegration
from fem_lie.solve.multirate.coupling import Coupling
from fem_lie.solve.multirate.domain import Domain
from fem_lie.solve.multirate.split import rows_of
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.plan import EqualSteps
from fem_lie.solve.recording.recorder import History
from fem_lie.solve.recording.result_row import ResultRow
from fem_lie.system.equations import Equations, Instant


class MultiRateRun(DividedIntegration[History]):
    """One integration."""

    STATE = attributes("_coupling", "_made", "_domains")

    def __init__(
        self,
        options: Options,
        equations: Equations,
        step: float,
        parts: Mapping[int, Equations],
        between: Equations,
    ) -> None:
        """Nothing is computed yet.

        Args:
            options: Of the scheme of all steps.
            equations: Of the whole scene.
            step: Size of whole steps.
            parts: Equations of the bodies of each number of steps in a whole one.
            between: Those of all bodies and the joints between parts.
        """
        super().__init__(options.policy, equations, step)
        self.carried = equations.memory
        self.options = options
        self._domains = tuple(
            Domain(options, part, step, count, rows_of(part, equations))
            for count, part in parts.items()
        )
        bodies = equations.tables.floating
        self._products = [
            product_numbers(part.tables.floating, domain.rows, bodies)
            for part, domain in zip(parts.values(), self._domains, strict=True)
        ]
        self._coupling = Coupling(between, equations, self._domains)
        self.H = equations.start.frames.copy()
        self._filled, self._r = ResultRow(equations), np.empty(equations.unknowns.size)
        self._solver: DirectSolver | None = None
        self._made, self._joints = 0, joints_of(equations)

    def history(
        self, plan: EqualSteps, progress: bool | None, store: Checkpoints | None
    ) -> History:
        """See the base class."""
        return History(self.equations.info, plan, progress, store)

    def start(self) -> None:
        """See the base class."""
        check_velocities(self.equations, self.h)
        for domain in self._domains:
            domain.start()

    @property
    def frames(self) -> Array:
        """See the base class."""
        for domain in self._domains:
            self.H[domain.rows] = domain.s.H[: domain.moving]
        return self.H

    @property
    def index(self) -> int:
        """See the base class."""
        return self._made

    def _advance(self, history: History) -> bool:
        done = self._cover()
        self._made += done
        return done

    def attempt(self, start: float, end: float) -> bool:
        """See the base class."""
        return self._coupling.step(start, self.options.max_iterations)

    def resize(self, time: float, size: float) -> None:
        """See the base class."""
        self._coupling.resize(self.part_size)

    def _failure(self, steps: int) -> str:
        text = (
            f"step {self.index + 1} of {steps} (h = {self.h:g}) failed: joints between bodies with "
            f"steps of their own were left open by {self._coupling.left:.2g} of the model, or a "
            "step of a body was not found; a smaller step may help"
        )
        return self._nor_in_parts(text)

    # --- results ---

    def _record(self, history: History) -> bool:
        wanted = history.wants(self.index)
        if wanted:
            self._keep_row(history)
        if self.index:
            history.update_if_due(self.index, self._coupling.tries)
        return wanted

    def _result(self, history: History) -> Result:
        factorisations = sum(int(domain.counts[0]) for domain in self._domains)
        self.division.report(self.index)
        divided = self.division.divided
        return history.result(factorisations, history.seconds, divided=divided)

    def _keep_row(self, history: History) -> None:
        equations, row = self.equations, history.row
        n, m = equations.unknowns.moving, equations.unknowns.m
        rows = n + sum(map(len, self._products))
        held, H, V = len(equations.unknowns.supported) > 0, self.frames, np.empty((rows, 4, 3))
        v = equations.start.velocities.copy()
        rates: Array = np.zeros((n, 6))
        weights: Array = np.zeros(m)
        if equations.unknowns.time_dependent:
            equations.prescribed(self.index * self.h).act()
        for domain, products in zip(self._domains, self._products, strict=True):
            own = domain.s.V[: domain.moving]
            V[domain.rows], V[n + products] = own, domain.s.V[domain.moving :]
            v[domain.rows] = domain.local(own, domain.s.H)
        if Record.FORCES in history.filled and (held or m):
            rates, weights = self._end_forces(H, v)
        books = np.sum([domain.s.books for domain in self._domains], axis=0)
        self._filled.by_both(history, H, (V, v[:n]), weights, books)
        if Record.FORCES in history.filled and held:
            told = equations.report(H, v, rates, weights, carried=False)
            history.reactions[row] = told.reactions
        if Record.ENERGIES in history.filled:
            if self._joints is not None:
                history.elastic[row] = self._joints.energy(H)
            history.elastic[row] += sum(domain.stored for domain in self._domains)
        history.keep(np.array([self.index]), np.array([self._coupling.tries]))

    def _end_forces(self, H: Array, v: Array) -> tuple[Array, Array]:
        """Accelerations and multipliers of the equations of motion, with a matrix of their own."""
        equations = self.equations
        if self._solver is None:
            self._solver = DirectSolver(equations.matrix, PREFIX)
        n, ones = equations.unknowns.moving, np.ones(equations.unknowns.m)
        still = np.zeros((n, 6))
        # elements' own unknowns are those of the domains, and not yet known to the equations
        equations.residual(Instant(H, v, still, 0.0 * ones), ones, self._r)
        time, size = self.index * self.h, self.h / max(d.count for d in self._domains)
        return accelerations(equations, self._solver, H, v, time, size, sweeps=2)
