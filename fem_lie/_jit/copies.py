"""Copies between arrays of equal shapes in compiled code.

``target[:] = source`` is more to numba: it checks for overlap and broadcasting, and has an error
message with both shapes, whose text takes seconds to compile.
"""

from __future__ import annotations

from typing import Any

from fem_lie._jit.decorators import inlined_uncounted


@inlined_uncounted
def copy_vector(source: Any, target: Any) -> None:
    """Copy the numbers of an array of shape (n,)."""
    for i in range(target.shape[0]):
        target[i] = source[i]


@inlined_uncounted
def copy_matrix(source: Any, target: Any) -> None:
    """Copy an array of shape (m, n)."""
    for i in range(target.shape[0]):
        for j in range(target.shape[1]):
            target[i, j] = source[i, j]


@inlined_uncounted
def copy_blocks(source: Any, target: Any) -> None:
    """Copy an array of shape (m, n, k)."""
    for i in range(target.shape[0]):
        for j in range(target.shape[1]):
            for k in range(target.shape[2]):
                target[i, j, k] = source[i, j, k]
