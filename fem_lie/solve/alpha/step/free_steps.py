"""Steps of all free rigid bodies, one body after the other, with loads and rows of results."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled, inlined
from fem_lie.lie.motions import to_local
from fem_lie.lie.node_types import inertia
from fem_lie.lie.tuples import (
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
)
from fem_lie.solve.alpha.step.free_body import (
    BODY,
    INCREMENT,
    RESIDUAL,
    Bodies,
    Body,
    End,
    Loads,
    Options,
    Plan,
    ResultRows,
    Start,
    State,
    inverse,
    make_step,
    residual,
)
from fem_lie.solve.alpha.step.node import Scheme


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
def act(f: Array, constant: Array, H: Array, twist: Array, row: Array) -> None:
    """Power of non-conservative loads, force and moment about the origin, into ``row`` (7,)."""
    d1, d2, d3 = load_row(H, 1), load_row(H, 2), load_row(H, 3)
    x, ω = load_row(H, 0), rotate(d1, d2, d3, load(twist, 3))
    u = rotate(d1, d2, d3, load(twist, 0))
    follower = rotate(d1, d2, d3, load(f, 6))
    moment = plus(load(f, 3), rotate(d1, d2, d3, load(f, 9)))
    changing = plus(minus(load(f, 0), load(constant, 0)), follower)
    row[0] = dot(changing, u) + dot(moment, ω)
    force = plus(load(f, 0), follower)
    store(row, 1, force)
    store(row, 4, plus(moment, cross(x, force)))


@inlined
def add_to_balance(h: float, row: Array, last: Array, total: Array) -> None:
    """Add to ``total`` by the trapezoidal rule, shapes (7,); ``row`` becomes ``last``."""
    for k in range(7):
        total[k] += 0.5 * h * (last[k] + row[k])
        last[k] = row[k]


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
    rows: ResultRows,
) -> tuple[int, int]:
    """Make steps ``first … last`` of all bodies.

    Args:
        p: Parameters of the scheme.
        options: Options of the iteration.
        bodies: Properties of the bodies.
        loads: Loads on the bodies.
        amplitude: Amplitudes of the loads with history, shape (last − first + 1, k).
        state: State of all bodies; updated.
        plan: Steps to make and to record.
        rows: Arrays of results, overwritten.

    Returns:
        The last step that all bodies made, and the number of factorisations.
    """
    always = Options(options.tolerance, options.limit, 1, 0.0, False)
    mass, J, scaling, group = bodies
    H, v, vdot, a, convergence, kept, rates, balance = state
    frames, velocities, done, iterations, failed = rows
    first, last, kept_row, total, every = plan
    end = End(np.empty(6), np.empty((4, 3)), np.empty(6), np.empty(6), np.empty(6))
    f, rate, note = np.empty(12), np.empty(6), np.zeros(3)
    twist, row_now = np.empty(6), np.empty(7)
    factorisations = 0
    for i in range(v.shape[0]):
        body = Body(group[i], mass[i], J[i], scaling[i])
        here = Start(H[i], v[i], vdot[i], a[i], convergence[i], kept[i])
        row = kept_row
        for index in range(first, last + 1):
            load_of(loads, amplitude[index - first], i, f)
            count, made = make_step(p, options, body, f, here, end, note)
            factorisations += made
            if count == 0 and options.full_newton_fallback:
                count, made = make_step(p, always, body, f, here, end, note)
                factorisations += made
            if count == 0:
                # the other bodies need not go beyond the previous step
                last = index - 1
                failed[BODY] = i
                failed[INCREMENT], failed[RESIDUAL] = note[INCREMENT], note[RESIDUAL]
                break
            iterations[index - first] = max(count, iterations[index - first])
            to_local(group[i], here.H, here.v, here.vdot, twist, rate)
            act(f, loads.constant[i], here.H, twist, row_now)
            add_to_balance(p.h, row_now, rates[i], balance[i])
            if index % every == 0 or index == total:
                frames[row, i], velocities[row, i] = here.H, twist
                done[row - kept_row] += balance[i]
                row += 1
    return last, factorisations


@compiled
def start_balance(loads: Loads, amplitude: Array, H: Array, twists: Array, rates: Array) -> None:
    """Power, force and moment of loads at the start, see :func:`act`, shape (n, 7)."""
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
    """Energies and momenta of all stored states.

    Inertia ``blocks`` (n, 4, 4), constant loads without history.
    """
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
