"""Acceptance of a step of a conserving scheme: its end becomes the start of the next one."""

from __future__ import annotations

from math import sqrt

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined, linked, uncounted
from fem_lie._jit.records import Record
from fem_lie._jit.stack import stack, vector_at
from fem_lie.bodies.balances import BY_LOADS, DAMPING, NUMERICAL, WORK
from fem_lie.joints.equations.joint_arrays import joint_arrays
from fem_lie.joints.equations.terms import unwrap
from fem_lie.lie.node_types import inertia
from fem_lie.lie.node_types.forces import wrench
from fem_lie.lie.node_types.node_type import POSITION_GRADIENT, axes
from fem_lie.lie.tuples import (
    add_dead,
    add_wrench,
    combined,
    cross,
    dot,
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
from fem_lie.solve.conserving.midpoint.any_node import (
    go_along_edge,
    keep_axes,
    rates_of,
    turned_with,
)
from fem_lie.solve.conserving.midpoint.cayley import advance, left_moment, spin
from fem_lie.solve.conserving.midpoint.reduced_bodies import STRESS
from fem_lie.solve.conserving.step.dissipation import remember
from fem_lie.solve.conserving.step.packing import model_of, state_of, step_of
from fem_lie.solve.conserving.step.ranks import Ranks, add_up, ranks_of
from fem_lie.solve.conserving.step.records import Model, State, Step, solution_of, span_of
from fem_lie.system.nodes.masses import Loads


@linked
def packed_accept(model: Indices, state: Indices, step: Indices) -> None:
    """:func:`accept`, from Python."""
    accept(model, state, step)


@uncounted
def accept(packed: Indices, starts: Indices, steps: Indices) -> None:
    """Make the end of the step the start of the next one."""
    model, state, this = model_of(packed), state_of(starts), step_of(steps)
    H, V, filter_state, balance, account = (
        state.H,
        state.V,
        state.filter_state[0],
        state.balance,
        state.account,
    )
    step, V1, F1, losses, scheme = this.step, this.V1, this.F1, this.losses, model.scheme
    end, _, middle, delta = span_of(this.coordinates)
    n, (h, χ, μ) = step.shape[0], scheme
    share = 0.5 * (1.0 + χ * filter_state.active)
    given = model.kinds, model.arms, middle, step, solution_of(this.r).residual
    ranks = ranks_of(model, this)
    _store_residual(*given, share, filter_state, state.last_residual, ranks)
    if χ > 0.0:
        # in the first step there is no earlier change
        μ = μ if filter_state.active > 0.0 else 1.0
        filter_state.active = 1.0
        remember(filter_state, μ)
        _learn(μ, V, V1, state.w)
        for row in range(F1.shape[0]):
            for k in range(6):
                old = state.w_F[row, k]
                state.w_F[row, k] = old + μ * (F1[row, k] - state.F[row, k] - old)
        _learn_of_vector_cells(μ, this.cell_forces, state.cell_forces)
        for a in range(state.within.shape[0]):
            state.within[a] += μ * (this.within[STRESS, a] - state.within[a])
    work = _work_of_loads(
        model.kinds, model.loads, model.conservative, this.coordinates, step, losses
    )
    work += _work_on_products(model, this)
    balance[WORK] += losses[WORK] + work
    balance[DAMPING] += losses[DAMPING]
    balance[NUMERICAL] += losses[NUMERICAL]
    for k in range(BY_LOADS, balance.shape[0]):
        balance[k] += h * losses[k]
    advance(H[:n], state.rest, delta[:n])
    keep_axes(model.kinds, end, H)
    for i in range(n, H.shape[0]):
        for k in range(4):
            store_row(H[i], k, load_row(end[i], k))
    unwrap(H, joint_arrays(model.joints))
    unwrap(H, joint_arrays(model.probes))
    for i in range(V.shape[0]):
        for k in range(4):
            store_row(V[i], k, load_row(V1[i], k))
    mass, momenta = model.inertia, this.q[1]
    inertia.multiply(mass.indptr, mass.indices, mass.blocks, V, momenta)
    energy = vector_at(stack(1), 1)
    energy[0] = 0.5 * _product(V, momenta) + np.sum(this.W1)
    add_up(ranks, energy)
    filter_state.energy = max(filter_state.energy, energy[0])
    _set_massless_rates(model.light, H, step, h, V)
    _keep_trend(model.kinds, H, V, h, step, state)
    for row in range(F1.shape[0]):
        for k in range(6):
            state.F[row, k] = F1[row, k]
    for e in range(account.shape[0]):
        state.W[e] = this.W1[e]
        account[e] += this.work[e]
    _go_along_edges(packed, starts, steps)
    sizes, earlier = state.sizes, state.earlier
    sizes[2], sizes[1], sizes[0] = sizes[1], sizes[0], h
    for c in range(state.gap.shape[0]):
        state.gap[c] += this.change[c]
        earlier[1, c], earlier[0, c] = earlier[0, c], this.multipliers[c]


@uncounted
def _set_massless_rates(light: Array, H: Array, step: Array, h: float, V: Array) -> None:
    """Give rotations without inertia their mean rate in the step.

    Nothing balances their rates at its end, ``2 Δ/h − V``, whose sign would alternate from step to
    step.
    """
    for i in range(light.shape[0]):
        d1, d2, d3 = load_row(H[i], 1), load_row(H[i], 2), load_row(H[i], 3)
        missing = minus(scaled(1.0 / h, load(step[i], 3)), spin(H[i], V[i]))
        own, P = rotate_back(d1, d2, d3, missing), light[i]
        part = dot(load_row(P, 0), own), dot(load_row(P, 1), own), dot(load_row(P, 2), own)
        added = rotate(d1, d2, d3, part)
        for k in range(1, 4):
            store_row(V[i], k, plus(load_row(V[i], k), cross(added, load_row(H[i], k))))


@uncounted
def _go_along_edges(packed: Indices, starts: Indices, steps: Indices) -> None:
    """Rotate frames onto their edges, together with vectors along their axes."""
    model, state, this = model_of(packed), state_of(starts), step_of(steps)
    edges, master, before = model.masters.edges, model.masters.master, span_of(this.coordinates).end
    for k in range(edges.shape[0]):
        i = master[edges[k, 0]]
        after = state.H[i]
        go_along_edge(span_of(this.nodes).end, edges[k, 0], edges[k, 1], after)
        for r in range(1, 4):
            store_row(state.rest[i], r, (0.0, 0.0, 0.0))
            for rates in (state.V, state.w):
                store_row(rates[i], r, turned_with(before[i], after, load_row(rates[i], r)))
        for numbers in (state.last_residual, state.trend, state.rates[0], state.rates[1]):
            store(numbers[i], 3, turned_with(before[i], after, load(numbers[i], 3)))


@inlined
def _learn(μ: float, V: Array, V1: Array, w: Array) -> None:
    """``w += μ (V₁ − V − w)``, (n, 4, 3)."""
    for i in range(w.shape[0]):
        for k in range(4):
            for j in range(3):
                w[i, k, j] += μ * (V1[i, k, j] - V[i, k, j] - w[i, k, j])


@inlined
def _product(V: Array, p: Array) -> float:
    """``Σ V·p``, (n, 4, 3)."""
    total = 0.0
    for i in range(V.shape[0]):
        for k in range(4):
            for j in range(3):
                total += V[i, k, j] * p[i, k, j]
    return total


@inlined
def _learn_of_vector_cells(μ: float, found: Array, cell_forces: Array) -> None:
    """Forces at the end, and their filter, ``w += μ (ΔF − w)``.

    (3, cell nodes, 2, 3), (2, cell nodes, 2, 3).
    """
    for a in range(cell_forces.shape[1]):
        for k in range(2):
            for j in range(3):
                kept = found[2, a, k, j]
                cell_forces[0, a, k, j] = found[0, a, k, j]
                cell_forces[1, a, k, j] = kept + μ * (found[1, a, k, j] - kept)


@inlined
def _keep_trend(kinds: Indices, H: Array, V: Array, h: float, step: Array, state: State) -> None:
    """Half the change of the rates of increments in the step, per time, and mean accelerations."""
    rates, trend, mean = vector_at(stack(6), 6), state.trend, state.rates
    for i in range(step.shape[0]):
        rates_of(kinds[i], H[i], V[i], rates)
        for at in (0, 3):
            later = load(rates, at)
            store(trend[i], at, combined(1.0 / h, later, -1.0 / h**2, load(step[i], at)))
        for k in range(6):
            mean[1, i, k] = mean[0, i, k]
            mean[0, i, k] = 2.0 * trend[i, k]


@uncounted
def _store_residual(
    kinds: Indices,
    arms: Array,
    middle: Array,
    step: Array,
    r: Array,
    factor: float,
    filter_state: Record,
    last_residual: Array,
    ranks: Ranks,
) -> None:
    """Residual forces ``r`` of owned nodes, and energy, that the next step corrects."""
    gain = square = 0.0
    for i in range(step.shape[0]):
        left, u, ψ = r[6 * i : 6 * i + 6], load(step[i], 0), load(step[i], 3)
        own = factor * ranks.owned[i]
        d1, d2, d3 = axes(kinds[i], middle[i])
        f = scaled(own, rotate(d1, d2, d3, load(left, 0)))
        moment = scaled(own, rotate(d1, d2, d3, load(left, 3)))
        before, earlier = load(last_residual[i], 0), load(last_residual[i], 3)
        frame = kinds[i] < POSITION_GRADIENT
        if frame:
            earlier = left_moment(earlier, before, u)
        gain += dot(minus(f, before), u)
        gain += dot(minus(moment, earlier), ψ)
        square += dot(f, f) / arms[i, 0] ** 2
        if not frame:
            square += dot(moment, moment) / arms[i, 1] ** 2
        store(last_residual[i], 0, f)
        store(last_residual[i], 3, minus(moment, cross(scaled(0.5, u), f)) if frame else moment)
    sums = vector_at(stack(2), 2)
    sums[0], sums[1] = gain - filter_state.repaid - filter_state.row_repaid, square
    add_up(ranks, sums)
    filter_state.leak += sums[0]
    filter_state.limit = sqrt(sums[1])


@uncounted
def _work_of_loads(
    kinds: Indices,
    loads: Loads,
    constant: Array,
    coordinates: Array,
    step: Array,
    losses: Array,
) -> float:
    """Work in the step of all non-conservative loads; adds the forces of all loads to ``losses``.

    Args:
        kinds: Types of the nodes, (n,).
        loads: Loads at the midpoint of the step.
        constant: Those with a potential, (n, 4, 3).
        coordinates: :class:`~fem_lie.solve.conserving.step.records.Span`.
        step: Increments, (n, 6).
        losses: Work, forces and moments, updated.
    """
    dead, moment, following = loads
    _, mean, middle, delta = span_of(coordinates)
    work = 0.0
    for i in range(step.shape[0]):
        for k in range(4):
            for j in range(3):
                work += (dead[i, k, j] - constant[i, k, j]) * delta[i, k, j]
        add_dead(losses, BY_LOADS, 1.0, mean[i], dead[i])
        d1, d2, d3 = axes(kinds[i], middle[i])
        f = rotate(d1, d2, d3, load(following[i], 0))
        m = plus(load(moment[i], 0), rotate(d1, d2, d3, load(following[i], 3)))
        work += dot(f, load(step[i], 0)) + dot(m, load(step[i], 3))
        if kinds[i] < POSITION_GRADIENT:
            add_wrench(losses, BY_LOADS, load_row(mean[i], 0), f, m)
        else:
            force, turning = wrench(kinds[i], middle[i], following[i])
            turning = plus(turning, load(moment[i], 0))
            add_wrench(losses, BY_LOADS, load_row(middle[i], 0), force, turning)
    return work


@inlined
def _work_on_products(model: Model, this: Step) -> float:
    """The same for forces on products; adds their moments to ``losses``."""
    n, dead, work = this.step.shape[0], model.loads.dead, 0.0
    for a in range(this.products.shape[0]):
        force, constant, moved = dead[n + a], model.conservative[n + a], this.moved[n + a]
        for k in range(1, 4):
            for j in range(3):
                work += (force[k, j] - constant[k, j]) * moved[k, j]
        add_dead(this.losses, BY_LOADS, 1.0, this.products[a], force)
    return work
