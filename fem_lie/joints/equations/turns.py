"""Joint angles beyond half a turn, and coordinate changes of springs, compiled.

Frames determine an angle up to full turns, and the constrained terms of ``Q`` vanish on several
branches: ``skew Q = 0`` also at half a turn about any axis, ``Q₁₃ = Q₂₃ = 0`` also for opposite
axes e₃. Iterations with large increments need a reference angle that selects the branch.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled
from fem_lie.joints.equations import functions
from fem_lie.joints.equations.joint_arrays import JointArrays
from fem_lie.joints.equations.one_pair import locate, rate_of_term, term, twists
from fem_lie.joints.equations.relative_motion import variation


@compiled
def spring_changes(H: Array, h: Array, arrays: JointArrays, out: Array) -> None:
    """Change of the coordinate of each spring along ``h``, to first order.

    Args:
        H: Frames of all nodes, shape (≥ n, 4, 3).
        h: Local increments of the moving nodes, shape (n, 6).
        arrays: The joints, with k springs.
        out: Shape (k,), overwritten.
    """
    A, B, z, f = np.empty((4, 3)), np.empty((4, 3)), np.empty(12), np.zeros(3)
    m = len(arrays.targets)
    for j in range(arrays.nodes.shape[0]):
        for t in range(arrays.first[j], arrays.first[j + 1]):
            if arrays.rows[t] >= m:
                locate(H, arrays, j, A, B, z, f)
                out[arrays.rows[t] - m] = rate_of_term(h, arrays, j, t, z)


_NEAR = 0.5 * np.pi
"""Change of an angle, rad, below which the reference angle stays as it is."""


@compiled
def foresee(H: Array, h: Array, arrays: JointArrays) -> None:
    """Move the reference angles of all pairs along an increment of the nodes.

    The angle after the increment is then the one within half a turn of its linear prediction.

    Args:
        H: Frames of nodes, ground and prescribed motions before the increment, (≥ n, 4, 3).
        h: Increment of the moving nodes as twists, shape (n, 6).
        arrays: The joints; ``turned`` is updated.
    """
    A, B, z, f = np.empty((4, 3)), np.empty((4, 3)), np.empty(12), np.zeros(3)
    twist, dz, p = np.empty((2, 6)), np.empty(12), np.empty(12)
    angle = np.zeros(functions.COUNT)
    angle[functions.ANGLE] = 1.0
    for j in range(arrays.nodes.shape[0]):
        if arrays.functions[arrays.first[j] : arrays.first[j + 1], functions.ANGLE].any():
            locate(H, arrays, j, A, B, z, f)
            twists(h, arrays, j, twist)
            variation(z, twist[0], twist[1], dz)
            p[:] = 0.0
            functions.add_gradients(z, arrays.angle[j], angle, p)
            ahead = f[functions.ANGLE] + p @ dz
            if abs(ahead - arrays.turned[j]) > _NEAR:
                arrays.turned[j] = ahead


@compiled
def angles(H: Array, arrays: JointArrays, out: Array) -> None:
    """Angle of each pair, rad, shape (j,); zero for pairs without an angle."""
    A, B, z, f = np.empty((4, 3)), np.empty((4, 3)), np.empty(12), np.zeros(3)
    for j in range(arrays.nodes.shape[0]):
        out[j] = 0.0
        if arrays.functions[arrays.first[j] : arrays.first[j + 1], functions.ANGLE].any():
            locate(H, arrays, j, A, B, z, f)
            out[j] = f[functions.ANGLE]


@compiled
def alignments(H: Array, arrays: JointArrays, aligned: Array, out: Array) -> None:
    """``aligned : Q`` of each pair, shape (j,).

    Args:
        H: Frames of all nodes, ground and prescribed motions.
        arrays: The joints.
        aligned: The identity, a product ``a aᵀ`` or zero for each pair, shape (j, 3, 3).
        out: Overwritten.
    """
    A, B, z, f = np.empty((4, 3)), np.empty((4, 3)), np.empty(12), np.zeros(3)
    for j in range(arrays.nodes.shape[0]):
        locate(H, arrays, j, A, B, z, f)
        out[j] = 0.0
        for k in range(3):
            for n in range(3):
                out[j] += aligned[j, k, n] * z[3 + 3 * k + n]


@compiled
def spring_values(H: Array, arrays: JointArrays, out: Array) -> None:
    """Coordinate of each spring, shape (k,)."""
    A, B, z, f = np.empty((4, 3)), np.empty((4, 3)), np.empty(12), np.zeros(3)
    m = len(arrays.targets)
    for j in range(arrays.nodes.shape[0]):
        for t in range(arrays.first[j], arrays.first[j + 1]):
            if arrays.rows[t] >= m:
                locate(H, arrays, j, A, B, z, f)
                out[arrays.rows[t] - m] = term(arrays, t, z, f)


def fixed_rotations(selection: Array) -> Array:
    """Matrix that detects wrong branches of the constraints of a relative rotation, shape (3, 3).

    Args:
        selection: Selected components of ``Q`` in the constraints of a pair, which hold for ``Q =
            1``, shape (c, 9).

    Returns:
        The identity if all three rotations are constrained, ``a aᵀ`` if only the rotation about
        ``a`` is free, else zero. Its product with ``Q`` has the trace 3 or 1 on the intended
        branch, and −1 on the others.
    """
    basis = np.zeros((9, 3))
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        basis[3 * j + i, k], basis[3 * i + j, k] = 1.0, -1.0
    if not selection.any():
        return np.zeros((3, 3))
    _, sizes, axes = np.linalg.svd(selection @ basis)
    rank = int((sizes > 1e-9 * sizes[0]).sum()) if sizes[0] > 0 else 0
    if rank < 2:
        return np.zeros((3, 3))
    return np.eye(3) if rank == 3 else np.outer(axes[2], axes[2])
