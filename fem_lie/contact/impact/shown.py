"""What is kept of each contact at the end of a step, for results."""

from __future__ import annotations

from fem_lie._arrays import Array, Indices
from fem_lie._jit import uncounted
from fem_lie.contact.impact.records import Touch, Work
from fem_lie.contact.impact.sweeps import along
from fem_lie.contact.sides.kinematics import gap
from fem_lie.lie.tuples import dot, load, minus, plus, scaled

TIME, PAIR, GAP, POSITION, IMPULSE, SLIP, STICKS, WIDTH = 0, 1, 2, 3, 6, 9, 12, 13
"""Columns: end of the step, number of the pair, gap, place of the first side, impulse on it, its
velocity across the normal, global components, and whether that is none."""


@uncounted
def show(
    index: int,
    h: float,
    touch: Touch,
    w: Work,
    k: int,
    ends: tuple[Array, Array],
    room: Array,
    count: Indices,
) -> None:
    """Append the first ``k`` contacts that take part and push, as rows of ``room``.

    Args:
        index: Number of the step.
        h: Its size; what slides less than closed gaps in it sticks.
        touch: Pairs.
        w: Work of the step.
        k: How many take part.
        ends: Frames at the end, and velocities there, shape (n, 6).
        room: With room for them, shape (·, :data:`WIDTH`).
        count: How many rows there are, shape (1,), updated.
    """
    problem, (H, v) = w.cones, ends
    for e in range(k):
        if not problem.r[e, 0] > 0.0:
            continue
        c, row = w.chosen[e], room[count[0]]
        i, j = touch.pairs[c]
        g, n, P = gap(H, touch.a, touch.b, i, j, touch.flat[c])
        row[TIME], row[PAIR], row[GAP] = h * index, c, g
        at = minus(P, scaled(touch.a.radii[i], n))
        side = 0 if problem.bodies[e, 0] >= 0 else 1
        sign = 1.0 if side == 0 else -1.0
        impulse, slip = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        for m in range(3):
            d = scaled(sign, load(problem.rows[e, side, m], 0))
            impulse = plus(impulse, scaled(problem.r[e, m], d))
            if m > 0:
                slip = plus(slip, scaled(along(problem.rows[e], problem.bodies[e], v, m), d))
        for m in range(3):
            row[POSITION + m], row[IMPULSE + m], row[SLIP + m] = at[m], impulse[m], slip[m]
        slow = touch.closed[c] / h
        row[STICKS] = 1.0 if dot(slip, slip) <= slow * slow else 0.0
        count[0] += 1
