"""Cells of any stencil summed, by addresses of kernels and of their data, in one compiled call.

What DOLFINx's assembly does, in one call with the frames of each cell's nodes, which are written at
the head of its packed coefficients. For twenty beams that is half the time. A form is a row of
integers, so that any number of forms is passed as two arrays.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numba
import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie.forms.kernels import call_kernel, pointer, stack

_KERNEL, _CELLS, _NODES, _FIRST, _W, _WIDTH, _C, _X, _EXTENT = range(9)
"""In a row: address of the kernel; number of cells, nodes of each, place of the first one; address
and length of coefficients, address of constants, address and length of coordinates."""


class FormTable(NamedTuple):
    """Forms to be summed.

    Attributes:
        rows: Of addresses and sizes, shape (f, 9).
        nodes: Of all cells of all forms.
    """

    rows: Indices
    nodes: Indices


@compiled
def add_cells(H: Array, table: tuple[Indices, Indices], unknowns: int, out: Array) -> None:
    """Sum all forms over their cells, at nodal frames ``H``.

    Args:
        H: Frames of the nodes, shape (≥ count, 4, 3).
        table: See :class:`FormTable`.
        unknowns: Of each node, 0 for a number.
        out: Added to, shape (≥ count · unknowns,) or (1,).
    """
    rows, nodes = table
    most = 1
    for f in range(rows.shape[0]):
        most = max(most, rows[f, _NODES] * unknowns)
    place = stack(most)
    values = numba.carray(place, (most,))
    for f in range(rows.shape[0]):
        kernel, count, width = rows[f, _KERNEL], rows[f, _NODES], rows[f, _WIDTH]
        for e in range(rows[f, _CELLS]):
            first = rows[f, _FIRST] + count * e
            w = pointer(rows[f, _W] + 8 * width * e)
            packed, k = numba.carray(w, (12 * count,)), 0
            for i in range(first, first + count):
                for a in range(4):
                    for j in range(3):
                        packed[k] = H[nodes[i], a, j]
                        k += 1
            values[:] = 0.0
            x = pointer(rows[f, _X] + 8 * rows[f, _EXTENT] * e)
            call_kernel(kernel, place, w, pointer(rows[f, _C]), x)
            if unknowns == 0:
                out[0] += values[0]
            for i in range(count):
                for k in range(unknowns):
                    out[unknowns * nodes[first + i] + k] += values[unknowns * i + k]


@compiled
def add_blocks(
    H: Array, table: tuple[Indices, Indices], place: Indices, unknowns: int, out: Array
) -> None:
    """Sum matrices of all forms over their cells, at nodal frames ``H``.

    Args:
        H: Frames of the nodes, shape (≥ count, 4, 3).
        table: See :class:`FormTable`.
        place: Of each pair of nodes of each cell of each form, in ``out``.
        unknowns: Of each node.
        out: Blocks of pairs of nodes, added to, shape (nnz, unknowns, unknowns).
    """
    rows, nodes = table
    most = 1
    for f in range(rows.shape[0]):
        most = max(most, rows[f, _NODES] * unknowns)
    room, pair = stack(most * most), 0
    for f in range(rows.shape[0]):
        kernel, count, width = rows[f, _KERNEL], rows[f, _NODES], rows[f, _WIDTH]
        values = numba.carray(room, (count, unknowns, count, unknowns))
        for e in range(rows[f, _CELLS]):
            first = rows[f, _FIRST] + count * e
            w = pointer(rows[f, _W] + 8 * width * e)
            packed, k = numba.carray(w, (12 * count,)), 0
            for i in range(first, first + count):
                for a in range(4):
                    for j in range(3):
                        packed[k] = H[nodes[i], a, j]
                        k += 1
            values[:] = 0.0
            x = pointer(rows[f, _X] + 8 * rows[f, _EXTENT] * e)
            call_kernel(kernel, room, w, pointer(rows[f, _C]), x)
            for i in range(count):
                for j in range(count):
                    block = out[place[pair]]
                    pair += 1
                    for a in range(unknowns):
                        for b in range(unknowns):
                            block[a, b] += values[i, a, j, b]


def joined(tables: Sequence[FormTable], first: Sequence[int]) -> tuple[Indices, Indices]:
    """All forms in one table, as a plain tuple.

    Args:
        tables: Of forms that live on.
        first: Number of the first node of each in ``H``.
    """
    rows, nodes, at = [], [], 0
    for table, start in zip(tables, first, strict=True):
        own = table.rows.copy()
        own[:, _FIRST] += at
        rows.append(own)
        nodes.append(start + table.nodes)
        at += len(table.nodes)
    empty = np.empty((0, _EXTENT + 1), dtype=np.int64), np.empty(0, dtype=np.int64)
    return np.concatenate([empty[0], *rows]), np.concatenate([empty[1], *nodes])
