"""Energy that contacts by penalty gain or lose in steps that do not resolve them.

Energy that contacts by penalty gain or lose in steps that do not resolve them.

A scheme that does not conserve energy moves bodies by forces at both ends of a step, or in its
middle. Over a step these do the work ``½ (F₀ + F₁)·Δu`` or ``F̄·Δu``, while the penalty stores
``U₁ − U₀``. Both agree, but for what damping takes, as long as the force is linear in the gap. It
is not in the steps in which surfaces meet and part: bodies get ``½ (F₀ + F₁)·Δu + U₁ − U₀``. That
is of the order of ``(h/T)²`` of the energy of an impact that lasts ``T = π √(m/k)``.

T is measured, whatever bodies are behind the surfaces: forces ``F = k δ n`` of a contact change the
displacements of two successive steps by ``h² M⁻¹ F``, so ``ω² = F·(Δu₂ − Δu₁)/(2 U h²)`` is
Rayleigh's quotient of the bodies on the stiffness of the contact, and ``T = π/ω``.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled, inlined_uncounted
from fem_lie.contact.sides.gauss_points import Meeting
from fem_lie.contact.sides.kinematics import gap, place
from fem_lie.contact.sides.table import GROUND
from fem_lie.lie.motions import global_components, local_components
from fem_lie.lie.tuples import Vector, dot, load_row, minus, plus


class Numbers(NamedTuple):
    """Of a law, for a weight of one.

    Attributes:
        k: Stiffness.
        c: Damping.
        ramp: Overlap over which that grows.
    """

    k: float
    c: float
    ramp: float


@inlined_uncounted
def damping(law: Numbers, g: float, speed: float) -> tuple[float, float, float]:
    """What damping adds to ``k g``, and how that changes with ``g`` and ``ġ``: nothing pulls."""
    part, by_gap = 1.0, 0.0
    if -g < law.ramp:
        part, by_gap = -g / law.ramp, -1.0 / law.ramp
    if law.k * g + part * law.c * speed >= 0.0:
        return -law.k * g, -law.k, 0.0
    return part * law.c * speed, by_gap * law.c * speed, part * law.c


LARGEST = 0.05
"""Part of the largest energy that a contact has stored, by which it may change that of bodies."""

_STEPS = 10
"""Steps in an impact that change its energy by less than 1 %."""


class UnresolvedContactWarning(UserWarning):
    """Steps are too large for a contact by penalty: it adds energy to bodies, or takes it."""


@inlined_uncounted
def _carried(start: Array, end: Array, at: Meeting, j: int, here: Array, X: Vector) -> Vector:
    """Displacement in a step of the point of a plane that is at ``X`` at frames ``here``."""
    node = at.b.nodes[j, 0]
    if node == GROUND:
        return 0.0, 0.0, 0.0
    c = local_components(here[node], minus(X, load_row(here[node], 0)))
    x1 = plus(load_row(end[node], 0), global_components(end[node], c))
    return minus(x1, plus(load_row(start[node], 0), global_components(start[node], c)))


@compiled
def _work(
    start: Array, end: Array, here: Array, at: Meeting, law: Numbers, h: float
) -> tuple[float, float]:
    """Work over a step of the forces at some frames of it, and the energy stored there.

    Args:
        start: Frames at the start of the step.
        end: At its end.
        here: Those at which the forces act.
        at: Where the sides meet there.
        law: Stiffness and damping.
        h: Size of the step.
    """
    work, stored = 0.0, 0.0
    for e in range(at.pairs.shape[0]):
        i, j = at.pairs[e]
        g, n, P = gap(here, at.a, at.b, i, j, at.flat)
        if g >= 0.0:
            continue
        u = minus(place(end, at.a, i), place(start, at.a, i))
        if at.flat:
            u = minus(u, _carried(start, end, at, j, here, P))
        else:
            u = minus(u, minus(place(end, at.b, j), place(start, at.b, j)))
        change = dot(n, u)
        work -= at.weight[e] * (law.k * g + damping(law, g, change / h)[0]) * change
        stored += 0.5 * at.weight[e] * law.k * g * g
    return work, stored


class _Record(NamedTuple):
    """What is known of a contact so far.

    Attributes:
        gained: Energy that bodies have got beyond what the contact had stored.
        stored: The largest energy that it has stored.
        frequency: ω at that.
        energy: Stored at the end of the last step; negative before the first one.
        pushed: Work over the last step of the forces at its end, over the step size; nan before
            the first one.
        reported: Whether it has been reported.
    """

    gained: float = 0.0
    stored: float = 0.0
    frequency: float = 0.0
    energy: float = -1.0
    pushed: float = np.nan
    reported: float = 0.0


class EnergyWatch:
    """The energy balance of one contact over a run."""

    def __init__(self, name: str, law: Numbers, meet: Callable[[Array], Meeting]) -> None:
        """Nothing is known yet.

        Args:
            name: Of the contact.
            law: Its law.
            meet: Where both sides meet at frames; the result stays when they are asked again.
        """
        self._name, self._law, self._meet = name, law, meet
        self._known = _Record()
        self._closed: Meeting | None = None

    @property
    def memory(self) -> Array:
        """What is known, for checkpoints."""
        return np.array(self._known)

    def restore(self, memory: Array) -> None:
        """Know again what :attr:`memory` was."""
        self._known, self._closed = _Record(*(float(x) for x in memory)), None

    def add(self, start: Array, end: Array, h: float, middle: Array | None) -> None:
        """Take a step into the balance, and warn if that does not close.

        Args:
            start: Frames at the start of the step.
            end: At its end.
            h: Its size.
            middle: Where forces act in the step; None: at both ends.
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
        if known.energy >= stored > 0.0 and by_start > known.pushed * h:
            square = (by_start / h - known.pushed) / (2.0 * known.energy * h)
            frequency = float(np.sqrt(square))
        self._known = _Record(
            gained, max(stored, energy, inside), frequency, energy, by_end / h, known.reported
        )
        self._closed = at if energy > 0.0 else None
        # what has not opened yet may still give back what it has taken
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
