"""Polar decomposition ``A = R U``, and nodal axes convected by the mean deformation; compiled.

The mean deformation around point i is ``F_i = Σ_k x_k ⊗ b_ik`` with constants ``b``. The convected
axes are the reference axes times the rotation of ``F_i``.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie._jit.copies import copy_matrix
from fem_lie._jit.packed_arrays import Integers1, Numbers2, Numbers3

_MOST = 60  # iterations; six do for moderate strains
_EXACT = 1e-15


@compiled
def polar_rotation(A: Array, R: Array) -> bool:
    """Set ``R`` (3, 3) to the rotation of ``A``; return whether there is one.

    The cofactor of ``A``, which has the same rotation, is added, so that a matrix of rank two is
    accepted, such as that of points in a plane. Then ``R ← ½ (R + R⁻ᵀ)`` is iterated.

    Args:
        A: Columns are images of axes, shape (3, 3).
        R: Overwritten.
    """
    size = np.sqrt((A * A).sum())
    if not size > 0.0:
        return False
    B = A / size
    _cofactor(B, R)
    R += B
    C = np.empty((3, 3))
    for _ in range(_MOST):
        _cofactor(R, C)
        volume = (R[0] * C[0]).sum()
        if not volume > 0.0:
            return False
        change = 0.0
        for i in range(3):
            for j in range(3):
                step = 0.5 * (C[i, j] / volume - R[i, j])
                R[i, j] += step
                change = max(change, abs(step))
        if change <= _EXACT:
            break
    return True


@compiled
def _cofactor(A: Array, out: Array) -> None:
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        for a in range(3):
            b, c = (a + 1) % 3, (a + 2) % 3
            out[i, a] = A[j, b] * A[k, c] - A[j, c] * A[k, b]


class Surroundings(NamedTuple):
    """Points with convected axes, and the points around them.

    Attributes:
        nodes: Nodes whose axes rotate, shape (t,).
        indptr: Start of each point in ``indices`` and ``b``, shape (n + 1,).
        indices: Points around each point, shape (nnz,).
        b: Factors of these points in the mean deformation, shape (nnz, 3), 1/m.
        axes: Axes in the reference configuration as rows, shape (n, 3, 3).
        given: Mean deformations, if they do not follow from these points alone, shape (n, 3, 3);
            else no rows.
    """

    nodes: Indices
    indptr: Indices
    indices: Indices
    b: Array
    axes: Array
    given: Array


PlainSurroundings: TypeAlias = tuple[Integers1, Integers1, Integers1, Numbers2, Numbers3, Numbers3]
"""A :class:`Surroundings` as a plain tuple, which is faster to pass from Python."""


@compiled
def _add_deformation(i: int, H: Array, around: Surroundings, F: Array) -> None:
    """Add the mean deformation around point ``i`` to ``F`` (3, 3)."""
    for k in range(around.indptr[i], around.indptr[i + 1]):
        for a in range(3):
            for c in range(3):
                F[a, c] += H[around.indices[k], 0, a] * around.b[k, c]


@compiled
def mean_deformations(H: Array, around: PlainSurroundings, F: Array) -> None:
    """Set the mean deformations ``F`` (n, 3, 3) around all points."""
    known = Surroundings(*around)
    F[:] = 0.0
    for i in range(F.shape[0]):
        _add_deformation(i, H, known, F[i])


@compiled
def _rotation(i: int, H: Array, around: Surroundings, R: Array) -> bool:
    """Set ``R`` to the rotation of the mean deformation around point ``i``, if it exists."""
    F = np.zeros((3, 3))
    if around.given.shape[0] > 0:
        copy_matrix(around.given[i], F)
    else:
        _add_deformation(i, H, around, F)
    return polar_rotation(F, R)


@compiled
def find_reference_axes(H: Array, around: PlainSurroundings) -> None:
    """Set the reference axes from coordinates ``H`` (≥ n, 4, 3): those of ``H`` rotated back."""
    known = Surroundings(*around)
    R = np.empty((3, 3))
    for i in range(known.axes.shape[0]):
        known.axes[i] = H[i, 1:]
        if known.indptr[i] < known.indptr[i + 1] and _rotation(i, H, known, R):
            known.axes[i] = H[i, 1:] @ R


@compiled
def convect_axes(H: Array, around: PlainSurroundings, motion: Array, written: Indices) -> None:
    """Rotate the axes of ``H`` (≥ n, 4, 3), and fields stored in them, with the deformation.

    Args:
        H: Nodal coordinates, changed in place.
        around: See :class:`Surroundings`.
        motion: Velocities, accelerations and similar fields, shape (k, n, 6).
        written: Fields with components along the nodal axes.
    """
    known = Surroundings(*around)
    R, new, turn = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    own = np.empty(3)
    for i in known.nodes:
        if not _rotation(i, H, known, R):
            continue
        _multiply_transposed(known.axes[i], R, new)
        _multiply_transposed(new, H[i, 1:], turn)
        copy_matrix(new, H[i, 1:])
        for k in written:
            for at in (0, 3):
                for a in range(3):
                    own[a] = motion[k, i, at + a]
                for a in range(3):
                    moved = turn[a, 0] * own[0] + turn[a, 1] * own[1] + turn[a, 2] * own[2]
                    motion[k, i, at + a] = moved


@compiled
def _multiply_transposed(A: Array, B: Array, out: Array) -> None:
    """``out = A Bᵀ`` of matrices (3, 3)."""
    for a in range(3):
        for b in range(3):
            out[a, b] = A[a, 0] * B[b, 0] + A[a, 1] * B[b, 1] + A[a, 2] * B[b, 2]
