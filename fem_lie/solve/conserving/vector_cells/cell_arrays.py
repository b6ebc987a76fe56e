"""Vector coordinates of nodes, and their packing for the kernels of cells; compiled.

A node has :func:`~fem_lie.lie.node_types.node_type.vector_count`, one or two, such vectors. Here
they are the two halves of six numbers, along global axes.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined, inlined_uncounted, uncounted
from fem_lie._jit.packed_arrays import Integers1, Integers3, Numbers1, Numbers2
from fem_lie._jit.stack import stack, vector_at
from fem_lie.forms.cell_forms import coefficients
from fem_lie.forms.kernels.addresses import Pointer, call_kernel, pointer
from fem_lie.lie.node_types.node_type import (
    POSITION_GRADIENT,
    axes,
    first_vector,
    set_axes,
    vector_count,
)
from fem_lie.lie.tuples import (
    cross,
    dot,
    load,
    load_row,
    minus,
    rotate,
    scaled,
    store,
    store_row,
)

FORCES, ENERGY = 0, 1
"""Kernels of a cell."""
NOTHING, DIRECTIONS, POSITIONS = 0, 1, 2
"""Invariance of the energy of a cell: under rigid motions, only under translations, or neither."""


class VectorCells(NamedTuple):
    """All cells of a scene.

    Attributes:
        calls: Kernels of forces and energy, see :class:`~fem_lie.forms.cell_forms.EachCell`, shape
            (M, 2, 6).
        first: Index of the first node of each cell in ``nodes``, shape (M + 1,).
        nodes: Nodes of the cells.
        kinds: Types of these nodes, see :mod:`fem_lie.lie.node_types`.
        weights: Metric of increments of both vectors of each node, zero for missing ones, shape
            (cell nodes, 2).
        sees: Invariance of the energy, see :data:`NOTHING`, shape (M,).
        cancels: Error of the energy of each cell if it is a difference of larger numbers, beyond
            the round-off of positions, else zero, shape (M,).
    """

    calls: Integers3
    first: Integers1
    nodes: Integers1
    kinds: Integers1
    weights: Numbers2
    sees: Integers1
    cancels: Numbers1


@inlined
def has_position(kind: int) -> bool:
    """Whether the first vector of such a node is a position, which translations move."""
    return first_vector(kind) == 0


@inlined_uncounted
def are_positions(cells: VectorCells, e: int) -> bool:
    """Whether all nodes of a cell are position nodes."""
    alone = True
    for a in range(cells.first[e], cells.first[e + 1]):
        alone = alone and has_position(cells.kinds[a]) and vector_count(cells.kinds[a]) == 1
    return alone


@uncounted
def gather(kinds: Indices, nodes: Indices, H: Array, rest: Array, out: Array) -> None:
    """Vectors (k, 2, 3) of a cell's nodes, positions relative to its first node.

    Args:
        kinds: Types of the nodes of the cell.
        nodes: Their numbers.
        H: All nodes, (≥ n, 4, 3).
        rest: Their digits beyond double precision, (≥ n, 4, 3).
        out: Vectors, overwritten.
    """
    out[:] = 0.0
    origin = nodes[0]
    for a in range(nodes.shape[0]):
        i, kind = nodes[a], kinds[a]
        at = first_vector(kind)
        for k in range(vector_count(kind)):
            for j in range(3):
                value, digits = H[i, at + k, j], rest[i, at + k, j]
                if k == 0 and at == 0:
                    # differences of the large parts are exact, those of the small parts have all
                    # digits
                    value, digits = value - H[origin, 0, j], digits - rest[origin, 0, j]
                out[a, k, j] = value + digits


@inlined_uncounted
def write_node(kind: int, H: Array, halves: Array, out: Array) -> None:
    """Node (4, 3) with these vectors and simple axes; ``H``: the current node."""
    at = first_vector(kind)
    out[:] = 0.0
    for k in range(vector_count(kind)):
        store_row(out, at + k, load_row(halves, k))
    if kind == POSITION_GRADIENT:
        along, across = load_row(halves, 1), load_row(H, 2)
        along = scaled(1.0 / sqrt(dot(along, along)), along)
        across = minus(across, scaled(dot(along, across), along))
        across = scaled(1.0 / sqrt(dot(across, across)), across)
        store_row(out, 2, across)
        store_row(out, 3, cross(along, across))
    else:
        set_axes(kind, out, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@inlined
def workspace_size(calls: Indices) -> int:
    """Size of the workspace for coefficients that are not stored with the cell."""
    return calls[4] + calls[5] if calls[5] > 0 else 1


@inlined_uncounted
def _call(cells: VectorCells, e: int, which: int, coordinates: Array, buffer: Pointer) -> None:
    calls = cells.calls[e, which]
    w = coefficients(calls[1], calls[4], calls[5], stack(workspace_size(calls)))
    packed, at = vector_at(w, 12 * coordinates.shape[0]), 0
    for a in range(coordinates.shape[0]):
        for k in range(4):
            for j in range(3):
                packed[at] = coordinates[a, k, j]
                at += 1
    call_kernel(calls[0], buffer, w, pointer(calls[2]), pointer(calls[3]))


@uncounted
def energy_of(cells: VectorCells, e: int, H: Array, halves: Array, coordinates: Array) -> float:
    """Energy of a cell with these vectors (k, 2, 3); ``coordinates`` (k, 4, 3) is workspace."""
    begin = cells.first[e]
    for a in range(coordinates.shape[0]):
        write_node(cells.kinds[begin + a], H[cells.nodes[begin + a]], halves[a], coordinates[a])
    buffer = stack(1)
    out = vector_at(buffer, 1)
    out[0] = 0.0
    _call(cells, e, ENERGY, coordinates, buffer)
    return float(out[0])


@uncounted
def forces_of(
    cells: VectorCells, e: int, H: Array, halves: Array, coordinates: Array, out: Array
) -> None:
    """Forces (k, 2, 3) on a cell with these vectors (k, 2, 3); ``coordinates`` is workspace."""
    begin, count = cells.first[e], coordinates.shape[0]
    for a in range(count):
        write_node(cells.kinds[begin + a], H[cells.nodes[begin + a]], halves[a], coordinates[a])
    buffer = stack(6 * count)
    found = vector_at(buffer, 6 * count)
    found[:] = 0.0
    _call(cells, e, FORCES, coordinates, buffer)
    out[:] = 0.0
    for a in range(count):
        kind = cells.kinds[begin + a]
        d1, d2, d3 = axes(kind, coordinates[a])
        for k in range(vector_count(kind)):
            store_row(out[a], k, rotate(d1, d2, d3, load(found, 6 * a + 3 * k)))


@inlined
def spread(kind: int, halves: Array, out: Array) -> None:
    """Vectors (6,) as nodal coordinates (4, 3); the others are zero."""
    at = first_vector(kind)
    out[:] = 0.0
    for k in range(vector_count(kind)):
        store_row(out, at + k, load(halves, 3 * k))


@inlined
def gathered(kind: int, coordinates: Array, out: Array) -> None:
    """Inverse of :func:`spread`; missing vectors are zero."""
    at = first_vector(kind)
    out[:] = 0.0
    for k in range(vector_count(kind)):
        store(out, 3 * k, load_row(coordinates, at + k))


@compiled
def largest_cell(first_nodes: Indices) -> int:
    """Number of nodes of the largest cell, at least one."""
    most = 1
    for e in range(first_nodes.shape[0] - 1):
        most = max(most, first_nodes[e + 1] - first_nodes[e])
    return most
