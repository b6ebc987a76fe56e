"""Forces over a step: of constraints at its ends, and of terms that Python is asked for.

A multiplier λ of a conserving step is the force over that step: of second order in its middle, but
for a part that changes its sign from step to step. Velocities that satisfy the constraints of each
mean ``q̄`` miss those at the ends of steps by ``c h²`` once in two steps; the joint takes that
difference back and forth, with the force ``±2 c h``. So the force at the end of a step, a straight
line through three of its past values and what alternates with an impulse of constant size, is::

    λ(t₁) = Σ wₖ λₖ,      Σ wₖ = 1,   Σ wₖ (t₁ − tₖ) = 0,   Σ wₖ (−1)ᵏ/hₖ = 0,

for constant steps ``λ₁ + ½ λ₂ − ½ λ₃``, the last one first.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie._state import Stateful, attributes
from fem_lie.forms.abilities import Ends
from fem_lie.forms.term import Term
from fem_lie.lie.tuples import cross, scaled
from fem_lie.solve.conserving.midpoint.cayley import follow


@compiled
def at_end(last: Array, earlier: Array, sizes: Array) -> Array:
    """Multipliers at the end of the last step, shape (m,).

    Args:
        last: Those over the last step.
        earlier: Those over the two before, the later one first, (2, m).
        sizes: Of these three steps, the last one first, (3,).
    """
    h1, h2, h3 = sizes[0], sizes[1], sizes[2]
    after = 0.5 * h1, h1 + 0.5 * h2, h1 + h2 + 0.5 * h3
    w = cross(after, (1.0 / h1, -1.0 / h2, 1.0 / h3))
    w = scaled(1.0 / (w[0] + w[1] + w[2]), w)
    out = np.empty_like(last)
    for c in range(last.shape[0]):
        out[c] = w[0] * last[c] + w[1] * earlier[0, c] + w[2] * earlier[1, c]
    return out


@compiled
def rates_at_end(rates: Array, sizes: Array, out: Array) -> None:
    """Accelerations of increments (n, 6) at the end of the last step.

    Mean accelerations of a step are those of its middle; the end is half a step further, along the
    line through the last two of them: of second order.

    Args:
        rates: Means over the last step and the one before, or at the instant where it began,
            (2, n, 6).
        sizes: Of these steps; nil at an instant.
        out: Overwritten.
    """
    whole = sizes[0] + sizes[1]
    share = sizes[0] / whole if whole > 0.0 else 0.0
    for i in range(out.shape[0]):
        for k in range(6):
            out[i, k] = rates[0, i, k] + share * (rates[0, i, k] - rates[1, i, k])


ON_GROUND, LOSS = 0, 1
"""Rows of pushes after those of the nodes: on ground, and what was lost, in its first number."""
BESIDE = 2
"""How many these are."""

_MOST = 0.5
"""Part by which forces may be changed to do the work that is wanted of them."""
_DIGITS = 1e-11
"""Part of what is stored that is round-off, which may wait likewise."""
_LITTLE = 1e-2
"""Part of what is stored: forces that do less work take back less of what earlier steps left."""


class EndForces(Stateful):
    """The forces of terms that have secants, such as contacts, on the nodes that lead.

    Attributes:
        energy: That terms which push have stored at the end of the last step.
        ahead: At the end of the step that is looked at.
        held: As energy, of steady terms.
        debt: By how much more was stored than the work on what pushes.
        ends: Of that step, of all nodes.
    """

    STATE = attributes("energy", "debt", "held")

    def __init__(self, terms: Sequence[Term], master: Indices, offset: Array, moving: int) -> None:
        """Choose the terms.

        Args:
            terms: All that add forces.
            master: Of each node, (N,).
            offset: Frame of each in that of its leader, (N, 4, 3).
            moving: Nodes that lead.
        """
        self._terms = [term for term in terms if term.over_step is not None]
        self._master, self._offset = master, offset
        self.energy = self.ahead = self.held = self.debt = 0.0
        forces = [(term, term.over_step) for term in self._terms]
        self._acting = [(term, of) for term, of in forces if of is not None and not of.steady]
        self._steady = [(term, of) for term, of in forces if of is not None and of.steady]
        self._trivial, total = moving == len(master), len(master)
        self._held_ahead = 0.0
        self._on_all, self._ground = np.zeros((total, 6)), np.zeros(6)
        self.ends = Ends(*np.zeros((4, total, 4, 3)))

    def __bool__(self) -> bool:
        """Whether there are any."""
        return bool(self._terms)

    @property
    def act_always(self) -> bool:
        """Whether some act in all steps."""
        return bool(self._steady)

    def overlap(self, H: Array) -> bool:
        """Whether anything pushes at frames ``H``."""
        return any(forces.overlaps(H) for _, forces in (*self._acting, *self._steady))

    def at_rest(self, H: Array) -> None:
        """Find the stored energy at frames ``H``."""
        self.energy = sum(term.energy(H) for term, _ in self._acting)
        self.held = sum(term.energy(H) for term, _ in self._steady)

    def set(self, ends: Ends, leak: float, out: Array) -> None:
        """Forces over a step, into ``out``; on nodes that are no frames along increments.

        Args:
            ends: Of the nodes that lead, (≥ n, 4, 3) each.
            leak: Energy that round-off has brought in, which they take back with the debt.
            out: Forces and moments on these, on ground, and the energy that is lost, (n + 2, 6).
        """
        for given, own in zip(ends, self.ends, strict=True):
            if self._trivial:
                own[:] = given[: len(own)]
            else:
                follow(given, self._master, self._offset, own)
        work = self._add_all(out)
        self._lead(ends.mean, out)
        self._settle_debt(work, leak, out)
        self._add_steady(out, ends.mean)

    def _add_all(self, out: Array) -> float:
        """Forces of what pushes on leaders and on ground; the work that is kept."""
        n = len(out) - BESIDE
        self._on_all[:] = self._ground[:] = out[:] = 0.0
        work, self.ahead = 0.0, 0.0
        for _, forces in self._acting:
            done = forces.add_over_step(self.ends, self._on_all, self._ground)
            self.ahead += done.stored
            work += done.work
            out[n + LOSS, 0] += done.lost
        out[n + ON_GROUND] = self._ground
        return work - float(out[n + LOSS, 0])

    def _lead(self, mean: Array, out: Array) -> None:
        """Add what was found to leaders, which have these means."""
        if self._trivial:
            out[: len(self._on_all)] += self._on_all
        else:
            np.add.at(out, self._master, self._on_all)
            arms = self.ends.mean[:, 0] - mean[self._master, 0]
            np.add.at(out[:, 3:], self._master, np.cross(arms, self._on_all[:, :3]))

    def _add_steady(self, out: Array, mean: Array) -> None:
        """Add forces of steady terms."""
        if not self._steady:
            return
        n, self._held_ahead = len(out) - BESIDE, 0.0
        self._on_all[:] = self._ground[:] = 0.0
        for _, forces in self._steady:
            done = forces.add_over_step(self.ends, self._on_all, self._ground)
            self._held_ahead += done.stored
            out[n + LOSS, 0] += done.lost
        out[n + ON_GROUND] += self._ground
        self._lead(mean, out)

    def _settle_debt(self, work: float, leak: float, out: Array) -> None:
        """Change forces by what is stored beyond the work on it."""
        # by digits of places, and where places follow
        missing = self.ahead - self.energy - work
        little = _LITTLE * (self.ahead + self.energy)
        earlier = self.debt + leak
        if abs(missing) <= _DIGITS * (self.ahead + self.energy):
            part = _part_of_earlier(earlier + missing, work, little)
        else:
            part = _part(missing, work) + _part_of_earlier(earlier, work, little)
        out *= 1.0 + part
        self._owed = self.debt + missing - part * work

    def accept(self) -> None:
        """Make the end of the step with the last forces the start of the next one."""
        self.energy, self.debt, self.held = self.ahead, self._owed, self._held_ahead


def _part(missing: float, work: float) -> float:
    """By which forces are changed for missing work: little where they do none."""
    if work == 0.0 or missing == 0.0:
        return 0.0
    part = missing / work
    return part if abs(part) <= _MOST else _MOST**2 / part


def _part_of_earlier(missing: float, work: float, little: float) -> float:
    """The same of what may wait: goes to zero with the work.

    Between surfaces that rest on each other work is of either sign from one iteration to the next,
    and forces that jumped with it would have no equilibrium.
    """
    if abs(work) >= little:
        return _part(missing, work)
    return _part(missing, little) * work / little
