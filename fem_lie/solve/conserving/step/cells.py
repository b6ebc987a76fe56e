"""Forces over a step on all nodes, attached ones included: elements, their viscosity, pressure."""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined, uncounted
from fem_lie._jit.records import Record
from fem_lie._jit.stack import stack, vector_at
from fem_lie.bodies.balances import BY_LOADS, DAMPING, NUMERICAL, WORK
from fem_lie.forms import cells as elements
from fem_lie.forms.cells import CellArrays
from fem_lie.lie.tuples import (
    add_wrench,
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
from fem_lie.solve.conserving.midpoint.any_node import pull_edges, turn_edges
from fem_lie.solve.conserving.midpoint.cayley import set_attached_nodes
from fem_lie.solve.conserving.midpoint.discrete_gradient import Energies, Filtered, add_elastic
from fem_lie.solve.conserving.midpoint.mean_forces import Ends, Path
from fem_lie.solve.conserving.midpoint.reduced_bodies import add_elastic as add_of_bodies
from fem_lie.solve.conserving.step.packing import model_of, state_of, step_of
from fem_lie.solve.conserving.step.records import Masters, Segments, Step, span_of
from fem_lie.solve.conserving.vector_cells.cells import Energies as RowEnergies
from fem_lie.solve.conserving.vector_cells.cells import Nodes
from fem_lie.solve.conserving.vector_cells.cells import add_elastic as add_of_vector_cells
from fem_lie.solve.conserving.vector_cells.force_changes import CellForces, add_changes
from fem_lie.solve.conserving.vector_cells.position_cells import add_position_cells


class Motion(NamedTuple):
    """Motion of all nodes in a step, see :class:`~fem_lie.solve.conserving.step.records.Step`.

    Attributes:
        start: Frames at the start, (N, 4, 3), like the next five.
        end: Frames at the end.
        mean: Means.
        middle: Midpoint frames.
        delta: Increments.
        exact: Increments with the digits beyond double precision of the frames.
        step: Translation and rotation, (N, 6).
    """

    start: Array
    end: Array
    mean: Array
    middle: Array
    delta: Array
    exact: Array
    step: Array


@uncounted
def add_from_nodes(packed: Indices, starts: Indices, steps: Indices, reevaluate: bool) -> None:
    """Add the forces of all cells and of pressure.

    Without ``reevaluate``: the last forces, and energies by their work.
    """
    model, state = model_of(packed), state_of(starts)
    known = _repayment(state.filter_state[0]), state.filter_state[0].all_squares
    vector_cells, bodies = model.vector_cells.sees.shape[0], step_of(steps).products.shape[0]
    if vector_cells + bodies == 0:
        _add_from_frames(packed, starts, steps, reevaluate, known)
        return
    changes = step_of(steps).changes
    if model.scheme.dissipation > 0.0:
        reevaluate = True
        state.filter_state[0].change_work = state.filter_state[0].filter_work = 0.0
        for i in range(changes.shape[1]):
            for k in range(6):
                changes[0, i, k] = changes[1, i, k] = 0.0
    _add_from_frames(packed, starts, steps, reevaluate, known)
    if vector_cells > 0:
        _add_from_vector_cells(packed, starts, steps, known)
    if bodies > 0:
        _add_from_bodies(packed, starts, steps)


@uncounted
def _add_from_bodies(packed: Indices, starts: Indices, steps: Indices) -> None:
    """Add elastic forces of reduced-order bodies."""
    model, state, this = model_of(packed), state_of(starts), step_of(steps)
    along, first = span_of(this.coordinates), state.W.shape[0] - model.bodies[0][0]
    nodes, motion = (state.H, state.rest), (along.mean, along.delta)
    energies, out = (this.W1[first:], this.work[first:]), (this.forces, this.changes)
    own, works = (this.within, state.within), vector_at(stack(2), 2)
    works[0] = works[1] = 0.0
    add_of_bodies(model.bodies, model.kinds, nodes, motion, *own, energies, out, works)
    state.filter_state[0].change_work += works[0]
    state.filter_state[0].filter_work += works[1]


@uncounted
def _add_from_vector_cells(
    packed: Indices, starts: Indices, steps: Indices, known: tuple[float, float]
) -> None:
    """Add the forces of cells of nodes other than frames.

    Args:
        packed: The model.
        starts: The state.
        steps: The step.
        known: Factor of forces that remove the energy added by round-off, and the sum of ``|s|²``
            over all cells in the last iteration.
    """
    model, state, this = model_of(packed), state_of(starts), step_of(steps)
    cells, filter_state, M, count = (
        model.vector_cells,
        state.filter_state[0],
        this.gains.shape[0],
        model.total,
    )
    repay, squares = known
    factors = repay, squares / count, ULP * filter_state.energy / count
    nodes = Nodes(state.H, state.rest, this.step)
    energies = RowEnergies(state.W[M:], state.account[M:], this.W1[M:], this.work[M:])
    found = add_of_vector_cells(cells, nodes, energies, factors, this.forces)
    found += add_position_cells(cells, nodes, energies, factors, this.forces)
    filter_state.row_squares, filter_state.row_repaid = found, repay * found
    if model.scheme.dissipation == 0.0:
        return
    cell_forces, changes = this.cell_forces, this.changes
    forces = CellForces(
        state.cell_forces[0], state.cell_forces[1], cell_forces[0], cell_forces[1], cell_forces[2]
    )
    by_change, by_filter = add_changes(cells, nodes, forces, changes)
    filter_state.change_work += by_change
    filter_state.filter_work += by_filter


@uncounted
def _add_from_frames(
    packed: Indices,
    starts: Indices,
    steps_of: Indices,
    reevaluate: bool,
    known: tuple[float, float],
) -> None:
    """Add the forces of cells of frames and of pressure to those on the master nodes."""
    model, state, this = model_of(packed), state_of(starts), step_of(steps_of)
    master, offset, trivial, edges = model.masters
    H, step, forces = state.H, this.step, this.forces
    coordinates, nodes, exact = span_of(this.coordinates), span_of(this.nodes), this.exact
    if model.cells.x.shape[0] == 0:  # rigid bodies only
        return
    for i in range(step.shape[0]):
        for k in range(4):
            for j in range(3):
                exact[i, k, j] = coordinates.delta[i, k, j] + state.rest[i, k, j]
    steps, on_all, further = this.steps, this.on_nodes, this.twists
    if trivial:
        motion = Motion(
            H,
            coordinates.end,
            coordinates.mean,
            coordinates.middle,
            coordinates.delta,
            exact,
            steps,
        )
    else:
        own = this.q[0]
        for i in range(step.shape[0]):
            for k in range(4):
                store_row(own[i], k, load_row(exact[i], k))
        set_attached_nodes(H, master, offset, this.start)
        for k in range(4):
            set_attached_nodes(this.coordinates[k], master, offset, this.nodes[k])
        set_attached_nodes(own, master, offset, exact)
        motion = Motion(this.start, nodes.end, nodes.mean, nodes.middle, nodes.delta, exact, steps)
    for i in range(master.shape[0]):
        for k in range(3):
            u, ψ = motion.delta[i, 0, k], step[master[i], 3 + k]
            further[i, k], further[i, 3 + k] = u - steps[i, k], -steps[i, 3 + k]
            steps[i, k], steps[i, 3 + k] = u, ψ
    if edges.shape[0] > 0:
        moved = motion.delta, motion.mean, motion.end, motion.middle, exact
        turn_edges(edges, motion.start, moved, steps)
    for i in range(master.shape[0]):
        for k in range(3, 6):
            further[i, k] += steps[i, k]
    if reevaluate or model.viscous or model.pressure.pairs.shape[0] > 0:
        for i in range(on_all.shape[0]):
            for k in range(6):
                on_all[i, k] = 0.0
        _add_cells(packed, starts, steps_of, motion, known, on_all)
        this.losses[WORK] += _add_pressure(model.pressure, motion, on_all, this.losses)
    else:
        _move_cells(packed, starts, steps_of, motion.end, further)
    if trivial:
        for i in range(forces.shape[0]):
            for k in range(6):
                forces[i, k] += on_all[i, k]
    else:
        collect(model.masters, this, on_all, forces)


@uncounted
def _move_cells(
    packed: Indices, starts: Indices, steps: Indices, end: Array, further: Array
) -> None:
    """Energies and works after a motion (N, 6) that is too small to change forces.

    Together they are the work of the forces over the step, so that errors do not accumulate; each
    cell gets the part of its forces at the end.
    """
    cells, state, this = model_of(packed).cells, state_of(starts), step_of(steps)
    first, nodes, F, filter_state, filtered = (
        cells.first,
        cells.nodes,
        this.F1,
        state.filter_state[0],
        this.filtered,
    )
    gains, expected, sizes, done = this.gains, 0.0, 0.0, 0.0
    for e in range(gains.shape[0]):
        gains[e] = 0.0
        for a in range(first[e], first[e + 1]):
            m, d = end[nodes[a]], further[nodes[a]]
            for at in (0, 3):
                f = rotate(load_row(m, 1), load_row(m, 2), load_row(m, 3), load(F[a], at))
                gains[e] += dot(f, load(d, at))
        expected += gains[e]
        sizes += abs(gains[e])
    for i in range(further.shape[0]):
        for k in range(6):
            done += this.on_nodes[i, k] * further[i, k]
            filter_state.change_work += filtered[0, i, k] * further[i, k]
            filter_state.filter_work += filtered[1, i, k] * further[i, k]
    rest = (done - expected) / sizes if sizes > 0.0 else 0.0
    for e in range(gains.shape[0]):
        gain = gains[e] + rest * abs(gains[e])
        this.W1[e] += gain
        this.work[e] += gain


ULP = float(np.finfo(np.float64).eps)


@uncounted
def _add_cells(
    packed: Indices,
    starts: Indices,
    steps: Indices,
    motion: Motion,
    before: tuple[float, float],
    out: Array,
) -> None:
    """Add elastic, filtered and viscous forces of the cells to those on all nodes."""
    model, state, this = model_of(packed), state_of(starts), step_of(steps)
    cells, h, filter_state, dissipates = (
        model.cells,
        model.scheme.h,
        state.filter_state[0],
        model.scheme.dissipation > 0.0,
    )
    H, end, mean, middle, delta, more, step = motion
    M, count = this.gains.shape[0], model.total
    elements.evaluate(cells, H, more, this.F1, this.W1[:M])
    ends = Ends(H, end, state.F, this.F1)
    path = Path(mean, delta, step)
    energies = Energies(state.W[:M], this.W1[:M], state.account[:M])
    repay, squares = before
    typical, unknown = squares / count, ULP * filter_state.energy / count
    known = repay, typical, unknown
    other = Filtered(dissipates, state.w_F, this.filtered)
    found = add_elastic(cells, ends, path, energies, this.work[:M], known, other, out)
    filter_state.squares, filter_state.change_work, filter_state.filter_work = found
    filter_state.repaid = repay * filter_state.squares
    if model.viscous:
        twists = this.twists
        for i in range(step.shape[0]):
            m = middle[i]
            for at in (0, 3):
                rate = scaled(1.0 / h, load(step[i], at))
                turned = rotate_back(load_row(m, 1), load_row(m, 2), load_row(m, 3), rate)
                store(twists[i], at, turned)
        this.losses[DAMPING] += h * _add_viscous(cells, middle, twists, this.F_viscous, out)


@uncounted
def add_filtered_forces(packed: Indices, starts: Indices, steps: Indices) -> None:
    """Add forces of the changes of elastic forces minus their filter state, to the master nodes."""
    model, state, this = model_of(packed), state_of(starts), step_of(steps)
    masters, scheme = model.masters, model.scheme
    filter_state, given, losses = state.filter_state[0], this.filtered, this.losses
    a = 0.5 * scheme.dissipation * filter_state.active * filter_state.elastic
    b = a * filter_state.gain
    others = model.vector_cells.sees.shape[0] + this.products.shape[0]
    if model.cells.x.shape[0] > 0 or others > 0:
        losses[NUMERICAL] += a * filter_state.change_work - b * filter_state.filter_work
    if others > 0:
        for i in range(this.forces.shape[0]):
            for k in range(6):
                this.forces[i, k] += a * this.changes[0, i, k] - b * this.changes[1, i, k]
    if model.cells.x.shape[0] == 0:
        return
    if masters.trivial:
        on_all = this.forces
    else:
        on_all = this.filtered[2]
        for i in range(on_all.shape[0]):
            for k in range(6):
                on_all[i, k] = 0.0
    for i in range(on_all.shape[0]):
        for k in range(6):
            on_all[i, k] += a * given[0, i, k] - b * given[1, i, k]
    if not masters.trivial:
        collect(masters, this, on_all, this.forces)


@inlined
def _repayment(filter_state: Record) -> float:
    """Factor of forces that remove the energy added by round-off, as small as round-off."""
    leak, squares = filter_state.leak, filter_state.all_squares
    if squares == 0.0:
        return 0.0
    # a force of full size would change its sign with a round-off deformation, and maintain it
    most = 0.1 * filter_state.limit / sqrt(squares)
    return max(-most, min(most, leak / squares))


@uncounted
def _add_viscous(cells: CellArrays, middle: Array, twists: Array, F: Array, out: Array) -> float:
    """Add viscous forces at the midpoint frames; returns their power."""
    first, nodes, power = cells.first, cells.nodes, 0.0
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


@uncounted
def _add_pressure(pressure: Segments, motion: Motion, out: Array, losses: Array) -> float:
    """Subtract ``½ (x_j − x_i) × ½ (R_i + R_j) w`` on both nodes of each segment; returns work."""
    pairs, across = pressure
    mean, middle, delta, work = motion.mean, motion.middle, motion.delta, 0.0
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


@uncounted
def collect(masters: Masters, this: Step, given: Array, forces: Array) -> None:
    """Add forces and moments on all nodes, (N, 6), to those on their master nodes, (n, 6)."""
    master, _, _, edges = masters
    all_means, mean = span_of(this.nodes).mean, span_of(this.coordinates).mean
    if edges.shape[0] > 0:
        pull_edges(edges, this.start, all_means, (master, mean), given, forces)
    for i in range(master.shape[0]):
        to = master[i]
        f, arm = load(given[i], 0), minus(load_row(all_means[i], 0), load_row(mean[to], 0))
        store(forces[to], 0, plus(load(forces[to], 0), f))
        moment = plus(load(given[i], 3), cross(arm, f))
        store(forces[to], 3, plus(load(forces[to], 3), moment))
