"""One step that conserves energy and momenta, on all nodes: residual, correction, acceptance.

Compiled loops over the steps; the formulas stand in :mod:`fem_lie.solve.energy_momentum`.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fem_lie import inertia
from fem_lie._jit import Array, Indices, compiled, inlined
from fem_lie._lie_tuples import (
    Vector,
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
from fem_lie.solve import cells as elements
from fem_lie.solve.between import advance, follow, span
from fem_lie.solve.discrete_gradient import add_elastic
from fem_lie.solve.factors import solve
from fem_lie.solve.joints_between import add_joints
from fem_lie.solve.scheme import ROTATION


class Model(NamedTuple):
    """What does not change in a step, as plain tuples.

    Attributes:
        cells: See :class:`~fem_lie.solve.cells.CellTable`.
        joints: See :class:`~fem_lie.constraints.JointTable`.
        inertia: See :class:`~fem_lie.nodal.Inertia`.
        attachment: Leaders and offsets of all nodes.
        held: Which unknowns are zero, (n, 6).
        measure: Size of each unknown and scaled multiplier, shape (6 n + m,).
        scale: Factor of each constraint, (m,).
        dead: Forces fixed in space on (x, d₁, d₂, d₃), (n, 4, 3).
        h: Step size.
    """

    cells: tuple[Any, ...]
    joints: tuple[Any, ...]
    inertia: tuple[Any, ...]
    attachment: tuple[Any, ...]
    held: Any
    measure: Array
    scale: Array
    dead: Array
    h: float


class State(NamedTuple):
    """Start of a step, and its end with index 1.

    Attributes:
        H: Frames of all rows, ground and prescribed motions last, (n + 1 + p, 4, 3).
        rest: Digits of ``H`` that do not fit into it, (n, 4, 3).
        H1: Frames at the end.
        V: Velocities of (x, d₁, d₂, d₃), (n, 4, 3).
        V1: At the end.
        step: Spatial translation and rotation of the nodes in the step, (n, 6).
        delta: Increments of all rows.
        mean: Means of all rows.
        middle: Mean positions with half-way rotations, of all rows.
        weights: Multipliers, (m,).
        gap: Values of the constraints, (m,).
        F: Forces of the cells at the start, (places, 6).
        F1: At the end.
        W: Energies of the cells at the start, (M,).
        W1: At the end.
        account: Work done on each cell, (M,).
        work: In this step.
    """

    H: Array
    rest: Array
    H1: Array
    V: Array
    V1: Array
    step: Array
    delta: Array
    mean: Array
    middle: Array
    weights: Array
    gap: Array
    F: Array
    F1: Array
    W: Array
    W1: Array
    account: Array
    work: Array


class Work(NamedTuple):
    """Memory of a step without meaning between two of them.

    Attributes:
        nodes: Start, end, mean, increments, and those with the rest, of all nodes, (5, N, 4, 3).
        steps: Their steps, and forces on them, (2, N, 6).
        forces: On the leaders, (n, 6).
        q: For inertia, (2, n, 4, 3).
        change: Of the constraints, (m,).
        r: Residual, solution and work of the solver, (3, 6 n + m).
    """

    nodes: Array
    steps: Array
    forces: Array
    q: Array
    change: Array
    r: Array


@compiled
def begin(model: tuple[Any, ...], state: tuple[Any, ...]) -> float:
    """Predict the step; returns the size of its largest motion."""
    held, measure, h = model[4], model[5], model[8]
    H, V, step = state[0], state[3], state[5]
    largest = 0.0
    for i in range(step.shape[0]):
        spin = (0.0, 0.0, 0.0)
        for k in range(1, 4):
            spin = plus(spin, cross(load_row(H[i], k), load_row(V[i], k)))
        _hold(H[i], held[i], scaled(h, load_row(V[i], 0)), scaled(0.5 * h, spin), step[i])
        for k in range(6):
            largest = max(largest, abs(step[i, k]) * measure[6 * i + k])
    return largest


@inlined
def _hold(H: Array, held: Any, u: Vector, ψ: Vector, step: Array) -> None:
    """``step = (u, ψ)`` without its parts along the held axes of the frame."""
    any_held = False
    for k in range(6):
        any_held = any_held or held[k]
    if any_held:
        a = rotate_back(load_row(H, 1), load_row(H, 2), load_row(H, 3), u)
        b = rotate_back(load_row(H, 1), load_row(H, 2), load_row(H, 3), ψ)
        a = (0.0 if held[0] else a[0], 0.0 if held[1] else a[1], 0.0 if held[2] else a[2])
        b = (0.0 if held[3] else b[0], 0.0 if held[4] else b[1], 0.0 if held[5] else b[2])
        u = rotate(load_row(H, 1), load_row(H, 2), load_row(H, 3), a)
        ψ = rotate(load_row(H, 1), load_row(H, 2), load_row(H, 3), b)
    store(step, 0, u)
    store(step, 3, ψ)


@compiled
def residual(model: tuple[Any, ...], state: tuple[Any, ...], space: tuple[Any, ...]) -> None:
    """Twice the balance of momenta over the step, along the half-way frames, and constraints."""
    cells, joints, mass, attachment, held, measure, scale, dead, h = model
    H, rest, H1, V, V1, step, delta, mean, middle = state[:9]
    weights, gap, F = state[9:12]
    nodes, steps, forces, q, change, r = space
    n = step.shape[0]
    span(H, step, delta, mean, H1, middle)
    _inertia(mass, V, V1, delta, dead, h, q)
    for i in range(n):
        moment = (0.0, 0.0, 0.0)
        for k in range(1, 4):
            moment = plus(moment, cross(load_row(mean[i], k), load_row(q[1, i], k)))
        store(forces[i], 0, load_row(q[1, i], 0))
        store(forces[i], 3, moment)
    if F.shape[0] > 0:
        _elements(cells, attachment, state, space)
    add_joints(mean, delta, joints, weights, change, forces)
    for i in range(n):
        m = middle[i]
        for at in (0, 3):
            local = rotate_back(
                load_row(m, 1), load_row(m, 2), load_row(m, 3), load(forces[i], at)
            )
            store(r[0, 6 * i : 6 * i + 6], at, scaled(2.0, local))
        for k in range(6):
            if held[i, k]:
                r[0, 6 * i + k] = 0.0
    for c in range(weights.shape[0]):
        r[0, 6 * n + c] = scale[c] * (gap[c] + change[c])


@compiled
def _inertia(
    mass: tuple[Any, ...], V: Array, V1: Array, delta: Array, dead: Array, h: float, q: Array
) -> None:
    """``V₁ = 2Δ/h − V`` and ``q[1] = G (V₁ − V)/h − dead``."""
    indptr, indices, blocks = mass
    for i in range(V.shape[0]):
        for k in range(4):
            for j in range(3):
                mean = delta[i, k, j] / h
                V1[i, k, j] = 2.0 * mean - V[i, k, j]
                q[0, i, k, j] = 2.0 / h * (mean - V[i, k, j])
    inertia.multiply(indptr, indices, blocks, q[0], q[1])
    for i in range(V.shape[0]):
        for k in range(4):
            for j in range(3):
                q[1, i, k, j] -= dead[i, k, j]


@compiled
def _elements(
    cells: tuple[Any, ...],
    attachment: tuple[Any, ...],
    state: tuple[Any, ...],
    space: tuple[Any, ...],
) -> None:
    """Add the elastic forces to those on the leaders."""
    leader, offset, trivial = attachment
    H, rest, H1, _, _, step, delta, mean, _ = state[:9]
    F, F1, W, W1, account, work = state[11:]
    q = space[3][0]
    for i in range(step.shape[0]):
        for k in range(4):
            for j in range(3):
                q[i, k, j] = delta[i, k, j] + rest[i, k, j]
    if trivial:
        elements.evaluate(cells, H, q, F1, W1)
        add_elastic(cells, (H, H1, F, F1, W, W1), (mean, delta, step), account, work, space[2])
        return
    nodes, steps, forces = space[:3]
    follow(H, leader, offset, nodes[0])
    follow(H1, leader, offset, nodes[1])
    follow(mean, leader, offset, nodes[2])
    follow(delta, leader, offset, nodes[3])
    for i in range(leader.shape[0]):
        store(steps[0, i], 0, load_row(nodes[3, i], 0))
        store(steps[0, i], 3, load(step[leader[i]], 3))
    steps[1] = 0.0
    follow(q, leader, offset, nodes[4])
    elements.evaluate(cells, nodes[0], nodes[4], F1, W1)
    ends = (nodes[0], nodes[1], F, F1, W, W1)
    add_elastic(cells, ends, (nodes[2], nodes[3], steps[0]), account, work, steps[1])
    collect(leader, nodes[2], mean, steps[1], forces)


@compiled
def collect(leader: Indices, all_means: Array, mean: Array, given: Array, forces: Array) -> None:
    """Add forces and moments on all nodes, (N, 6), to those on their leaders, (n, 6)."""
    for i in range(leader.shape[0]):
        to = leader[i]
        f, arm = load(given[i], 0), minus(load_row(all_means[i], 0), load_row(mean[to], 0))
        store(forces[to], 0, plus(load(forces[to], 0), f))
        moment = plus(load(given[i], 3), cross(arm, f))
        store(forces[to], 3, plus(load(forces[to], 3), moment))


@compiled
def correction(
    model: tuple[Any, ...], space: tuple[Any, ...], factors: tuple[Any, ...]
) -> float:
    """Solve for the correction; returns the size of its largest part."""
    measure, r = model[5], space[5]
    x, largest = r[1], 0.0
    solve(factors, r[0], r[2], x)
    for k in range(x.shape[0]):
        size = abs(x[k]) * measure[k]
        if size > largest or size != size:  # nan stays
            largest = size
    return largest


@compiled
def correct(model: tuple[Any, ...], state: tuple[Any, ...], space: tuple[Any, ...]) -> None:
    """Apply the correction."""
    held, scale = model[4], model[6]
    H, step, middle, weights = state[0], state[5], state[8], state[9]
    x, n = space[5][1], step.shape[0]
    for i in range(n):
        m, dx = middle[i], x[6 * i : 6 * i + 6]
        u = rotate(load_row(m, 1), load_row(m, 2), load_row(m, 3), load(dx, 0))
        ψ = rotate(load_row(m, 1), load_row(m, 2), load_row(m, 3), load(dx, 3))
        u, ψ = minus(load(step[i], 0), u), minus(load(step[i], 3), ψ)
        _hold(H[i], held[i], u, ψ, step[i])
    for c in range(weights.shape[0]):
        # the matrix knows twice the multipliers, as the residual has twice their forces
        weights[c] -= 0.5 * scale[c] * x[6 * n + c]


@compiled
def accept(model: tuple[Any, ...], state: tuple[Any, ...], space: tuple[Any, ...]) -> None:
    """Make the end of the step the start of the next."""
    H, rest, H1, V, V1, step, delta = state[:7]
    gap, F, F1, W, W1, account, work = state[10:]
    change = space[4]
    n = step.shape[0]
    advance(H[:n], rest, delta[:n])
    for i in range(n, H.shape[0]):
        for k in range(4):
            store_row(H[i], k, load_row(H1[i], k))
    V[:] = V1
    F[:], W[:] = F1, W1
    for e in range(account.shape[0]):
        account[e] += work[e]
    for c in range(gap.shape[0]):
        gap[c] += change[c]


STEPS, ITERATION, TOTAL, BEST, ASKED, STALLS = 0, 1, 2, 3, 4, 5
"""Counters: steps made, iterations of the present one and of all, fewest, iteration agreed on, and
iterations of the present step that did not halve the increment."""
PREVIOUS, RATIO, MOTION, EXCESS, INCREMENT, LEAST, FLOOR = 0, 1, 2, 3, 4, 5, 6
"""Numbers: last increment, ratio, largest motion, iterations beyond the fewest, increment, the
least of the present step, and the least that round-off lets one expect."""
DONE, MATRIX, FAILED = 0, 1, 2
ULPS = 1e3 * float(np.finfo(np.float64).eps)


@compiled
def run(
    model: tuple[Any, ...],
    state: tuple[Any, ...],
    space: tuple[Any, ...],
    factors: tuple[Any, ...],
    options: tuple[float, int, int, float],
    counters: Indices,
    numbers: Array,
    last: int,
) -> int:
    """Go on until step ``last``, or until a new matrix is wanted, or a step fails.

    Args:
        model: See :class:`Model`; ``state`` and ``space`` likewise.
        factors: Of the matrix.
        options: Tolerance (0: until nothing changes), most iterations, patience and cost as of
            :class:`~fem_lie.solve.policies.Automatic`.
        counters: Shape (5,), updated.
        numbers: Shape (5,), updated.
        last: Step to reach.
    """
    tolerance, limit, patience, cost = options
    while counters[STEPS] < last:
        if counters[ITERATION] == 0:
            numbers[MOTION] = max(begin(model, state), numbers[MOTION])
            numbers[PREVIOUS] = numbers[LEAST] = np.inf
            counters[ITERATION], counters[STALLS] = 1, 0
        iteration = counters[ITERATION]
        if counters[ASKED] != iteration:
            due = numbers[EXCESS] >= cost if iteration == 1 else (iteration - 1) % patience == 0
            counters[ASKED] = iteration
            if due:
                return MATRIX
        residual(model, state, space)
        numbers[INCREMENT] = correction(model, space, factors)
        counters[TOTAL] += 1
        settled = _settled(counters, numbers)
        if settled or _converged(numbers, tolerance, iteration):
            # a correction that is noise is not made: what is accepted must be of one piece
            if not settled:
                correct(model, state, space)
                residual(model, state, space)
            accept(model, state, space)
            counted = max(iteration, 2)
            if counters[BEST] == 0 or counted < counters[BEST]:
                counters[BEST] = counted
            numbers[EXCESS] += counted - counters[BEST]
            counters[STEPS] += 1
            counters[ITERATION] = counters[ASKED] = 0
        elif iteration == limit or not numbers[INCREMENT] < 1e3:
            return FAILED
        else:
            correct(model, state, space)
            numbers[PREVIOUS] = numbers[INCREMENT]
            counters[ITERATION] += 1
    return DONE


@inlined
def _settled(counters: Indices, numbers: Array) -> bool:
    """Whether only round-off is left: twice no longer halved, or as small as that was before."""
    increment, least = numbers[INCREMENT], numbers[LEAST]
    if increment > 0.5 * least:
        counters[STALLS] += 1
    numbers[LEAST] = min(increment, least)
    known = increment <= 2.0 * numbers[FLOOR]
    if not known and (counters[STALLS] < 2 or increment > ULPS):
        return False
    floor = max(numbers[LEAST], 0.9 * numbers[FLOOR])
    numbers[FLOOR] = floor if numbers[FLOOR] == 0.0 else min(floor, 2.0 * numbers[FLOOR])
    return True


@inlined
def _converged(numbers: Array, tolerance: float, iteration: int) -> bool:
    """Whether what would follow is below the tolerance, or nothing would."""
    increment = numbers[INCREMENT]
    if tolerance > 0.0 and iteration > 1:
        ratio = max(increment / numbers[PREVIOUS], 0.7 * numbers[RATIO])
        numbers[RATIO] = ratio
        if ratio < 1.0 and increment * ratio / (1.0 - ratio) <= tolerance * numbers[MOTION]:
            return True
    return increment == 0.0
