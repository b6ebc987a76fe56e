"""Steps of free rigid bodies, compiled.

The equations of a free body in its own frame at the centre of mass, with forces and moments
``f, m`` fixed in space and ``f', m'`` following::

    m (u̇ + ω×u) = Rᵀf + f'           J ω̇ + ω×Jω = Rᵀm + m'                 on SE(3)
    m ẍ = f + R f'                   the same                              on R³×SO(3)

Turning does not depend on the translation, so the 6×6 matrix of Newton's method is block
triangular, and its factorisation is two 3×3 inverses and the block between them. It is constant but
for the gyroscopic and load terms, and is kept.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled, inlined
from fem_lie.lie.motions import Group, to_local
from fem_lie.lie.series import blend, tangent_coefficients
from fem_lie.lie.tuples import (
    Vector,
    combined,
    cross,
    dot,
    load,
    load_row,
    minus,
    negative,
    plus,
    rotate,
    rotate_back,
    scaled,
    store,
    store_row,
)
from fem_lie.solve.alpha.step import node
from fem_lie.solve.alpha.step.free_records import (
    BEYOND,
    BODY,
    FEWEST,
    INCREMENT,
    MOTION,
    RATIO,
    RESIDUAL,
    Bodies,
    Body,
    End,
    Kept,
    Loads,
    Options,
    Plan,
    Start,
    State,
)
from fem_lie.solve.alpha.step.node import Scheme
from fem_lie.solve.motion.convergence import DIVERGED, ROUND_OFF, UNMEASURED, estimate
from fem_lie.system.nodes import inertia

# --- one body -----------------------------------------------------------------------------------


@inlined
def load_of(loads: Loads, amplitude: Array, i: int, f: Array) -> None:
    """Load of body ``i`` into ``f`` (12,)."""
    constant, first, vary, column = loads
    for k in range(12):
        f[k] = constant[i, k]
    for entry in range(first[i], first[i + 1]):
        for k in range(12):
            f[k] += amplitude[column[entry]] * vary[entry, k]


@inlined
def residual(
    group: int, m: float, J: Array, f: Array, H1: Array, v1: Array, vdot1: Array
) -> tuple[Vector, Vector]:
    """Inertia minus load at the end of a step: translation and rotation."""
    d1, d2, d3 = load_row(H1, 1), load_row(H1, 2), load_row(H1, 3)
    J1, J2, J3 = load_row(J, 0), load_row(J, 1), load_row(J, 2)
    ω = load(v1, 3)
    rate = rotate_back(J1, J2, J3, load(vdot1, 3))
    gyroscopic = cross(ω, rotate_back(J1, J2, J3, ω))
    moment = plus(rotate_back(d1, d2, d3, load(f, 3)), load(f, 9))
    turning = minus(plus(rate, gyroscopic), moment)
    acceleration = load(vdot1, 0)
    if group == Group.SE3:
        acceleration = plus(acceleration, cross(ω, load(v1, 0)))
        force = plus(rotate_back(d1, d2, d3, load(f, 0)), load(f, 6))
    else:
        force = plus(load(f, 0), rotate(d1, d2, d3, load(f, 6)))
    return minus(scaled(m, acceleration), force), turning


@inlined
def inverse(a: Vector, b: Vector, c: Vector) -> tuple[Vector, Vector, Vector]:
    """Rows of the inverse of the matrix with columns ``a, b, c``."""
    bc = cross(b, c)
    s = 1.0 / dot(a, bc)
    return scaled(s, bc), scaled(s, cross(c, a)), scaled(s, cross(a, b))


@inlined
def _columns(
    p: Scheme,
    body: Body,
    f: Array,
    H1: Array,
    v1: Array,
    d: Array,
    e: Vector,
) -> tuple[Vector, Vector, Vector]:
    """Derivatives of the residual along the unit vector ``e``.

    Of the rotation by ``d_θ``, of the translation by ``d_θ``, of the translation by ``d_u``.
    """
    mass, damping = p.mass, p.damping
    group, m, J = body
    d1, d2, d3 = load_row(H1, 1), load_row(H1, 2), load_row(H1, 3)
    J1, J2, J3 = load_row(J, 0), load_row(J, 1), load_row(J, 2)
    ω, θ = load(v1, 3), load(d, 3)
    Je, Jω = rotate_back(J1, J2, J3, e), rotate_back(J1, J2, J3, ω)
    k, _ = tangent_coefficients(dot(θ, θ))
    h = blend(k, θ, e)
    turning = combined(mass, Je, damping, plus(cross(ω, Je), cross(e, Jω)))
    turning = minus(turning, cross(rotate_back(d1, d2, d3, load(f, 3)), h))
    if group == Group.SE3:
        coupling = scaled(m * damping, cross(e, load(v1, 0)))
        coupling = minus(coupling, cross(rotate_back(d1, d2, d3, load(f, 0)), h))
        return turning, coupling, combined(m * mass, e, m * damping, cross(ω, e))
    coupling = negative(rotate(d1, d2, d3, cross(h, load(f, 6))))
    return turning, coupling, scaled(m * mass, e)


@compiled
def factorise(
    p: Scheme,
    body: Body,
    f: Array,
    H1: Array,
    v1: Array,
    d: Array,
    kept: Array,
) -> None:
    """Renew the kept matrix."""
    a = _columns(p, body, f, H1, v1, d, (1.0, 0.0, 0.0))
    b = _columns(p, body, f, H1, v1, d, (0.0, 1.0, 0.0))
    c = _columns(p, body, f, H1, v1, d, (0.0, 0.0, 1.0))
    for block in range(3):
        rows = (a[block], b[block], c[block])
        if block != 1:
            rows = inverse(a[block], b[block], c[block])
        for k in range(3):
            store_row(kept, 3 * block + k, rows[k])


@inlined
def _solve(kept: Array, translation: Vector, turning: Vector, dx: Array) -> None:
    θ = rotate_back(load_row(kept, 0), load_row(kept, 1), load_row(kept, 2), turning)
    coupled = rotate(load_row(kept, 3), load_row(kept, 4), load_row(kept, 5), θ)
    right = minus(translation, coupled)
    store(dx, 0, rotate_back(load_row(kept, 6), load_row(kept, 7), load_row(kept, 8), right))
    store(dx, 3, θ)


@compiled
def make_step(
    p: Scheme,
    options: Options,
    body: Body,
    f: Array,
    state: Start,
    end: End,
    failed: Array,
) -> tuple[int, int]:
    """Iterations, 0 if it failed, and factorisations of one step of one body."""
    tolerance, limit, patience, cost, _ = options
    group, m, J = body
    H, v, vdot, a, memory, kept = state
    d, H1, v1, vdot1, dx = end
    motion = node.predict(p, group, H, v, vdot, a, d, H1, v1, vdot1)
    memory[MOTION] = max(motion, memory[MOTION])
    wanted = max(tolerance * memory[MOTION], ROUND_OFF)
    previous, ratio, renewed, increment = np.inf, memory[RATIO], 0, np.inf
    translation = turning = (0.0, 0.0, 0.0)
    failed[RESIDUAL] = 0.0
    for iteration in range(1, limit + 1):
        translation, turning = residual(group, m, J, f, H1, v1, vdot1)
        due = memory[BEYOND] >= cost if iteration == 1 else (iteration - 1) % patience == 0
        if due:
            factorise(p, body, f, H1, v1, d, kept)
            memory[FEWEST], memory[BEYOND] = 0.0, 0.0
            renewed += 1
        _solve(kept, translation, turning, dx)
        increment = node.correct(p, group, dx, H, d, H1, v1, vdot1)
        ratio, remaining = estimate(increment, previous, ratio)
        if remaining <= wanted or increment <= ROUND_OFF:
            memory[RATIO] = ratio if iteration > 1 else ratio**UNMEASURED
            counted = max(iteration, 2)  # as policies.Automatic: one iteration is luck
            if memory[FEWEST] == 0.0 or counted < memory[FEWEST]:
                memory[FEWEST] = counted
            memory[BEYOND] += counted - memory[FEWEST]
            node.accept(p, group, v, vdot, a, H1, v1, vdot1)
            H[:] = H1
            return iteration, renewed
        if not increment < DIVERGED:
            break
        previous = increment
    for k in range(3):
        failed[RESIDUAL] = max(failed[RESIDUAL], abs(translation[k]), abs(turning[k]))
    failed[INCREMENT] = increment
    return 0, renewed


@inlined
def act(f: Array, constant: Array, H: Array, twist: Array, row: Array) -> None:
    """Power without what has a potential, force and moment about the origin, into ``row`` (7,)."""
    d1, d2, d3 = load_row(H, 1), load_row(H, 2), load_row(H, 3)
    x, ω = load_row(H, 0), rotate(d1, d2, d3, load(twist, 3))
    u = rotate(d1, d2, d3, load(twist, 0))
    follows = rotate(d1, d2, d3, load(f, 6))
    moment = plus(load(f, 3), rotate(d1, d2, d3, load(f, 9)))
    changing = plus(minus(load(f, 0), load(constant, 0)), follows)
    row[0] = dot(changing, u) + dot(moment, ω)
    force = plus(load(f, 0), follows)
    store(row, 1, force)
    store(row, 4, plus(moment, cross(x, force)))


@inlined
def book(h: float, row: Array, last: Array, total: Array) -> None:
    """Sum up by the trapezoidal rule, shapes (7,); ``row`` becomes the ``last``."""
    for k in range(7):
        total[k] += 0.5 * h * (last[k] + row[k])
        last[k] = row[k]


# --- all bodies ---------------------------------------------------------------------------------


@compiled
def accelerations(
    bodies: Bodies,
    loads: Loads,
    amplitude: Array,
    H: Array,
    v: Array,
    vdot: Array,
) -> None:
    """``v̇`` of all bodies at frames ``H`` with velocities ``v``."""
    mass, J, _, group = bodies
    f = np.empty(12)
    vdot[:] = 0.0
    for i in range(v.shape[0]):
        load_of(loads, amplitude, i, f)
        r, turning = residual(group[i], mass[i], J[i], f, H[i], v[i], vdot[i])
        store(vdot[i], 0, scaled(-1.0 / mass[i], r))
        J1, J2, J3 = load_row(J[i], 0), load_row(J[i], 1), load_row(J[i], 2)
        store(vdot[i], 3, negative(rotate_back(*inverse(J1, J2, J3), turning)))


@compiled
def advance(
    p: Scheme,
    options: Options,
    bodies: Bodies,
    loads: Loads,
    amplitude: Array,
    state: State,
    plan: Plan,
    rows: Kept,
) -> tuple[int, int]:
    """Steps ``first … last`` of all bodies.

    Args:
        p: Parameters of the scheme.
        options: Of the iteration.
        bodies: What they are.
        loads: Their loads.
        amplitude: Of the loads with history, shape (last − first + 1, k).
        state: Of all bodies; updated.
        plan: Which steps.
        rows: What is kept, overwritten.

    Returns:
        The last step that all bodies made, and the number of factorisations.
    """
    always = Options(options.tolerance, options.limit, 1, 0.0, False)
    mass, J, size, group = bodies
    H, v, vdot, a, memory, kept, rates, booked = state
    frames, velocities, done, iterations, failed = rows
    first, last, kept_row, total, every = plan
    end = End(np.empty(6), np.empty((4, 3)), np.empty(6), np.empty(6), np.empty(6))
    f, rate, note = np.empty(12), np.empty(6), np.zeros(3)
    twist, row_now = np.empty(6), np.empty(7)
    factorisations = 0
    for i in range(v.shape[0]):
        own = Scheme(p.h, p.am, p.af, p.gamma, p.beta, p.mass, p.damping, size[i])
        body = Body(group[i], mass[i], J[i])
        here = Start(H[i], v[i], vdot[i], a[i], memory[i], kept[i])
        row = kept_row
        for index in range(first, last + 1):
            load_of(loads, amplitude[index - first], i, f)
            count, made = make_step(own, options, body, f, here, end, note)
            factorisations += made
            if count == 0 and options.rescue:
                count, made = make_step(own, always, body, f, here, end, note)
                factorisations += made
            if count == 0:
                # the others need not go farther than the step before
                last = index - 1
                failed[BODY] = i
                failed[INCREMENT], failed[RESIDUAL] = note[INCREMENT], note[RESIDUAL]
                break
            iterations[index - first] = max(count, iterations[index - first])
            to_local(group[i], here.H, here.v, here.vdot, twist, rate)
            act(f, loads.constant[i], here.H, twist, row_now)
            book(p.h, row_now, rates[i], booked[i])
            if index % every == 0 or index == total:
                frames[row, i], velocities[row, i] = here.H, twist
                done[row - kept_row] += booked[i]
                row += 1
    return last, factorisations


@compiled
def start_books(loads: Loads, amplitude: Array, H: Array, twists: Array, rates: Array) -> None:
    """What acts on each body at the start, see :func:`act`, shape (n, 7)."""
    f = np.empty(12)
    for i in range(twists.shape[0]):
        load_of(loads, amplitude, i, f)
        act(f, loads.constant[i], H[i], twists[i], rates[i])


@compiled
def observe(
    frames: Array,
    velocities: Array,
    blocks: Array,
    constant: Array,
    invariants: Array,
    potential: Array,
) -> None:
    """Energies and momenta of all rows; inertia ``blocks`` (n, 4, 4), loads without history."""
    n = blocks.shape[0]
    indptr, work = np.arange(n + 1), np.empty((2, n, 4, 3))
    kinds = np.zeros(n, dtype=np.int64)
    for row in range(frames.shape[0]):
        values = inertia.invariants(
            kinds, frames[row], velocities[row], indptr, indptr, blocks, work[0], work[1]
        )
        for k in range(7):
            invariants[row, k] = values[k]
        potential[row] = 0.0
        for i in range(n):
            potential[row] -= dot(load(constant[i], 0), load_row(frames[row, i], 0))
