"""Balances of momenta over a step of nodes of any kind; compiled.

Formulas in :mod:`fem_lie.solve.conserving.energy_momentum`; for nodes that are no frames ``q`` are
the rows whose increments add, so that ``L`` is constant. Both kinds of forces are along increments:
of a frame the moment of forces on its directors is about their means.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled, inlined_uncounted, uncounted
from fem_lie._jit.stack import stack, vector_at
from fem_lie.bodies.balances import BY_LOADS, BY_REACTIONS, DAMPING, NUMERICAL, WORK
from fem_lie.forms import cells as elements
from fem_lie.lie.kinds import inertia
from fem_lie.lie.kinds.forces import add_along_increments, wrench
from fem_lie.lie.kinds.kind import SLOPE, axes
from fem_lie.lie.tuples import (
    combined,
    dot,
    load,
    load_row,
    plus,
    rotate,
    rotate_back,
    store,
)
from fem_lie.lie.wrenches import add_dead, add_wrench
from fem_lie.solve.conserving.between import discrete_gradient
from fem_lie.solve.conserving.between.cayley import left_moment
from fem_lie.solve.conserving.between.mean_forces import Ends, Path
from fem_lie.solve.conserving.between.pushes import LOSS, ON_GROUND
from fem_lie.solve.conserving.rows.cells import Nodes, add_elastic
from fem_lie.solve.conserving.rows.changes import Lasting, add_changes
from fem_lie.solve.conserving.rows.energies import Energies
from fem_lie.solve.conserving.rows.places import add_of_places
from fem_lie.solve.conserving.step.dissipation import (
    ELASTIC,
    MEMORY,
    REMEMBERS,
    WORKS,
    choose_memory,
    set_velocities,
    velocity_loss,
)
from fem_lie.solve.conserving.step.products import set_products
from fem_lie.solve.conserving.straight.records import (
    ENERGY,
    LEAK,
    LIMIT,
    SQUARES,
    Model,
    State,
    Step,
    products_of,
)

_ULP = float(np.finfo(np.float64).eps)


@compiled
def add_viscous(model: Model, this: Step, h: float, rates: Array, forces: Array) -> None:
    """Add forces (n, 6) along these axes, at these velocities, and book what they take.

    They do not oppose rigid motions: these are motions of the middle of the step, by
    ``ω × r̄``, however far the step turns.
    """
    for i in range(rates.shape[0]):
        d1, d2, d3 = axes(model.kinds[i], this.middle[i])
        for at in (0, 3):
            f = load(forces[i], at)
            this.losses[DAMPING] += h * dot(f, load(rates[i], at))
            store(this.outer[i], at, plus(load(this.outer[i], at), rotate(d1, d2, d3, f)))


@compiled
def add_pushed(this: Step, pushed: Array) -> None:
    """Add forces that are given along increments, and book what they do to ground and lose.

    Args:
        this: Step, whose nodes have moved.
        pushed: See :mod:`fem_lie.solve.conserving.between.pushes`, (n + 2, 6).
    """
    n = this.outer.shape[0]
    for k in range(6):
        for i in range(n):
            this.outer[i, k] += pushed[i, k]
        this.losses[BY_REACTIONS + k] += pushed[n + ON_GROUND, k]
    this.losses[DAMPING] += pushed[n + LOSS, 0]


@compiled
def residual(model: Model, state: State, this: Step, h: float) -> None:
    """The balance of momenta over the step, along the axes in the middle, into ``this.r``.

    It is times ``2/(1 + χ)``. Nodes have moved, and the outer forces are there.
    """
    q = this.q
    this.forces[:] = 0.0
    _add_elastic(model, state, this)
    χ = model.loss * state.lag[REMEMBERS]
    if χ > 0.0:
        _dissipate(model, state, this, h)
    _set_rates(state, this, h)
    inertia.multiply(model.inertia.indptr, model.inertia.indices, model.inertia.blocks, q[0], q[1])
    if χ > 0.0:
        this.losses[NUMERICAL] += velocity_loss(state.V, this.V1, this.delta, h, q[1])
    _add_loads(model, this)
    if model.damping.indptr.shape[0] > 0:
        _add_damping(model, this, h)
    _balance_all(model, state, this, 2.0 / (1.0 + χ))


@uncounted
def _set_rates(state: State, this: Step, h: float) -> None:
    """Set ``q[0]`` to mean rates of the velocities of all rows."""
    for i in range(this.step.shape[0]):
        for k in range(4):
            for j in range(3):
                this.q[0, i, k, j] = (this.V1[i, k, j] - state.V[i, k, j]) / h


@uncounted
def _add_loads(model: Model, this: Step) -> None:
    """Take loads that are fixed in space from rates of momenta ``q[1]``."""
    for i in range(this.step.shape[0]):
        for k in range(4):
            for j in range(3):
                this.q[1, i, k, j] -= model.dead[i, k, j]
                own = model.dead[i, k, j] - model.conservative[i, k, j]
                this.losses[WORK] += own * this.delta[i, k, j]
        add_dead(this.losses, BY_LOADS, 1.0, this.mean[i], model.dead[i])


@uncounted
def _balance_all(model: Model, state: State, this: Step, factor: float) -> None:
    """Of all nodes, and what constraints violate."""
    n = this.step.shape[0]
    for i in range(n):
        kind, forces = model.kinds[i], this.forces[i]
        add_along_increments(kind, this.mean[i], this.q[1, i], forces)
        _make_up(kind, state.carry[i], this.step[i], forces)
        for k in range(6):
            forces[k] += this.outer[i, k]
        _balance(i, model, this, factor)
    for c in range(state.gap.shape[0]):
        this.r[6 * n + c] = state.scale[c] * (state.gap[c] + this.change[c])


@compiled
def _dissipate(model: Model, state: State, this: Step, h: float) -> None:
    """Add what is filtered of elastic forces, and set velocities at the end."""
    χ, lag, products = model.loss, state.lag, products_of(this)
    set_products(model.inertia, state.V, state.w, this.delta, h, products)
    ψ = choose_memory(products.sums, χ, lag)
    set_velocities(state.V, state.w, products.δ, χ, lag[MEMORY], ψ, this.V1)
    a = 0.5 * χ * lag[ELASTIC]
    b = a * lag[MEMORY]
    this.losses[NUMERICAL] += a * lag[WORKS] - b * lag[WORKS + 1]
    for i in range(this.forces.shape[0]):
        for k in range(6):
            this.forces[i, k] += a * this.filtered[0, i, k] - b * this.filtered[1, i, k]


@inlined_uncounted
def _make_up(kind: int, carry: Array, step: Array, forces: Array) -> None:
    """Add what the last step has left over."""
    f, moment = load(carry, 0), load(carry, 3)
    if kind < SLOPE:
        moment = left_moment(moment, f, load(step, 0))
    store(forces, 0, plus(load(forces, 0), f))
    store(forces, 3, plus(load(forces, 3), moment))


@compiled
def _add_damping(model: Model, this: Step, h: float) -> None:
    """Add to rates of momenta ``q[1]`` what goes with mass, at the mean velocity of the step."""
    D, f = model.damping, np.empty_like(this.mean)
    for i in range(f.shape[0]):
        for k in range(4):
            for j in range(3):
                this.q[0, i, k, j] = this.delta[i, k, j] / h
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
    # of the last step, or of the last iteration, where an impact deforms what was not deformed
    squares_before = max(state.told[SQUARES], this.told[0])
    unknown = _ULP * state.told[ENERGY] / count
    repay = 0.0
    if squares_before > 0.0:
        # a force of the whole size turns its sign with a deformation that is noise, and keeps it up
        most = 0.1 * state.told[LIMIT] / sqrt(squares_before)
        repay = max(-most, min(most, state.told[LEAK] / squares_before))
    squares = 0.0
    state.lag[WORKS] = state.lag[WORKS + 1] = 0.0
    if model.cells.sees.shape[0] > 0:
        squares += _add_straight(model, state, this, (repay, squares_before / count, unknown))
    if model.framed.x.shape[0] > 0:
        squares += _add_framed(model, state, this, (repay, squares_before / count, unknown))
    elif model.loss > 0.0:
        this.filtered[:] = 0.0
    if model.loss > 0.0 and model.cells.sees.shape[0] > 0:
        end, change, kept = this.lasting[0], this.lasting[1], this.lasting[2]
        lasting = Lasting(state.lasting[0], state.lasting[1], end, change, kept)
        nodes = Nodes(state.H, state.rest, this.step)
        by_change, by_memory = add_changes(model.cells, nodes, lasting, this.filtered)
        state.lag[WORKS] += by_change
        state.lag[WORKS + 1] += by_memory
    this.told[0], this.told[1] = squares, repay


@compiled
def _add_straight(
    model: Model, state: State, this: Step, factors: tuple[float, float, float]
) -> float:
    """Forces of cells of nodes that are no frames; returns the sum of ``|s|²``."""
    M = model.cells.sees.shape[0]
    nodes = Nodes(state.H, state.rest, this.step)
    energies = Energies(state.W[:M], state.account[:M], this.W1[:M], this.work[:M])
    squares = add_elastic(model.cells, nodes, energies, factors, this.forces)
    return squares + add_of_places(model.cells, nodes, energies, factors, this.forces)


@compiled
def _add_framed(
    model: Model, state: State, this: Step, factors: tuple[float, float, float]
) -> float:
    """Forces of cells of frames; returns the sum of ``|s|²``."""
    M, W1 = model.cells.sees.shape[0], this.W1
    elements.evaluate(model.framed, state.H, this.delta + state.rest, this.F1, W1[M:])
    ends = Ends(state.H, this.end, state.F, this.F1)
    path = Path(this.mean, this.delta, this.step)
    energies = discrete_gradient.Energies(state.W[M:], W1[M:], state.account[M:])
    lasts = discrete_gradient.Filtered(model.loss > 0.0, state.w_F, this.filtered)
    squares, state.lag[WORKS], state.lag[WORKS + 1] = discrete_gradient.add_elastic(
        model.framed, ends, path, energies, this.work[M:], factors, lasts, this.forces
    )
    return squares


@uncounted
def _balance(i: int, model: Model, this: Step, factor: float) -> None:
    """Of one node, with loads along its axes and moments; what holds it is a reaction."""
    kind, m, r = model.kinds[i], this.middle[i], this.r[6 * i : 6 * i + 6]
    (d1, d2, d3), f = axes(kind, m), model.following[i]
    any_held = False
    turn = load_row(model.moment, i)
    for at in (0, 3):
        push = rotate(d1, d2, d3, load(f, at))
        push = push if at == 0 else plus(push, turn)
        store(this.forces[i], at, combined(1.0, load(this.forces[i], at), -1.0, push))
        for j in range(3):
            this.losses[WORK] += push[j] * this.step[i, at + j]
        store(r, at, rotate_back(d1, d2, d3, load(this.forces[i], at)))
    force, moment = wrench(kind, m, f)
    add_wrench(this.losses, BY_LOADS, load_row(m, 0), force, plus(moment, turn))
    for k in range(6):
        any_held = any_held or model.supported[i, k]
    if any_held:
        own = vector_at(stack(6), 6)
        for k in range(6):
            own[k] = r[k] if model.supported[i, k] else 0.0
        force, moment = wrench(kind, m, own)
        add_wrench(this.losses, BY_REACTIONS, load_row(m, 0), force, moment)
    for k in range(6):
        r[k] = 0.0 if model.held[i, k] else factor * r[k]
