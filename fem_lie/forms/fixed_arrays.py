"""Arrays that stay where they are, passed to compiled functions as one.

A compiled function takes 0.15 µs longer to call from Python for each array it is given: with
twenty, as long as it takes to do its work on a small scene. What does not change its place in a run
is found by its address.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numba
import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined
from fem_lie.forms.kernels.addresses import integer_pointer, pointer

_MOST = 4  # dimensions


class FixedArrays:
    """Keeps arrays of doubles and of 64-bit integers alive; they must not be replaced by others.

    Attributes:
        table: For compiled functions: address and shape of each, shape (k, 5).
    """

    def __init__(self, arrays: Iterable[Any]) -> None:
        """In the order in which compiled functions look for them."""
        self._arrays = tuple(arrays)
        self.table = np.ones((len(self._arrays), 1 + _MOST), dtype=np.int64)
        for row, array in zip(self.table, self._arrays, strict=True):
            if not array.flags.c_contiguous or array.dtype not in (np.float64, np.int64):
                raise TypeError(f"contiguous doubles or integers, got {array.dtype}")
            row[0] = array.ctypes.data
            row[1 : 1 + array.ndim] = array.shape


@inlined
def numbers1(table: Indices, k: int) -> Array:
    """Array ``k``, of one dimension."""
    return numba.carray(pointer(table[k, 0]), (table[k, 1],))


@inlined
def numbers2(table: Indices, k: int) -> Array:
    """Of two."""
    return numba.carray(pointer(table[k, 0]), (table[k, 1], table[k, 2]))


@inlined
def numbers3(table: Indices, k: int) -> Array:
    """Of three."""
    return numba.carray(pointer(table[k, 0]), (table[k, 1], table[k, 2], table[k, 3]))


@inlined
def numbers4(table: Indices, k: int) -> Array:
    """Of four."""
    shape = table[k, 1], table[k, 2], table[k, 3], table[k, 4]
    return numba.carray(pointer(table[k, 0]), shape)


@inlined
def integers1(table: Indices, k: int) -> Indices:
    """Array ``k``, of integers and one dimension."""
    return numba.carray(integer_pointer(table[k, 0]), (table[k, 1],))


@inlined
def integers2(table: Indices, k: int) -> Indices:
    """Of two."""
    return numba.carray(integer_pointer(table[k, 0]), (table[k, 1], table[k, 2]))


@inlined
def frames(table: Indices, k: int) -> Array:
    """Of frames, (n, 4, 3): what a compiler knows of a shape it needs not multiply with."""
    return numba.carray(pointer(table[k, 0]), (table[k, 1], 4, 3))


@inlined
def sixes(table: Indices, k: int) -> Array:
    """Of shape (n, 6), likewise."""
    return numba.carray(pointer(table[k, 0]), (table[k, 1], 6))


@inlined
def integer_sixes(table: Indices, k: int) -> Indices:
    """Of integers."""
    return numba.carray(integer_pointer(table[k, 0]), (table[k, 1], 6))


@inlined
def many_frames(table: Indices, k: int) -> Array:
    """Of shape (k, n, 4, 3)."""
    return numba.carray(pointer(table[k, 0]), (table[k, 1], table[k, 2], 4, 3))


@inlined
def many_sixes(table: Indices, k: int) -> Array:
    """Of shape (k, n, 6)."""
    return numba.carray(pointer(table[k, 0]), (table[k, 1], table[k, 2], 6))


@inlined
def as_frames(H: Array) -> Array:
    """The array, known to be contiguous and of shape (n, 4, 3); likewise."""
    return numba.carray(pointer(H.ctypes.data), (H.shape[0], 4, 3))


@inlined
def as_sixes(F: Array) -> Array:
    """The array, known to be contiguous and of shape (n, 6)."""
    return numba.carray(pointer(F.ctypes.data), (F.shape[0], 6))


@inlined
def put(values: Array, out: Array) -> None:
    """``out[:] = values`` for arrays of the same shape.

    That itself checks the shapes, and what would write them into a message is more code than most
    functions are: some twenty functions on strings, which go into each caller.
    """
    source, target = values.flat, out.flat
    for k in range(out.size):
        target[k] = source[k]
