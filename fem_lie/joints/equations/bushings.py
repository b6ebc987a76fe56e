"""Compiled springs and dampers of six components between two frames.

The coordinate of a bushing is the relative motion ``d = log(A⁻¹ B)`` of its frames, shape (6,), as
in a geodesic beam element of one cell. With ``N = K (d − d₀) + C ḋ``::

    δd = −T⁻¹(−d) h_A + T⁻¹(d) h_B,    f_A = −T⁻ᵀ(−d) N,    f_B = T⁻ᵀ(d) N

Frames A and B are fixed to their nodes; nodes from ``count`` on do not move by themselves.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled


class BushingArrays(NamedTuple):
    """Packed arrays of j bushings.

    Attributes:
        nodes: Nodes A and B, shape (j, 2).
        frames: Frames A and B in the frames of their nodes, shape (j, 2, 4, 3).
        rest: Relative motion ``d₀`` without force, shape (j, 6).
        stiffness: ``K``, shape (j, 6, 6).
        damping: ``C``, shape (j, 6, 6).
    """

    nodes: Indices
    frames: Array
    rest: Array
    stiffness: Array
    damping: Array


@compiled
def _locate(H: Array, arrays: BushingArrays, j: int, d: Array) -> None:
    """Relative motion ``d`` of bushing j."""
    A, B = np.empty((4, 3)), np.empty((4, 3))
    lie.compose(H[arrays.nodes[j, 0]], arrays.frames[j, 0], A)
    lie.compose(H[arrays.nodes[j, 1]], arrays.frames[j, 1], B)
    lie.relative(A, B, d)


@compiled
def _rate(v: Array, arrays: BushingArrays, j: int, d: Array, rate: Array) -> None:
    """Rate of ``d`` at nodal twists ``v``; nodes beyond its rows are at rest."""
    twist, part = np.empty(6), np.empty(6)
    rate[:] = 0.0
    a, b = arrays.nodes[j]
    if a < v.shape[0]:
        lie.apply_adjoint_inverse(arrays.frames[j, 0], v[a], twist)
        lie.apply_tangent_inverse_minus(d, twist, part)
        rate -= part
    if b < v.shape[0]:
        lie.apply_adjoint_inverse(arrays.frames[j, 1], v[b], twist)
        lie.apply_tangent_inverse(d, twist, part)
        rate += part


@compiled
def _conjugate(v: Array, arrays: BushingArrays, j: int, d: Array, N: Array) -> None:
    """Force ``N`` conjugate to ``d``."""
    rate = np.empty(6)
    _rate(v, arrays, j, d, rate)
    N[:] = arrays.stiffness[j] @ (d - arrays.rest[j]) + arrays.damping[j] @ rate


@compiled
def _on_frames(d: Array, N: Array, sides: Array) -> None:
    """Forces and moments (2, 6) on frames A and B."""
    lie.apply_tangent_inverse_transposed_minus(d, N, sides[0])
    sides[0] *= -1.0
    lie.apply_tangent_inverse_transposed(d, N, sides[1])


@compiled
def relative_motions(H: Array, arrays: BushingArrays, out: Array) -> None:
    """Relative motion of each bushing, shape (j, 6)."""
    for j in range(arrays.nodes.shape[0]):
        _locate(H, arrays, j, out[j])


@compiled
def relative_rates(H: Array, v: Array, arrays: BushingArrays, out: Array) -> None:
    """Rate of the relative motion of each bushing at nodal twists ``v``, shape (j, 6)."""
    d = np.empty(6)
    for j in range(arrays.nodes.shape[0]):
        _locate(H, arrays, j, d)
        _rate(v, arrays, j, d, out[j])


@compiled
def wrenches(H: Array, v: Array, arrays: BushingArrays, out: Array) -> None:
    """Forces and moments on frames A and B, in these frames, with the sign of a residual.

    Args:
        H: Frames of all nodes, ground and prescribed motions.
        v: Twists of the moving nodes.
        arrays: The bushings.
        out: Shape (j, 2, 6), overwritten.
    """
    d, N = np.empty(6), np.empty(6)
    for j in range(arrays.nodes.shape[0]):
        _locate(H, arrays, j, d)
        _conjugate(v, arrays, j, d, N)
        _on_frames(d, N, out[j])


@compiled
def evaluate(H: Array, v: Array, arrays: BushingArrays, count: int, r: Array) -> None:
    """Add the forces on the first ``count`` nodes to ``r`` (≥ 6 count,)."""
    d, N, sides, moved = np.empty(6), np.empty(6), np.empty((2, 6)), np.empty(6)
    for j in range(arrays.nodes.shape[0]):
        _locate(H, arrays, j, d)
        _conjugate(v, arrays, j, d, N)
        _on_frames(d, N, sides)
        for side in range(2):
            node = arrays.nodes[j, side]
            if node < count:
                lie.apply_adjoint_inverse_transposed(arrays.frames[j, side], sides[side], moved)
                r[6 * node : 6 * node + 6] += moved


@compiled
def _derivatives(d: Array, arrays: BushingArrays, j: int, D: Array) -> None:
    """Derivatives of ``d`` in the twists of both nodes, shape (2, 6, 6)."""
    unit, twist, column = np.empty(6), np.empty(6), np.empty(6)
    for side in range(2):
        for k in range(6):
            unit[:] = 0.0
            unit[k] = 1.0
            lie.apply_adjoint_inverse(arrays.frames[j, side], unit, twist)
            if side == 0:
                lie.apply_tangent_inverse_minus(d, twist, column)
                D[side, :, k] = -column
            else:
                lie.apply_tangent_inverse(d, twist, column)
                D[side, :, k] = column


@compiled
def geometric(H: Array, arrays: BushingArrays, index: Indices, K: Array) -> None:
    """Add the derivative of the forces at rest, at constant ``N``, to blocks ``K``.

    Args:
        H: Frames of all nodes, ground and prescribed motions.
        arrays: The bushings.
        index: Block of each pair of nodes, −1: none, shape (j, 2, 2).
        K: Blocks, shape (any, 6, 6).
    """
    d, N, D, G = np.empty(6), np.empty(6), np.empty((2, 6, 6)), np.empty((2, 6, 6))
    moved, still = np.empty(6), np.zeros((0, 6))
    for j in range(arrays.nodes.shape[0]):
        _locate(H, arrays, j, d)
        _conjugate(still, arrays, j, d, N)
        _derivatives(d, arrays, j, D)
        lie.tangent_inverse_transposed_derivative_minus(d, N, G[0])
        lie.tangent_inverse_transposed_derivative(d, N, G[1])
        for side in range(2):
            for source in range(2):
                if index[j, side, source] >= 0:
                    block, change = K[index[j, side, source]], G[side] @ D[source]
                    for k in range(6):
                        lie.apply_adjoint_inverse_transposed(
                            arrays.frames[j, side], change[:, k].copy(), moved
                        )
                        block[:, k] += moved


@compiled
def stiffen(
    H: Array, arrays: BushingArrays, index: Indices, stiff: float, damp: float, K: Array
) -> None:
    """Add ``Dᵀ (stiff K + damp C) D`` to blocks, as :func:`geometric`; ``δd = D h``."""
    d, D = np.empty(6), np.empty((2, 6, 6))
    for j in range(arrays.nodes.shape[0]):
        _locate(H, arrays, j, d)
        _derivatives(d, arrays, j, D)
        law = stiff * arrays.stiffness[j] + damp * arrays.damping[j]
        for side in range(2):
            for source in range(2):
                if index[j, side, source] >= 0:
                    K[index[j, side, source]] += D[side].T @ (law @ D[source])
