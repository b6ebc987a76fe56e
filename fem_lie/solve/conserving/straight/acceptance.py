"""The end of a step as the start of the next one, for nodes of any kind; compiled."""

from __future__ import annotations

from math import sqrt

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled, inlined
from fem_lie.bodies.balances import BY_LOADS, DAMPING, NUMERICAL, WORK
from fem_lie.lie.kinds import inertia
from fem_lie.lie.kinds.kind import SLOPE, axes, first, straight
from fem_lie.lie.tuples import cross, load, load_row, minus, rotate, scaled, store, store_row
from fem_lie.solve.conserving.between.cayley import advance, left_moment
from fem_lie.solve.conserving.step.dissipation import REMEMBERS, remember
from fem_lie.solve.conserving.straight.nodes import rates_of
from fem_lie.solve.conserving.straight.records import (
    ENERGY,
    LEAK,
    LIMIT,
    SQUARES,
    Model,
    State,
    Step,
)


@compiled
def accept(model: Model, state: State, this: Step, h: float) -> None:
    """Make the end of the step the start of the next one."""
    books, told, losses = state.books, state.told, this.losses
    _keep_what_is_left(model, state, this)
    if model.loss > 0.0:
        _learn(model, state, this)
    for i in range(model.kinds.shape[0]):
        _advance(i, model, state, this, h)
    books[WORK] += losses[WORK]
    books[DAMPING] += losses[DAMPING]
    books[NUMERICAL] += losses[NUMERICAL]
    for k in range(BY_LOADS, books.shape[0]):
        books[k] += h * losses[k]
    M, q = model.inertia, this.q[1]
    inertia.multiply(M.indptr, M.indices, M.blocks, state.V, q)
    energy = 0.5 * np.sum(state.V * q)
    for e in range(state.W.shape[0]):
        state.W[e] = this.W1[e]
        state.account[e] += this.work[e]
        energy += this.W1[e]
    state.F[:] = this.F1
    told[ENERGY] = max(told[ENERGY], energy)
    for c in range(state.gap.shape[0]):
        state.gap[c] += this.change[c]


@inlined
def _learn(model: Model, state: State, this: Step) -> None:
    """Remember changes of velocities and forces, see :mod:`..step.dissipation`."""
    lag, n = state.lag, model.kinds.shape[0]
    # the first step knows of no change before
    μ = model.learning if lag[REMEMBERS] > 0.0 else 1.0
    lag[REMEMBERS] = 1.0
    remember(lag, μ)
    for i in range(n):
        for k in range(4):
            for j in range(3):
                old = state.w[i, k, j]
                state.w[i, k, j] = old + μ * (this.V1[i, k, j] - state.V[i, k, j] - old)
    for place in range(this.F1.shape[0]):
        for k in range(6):
            old = state.w_F[place, k]
            change = this.F1[place, k] - state.F[place, k]
            state.w_F[place, k] = old + μ * (change - old)
    state.lasting[0] = this.lasting[0]
    state.lasting[1] = this.lasting[2] + μ * (this.lasting[1] - this.lasting[2])


@inlined
def _keep_what_is_left(model: Model, state: State, this: Step) -> None:
    """Forces and energy that the next step makes up for."""
    told, left = state.told, np.empty(6)
    gain, square, share = 0.0, 0.0, 0.5 * (1.0 + model.loss * state.lag[REMEMBERS])
    for i in range(model.kinds.shape[0]):
        kind = model.kinds[i]
        d1, d2, d3 = axes(kind, this.middle[i])
        for at in (0, 3):
            store(left, at, scaled(share, rotate(d1, d2, d3, load(this.r, 6 * i + at))))
        before, u = state.carry[i], load(this.step[i], 0)
        if kind < SLOPE:
            store(before, 3, left_moment(load(before, 3), load(before, 0), u))
        for k in range(6):
            gain += (left[k] - before[k]) * this.step[i, k]
            force = left[k] / model.arms[i, k // 3]
            square += force * force if k < 3 or kind >= SLOPE else 0.0
            before[k] = left[k]
        if kind < SLOPE:
            moment = minus(load(left, 3), cross(scaled(0.5, u), load(left, 0)))
            store(before, 3, moment)
    told[LEAK] += gain - this.told[1] * this.told[0]
    told[SQUARES], told[LIMIT] = this.told[0], sqrt(square)


@inlined
def _advance(i: int, model: Model, state: State, this: Step, h: float) -> None:
    """One node, and its rates."""
    kind, rates = model.kinds[i], np.empty(6)
    if kind < SLOPE:
        one = slice(i, i + 1)
        advance(state.H[one], state.rest[one], this.delta[one])
    else:
        _move(kind, state.H[i], state.rest[i], this.step[i], this.end[i])
    for k in range(4):
        for j in range(3):
            state.V[i, k, j] = this.V1[i, k, j]
    rates_of(kind, state.H[i], state.V[i], rates)
    for k in range(6):
        state.trend[i, k] = (rates[k] - this.step[i, k] / h) / h


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
