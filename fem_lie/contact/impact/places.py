"""Places of bodies at the end of a step: moved by impulses, until nothing overlaps."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled, uncounted
from fem_lie.contact.impact.records import CLOSED, Masses, Touch, Work
from fem_lie.contact.impact.rows import axis_of, set_pushes, set_rows
from fem_lie.contact.impact.sweeps import along, push
from fem_lie.contact.sides.kinematics import gap
from fem_lie.lie.kinds import move
from fem_lie.lie.motions import Group

_GROUP = int(Group.R3xSO3)

_EXACT = 1e-13
"""Overlap that is left, as a part of a length, as in :data:`CLOSED`."""


@compiled
def moved(H: Array, by: Array, part: float, out: Array) -> None:
    """Frames moved by part of an increment (n, 6), from ``H`` to ``out``."""
    d, frame = np.empty(6), np.empty((4, 3))
    for body in range(by.shape[0]):
        still = True
        for k in range(6):
            d[k] = part * by[body, k]
            still = still and d[k] == 0.0
        if still:
            out[body] = H[body]
        else:
            move(_GROUP, H[body], d, frame)
            out[body] = frame


@uncounted
def aim(h: float, touch: Touch, w: Work, k: int, factor: float) -> float:
    """Set impulses, times and targets; returns for which part of the step impulses act."""
    problem, top, bottom = w.cones, 0.0, 0.0
    w.nu[:], w.target[:], w.impulses[:] = 0.0, 0.0, 0.0
    for i in range(k):
        c = w.chosen[i]
        for j in range(3):
            w.impulses[c, j] = problem.r[i, j]
        closed = w.gaps[c] <= touch.closed[c]
        if closed or w.smooth[c] <= 0.0:
            top += (0.5 if closed else 1.0 - w.part[c]) * problem.r[i, 0]
            bottom += problem.r[i, 0]
    part = 0.0 if bottom == 0.0 else top / bottom
    for i in range(k):
        c = w.chosen[i]
        w.nu[c] = part * h * problem.r[i, 0]
        after = along(problem.rows[i], problem.bodies[i], w.v, 0)
        after += along(problem.rows[i], problem.bodies[i], problem.W, 0)
        away = 0.5 * (after - factor * touch.restitution[c] * w.incoming[c])
        w.target[c] = max(0.0, away * (1.0 - w.part[c]) * h)
    return part


@uncounted
def _part_places(touch: Touch, masses: Masses, H: Array, w: Work, k: int, sweeps: int) -> None:
    """``0 ≤ ν ⊥ g − g* ≥ 0`` linearised, by sweeps; bodies are moved."""
    w.moved[:], bodies = 0.0, w.bodies
    for i in range(k):
        c = w.near[i]
        set_rows(H, touch, c, 0, bodies[i], w.rows[i])
        set_pushes(masses, bodies[i], w.rows[i], w.pushes[i])
    for _ in range(sweeps):
        worst = 0.0
        for i in range(k):
            c = w.near[i]
            own = 0.0
            for side in range(2):
                if bodies[i, side] >= 0:
                    for j in range(6):
                        own += w.rows[i, side, 0, j] * w.pushes[i, side, 0, j]
            g = w.apart[c] + along(w.rows[i], bodies[i], w.moved, 0)
            new = max(0.0, w.nu[c] - g / own)
            if new != w.nu[c]:
                worst = max(worst, abs(new - w.nu[c]) * own / touch.closed[c])
                push(w.pushes[i], bodies[i], 0, new - w.nu[c], w.moved)
                w.nu[c] = new
        if worst < 0.1 * _EXACT / CLOSED:
            break
    moved(H, w.moved, 1.0, H)


@uncounted
def settle_places(
    touch: Touch, masses: Masses, H: Array, w: Work, limits: tuple[int, int, bool]
) -> bool:
    """Move bodies until nothing overlaps; whether a contact has joined, and it ended with that.

    Args:
        touch: Pairs.
        masses: Of the bodies.
        H: Frames, updated.
        w: Work.
        limits: Iterations, sweeps in one, and whether to end where a contact joins.
    """
    for _ in range(limits[0]):
        k, worst, grew = 0, 0.0, False
        for at in range(w.many[0]):
            c = w.close[at]
            i, j = touch.pairs[c]
            g, _, _ = gap(H, touch.a, touch.b, i, j, touch.flat[c])
            g -= w.target[c]
            if g < 0.0 or w.nu[c] > 0.0:
                if not w.joined[c]:
                    w.joined[c] = grew = True
                    if w.gaps[c] > touch.closed[c]:  # else rows of the start have their tangents
                        w.axis[c] = axis_of(H, touch, c)
                w.near[k], w.apart[c] = c, g
                k += 1
                worst = max(worst, (-g if w.nu[c] == 0.0 else abs(g)) / touch.closed[c])
        if grew and limits[2]:
            return True
        if worst < _EXACT / CLOSED:
            return False
        _part_places(touch, masses, H, w, k, limits[1])
    return False
