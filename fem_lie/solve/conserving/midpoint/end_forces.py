"""Multipliers at ends of steps, and secant forces of terms over a step, such as contacts.

A multiplier λ of a conserving step is the force over that step: of second order at its midpoint,
except for a part that changes its sign from step to step. Velocities that satisfy the constraints
of each mean ``q̄`` violate those at the ends of steps by ``c h²`` once in two steps; the joint
reverses this difference in each step, with the force ``±2 c h``. So the force at the end of a step
is extrapolated linearly from three past values, such that an alternating part with an impulse of
constant size cancels::

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
from fem_lie.ranks.shared_nodes import SharedNodes
from fem_lie.solve.conserving.midpoint.cayley import set_attached_nodes


@compiled
def at_end(last: Array, earlier: Array, sizes: Array) -> Array:
    """Multipliers at the end of the last step, shape (m,).

    Args:
        last: Multipliers over the last step.
        earlier: Those over the two steps before, the later one first, (2, m).
        sizes: Sizes of these three steps, the last one first, (3,).
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

    Mean accelerations of a step are those at its midpoint. They are extrapolated linearly by half a
    step from the last two of them: second order.

    Args:
        rates: Means over the last step and the one before, or at its initial time, (2, n, 6).
        sizes: Sizes of these steps; zero for a single time.
        out: Accelerations, overwritten.
    """
    whole = sizes[0] + sizes[1]
    share = sizes[0] / whole if whole > 0.0 else 0.0
    for i in range(out.shape[0]):
        for k in range(6):
            out[i, k] = rates[0, i, k] + share * (rates[0, i, k] - rates[1, i, k])


ON_GROUND, LOSS = 0, 1
"""Rows of end forces after those of the nodes: on the ground, and dissipated energy (first
number)."""
BESIDE = 2
"""Number of these rows."""

_MOST = 0.5
"""Largest fraction by which forces may be changed to correct their work."""
_DIGITS = 1e-11
"""Fraction of the stored energy that is round-off, whose correction may be deferred."""
_ULPS = 16.0 * float(np.finfo(np.float64).eps)
"""Round-off of the gaps, over the distances from which they are computed: times the forces, it is
round-off of the stored energy, too. It is the larger one for small overlaps far from the origin."""
_LITTLE = 1e-2
"""Fraction of the stored energy: forces that do less work correct less of the earlier error."""


class EndForces(Stateful):
    """Forces on the master nodes of terms with secant forces, such as contacts.

    If the scene is divided, energies are those of the terms of this rank. All ranks correct the
    work together, and decide the same.

    Attributes:
        energy: Energy stored by active terms at the end of the last step.
        ahead: The same at the current end of the step.
        held: Energy stored by steady terms.
        act_always: Whether some terms act in all steps.
        debt: Excess of the stored energy over the work on these terms, on all ranks.
        ends: All nodes at both ends of the step.
    """

    STATE = attributes("energy", "debt", "held")

    def __init__(
        self,
        terms: Sequence[Term],
        master: Indices,
        offset: Array,
        moving: int,
        shared: SharedNodes,
    ) -> None:
        """Select the terms; all ranks together.

        Args:
            terms: All terms with forces.
            master: Master node of each node, (N,).
            offset: Frame of each node in the frame of its master, (N, 4, 3).
            moving: Number of master nodes that move.
            shared: All ranks.
        """
        self._shared = shared
        self._master, self._offset = master, offset
        self.energy = self.ahead = self.held = self.debt = 0.0
        forces = [(term, term.over_step) for term in terms]
        self._acting = [(term, of) for term, of in forces if of is not None and not of.steady]
        self._steady = [(term, of) for term, of in forces if of is not None and of.steady]
        # asked in each step
        self._any = shared.any(bool(self._acting or self._steady))
        self.act_always = shared.any(bool(self._steady))
        self._trivial, total = moving == len(master), len(master)
        self._held_ahead = 0.0
        self._on_all, self._ground = np.zeros((total, 6)), np.zeros(6)
        self.ends = Ends(*np.zeros((4, total, 4, 3)))

    def __bool__(self) -> bool:
        """Whether there are any such terms."""
        return self._any

    def overlap(self, H: Array) -> bool:
        """Whether any of them acts at frames ``H``."""
        every = [forces for _, forces in (*self._acting, *self._steady)]
        found = self._shared.any(any(forces.overlaps(H) for forces in every))
        if not found:
            for forces in every:
                forces.keep_gaps()
        return found

    def at_rest(self, H: Array) -> None:
        """Compute the stored energy at frames ``H``."""
        self.energy = sum(term.energy(H) for term, _ in self._acting)
        self.held = sum(term.energy(H) for term, _ in self._steady)

    def set(self, ends: Ends, leak: float, out: Array) -> None:
        """Forces over a step, into ``out``; along increments on nodes other than frames.

        Args:
            ends: Master nodes over the step, (≥ n, 4, 3) each.
            leak: Energy added by round-off, which these forces remove together with the debt.
            out: Forces and moments on the nodes and on the ground, and the dissipated energy, (n +
                2, 6).
        """
        for given, own in zip(ends, self.ends, strict=True):
            if self._trivial:
                own[:] = given[: len(own)]
            else:
                set_attached_nodes(given, self._master, self._offset, own)
        work = self._add_all(out)
        self._transfer_to_masters(ends.mean, out)
        self._correct_work(work, leak, out, ends.mean)
        self._add_steady(out, ends.mean)

    def _add_all(self, out: Array) -> float:
        """Forces of active terms on master nodes and ground; returns the work that is stored."""
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

    def _transfer_to_masters(self, mean: Array, out: Array) -> None:
        """Transfer forces to the master nodes, which have these means."""
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
        self._transfer_to_masters(mean, out)

    def _correct_work(self, work: float, leak: float, out: Array, mean: Array) -> None:
        """Correct the forces by the excess of the stored energy over their work."""
        ahead, energy, work = self._total(self.ahead, self.energy, work)
        # by the digits of positions, and of dependent positions
        missing = ahead - energy - work
        little = _LITTLE * (ahead + energy)
        earlier = self.debt + leak
        digits = _DIGITS * (ahead + energy)
        if abs(missing) <= digits or abs(missing) <= digits + self._gap_digits(out, mean):
            part = _part_of_earlier(earlier + missing, work, little)
        else:
            part = _part(missing, work) + _part_of_earlier(earlier, work, little)
        out *= 1.0 + part
        self._owed = self.debt + missing - part * work

    def _gap_digits(self, out: Array, mean: Array) -> float:
        """Round-off of the stored energy by that of the gaps, for forces on nodes at ``mean``."""
        n = len(out) - BESIDE
        reach = np.abs(mean[:n, 0]).max(axis=1, initial=0.0)
        own = float(reach @ np.abs(out[:n, :3]).sum(axis=1) + np.abs(out[:n, 3:]).sum())
        return _ULPS * self._total(own)[0]

    def _total(self, *values: float) -> list[float]:
        """Sums over all ranks."""
        return [float(each) for each in self._shared.total(np.array(values))]

    def accept(self) -> None:
        """Make the end of the step, with the last forces, the start of the next one."""
        self.energy, self.debt, self.held = self.ahead, self._owed, self._held_ahead


def _part(missing: float, work: float) -> float:
    """Relative change of forces for missing work: small if they do little work."""
    if work == 0.0 or missing == 0.0:
        return 0.0
    part = missing / work
    return part if abs(part) <= _MOST else _MOST**2 / part


def _part_of_earlier(missing: float, work: float, little: float) -> float:
    """The same for deferred corrections: it tends to zero with the work.

    Between resting surfaces the work changes its sign from one iteration to the next, and forces
    that jumped with it would have no equilibrium.
    """
    if abs(work) >= little:
        return _part(missing, work)
    return _part(missing, little) * work / little
