"""Forces over a step that are written on all nodes: elements, their viscosity, and pressure."""

from __future__ import annotations

from math import sqrt
from typing import Any

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined, linked
from fem_lie.bodies.balances import BY_LOADS
from fem_lie.forms import cells as elements
from fem_lie.lie.tuples import (
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
)
from fem_lie.lie.wrenches import add_wrench
from fem_lie.solve.conserving.step.cayley import follow
from fem_lie.solve.conserving.step.copies import put
from fem_lie.solve.conserving.step.discrete_gradient import add_elastic, filtered_forces
from fem_lie.solve.conserving.step.dissipation import (
    ELASTIC,
    ENERGY,
    LEAK,
    LIMIT,
    MEMORY,
    REMEMBERS,
    REPAID,
    SQUARES,
    WORKS,
)


@linked
def add_from_nodes(model: tuple[Any, ...], state: tuple[Any, ...], this: tuple[Any, ...]) -> None:
    """Add the forces of the cells and of pressure, which are on all nodes, to the leaders."""
    leader, offset, trivial = model[4]
    cells, pressure = model[0], model[9]
    H, rest = state[0], state[1]
    step, rows, nodes, steps, forces = this[0], this[1], this[7], this[8], this[9]
    if cells[4].shape[0] == 0:  # nothing but rigid bodies
        return
    for i in range(step.shape[0]):
        for k in range(4):
            for j in range(3):
                nodes[5, i, k, j] = rows[3, i, k, j] + rest[i, k, j]
    if trivial:
        on_all = forces
        parts = (H, rows[0], rows[1], rows[2], rows[3], nodes[5], step)
    else:
        put(nodes[5, : step.shape[0]], this[10][0])
        follow(H, leader, offset, nodes[0])
        for k in range(4):
            follow(rows[k], leader, offset, nodes[1 + k])
        follow(this[10][0], leader, offset, nodes[5])
        for i in range(leader.shape[0]):
            store(steps[0, i], 0, load_row(nodes[4, i], 0))
            store(steps[0, i], 3, load(step[leader[i]], 3))
        on_all = steps[2]
        on_all[:] = 0.0
        parts = (nodes[0], nodes[1], nodes[2], nodes[3], nodes[4], nodes[5], steps[0])
    _add_cells(model, state, this, parts, on_all)
    this[6][0] += _add_pressure(pressure, parts[2], parts[3], parts[4], on_all, this[6])
    if not trivial:
        collect(leader, nodes[2], rows[1], on_all, forces)


ULP = float(np.finfo(np.float64).eps)


@compiled
def _add_cells(  # type: ignore[no-untyped-def]
    model, state, this, parts, out
):
    """Add elastic, filtered and viscous forces of the cells to those on all nodes."""
    cells, viscous, h, χ = model[0], model[10], model[11][0], model[11][1]
    F, W, account, w_F, lag = state[5], state[6], state[7], state[9], state[10]
    F1, energies, losses, steps = this[3], this[4], this[6], this[8]
    H, end, mean, middle, delta, more, step = parts
    elements.evaluate(cells, H, more, F1, energies[0])
    ends = (H, end, F, F1, W, energies[0])
    repay = _repayment(lag)
    typical, unknown = lag[SQUARES] / W.shape[0], ULP * lag[ENERGY] / W.shape[0]
    squares = add_elastic(
        cells, ends, (mean, delta, step), account, energies[1], repay, typical, unknown, out
    )
    lag[SQUARES], lag[REPAID] = squares, repay * squares
    if χ > 0.0:
        lag[WORKS], lag[WORKS + 1] = filtered_forces(
            cells, (H, end, F, F1), (mean, delta, step), w_F, this[14]
        )
    if viscous:
        for i in range(step.shape[0]):
            m = middle[i]
            for at in (0, 3):
                rate = scaled(1.0 / h, load(step[i], at))
                turned = rotate_back(load_row(m, 1), load_row(m, 2), load_row(m, 3), rate)
                store(steps[1, i], at, turned)
        losses[1] += h * _add_viscous(cells, middle, steps[1], this[11], out)


@compiled
def add_filtered_forces(  # type: ignore[no-untyped-def]
    kinds, attachment, scheme, state, this
):
    """Add forces of the changes of elastic forces less their memory, to the leaders.

    ``kinds``: how many of cells there are.
    """
    leader, _, trivial = attachment
    lag, nodes, on_all, given, losses = state[10], this[7], this[8][2], this[14], this[6]
    if kinds == 0:
        return
    a = 0.5 * scheme[1] * lag[REMEMBERS] * lag[ELASTIC]
    b = a * lag[MEMORY]
    losses[2] += a * lag[WORKS] - b * lag[WORKS + 1]
    if trivial:
        on_all = this[9]
    else:
        on_all[:] = 0.0
    for i in range(on_all.shape[0]):
        for k in range(6):
            on_all[i, k] += a * given[0, i, k] - b * given[1, i, k]
    if not trivial:
        collect(leader, nodes[2], this[1][1], on_all, this[9])


@inlined
def _repayment(lag: Array) -> float:
    """Factor of forces that take back what round-off has brought in, as small as round-off is."""
    leak, squares = lag[LEAK], lag[SQUARES]
    if squares == 0.0:
        return 0.0
    # a force of the whole size turns its sign with a deformation that is noise, and keeps it up
    most = 0.1 * lag[LIMIT] / sqrt(squares)
    return max(-most, min(most, leak / squares))


@compiled
def _add_viscous(  # type: ignore[no-untyped-def]
    cells, middle, twists, F, out
):
    """Add viscous forces at the half-way frames; returns their power."""
    first, nodes, power = cells[7], cells[8], 0.0
    elements.viscous_forces(cells, middle, twists, F)
    for e in range(first.shape[0] - 1):
        for a in range(first[e], first[e + 1]):
            m = middle[nodes[a]]
            for at in (0, 3):
                f = rotate(load_row(m, 1), load_row(m, 2), load_row(m, 3), load(F[a], at))
                store(out[nodes[a]], at, plus(load(out[nodes[a]], at), f))
            for k in range(6):
                power += F[a, k] * twists[nodes[a], k]
    return power


@compiled
def _add_pressure(  # type: ignore[no-untyped-def]
    pressure, mean, middle, delta, out, losses
):
    """Subtract ``½ (x_j − x_i) × ½ (R_i + R_j) w`` on both nodes of each piece; returns work."""
    pairs, across = pressure
    work = 0.0
    for e in range(pairs.shape[0]):
        i, j = pairs[e, 0], pairs[e, 1]
        push = (0.0, 0.0, 0.0)
        for node in (i, j):
            m = middle[node]
            axis = rotate(load_row(m, 1), load_row(m, 2), load_row(m, 3), load_row(across, e))
            push = plus(push, scaled(0.25, axis))
        force = cross(minus(load_row(mean[j], 0), load_row(mean[i], 0)), push)
        for node in (i, j):
            store(out[node], 0, minus(load(out[node], 0), force))
            add_wrench(losses, BY_LOADS, load_row(mean[node], 0), force, (0.0, 0.0, 0.0))
            work += dot(force, load_row(delta[node], 0))
    return work


@compiled
def collect(leader: Indices, all_means: Array, mean: Array, given: Array, forces: Array) -> None:
    """Add forces and moments on all nodes, (N, 6), to those on their leaders, (n, 6)."""
    for i in range(leader.shape[0]):
        to = leader[i]
        f, arm = load(given[i], 0), minus(load_row(all_means[i], 0), load_row(mean[to], 0))
        store(forces[to], 0, plus(load(forces[to], 0), f))
        moment = plus(load(given[i], 3), cross(arm, f))
        store(forces[to], 3, plus(load(forces[to], 3), moment))
