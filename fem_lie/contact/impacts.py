"""Impacts and Coulomb's friction of rigid bodies in one step: what comes after the smooth step.

Brüls, Acary & Cardona, CMAME 281 (2014) 131, and Cosimo, Galvez, Cavalieri, Cardona & Brüls,
Nonlinear Dyn. 102 (2020) 2453, decoupled: the step without contacts first. What is different here:

- an impact has a time ``τ h``, from the gaps at both ends and the velocity at the start, and
  restitution is of the velocity that there is then;
- contacts that were closed push along the mean of their rows at both ends, and their impulses move
  bodies by half a step, as constant forces do; impulses of impacts by what is left of the step. All
  contacts of a step have one such part, the mean by their impulses, so that forces in
  equilibrium stay so;
- restitution is reduced, if the step would have more energy than it began with.

Two passes make the rows those of the end. Bodies move on R³×SO(3): velocities are ``ẋ``, global,
and ``ω``, in the body's axes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled, inlined, linked
from fem_lie.contact import cones
from fem_lie.contact.cones import Cones, along, push
from fem_lie.contact.kinematics import gap
from fem_lie.contact.table import Side
from fem_lie.lie.kinds import move
from fem_lie.lie.motions import Group, global_components, local_components
from fem_lie.lie.tuples import (
    Vector,
    cross,
    dot,
    load,
    load_row,
    minus,
    negative,
    plus,
    rotate_back,
    scaled,
)

_GROUP = int(Group.R3xSO3)

CLOSED = 1e-9
"""Gaps of closed contacts, as a part of a length of theirs; over a step it is a speed."""

_EXACT = 1e-13
"""Overlap that is left, likewise."""

_PASSES, _MOST, _GROWING, _GUARDS = 2, 40, 6, 6
"""Passes; most of them; in how many contacts may join; reductions of restitution."""

_REACH = 4.0
"""Steps in which places come so near that their gaps are looked at."""

_ROUGH = 1e-4
"""Residual of the cones in the first pass, which is there for its rows; places are rough, too."""

_PLACES, _SWEEPS = 20, 200
"""Iterations of places, and sweeps in one, at most."""

CONTACTS, SWEEPS, RESIDUAL, PENETRATION, IMPACT, FRICTION, GROUND = range(7)
"""Places in what is told of a step; from the last on impulse of ground and its moment, six."""
TOLD = GROUND + 6


class Touch(NamedTuple):
    """Pairs of places that may touch.

    Attributes:
        a: First places, on rigid bodies or ground.
        b: Second ones, or planes.
        pairs: Shape (m, 2).
        flat: Whether the second is a plane, shape (m,).
        friction: μ, shape (m,).
        restitution: e, shape (m,).
        closed: Gap below which a contact is closed, shape (m,).
        arm: The largest distance of a place from the centre of its body.
    """

    a: Side
    b: Side
    pairs: Indices
    flat: Flags
    friction: Array
    restitution: Array
    closed: Array
    arm: float


class Masses(NamedTuple):
    """What impulses do to bodies.

    Attributes:
        mass: Shape (n,).
        J: Inertia tensors in the bodies' axes, shape (n, 3, 3).
        inverse: Of these, shape (n, 3, 3).
        force: Constant forces on the bodies, which have a potential, shape (n, 3).
    """

    mass: Array
    J: Array
    inverse: Array
    force: Array


class Work(NamedTuple):
    """Of a step.

    Attributes:
        cones: Of the contacts that take part.
        chosen: Which those are, shape (m,).
        joined: Whether a contact takes part, shape (m,).
        gaps: At the start of a step, and at its end, shape (m,).
        smooth: At the end of the step without contacts, shape (m,).
        before: Rows at the start of those that were closed, shape (m, 2, 3, 6).
        speed: Along the normal at the start, shape (m,).
        incoming: At the time of the impact, shape (m,).
        part: Of the step up to it, shape (m,).
        target: Gap that is reached, shape (m,).
        nu: Impulses times times that move bodies apart, shape (m,).
        apart: Gaps less those targets, shape (m,).
        impulses: In the last step, shape (m, 3).
        rows: Normal rows, shape (m, 2, 1, 6).
        pushes: What they do, likewise.
        moved: Of bodies, shape (n, 6).
        H: Frames without contacts, and those of the last pass, shape (2, n, 4, 3).
        v: Velocities without contacts, shape (n, 6).
        mean: Rows of a force, shape (2, 3, 6).
        near: Contacts whose places are looked at, shape (m,).
        bodies: Of these, shape (m, 2).
        axis: By which tangents are chosen, shape (m,).
        close: Which may touch in this step at all, shape (m,).
        many: How many these are, shape (1,).
    """

    cones: Cones
    chosen: Indices
    joined: Flags
    gaps: Array
    smooth: Array
    before: Array
    speed: Array
    incoming: Array
    part: Array
    target: Array
    nu: Array
    apart: Array
    impulses: Array
    rows: Array
    pushes: Array
    moved: Array
    H: Array
    v: Array
    mean: Array
    near: Indices
    bodies: Indices
    axis: Indices
    close: Indices
    many: Indices


def work_of(m: int, n: int) -> Work:
    """Of ``m`` pairs of places and ``n`` bodies."""
    z = np.zeros
    problem = Cones(
        np.full((m, 2), -1),
        z((m, 2, 3, 6)),
        z((m, 2, 3, 6)),
        z((m, 3, 3)),
        z((m, 3)),
        z(m),
        z((m, 3)),
        z((n, 6)),
    )
    whole = np.zeros(m, dtype=np.int64)
    return Work(
        cones=problem,
        chosen=whole.copy(),
        joined=np.zeros(m, dtype=np.bool_),
        gaps=z(m),
        smooth=z(m),
        before=z((m, 2, 3, 6)),
        speed=z(m),
        incoming=z(m),
        part=z(m),
        target=z(m),
        nu=z(m),
        apart=z(m),
        impulses=z((m, 3)),
        rows=z((m, 2, 1, 6)),
        pushes=z((m, 2, 1, 6)),
        moved=z((n, 6)),
        H=z((2, n, 4, 3)),
        v=z((n, 6)),
        mean=z((2, 3, 6)),
        near=whole.copy(),
        bodies=np.full((m, 2), -1),
        axis=whole.copy(),
        close=whole.copy(),
        many=np.zeros(1, dtype=np.int64),
    )


# --- rows ---


@inlined
def _local_normal(H: Array, touch: Touch, j: int, n: Vector) -> Vector:
    """In the axes of the second body; of a plane it is constant."""
    node = touch.b.nodes[j, 0]
    if node < 0 or dot(load_row(touch.b.normals, j), load_row(touch.b.normals, j)) > 0.0:
        return n if node < 0 else load_row(touch.b.normals, j)
    return local_components(H[node], n)


@inlined
def _axis(H: Array, touch: Touch, c: int) -> int:
    """The axis of the second body that is most nearly across a normal."""
    i, j = touch.pairs[c]
    _, n, _ = gap(H, touch.a, touch.b, i, j, touch.flat[c])
    local, k = _local_normal(H, touch, j, n), 0
    if abs(local[1]) < abs(local[0]):
        k = 1
    if abs(local[2]) < abs(local[k]):
        k = 2
    return k


@inlined
def _tangents(H: Array, touch: Touch, j: int, n: Vector, k: int) -> tuple[Vector, Vector]:
    """Two directions across a normal, of which the first is across an axis of the second body."""
    node = touch.b.nodes[j, 0]
    axis = (1.0 if k == 0 else 0.0, 1.0 if k == 1 else 0.0, 1.0 if k == 2 else 0.0)
    first = cross(n, axis if node < 0 else global_components(H[node], axis))
    first = scaled(1.0 / np.sqrt(dot(first, first)), first)
    return first, cross(n, first)


@inlined
def _set_rows(H: Array, touch: Touch, c: int, axis: int, bodies: Indices, rows: Array) -> None:
    """Bodies and rows of a pair, as many as there is room for: (2,), (2, 1 or 3, 6)."""
    i, j = touch.pairs[c]
    _, n, P = gap(H, touch.a, touch.b, i, j, touch.flat[c])
    at = minus(P, scaled(touch.a.radii[i], n))
    first, second = n, n
    if rows.shape[1] > 1:
        first, second = _tangents(H, touch, j, n, axis)
    for side in range(2):
        body = touch.a.nodes[i, 0] if side == 0 else touch.b.nodes[j, 0]
        bodies[side] = body
        if body < 0:
            continue
        lever = minus(at, load_row(H[body], 0))
        for k in range(rows.shape[1]):
            d = n if k == 0 else (first if k == 1 else second)
            if side == 1:
                d = negative(d)
            turning = local_components(H[body], cross(lever, d))
            for at_ in range(3):
                rows[side, k, at_] = d[at_]
                rows[side, k, 3 + at_] = turning[at_]


@inlined
def _set_pushes(masses: Masses, bodies: Indices, rows: Array, pushes: Array) -> None:
    """``M⁻¹ Bᵀ``."""
    for side in range(2):
        body = bodies[side]
        if body < 0:
            continue
        J = masses.inverse[body]
        for k in range(rows.shape[1]):
            for i in range(3):
                pushes[side, k, i] = rows[side, k, i] / masses.mass[body]
                total = 0.0
                for j in range(3):
                    total += J[i, j] * rows[side, k, 3 + j]
                pushes[side, k, 3 + i] = total


@compiled
def _moved(H: Array, by: Array, part: float, out: Array) -> None:
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


@compiled
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


# --- velocities ---


@inlined
def _time(g0: float, moved: float, g1: float) -> float:
    """Part of a step up to ``g₀ + moved τ + (g₁ − g₀ − moved) τ² = 0``, at most 1."""
    bend = g1 - g0 - moved
    if abs(bend) < 1e-14 * abs(moved):
        return min(-g0 / moved, 1.0)
    root = np.sqrt(max(moved * moved - 4.0 * bend * g0, 0.0))
    half = -0.5 * (moved + (root if moved >= 0.0 else -root))
    found = 1.0
    for t in (half / bend, g0 / half if half != 0.0 else 2.0):
        if 0.0 <= t <= found:
            found = t
    return found


@inlined
def _largest_speed(v: Array, arm: float) -> float:
    """Of any place."""
    found = 0.0
    for body in range(v.shape[0]):
        u, ω = load(v[body], 0), load(v[body], 3)
        found = max(found, np.sqrt(dot(u, u)) + arm * np.sqrt(dot(ω, ω)))
    return found


@compiled
def _choose(h: float, touch: Touch, start: tuple[Array, Array], v: Array, w: Work) -> None:
    """Which gaps are within what bodies move in some steps: contacts change no more than that."""
    speed = _largest_speed(start[1], touch.arm) + _largest_speed(v, touch.arm)
    k = 0
    for c in range(touch.pairs.shape[0]):
        if min(w.gaps[c], w.smooth[c]) <= _REACH * h * speed + touch.closed[c]:
            w.close[k] = c
            k += 1
    w.many[0] = k


@compiled
def _join(h: float, touch: Touch, start: tuple[Array, Array], w: Work) -> None:
    """Let contacts take part that have overlapped, or were closed and do not open."""
    H, v = start
    bodies = np.empty(2, dtype=np.int64)
    for at in range(w.many[0]):
        c = w.close[at]
        closed = w.gaps[c] <= touch.closed[c]
        if w.joined[c] or closed:
            w.axis[c] = _axis(H, touch, c)
            _set_rows(H, touch, c, w.axis[c], bodies, w.before[c])
            w.speed[c] = along(w.before[c], bodies, v, 0)
            w.joined[c] = w.joined[c] or w.speed[c] <= touch.closed[c] / h


@inlined
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
            w.part[c] = _time(g0, moved, g1)
        w.incoming[c] += 2.0 * (g1 - g0 - moved) * w.part[c] / h
    elif g1 > 0.0:
        w.incoming[c] = free
    w.incoming[c] = min(0.0, w.incoming[c])
    if w.incoming[c] == 0.0:
        return 0.0
    return max(0.0, free - (1.0 + factor * touch.restitution[c]) * w.incoming[c])


@compiled
def _set_cones(h: float, touch: Touch, masses: Masses, w: Work, factor: float) -> int:
    """Rows at the places of the last pass, and velocities without impulses; how many take part."""
    problem, k = w.cones, 0
    for at in range(w.many[0]):
        c = w.close[at]
        if not w.joined[c]:
            continue
        bodies, rows = problem.bodies[k], problem.rows[k]
        _set_rows(w.H[1], touch, c, w.axis[c], bodies, rows)
        if w.gaps[c] <= touch.closed[c]:
            mean = w.mean
            for side in range(2):
                for i in range(3):
                    for j in range(6):
                        mean[side, i, j] = 0.5 * (rows[side, i, j] + w.before[c, side, i, j])
            _set_pushes(masses, bodies, mean, problem.pushes[k])
        else:
            _set_pushes(masses, bodies, rows, problem.pushes[k])
        for i in range(3):
            problem.q[k, i] = along(rows, bodies, w.v, i)
            problem.r[k, i] = w.impulses[c, i]
        problem.q[k, 0] -= _bound(h, touch, w, c, k, factor)
        problem.friction[k] = touch.friction[c]
        w.chosen[k] = c
        k += 1
    return k


@compiled
def _note_works(w: Work, k: int, v: Array, told: Array) -> None:
    """Work of normal impulses and of friction, by the mean velocities of their rows."""
    problem = w.cones
    told[IMPACT], told[FRICTION] = 0.0, 0.0
    for i in range(k):
        for j in range(3):
            mean = along(problem.rows[i], problem.bodies[i], v, j)
            mean = 0.5 * (mean + along(problem.rows[i], problem.bodies[i], w.v, j))
            told[IMPACT if j == 0 else FRICTION] += mean * problem.r[i, j]


@compiled
def _note_ground(masses: Masses, w: Work, k: int, told: Array) -> None:
    """Impulses of ground on bodies, and their moments about the origin."""
    problem = w.cones
    told[GROUND:] = 0.0
    for i in range(k):
        side = 0 if problem.bodies[i, 1] < 0 else 1
        if problem.bodies[i, 1 - side] >= 0:
            continue
        body, impulse, turning = problem.bodies[i, side], (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        for j in range(3):
            given = problem.pushes[i, side, j]
            impulse = plus(impulse, scaled(problem.r[i, j] * masses.mass[body], load(given, 0)))
            turning = plus(turning, scaled(problem.r[i, j], load(given, 3)))
        J, H = masses.J[body], w.H[1, body]
        local = rotate_back(load_row(J, 0), load_row(J, 1), load_row(J, 2), turning)
        moment = plus(cross(load_row(H, 0), impulse), global_components(H, local))
        for j in range(3):
            told[GROUND + j] += impulse[j]
            told[GROUND + 3 + j] += moment[j]


# --- places ---


@compiled
def _aim(h: float, touch: Touch, w: Work, k: int, factor: float) -> float:
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


@compiled
def _part_places(touch: Touch, masses: Masses, H: Array, w: Work, k: int, sweeps: int) -> None:
    """``0 ≤ ν ⊥ g − g* ≥ 0`` linearised, by sweeps; bodies are moved."""
    w.moved[:], bodies = 0.0, w.bodies
    for i in range(k):
        c = w.near[i]
        _set_rows(H, touch, c, 0, bodies[i], w.rows[i])
        _set_pushes(masses, bodies[i], w.rows[i], w.pushes[i])
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
    _moved(H, w.moved, 1.0, H)


@compiled
def _settle_places(
    touch: Touch, masses: Masses, H: Array, w: Work, limits: tuple[int, int]
) -> bool:
    """Move bodies until nothing overlaps; whether a contact has joined."""
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
                    w.axis[c] = _axis(H, touch, c)
                w.near[k], w.apart[c] = c, g
                k += 1
                worst = max(worst, (-g if w.nu[c] == 0.0 else abs(g)) / touch.closed[c])
        if grew:
            return True
        if worst < _EXACT / CLOSED:
            return False
        _part_places(touch, masses, H, w, k, limits[1])
    return False


# --- a step ---


@linked
def _pass(
    h: float,
    touch: Touch,
    masses: Masses,
    H: Array,
    v: Array,
    w: Work,
    factor: float,
    tolerance: float,
    told: Array,
    limits: tuple[int, int],
) -> bool:
    """One pass from the end without contacts to ``H`` and ``v``; whether a contact has joined."""
    k = _set_cones(h, touch, masses, w, factor)
    sweeps, _, told[RESIDUAL] = cones.solve(w.cones, k, tolerance)
    told[CONTACTS], told[SWEEPS] = k, told[SWEEPS] + sweeps
    v[:] = w.v + w.cones.W
    _note_works(w, k, v, told)
    _note_ground(masses, w, k, told)
    part = _aim(h, touch, w, k, factor)
    _moved(w.H[0], w.cones.W, part * h, H)
    return _settle_places(touch, masses, H, w, limits)


@compiled
def _kick(touch: Touch, w: Work) -> float:
    """The largest velocity that restitution gives."""
    found = 0.0
    for at in range(w.many[0]):
        c = w.close[at]
        if w.joined[c]:
            found = max(found, -touch.restitution[c] * w.incoming[c])
    return found


@compiled
def _fall(w: Work, k: int) -> float:
    """The largest change of a normal velocity in the smooth step."""
    found = 0.0
    for i in range(k):
        free = along(w.cones.rows[i], w.cones.bodies[i], w.v, 0)
        found = max(found, abs(free - w.speed[w.chosen[i]]))
    return found


@compiled
def set_gaps(touch: Touch, H: Array, out: Array) -> None:
    """Gaps at frames ``H``, shape (m,)."""
    for c in range(touch.pairs.shape[0]):
        i, j = touch.pairs[c]
        out[c], _, _ = gap(H, touch.a, touch.b, i, j, touch.flat[c])


@linked
def settle(
    h: float,
    touch: Touch,
    masses: Masses,
    start: tuple[Array, Array],
    H: Array,
    v: Array,
    w: Work,
    tolerance: float,
    told: Array,
) -> bool:
    """What contacts make of the end of a step; whether there are any.

    Args:
        h: Size of the step.
        touch: Pairs.
        masses: Of the bodies.
        start: Frames and velocities at its start.
        H: Frames at its end without contacts, shape (n, 4, 3), updated.
        v: Velocities, shape (n, 6), updated.
        w: Work; gaps and impulses are kept from step to step.
        tolerance: Of :func:`~fem_lie.contact.cones.residual`.
        told: See :data:`TOLD`, overwritten.
    """
    told[:], overlaps, m = 0.0, False, touch.pairs.shape[0]
    for c in range(m):
        i, j = touch.pairs[c]
        w.smooth[c], _, _ = gap(H, touch.a, touch.b, i, j, touch.flat[c])
        w.joined[c] = w.smooth[c] <= 0.0
        overlaps = overlaps or w.joined[c]
    if not overlaps:
        w.impulses[:] = 0.0
        w.gaps[:] = w.smooth
        return False
    _choose(h, touch, start, v, w)
    _join(h, touch, start, w)
    w.H[0], w.H[1], w.v[:] = H, H, v
    free, before = energy(masses, H, v), energy(masses, start[0], start[1])
    _guarded(h, touch, masses, before, H, v, w, tolerance, told)
    told[IMPACT] = energy(masses, H, v) - free - told[FRICTION]
    for c in range(m):
        i, j = touch.pairs[c]
        w.gaps[c], _, _ = gap(H, touch.a, touch.b, i, j, touch.flat[c])
        told[PENETRATION] = max(told[PENETRATION], -w.gaps[c])
    return True


@linked
def _guarded(
    h: float,
    touch: Touch,
    masses: Masses,
    before: float,
    H: Array,
    v: Array,
    w: Work,
    tolerance: float,
    told: Array,
) -> None:
    """Passes, with as much of the restitution as does not add to the energy ``before``."""
    factor, least, most, below, above = 1.0, -1.0, 1.0, 0.0, 0.0
    passes, tries, last = 0, 0, False
    for attempt in range(_MOST):
        wanted, limits = (_ROUGH, (1, 3)) if attempt == 0 else (tolerance, (_PLACES, _SWEEPS))
        grew = _pass(h, touch, masses, H, v, w, factor, wanted, told, limits)
        w.H[1] = H
        if grew and attempt < _GROWING:
            continue
        passes += 1
        if passes < _PASSES:
            continue
        if last or _kick(touch, w) <= 1e-2 * _fall(w, int(told[CONTACTS])):
            return
        excess = energy(masses, H, v) - before
        if excess <= 1e-10 * abs(told[IMPACT] + told[FRICTION]) + 1e-14 * abs(before):
            if tries == 0:
                return
            least, below = factor, excess
        else:
            most, above = factor, excess
        tries += 1
        if tries == 1:
            factor = 0.0
        elif least < 0.0:
            factor, last = 1.0, True  # it is not restitution that gives it
        elif tries >= _GUARDS or most - least < 1e-3 or -below < 1e-12 * abs(before):
            if factor == least:
                return
            factor, last = least, True
        else:
            by_secant = -below / (above - below)
            factor = least + (most - least) * min(0.95, max(0.05, by_secant))
