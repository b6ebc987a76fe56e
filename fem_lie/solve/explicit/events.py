"""Asynchronous steps of cells, compiled: a queue of cells, and free motion of nodes between them.

A node moves under its dead loads from the time of one of its cells to the next. A cell that is due
brings its nodes to its time and applies the impulses of its forces for its own step.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled, inlined
from fem_lie._jit.stack import stack, vector_at
from fem_lie.forms.cell_forms import (
    CELLS,
    FIRST,
    NODES,
    address_of,
    cell_forces,
    most_nodes,
    workspace_size,
)
from fem_lie.lie.tuples import combined, load, load_row, rotate, store_row


class Flight(NamedTuple):
    """Nodes in free motion.

    Attributes:
        H: Frames of all nodes, ground and prescribed motions; positions at the nodes' times.
        v: Velocities in global components, (n, 3).
        times: Times of the nodes, (n,).
        fall: Accelerations by dead loads, (n, 3).
        light: Inverse masses, zero for fixed nodes, (n,).
        held: Which components along the nodes' axes are zero, (n, 3).
    """

    H: Array
    v: Array
    times: Array
    fall: Array
    light: Array
    held: Flags


PlainFlight: TypeAlias = tuple[Array, Array, Array, Array, Array, Flags]


class Queue(NamedTuple):
    """Cells of all forms, and the order in which they are due.

    Attributes:
        rows: Packed forms, see :class:`~fem_lie.forms.cell_forms.FormArrays`.
        nodes: Nodes of their cells.
        form: Form of each cell, (m,).
        steps: Step size of each cell, (m,).
        made: Number of steps made by each cell, (m,).
        heap: Binary heap of the cells by their due times, (m,).
    """

    rows: Indices
    nodes: Indices
    form: Indices
    steps: Array
    made: Indices
    heap: Indices


PlainQueue: TypeAlias = tuple[Indices, Indices, Indices, Array, Indices, Indices]


@inlined
def _due(e: int, steps: Array, made: Indices) -> float:
    return steps[e] * made[e]


@compiled
def _sift(steps: Array, made: Indices, heap: Indices) -> None:
    """Move the first cell of the heap to its position."""
    at, count, e = 0, heap.shape[0], heap[0]
    time = _due(e, steps, made)
    while True:
        child = 2 * at + 1
        if child >= count:
            break
        first = _due(heap[child], steps, made)
        if child + 1 < count:
            second = _due(heap[child + 1], steps, made)
            if second < first or (second == first and heap[child + 1] < heap[child]):
                child, first = child + 1, second
        if time < first or (time == first and e < heap[child]):
            break
        heap[at] = heap[child]
        at = child
    heap[at] = e


@inlined
def _fly(flight: PlainFlight, i: int, time: float) -> None:
    """Move a node to a time."""
    H, v, times, fall, light, _ = flight
    dt = time - times[i]
    if dt != 0.0 and light[i] > 0.0:
        speed, g = load_row(v, i), load_row(fall, i)
        x = combined(1.0, load_row(H[i], 0), dt, combined(1.0, speed, 0.5 * dt, g))
        store_row(H[i], 0, x)
        store_row(v, i, combined(1.0, speed, dt, g))
    times[i] = time


@inlined
def _kick(flight: PlainFlight, i: int, size: float, force: Array) -> None:
    """Change a node's velocity by the impulse of a force along its axes."""
    H, v, _, _, light, held = flight
    if light[i] > 0.0:
        for k in range(3):
            if held[i, k]:
                force[k] = 0.0
        f = rotate(load_row(H[i], 1), load_row(H[i], 2), load_row(H[i], 3), load(force, 0))
        store_row(v, i, combined(1.0, load_row(v, i), -size * light[i], f))


@compiled
def run(flight: PlainFlight, queue: PlainQueue, end: float) -> int:
    """Make all steps of cells that are due before a time; returns their number."""
    H = flight[0]
    rows, nodes, form, steps, made, heap = queue
    most = 6 * most_nodes(rows)
    workspace, buffer = stack(workspace_size(rows)), stack(most)
    forces = vector_at(buffer, most)
    before = np.zeros(rows.shape[0] + 1, dtype=np.int64)
    for f in range(rows.shape[0]):
        before[f + 1] = before[f] + rows[f, CELLS]
    count = 0
    while True:
        e = heap[0]
        time = _due(e, steps, made)
        # cells that are due at that time follow: reported states lie in between
        if time >= end - 1e-9 * steps[e]:
            return count
        row = rows[form[e]]
        cell = e - before[form[e]]
        first = row[FIRST] + row[NODES] * cell
        for i in range(first, first + row[NODES]):
            _fly(flight, nodes[i], time)
        cell_forces(address_of(H), row, nodes, cell, workspace, buffer)
        # the first impulse is half a step: forces represent the time around them
        size = steps[e] if made[e] > 0 else 0.5 * steps[e]
        for i in range(row[NODES]):
            _kick(flight, nodes[first + i], size, forces[6 * i : 6 * i + 6])
        made[e] += 1
        _sift(steps, made, heap)
        count += 1


@compiled
def fly(flight: PlainFlight, time: float) -> None:
    """Move all nodes to a time."""
    for i in range(flight[2].shape[0]):
        _fly(flight, i, time)


@compiled
def kick(flight: PlainFlight, size: float, forces: Array) -> None:
    """Change the velocities of all nodes by impulses.

    Args:
        flight: The nodes.
        size: Duration of the forces.
        forces: Forces along the axes of the nodes, (n, 6); those on held components become zero.
    """
    for i in range(forces.shape[0]):
        _kick(flight, i, size, forces[i])


@compiled
def state_at(flight: PlainFlight, queue: PlainQueue, time: float, out: PlainFlight) -> None:
    """All nodes at one time, with the velocities due to forces up to then.

    Args:
        flight: The nodes.
        queue: The cells, none of which is due before that time.
        time: The time.
        out: A copy of the nodes, overwritten.
    """
    rows, nodes, _, steps, made, _ = queue
    out[0][:], out[1][:], out[2][:] = flight[0], flight[1], flight[2]
    fly(out, time)
    most = 6 * most_nodes(rows)
    workspace, buffer = stack(workspace_size(rows)), stack(most)
    forces = vector_at(buffer, most)
    e = 0
    for f in range(rows.shape[0]):
        for cell in range(rows[f, CELLS]):
            first = cell_forces(address_of(out[0]), rows[f], nodes, cell, workspace, buffer)
            kicked = (made[e] - 0.5) * steps[e] if made[e] > 0 else 0.0
            for i in range(rows[f, NODES]):
                _kick(out, nodes[first + i], time - kicked, forces[6 * i : 6 * i + 6])
            e += 1
