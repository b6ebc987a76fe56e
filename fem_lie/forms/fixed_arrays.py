"""Arrays at fixed addresses, passed to compiled functions as one table.

Each array argument adds 0.15 µs to a call of a compiled function from Python: twenty arrays cost as
much as the work on a small scene. Arrays that do not move during a run are passed by address.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numba
import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined
from fem_lie._jit.records import Records
from fem_lie.forms.kernels.addresses import integer_pointer, pointer, void_pointer

_MOST = 4  # dimensions


class FixedArrays:
    """Table of arrays of doubles and 64-bit integers, and of records, which it keeps alive.

    None of them may be replaced.

    Attributes:
        table: Address and shape of each array, for compiled functions, shape (k, 5).
    """

    def __init__(self, arrays: Iterable[Any]) -> None:
        """Store the arrays in the order in which compiled functions index them."""
        self._arrays = tuple(arrays)
        self.table = np.ones((len(self._arrays), 1 + _MOST), dtype=np.int64)
        for row, given in zip(self.table, self._arrays, strict=True):
            record = isinstance(given, np.record)
            array = np.asarray(given.base) if record else given
            plain = record or array.dtype in (np.float64, np.int64)
            if not array.flags.c_contiguous or not plain:
                raise TypeError(f"contiguous doubles or integers, got {array.dtype}")
            row[0] = array.ctypes.data
            row[1 : 1 + array.ndim] = array.shape


@inlined
def numbers1(table: Indices, k: int) -> Array:
    """Array ``k`` of doubles, one dimension."""
    return numba.carray(pointer(table[k, 0]), (table[k, 1],))


@inlined
def numbers2(table: Indices, k: int) -> Array:
    """Array ``k`` of doubles, two dimensions."""
    return numba.carray(pointer(table[k, 0]), (table[k, 1], table[k, 2]))


@inlined
def numbers3(table: Indices, k: int) -> Array:
    """Array ``k`` of doubles, three dimensions."""
    return numba.carray(pointer(table[k, 0]), (table[k, 1], table[k, 2], table[k, 3]))


@inlined
def numbers4(table: Indices, k: int) -> Array:
    """Array ``k`` of doubles, four dimensions."""
    shape = table[k, 1], table[k, 2], table[k, 3], table[k, 4]
    return numba.carray(pointer(table[k, 0]), shape)


@inlined
def integers1(table: Indices, k: int) -> Indices:
    """Array ``k`` of integers, one dimension."""
    return numba.carray(integer_pointer(table[k, 0]), (table[k, 1],))


@inlined
def integers2(table: Indices, k: int) -> Indices:
    """Array ``k`` of integers, two dimensions."""
    return numba.carray(integer_pointer(table[k, 0]), (table[k, 1], table[k, 2]))


@inlined
def records(table: Indices, k: int, kind: np.dtype[np.void]) -> Records:
    """Array ``k``, of one record of a type, see :mod:`fem_lie._jit.records`."""
    return numba.carray(void_pointer(table[k, 0]), (1,), kind)


@inlined
def frames(table: Indices, k: int) -> Array:
    """Array ``k`` of shape (n, 4, 3); strides that are known to the compiler are faster."""
    return numba.carray(pointer(table[k, 0]), (table[k, 1], 4, 3))


@inlined
def sixes(table: Indices, k: int) -> Array:
    """Array ``k`` of doubles, shape (n, 6)."""
    return numba.carray(pointer(table[k, 0]), (table[k, 1], 6))


@inlined
def integer_sixes(table: Indices, k: int) -> Indices:
    """Array ``k`` of integers, shape (n, 6)."""
    return numba.carray(integer_pointer(table[k, 0]), (table[k, 1], 6))


@inlined
def many_frames(table: Indices, k: int) -> Array:
    """Array ``k`` of shape (m, n, 4, 3)."""
    return numba.carray(pointer(table[k, 0]), (table[k, 1], table[k, 2], 4, 3))


@inlined
def many_sixes(table: Indices, k: int) -> Array:
    """Array ``k`` of shape (m, n, 6)."""
    return numba.carray(pointer(table[k, 0]), (table[k, 1], table[k, 2], 6))


@inlined
def as_frames(H: Array) -> Array:
    """The contiguous array ``H`` as one of known shape (n, 4, 3)."""
    return numba.carray(pointer(H.ctypes.data), (H.shape[0], 4, 3))


@inlined
def as_sixes(F: Array) -> Array:
    """The contiguous array ``F`` as one of known shape (n, 6)."""
    return numba.carray(pointer(F.ctypes.data), (F.shape[0], 6))


@inlined
def put(values: Array, out: Array) -> None:
    """``out[:] = values`` for arrays of the same shape, without a check.

    The check and its message would add some twenty string functions to the code of each caller.
    """
    source, target = values.flat, out.flat
    for k in range(out.size):
        target[k] = source[k]
