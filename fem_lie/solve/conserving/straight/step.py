"""Balances of a step of nodes that are no frames, and its end as the start of the next; compiled.

Formulas in :mod:`fem_lie.solve.conserving.energy_momentum`; ``q`` are the rows whose increments
add, so that ``L`` is constant.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from fem_lie._arrays import Array, Flags
from fem_lie._jit import compiled, inlined
from fem_lie.bodies.balances import BY_LOADS, BY_REACTIONS, DAMPING, WORK
from fem_lie.lie.kinds import inertia
from fem_lie.lie.kinds.forces import wrench
from fem_lie.lie.kinds.kind import SLOPE, axes, carry, first, straight
from fem_lie.lie.kinds.motion import from_local, to_local
from fem_lie.lie.tuples import (
    combined,
    dot,
    load,
    load_row,
    plus,
    rotate,
    rotate_back,
    scaled,
    store,
    store_row,
)
from fem_lie.lie.wrenches import add_dead, add_wrench
from fem_lie.solve.conserving.straight.cells import Energies, Nodes, add_elastic
from fem_lie.solve.conserving.straight.records import (
    ENERGY,
    LEAK,
    LIMIT,
    SQUARES,
    Model,
    State,
    Step,
)
from fem_lie.solve.conserving.straight.rows import gathered, spread

_ULP = float(np.finfo(np.float64).eps)


@inlined
def _hold(kind: int, H: Array, held: Flags, step: Array) -> None:
    """Take what is held out of increments (6,)."""
    any_held = False
    for k in range(6):
        any_held = any_held or held[k]
    if any_held:
        d1, d2, d3 = axes(kind, H)
        for at in (0, 3):
            a = rotate_back(d1, d2, d3, load(step, at))
            a = (
                0.0 if held[at] else a[0],
                0.0 if held[at + 1] else a[1],
                0.0 if held[at + 2] else a[2],
            )
            store(step, at, rotate(d1, d2, d3, a))


@compiled
def predict(model: Model, state: State, h: float, out: Array) -> None:
    """Increments (n, 6) of a step with the acceleration of the last one."""
    for i in range(out.shape[0]):
        for k in range(6):
            out[i, k] = h * (state.V[i, k] + h * state.trend[i, k])
        _hold(model.kinds[i], state.H[i], model.held[i], out[i])


@compiled
def correct(model: Model, state: State, this: Step, x: Array) -> None:
    """Subtract the solution ``x`` (6 n + m,), along the axes in the middle, from the step."""
    for i in range(this.step.shape[0]):
        d1, d2, d3 = axes(model.kinds[i], this.mean[i])
        for at in (0, 3):
            change = rotate(d1, d2, d3, load(x, 6 * i + at))
            store(this.step[i], at, combined(1.0, load(this.step[i], at), -1.0, change))
        _hold(model.kinds[i], state.H[i], model.held[i], this.step[i])
    first_weight = 6 * this.step.shape[0]
    for c in range(state.weights.shape[0]):
        # twice the balance has twice the forces of joints
        state.weights[c] -= 0.5 * state.scale[c] * x[first_weight + c]


@compiled
def move(model: Model, state: State, this: Step, h: float) -> None:
    """Rows in the middle and at the end of the step, rates at its end; no forces, empty books."""
    step, half = this.step, np.empty(6)
    this.losses[:] = 0.0
    this.outer[:] = 0.0
    for i in range(step.shape[0]):
        for k in range(6):
            half[k] = 0.5 * step[i, k]
            this.V1[i, k] = 2.0 / h * step[i, k] - state.V[i, k]
        carry(model.kinds[i], state.H[i], half, this.mean[i])
        carry(model.kinds[i], state.H[i], step[i], this.end[i])


@compiled
def mean_rates(model: Model, this: Step, h: float, out: Array) -> None:
    """Mean velocities (n, 6) along the axes of the nodes in the middle of the step."""
    for i in range(out.shape[0]):
        d1, d2, d3 = axes(model.kinds[i], this.mean[i])
        for at in (0, 3):
            rate = scaled(1.0 / h, load(this.step[i], at))
            store(out[i], at, rotate_back(d1, d2, d3, rate))


@compiled
def add_viscous(model: Model, this: Step, h: float, rates: Array, forces: Array) -> None:
    """Add forces (n, 6) along these axes, at these velocities, and book what they take.

    They do not oppose rigid motions: these are motions of the middle of the step, by
    ``ω × r̄``, however far the step turns.
    """
    for i in range(rates.shape[0]):
        d1, d2, d3 = axes(model.kinds[i], this.mean[i])
        for at in (0, 3):
            f = load(forces[i], at)
            this.losses[DAMPING] += h * dot(f, load(rates[i], at))
            store(this.outer[i], at, plus(load(this.outer[i], at), rotate(d1, d2, d3, f)))


@compiled
def residual(model: Model, state: State, this: Step, h: float) -> None:
    """Twice the balance of momenta over the step, along the axes in the middle, into ``this.r``.

    Nodes have moved, and the outer forces are there.
    """
    kinds, (step, mean, end), forces, q = model.kinds, this[:3], this.forces, this.q
    n = step.shape[0]
    for i in range(n):
        for k in range(6):
            forces[i, k] = (this.V1[i, k] - state.V[i, k]) / h
    spread(kinds, forces, q[0])
    inertia.multiply(model.inertia.indptr, model.inertia.indices, model.inertia.blocks, q[0], q[1])
    for i in range(n):
        for k in range(4):
            for j in range(3):
                q[1, i, k, j] -= model.dead[i, k, j]
                own = model.dead[i, k, j] - model.conservative[i, k, j]
                this.losses[WORK] += own * (end[i, k, j] - state.H[i, k, j])
        add_dead(this.losses, BY_LOADS, 1.0, mean[i], model.dead[i])
    if model.damping.indptr.shape[0] > 0:
        _add_damping(model, this, h)
    gathered(kinds, q[1], forces)
    for i in range(n):
        for k in range(6):
            forces[i, k] += state.carry[i, k] + this.outer[i, k]
    _add_elastic(model, state, this)
    for i in range(n):
        _balance(i, model, this)
    for c in range(state.gap.shape[0]):
        this.r[6 * n + c] = state.scale[c] * (state.gap[c] + this.change[c])


@compiled
def _add_damping(model: Model, this: Step, h: float) -> None:
    """Add to rates of momenta ``q[1]`` what goes with mass, at the mean velocity of the step."""
    D, f, rates = model.damping, np.empty_like(this.mean), np.empty_like(this.step)
    for i in range(rates.shape[0]):
        for k in range(6):
            rates[i, k] = this.step[i, k] / h
    spread(model.kinds, rates, this.q[0])
    inertia.multiply(D.indptr, D.indices, D.blocks, this.q[0], f)
    this.losses[DAMPING] += h * np.sum(this.q[0] * f)
    for i in range(f.shape[0]):
        add_dead(this.losses, BY_LOADS, -1.0, this.mean[i], f[i])
        for k in range(4):
            for j in range(3):
                this.q[1, i, k, j] += f[i, k, j]


@compiled
def _add_elastic(model: Model, state: State, this: Step) -> None:
    count = max(this.W1.shape[0], 1)
    unknown, squares = _ULP * state.told[ENERGY] / count, state.told[SQUARES]
    repay = 0.0
    if squares > 0.0:
        # a force of the whole size turns its sign with a deformation that is noise, and keeps it up
        most = 0.1 * state.told[LIMIT] / sqrt(squares)
        repay = max(-most, min(most, state.told[LEAK] / squares))
    nodes = Nodes(state.H, state.rest, this.step)
    energies = Energies(state.W, state.account, this.W1, this.work)
    factors = repay, squares / count, unknown
    this.told[0], this.told[1] = (
        add_elastic(model.cells, nodes, energies, factors, this.forces),
        repay,
    )


@inlined
def _balance(i: int, model: Model, this: Step) -> None:
    """Of one node, with loads along its axes; what holds it is a reaction."""
    kind, m, r = model.kinds[i], this.mean[i], this.r[6 * i : 6 * i + 6]
    (d1, d2, d3), f = axes(kind, m), model.following[i]
    any_held = False
    for at in (0, 3):
        push = rotate(d1, d2, d3, load(f, at))
        store(this.forces[i], at, combined(1.0, load(this.forces[i], at), -1.0, push))
        for j in range(3):
            this.losses[WORK] += push[j] * this.step[i, at + j]
        store(r, at, rotate_back(d1, d2, d3, load(this.forces[i], at)))
    force, moment = wrench(kind, m, f)
    add_wrench(this.losses, BY_LOADS, load_row(m, 0), force, moment)
    for k in range(6):
        any_held = any_held or model.supported[i, k]
    if any_held:
        own = np.zeros(6)
        for k in range(6):
            own[k] = r[k] if model.supported[i, k] else 0.0
        force, moment = wrench(kind, m, own)
        add_wrench(this.losses, BY_REACTIONS, load_row(m, 0), force, moment)
    for k in range(6):
        r[k] = 0.0 if model.held[i, k] else 2.0 * r[k]


@compiled
def accept(model: Model, state: State, this: Step, h: float) -> None:
    """Make the end of the step the start of the next one."""
    kinds, books, told, losses = model.kinds, state.books, state.told, this.losses
    gain = square = 0.0
    for i in range(kinds.shape[0]):
        d1, d2, d3 = axes(kinds[i], this.mean[i])
        for at in (0, 3):
            left = rotate(d1, d2, d3, load(this.r, 6 * i + at))
            for j in range(3):
                f = 0.5 * left[j]
                gain += (f - state.carry[i, at + j]) * this.step[i, at + j]
                square += f * f
                state.carry[i, at + j] = f
        _move(kinds[i], state.H[i], state.rest[i], this.step[i], this.end[i])
        for k in range(6):
            rate = this.V1[i, k] - state.V[i, k]
            state.trend[i, k] = 0.5 * rate / h
            state.V[i, k] = this.V1[i, k]
    told[LEAK] += gain - this.told[1] * this.told[0]
    told[SQUARES], told[LIMIT] = this.told[0], sqrt(square)
    books[WORK] += losses[WORK]
    books[DAMPING] += losses[DAMPING]
    for k in range(BY_LOADS, books.shape[0]):
        books[k] += h * losses[k]
    spread(kinds, state.V, this.q[0])
    inertia.multiply(
        model.inertia.indptr, model.inertia.indices, model.inertia.blocks, this.q[0], this.q[1]
    )
    energy = 0.5 * np.sum(this.q[0] * this.q[1])
    for e in range(state.W.shape[0]):
        state.W[e] = this.W1[e]
        state.account[e] += this.work[e]
        energy += this.W1[e]
    told[ENERGY] = max(told[ENERGY], energy)
    for c in range(state.gap.shape[0]):
        state.gap[c] += this.change[c]


@inlined
def _move(kind: int, H: Array, rest: Array, step: Array, end: Array) -> None:
    """Straight rows as compensated sums, with axes as at the end."""
    at = first(kind)
    for k in range(straight(kind)):
        for j in range(3):
            term = step[3 * k + j] + rest[at + k, j]
            total = H[at + k, j] + term
            # a row may be smaller than the term: Knuth's sum, not Dekker's
            part = total - H[at + k, j]
            rest[at + k, j] = (H[at + k, j] - (total - part)) + (term - part)
            H[at + k, j] = total
    if kind == SLOPE:
        store_row(H, 2, load_row(end, 2))
        store_row(H, 3, load_row(end, 3))


@compiled
def twists(model: Model, state: State, rates: Array, v: Array, a: Array) -> None:
    """Velocities and their rates (n, 6) along the axes of the nodes, from ``rates`` of halves."""
    for i in range(v.shape[0]):
        to_local(model.kinds[i], state.H[i], state.V[i], rates[i], v[i], a[i])


@compiled
def spatial_rates(model: Model, state: State, rates: Array, out: Array) -> None:
    """Inverse of :func:`twists`, for the accelerations: halves (n, 6) along global axes."""
    v, still, own = np.empty(6), np.empty(6), np.empty(6)
    for i in range(out.shape[0]):
        to_local(model.kinds[i], state.H[i], state.V[i], out[i], v, still)
        from_local(model.kinds[i], state.H[i], v, rates[i], own, out[i])
