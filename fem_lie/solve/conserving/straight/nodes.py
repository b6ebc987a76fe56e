"""How nodes of any kind move within a step: prediction, corrections, means and rates; compiled.

Frames turn by Cayley's map (:mod:`fem_lie.solve.conserving.between.cayley`), and rows of other
nodes go straight on.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Flags
from fem_lie._jit import compiled, inlined, uncounted
from fem_lie._jit.stack import stack, vector_at
from fem_lie.lie.kinds import inertia
from fem_lie.lie.kinds.kind import SLOPE, axes, carry
from fem_lie.lie.kinds.motion import from_local, to_local
from fem_lie.lie.tuples import (
    Vector,
    combined,
    cross,
    load,
    load_row,
    minus,
    plus,
    rotate,
    rotate_back,
    scaled,
    store,
    store_row,
)
from fem_lie.solve.conserving.between.cayley import span, spin
from fem_lie.solve.conserving.rows.halves import gathered, spread
from fem_lie.solve.conserving.step.dissipation import REMEMBERS
from fem_lie.solve.conserving.step.products import begin_products
from fem_lie.solve.conserving.straight.records import Model, State, Step, products_of


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


@inlined
def rates_of(kind: int, H: Array, V: Array, out: Array) -> None:
    """Rates (6,) of increments, from those of the rows (4, 3)."""
    if kind < SLOPE:
        store(out, 0, load_row(V, 0))
        store(out, 3, spin(H, V))
    else:
        out[:] = 0.0
        gathered(kind, V, out)


@compiled
def predict(model: Model, state: State, this: Step, h: float) -> None:
    """Increments of a step with the acceleration of the last one."""
    rates = np.empty(6)
    if model.loss * state.lag[REMEMBERS] > 0.0:
        begin_products(model.inertia, state.V, state.w, products_of(this))
    out = this.step
    for i in range(out.shape[0]):
        rates_of(model.kinds[i], state.H[i], state.V[i], rates)
        for k in range(6):
            out[i, k] = h * (rates[k] + h * state.trend[i, k])
        _hold(model.kinds[i], state.H[i], model.held[i], out[i])


@compiled
def correct(model: Model, state: State, this: Step, x: Array) -> None:
    """Subtract the solution ``x`` (6 n + m,), along the axes in the middle, from the step."""
    for i in range(this.step.shape[0]):
        d1, d2, d3 = axes(model.kinds[i], this.middle[i])
        for at in (0, 3):
            change = rotate(d1, d2, d3, load(x, 6 * i + at))
            store(this.step[i], at, combined(1.0, load(this.step[i], at), -1.0, change))
        _hold(model.kinds[i], state.H[i], model.held[i], this.step[i])
    first_weight = 6 * this.step.shape[0]
    share = 0.5 * (1.0 + model.loss * state.lag[REMEMBERS])
    for c in range(state.weights.shape[0]):
        # the balance has 2/(1 + χ) times the forces of joints
        state.weights[c] -= share * state.scale[c] * x[first_weight + c]


@compiled
def move(model: Model, state: State, this: Step, h: float) -> None:
    """Nodes in the middle and at the end of the step, rates at its end; no forces, empty books."""
    this.losses[:] = 0.0
    this.outer[:] = 0.0
    _move_all(model, state, this, h)


@uncounted
def _move_all(model: Model, state: State, this: Step, h: float) -> None:
    """The nodes alone."""
    step, half = this.step, vector_at(stack(6), 6)
    for i in range(step.shape[0]):
        kind, one = model.kinds[i], slice(i, i + 1)
        if kind < SLOPE:
            rows = this.delta[one], this.mean[one], this.end[one], this.middle[one]
            span(state.H[one], step[one], rows[0], rows[1], rows[2], rows[3])
        else:
            for k in range(6):
                half[k] = 0.5 * step[i, k]
            carry(kind, state.H[i], half, this.middle[i])
            carry(kind, state.H[i], step[i], this.end[i])
            for k in range(4):
                store_row(this.mean[i], k, load_row(this.middle[i], k))
            spread(kind, step[i], this.delta[i])
        for k in range(4):
            for j in range(3):
                this.V1[i, k, j] = 2.0 / h * this.delta[i, k, j] - state.V[i, k, j]


@compiled
def mean_rates(model: Model, this: Step, h: float, out: Array) -> None:
    """Mean velocities (n, 6) along the axes of the nodes in the middle of the step."""
    for i in range(out.shape[0]):
        d1, d2, d3 = axes(model.kinds[i], this.middle[i])
        for at in (0, 3):
            rate = scaled(1.0 / h, load(this.step[i], at))
            store(out[i], at, rotate_back(d1, d2, d3, rate))


@inlined
def _turned(H: Array, a: Vector) -> Vector:
    return rotate(load_row(H, 1), load_row(H, 2), load_row(H, 3), a)


@compiled
def twists(model: Model, H: Array, V: Array, rates: Array, v: Array, a: Array) -> None:
    """Velocities and their rates (n, 6) along the axes of nodes ``H``.

    Args:
        model: The scene.
        H: Nodes.
        V: Rates of all rows, (n, 4, 3).
        rates: Of the rates of increments, (n, 6).
        v: Overwritten.
        a: Overwritten.
    """
    own = np.empty(6)
    inertia.local_twists(H, V, model.turning, v)
    for i in range(v.shape[0]):
        kind = model.kinds[i]
        if kind < SLOPE:
            d1, d2, d3 = load_row(H[i], 1), load_row(H[i], 2), load_row(H[i], 3)
            for at in (0, 3):
                store(a[i], at, rotate_back(d1, d2, d3, load(rates[i], at)))
            store(a[i], 0, minus(load(a[i], 0), cross(load(v[i], 3), load(v[i], 0))))
        else:
            rates_of(kind, H[i], V[i], own)
            to_local(kind, H[i], own, rates[i], v[i], a[i])


@compiled
def spatial_rates(model: Model, state: State, rates: Array, out: Array) -> None:
    """Inverse of :func:`twists`, for the accelerations: of increments, (n, 6)."""
    v, own, still = np.empty((out.shape[0], 6)), np.empty(6), np.zeros_like(out)
    unused = np.empty_like(out)
    twists(model, state.H, state.V, still, v, unused)
    for i in range(out.shape[0]):
        if model.kinds[i] < SLOPE:
            moved = plus(load(rates[i], 0), cross(load(v[i], 3), load(v[i], 0)))
            store(out[i], 0, _turned(state.H[i], moved))
            store(out[i], 3, _turned(state.H[i], load(rates[i], 3)))
        else:
            from_local(model.kinds[i], state.H[i], v[i], rates[i], own, out[i])
