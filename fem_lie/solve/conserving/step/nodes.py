"""How nodes move within a step: the prediction, and each correction of it."""

from __future__ import annotations

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined, linked, uncounted
from fem_lie._jit.stack import stack, vector_at
from fem_lie.forms.fixed_arrays import put
from fem_lie.lie.kinds.kind import axes
from fem_lie.lie.tuples import (
    Vector,
    combined,
    load,
    minus,
    rotate,
    rotate_back,
    store,
)
from fem_lie.solve.conserving.between.any_node import rates_of
from fem_lie.solve.conserving.step.dissipation import REMEMBERS, set_turnings
from fem_lie.solve.conserving.step.joints import border_at
from fem_lie.solve.conserving.step.packing import PackedModel, model_of, state_of, step_of
from fem_lie.solve.conserving.step.products import begin_products
from fem_lie.solve.conserving.step.records import products_of, solution_of, span_of


@linked
def packed_begin(model: PackedModel, state: Indices, step: Indices) -> float:
    """:func:`begin`, from Python."""
    return begin(model, state, step)


@uncounted
def begin(packed: PackedModel, starts: Indices, steps: Indices) -> float:
    """Predict the step; returns the size of its largest motion.

    Records are :class:`~fem_lie.solve.conserving.step.packing.Packed`, here and below: what is not
    read of them is not passed.
    """
    model, state, this = model_of(packed), state_of(starts), step_of(steps)
    H, V, trend, step, scheme = state.H, state.V, state.trend, this.step, model.scheme
    put(V, this.V1)
    put(state.weights, this.weights)
    if scheme.loss * state.lag[REMEMBERS] > 0.0:
        begin_products(model.inertia, V, state.w, products_of(this))
    h = scheme.h
    ahead, largest, rates = h * h, 0.0, vector_at(stack(6), 6)
    for i in range(step.shape[0]):
        rates_of(model.kinds[i], H[i], V[i], rates)
        u = combined(h, load(rates, 0), ahead, load(trend[i], 0))
        ψ = combined(h, load(rates, 3), ahead, load(trend[i], 3))
        hold(model.kinds[i], H[i], model.held[i], u, ψ, step[i])
        for k in range(6):
            largest = max(largest, abs(step[i, k]) * model.measure[6 * i + k])
    return largest


@inlined
def hold(kind: int, H: Array, held: Indices, u: Vector, ψ: Vector, step: Array) -> None:
    """``step = (u, ψ)`` without its parts along the held axes of the node."""
    any_held = False
    for k in range(6):
        any_held = any_held or held[k] != 0
    if any_held:
        d1, d2, d3 = axes(kind, H)
        a, b = rotate_back(d1, d2, d3, u), rotate_back(d1, d2, d3, ψ)
        a = (0.0 if held[0] else a[0], 0.0 if held[1] else a[1], 0.0 if held[2] else a[2])
        b = (0.0 if held[3] else b[0], 0.0 if held[4] else b[1], 0.0 if held[5] else b[2])
        u, ψ = rotate(d1, d2, d3, a), rotate(d1, d2, d3, b)
    store(step, 0, u)
    store(step, 3, ψ)


@uncounted
def compare(packed: PackedModel, starts: Indices, steps: Indices) -> None:
    """What of the step as it is is not in the matrix: its constraints, and rotations of Π."""
    model, state, this = model_of(packed), state_of(starts), step_of(steps)
    along, change, legs, scheme = span_of(this.rows), this.border, model.legs, model.scheme
    if this.turnings.shape[1] > 0:
        χ, frames = scheme.loss * state.lag[REMEMBERS], (model.kinds, along.mean, along.middle)
        set_turnings(products_of(this), frames, model.held, χ, scheme.h, this.turnings)
    if legs.nodes.shape[0] == 0:
        return
    frames_at = along.end, along.middle, along.middle
    border_at(model.joints, legs, model.kinds, model.held, frames_at, change)
    for side in range(2):
        for leg in range(change.shape[1]):
            for k in range(6):
                change[side, leg, k] -= state.border[side, leg, k]


@linked
def packed_correct(model: PackedModel, state: Indices, step: Indices) -> None:
    """:func:`correct`, from Python."""
    correct(model, state, step)


@uncounted
def correct(packed: PackedModel, starts: Indices, steps: Indices) -> None:
    """Apply the correction."""
    model, state, this = model_of(packed), state_of(starts), step_of(steps)
    χ = model.scheme.loss * state.lag[REMEMBERS]
    H, weights, held, scale = state.H, state.weights, model.held, model.scale
    kinds = model.kinds
    step, middle, x = this.step, span_of(this.rows).middle, solution_of(this.r).x
    n = step.shape[0]
    for i in range(n):
        (d1, d2, d3), dx = axes(kinds[i], middle[i]), x[6 * i : 6 * i + 6]
        u = minus(load(step[i], 0), rotate(d1, d2, d3, load(dx, 0)))
        ψ = minus(load(step[i], 3), rotate(d1, d2, d3, load(dx, 3)))
        hold(kinds[i], H[i], held[i], u, ψ, step[i])
    for c in range(weights.shape[0]):
        # the residual has 2/(1 + χ) times the forces, the matrix one times their derivatives
        weights[c] -= 0.5 * (1.0 + χ) * scale[c] * x[6 * n + c]
