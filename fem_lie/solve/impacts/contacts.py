"""Impacts and friction of jointed and flexible bodies, applied after the smooth step.

As :mod:`fem_lie.contact.impact.resolve`, but contacts are coupled by joints and elements, so that
there is one dense matrix for all of them. The differences:

- positions come first. Forces ``r`` of a step, with Coulomb's law for the sliding *in the step*,
  move the nodes by ``Z r``, ``Z = S⁻¹ B̄ᵀ`` with the frozen factors of the iteration matrix, which
  contains the constraint block: it includes the response of stiff elements, so that contacts do not
  displace single nodes. Scenes without elements use ``S = m M``. Joints are closed by the same
  factors in the same iteration;
- velocities follow the scheme, ``v + γ/(βh) Z r``, if there are elements, and then change by
  impulses with mass and joints (:mod:`.impulses`), whose cones are for the sum of both. Errors of
  order h² that index 3 leaves in constraint rates are unchanged;
- accelerations and multipliers change as much as those that satisfy the equations of motion without
  contacts.

Restitution is by Newton's law at the times of impacts, and is reduced where a step would gain
energy (:mod:`.bounds`); forces of closed contacts are along the mean of their rows at both ends.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._state import Stateful, attributes
from fem_lie.contact.cones.jacobian import BlockRows
from fem_lie.contact.cones.sweeps import MOST_NEWTON
from fem_lie.contact.contact import Contact
from fem_lie.contact.impact.records import (
    LARGEST,
    STEP_REPORT,
)
from fem_lie.contact.impact.rows import choose_axes, set_ahead
from fem_lie.forms.abilities import PassedThroughError
from fem_lie.solve.impacts.bounds import Chosen, allowed_part, bounds_of
from fem_lie.solve.impacts.delassus import Delassus
from fem_lie.solve.impacts.end_state import MOST_ITERATIONS, Aims, CoupledVelocities, Moved
from fem_lie.solve.impacts.step_end import Changed, ContactHistory, Factors, Last, Rule, StepEnd
from fem_lie.system.equations import Equations, TimeState

_NOTHING = Last.nothing()
"""Record of a step without contacts."""

_FEW = 2
"""Number of iterations in the first of two passes over many contacts, after which velocities after
impacts are known for the second."""

_FELT = 1e-2
"""Velocity by restitution, over the change of velocity without contacts, from which the energy is
checked."""

_GAIN = 1e-10
"""Energy gain, over the energy exchanged by contacts, that counts as none."""

_VIOLATED = 1e-8
"""Joint violation after contacts, over the length of the model or in rad, above which the step
fails."""


class _Solved(NamedTuple):
    """End of a step with contacts.

    Attributes:
        chosen: Active contacts.
        H: Frames of all rows.
        rows: Contact Jacobian there.
        v: Twists of the nodes, shape (n, 6).
        impulses: Contact impulses, shape (k, 3).
        gaps: Gaps of all pairs, shape (m,).
    """

    chosen: Chosen
    H: Array
    rows: BlockRows
    v: Array
    impulses: Array
    gaps: Array


class CoupledContacts(CoupledVelocities, Stateful):
    """All contacts by impacts of a run.

    Attributes:
        statistics: Contact statistics of the last step, see
            :data:`~fem_lie.contact.impact.records.STEP_REPORT`.
        history: Contact statistics of all steps of the run.
        reactions: Joint impulses including those of contacts, over the step, shape (m,).
        work: Work of drives and prescribed motions by these impulses.
        overlap: Overlap of bodies at the end of the last step, beyond that of closed contacts; 0:
            none.
        violation: Joint violation at the end of the last step, over the length of the model or in
            rad, if contacts have moved bodies.
    """

    STATE = attributes("near", "history")

    def __init__(
        self, contacts: Sequence[Contact], equations: Equations, rule: Rule, kept: Factors | None
    ) -> None:
        """Set up the contacts of a scene, without history."""
        super().__init__(contacts, equations, rule, kept)
        self.history, self._energy = ContactHistory(), equations.energy_balance()
        self._forget()

    def _forget(self) -> None:
        """Record that no contact is active."""
        self.statistics = STEP_REPORT()
        self.reactions[:], self.work = 0.0, 0.0
        self.overlap = self.violation = 0.0
        self._last = _NOTHING

    def begin(self, H: Array, v: Array, time: float) -> None:
        """Begin a step from these frames and twists."""
        super().begin(H, v, time)
        self._forget()

    def abandon(self) -> None:
        """Discard a step that is not accepted; its impulses are no initial guess."""
        self.near.work.impulses[:] = 0.0

    # --- active contacts ---

    def _choose(self, smooth: Array, joined: Flags, part: float) -> Chosen:
        """Pairs that overlap at the end, that were closed and do not open, or that were added.

        Args:
            smooth: Gaps at the end without contacts, shape (m,).
            joined: Pairs that were added, shape (m,).
            part: Fraction of the restitution.
        """
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
            Delassus(rows, self._islands, self._kinds, self._free),
            speed[keep],
            before[pairs],
            smooth[pairs],
            touch.friction[pairs],
            part * touch.restitution[pairs],
        )

    def resolve(self, step: StepEnd) -> Changed | None:
        """End of a step changed by contacts; ``None`` if none is active.

        Args:
            step: End of the step without contacts.
        """
        time = step.time
        work = self.near.work
        ends = self._H0, step.frames
        if self.near.has_manifolds:
            set_ahead(self.near.touch, self.near.polyhedra, *ends, work.gaps, work.impulses)
        smooth = self._gaps(step.frames)
        if not (smooth <= 0.0).any():
            self.near.work.impulses[:] = 0.0
            return None
        if self._kept is not None and self._impulses.stale(step.frames):
            self._kept.renew()  # axes have turned since, and the mass in it with them
        V = self._all_rows(step.twists, time)
        old = self._accelerations(step.frames, V, time)
        solve = partial(self._solve_end, step, V, smooth)
        found = solve(1.0)
        given, fallen = self._law
        if found.chosen.restitution.any() and given.max() > _FELT * np.abs(fallen).max():
            found = self._without_gain(step, solve, found)
        self.violation = self._largest_violation(found.H)
        V1 = self._all_rows(found.v, time)
        new = self._accelerations(found.H, V1, time)
        speeds = self._rates_of(found.rows, found.H, V1)
        self._record_state(found.chosen, found.gaps, found.impulses, speeds)
        return Changed(found.H, found.v, (old[0], new[0]), new[1] - old[1])

    def _solve_end(self, step: StepEnd, V: Array, smooth: Array, part: float) -> _Solved:
        """End of the step with a fraction of the restitution.

        Args:
            step: End of the step without contacts.
            V: Twists of all rows there, shape (rows, 6).
            smooth: Gaps there, shape (m,).
            part: Fraction of the restitution.
        """
        end, time = step.frames, step.time
        guess = np.asarray(self.near.work.impulses[: len(smooth)] / self._h, dtype=np.float64)
        closed = self.near.touch.closed
        defect, joined = self._rates(end, V, time), np.zeros(len(smooth), dtype=np.bool_)
        pressed = (guess[:, 0] > 0.0) & (self._gaps(self._H0) <= closed)
        # contacts of a pile become active one after the other: one iteration finds them
        piled = int(pressed.sum()) > MOST_NEWTON
        if piled:
            joined |= pressed
        self.statistics.sweeps = 0.0
        # overlapping inactive pairs are added; this terminates, because the number of pairs is
        # finite
        while True:
            chosen = self._choose(smooth, joined, part)
            if piled:
                moved = self._first_parted(chosen, end, V, guess[chosen.pairs])
            else:
                moved, v, impulses = self._passes(chosen, end, V, defect, guess[chosen.pairs], time)
            gaps, guess[chosen.pairs] = self._gaps(moved.H), moved.r
            deep = gaps < -closed
            self.overlap = -float(gaps[deep].min(initial=0.0))
            deep[chosen.pairs] = False
            joined |= deep
            if not (piled or deep.any()):
                return _Solved(chosen, moved.H, moved.rows, v, impulses, gaps)
            piled &= bool(deep.any())

    def _without_gain(
        self, step: StepEnd, solve: Callable[[float], _Solved], whole: _Solved
    ) -> _Solved:
        """End of the step with as much of the restitution as adds no energy."""
        none = self._still, np.zeros(self._m)
        before = TimeState(step.frames, step.twists, *none)

        def gained(end: _Solved) -> float:
            after = TimeState(end.H, end.v, *none)
            return -self._energy.collide(step.time, before, after, self.work)

        most, allowed = gained(whole), _GAIN * self.exchanged
        if most <= allowed:
            return whole
        return solve(allowed_part(lambda part: gained(solve(part)), most, allowed))

    @property
    def failure(self) -> str:
        """Why the end of the last step cannot be accepted; empty if it can."""
        residual, many = (
            float(self.statistics.residual),
            f"{int(self.statistics.contacts)} contacts",
        )
        advice = "are bodies wedged? Try smaller steps, or Penalty"
        if not residual <= LARGEST:
            return f"{many} did not converge (residual {residual:.0e}); {advice}"
        if self.overlap > 0.0:
            return f"{many} still overlap by {self.overlap:.2g} after all became active; {advice}"
        if not self.violation <= _VIOLATED:
            return (
                f"{many} violate joints by {self.violation:.2g} of the length of the model, or "
                f"rad; {advice}"
            )
        return ""

    def passed(self, frames: Array) -> str:
        """Bodies that passed through each other in the step that ends at ``frames``.

        Empty: none.
        """
        if (found := self.near.passed(self._H0, frames)) is None:
            return ""
        pair, way = found
        master, own = self._equations.arrays.master, self._equations.unknowns.bodies.items()
        who = self.near.names(pair, {body: master[nodes] for body, nodes in own})
        return str(PassedThroughError(" and ".join(who), *way))

    def _first_parted(self, chosen: Chosen, end: Array, V: Array, r: Array) -> Moved:
        """Positions after one iteration, which tell which contacts become active."""
        rows = self._rows_of(end, chosen.pairs, chosen.axis)
        moved = self.part(chosen, end, self._aims(chosen, rows, end, V, None), r, 1)
        self.statistics.sweeps += moved.sweeps
        return moved

    def _aims(
        self, chosen: Chosen, rows: BlockRows, end: Array, V: Array, normal: Array | None
    ) -> Aims:
        """Targets of positions, for a normal velocity after impacts; ``None``: the least one."""
        free, h = self._rates_of(rows, end, V), self._h
        bounds = bounds_of(h, chosen, free[:, 0])
        least = bounds.gaps(h, bounds.velocity if normal is None else normal, chosen)
        return Aims(least, bounds.rest[:, np.newaxis] * h * free[:, 1:])

    def _passes(
        self, chosen: Chosen, end: Array, V: Array, defect: Array, r: Array, time: float
    ) -> tuple[Moved, Array, Array]:
        """Positions, twists of the nodes, and contact impulses at the end of a step.

        Args:
            chosen: Active contacts.
            end: Frames of all nodes, ground and prescribed motions without contacts.
            V: Twists of all rows there, shape (rows, 6).
            defect: Errors of the constraint rates there, shape (m,).
            r: Initial guess of forces, shape (k, 3).
            time: Time at the end.
        """
        rows, normal, impulses = self._rows_of(end, chosen.pairs, chosen.axis), None, self._h * r
        rough = _FEW if len(chosen.pairs) > MOST_NEWTON else MOST_ITERATIONS
        for most in (MOST_ITERATIONS,) if chosen.closed.all() else (rough, MOST_ITERATIONS):
            moved = self.part(chosen, end, self._aims(chosen, rows, end, V, normal), r, most)
            self.statistics.sweeps += moved.sweeps
            self.statistics.residual = moved.residual
            rows, r = moved.rows, moved.r
            v, impulses = self._throw(chosen, moved, end, V, defect, impulses, time)
            normal = self._rates_of(rows, moved.H, self._all_rows(v, time))[:, 0]
        return moved, v, impulses

    # --- the end of the step ---

    def _record_state(self, chosen: Chosen, gaps: Array, impulses: Array, speeds: Array) -> None:
        self.statistics.contacts = len(chosen.pairs)
        self.statistics.penetration = max(0.0, float(-gaps.min()))
        self.near.work.impulses[:] = 0.0
        self.near.work.impulses[chosen.pairs] = impulses
        slips = speeds[:, 1:]
        slow = self.near.touch.closed[chosen.pairs] / self._h
        sticks = np.linalg.norm(slips, axis=1) <= slow
        at = gaps[chosen.pairs]
        self._last = Last(chosen.pairs, chosen.axis, at, impulses, slips, sticks)

    def record(self, H: Array, time: float) -> None:
        """Record the data of each contact in the last step for results.

        Args:
            H: Frames of all rows.
            time: Time at its end.
        """
        self.history.append(self._last.shown(self.near, H, time))
