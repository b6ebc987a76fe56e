"""Generalised-α for bodies of whatever sort that touch by impacts: in joints, and flexible ones.

Each step is made as without contacts, and these change its end
(:mod:`fem_lie.solve.alpha.ends.coupled_contacts`).
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._state import attributes
from fem_lie.contact.impact.observed import WIDTH
from fem_lie.contact.impact.records import CONTACTS, FRICTION, IMPACT, RESIDUAL
from fem_lie.contact.impact.records import TOLD as SIZE
from fem_lie.forms.abilities import PassedThroughError
from fem_lie.lie.kinds.kind import SLOPE
from fem_lie.results import Result
from fem_lie.solve.alpha.ends.coupled_contacts import CoupledContacts, Kept
from fem_lie.solve.alpha.impacts import contact_steps
from fem_lie.solve.alpha.options import Options
from fem_lie.solve.alpha.run import Run
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.plan import EqualSteps
from fem_lie.solve.recording.recorder import Recorder
from fem_lie.system.equations import Equations, Instant

LARGEST = 1e-3
"""Residual of the cones with which a step has failed."""

VIOLATED = 1e-8
"""Violation of joints after contacts, over the length of the model or in rad, with which it has."""


class CoupledRun(Run):
    """One integration."""

    STATE = attributes("_contacts.near", "_told", "_shown")

    def __init__(self, options: Options, equations: Equations, step: float) -> None:
        """Collect bodies, joints and contacts.

        Args:
            options: Of the scheme.
            equations: Of a scene with contacts by impacts; see :func:`check`.
            step: Step size.
        """
        super().__init__(options, equations, step)
        unknowns, kept = equations.unknowns, None
        if not unknowns.rigid or len(equations.tables.terms):
            kept = Kept(self._solve, self.r, self.dx, self.scale)
        self._contacts = CoupledContacts(equations.scene.impacts, equations, self.p, kept)
        self._told: Array = np.zeros((0, SIZE))
        self._shown: Array = np.zeros((0, WIDTH + 2))

    def history(
        self, plan: EqualSteps, progress: bool | None, store: Checkpoints | None
    ) -> Recorder:
        """See the base class."""
        self._told = np.zeros((plan.steps, SIZE))
        return super().history(plan, progress, store)

    @property
    def divides(self) -> bool:
        """Not here: contacts change the end of whole steps."""
        return False

    def _advance(self, history: Recorder) -> bool:
        s, contacts = self.s, self._contacts
        start = s.H.copy()
        contacts.begin(s.H, s.twist1, self.index * self.h)
        self._end = (self.index + 1) * self.h
        self._go_to_time(self._end)
        iterations = self._take_step()
        history.count += iterations
        if not iterations:
            return False
        self._turn()
        self.books.add(self.h, self._end, *self._accepted)
        told = self._told[self.index - 1]
        before = self._accepted._replace(H=s.H.copy(), v=s.twist1.copy())
        if contacts.settle(s, self.weights, self._end):
            lost = self.books.collide(self._end, before, self._accepted, contacts.work)
            contacts.told[IMPACT] = -lost
            contacts.told[IMPACT] -= contacts.told[FRICTION]
        told[:] = contacts.told
        if not told[RESIDUAL] <= LARGEST:
            self.reason = (
                f"{int(told[CONTACTS])} contacts did not settle (residual {told[RESIDUAL]:.0e}); "
                "are bodies wedged? Try smaller steps, or Penalty"
            )
            return False
        if contacts.overlap > 0.0:
            self.reason = (
                f"{int(told[CONTACTS])} contacts still overlap by {contacts.overlap:.2g} after all "
                "of them took part; are bodies wedged? Try smaller steps, or Penalty"
            )
            return False
        if not contacts.violation <= VIOLATED:
            self.reason = (
                f"{int(told[CONTACTS])} contacts violate joints by {contacts.violation:.2g} of the "
                "length of the model, or rad; are bodies wedged? Try smaller steps, or Penalty"
            )
            return False
        if (found := contacts.near.passed(start, s.H)) is not None:
            pair, way = found
            leader = self.equations.tables.leader
            own = self.equations.unknowns.bodies.items()
            who = contacts.near.names(pair, {body: leader[nodes] for body, nodes in own})
            self.reason = str(PassedThroughError(" and ".join(who), *way))
            return False
        return self._remembered(start)

    def _record(self, history: Recorder) -> bool:
        kept = super()._record(history)
        if kept and self.index:
            shown = self._contacts.shown(self.s.H, self.index * self.h)
            self._shown = np.concatenate([self._shown, shown])
        return kept

    @property
    def _recorded(self) -> Instant:
        """See the base class: joint forces have what contacts push through them."""
        weights = self.weights + self._contacts.reactions / self.h
        return self._accepted._replace(weights=weights)

    def _result(self, history: Recorder) -> Result:
        found = contact_steps(self._told, self.h, self._shown)
        history.add(found)
        return Result(**vars(super()._result(history)) | {"contacts": found})


def check(equations: Equations) -> None:
    """Refuse what contacts by impacts cannot be with.

    Raises:
        ValueError: Nodes are no frames, or held along fixed axes, or constraints are of velocities.
    """
    unknowns = equations.unknowns
    wanted = "Impact is for rigid bodies, beams and shells whose nodes are frames"
    if (unknowns.kinds >= SLOPE).any():
        raise ValueError(
            f"{wanted}, not for cables, nets, solids, thin shells and bodies in few shapes; give "
            "Penalty"
        )
    if equations.supports:
        raise ValueError(f"{wanted} and are not held along fixed axes (Shell.guide); give Penalty")
    if unknowns.of_velocities:
        raise ValueError(f"{wanted}, without joints that roll; give Penalty")
