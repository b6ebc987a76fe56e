"""Energy error of penalty contacts in steps that do not resolve the contact duration.

A scheme that does not conserve energy applies contact forces at both ends of a step, or at its
midpoint. Their work over a step is ``½ (F₀ + F₁)·Δu`` or ``F̄·Δu``, while the stored energy of the
penalty changes by ``U₁ − U₀``. As long as the force is linear in the gap the two agree, except for
damping. They do not agree in steps in which surfaces meet or separate: there the bodies gain
``½ (F₀ + F₁)·Δu + U₁ − U₀``, which is of the order of ``(h/T)²`` of the energy of an impact of
duration ``T = π √(m/k)``.

T is estimated during the run, for any bodies: contact forces ``F = k δ n`` change the displacements
of two successive steps by ``h² M⁻¹ F``, so ``ω² = F·(Δu₂ − Δu₁)/(2 U h²)`` is the Rayleigh quotient
of the bodies on the contact stiffness, and ``T = π/ω``.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled, inlined_uncounted
from fem_lie.contact.sides.kinematics import SLOTS, ContactPoint, contact_point, slot
from fem_lie.contact.sides.table import ContactPoints
from fem_lie.lie.motions import global_components
from fem_lie.lie.tuples import Vector, dot, load_row, minus, plus, scaled


class PenaltyConstants(NamedTuple):
    """Constants of a penalty, for an integration weight of one.

    Attributes:
        k: Stiffness.
        c: Damping.
        ramp: Overlap over which the damping grows from zero to ``c``.
    """

    k: float
    c: float
    ramp: float


@inlined_uncounted
def damping(law: PenaltyConstants, g: float, speed: float) -> tuple[float, float, float]:
    """Damping beyond ``k g`` and its derivatives in ``g`` and ``ġ``; the total is never tensile."""
    part, by_gap = 1.0, 0.0
    if -g < law.ramp:
        part, by_gap = -g / law.ramp, -1.0 / law.ramp
    if law.k * g + part * law.c * speed >= 0.0:
        return -law.k * g, -law.k, 0.0
    return part * law.c * speed, by_gap * law.c * speed, part * law.c


LARGEST = 0.05
"""Energy that a contact may add to bodies, over the largest energy that it has stored."""

_STEPS = 10
"""Steps per contact duration with which the energy error is below 1 %."""


class UnresolvedContactWarning(UserWarning):
    """Steps are too large for a penalty contact: the contact adds or removes energy."""


@inlined_uncounted
def _moved(
    start: Array, end: Array, here: Array, at: ContactPoints, e: int, point: ContactPoint
) -> Vector:
    """Relative displacement over a step of the material points of a contact at frames ``here``."""
    (i, j), u = at.pairs[e], (0.0, 0.0, 0.0)
    for s in range(SLOTS):
        node, sign, w, c = slot(here, at.a, at.b, i, j, at.kind, point, s)
        if node >= 0:
            u = plus(u, scaled(sign * w, minus(load_row(end[node], 0), load_row(start[node], 0))))
            turned = minus(global_components(end[node], c), global_components(start[node], c))
            u = plus(u, scaled(sign, turned))
    return u


@compiled
def _work(
    start: Array, end: Array, here: Array, at: ContactPoints, law: PenaltyConstants, h: float
) -> tuple[float, float]:
    """Work of contact forces over a step, and the energy stored, both for forces at ``here``.

    Args:
        start: Frames at the start of the step.
        end: Frames at the end of the step.
        here: Frames at which the forces are evaluated.
        at: Contact points at these frames.
        law: Stiffness and damping.
        h: Step size.
    """
    work, stored = 0.0, 0.0
    for e in range(at.pairs.shape[0]):
        i, j = at.pairs[e]
        point = contact_point(here, at.a, at.b, i, j, at.kind)
        g = point.gap
        if g >= 0.0:
            continue
        change = dot(point.normal, _moved(start, end, here, at, e, point))
        work -= at.weight[e] * (law.k * g + damping(law, g, change / h)[0]) * change
        stored += 0.5 * at.weight[e] * law.k * g * g
    return work, stored


class _Record(NamedTuple):
    """Energy balance of a contact so far.

    Attributes:
        gained: Energy that the bodies have gained beyond what the contact had stored.
        stored: Largest energy that the contact has stored.
        frequency: ω at that time.
        energy: Energy stored at the end of the last step; negative before the first one.
        power: Work over the last step of the forces at its end, divided by the step size; nan
            before the first step.
        reported: Whether the user has been warned.
    """

    gained: float = 0.0
    stored: float = 0.0
    frequency: float = 0.0
    energy: float = -1.0
    power: float = np.nan
    reported: float = 0.0


class EnergyWatch:
    """Energy balance of one contact over a run."""

    def __init__(
        self, name: str, law: PenaltyConstants, meet: Callable[[Array], ContactPoints]
    ) -> None:
        """Start an empty balance.

        Args:
            name: Name of the contact.
            law: Constants of the penalty.
            meet: Gives the contact points at frames. The result remains valid when it is called
                again.
        """
        self._name, self._law, self._meet = name, law, meet
        self._known = _Record()
        self._closed: ContactPoints | None = None

    @property
    def energy(self) -> float:
        """Energy that the contact stored at the end of the last step, J."""
        return self._known.energy

    @property
    def memory(self) -> Array:
        """State of the balance, for checkpoints."""
        return np.array(self._known)

    def restore(self, memory: Array) -> None:
        """Restore the state that :attr:`memory` returned."""
        self._known, self._closed = _Record(*(float(x) for x in memory)), None

    def add(self, start: Array, end: Array, h: float, middle: Array | None) -> None:
        """Add a step to the balance, and warn if the energy error is too large.

        Args:
            start: Frames at the start of the step.
            end: Frames at the end of the step.
            h: Step size.
            middle: Frames at which contact forces act in the step; ``None``: they act at both ends.
        """
        known, law = self._known, self._law
        if known.energy < 0.0:
            _, before = _work(start, end, start, self._meet(start), law, h)
            known = self._known = known._replace(energy=before, stored=before)
        at = self._meet(end)
        by_end, energy = _work(start, end, end, at, law, h)
        if energy == 0.0 and known.energy == 0.0 and middle is None:
            return
        by_start = inside = 0.0
        if known.energy > 0.0:
            here = self._closed or self._meet(start)
            by_start, _ = _work(start, end, start, here, law, h)
        work = 0.5 * (by_start + by_end)
        if middle is not None:
            work, inside = _work(start, end, middle, self._meet(middle), law, h)
        gained = known.gained + work + energy - known.energy
        stored, frequency = known.stored, known.frequency
        if known.energy >= stored > 0.0 and by_start > known.power * h:
            square = (by_start / h - known.power) / (2.0 * known.energy * h)
            frequency = float(np.sqrt(square))
        self._known = _Record(
            gained, max(stored, energy, inside), frequency, energy, by_end / h, known.reported
        )
        self._closed = at if energy > 0.0 else None
        # a contact that is still closed may still return the energy that it has stored
        if energy == 0.0:
            self._report(h)

    def _report(self, h: float) -> None:
        known = self._known
        part = known.gained / known.stored if known.stored > 0.0 else 0.0
        lost = part < -LARGEST and self._law.c == 0.0
        if known.reported or not (part > LARGEST or lost) or known.frequency == 0.0:
            return
        self._known = known._replace(reported=1.0)
        lasts, k = np.pi / known.frequency, self._law.k
        softer = k * (lasts / (_STEPS * h)) ** 2
        helps = f"Take steps of {lasts / _STEPS:.2g} or less"
        if softer < k:
            helps += f", a stiffness of {softer:.2g} or less"
        warnings.warn(
            f"{self._name}: steps of {h:.2g} do not resolve a contact that lasts {lasts:.2g}: it "
            f"has changed the energy of the bodies by {100.0 * part:+.0f} % of the most that it "
            f"stored. {helps}, or EnergyMomentum, which conserves energy",
            UnresolvedContactWarning,
            stacklevel=2,
        )
