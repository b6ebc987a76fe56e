"""Generalised-α for rigid bodies that nothing holds: one compiled loop, no matrix of the scene.

Every body has its own six equations and its own iteration
(:mod:`fem_lie.solve.alpha.step.free_steps`), which does not depend on what else is in the scene:
each of a thousand bodies moves bit for bit as alone.

Scheme, start, stopping rule and results are those of :mod:`fem_lie.solve.alpha.generalised_alpha`.
Iterations are those of the body that takes most in a step; factorisations count those of all.
"""

from __future__ import annotations

import logging
from dataclasses import replace

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._state import attributes
from fem_lie.bodies.rigid import RigidBody
from fem_lie.lie.kinds import all_from_local, move_all
from fem_lie.results import Result
from fem_lie.results.record import BOOKED, Record
from fem_lie.scene import Scene
from fem_lie.scene.load import History as LoadHistory
from fem_lie.scene.load import NodalLoad, amplitudes, histories
from fem_lie.solve.alpha.options import Options
from fem_lie.solve.alpha.step import free_steps
from fem_lie.solve.alpha.step import node as scheme
from fem_lie.solve.alpha.step.free_records import (
    BODY,
    INCREMENT,
    RESIDUAL,
    Bodies,
    Kept,
    Loads,
    Plan,
    State,
)
from fem_lie.solve.alpha.step.free_records import Options as Iteration
from fem_lie.solve.motion.convergence import ROTATION, failure
from fem_lie.solve.motion.driver import Driver
from fem_lie.solve.motion.policies import Policy
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.plan import EqualSteps
from fem_lie.solve.recording.recorder import History
from fem_lie.system.equations import Equations

_log = logging.getLogger(__name__)

_CHUNK = 200_000  # steps of bodies between two returns to Python: 0.1 s


def applies(scene: Scene, policy: Policy) -> bool:
    """Whether the scene is rigid bodies alone, and the policy a rule for compiled loops."""
    return not scene.contacts and not scene.impacts and held_by_nothing(scene, policy)


def held_by_nothing(scene: Scene, policy: Policy) -> bool:
    """:func:`applies`, whatever the contacts."""
    holding = scene.joints, scene.connections, scene.clamps, scene.motions, scene.links
    held = any(holding) or any(body.held.any() for body in scene.bodies)
    rigid = all(isinstance(body, RigidBody) and not body.gram[0, 1:].any() for body in scene.bodies)
    nodal = [load for load in scene.loads if isinstance(load, NodalLoad)]
    simple = len(nodal) == len(scene.loads) and not any(load.on_directors().any() for load in nodal)
    return bool(scene.bodies) and rigid and simple and not held and policy.rule() is not None


class Run(Driver[History]):
    """One integration.

    Attributes:
        p: Parameters of the scheme.
        s: State at the start of the next step.
    """

    STATE = attributes("s", "_index", "_count", "_factorisations")

    def __init__(self, options: Options, equations: Equations, step: float) -> None:
        """Collect bodies and loads.

        Args:
            options: Of the scheme.
            equations: Of a scene that :func:`applies`.
            step: Step size.
        """
        scene = equations.scene
        _log.info("free rigid bodies only (%d): no matrix of the scene", len(scene.bodies))
        rule = options.policy.rule()
        assert rule is not None
        self.options = Iteration(
            float(options.tolerance),
            options.max_iterations,
            rule[0],
            float(rule[1]),
            options.policy.rescue,
        )
        self.scene, self.equations = scene, equations
        self._index, self._count, self._factorisations = 0, 0, 0
        self._failed: Array = np.zeros(3)
        unknowns, start = self.equations.unknowns, self.equations.start
        n = unknowns.moving
        self.blocks = np.empty((n, 4, 4))
        self.sizes = np.empty(n)
        for body, nodes in unknowns.bodies.items():
            assert isinstance(body, RigidBody)
            self.blocks[nodes], self.sizes[nodes] = body.gram, body.size
        trace = np.trace(self.blocks[:, 1:, 1:], axis1=1, axis2=2)
        J = trace[:, np.newaxis, np.newaxis] * np.eye(3) - self.blocks[:, 1:, 1:]
        scaling = np.column_stack([1.0 / self.sizes, np.full(n, ROTATION)])
        self.bodies = Bodies(self.blocks[:, 0, 0].copy(), J, scaling, unknowns.kinds)
        self.loads, self.histories = self._collect(scene)
        self.p = scheme.parameters(options.radius, step)
        self.s = State(
            start.frames[:n].copy(),
            np.zeros((n, 6)),
            np.zeros((n, 6)),
            np.zeros((n, 6)),
            # no ratio and no matrix yet: the first step makes one, whatever it costs
            np.tile([1.0, 0.0, 0.0, np.inf], (n, 1)),
            np.zeros((n, 9, 3)),
            np.zeros((n, 7)),
            np.zeros((n, 7)),
        )

    def _collect(self, scene: Scene) -> tuple[Loads, dict[int, LoadHistory]]:
        unknowns = self.equations.unknowns
        constant = np.zeros((unknowns.moving, 12))
        constant[:, :3] = self.bodies.mass[:, np.newaxis] * scene.gravity
        vary, owner, varying = [], [], histories(scene.loads)
        for k, given in enumerate(scene.loads):
            assert isinstance(given, NodalLoad)
            (node,) = unknowns.bodies[given.body]
            twelve, at = np.zeros(12), 6 if given.following else 0
            twelve[at : at + 6] = given.nodal()[0]
            if k in varying:
                vary.append(twelve)
                owner.append(node)
            else:
                constant[node] += twelve
        nodes = np.array(owner, dtype=np.int64)
        order = np.argsort(nodes, kind="stable")
        first = np.searchsorted(nodes[order], np.arange(unknowns.moving + 1))
        table = np.array(vary).reshape(-1, 12)[order]
        return Loads(constant, first, table, order), varying

    @property
    def _twists(self) -> Array:
        """At the start, local components, (n, 6)."""
        return self.equations.start.velocities[: len(self.s.H)]

    def start(self) -> None:
        """Consistent accelerations, and those that ``a`` stands for: α_m − α_f steps earlier."""
        s, ahead = self.s, self.p.ahead
        bodies, loads = self.bodies, self.loads
        amplitude = amplitudes(self.histories, [0.0, ahead])
        group, twists = self.bodies.group, self._twists
        all_from_local(group, s.H, twists, np.zeros_like(twists), s.v, s.vdot)
        free_steps.accelerations(bodies, loads, amplitude[0], s.H, s.v, s.vdot)
        d, H1, later = ahead * s.v + 0.5 * ahead**2 * s.vdot, s.H.copy(), np.empty_like(s.vdot)
        move_all(group, s.H, d, H1)
        v1 = s.v + ahead * s.vdot
        free_steps.accelerations(bodies, loads, amplitude[1], H1, v1, later)
        s.a[:] = s.vdot - self.p.shift / ahead * (later - s.vdot)
        free_steps.start_books(loads, amplitude[0], s.H, twists, s.rates)

    def history(
        self, plan: EqualSteps, progress: bool | None, store: Checkpoints | None
    ) -> History:
        """See the base class."""
        # energies and momenta are made of velocities
        plan = replace(plan, saving=replace(plan.saving, also=Record.VELOCITIES))
        return History(self.equations.info, plan, progress, store)

    @property
    def frames(self) -> Array:
        """See the base class."""
        return np.concatenate([self.s.H, self.equations.start.frames[len(self.s.H) :]])

    @property
    def index(self) -> int:
        """See the base class."""
        return self._index

    def integrate(self, history: History) -> Result:
        """See the base class."""
        self._go_on(history, range(1, 1), 0)  # compilation is not integration
        return super().integrate(history)

    def _advance(self, history: History) -> bool:
        index = self._index
        chunk = max(1, min(history.refresh, _CHUNK // len(self.s.H)))
        end = history.next_halt(index, min(chunk, history.room or chunk))
        if history.room:
            history.make_room(end - index)
        wanted = range(index + 1, end + 1)
        self._index, self._count, made = self._go_on(history, wanted, self._count)
        self._factorisations += made
        if self._index:
            history.update_if_due(self._index, self._count)
        return self._index == end

    def _record(self, history: History) -> bool:
        """See the base class: all rows but the first one are kept by the compiled loop."""
        if not self._index:
            history.frames[0], history.velocities[0] = self.s.H, self._twists
            start = np.zeros(1, dtype=np.int64)
            self._keep_rows(history, start, start)
        return True

    def _result(self, history: History) -> Result:
        return history.result(self._factorisations, history.seconds)

    def _go_on(self, history: History, wanted: range, before: int) -> tuple[int, int, int]:
        """Make the steps ``wanted``, after ``before`` iterations: last step, iterations, matrices.

        Counts are of all steps so far and of these steps.
        """
        indices = np.arange(wanted.start, wanted.stop)
        amplitude = amplitudes(self.histories, indices * self.p.h)
        taken = np.zeros(len(indices), dtype=np.int64)
        wanted_rows = (indices % history.every == 0) | (indices == history.steps)
        done = np.zeros((int(wanted_rows.sum()), 7))
        last, factorisations = free_steps.advance(
            self.p,
            self.options,
            self.bodies,
            self.loads,
            amplitude,
            self.s,
            Plan(wanted.start, wanted.stop - 1, history.row, history.steps, history.every),
            Kept(history.frames, history.velocities, done, taken, self._failed),
        )
        count = before + np.cumsum(taken)
        kept = (indices <= last) & wanted_rows
        count_kept = int(kept.sum())
        rows = slice(history.row, history.row + count_kept)
        self._book(history, rows, 0, done[:count_kept])
        self._keep_rows(history, indices[kept], count[kept])
        made = last - wanted.start + 1
        return last, int(count[made - 1]) if made else before, factorisations

    def _book(self, history: History, rows: slice, column: int, done: Array) -> None:
        """Keep sums of what acted, work or loss before impulses, shape (k, 7)."""
        if Record.ENERGIES in history.filled:
            history.balance[rows, column] = done[:, 0]
        if Record.MOMENTA in history.filled:
            history.impulses[rows, column] = done[:, 1:]

    def _keep_rows(self, history: History, indices: Indices, iterations: Indices) -> None:
        """Energies and momenta of the steps ``indices``, whose frames are in the next rows."""
        rows = slice(history.row, history.row + len(indices))
        if history.filled & BOOKED:
            potential = np.empty(len(indices))
            invariants = history.invariants[rows]
            states = history.frames[rows], history.velocities[rows]
            free_steps.observe(*states, self.blocks, self.loads.constant, invariants, potential)
            if Record.ENERGIES in history.filled:
                history.potential[rows] = potential
        history.keep(indices, iterations)

    def _failure(self, steps: int) -> str:
        index, failed = self._index + 1, self._failed
        name = self.scene.bodies[int(failed[BODY])].label
        limit, tolerance = self.options.limit, self.options.tolerance
        rescued = self.options.rescue
        reached = index, steps, self.p.h, limit, failed[INCREMENT], failed[RESIDUAL]
        text = failure(*reached, tolerance, rescued)
        return f"{name}: {text}"
