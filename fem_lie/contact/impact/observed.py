"""What contacts did in a step: energy, work, the impulses of ground, and a row for each of them."""

from __future__ import annotations

from fem_lie._arrays import Array, Indices
from fem_lie._jit import uncounted
from fem_lie.contact.impact.jacobian import along
from fem_lie.contact.impact.records import FRICTION, GROUND, IMPACT, Masses, Touch, Work
from fem_lie.contact.impact.rows import nearest
from fem_lie.lie.motions import global_components
from fem_lie.lie.tuples import cross, dot, load, load_row, plus, rotate_back, scaled

TIME, PAIR, GAP, POSITION, IMPULSE, SLIP, STICKS, WIDTH = 0, 1, 2, 3, 6, 9, 12, 13
"""Columns: end of the step, number of the pair, gap, place of the first side, impulse on it, its
velocity across the normal, global components, and whether that is none."""


@uncounted
def energy(masses: Masses, H: Array, v: Array) -> float:
    """Kinetic, and that of constant forces."""
    total = 0.0
    for body in range(v.shape[0]):
        u, ω = load(v[body], 0), load(v[body], 3)
        total += 0.5 * masses.mass[body] * dot(u, u)
        for i in range(3):
            for j in range(3):
                total += 0.5 * ω[i] * masses.J[body, i, j] * ω[j]
        total -= dot(load(masses.force[body], 0), load_row(H[body], 0))
    return total


@uncounted
def note_works(w: Work, k: int, v: Array, told: Array) -> None:
    """Work of normal impulses and of friction, by the mean velocities of their rows."""
    problem = w.cones
    told[IMPACT], told[FRICTION] = 0.0, 0.0
    for i in range(k):
        for j in range(3):
            mean = 0.5 * (along(problem.rows, i, v, j) + along(problem.rows, i, w.v, j))
            told[IMPACT if j == 0 else FRICTION] += mean * problem.r[i, j]


@uncounted
def note_ground(masses: Masses, w: Work, k: int, told: Array) -> None:
    """Impulses of ground on bodies, and their moments about the origin."""
    problem = w.cones
    told[GROUND:] = 0.0
    for i in range(k):
        block = problem.rows.first[i]
        if problem.rows.first[i + 1] - block > 1:  # it is between two bodies
            continue
        body, impulse, turning = problem.rows.nodes[block], (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        for j in range(3):
            given = problem.pushes.values[block, j]
            impulse = plus(impulse, scaled(problem.r[i, j] * masses.mass[body], load(given, 0)))
            turning = plus(turning, scaled(problem.r[i, j], load(given, 3)))
        J, H = masses.J[body], w.H[1, body]
        local = rotate_back(load_row(J, 0), load_row(J, 1), load_row(J, 2), turning)
        moment = plus(cross(load_row(H, 0), impulse), global_components(H, local))
        for j in range(3):
            told[GROUND + j] += impulse[j]
            told[GROUND + 3 + j] += moment[j]


@uncounted
def show(
    time: float,
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
        time: End of the step.
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
        at, _ = nearest(H, touch, c)
        row[TIME], row[PAIR], row[GAP] = time, c, w.gaps[c]
        block = problem.rows.first[e]
        sign = 1.0 if touch.a.nodes[touch.pairs[c, 0], 0] >= 0 else -1.0
        impulse, slip = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        for m in range(3):
            d = scaled(sign, load(problem.rows.values[block, m], 0))
            impulse = plus(impulse, scaled(problem.r[e, m], d))
            if m > 0:
                slip = plus(slip, scaled(along(problem.rows, e, v, m), d))
        for m in range(3):
            row[POSITION + m], row[IMPULSE + m], row[SLIP + m] = at[m], impulse[m], slip[m]
        slow = touch.closed[c] / h
        row[STICKS] = 1.0 if dot(slip, slip) <= slow * slow else 0.0
        count[0] += 1
