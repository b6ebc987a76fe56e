"""Generalised-α for free rigid bodies: one compiled loop without a global matrix.

Every body has its own six equations and its own iteration
(:mod:`fem_lie.solve.alpha.step.free_steps`), independent of the rest of the scene: each of a
thousand bodies moves bit for bit as in a scene of its own. The bodies may touch by impacts, which
change the ends of steps (:mod:`fem_lie.solve.alpha.free_impacts`).

Scheme, start, stopping rule and results are those of :mod:`fem_lie.solve.alpha.generalised_alpha`.
Iterations are the largest number of any body in a step; factorisations are counted over all bodies.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._state import attributes
from fem_lie.lie.node_types import all_from_local, move_all
from fem_lie.results import Result
from fem_lie.results.record import WITH_BALANCE, Record, with_others
from fem_lie.scene.load import amplitudes
from fem_lie.solve.alpha.free_impacts import FreeImpacts, Interval, packed_bodies, packed_loads
from fem_lie.solve.alpha.options import DAMPED, Options
from fem_lie.solve.alpha.step import free_steps
from fem_lie.solve.alpha.step import node as scheme
from fem_lie.solve.alpha.step.free_body import (
    BEYOND,
    BODY,
    FEWEST,
    INCREMENT,
    RESIDUAL,
    Plan,
    ResultRows,
    State,
)
from fem_lie.solve.alpha.step.free_body import Options as Iteration
from fem_lie.solve.convergence import failure
from fem_lie.solve.motion.integration import Divided
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.plan import EqualSteps
from fem_lie.solve.recording.recorder import History
from fem_lie.system.equations import Equations

_log = logging.getLogger(__name__)

_CHUNK = 200_000  # steps times bodies between two returns to Python: 0.1 s

_NEVER = 2**62
"""Number of steps between two rows if none is recorded."""


class Run(Divided[History]):
    """Run of free rigid bodies.

    Attributes:
        p: Parameters of the scheme.
        s: State at the start of the next step.
    """

    STATE = attributes("s", "_index", "_count", "_factorisations", "_impacts")

    def __init__(self, options: Options, equations: Equations, step: float) -> None:
        """Collect bodies and loads.

        Args:
            options: Options of the scheme.
            equations: Equations of a scene for which :func:`applies` is true.
            step: Step size.
        """
        super().__init__(options.policy, step)
        scene = equations.scene
        _log.info("free rigid bodies only (%d): no matrix of the scene", len(scene.bodies))
        rule = options.policy.rule()
        assert rule is not None
        self.options = Iteration(
            float(options.tolerance),
            options.max_iterations,
            rule[0],
            float(rule[1]),
            options.policy.full_newton_fallback,
        )
        self.scene, self.equations, self._radius = scene, equations, options.radius
        self._index, self._count, self._factorisations = 0, 0, 0
        self._failed: Array = np.zeros(3)
        unknowns, start = equations.unknowns, equations.start
        n = unknowns.moving
        self.blocks, self.sizes, self.bodies = packed_bodies(equations)
        self.loads, self.histories = packed_loads(equations, self.bodies.mass)
        self.p = scheme.parameters(options.radius, step)
        self.s = State(
            start.frames[:n].copy(),
            np.zeros((n, 6)),
            np.zeros((n, 6)),
            np.zeros((n, 6)),
            # no ratio and no matrix yet: the first step factorises one, whatever it costs
            np.tile([1.0, 0.0, 0.0, np.inf], (n, 1)),
            np.zeros((n, 9, 3)),
            np.zeros((n, 7)),
            np.zeros((n, 7)),
        )
        self._impacts: FreeImpacts | None = None
        if scene.impacts:
            force, own = self.loads.constant[:, :3], unknowns.bodies
            self._impacts = FreeImpacts(scene, own, self.bodies, force, self.sizes, self.s.H)

    @property
    def _twists(self) -> Array:
        """Initial twists in local components, (n, 6)."""
        return self.equations.start.velocities[: len(self.s.H)]

    def start(self) -> None:
        """Compute consistent accelerations."""
        s = self.s
        all_from_local(self.bodies.group, s.H, self._twists, np.zeros_like(s.v), s.v, s.vdot)
        self._make_consistent(0.0)
        amplitude = amplitudes(self.histories, [0.0])
        free_steps.start_balance(self.loads, amplitude[0], s.H, self._twists, s.rates)

    def _make_consistent(self, time: float) -> None:
        """Accelerations ``v̇`` at ``time``, and ``a``, valid α_m − α_f steps earlier."""
        s, ahead, group = self.s, self.p.ahead, self.bodies.group
        bodies, loads = self.bodies, self.loads
        amplitude = amplitudes(self.histories, [time, time + ahead])
        free_steps.accelerations(bodies, loads, amplitude[0], s.H, s.v, s.vdot)
        d, H1, later = ahead * s.v + 0.5 * ahead**2 * s.vdot, s.H.copy(), np.empty_like(s.vdot)
        move_all(group, s.H, d, H1)
        v1 = s.v + ahead * s.vdot
        free_steps.accelerations(bodies, loads, amplitude[1], H1, v1, later)
        s.a[:] = s.vdot - self.p.shift / ahead * (later - s.vdot)

    def history(
        self, plan: EqualSteps, progress: bool | None, store: Checkpoints | None
    ) -> History:
        """Create the history of results."""
        if self._impacts is not None:
            self._impacts.history.begin(plan.steps)
        # energies and momenta are computed from velocities
        plan = replace(plan, saving=replace(plan.saving, also=Record.VELOCITIES))
        return History(self.equations.info, plan, progress, store)

    @property
    def frames(self) -> Array:
        """Current frames of all nodes, ground and prescribed motions."""
        return np.concatenate([self.s.H, self.equations.start.frames[len(self.s.H) :]])

    @property
    def index(self) -> int:
        """Number of steps made, including the current one."""
        return self._index

    def integrate(self, history: History) -> Result:
        """Make all remaining steps."""
        self._history = history
        self._make(range(1, 1), np.zeros(0), kept=True)  # compilation is not integration
        return super().integrate(history)

    # --- the size of the step ---

    def _set_size(self, h: float) -> None:
        radius = self._radius
        self.p = scheme.parameters(min(radius, DAMPED) if self.division.level else radius, h)

    def resize(self, time: float, size: float) -> None:
        """Start steps of another size; velocities of free bodies do not depend on it."""
        self._set_size(size)
        self._make_consistent(time)
        convergence = self.s.convergence
        convergence[:, FEWEST], convergence[:, BEYOND] = 0.0, np.inf

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Restore the state that :meth:`saved_state` returned."""
        super().restore(kept)
        self._set_size(self.part_size)

    # --- steps ---

    def _advance(self, history: History) -> bool:
        if self.division.level:
            return self._in_parts()
        index = self._index
        chunk = max(1, min(history.refresh, _CHUNK // len(self.s.H)))
        end = history.next_halt(index, min(chunk, history.free_rows or chunk))
        if history.free_rows:
            history.ensure_rows(end - index)
        wanted = range(index + 1, end + 1)
        self._index = self._make(wanted, self.h * np.arange(index + 1.0, end + 1.0), kept=True)
        if self._index < end:
            if not self.divides:
                return False
            self.division.halve(self, self._index * self.h, self.h)
            return self._in_parts()
        self._show(history)
        return True

    def _show(self, history: History) -> None:
        if self._index:
            history.update_if_due(self._index, self._count)

    def _in_parts(self) -> bool:
        """Make the next step in sub-steps; return whether it was made."""
        if self._impacts is not None:
            self._impacts.history.begin_step(self._index + 1)
        if self._history.free_rows:
            self._history.ensure_rows(1)
        made = self._cover()
        self._index += made
        self._show(self._history)
        return made

    def attempt(self, start: float, end: float) -> bool:
        """Make a step; the row of a divided step is that of its last sub-step."""
        step, last = self.begun + 1, end == (self.begun + 1) * self.h
        return self._make(range(step, step + 1), np.array([end]), kept=last) == step

    def _record(self, history: History) -> bool:
        """Record the initial state; the compiled loop records all others."""
        if not self._index:
            history.frames[0], history.velocities[0] = self.s.H, self._twists
            start = np.zeros(1, dtype=np.int64)
            self._keep_rows(history, start, start)
        return True

    def _result(self, history: History) -> Result:
        self.division.report(self._index)
        contacts = None
        if self._impacts is not None:
            contacts = self._impacts.history.result(self.h)
            history.add(contacts)
        divided = self.division.divided
        made = history.result(self._factorisations, history.seconds, divided=divided)
        return made if contacts is None else with_others(made, {"contacts": contacts})

    def _make(self, wanted: range, times: Array, *, kept: bool) -> int:
        """Make steps that end at ``times``; return the number of the last one made.

        If a step failed, the state is that at its start.

        Args:
            wanted: Numbers of the steps.
            times: Their ends.
            kept: Whether rows are recorded.
        """
        history, indices = self._history, np.arange(wanted.start, wanted.stop)
        every, total = (history.every, history.steps) if kept else (_NEVER, -1)
        rows = (indices % every == 0) | (indices == total)
        taken, count = np.zeros(len(indices), dtype=np.int64), int(rows.sum())
        interval = Interval(
            Plan(wanted.start, wanted.stop - 1, history.row, total, every),
            times,
            amplitudes(self.histories, times),
            ResultRows(
                history.frames, history.velocities, np.zeros((count, 7)), taken, self._failed
            ),
            rows,
        )
        done = None
        self.reason = ""
        if self._impacts is None:
            last, made = self._alone(interval)
        else:
            how = self.p, self.options, self.loads, self.s, interval
            last, made, done = self._impacts.advance(*how)
            if last < wanted.stop - 1:
                if self._impacts.crossed:
                    self.reason = self._impacts.failure(self.p, self.s.v)
                self._impacts.go_back(self.s.H)
        self._factorisations += made
        counts = self._count + np.cumsum(taken)
        filled = (indices <= last) & rows
        number = int(filled.sum())
        at = slice(history.row, history.row + number)
        self._add_to_balance(history, at, 0, interval.rows.done[:number])
        if done is not None:
            self._add_to_balance(history, at, 1, done[:number])
        self._keep_rows(history, indices[filled], counts[filled])
        if last >= wanted.start:
            self._count = int(counts[last - wanted.start])
        return last

    def _alone(self, interval: Interval) -> tuple[int, int]:
        """Steps of bodies that do not touch.

        Returns the last one and the number of factorisations.
        """
        plan, rows = interval.plan, interval.rows
        before = State(*(array.copy() for array in self.s))
        last, made = self._go(interval)
        if last < plan.last:
            # some bodies have passed that step
            for array, start in zip(self.s, before, strict=True):
                array[:] = start
            rows.done[:], rows.iterations[:], noted = 0.0, 0, self._failed.copy()
            self._go(interval._replace(plan=plan._replace(last=last)))
            self._failed[:] = noted
        return last, made

    def _go(self, interval: Interval) -> tuple[int, int]:
        how = self.p, self.options, self.bodies, self.loads, interval.amplitude, self.s
        return free_steps.advance(*how, interval.plan, interval.rows)

    def _add_to_balance(self, history: History, rows: slice, column: int, done: Array) -> None:
        """Record sums (k, 7) of work (or losses) and impulses."""
        if Record.ENERGIES in history.filled:
            history.balance[rows, column] = done[:, 0]
        if Record.MOMENTA in history.filled:
            history.impulses[rows, column] = done[:, 1:]

    def _keep_rows(self, history: History, indices: Indices, iterations: Indices) -> None:
        """Energies and momenta of the steps ``indices``, whose frames are in the next rows."""
        rows = slice(history.row, history.row + len(indices))
        if history.filled & WITH_BALANCE:
            potential = np.empty(len(indices))
            invariants = history.invariants[rows]
            states = history.frames[rows], history.velocities[rows]
            free_steps.observe(*states, self.blocks, self.loads.constant, invariants, potential)
            if Record.ENERGIES in history.filled:
                history.potential[rows] = potential
        history.keep(indices, iterations)

    def _failure(self, steps: int) -> str:
        index, failed, wedged = self._index + 1, self._failed, ""
        if self._impacts is not None:
            wedged = self._impacts.failure(self.p, self.s.v)
        if reason := self.reason or wedged:
            return self._nor_in_parts(f"step {index} of {steps}: {reason}")
        name = self.scene.bodies[int(failed[BODY])].label
        limit, tolerance = self.options.limit, self.options.tolerance
        after_fallback = self.options.full_newton_fallback
        reached = index, steps, self.h, limit, failed[INCREMENT], failed[RESIDUAL]
        text = failure(*reached, tolerance, after_fallback)
        return self._nor_in_parts(f"{name}: {text}")
