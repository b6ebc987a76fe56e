"""Constants of elements whose numbers of nodes and points are known at run time, for their kernels.

Functions of such an element get the constants with each call, behind the data of the cell, as the
constants of a form. They are compiled once for all sizes.
"""

from __future__ import annotations

import numpy as np
from numba import types

from fem_lie._arrays import Array
from fem_lie._jit import inlined
from fem_lie._jit.stack import vector_at
from fem_lie.forms.kernels.addresses import Pointer, double_pointer, shift
from fem_lie.forms.small_energy.element import Cells

PACKED_SIGNATURE = types.void(double_pointer, double_pointer, double_pointer, double_pointer)
"""Of their functions: what they add to, the data of a cell, the constants, and twists or increments
of its nodes."""

_HEAD = 14
"""Numbers before the arrays."""


def packed(cells: Cells) -> Array:
    """Constants as :func:`unpacked` reads them; integers keep their bits."""
    sizes = [len(cells.types), len(cells.coordinates), len(cells.groups), len(cells.terms)]
    sizes += [*cells.inputs.shape, *(each for each in cells if isinstance(each, int))]
    arrays = cells.types, cells.coordinates, cells.starts, cells.groups, cells.terms, cells.inputs
    integers = np.concatenate([np.array(sizes), *(each.ravel() for each in arrays)])
    return np.concatenate([integers.astype(np.int64).view(np.float64), cells.factors])


@inlined
def unpacked(c: Pointer) -> Cells:
    """Constants at ``c``."""
    head = vector_at(c, _HEAD).view(np.int64)
    k, r, u, t, d, i = head[0], head[1], head[2], head[3], head[4], head[5]
    size = k + 5 * r + u + 3 * t + d * i
    rest = vector_at(shift(c, _HEAD), size).view(np.int64)
    at = k + 5 * r + u
    return Cells(
        rest[:k],
        rest[k : k + 4 * r].reshape((r, 4)),
        rest[k + 4 * r : k + 5 * r],
        rest[k + 5 * r : at],
        rest[at : at + 3 * t].reshape((t, 3)),
        vector_at(shift(c, _HEAD + size), t),
        rest[at + 3 * t : size].reshape((d, i)),
        head[6],
        head[7],
        head[8],
        head[9],
        head[10],
        head[11],
        head[12],
        head[13],
    )
