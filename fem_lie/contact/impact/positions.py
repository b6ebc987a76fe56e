"""Positions of bodies at the end of a step: moved by impulses until nothing overlaps."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled, inlined_uncounted, uncounted
from fem_lie.contact.cones.gaps import Gaps, separate
from fem_lie.contact.cones.jacobian import add_response, along
from fem_lie.contact.cones.sweeps import MOST_NEWTON
from fem_lie.contact.impact.records import CLOSED, Masses, Touch, Work
from fem_lie.contact.impact.rows import axis_of, point_of, set_response, set_rows
from fem_lie.lie.motions import Group
from fem_lie.lie.node_types import move

_GROUP = int(Group.R3xSO3)

PLACES, SWEEPS, _NEWTON = 20, 200, 40
"""Largest number of iterations; of sweeps in each; and of Newton's method where sweeps over many
contacts are too slow, because more contacts bear a body than are needed."""

_SLOW = 3
"""Iteration from which sweeps over few contacts are accelerated like those over many: two nearly
parallel planes separate a ball by less than the square of their angle per sweep."""

_EXACT = 1e-13
"""Remaining overlap relative to a length, as in :data:`CLOSED`."""

_SUFFICIENT = 1e-2
"""Remaining overlap relative to a closed gap, if iterations no longer halve it: of contacts that
share a load, some open by less when others take it, and each redistribution is costly."""


@compiled
def moved(H: Array, by: Array, part: float, out: Array) -> None:
    """Frames ``out``: ``H`` moved by ``part`` times an increment (n, 6)."""
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
    """Set impulses and target gaps; return the mean fraction of the step in which impulses act."""
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
        after = along(problem.rows, i, w.v, 0) + along(problem.rows, i, problem.W, 0)
        away = 0.5 * (after - factor * touch.restitution[c] * w.incoming[c])
        w.target[c] = max(0.0, away * (1.0 - w.part[c]) * h)
    return part


@inlined_uncounted
def _sweep(touch: Touch, w: Work, k: int) -> tuple[float, float]:
    """Sweep over all normal impulses; largest change of a gap, and product with the last sweep."""
    worst, forward = 0.0, 0.0
    for i in range(k):
        c = w.near[i]
        g = w.separation[c] + along(w.rows, i, w.moved, 0)
        new = max(0.0, w.nu[c] - g / w.own[i])
        if new != w.nu[c]:
            more = new - w.nu[c]
            worst = max(worst, abs(more) * w.own[i] / touch.closed[c])
            add_response(w.responses, i, 0, more, w.moved)
            w.nu[c] = new
            forward += more * (new - w.last[i])
    return worst, forward


@inlined_uncounted
def _go_on(w: Work, k: int, part: float) -> None:
    """Extrapolate by ``part`` times the change of the last sweep, as in Nesterov's method.

    The acceleration restarts when a sweep reverses direction (O'Donoghue & Candès, Found. Comput.
    Math. 15 (2015) 715).
    """
    last, turned = w.last, w.turned
    for i in range(k):
        here = w.nu[w.near[i]]
        w.nu[w.near[i]] += part * (here - last[i])
        last[i] = here
    for body in range(turned.shape[0]):
        for j in range(6):
            here = w.moved[body, j]
            w.moved[body, j] += part * (here - turned[body, j])
            turned[body, j] = here


@uncounted
def _separate(
    touch: Touch,
    masses: Masses,
    H: Array,
    w: Work,
    k: int,
    sweeps: int,
    enough: float,
    ahead: bool,
) -> None:
    """Solve ``0 ≤ ν ⊥ g − g* ≥ 0``, linearised, by sweeps, and move the bodies.

    Args:
        touch: Pairs.
        masses: Masses of the bodies.
        H: Frames, updated.
        w: Workspace.
        k: Number of contacts.
        sweeps: Largest number of sweeps.
        enough: Change of a gap, relative to that of a closed contact, at which sweeps end.
        ahead: Whether sweeps are accelerated, see :func:`_go_on`.
    """
    w.moved[:], rows, responses = 0.0, w.rows, w.responses
    for i in range(k):
        c = w.near[i]
        rows.first[i + 1] = rows.first[i] + set_rows(H, touch, c, 0, rows, rows.first[i])
        w.own[i] = 0.0
        for block in range(rows.first[i], rows.first[i + 1]):
            set_response(masses, rows.nodes[block], rows.values[block], responses.values[block])
            for j in range(6):
                w.own[i] += rows.values[block, 0, j] * responses.values[block, 0, j]
    weight, worst = 1.0, np.inf
    if ahead:
        _go_on(w, k, 0.0)
    for left in range(sweeps - 1, -1, -1):
        worst, forward = _sweep(touch, w, k)
        if worst < enough:
            break
        if ahead and left > 0:
            weight = 1.0 if forward < 0.0 else weight
            later = 0.5 * (1.0 + np.sqrt(1.0 + 4.0 * weight * weight))
            _go_on(w, k, (weight - 1.0) / later)
            weight = later
    if sweeps == SWEEPS and not worst < enough:
        gaps = Gaps(rows, responses, w.own, w.near, w.separation, w.nu, touch.closed, w.moved)
        separate(gaps, k, max(enough, 0.1 * _SUFFICIENT), _NEWTON)
    moved(H, w.moved, 1.0, H)


@uncounted
def resolve_positions(
    touch: Touch, masses: Masses, H: Array, w: Work, limits: tuple[int, int, bool]
) -> bool:
    """Move bodies until nothing overlaps; whether it ended early because a contact became active.

    Args:
        touch: Pairs.
        masses: Masses of the bodies.
        H: Frames, updated.
        w: Workspace.
        limits: Largest number of iterations, of sweeps in each, and whether to end when a contact
            becomes active.
    """
    many = w.many[0] > MOST_NEWTON
    halved = np.inf
    for iteration in range(limits[0]):
        k, worst, grew = 0, 0.0, False
        for at in range(w.many[0]):
            c = w.close[at]
            g = point_of(H, touch, c).gap - w.target[c]
            if g < 0.0 or w.nu[c] > 0.0 or (many and w.joined[c]):
                if not w.joined[c]:
                    w.joined[c] = grew = True
                    if (
                        w.gaps[c] > touch.closed[c]
                    ):  # otherwise the axis of the rows at the start is kept
                        w.axis[c] = axis_of(H, touch, c)
                w.near[k], w.separation[c] = c, g
                k += 1
                worst = max(worst, (-g if w.nu[c] == 0.0 else abs(g)) / touch.closed[c])
        if grew and limits[2]:
            return True
        if worst < _EXACT / CLOSED or halved < worst < _SUFFICIENT:
            return False
        halved = min(halved, 0.5 * worst)
        enough = 0.1 * max(_EXACT, (CLOSED * worst) ** 2 if many else 0.0) / CLOSED
        ahead = k > MOST_NEWTON or iteration >= _SLOW
        _separate(touch, masses, H, w, k, limits[1], enough, ahead)
    return False


@uncounted
def deepest(touch: Touch, w: Work) -> int:
    """The pair with the largest overlap at the end of a step, beyond a closed contact's; or −1."""
    found, worst = -1, 1.0
    for c in range(touch.pairs.shape[0]):
        if -w.gaps[c] > worst * touch.closed[c]:
            found, worst = c, -w.gaps[c] / touch.closed[c]
    return found
