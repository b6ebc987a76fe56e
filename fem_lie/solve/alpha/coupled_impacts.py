"""Generalised-α for bodies of whatever sort that touch by impacts: in joints, and flexible ones.

Each step is made as without contacts, and these change its end
(:mod:`fem_lie.solve.alpha.ends.coupled_contacts`).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fem_lie._arrays import Array
from fem_lie.contact.impact.records import CONTACTS, FRICTION, IMPACT, RESIDUAL
from fem_lie.contact.impact.records import TOLD as SIZE
from fem_lie.contact.impact.shown import WIDTH
from fem_lie.contact.laws import Impact
from fem_lie.forms.term import PassedThroughError
from fem_lie.lie.kinds.kind import SLOPE
from fem_lie.results import Result
from fem_lie.scene import Scene
from fem_lie.solve.alpha.ends.coupled_contacts import CoupledContacts, Kept
from fem_lie.solve.alpha.impacts import contact_steps
from fem_lie.solve.alpha.options import Options
from fem_lie.solve.alpha.run import Run
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.fingerprint import Fingerprint
from fem_lie.solve.recording.recorder import Recorder
from fem_lie.solve.recording.saving import Saving
from fem_lie.system.equations import Equations, Instant

LARGEST = 1e-3
"""Residual of the cones with which a step has failed."""

VIOLATED = 1e-8
"""Violation of joints after contacts, over the length of the model or in rad, with which it has."""


def applies(scene: Scene) -> bool:
    """Whether there are contacts by impacts."""
    return any(isinstance(contact.law, Impact) for contact in scene.contacts)


class CoupledRun(Run):
    """One integration."""

    def __init__(self, options: Options, scene: Scene, step: float) -> None:
        """Collect bodies, joints and contacts.

        Args:
            options: Of the scheme.
            scene: One that :func:`applies`.
            step: Step size.

        Raises:
            ValueError: Something in it is not for impacts.
        """
        equations = equations_of(options, scene)
        super().__init__(options, equations, step)
        unknowns, kept = equations.unknowns, None
        if not unknowns.rigid or len(equations.tables.terms):
            kept = Kept(self._solve, self.r, self.dx, self.scale)
        by_impacts = [each for each in scene.contacts if isinstance(each.law, Impact)]
        self._contacts = CoupledContacts(by_impacts, equations, self.p, kept)
        self._told: Array = np.zeros((0, SIZE))
        self._shown: Array = np.zeros((0, WIDTH + 2))

    def whole(
        self, steps: int, saving: Saving, progress: bool | None, store: Checkpoints | None = None
    ) -> Result:
        """All steps, or those after a checkpoint."""
        self._told = np.zeros((steps, SIZE))
        history = self.history(steps, saving, progress, store)
        if store is not None and store.memory:
            self.restore(store.memory)
        result = self.integrate(history)
        if store is not None and result.contacts is not None:
            store.add_contacts(result.contacts)
        return result

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
        return Result(**vars(super()._result(history)) | {"contacts": found})

    def memory(self) -> dict[str, Array]:
        """See the base class."""
        own = {f"contacts.{k}": x for k, x in self._contacts.memory().items()}
        return super().memory() | own | {"contacts.told": self._told, "contacts.shown": self._shown}

    def restore(self, kept: Mapping[str, Array]) -> None:
        """See the base class."""
        super().restore(kept)
        near = {k.partition(".")[2]: x for k, x in kept.items() if k.startswith("contacts.")}
        self._contacts.restore(near)
        self._told[:], self._shown = near["told"], near["shown"]


class CoupledAlone:
    """Runs whose results go to files.

    Attributes:
        fingerprint: Of the scene and its contacts.
    """

    def __init__(self, options: Options, scene: Scene) -> None:
        """Of a scene that :func:`applies`."""
        self._options, self._scene = options, scene
        equations = equations_of(options, scene)
        nodes = equations.unknowns.bodies.__getitem__
        also = [
            (each.contents(nodes), each.label)
            for each in scene.contacts
            if isinstance(each.law, Impact)
        ]
        self.fingerprint = Fingerprint(equations, options, also)

    def integrate(self, store: Checkpoints, progress: bool | None) -> Result:
        """All steps that a file and its checkpoint leave to be made."""
        steps, step, saving = store.plan
        return CoupledRun(self._options, self._scene, step).whole(steps, saving, progress, store)


def equations_of(options: Options, scene: Scene) -> Equations:
    """Those of a scene without contacts by impacts.

    Raises:
        ValueError: Nodes are no frames, or held along fixed axes, or constraints are of velocities.
    """
    equations = Equations(
        scene.without_impacts(), dynamics=True, parametrisation=options.parametrisation
    )
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
    return equations
