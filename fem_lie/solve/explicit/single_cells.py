"""Forces of cells that leave their data alone: of one by itself, and of all in a sum."""

from __future__ import annotations

import numba

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined
from fem_lie._jit.stack import stack
from fem_lie.forms.cell_forms import APART, CELLS, EXTENT, FIRST, KERNEL, NODES, WIDTH, C, W, X
from fem_lie.forms.kernels.addresses import Pointer, call_kernel, pointer


@compiled
def room_for(rows: Indices) -> tuple[int, int]:
    """Most coefficients of a cell, and most of its forces."""
    width = most = 1
    for f in range(rows.shape[0]):
        width = max(width, rows[f, APART] + rows[f, WIDTH])
        most = max(most, 6 * rows[f, NODES])
    return width, most


@inlined
def cell_forces(
    H: Array, row: Indices, nodes: Indices, e: int, data: Pointer, place: Pointer
) -> int:
    """Forces on the nodes of cell ``e`` of a form; the cell's own data are not written to.

    Args:
        H: Frames of the nodes, shape (≥ count, 4, 3).
        row: Of the table.
        nodes: Of the table.
        e: Which cell.
        data: Room for all coefficients of a cell.
        place: Six numbers of each of its nodes, overwritten.

    Returns:
        Where its nodes begin in ``nodes``.
    """
    count, width, apart = row[NODES], row[WIDTH], row[APART]
    first = row[FIRST] + count * e
    packed, values = numba.carray(data, (apart + width,)), numba.carray(place, (6 * count,))
    given = numba.carray(pointer(row[W] + 8 * width * e), (width,))
    k = 0
    for i in range(first, first + count):
        node = nodes[i]
        for a in range(4):
            for j in range(3):
                packed[k] = H[node, a, j]
                k += 1
    for j in range(k, apart + width):
        packed[j] = given[j - apart]
    for j in range(6 * count):
        values[j] = 0.0
    x = pointer(row[X] + 8 * row[EXTENT] * e)
    call_kernel(row[KERNEL], place, data, pointer(row[C]), x)
    return first


@compiled
def add_all(H: Array, rows: Indices, nodes: Indices, r: Array) -> None:
    """Add the forces of all cells to a residual.

    With many cells most of the time would be spent on writing frames to the data of each, which
    then go back to memory: here they are written to one place, over and over.

    Args:
        H: Frames of the nodes, shape (≥ n, 4, 3).
        rows: Of the table.
        nodes: Of the table.
        r: Shape (6 n,), updated.
    """
    width, most = room_for(rows)
    data, place = stack(width), stack(most)
    values = numba.carray(place, (most,))
    for f in range(rows.shape[0]):
        count = rows[f, NODES]
        for e in range(rows[f, CELLS]):
            first = cell_forces(H, rows[f], nodes, e, data, place)
            for i in range(count):
                for k in range(6):
                    r[6 * nodes[first + i] + k] += values[6 * i + k]
