"""Generalised-α for rigid bodies that nothing holds, and that touch each other and ground.

Each body makes its step as if it were alone (:mod:`fem_lie.solve.alpha.free_bodies`), and contacts
change its end (:mod:`fem_lie.contact.impact.settle`). Accelerations are then those of the end
without contacts.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._state import attributes
from fem_lie.contact.impact.observed import WIDTH
from fem_lie.contact.impact.records import (
    CONTACTS,
    RESIDUAL,
    TOLD,
    Masses,
)
from fem_lie.contact.impact.touching import Touching
from fem_lie.contact.impact.velocities import largest_speed
from fem_lie.forms.abilities import PassedThroughError
from fem_lie.lie.motions import Group
from fem_lie.results import Result
from fem_lie.scene import Scene
from fem_lie.scene.load import amplitudes
from fem_lie.solve.alpha import free_bodies
from fem_lie.solve.alpha.options import Options
from fem_lie.solve.alpha.step.free_records import Kept, Plan
from fem_lie.solve.alpha.step.impact_steps import (
    CROSSED,
    FULL,
    MADE,
    OVERLAPPING,
    STALE,
    UNSETTLED,
    Contacts,
    advance,
)
from fem_lie.solve.impacts.history import ContactHistory
from fem_lie.solve.motion.policies import Policy
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.plan import EqualSteps
from fem_lie.solve.recording.recorder import History
from fem_lie.system.equations import Equations

_ROOM = 10_000
"""For so many contacts what results have of them is kept before it is taken."""

_TOLERANCE = 1e-9
"""Residual of the cones; where it is not reached it is told, see :class:`ContactSteps`."""


def applies(scene: Scene, policy: Policy) -> bool:
    """Whether the scene is free rigid bodies, and impacts between them and ground."""
    flat = all(body.group == Group.R3xSO3 for body in scene.bodies)
    return (
        bool(scene.impacts)
        and not scene.contacts
        and flat
        and free_bodies.held_by_nothing(scene, policy)
    )


class Run(free_bodies.Run):
    """One integration."""

    STATE = attributes("_touching", "_contacts.sum", "_contacts.booked", "_told")

    def __init__(self, options: Options, equations: Equations, step: float) -> None:
        """Collect bodies, loads and contacts."""
        super().__init__(options, equations, step)
        bodies, nodes = self.bodies, self.equations.unknowns.bodies
        inverse = np.linalg.inv(bodies.J).astype(np.float64)
        self._masses = Masses(bodies.mass, bodies.J, inverse, self.loads.constant[:, :3].copy())
        self._touching = Touching(equations.scene.impacts, nodes.__getitem__, self.sizes, self.s.H)
        self._contacts = Contacts(
            _TOLERANCE,
            self._touching.patience,
            self._touching.arm,
            self._touching.thin,
            np.full(1, -1),
            np.zeros(1),
            np.zeros((0, TOLD)),
            np.zeros(7),
            np.zeros((0, 7)),
            np.zeros((_ROOM, WIDTH)),
            np.zeros(1, dtype=np.int64),
        )
        self._told = ContactHistory()
        self._why = MADE

    def history(
        self, plan: EqualSteps, progress: bool | None, store: Checkpoints | None
    ) -> History:
        """See the base class."""
        self._told.begin(plan.steps)
        return super().history(plan, progress, store)

    def _result(self, history: History) -> Result:
        found = self._told.result(self.p.h)
        history.add(found)
        return Result(**vars(super()._result(history)) | {"contacts": found})

    def restore(self, kept: Mapping[str, Array]) -> None:
        """See the base class."""
        super().restore(kept)
        self._contacts = self._contacts._replace(patience=self._touching.patience)

    def _go_on(self, history: History, wanted: range, before: int) -> tuple[int, int, int]:
        first, made, factorisations = wanted.start, before, 0
        while True:
            left = range(first, wanted.stop)
            last, made, more, why = self._go(history, left, made)
            factorisations += more
            self._why = why
            self._take_shown()
            if why == FULL:
                first, room = last + 1, max(_ROOM, 4 * len(self._touching.touch.pairs))
                self._contacts = self._contacts._replace(room=np.zeros((room, WIDTH)))
                continue
            if why != STALE:
                return last, made, factorisations
            far = self.p.h * largest_speed(self.s.v, self._contacts.arm)
            self._touching.update(self.s.H, far)
            self._contacts = self._contacts._replace(patience=self._touching.patience)
            self._contacts.sum[0], first = 0.0, last + 1

    def _take_shown(self) -> None:
        """Take what results have of contacts, with the numbers of these and of their places."""
        count = int(self._contacts.shown[0])
        self._told.append(self._touching.named(self._contacts.room[:count]))
        self._contacts.shown[0] = 0

    def _go(self, history: History, wanted: range, before: int) -> tuple[int, int, int, int]:
        """Steps until the list of pairs is old: last step, iterations, matrices, and why."""
        indices: Indices = np.arange(wanted.start, wanted.stop)
        amplitude = amplitudes(self.histories, indices * self.p.h)
        taken = np.zeros(len(indices), dtype=np.int64)
        rows = (indices % history.every == 0) | (indices == history.steps)
        done, contacts = np.zeros((int(rows.sum()), 7)), np.zeros((int(rows.sum()), 7))
        last, factorisations, why = advance(
            self.p,
            self.options,
            self.bodies,
            self.loads,
            amplitude,
            self.s,
            Plan(wanted.start, wanted.stop - 1, history.row, history.steps, history.every),
            Kept(history.frames, history.velocities, done, taken, self._failed),
            self._touching.touch,
            self._masses,
            self._touching.work,
            self._contacts._replace(done=contacts, told=self._told.steps),
        )
        count, kept = before + np.cumsum(taken), (indices <= last) & rows
        number = int(kept.sum())
        at = slice(history.row, history.row + number)
        self._book(history, at, 0, done[:number])
        self._book(history, at, 1, contacts[:number])
        self._keep_rows(history, indices[kept], count[kept])
        made = last - wanted.start + 1
        return last, int(count[made - 1]) if made else before, factorisations, why

    def _failure(self, steps: int) -> str:
        index = self.index + 1
        if self._why == CROSSED:
            who = " and ".join(self._names(int(self._contacts.failed[0])))
            moved = self.p.h * largest_speed(self.s.v, self._contacts.arm)
            return f"step {index} of {steps}: {PassedThroughError(who, moved, self._touching.thin)}"
        if self._why == OVERLAPPING:
            pair = int(self._contacts.failed[0])
            one, other = self._names(pair)
            return (
                f"step {index} of {steps}: {one} and {other} still overlap by "
                f"{-self._touching.work.gaps[pair]:.2g} after all iterations that part contacts; "
                "are bodies wedged? Try smaller steps, or Penalty"
            )
        if self._why != UNSETTLED:
            return super()._failure(steps)
        reached = float(self._told.steps[index - 1, RESIDUAL])
        count = int(self._told.steps[index - 1, CONTACTS])
        work = self._touching.work
        worst = int(np.argmax(np.abs(work.cones.r[:count]).max(axis=1)))
        one, other = self._names(int(work.chosen[worst]))
        return (
            f"step {index} of {steps}: {count} contacts did not settle (residual {reached:.0e}); "
            f"are bodies wedged, such as {one} and {other}? Try smaller steps, or Penalty"
        )

    def _names(self, pair: int) -> list[str]:
        return self._touching.names(pair, self.equations.unknowns.bodies)
