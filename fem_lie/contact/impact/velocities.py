"""Which contacts are active in a step, and their target velocities at its end."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Flags
from fem_lie._jit import inlined_uncounted, uncounted
from fem_lie.contact.cones.jacobian import along
from fem_lie.contact.cones.sweeps import MOST_NEWTON
from fem_lie.contact.impact.records import Masses, Touch, Work
from fem_lie.contact.impact.rows import axis_of, set_response, set_rows
from fem_lie.lie.tuples import dot, load

_TINY = 1e-6
"""Round-off level of velocities relative to the speed; round-off is 1e-10 of impulses that change
it."""

_REACH = 4.0
"""Number of steps in which points may come into contact, for pairs whose gaps are checked."""


@inlined_uncounted
def time_of(g0: float, moved: float, g1: float) -> float:
    """Fraction of a step before ``g₀ + moved τ + (g₁ − g₀ − moved) τ² = 0``, at most 1.

    The root is computed without cancellation, so that a constant closing velocity is no special
    case: the other root is then infinite.
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
def largest_speed(v: Array, arms: Array) -> float:
    """Largest velocity of any point within the distance ``arms`` from the centre of its body."""
    found = 0.0
    for body in range(v.shape[0]):
        u, ω = load(v[body], 0), load(v[body], 3)
        found = max(found, np.sqrt(dot(u, u)) + arms[body] * np.sqrt(dot(ω, ω)))
    return found


@uncounted
def choose(h: float, touch: Touch, start: tuple[Array, Array], v: Array, w: Work) -> None:
    """Choose pairs whose gaps are within the motion of bodies in some steps; others stay open.

    Nothing but gaps and impulses of these pairs is kept from earlier steps.
    """
    speed = largest_speed(start[1], touch.arms) + largest_speed(v, touch.arms)
    k = 0
    for c in range(touch.pairs.shape[0]):
        if min(w.gaps[c], w.smooth[c]) <= _REACH * h * speed + touch.closed[c]:
            w.close[k] = c
            w.speed[c] = w.nu[c] = w.target[c] = 0.0
            k += 1
    w.many[0] = k


@uncounted
def join(h: float, touch: Touch, start: tuple[Array, Array], w: Work) -> None:
    """Activate contacts that overlap, and closed ones that do not open.

    If there are many, closed contacts with an impulse in the last step are activated, too: in a
    pile they would be activated one after the other.
    """
    H, v = start
    many = w.many[0] > MOST_NEWTON
    for at in range(w.many[0]):
        c = w.close[at]
        closed = w.gaps[c] <= touch.closed[c]
        if w.joined[c] or closed:
            w.axis[c] = axis_of(H, touch, c)
            block = w.before.first[c]
            block += set_rows(H, touch, c, w.axis[c], w.before, block)
            w.before.values[block : w.before.first[c + 1]] = 0.0  # ground has no block
            w.speed[c] = along(w.before, c, v, 0)
            lasts = many and closed and w.impulses[c, 0] > 0.0
            w.joined[c] = w.joined[c] or lasts or w.speed[c] <= touch.closed[c] / h


@inlined_uncounted
def bound(
    h: float, gaps: tuple[float, float], closed: bool, speed: float, free: float, restitution: float
) -> tuple[float, float, float]:
    """Least normal velocity at the end of a step, velocity at the impact, and time of the impact.

    Args:
        h: Step size.
        gaps: Gaps at the start, and at the end without contacts.
        closed: Whether the contact was closed at the start.
        speed: Normal velocity at the start.
        free: Normal velocity at the end without contacts.
        restitution: e.
    """
    g0, g1, moved = max(gaps[0], 0.0), gaps[1], speed * h
    part, incoming = 0.0, free
    if g1 > 0.0:
        part = 0.0 if closed else 1.0
    else:
        if not closed:
            part = time_of(g0, moved, g1)
        incoming = speed + 2.0 * (g1 - g0 - moved) * part / h
    incoming = min(0.0, incoming)
    least = 0.0 if incoming == 0.0 else max(0.0, free - (1.0 + restitution) * incoming)
    return least, incoming, part


@uncounted
def set_bounds(
    h: float,
    gaps: tuple[Array, Array],
    closed: Flags,
    speed: Array,
    free: Array,
    restitution: Array,
    out: Array,
) -> None:
    """:func:`bound` of all contacts, shape (k, 3)."""
    for c in range(out.shape[0]):
        ends = gaps[0][c], gaps[1][c]
        found = bound(h, ends, closed[c], speed[c], free[c], restitution[c])
        out[c, 0], out[c, 1], out[c, 2] = found


@uncounted
def set_cones(h: float, touch: Touch, masses: Masses, w: Work, factor: float) -> int:
    """Set rows at the positions of the last pass and velocities without impulses; their number."""
    problem, k = w.cones, 0
    rows, responses = problem.rows, problem.responses
    problem.least[0] = _TINY * largest_speed(w.v, touch.arms)
    for at in range(w.many[0]):
        c = w.close[at]
        if not w.joined[c]:
            continue
        first, closed = rows.first[k], w.gaps[c] <= touch.closed[c]
        rows.first[k + 1] = first + set_rows(w.H[1], touch, c, w.axis[c], rows, first)
        for block in range(first, rows.first[k + 1]):
            start = w.before.values[w.before.first[c] + block - first]
            for i in range(3):
                for j in range(6):
                    here = rows.values[block, i, j]
                    w.mean[i, j] = 0.5 * (here + start[i, j]) if closed else here
            set_response(masses, rows.nodes[block], w.mean, responses.values[block])
        for i in range(3):
            problem.q[k, i] = along(rows, k, w.v, i)
            problem.r[k, i] = w.impulses[c, i]
        gaps, free, restitution = (w.gaps[c], w.smooth[c]), problem.q[k, 0], touch.restitution[c]
        least, w.incoming[c], w.part[c] = bound(
            h, gaps, closed, w.speed[c], free, factor * restitution
        )
        problem.q[k, 0] -= least
        problem.friction[k] = touch.friction[c]
        w.chosen[k] = c
        k += 1
    return k
