"""Impacts and friction of bodies in joints, and of flexible ones: what comes after the smooth step.

As :mod:`fem_lie.contact.impact.settle`, but contacts see each other through joints and elements, so
that there is one dense matrix for all of them. What differs:

- positions come first. Forces ``r`` of a step, with Coulomb's law for what slides *in the step*,
  move the nodes by ``Z r``, ``Z = S⁻¹ B̄ᵀ`` with the kept factors of the iteration matrix, whose
  border are the joints: what stiff elements do is in it, so that no single node is pushed. Scenes
  without elements take ``S = m M``. Joints are closed by the same factors in the same iteration;
- velocities follow ``v + γ/(βh) Z r`` as in the scheme where there are elements, and then get
  impulses by mass and joints (:mod:`.impulses`), whose cones are for the sum of both. Errors of
  order h² that index 3 leaves in rates of the constraints stay as they were;
- accelerations and multipliers change by as much as those that satisfy the equations of motion
  without contacts.

Restitution is by Newton's law at the times of impacts; forces of closed contacts are along the mean
of their rows at both ends.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._state import Stateful, attributes
from fem_lie.contact.contact import Contact
from fem_lie.contact.impact import cones
from fem_lie.contact.impact.records import (
    CONTACTS,
    FRICTION,
    LARGEST,
    PENETRATION,
    RESIDUAL,
    SWEEPS,
)
from fem_lie.contact.impact.records import TOLD as SIZE
from fem_lie.contact.impact.rows import choose_axes
from fem_lie.contact.impact.sweeps import products
from fem_lie.forms.abilities import PassedThroughError
from fem_lie.lie.kinds import all_from_local, all_to_group
from fem_lie.solve.impacts.bodies import to_twists
from fem_lie.solve.impacts.bounds import Chosen, bounds_of
from fem_lie.solve.impacts.delassus import Delassus
from fem_lie.solve.impacts.history import ContactHistory
from fem_lie.solve.impacts.last_contacts import Last
from fem_lie.solve.impacts.positions import TOLERANCE, Aims, CoupledPlaces, Moved
from fem_lie.solve.impacts.step_end import Changed, Factors, Rule, StepEnd
from fem_lie.system.equations import Equations

_PASSES = 2
"""Passes, in the second of which velocities after impacts are known."""

_TINY = 1e-6
"""Part of speeds below which they are known to round-off alone."""

_VIOLATED = 1e-8
"""Violation of joints after contacts, over the length of the model or in rad, with which it has."""


class CoupledContacts(CoupledPlaces, Stateful):
    """All contacts by impacts of a run.

    Attributes:
        told: What they did in the last step, see :data:`~fem_lie.contact.impact.records.TOLD`.
        history: What they did in all steps of the run.
        reactions: Impulses of the joints with those of contacts, over the step, shape (m,).
        work: Of drives and prescribed motions by these impulses.
        overlap: By which bodies still overlap at the end of the last step, beyond what counts as
            closed; 0: they do not.
        violation: Of joints at the end of the last step, over the length of the model or in rad,
            if contacts have moved bodies.
    """

    STATE = attributes("near", "history")

    def __init__(
        self, contacts: Sequence[Contact], equations: Equations, rule: Rule, kept: Factors | None
    ) -> None:
        """As the base class."""
        super().__init__(contacts, equations, rule, kept)
        self.told, self.reactions, self.work = np.zeros(SIZE), np.zeros(self._m), 0.0
        self.history = ContactHistory()
        self._forget()

    def _forget(self) -> None:
        """No contact has taken part."""
        self.told[:], self.reactions[:], self.work = 0.0, 0.0, 0.0
        self.overlap = self.violation = 0.0
        self._last = Last.nothing()

    def begin(self, H: Array, v: Array, time: float) -> None:
        """See the base class."""
        super().begin(H, v, time)
        self._forget()

    def abandon(self) -> None:
        """Leave a step that is not accepted; its impulses are no start for another one."""
        self.near.work.impulses[:] = 0.0

    # --- which contacts take part ---

    def _choose(self, smooth: Array, joined: Flags) -> Chosen:
        """Those that overlap at the end, were closed and do not open, or have joined."""
        touch, before = self.near.touch, self._gaps(self._H0)
        closed = before <= touch.closed
        pairs = np.flatnonzero((smooth <= 0.0) | closed | joined)
        axis: Indices = np.zeros(len(pairs), dtype=np.int64)
        choose_axes(self._H0, touch, pairs, axis)
        rows = self._rows_of(self._H0, pairs, axis)
        speed = self._rates_of(rows, self._H0, self._V0)[:, 0]
        slow = speed <= touch.closed[pairs] / self._h
        keep = (smooth[pairs] <= 0.0) | joined[pairs] | slow
        pairs, axis = pairs[keep], axis[keep]
        rows = self._rows_of(self._H0, pairs, axis)
        return Chosen(
            pairs,
            axis,
            closed[pairs],
            rows,
            Delassus(rows, self._islands, self._free),
            speed[keep],
            before[pairs],
            smooth[pairs],
            touch.friction[pairs],
            touch.restitution[pairs],
        )

    def settle(self, step: StepEnd) -> Changed | None:
        """What contacts make of the end of a step; ``None`` if there are none.

        Args:
            step: Its end, made without contacts.
        """
        time = step.time
        smooth = self._gaps(step.frames)
        if not (smooth <= 0.0).any():
            self.near.work.impulses[:] = 0.0
            return None
        end, V = step.frames, self._all_rows(step.twists, time)
        defect = self._rates(end, V, time)
        old = self._accelerations(end, V, time)
        joined = np.zeros(len(smooth), dtype=np.bool_)
        # those that overlap without taking part join; this ends, for there are so many pairs
        while True:
            chosen = self._choose(smooth, joined)
            moved, v, impulses = self._passes(chosen, end, V, defect, time)
            gaps = self._gaps(moved.H)
            deep = gaps < -self.near.touch.closed
            self.overlap = -float(gaps[deep].min(initial=0.0))
            deep[chosen.pairs] = False
            if not deep.any():
                break
            joined |= deep
        self.violation = self._largest_violation(moved.H)
        V1 = self._all_rows(v, time)
        new = self._accelerations(moved.H, V1, time)
        speeds = self._rates_of(moved.rows, moved.H, V1)
        self._tell(chosen, gaps, impulses, speeds)
        return Changed(moved.H, v, (old[0], new[0]), new[1] - old[1])

    @property
    def failure(self) -> str:
        """Why the end of the last step cannot be accepted; empty if it can."""
        residual, many = float(self.told[RESIDUAL]), f"{int(self.told[CONTACTS])} contacts"
        advice = "are bodies wedged? Try smaller steps, or Penalty"
        if not residual <= LARGEST:
            return f"{many} did not settle (residual {residual:.0e}); {advice}"
        if self.overlap > 0.0:
            return (
                f"{many} still overlap by {self.overlap:.2g} after all of them took part; {advice}"
            )
        if not self.violation <= _VIOLATED:
            return (
                f"{many} violate joints by {self.violation:.2g} of the length of the model, or "
                f"rad; {advice}"
            )
        return ""

    def passed(self, frames: Array) -> str:
        """Which bodies went through each other in the step that ends at ``frames``; empty: none."""
        if (found := self.near.passed(self._H0, frames)) is None:
            return ""
        pair, way = found
        leader, own = self._equations.tables.leader, self._equations.unknowns.bodies.items()
        who = self.near.names(pair, {body: leader[nodes] for body, nodes in own})
        return str(PassedThroughError(" and ".join(who), *way))

    def _passes(
        self, chosen: Chosen, end: Array, V: Array, defect: Array, time: float
    ) -> tuple[Moved, Array, Array]:
        """Places, twists of the nodes, and impulses of contacts at the end of a step."""
        h = self._h
        r = np.asarray(self.near.work.impulses[chosen.pairs] / h, dtype=np.float64)
        rows, normal, impulses = self._rows_of(end, chosen.pairs, chosen.axis), None, h * r
        open_ = not chosen.closed.all()
        for _ in range(_PASSES if open_ else 1):
            free = self._rates_of(rows, end, V)
            bounds = bounds_of(h, chosen, free[:, 0], 1.0)
            least = bounds.gaps(h, bounds.velocity if normal is None else normal, chosen)
            slid = bounds.rest[:, np.newaxis] * h * free[:, 1:]
            moved = self.part(chosen, end, Aims(least, slid), r)
            self.told[SWEEPS] += moved.sweeps
            self.told[RESIDUAL] = moved.residual
            rows, r = moved.rows, moved.r
            v, impulses = self._throw(chosen, moved, end, V, defect, impulses, time)
            normal = self._rates_of(rows, moved.H, self._all_rows(v, time))[:, 0]
        return moved, v, impulses

    # --- velocities ---

    def _throw(
        self,
        chosen: Chosen,
        moved: Moved,
        end: Array,
        V: Array,
        defect: Array,
        impulses: Array,
        time: float,
    ) -> tuple[Array, Array]:
        """Twists of the nodes at the end, and impulses of contacts (k, 3)."""
        B, H, k = moved.rows, moved.H, len(chosen.pairs)
        kinds, zero = self._kinds, np.zeros(6 * self._n)
        before, rate = np.empty_like(self._still), np.empty_like(self._still)
        all_from_local(kinds, end, V[: self._n], self._still, before, rate)
        v = before.copy()
        given: Array = np.zeros((k, 3))
        u_given: Array = np.empty((k, 3))
        self.reactions[:] = 0.0
        if self._kept is not None:
            by = moved.d.reshape(-1, 6).copy()
            all_to_group(kinds, end, by)
            v += self._rule.damping * by
            given = self._rule.damping / self._rule.mass * moved.r
            self.reactions[:] = self._rule.damping / self._rule.mass * moved.carried
        smooth, twist = np.empty_like(v), np.empty_like(v)
        to_twists(kinds, H, before, smooth)
        to_twists(kinds, H, v, twist)
        self._impulses.go_to(H)
        off = defect - self._rates(H, self._all_rows(twist, time), time)
        x, first = self._impulses.solve(zero, off)
        responses = chosen.operator.solve(moved.forces, H, self._impulses.solve)
        free = self._rates_of(B, H, self._all_rows(smooth, time))[:, 0]
        bounds = bounds_of(self._h, chosen, free, 1.0)
        problem = chosen.operator.problem(B.values, responses, chosen.friction)
        twist += x.reshape(-1, 6)
        u = self._rates_of(B, H, self._all_rows(twist, time))
        products(problem, given, u_given)
        without = u - u_given
        problem.q[:] = without
        problem.q[:, 0] -= bounds.velocity
        gaps = self._gaps(H)[chosen.pairs]
        opens = (moved.r[:, 0] == 0.0) & (gaps > self.near.touch.closed[chosen.pairs])
        opens &= chosen.smooth > 0.0
        problem.q[opens, 0] = np.maximum(problem.q[opens, 0], 0.0) + 1e3 * np.abs(u).max()
        problem.r[:], problem.least[0] = impulses, _TINY * float(np.abs(V).max())
        memory = np.empty((k, 3)), np.empty((k, 3))
        sweeps, residual = cones.solve_exactly(problem, k, TOLERANCE, memory)
        self.told[SWEEPS] += sweeps
        self.told[RESIDUAL] = max(self.told[RESIDUAL], residual)
        P, change = problem.r, problem.r - given
        end_twist = twist + responses.moved(change).reshape(-1, 6)
        driven = 0.5 * (self._V0 + V)
        driven[: self._n + 1] = 0.0
        self.work = -float((P * self._rates_of(B, H, driven)).sum())
        self.reactions += first + responses.reactions(change)
        self.work -= float(self.reactions @ self._driven(time))
        mean = 0.5 * (without + self._rates_of(B, H, self._all_rows(end_twist, time)))
        # of what was closed by how far it slid, for that is nothing of what sticks
        slid = np.where(chosen.closed[:, np.newaxis], moved.slips / self._h, mean[:, 1:])
        self.told[FRICTION] = float((slid * P[:, 1:]).sum())
        return end_twist, P.copy()

    # --- the end of the step ---

    def _tell(self, chosen: Chosen, gaps: Array, impulses: Array, speeds: Array) -> None:
        self.told[CONTACTS] = len(chosen.pairs)
        self.told[PENETRATION] = max(0.0, float(-gaps.min()))
        self.near.work.impulses[:] = 0.0
        self.near.work.impulses[chosen.pairs] = impulses
        slips = speeds[:, 1:]
        slow = self.near.touch.closed[chosen.pairs] / self._h
        sticks = np.linalg.norm(slips, axis=1) <= slow
        at = gaps[chosen.pairs]
        self._last = Last(chosen.pairs, chosen.axis, at, impulses, slips, sticks)

    def record(self, H: Array, time: float) -> None:
        """Keep for results what each contact did in the last step.

        Args:
            H: Frames of all rows.
            time: Its end.
        """
        self.history.append(self._last.shown(self.near, H, time))
