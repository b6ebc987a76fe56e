"""Which contacts take part in a step, and what velocities they are to have at its end."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import inlined_uncounted, uncounted
from fem_lie.contact.impact.records import Masses, Touch, Work
from fem_lie.contact.impact.rows import axis_of, set_pushes, set_rows
from fem_lie.contact.impact.sweeps import MOST_NEWTON, along
from fem_lie.lie.tuples import dot, load

_REACH = 4.0
"""Steps in which places come so near that their gaps are looked at."""


@inlined_uncounted
def time_of(g0: float, moved: float, g1: float) -> float:
    """Part of a step up to ``g₀ + moved τ + (g₁ − g₀ − moved) τ² = 0``, at most 1.

    The root is the one without cancellation, so that a gap that closes steadily is no special case:
    the other root is then infinite.
    """
    bend = g1 - g0 - moved
    root = np.sqrt(max(moved * moved - 4.0 * bend * g0, 0.0))
    half = -0.5 * (moved + (root if moved >= 0.0 else -root))
    found = 1.0
    for t in (half / bend, g0 / half if half != 0.0 else 2.0):
        if 0.0 <= t <= found:
            found = t
    return found


@inlined_uncounted
def largest_speed(v: Array, arm: float) -> float:
    """The largest of any place that is at most ``arm`` away from the centre of its body."""
    found = 0.0
    for body in range(v.shape[0]):
        u, ω = load(v[body], 0), load(v[body], 3)
        found = max(found, np.sqrt(dot(u, u)) + arm * np.sqrt(dot(ω, ω)))
    return found


@uncounted
def choose(h: float, touch: Touch, start: tuple[Array, Array], v: Array, w: Work) -> None:
    """Which gaps are within what bodies move in some steps: contacts change no more than that."""
    speed = largest_speed(start[1], touch.arm) + largest_speed(v, touch.arm)
    k = 0
    for c in range(touch.pairs.shape[0]):
        if min(w.gaps[c], w.smooth[c]) <= _REACH * h * speed + touch.closed[c]:
            w.close[k] = c
            k += 1
    w.many[0] = k


@uncounted
def join(h: float, touch: Touch, start: tuple[Array, Array], w: Work) -> None:
    """Let contacts take part that have overlapped, or were closed and do not open.

    Of many those that were closed and pushed, too: in a pile they would join one after the other.
    """
    H, v = start
    many = w.many[0] > MOST_NEWTON
    for at in range(w.many[0]):
        c = w.close[at]
        closed = w.gaps[c] <= touch.closed[c]
        if w.joined[c] or closed:
            w.axis[c] = axis_of(H, touch, c)
            set_rows(H, touch, c, w.axis[c], w.bodies[at], w.before[c])
            w.speed[c] = along(w.before[c], w.bodies[at], v, 0)
            lasts = many and closed and w.impulses[c, 0] > 0.0
            w.joined[c] = w.joined[c] or lasts or w.speed[c] <= touch.closed[c] / h


@inlined_uncounted
def _bound(h: float, touch: Touch, w: Work, c: int, i: int, factor: float) -> float:
    """What the normal velocity of contact c, the i-th that takes part, is to be at least."""
    free = along(w.cones.rows[i], w.cones.bodies[i], w.v, 0)
    g0, g1 = max(w.gaps[c], 0.0), w.smooth[c]
    moved = w.speed[c] * h
    w.part[c], w.incoming[c] = 0.0, w.speed[c]
    if g1 > 0.0 and g0 > touch.closed[c]:
        w.part[c], w.incoming[c] = 1.0, free
    elif g1 <= 0.0:
        if g0 > touch.closed[c]:
            w.part[c] = time_of(g0, moved, g1)
        w.incoming[c] += 2.0 * (g1 - g0 - moved) * w.part[c] / h
    elif g1 > 0.0:
        w.incoming[c] = free
    w.incoming[c] = min(0.0, w.incoming[c])
    if w.incoming[c] == 0.0:
        return 0.0
    return max(0.0, free - (1.0 + factor * touch.restitution[c]) * w.incoming[c])


@uncounted
def set_cones(h: float, touch: Touch, masses: Masses, w: Work, factor: float) -> int:
    """Rows at the places of the last pass, and velocities without impulses; how many take part."""
    problem, k = w.cones, 0
    problem.speed[0] = largest_speed(w.v, touch.arm)
    for at in range(w.many[0]):
        c = w.close[at]
        if not w.joined[c]:
            continue
        bodies, rows = problem.bodies[k], problem.rows[k]
        set_rows(w.H[1], touch, c, w.axis[c], bodies, rows)
        if w.gaps[c] <= touch.closed[c]:
            mean = w.mean
            for side in range(2):
                for i in range(3):
                    for j in range(6):
                        mean[side, i, j] = 0.5 * (rows[side, i, j] + w.before[c, side, i, j])
            set_pushes(masses, bodies, mean, problem.pushes[k])
        else:
            set_pushes(masses, bodies, rows, problem.pushes[k])
        for i in range(3):
            problem.q[k, i] = along(rows, bodies, w.v, i)
            problem.r[k, i] = w.impulses[c, i]
        problem.q[k, 0] -= _bound(h, touch, w, c, k, factor)
        problem.friction[k] = touch.friction[c]
        w.chosen[k] = c
        k += 1
    return k
