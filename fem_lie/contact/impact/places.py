"""Places of bodies at the end of a step: moved by impulses, until nothing overlaps."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled, inlined_uncounted, uncounted
from fem_lie.contact.convex.features import gap_of
from fem_lie.contact.impact.jacobian import along, push
from fem_lie.contact.impact.records import CLOSED, Masses, Touch, Work
from fem_lie.contact.impact.rows import axis_of, set_push, set_rows
from fem_lie.contact.impact.sweeps import MOST_NEWTON
from fem_lie.lie.motions import Group
from fem_lie.lie.node_types import move

_GROUP = int(Group.R3xSO3)

_SLOW = 3
"""Iterations after which sweeps over few contacts go on as those over many do: two planes that
almost face each other part a ball by less than their angle squared in one sweep."""

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
        after = along(problem.rows, i, w.v, 0) + along(problem.rows, i, problem.W, 0)
        away = 0.5 * (after - factor * touch.restitution[c] * w.incoming[c])
        w.target[c] = max(0.0, away * (1.0 - w.part[c]) * h)
    return part


@inlined_uncounted
def _sweep(touch: Touch, w: Work, k: int) -> tuple[float, float]:
    """One over all normal impulses: the largest change of a gap, and how far they go on."""
    worst, forward = 0.0, 0.0
    for i in range(k):
        c = w.near[i]
        g = w.apart[c] + along(w.rows, i, w.moved, 0)
        new = max(0.0, w.nu[c] - g / w.own[i])
        if new != w.nu[c]:
            more = new - w.nu[c]
            worst = max(worst, abs(more) * w.own[i] / touch.closed[c])
            push(w.pushes, i, 0, more, w.moved)
            w.nu[c] = new
            forward += more * (new - w.last[i])
    return worst, forward


@inlined_uncounted
def _go_on(w: Work, k: int, part: float) -> None:
    """On by a part of what the last sweep did, as Nesterov's method does.

    It begins anew where a sweep turns back (O'Donoghue & Candès, Found. Comput. Math. 15 (2015)
    715).
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
def _part_places(
    touch: Touch,
    masses: Masses,
    H: Array,
    w: Work,
    k: int,
    sweeps: int,
    enough: float,
    ahead: bool,
) -> None:
    """``0 ≤ ν ⊥ g − g* ≥ 0`` linearised, by sweeps until gaps change less; bodies are moved.

    Args:
        touch: Pairs.
        masses: Of the bodies.
        H: Frames, updated.
        w: Work.
        k: Number of contacts.
        sweeps: At most.
        enough: Change of a gap, over that which counts as closed, that is small.
        ahead: Whether sweeps extrapolate, see :func:`_go_on`.
    """
    w.moved[:], rows, pushes = 0.0, w.rows, w.pushes
    for i in range(k):
        c = w.near[i]
        rows.first[i + 1] = rows.first[i] + set_rows(H, touch, c, 0, rows, rows.first[i])
        w.own[i] = 0.0
        for block in range(rows.first[i], rows.first[i + 1]):
            set_push(masses, rows.nodes[block], rows.values[block], pushes.values[block])
            for j in range(6):
                w.own[i] += rows.values[block, 0, j] * pushes.values[block, 0, j]
    weight = 1.0
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
    many = w.many[0] > MOST_NEWTON
    for iteration in range(limits[0]):
        k, worst, grew = 0, 0.0, False
        for at in range(w.many[0]):
            c = w.close[at]
            i, j = touch.pairs[c]
            g, _, _ = gap_of(H, touch.a, touch.b, i, j, touch.kinds[c])
            g -= w.target[c]
            if g < 0.0 or w.nu[c] > 0.0 or (many and w.joined[c]):
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
        enough = 0.1 * max(_EXACT, (CLOSED * worst) ** 2 if many else 0.0) / CLOSED
        ahead = k > MOST_NEWTON or iteration >= _SLOW
        _part_places(touch, masses, H, w, k, limits[1], enough, ahead)
    return False


@uncounted
def deepest(touch: Touch, w: Work) -> int:
    """The pair that overlaps most at the end of a step, beyond what counts as closed; or −1."""
    found, worst = -1, 1.0
    for c in range(touch.pairs.shape[0]):
        if -w.gaps[c] > worst * touch.closed[c]:
            found, worst = c, -w.gaps[c] / touch.closed[c]
    return found
