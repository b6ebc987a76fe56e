"""Impacts with Coulomb friction of rigid bodies in one step, after the smooth step.

The scheme is the decoupled nonsmooth generalised-α method of Brüls, Acary & Cardona, CMAME 281
(2014) 131, and Cosimo, Galvez, Cavalieri, Cardona & Brüls, Nonlinear Dyn. 102 (2020) 2453: the step
without contacts comes first. The differences are:

- An impact has a time ``τ h``, computed from the gaps at both ends and the velocity at the start.
  Restitution applies to the velocity at that time.
- Contacts that were closed act along the mean of their rows at both ends, and their impulses move
  bodies during half a step, as constant forces do. Impulses of impacts move bodies during the rest
  of the step. All contacts of a step share one such fraction, the mean weighted by impulses, so
  that forces in equilibrium remain in equilibrium.
- Restitution is reduced if the step would increase the energy.

Two passes make the rows those of the end. Bodies move on R³×SO(3): velocities are ``ẋ`` in global
axes and ``ω`` in the body's axes.
"""

from __future__ import annotations

from fem_lie._arrays import Array
from fem_lie._jit import uncounted
from fem_lie._jit.records import Record
from fem_lie.contact.cones import solver
from fem_lie.contact.cones.jacobian import along
from fem_lie.contact.cones.sweeps import MOST_NEWTON
from fem_lie.contact.impact.positions import PLACES, SWEEPS, aim, moved, resolve_positions
from fem_lie.contact.impact.records import (
    Masses,
    Touch,
    Work,
)
from fem_lie.contact.impact.rows import point_of
from fem_lie.contact.impact.touching import energy, note_ground, note_works
from fem_lie.contact.impact.velocities import choose, join, set_cones

_PASSES, _MOST, _GROWING, _GUARDS = 2, 40, 6, 6
"""Passes; most of them; passes in which contacts may become active; reductions of restitution."""

_ROUGH, _ROUGHER = 1e-4, 1e-3
"""Residual of the cones in the first pass, which only provides rows, with few and many contacts;
positions have a low accuracy there, too. With many contacts a second pass, to the first of these
residuals, separates bodies: otherwise contacts would become active after cones have been solved."""


@uncounted
def _copy_frames(H: Array, out: Array) -> None:
    for body in range(H.shape[0]):
        for i in range(4):
            for j in range(3):
                out[body, i, j] = H[body, i, j]


@uncounted
def _pass(
    h: float,
    touch: Touch,
    masses: Masses,
    H: Array,
    v: Array,
    w: Work,
    factor: float,
    tolerance: float,
    report: Record,
    limits: tuple[int, int, bool],
) -> bool:
    """One pass from the end without contacts to ``H``, ``v``; whether a contact became active."""
    k = set_cones(h, touch, masses, w, factor)
    sweeps, _, report.residual = solver.solve(w.cones, k, tolerance)
    report.contacts, report.sweeps = k, report.sweeps + sweeps
    for body in range(v.shape[0]):
        for j in range(6):
            v[body, j] = w.v[body, j] + w.cones.W[body, j]
    note_works(w, k, v, report)
    note_ground(masses, w, k, report)
    part = aim(h, touch, w, k, factor)
    moved(w.H[0], w.cones.W, part * h, H)
    return resolve_positions(touch, masses, H, w, limits)


@uncounted
def _kick(touch: Touch, w: Work) -> float:
    """Largest rebound velocity by restitution."""
    found = 0.0
    for at in range(w.many[0]):
        c = w.close[at]
        if w.joined[c]:
            found = max(found, -touch.restitution[c] * w.incoming[c])
    return found


@uncounted
def _fall(w: Work, k: int) -> float:
    """Largest change of a normal velocity in the smooth step."""
    found = 0.0
    for i in range(k):
        free = along(w.cones.rows, i, w.v, 0)
        found = max(found, abs(free - w.speed[w.chosen[i]]))
    return found


@uncounted
def resolve(
    h: float,
    touch: Touch,
    masses: Masses,
    start: tuple[Array, Array],
    H: Array,
    v: Array,
    w: Work,
    tolerance: float,
    report: Record,
) -> bool:
    """Apply impulses and position corrections at the end of a step; whether there were any.

    Args:
        h: Step size.
        touch: Pairs.
        masses: Masses of the bodies.
        start: Frames and velocities at the start of the step.
        H: Frames at the end without contacts, shape (n, 4, 3), updated.
        v: Velocities at the end without contacts, shape (n, 6), updated.
        w: Workspace; gaps and impulses are kept from step to step.
        tolerance: Tolerance of :func:`~fem_lie.contact.cones.sweeps.residual`.
        report: Of type :data:`~fem_lie.contact.impact.records.STEP_REPORT`, zero, overwritten.
    """
    overlaps, m = False, touch.pairs.shape[0]
    for c in range(m):
        w.smooth[c] = point_of(H, touch, c).gap
        w.joined[c] = w.smooth[c] <= 0.0
        overlaps = overlaps or w.joined[c]
    if not overlaps:
        w.impulses[:] = 0.0
        for c in range(m):
            w.gaps[c] = w.smooth[c]
        return False
    choose(h, touch, start, v, w)
    join(h, touch, start, w)
    _copy_frames(H, w.H[0])
    _copy_frames(H, w.H[1])
    for body in range(v.shape[0]):
        for j in range(6):
            w.v[body, j] = v[body, j]
    free, before = energy(masses, H, v), energy(masses, start[0], start[1])
    _guarded(h, touch, masses, before, H, v, w, tolerance, report)
    report.impact = energy(masses, H, v) - free - report.friction
    for c in range(m):
        w.gaps[c] = point_of(H, touch, c).gap
        report.penetration = max(report.penetration, -w.gaps[c])
    return True


@uncounted
def _guarded(
    h: float,
    touch: Touch,
    masses: Masses,
    before: float,
    H: Array,
    v: Array,
    w: Work,
    tolerance: float,
    report: Record,
) -> None:
    """Passes with the largest restitution that does not increase the energy beyond ``before``."""
    factor, least, most, below, above = 1.0, -1.0, 1.0, 0.0, 0.0
    passes, tries, last = 0, 0, False
    many = w.many[0] > MOST_NEWTON
    few, needed = (30, _PASSES + 1) if many else (3, _PASSES)
    for attempt in range(_MOST):
        grows = attempt < _GROWING
        rough = (
            passes == 0 if many else attempt == 0
        )  # the contacts of a pile become active one pass after the other
        limits = (1, few, grows) if rough else (PLACES, SWEEPS, grows)
        wanted = tolerance
        if rough:
            wanted = _ROUGHER if many else _ROUGH
        elif passes + 1 < needed:
            wanted = _ROUGH
        grew = _pass(h, touch, masses, H, v, w, factor, wanted, report, limits)
        _copy_frames(H, w.H[1])
        if grew:
            continue
        passes += 1
        if passes < needed:
            continue
        if last or _kick(touch, w) <= 1e-2 * _fall(w, int(report.contacts)):
            return
        excess = energy(masses, H, v) - before
        if excess <= 1e-10 * abs(report.impact + report.friction) + 1e-14 * abs(before):
            if tries == 0:
                return
            least, below = factor, excess
        else:
            most, above = factor, excess
        tries += 1
        if tries == 1:
            factor = 0.0
        elif least < 0.0:
            factor, last = 1.0, True  # the energy does not come from restitution
        elif tries >= _GUARDS or most - least < 1e-3 or -below < 1e-12 * abs(before):
            if factor == least:
                return
            factor, last = least, True
        else:
            by_secant = -below / (above - below)
            factor = least + (most - least) * min(0.95, max(0.05, by_secant))
