"""Records and balances of a step that conserves energy and momenta, on all nodes, compiled.

Formulas in :mod:`fem_lie.solve.conserving.energy_momentum`.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled, inlined, linked
from fem_lie.bodies.balances import BY_LOADS, BY_REACTIONS
from fem_lie.lie.tuples import (
    cross,
    load,
    load_row,
    minus,
    plus,
    rotate,
    rotate_back,
    scaled,
    store,
)
from fem_lie.lie.wrenches import add_dead, add_wrench
from fem_lie.solve.conserving.step.cayley import span
from fem_lie.solve.conserving.step.cells import add_filtered_forces, add_from_nodes
from fem_lie.solve.conserving.step.copies import put
from fem_lie.solve.conserving.step.dissipation import (
    REMEMBERS,
    choose_memory,
    end_velocities,
    velocity_loss,
)
from fem_lie.solve.conserving.step.joints import add_joints
from fem_lie.system.nodes import inertia


class Model(NamedTuple):
    """What does not change in a step, as plain tuples.

    Attributes:
        cells: See :class:`~fem_lie.forms.cells.CellTable`.
        joints: See :class:`~fem_lie.joints.equations.table.JointTable`, packed.
        inertia: See :class:`~fem_lie.system.nodes.inertia.Inertia`.
        damping: The same of damping that goes with mass; without rows there is none.
        attachment: Leader and offset of each node, and whether all lead themselves.
        held: Which unknowns are zero, (n, 6).
        measure: Size of each unknown and scaled multiplier, shape (6 n + m,).
        scale: Factor of each constraint, (m,).
        loads: See :class:`~fem_lie.system.nodes.sums.Loads`, and those of ``dead`` that have a
            potential; they may be changed.
        pressure: Pairs of nodes (s, 2), and axes across times pressure (s, 3).
        viscous: Whether cells have viscous forces.
        scheme: Step size, χ and μ of :mod:`fem_lie.solve.conserving.step.dissipation`.
        probes: Table of the coordinates that results report, packed.
        driven: Increments of the constraints' targets in the step, (m,); they may be changed.
        supported: Which unknowns are held from outside, (n, 6).
    """

    cells: tuple[Any, ...]
    joints: tuple[Any, ...]
    inertia: tuple[Any, ...]
    damping: tuple[Any, ...]
    attachment: tuple[Any, ...]
    held: Any
    measure: Array
    scale: Array
    loads: tuple[Any, ...]
    pressure: tuple[Any, ...]
    viscous: bool
    scheme: tuple[float, float, float]
    probes: tuple[Any, ...]
    driven: Array
    supported: Any


class State(NamedTuple):
    """Start of a step, and its end with index 1.

    Attributes:
        H: Frames of all rows, ground and prescribed motions last, (n + 1 + p, 4, 3).
        rest: Digits of ``H`` that do not fit into it, (n, 4, 3).
        V: Velocities of (x, d₁, d₂, d₃), (n, 4, 3).
        weights: Multipliers, (m,).
        gap: Values of the constraints, (m,).
        F: Forces of the cells, in the frames of their nodes, (places, 6).
        W: Energies of the cells, (M,).
        account: Work done on each cell, (M,).
        w: Memory of changes of velocity, (n, 4, 3).
        w_F: Of changes of forces, (places, 6).
        lag: Numbers of the last iteration, see :mod:`fem_lie.solve.conserving.step.dissipation`,
            (11,).
        carry: Forces and moments left over by the last step, global components, (n, 6).
        books: Work of loads and drives that has no potential, of damping, numerical loss, and
            impulses of loads and of reactions, (15,).
        trend: Half the change of the nodes' spatial velocities in the last step, per time, (n, 6).
        earlier: Multipliers of the two steps before the last one, (2, m).
        sizes: Of the last three steps since the start or an event, 0 for those before, (3,).
    """

    H: Array
    rest: Array
    V: Array
    weights: Array
    gap: Array
    F: Array
    W: Array
    account: Array
    w: Array
    w_F: Array
    lag: Array
    carry: Array
    books: Array
    trend: Array
    earlier: Array
    sizes: Array


class Step(NamedTuple):
    """What a step consists of, and memory without meaning between two of them.

    Attributes:
        step: Spatial translation and rotation of the nodes, (n, 6).
        rows: Ends, means, half-way frames and increments of all rows, (4, rows, 4, 3).
        V1: Velocities at the end, (n, 4, 3).
        F1: Forces of the cells at the end, (places, 6).
        energies: At the end, and the work of the step, (2, M).
        change: Of the constraints, (m,).
        losses: Work of drives, of damping, numerical loss in the step, and forces and moments about
            the origin of pressure and mass damping, and of reactions, (15,).
        nodes: Start, ends, means, half-way frames, increments, and those with the rest, of all
            nodes, (6, N, 4, 3).
        steps: Their steps, twists and forces on them, (3, N, 6).
        forces: On the leaders, (n, 6).
        q: For inertia, (2, n, 4, 3).
        F_viscous: Viscous forces of the cells, (places, 6).
        r: Residual, solution and work of the solver, (3, 6 n + m).
        weights: Multipliers at the start of the step, (m,).
        filtered: Forces of the changes of elastic forces and of their memory, on all nodes,
            (2, N, 6).
    """

    step: Array
    rows: Array
    V1: Array
    F1: Array
    energies: Array
    change: Array
    losses: Array
    nodes: Array
    steps: Array
    forces: Array
    q: Array
    F_viscous: Array
    r: Array
    weights: Array
    filtered: Array


@linked
def residual(model: tuple[Any, ...], state: tuple[Any, ...], this: tuple[Any, ...]) -> None:
    """Balance of momenta over the step, times 2/(1 + χ), along half-way frames; constraints."""
    joints, held, scale, scheme = model[1], model[5], model[7], model[11]
    H, weights, gap, lag = state[0], state[3], state[4], state[10]
    step, rows, change, losses, forces, r = this[0], this[1], this[5], this[6], this[9], this[12]
    n, χ = step.shape[0], scheme[1] * lag[REMEMBERS]
    end, mean, middle, delta = rows[0], rows[1], rows[2], rows[3]
    span(H, step, delta, mean, end, middle)
    losses[:] = 0.0
    # what round-off has left over is made up: momenta are compensated sums
    put(state[11], forces)
    add_from_nodes(model, state, this)
    if χ > 0.0:
        _choose_memory(model[2], scheme, state, this)
        add_filtered_forces(model[0][4].shape[0], model[4], scheme, state, this)
    _add_momenta(model[2], model[3], model[8][0], scheme, state, this)
    _add_loads(model[8], middle, forces)
    given = joints, weights, model[13], scheme[0]
    work, loss = add_joints(mean, delta, *given, change, forces, losses[BY_REACTIONS:])
    losses[0] += work
    losses[1] += loss
    for i in range(n):
        m = middle[i]
        for at in (0, 3):
            local = rotate_back(load_row(m, 1), load_row(m, 2), load_row(m, 3), load(forces[i], at))
            store(r[0, 6 * i : 6 * i + 6], at, scaled(2.0 / (1.0 + χ), local))
        _add_reactions(m, load_row(mean[i], 0), model[14][i], r[0, 6 * i : 6 * i + 6], χ, losses)
        for k in range(6):
            if held[i, k]:
                r[0, 6 * i + k] = 0.0
    for c in range(weights.shape[0]):
        r[0, 6 * n + c] = scale[c] * (gap[c] + change[c])


@inlined
def _add_reactions(  # type: ignore[no-untyped-def]
    middle, x, supported, r, χ, losses
):
    """Add what is left over where a node at ``x`` is held from outside: the force that holds it."""
    any_held = False
    for k in range(6):
        any_held = any_held or supported[k]
    if not any_held:
        return
    s = 0.5 * (1.0 + χ)
    a = (s * r[0] * supported[0], s * r[1] * supported[1], s * r[2] * supported[2])
    b = (s * r[3] * supported[3], s * r[4] * supported[4], s * r[5] * supported[5])
    d1, d2, d3 = load_row(middle, 1), load_row(middle, 2), load_row(middle, 3)
    add_wrench(losses, BY_REACTIONS, x, rotate(d1, d2, d3, a), rotate(d1, d2, d3, b))


@compiled
def _choose_memory(  # type: ignore[no-untyped-def]
    mass, scheme, state, this
):
    """β of this iteration, from velocities with that of the last one."""
    V, w, lag, V1, q = state[2], state[8], state[10], this[2], this[10]
    end_velocities(mass, V, V1, this[1][3], w, lag, scheme[1], scheme[0], q)
    choose_memory(mass, V, V1, w, q, lag)


@compiled
def _add_momenta(  # type: ignore[no-untyped-def]
    mass, damping, dead, scheme, state, this
):
    """Add rates of momenta, and damping that goes with mass."""
    h, χ = scheme[0], scheme[1]
    V, w, lag = state[2], state[8], state[10]
    rows, V1, losses, forces, q = this[1], this[2], this[6], this[9], this[10]
    mean, delta = rows[1], rows[3]
    n = V.shape[0]
    end_velocities(mass, V, V1, delta, w, lag, χ, h, q)
    if damping[0].shape[0] > 0:
        for i in range(n):
            for k in range(4):
                for j in range(3):
                    q[0, i, k, j] = delta[i, k, j] / h
        inertia.multiply(damping[0], damping[1], damping[2], q[0], q[1])
        _on_directors(mean, q[1], forces)
        losses[1] += h * np.sum(q[0] * q[1])
        for i in range(n):
            add_dead(losses, BY_LOADS, -1.0, mean[i], q[1, i])
    for i in range(n):
        for k in range(4):
            for j in range(3):
                q[0, i, k, j] = (V1[i, k, j] - V[i, k, j]) / h
    inertia.multiply(mass[0], mass[1], mass[2], q[0], q[1])
    for i in range(n):
        for k in range(4):
            for j in range(3):
                q[1, i, k, j] -= dead[i, k, j]
    _on_directors(mean, q[1], forces)
    if χ > 0.0:
        losses[2] += velocity_loss(mass, V, V1, delta, h, q)


@compiled
def _on_directors(mean: Array, f: Array, forces: Array) -> None:
    """Add forces on (x, d₁, d₂, d₃) (n, 4, 3) to forces and moments (n, 6)."""
    for i in range(forces.shape[0]):
        moment = load(forces[i], 3)
        for k in range(1, 4):
            moment = plus(moment, cross(load_row(mean[i], k), load_row(f[i], k)))
        store(forces[i], 0, plus(load(forces[i], 0), load_row(f[i], 0)))
        store(forces[i], 3, moment)


@compiled
def _add_loads(loads: tuple[Any, ...], middle: Array, forces: Array) -> None:
    """Subtract moments fixed in space and loads that follow the half-way frames."""
    moment, following = loads[1], loads[2]
    for i in range(forces.shape[0]):
        m, f = middle[i], following[i]
        for at in (0, 3):
            turned = rotate(load_row(m, 1), load_row(m, 2), load_row(m, 3), load(f, at))
            store(forces[i], at, minus(load(forces[i], at), turned))
        store(forces[i], 3, minus(load(forces[i], 3), load(moment[i], 0)))
