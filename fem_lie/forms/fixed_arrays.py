"""Arrays of known shapes, and copies between arrays of one shape, in compiled code."""

from __future__ import annotations

import numba

from fem_lie._arrays import Array
from fem_lie._jit import inlined
from fem_lie.forms.kernels.addresses import pointer


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
