"""Sums over cells of any stencil, by addresses of kernels and data, in one compiled call.

It does what DOLFINx's assembly does, in one call, and writes the frames of each cell's nodes to the
head of its packed coefficients. For twenty beams this takes half the time. A form is a row of
integers, so that any number of forms is passed as two arrays.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numba
import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled, inlined, uncounted
from fem_lie._jit.stack import stack, vector_at
from fem_lie.forms.kernels.addresses import Pointer, call_kernel, pointer, shift

KERNEL, CELLS, NODES, FIRST, W, WIDTH, C, X, EXTENT, GATHERED = range(10)
"""Columns of a row of :class:`FormArrays`.

Address of the kernel; number of cells, nodes per cell, index of the first node; address and length
of the coefficients, address of the constants, address and length of the coordinates; number of
coefficients before these that are written for each cell and not stored: twelve per node and those
that the kernel writes, or none.
"""

NO_ROWS: Indices = np.empty((0, GATHERED + 1), dtype=np.int64)
"""Table without forms."""


class FormArrays(NamedTuple):
    """Forms to be summed.

    Attributes:
        rows: Addresses and sizes of each form, shape (f, 10).
        nodes: Nodes of all cells of all forms.
    """

    rows: Indices
    nodes: Indices


class EachCell(NamedTuple):
    """Cells of some forms, for schemes that call kernels cell by cell.

    Attributes:
        calls: Addresses of kernel, coefficients, constants and coordinates of each cell, number of
            its coefficients, and number of shared ones before these, shape (m, 6).
        first: Index of its first node, shape (m + 1,).
        nodes: Nodes of all cells.
    """

    calls: Indices
    first: Indices
    nodes: Indices


def each_cell(arrays: FormArrays) -> EachCell:
    """Cells of all forms, in the order of the forms."""
    calls: list[Indices] = [np.empty((0, 6), dtype=np.int64)]
    sizes = [np.zeros(1, dtype=np.int64)]
    for row in arrays.rows:
        own = np.tile(row[[KERNEL, W, C, X, WIDTH, GATHERED]], (row[CELLS], 1))
        own[:, [1, 3]] += 8 * np.arange(row[CELLS])[:, np.newaxis] * row[[WIDTH, EXTENT]]
        calls.append(own)
        sizes.append(np.full(row[CELLS], row[NODES]))
    return EachCell(np.concatenate(calls), np.cumsum(np.concatenate(sizes)), arrays.nodes)


@compiled
def own_coefficients(row: Indices) -> Array:
    """Copies of the coefficients of all cells of a form, with those that kernels read before them.

    Args:
        row: Row of a :class:`FormArrays`.

    Returns:
        Shape (m, any); zero at nodal coordinates.
    """
    width, gathered = row[WIDTH], row[GATHERED]
    out = np.zeros((row[CELLS], gathered + width))
    for e in range(row[CELLS]):
        given = vector_at(pointer(row[W] + 8 * width * e), width)
        for k in range(width):
            out[e, gathered + k] = given[k]
    return out


@inlined
def workspace_size(rows: Indices) -> int:
    """Size of the workspace for coefficients that cells share."""
    most = 1
    for f in range(rows.shape[0]):
        if rows[f, GATHERED] > 0:
            most = max(most, rows[f, WIDTH] + rows[f, GATHERED])
    return most


@inlined
def coefficients(at: int, width: int, gathered: int, workspace: Pointer) -> Pointer:
    """Address of all coefficients for a kernel: workspace, or storage if nothing is shared."""
    if gathered == 0:
        return pointer(at)
    given, found = vector_at(pointer(at), width), vector_at(workspace, gathered + width)
    for k in range(width):
        found[gathered + k] = given[k]
    return workspace


@inlined
def address_of(H: Array) -> Pointer:
    """Address of contiguous nodal frames; ``TypeError`` for others."""
    if not H.flags.c_contiguous:
        raise TypeError("nodal frames must be a contiguous array")
    return pointer(H.ctypes.data)


@inlined
def evaluate(
    H: Pointer, row: Indices, nodes: Indices, e: int, workspace: Pointer, buffer: Pointer
) -> int:
    """Evaluate the kernel of a form for its cell ``e``.

    Args:
        H: Frames of the nodes, contiguous.
        row: Row of the table.
        nodes: Nodes of all cells.
        e: Index of the cell.
        workspace: Of :func:`workspace_size`, for coefficients.
        buffer: Result, added to.

    Returns:
        Index of the cell's first node in ``nodes``.
    """
    count, width = row[NODES], row[WIDTH]
    first = row[FIRST] + count * e
    w = coefficients(row[W] + 8 * width * e, width, row[GATHERED], workspace)
    for i in range(count):
        own = vector_at(shift(H, 12 * nodes[first + i]), 12)
        packed = vector_at(shift(w, 12 * i), 12)
        for k in range(12):
            packed[k] = own[k]
    x = pointer(row[X] + 8 * row[EXTENT] * e)
    call_kernel(row[KERNEL], buffer, w, pointer(row[C]), x)
    return first


@inlined
def most_nodes(rows: Indices) -> int:
    """Largest number of nodes of a cell, at least one."""
    most = 1
    for f in range(rows.shape[0]):
        most = max(most, rows[f, NODES])
    return most


@inlined
def cell_forces(
    H: Pointer, row: Indices, nodes: Indices, e: int, workspace: Pointer, buffer: Pointer
) -> int:
    """:func:`evaluate` for forces, six numbers per node, which overwrite ``buffer``."""
    values = vector_at(buffer, 6 * row[NODES])
    for k in range(values.shape[0]):
        values[k] = 0.0
    return evaluate(H, row, nodes, e, workspace, buffer)


@uncounted
def add_forces(H: Array, arrays: tuple[Indices, Indices], out: Array) -> None:
    """Add the forces of all cells of all forms at nodal frames ``H``.

    Args:
        H: Frames of the nodes, contiguous, shape (≥ count, 4, 3).
        arrays: See :class:`FormArrays`.
        out: Six numbers of each node, added to, shape (≥ 6 count,).
    """
    rows, nodes = arrays
    most = 6 * most_nodes(rows)
    buffer, workspace, frames = stack(most), stack(workspace_size(rows)), address_of(H)
    values = vector_at(buffer, most)
    for f in range(rows.shape[0]):
        count = rows[f, NODES]
        for e in range(rows[f, CELLS]):
            first = cell_forces(frames, rows[f], nodes, e, workspace, buffer)
            for i in range(count):
                at = 6 * nodes[first + i]
                for k in range(6):
                    out[at + k] += values[6 * i + k]


@uncounted
def energy_of(H: Array, arrays: tuple[Indices, Indices]) -> float:
    """Sum of all forms with scalar kernels over their cells; see :func:`add_forces`."""
    rows, nodes = arrays
    buffer, workspace, frames = stack(1), stack(workspace_size(rows)), address_of(H)
    value, total = vector_at(buffer, 1), 0.0
    for f in range(rows.shape[0]):
        for e in range(rows[f, CELLS]):
            value[0] = 0.0
            evaluate(frames, rows[f], nodes, e, workspace, buffer)
            total += value[0]
    return total


@compiled
def add_blocks(
    H: Array,
    arrays: tuple[Indices, Indices],
    pair_of: Indices,
    index: Indices,
    unknowns: int,
    used: int,
    out: Array,
) -> None:
    """Sum the matrices of all forms over their cells at nodal frames ``H``.

    Args:
        H: Frames of the nodes, contiguous, shape (≥ count, 4, 3).
        arrays: See :class:`FormArrays`.
        pair_of: Index of each pair of nodes of each cell of each form among all pairs.
        index: Index of each pair's block in ``out``.
        unknowns: Unknowns per node of the kernels.
        used: Number of unknowns with entries, the first ones; kernels leave the others zero.
        out: Blocks of pairs of nodes, added to, shape (nnz, ≥ used, ≥ used).
    """
    rows, nodes = arrays
    most = unknowns * most_nodes(rows)
    buffer, workspace, pair = stack(most * most), stack(workspace_size(rows)), 0
    frames = address_of(H)
    for f in range(rows.shape[0]):
        count = rows[f, NODES]
        values = numba.carray(buffer, (count, unknowns, count, unknowns))
        for e in range(rows[f, CELLS]):
            for i in range(count):
                for a in range(used):
                    for j in range(count):
                        for b in range(used):
                            values[i, a, j, b] = 0.0
            evaluate(frames, rows[f], nodes, e, workspace, buffer)
            for i in range(count):
                for j in range(count):
                    block = out[index[pair_of[pair]]]
                    pair += 1
                    for a in range(used):
                        for b in range(used):
                            block[a, b] += values[i, a, j, b]


def of_some_cells(arrays: FormArrays, nodes: Flags) -> FormArrays:
    """Forms restricted to cells that contain any of some nodes.

    Args:
        arrays: Forms whose arrays stay alive.
        nodes: Mask of all nodes that the arrays number.
    """
    return of_cells(arrays, [np.asarray(nodes[cells].any(axis=1)) for cells in _cells(arrays)])


def of_other_cells(arrays: FormArrays, nodes: Flags) -> FormArrays:
    """Forms restricted to the cells that :func:`of_some_cells` leaves out."""
    return of_cells(arrays, [np.asarray(~nodes[cells].any(axis=1)) for cells in _cells(arrays)])


def of_deforming_cells(arrays: FormArrays, master: Indices) -> FormArrays:
    """Forms restricted to cells whose nodes are not all attached to the same node.

    Forces of the other cells are in equilibrium on that node.

    Args:
        arrays: Forms whose arrays stay alive.
        master: Master node of each node that the arrays number.
    """
    return of_cells(arrays, [np.ptp(master[cells], axis=1) > 0 for cells in _cells(arrays)])


def _cells(arrays: FormArrays) -> list[Indices]:
    """Nodes of the cells of each form, shape (m, k)."""
    found: list[Indices] = []
    for row in arrays.rows:
        size, first = row[NODES], row[FIRST]
        found.append(arrays.nodes[first : first + row[CELLS] * size].reshape(-1, size))
    return found


def of_cells(arrays: FormArrays, chosen: Sequence[Flags]) -> FormArrays:
    """Forms restricted to some cells.

    Args:
        arrays: Forms whose arrays stay alive.
        chosen: Mask of the cells of each form.
    """
    found, kept, at = [], [arrays.nodes[:0]], 0
    for k, cells in enumerate(_cells(arrays)):
        row: Indices = arrays.rows[k]
        edges = np.flatnonzero(np.diff(chosen[k], prepend=False, append=False))
        # cells that follow each other in memory are one row
        for start, end in edges.reshape(-1, 2):
            some = row.copy()
            some[CELLS], some[FIRST] = end - start, at
            some[[W, X]] += 8 * start * row[[WIDTH, EXTENT]]
            found.append(some)
            kept.append(cells[start:end].ravel())
            at += len(kept[-1])
    rows = np.array(found, dtype=np.int64).reshape(-1, GATHERED + 1)
    return FormArrays(rows, np.concatenate(kept))


def joined(tables: Sequence[FormArrays], first: Sequence[int]) -> tuple[Indices, Indices]:
    """Concatenation of the arrays of all forms, as a plain tuple.

    Args:
        tables: Forms whose arrays stay alive.
        first: Number of the first node of each in ``H``.
    """
    rows, nodes, at = [], [], 0
    for arrays, start in zip(tables, first, strict=True):
        own = arrays.rows.copy()
        own[:, FIRST] += at
        rows.append(own)
        nodes.append(start + arrays.nodes)
        at += len(arrays.nodes)
    return np.concatenate([NO_ROWS, *rows]), np.concatenate([np.empty(0, dtype=np.int64), *nodes])
