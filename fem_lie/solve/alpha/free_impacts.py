"""Impacts of free rigid bodies in a run of generalised-α.

The step of each body is made without contacts, which then change its end
(:mod:`fem_lie.contact.impact.resolve`). One compiled loop does this and returns for new lists of
contact pairs.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._state import Stateful, attributes
from fem_lie.bodies.body import Body
from fem_lie.bodies.rigid import RigidBody
from fem_lie.contact.impact.records import Masses, step_reports
from fem_lie.contact.impact.rows import set_gaps
from fem_lie.contact.impact.touching import WIDTH, Touching
from fem_lie.contact.impact.velocities import largest_speed
from fem_lie.forms.abilities import PassedThroughError
from fem_lie.lie.motions import Group
from fem_lie.scene import Scene
from fem_lie.scene.load import History as LoadHistory
from fem_lie.scene.load import NodalLoad, histories
from fem_lie.solve.alpha.step.free_body import Bodies, Loads, Options, Plan, ResultRows, State
from fem_lie.solve.alpha.step.impact_steps import (
    CROSSED,
    FAILED,
    FULL,
    MADE,
    OVERLAPPING,
    STALE,
    UNSETTLED,
    Contacts,
    advance,
)
from fem_lie.solve.alpha.step.node import Scheme
from fem_lie.solve.convergence import ROTATION
from fem_lie.solve.impacts.step_end import ContactHistory
from fem_lie.solve.motion.policies import RefactorisationPolicy
from fem_lie.system.equations import Equations


def applies(scene: Scene, policy: RefactorisationPolicy) -> bool:
    """Whether the scene has free rigid bodies only, and compiled loops support the policy.

    The bodies may touch by impacts, between which they move on R³×SO(3).
    """
    if scene.contacts or (scene.impacts and not _on_r3_so3(scene)):
        return False
    holding = scene.joints, scene.connections, scene.clamps, scene.motions, scene.links
    held = any(holding) or any(body.model.held.any() for body in scene.bodies)
    rigid = all(
        isinstance(body, RigidBody) and not body.model.mass_matrix[0, 1:].any()
        for body in scene.bodies
    )
    nodal = [load for load in scene.loads if isinstance(load, NodalLoad)]
    simple = len(nodal) == len(scene.loads) and not any(load.on_directors().any() for load in nodal)
    return bool(scene.bodies) and rigid and simple and not held and policy.rule() is not None


def _on_r3_so3(scene: Scene) -> bool:
    return all(body.model.group == Group.R3xSO3 for body in scene.bodies)


def packed_bodies(equations: Equations) -> tuple[Array, Array, Bodies]:
    """Inertia blocks (n, 4, 4), lengths (n,), and arrays of n bodies for compiled steps."""
    unknowns = equations.unknowns
    n = unknowns.moving
    blocks, sizes = np.empty((n, 4, 4)), np.empty(n)
    for body, nodes in unknowns.bodies.items():
        assert isinstance(body, RigidBody)
        blocks[nodes], sizes[nodes] = body.model.mass_matrix, body.model.size
    trace = np.trace(blocks[:, 1:, 1:], axis1=1, axis2=2)
    J = trace[:, np.newaxis, np.newaxis] * np.eye(3) - blocks[:, 1:, 1:]
    scaling = np.column_stack([1.0 / sizes, np.full(n, ROTATION)])
    return blocks, sizes, Bodies(blocks[:, 0, 0].copy(), J, scaling, unknowns.kinds)


def packed_loads(equations: Equations, mass: Array) -> tuple[Loads, dict[int, LoadHistory]]:
    """Loads on the bodies, and the histories of some of them; ``mass`` has shape (n,)."""
    scene, unknowns = equations.scene, equations.unknowns
    constant = np.zeros((unknowns.moving, 12))
    constant[:, :3] = mass[:, np.newaxis] * scene.gravity
    vary, owner, varying = [], [], histories(scene.loads)
    for k, load in enumerate(scene.loads):
        assert isinstance(load, NodalLoad)
        (node,) = unknowns.bodies[load.body]
        twelve, at = np.zeros(12), 6 if load.following else 0
        twelve[at : at + 6] = load.nodal()[0]
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


_BUFFER = 10_000
"""Number of contacts that can be recorded before the loop returns."""

_TOLERANCE = 1e-15
"""Target residual of the contact cones, so that resting bodies do not creep; the remaining residual
is reported, see :class:`ContactSteps`."""


class Interval(NamedTuple):
    """Successive steps, and the rows that they fill in.

    Attributes:
        plan: Numbers of the steps.
        times: Times at their ends, shape (S,).
        amplitude: Amplitudes of the loads with history at these times, shape (S, k).
        rows: Recorded arrays.
        kept: Whether the row of each step is recorded, shape (S,).
    """

    plan: Plan
    times: Array
    amplitude: Array
    rows: ResultRows
    kept: Array

    def after(self, made: int) -> Interval:
        """The remaining steps after ``made`` of them."""
        plan, rows, filled = self.plan, self.rows, int(self.kept[:made].sum())
        return Interval(
            plan._replace(first=plan.first + made, row=plan.row + filled),
            self.times[made:],
            self.amplitude[made:],
            rows._replace(done=rows.done[filled:], iterations=rows.iterations[made:]),
            self.kept[made:],
        )


class FreeImpacts(Stateful):
    """Impacts of free rigid bodies.

    Attributes:
        history: Contact statistics of all steps of the run.
    """

    STATE = attributes("_touching", "_contacts.sum", "_contacts.balance", "history")

    def __init__(
        self,
        scene: Scene,
        nodes: Mapping[Body, Indices],
        bodies: Bodies,
        force: Array,
        sizes: Array,
        H: Array,
    ) -> None:
        """Collect contacts.

        Args:
            scene: Scene with contacts by impacts.
            nodes: Numbers of the nodes of each body.
            bodies: Arrays of the bodies.
            force: Constant forces on them, shape (n, 3).
            sizes: Their lengths, shape (n,).
            H: Initial frames, shape (n, 4, 3).
        """
        self._nodes, self._bodies = nodes, bodies
        inverse = np.linalg.inv(bodies.J).astype(np.float64)
        self._masses = Masses(bodies.mass, bodies.J, inverse, force.copy())
        self._touching = Touching(scene.impacts, nodes.__getitem__, sizes, H)
        self.history = ContactHistory()
        none = np.zeros((0, 7))
        self._contacts = Contacts(
            tolerance=_TOLERANCE,
            patience=self._touching.patience,
            arms=self._touching.arms,
            thin=self._touching.thin,
            failed=np.full(1, -1),
            sum=np.zeros(1),
            times=np.zeros(0),
            statistics=step_reports(0),
            balance=np.zeros(7),
            done=none,
            buffer=np.zeros((_BUFFER, WIDTH)),
            shown=np.zeros(1, dtype=np.int64),
        )
        self._why, self._failed_step = MADE, step_reports(1)[0]

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Restore the state that :meth:`saved_state` returned."""
        super().restore(kept)
        self._contacts = self._contacts._replace(patience=self._touching.patience)

    @property
    def crossed(self) -> bool:
        """Whether bodies have passed through each other in the step that failed."""
        return self._why == CROSSED

    def advance(
        self, p: Scheme, options: Options, loads: Loads, s: State, interval: Interval
    ) -> tuple[int, int, Array]:
        """Make steps; if one failed, frames and velocities are those at its start.

        Args:
            p: Parameters of the scheme.
            options: Options of the iteration.
            loads: Loads on the bodies.
            s: State of the bodies.
            interval: The steps.

        Returns:
            The last step made, the number of factorisations, and the accumulated work of contacts
            (as losses) and their impulses at each recorded row, shape (·, 7).
        """
        plan = interval.plan
        last, factorisations, done = plan.first - 1, 0, np.zeros((int(interval.kept.sum()), 7))
        reported, filled, left = step_reports(len(interval.times)), 0, interval
        while True:
            made = last + 1 - plan.first
            contacts = self._contacts._replace(
                times=left.times, statistics=reported[made:], done=done[filled:]
            )
            near = self._touching
            tables = near.touch, near.polyhedra, self._masses, near.work, contacts
            how = p, options, self._bodies, loads, left.amplitude, s, left.plan, left.rows
            last, more, self._why = advance(*how, *tables)
            factorisations += more
            self._take_shown()
            made = last + 1 - plan.first
            left, filled = interval.after(made), int(interval.kept[:made].sum())
            if self._why == FULL:
                buffer = max(_BUFFER, 4 * len(self._touching.touch.pairs))
                self._contacts = self._contacts._replace(buffer=np.zeros((buffer, WIDTH)))
            elif self._why == STALE:
                self._touching.update(s.H, p.h * largest_speed(s.v, self._contacts.arms))
                self._contacts = self._contacts._replace(patience=self._touching.patience)
                self._contacts.sum[0] = 0.0
            else:
                break
        self.history.add(plan.first, reported[:made])
        if self._why not in (MADE, FAILED):
            self._failed_step = reported[made]
        return last, factorisations, done

    def go_back(self, H: Array) -> None:
        """Begin another step at the start of the failed one, at frames ``H``."""
        work = self._touching.work
        set_gaps(self._touching.touch, H, 0, work.gaps)
        work.impulses[:] = 0.0

    def _take_shown(self) -> None:
        """Copy the contact data for results, with the numbers of contacts and points."""
        count = int(self._contacts.shown[0])
        self.history.append(self._touching.named(self._contacts.buffer[:count]))
        self._contacts.shown[0] = 0

    def failure(self, p: Scheme, v: Array) -> str:
        """Why contacts made the last step fail; empty: they did not.

        Args:
            p: Parameters of the scheme.
            v: Velocities at its start, shape (n, 6).
        """
        touching, pair = self._touching, int(self._contacts.failed[0])
        if self._why == CROSSED:
            moved = p.h * largest_speed(v, self._contacts.arms)
            return str(PassedThroughError(" and ".join(self._names(pair)), moved, touching.thin))
        if self._why == OVERLAPPING:
            one, other = self._names(pair)
            return (
                f"{one} and {other} still overlap by {self._failed_step['penetration']:.2g} after "
                "all iterations that separate contacts; are bodies wedged? Try smaller steps, or "
                "Penalty"
            )
        if self._why != UNSETTLED:
            return ""
        reached, count = float(self._failed_step["residual"]), int(self._failed_step["contacts"])
        worst = int(np.argmax(np.abs(touching.work.cones.r[:count]).max(axis=1)))
        one, other = self._names(int(touching.work.chosen[worst]))
        return (
            f"{count} contacts did not converge (residual {reached:.0e}); are bodies wedged, such "
            f"as {one} and {other}? Try smaller steps, or Penalty"
        )

    def _names(self, pair: int) -> list[str]:
        return self._touching.names(pair, self._nodes)
