"""Generalised-α for rigid bodies that nothing holds: one compiled loop, no matrix of the scene.

Every body has its own six equations and its own iteration
(:mod:`fem_lie.solve.alpha.step.free_steps`), which does not depend on what else is in the scene:
each of a thousand bodies moves bit for bit as alone.

Scheme, start, stopping rule and results are those of :mod:`fem_lie.solve.alpha.generalised_alpha`.
Iterations are those of the body that takes most in a step; factorisations count those of all.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.rigid import RigidBody
from fem_lie.lie.kinds import all_from_local, move_all
from fem_lie.linear.direct import ConvergenceError
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
from fem_lie.solve.motion.policies import Policy
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.fingerprint import Fingerprint
from fem_lie.solve.recording.recorder import History
from fem_lie.solve.recording.saving import Saving
from fem_lie.solve.stopwatch import Stopwatch
from fem_lie.system.equations import Equations

_CHUNK = 200_000  # steps of bodies between two returns to Python: 0.1 s


def applies(scene: Scene, policy: Policy) -> bool:
    """Whether the scene is rigid bodies alone, and the policy a rule for compiled loops."""
    return not scene.contacts and held_by_nothing(scene, policy)


def held_by_nothing(scene: Scene, policy: Policy) -> bool:
    """:func:`applies`, whatever the contacts."""
    holding = scene.joints, scene.connections, scene.clamps, scene.motions, scene.links
    held = any(holding) or any(body.held.any() for body in scene.bodies)
    rigid = all(isinstance(body, RigidBody) and not body.gram[0, 1:].any() for body in scene.bodies)
    nodal = [load for load in scene.loads if isinstance(load, NodalLoad)]
    simple = len(nodal) == len(scene.loads) and not any(load.on_directors().any() for load in nodal)
    return bool(scene.bodies) and rigid and simple and not held and policy.rule() is not None


class Alone:
    """Runs whose results go to files: by the same loop, to the same bits, as those in memory.

    Attributes:
        fingerprint: Of the scene.
    """

    def __init__(self, options: Options, scene: Scene) -> None:
        """Of a scene that :func:`applies`."""
        self._options, self._scene = options, scene
        also = [("states of the loop of free rigid bodies", "the loop that makes steps")]
        self.fingerprint = Fingerprint(Equations(scene, dynamics=True), options, also)

    def integrate(self, store: Checkpoints, progress: bool | None) -> Result:
        """All steps that a file and its checkpoint leave to be made."""
        steps, step, saving = store.plan
        return Run(self._options, self._scene, step).integrate(steps, saving, progress, store)


class Run:
    """One integration.

    Attributes:
        p: Parameters of the scheme.
        s: State at the start of the next step.
    """

    def __init__(
        self,
        options: Options,
        scene: Scene,
        step: float,
    ) -> None:
        """Collect bodies and loads.

        Args:
            options: Of the scheme.
            scene: One that :func:`applies`.
            step: Step size.
        """
        rule = options.policy.rule()
        assert rule is not None
        self.options = Iteration(
            float(options.tolerance),
            options.max_iterations,
            rule[0],
            float(rule[1]),
            options.policy.rescue,
        )
        self.scene, self.equations = scene, Equations(scene, dynamics=True)
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

    def integrate(
        self, steps: int, saving: Saving, progress: bool | None, store: Checkpoints | None = None
    ) -> Result:
        """All steps, or those after a checkpoint; see :meth:`fem_lie.GeneralisedAlpha.run`."""
        # energies and momenta are made of velocities
        saving = replace(saving, also=Record.VELOCITIES)
        history = History(self.equations.info, steps, self.p.h, saving, progress, store)
        failed, index, count, factorisations = np.zeros(3), 0, 0, 0
        if store is not None and store.memory:
            self.restore(store.memory)
            index, count, factorisations = (int(number) for number in store.memory["counts"])
        else:
            self.start()
            history.frames[0], history.velocities[0] = self.s.H, self._twists
            start = np.zeros(1, dtype=np.int64)
            self._keep(history, start, start)
        self._advance(history, range(1, 1), failed)  # compilation is not integration
        watch = Stopwatch(history.seconds)
        chunk = max(1, min(history.refresh, _CHUNK // len(self.s.H)))
        chunk = min(chunk, history.room or chunk)
        with history:
            while index < steps:
                end = min(index + chunk, steps)
                if store is not None:
                    end = min(end, (index // store.every + 1) * store.every)
                wanted = range(index + 1, end + 1)
                if history.room:
                    history.make_room(len(wanted))
                index, count, made = self._advance(history, wanted, failed, count)
                factorisations += made
                if index and history.show:
                    history.update_bar(index, count)
                if index < wanted[-1]:
                    result = history.result(factorisations, watch.seconds)
                    raise ConvergenceError(self._failure(index + 1, steps, failed), result)
                if history.checkpoint_due(index):
                    history.seconds = watch.seconds
                    counts = {"counts": np.array([index, count, factorisations])}
                    history.write_checkpoint(index, self.memory() | counts)
        return history.result(factorisations, watch.seconds)

    def memory(self) -> dict[str, Array]:
        """All that the next steps depend on."""
        return {f"bodies.{name}": values for name, values in self.s._asdict().items()}

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Be as when :meth:`memory` was called."""
        for name, values in self.s._asdict().items():
            values[...] = kept[f"bodies.{name}"]

    def _advance(
        self, history: History, wanted: range, failed: Array, before: int = 0
    ) -> tuple[int, int, int]:
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
            Kept(history.frames, history.velocities, done, taken, failed),
        )
        count = before + np.cumsum(taken)
        kept = (indices <= last) & wanted_rows
        count_kept = int(kept.sum())
        rows = slice(history.row, history.row + count_kept)
        self._book(history, rows, 0, done[:count_kept])
        self._keep(history, indices[kept], count[kept])
        made = last - wanted.start + 1
        return last, int(count[made - 1]) if made else before, factorisations

    def _book(self, history: History, rows: slice, column: int, done: Array) -> None:
        """Keep sums of what acted, work or loss before impulses, shape (k, 7)."""
        if Record.ENERGIES in history.filled:
            history.balance[rows, column] = done[:, 0]
        if Record.MOMENTA in history.filled:
            history.impulses[rows, column] = done[:, 1:]

    def _keep(self, history: History, indices: Indices, iterations: Indices) -> None:
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

    def _failure(self, index: int, steps: int, failed: Array) -> str:
        name = self.scene.bodies[int(failed[BODY])].label
        limit, tolerance = self.options.limit, self.options.tolerance
        rescued = self.options.rescue
        reached = index, steps, self.p.h, limit, failed[INCREMENT], failed[RESIDUAL]
        text = failure(*reached, tolerance, rescued)
        return f"{name}: {text}"
