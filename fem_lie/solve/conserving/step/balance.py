"""Balances of a step that conserves energy and momenta, on all nodes, compiled.

Formulas are in :mod:`fem_lie.solve.conserving.energy_momentum`.
"""

from __future__ import annotations

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined, linked, uncounted
from fem_lie._jit.call_back import call_back
from fem_lie._jit.records import Record
from fem_lie._jit.stack import stack, vector_at
from fem_lie.bodies.balances import BY_LOADS, BY_REACTIONS, DAMPING, NUMERICAL, WORK
from fem_lie.lie.node_types import inertia
from fem_lie.lie.node_types.forces import add_along_increments, wrench
from fem_lie.lie.node_types.node_type import POSITION_GRADIENT, axes
from fem_lie.lie.tuples import (
    Vector,
    add_dead,
    add_wrench,
    load,
    load_row,
    minus,
    rotate,
    rotate_back,
    scaled,
    store,
    store_row,
)
from fem_lie.solve.conserving.midpoint.any_node import span_all
from fem_lie.solve.conserving.midpoint.cayley import left_moment
from fem_lie.solve.conserving.midpoint.reduced_bodies import add_inertia, span_products
from fem_lie.solve.conserving.step.cells import add_filtered_forces, add_from_nodes
from fem_lie.solve.conserving.step.dissipation import (
    choose_filter_gain,
    set_velocities,
    velocity_loss,
)
from fem_lie.solve.conserving.step.joints import add_joints
from fem_lie.solve.conserving.step.packing import model_of, state_of, step_of
from fem_lie.solve.conserving.step.products import set_products
from fem_lie.solve.conserving.step.ranks import Ranks, add_up, ranks_of
from fem_lie.solve.conserving.step.records import (
    FORCES,
    JOINTS,
    SUM,
    products_of,
    solution_of,
    span_of,
)
from fem_lie.system.nodes.masses import Loads


@linked
def packed_residual(model: Indices, state: Indices, step: Indices) -> None:
    """:func:`residual` with evaluation of all forces, from Python."""
    residual(model, state, step, True)


@uncounted
def residual(packed: Indices, starts: Indices, steps: Indices, reevaluate: bool) -> None:
    """Balance of momenta over the step, times 2/(1 + χ), along midpoint frames; constraints.

    Without ``reevaluate`` cells keep their last forces and energies.
    """
    model, state, this = model_of(packed), state_of(starts), step_of(steps)
    held, scheme, losses, forces = model.held, model.scheme, this.losses, this.forces
    kinds, addresses = model.kinds, model.addresses
    n, χ = this.step.shape[0], scheme.dissipation * state.filter_state[0].active
    along, r = span_of(this.coordinates), solution_of(this.r).residual
    span_all(kinds, state.H, this.step, (along.delta, along.mean, along.end, along.middle))
    if this.products.shape[0] > 0:
        _span_products(packed, starts, steps)
    for k in range(losses.shape[0]):
        losses[k] = 0.0
    _add_last_residual(kinds, state.last_residual, this.step, forces)
    add_from_nodes(packed, starts, steps, reevaluate)
    _add_up(ranks_of(model, this), state.filter_state[0])
    if χ > 0.0:
        _choose_filter_gain(packed, starts, steps)
        add_filtered_forces(packed, starts, steps)
    _add_momenta(packed, starts, steps)
    if addresses[FORCES] != 0:
        # the rates at the end of the step are known
        _add_outer(addresses, this.outer, forces)
    _add_loads(kinds, model.loads, along.middle, forces)
    if addresses[JOINTS] == 0:
        given = model.joints, state.multipliers, model.driven, scheme.h
        change, reactions = this.change, losses[BY_REACTIONS:]
        work, loss = add_joints(along.mean, along.delta, *given, change, forces, reactions)
        losses[WORK] += work
        losses[DAMPING] += loss
    for i in range(n):
        d1, d2, d3 = axes(kinds[i], along.middle[i])
        for at in (0, 3):
            local = rotate_back(d1, d2, d3, load(forces[i], at))
            store(r, 6 * i + at, scaled(2.0 / (1.0 + χ), local))
    if addresses[SUM] != 0:
        call_back(addresses[SUM])
    for i in range(n):
        m, own = along.middle[i], r[6 * i : 6 * i + 6]
        _add_reactions(kinds[i], m, load_row(along.mean[i], 0), model.supported[i], own, χ, losses)
        for k in range(6):
            if held[i, k]:
                r[6 * i + k] = 0.0
    for c in range(state.multipliers.shape[0]):
        r[6 * n + c] = model.scale[c] * (state.gap[c] + this.change[c])


@uncounted
def _add_up(ranks: Ranks, filter_state: Record) -> None:
    """Sums of all ranks of squares of the deformations and of works of the filter."""
    sums = vector_at(stack(3), 3)
    sums[0] = filter_state.squares + filter_state.row_squares
    sums[1], sums[2] = filter_state.change_work, filter_state.filter_work
    add_up(ranks, sums)
    filter_state.all_squares = sums[0]
    filter_state.all_change_work, filter_state.all_filter_work = sums[1], sums[2]


@uncounted
def _span_products(packed: Indices, starts: Indices, steps: Indices) -> None:
    """Modal coordinates and products of reduced-order bodies, and increments with inertia."""
    model, state, this = model_of(packed), state_of(starts), step_of(steps)
    along, moved = span_of(this.coordinates), this.moved
    for i in range(this.step.shape[0]):
        for k in range(4):
            store_row(moved[i], k, load_row(along.delta[i], k))
    nodes, motion = (state.H, state.rest), (along.mean, along.delta)
    span_products(model.bodies, nodes, motion, this.within, this.products, moved)


@inlined
def _add_last_residual(kinds: Indices, last_residual: Array, step: Array, forces: Array) -> None:
    """Start the forces with the remainder of the last step: momenta are compensated sums."""
    for i in range(forces.shape[0]):
        f, moment = load(last_residual[i], 0), load(last_residual[i], 3)
        if kinds[i] < POSITION_GRADIENT:
            moment = left_moment(moment, f, load(step[i], 0))
        store(forces[i], 0, f)
        store(forces[i], 3, moment)


@uncounted
def _add_outer(addresses: Indices, outer: Array, forces: Array) -> None:
    """Add the forces that Python evaluates."""
    for i in range(outer.shape[0]):
        for k in range(6):
            outer[i, k] = 0.0
    call_back(addresses[FORCES])
    for i in range(outer.shape[0]):
        for k in range(6):
            forces[i, k] += outer[i, k]


@uncounted
def _add_reactions(
    kind: int, middle: Array, x: Vector, supported: Indices, r: Array, χ: float, losses: Array
) -> None:
    """Add the reaction of a supported node at ``x``, which balances its residual."""
    any_held = False
    for k in range(6):
        any_held = any_held or supported[k] != 0
    if not any_held:
        return
    s, own = 0.5 * (1.0 + χ), vector_at(stack(6), 6)
    for k in range(6):
        own[k] = s * r[k] * supported[k]
    force, moment = wrench(kind, middle, own)
    add_wrench(losses, BY_REACTIONS, x, force, moment)


@uncounted
def _choose_filter_gain(packed: Indices, starts: Indices, steps: Indices) -> None:
    """Choose β, and velocities with it."""
    model, state, this = model_of(packed), state_of(starts), step_of(steps)
    V, w, filter_state, products, χ = (
        state.V,
        state.w,
        state.filter_state[0],
        products_of(this),
        model.scheme.dissipation,
    )
    ranks = ranks_of(model, this)
    set_products(model.inertia, V, w, this.moved, model.scheme.h, products, ranks)
    ψ = choose_filter_gain(products.sums, χ, filter_state)
    set_velocities(V, w, products.δ, χ, filter_state.gain, ψ, this.V1)


@uncounted
def _add_momenta(packed: Indices, starts: Indices, steps: Indices) -> None:
    """Add rates of momenta, and mass-proportional damping."""
    model, state, this = model_of(packed), state_of(starts), step_of(steps)
    mass, damping, dead, scheme = model.inertia, model.damping, model.loads.dead, model.scheme
    h = scheme.h
    V, V1, losses, forces, q = state.V, this.V1, this.losses, this.forces, this.q
    _, mean, _, delta = span_of(this.coordinates)
    n, moved, dissipates = (
        forces.shape[0],
        this.moved,
        scheme.dissipation * state.filter_state[0].active > 0.0,
    )
    if not dissipates:
        for i in range(V.shape[0]):
            for k in range(4):
                for j in range(3):
                    V1[i, k, j] = 2.0 / h * moved[i, k, j] - V[i, k, j]
    if damping.indptr.shape[0] > 0:
        for i in range(n):
            for k in range(4):
                for j in range(3):
                    q[0, i, k, j] = delta[i, k, j] / h
        inertia.multiply(damping.indptr, damping.indices, damping.blocks, q[0], q[1])
        _add_local_forces(model.kinds, mean, q[1], forces)
        power = 0.0
        for i in range(n):
            for k in range(4):
                for j in range(3):
                    power += q[0, i, k, j] * q[1, i, k, j]
        losses[DAMPING] += h * power
        for i in range(n):
            add_dead(losses, BY_LOADS, -1.0, mean[i], q[1, i])
    for i in range(V.shape[0]):
        for k in range(4):
            for j in range(3):
                q[0, i, k, j] = (V1[i, k, j] - V[i, k, j]) / h
    inertia.multiply(mass.indptr, mass.indices, mass.blocks, q[0], q[1])
    if dissipates:
        losses[NUMERICAL] += velocity_loss(V, V1, moved, h, q[1])
    for i in range(V.shape[0]):
        for k in range(4):
            for j in range(3):
                q[1, i, k, j] -= dead[i, k, j]
    _add_local_forces(model.kinds, mean, q[1], forces)
    if this.products.shape[0] > 0:
        nodes, motion = (state.H, state.rest), (mean, delta)
        own = this.step, this.within, this.products
        add_inertia(model.bodies, model.kinds, nodes, motion, *own, q[1], forces)


@uncounted
def _add_local_forces(kinds: Indices, mean: Array, f: Array, forces: Array) -> None:
    """Add forces on nodal coordinates (n, 4, 3) to forces along increments (n, 6)."""
    for i in range(forces.shape[0]):
        add_along_increments(kinds[i], mean[i], f[i], forces[i])


@uncounted
def _add_loads(kinds: Indices, loads: Loads, middle: Array, forces: Array) -> None:
    """Subtract moments fixed in space and follower loads at the midpoint of the step."""
    moment, following = loads.moment, loads.following
    for i in range(forces.shape[0]):
        (d1, d2, d3), f = axes(kinds[i], middle[i]), following[i]
        for at in (0, 3):
            turned = rotate(d1, d2, d3, load(f, at))
            store(forces[i], at, minus(load(forces[i], at), turned))
        store(forces[i], 3, minus(load(forces[i], 3), load(moment[i], 0)))
