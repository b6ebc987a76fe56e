"""Springs in bending and torsion between successive edges of discrete rods with axes.

An edge between two positions has the unit tangent ``t``, and the frame ``(D, d₂, d₃)`` of its first
node rotated onto it by the smallest rotation, ``M_k = d_k − (d_k·t)/(1 + D·t) (D + t)``. The
frame's unknown is its rotation about ``D``; where a state is accepted ``D`` becomes ``t``, so that
it is transported in parallel through time. At the ends of a rod an edge meets the frame of the end
itself. For the frames ``e`` and ``f`` of two edges, with ``Q_ij = e_i·f_j`` and ``X = 1 + e₁·f₁``::

    z = (angle(Q₃₂ − Q₂₃, Q₂₂ + Q₃₃), (Q₁₃ − Q₃₁)/X, (Q₂₁ − Q₁₂)/X),    W = ½ (z − z₀)·B (z − z₀)

are twist, and the components of ``κb = 2 e₁ × f₁/X`` along the mean axes. The torque between them
is ``μ = S₁ (e₁ + f₁)/X + S₂ ∂z₂ + S₃ ∂z₃``, ``S = B (z − z₀)``; on an edge ``x`` and its frame it
is::

    ∂W/∂x = (μ × t − (μ·t)/(1 + D·t) D × t)/|x|,    and on the frame    (μ·t)/(1 + D·t) (D + t)

The small-energy kernel (``benchmarks/derived_kernels.py``) takes 5.8 times as long for forces. The
matrix is the derivative of these forces at a stress ``S`` that is updated linearly between
iterates, by complex steps, which are exact. (Bergou, Wardetzky, Robinson, Audoly & Grinspun, *ACM
Trans. Graph.* 27 (2008) 63; Jawed, Novelia & O'Reilly, *A Primer on the Kinematics of Discrete
Elastic Rods*, 2018.)
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numba
import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import callback, compiled, inlined
from fem_lie._jit.stack import stack
from fem_lie.elements.rods.bends import Springs
from fem_lie.forms.cell_sums import LinearisedCellTerm
from fem_lie.forms.kernels.addresses import UFCX_SIGNATURE, Pointer
from fem_lie.lie.tuples import (
    combined,
    cross,
    dot,
    load_frame,
    minus,
    negative,
    plus,
    rotate,
    rotate_back,
    scaled,
)

_DATA = 36
"""Offsets of the data of a cell behind its three nodes: B, z₀, whether e and f are frames, S."""

_SIZE = _DATA + 17
_TINY = 1e-30  # a complex step: its square is nothing

# frames and edges as tuples of numbers, real or complex
_Numbers = Any


class Corners(NamedTuple):
    """Springs in bending and torsion between edges.

    Attributes:
        nodes: Ends of the first edge and of the second one; a node twice for the frame of a node,
            shape (b, 3).
        frames: Whether the first and the second are frames of nodes, shape (b, 2).
        stiffness: ``B``, shape (b, 3, 3).
        natural: ``z₀``, shape (b, 3).
    """

    nodes: Indices
    frames: Flags
    stiffness: Array
    natural: Array


@inlined
def _edge(P: _Numbers, Q: _Numbers, own: float) -> _Numbers:
    """Axes ``t, M₂, M₃`` of the edge from P to Q, its inverse length, and ``1 + D·t``."""
    D, d2, d3 = P[1], P[2], P[3]
    way = plus(minus(Q[0], P[0]), scaled(own, D))  # Q is P then
    inverse = 1.0 / np.sqrt(dot(way, way))
    t = scaled(inverse, way)
    near = 1.0 + dot(D, t)
    between = scaled(1.0 / near, plus(D, t))
    M2 = minus(d2, scaled(dot(d2, t), between))
    M3 = minus(d3, scaled(dot(d3, t), between))
    return t, M2, M3, inverse, near


@inlined
def _strains(e: _Numbers, f: _Numbers) -> _Numbers:
    """``X`` and ``z``."""
    X = 1.0 + dot(e[0], f[0])
    sine = dot(e[2], f[1]) - dot(e[1], f[2])
    cosine = dot(e[1], f[1]) + dot(e[2], f[2])
    second = (dot(e[0], f[2]) - dot(e[2], f[0])) / X
    third = (dot(e[1], f[0]) - dot(e[0], f[1])) / X
    return X, 2.0 * np.arctan(sine / (X + cosine)), second, third


@inlined
def _stress(data: Array, z: _Numbers) -> _Numbers:
    a, b, c = z[1] - data[9], z[2] - data[10], z[3] - data[11]
    return (
        data[0] * a + data[1] * b + data[2] * c,
        data[3] * a + data[4] * b + data[5] * c,
        data[6] * a + data[7] * b + data[8] * c,
    )


@inlined
def _torque(e: _Numbers, f: _Numbers, z: _Numbers, S: _Numbers) -> _Numbers:
    """Torque ``μ``: derivative of the energy in a rotation of ``f``."""
    X, both = z[0], cross(f[0], e[0])
    second = minus(minus(cross(f[2], e[0]), cross(f[0], e[2])), scaled(z[2], both))
    third = minus(minus(cross(f[0], e[1]), cross(f[1], e[0])), scaled(z[3], both))
    twist = scaled(S[0], plus(e[0], f[0]))
    return scaled(1.0 / X, plus(twist, combined(S[1], second, S[2], third)))


@inlined
def _pull(P: _Numbers, edge: _Numbers, μ: _Numbers, own: float) -> _Numbers:
    """Force on the end of an edge, and moment on the frame whose axes it has."""
    t, inverse, near = edge[0], edge[3], edge[4]
    about = dot(μ, t) / near
    force = scaled((1.0 - own) * inverse, minus(cross(μ, t), scaled(about, cross(P[1], t))))
    moment = combined(1.0 - own, scaled(about, plus(P[1], t)), own, μ)
    return force, moment


@inlined
def _sides(A: _Numbers, B: _Numbers, C: _Numbers, data: Array) -> _Numbers:
    """Both edges, ``X`` and ``z``."""
    e, f = _edge(A, B, data[12]), _edge(C if data[13] > 0.0 else B, C, data[13])
    return e, f, _strains(e, f)


@inlined
def _forces(
    A: _Numbers, B: _Numbers, C: _Numbers, sides: _Numbers, S: _Numbers, data: Array
) -> _Numbers:
    """Forces on the positions of three nodes, then moments on their frames, along their axes."""
    first, last = data[12], data[13]
    start = C if last > 0.0 else B
    e, f, z = sides
    μ = _torque(e, f, z, S)
    force_e, moment_e = _pull(A, e, negative(μ), first)
    force_f, moment_f = _pull(start, f, μ, last)
    at_b, at_c = scaled(1.0 - last, moment_f), scaled(last, moment_f)
    return (
        rotate_back(A[1], A[2], A[3], negative(force_e)),
        rotate_back(B[1], B[2], B[3], minus(force_e, force_f)),
        rotate_back(C[1], C[2], C[3], force_f),
        rotate_back(A[1], A[2], A[3], moment_e),
        rotate_back(B[1], B[2], B[3], at_b),
        rotate_back(C[1], C[2], C[3], at_c),
    )


@callback(UFCX_SIGNATURE)
def energy_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """``W`` of a spring."""
    H, data = numba.carray(w, (3, 4, 3)), numba.carray(w, (_SIZE,))[_DATA:]
    z = _sides(load_frame(H[0]), load_frame(H[1]), load_frame(H[2]), data)[2]
    value = numba.carray(A, (1,))
    change = z[1] - data[9], z[2] - data[10], z[3] - data[11]
    value[0] += 0.5 * dot(_stress(data, z), change)


@callback(UFCX_SIGNATURE)
def force_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Forces and moments of a spring on its three nodes."""
    H, data = numba.carray(w, (3, 4, 3)), numba.carray(w, (_SIZE,))[_DATA:]
    out = numba.carray(A, (3, 6))
    a, b, c_ = load_frame(H[0]), load_frame(H[1]), load_frame(H[2])
    sides = _sides(a, b, c_, data)
    found = _forces(a, b, c_, sides, _stress(data, sides[2]), data)
    for i in range(3):
        for k in range(3):
            out[i, k] += found[i][k]
            out[i, 3 + k] += found[3 + i][k]


@inlined
def _moved(H: Array, h: Array) -> _Numbers:
    """A frame after a tiny imaginary increment, to first order."""
    position, d1, d2, d3 = load_frame(H)
    ι = complex(0.0, _TINY)
    u, η = (ι * h[0], ι * h[1], ι * h[2]), (ι * h[3], ι * h[4], ι * h[5])
    return (
        plus(position, rotate(d1, d2, d3, u)),
        plus(d1, combined(η[2], d2, -η[1], d3)),
        plus(d2, combined(η[0], d3, -η[2], d1)),
        plus(d3, combined(η[1], d1, -η[0], d2)),
    )


@callback(UFCX_SIGNATURE)
def matrix_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Derivative of forces at the independent stress, by columns, and ``ZᵀBZ``, ``Z = z'``."""
    H, data = numba.carray(w, (3, 4, 3)), numba.carray(w, (_SIZE,))[_DATA:]
    K, Z = numba.carray(A, (18, 18)), numba.carray(stack(18 * 3), (18, 3))
    h = numba.carray(stack(18), (3, 6))
    h[:] = 0.0
    S = data[14], data[15], data[16]
    for j in range(18):
        h[j // 6, j % 6] = 1.0
        a, b, c_ = _moved(H[0], h[0]), _moved(H[1], h[1]), _moved(H[2], h[2])
        h[j // 6, j % 6] = 0.0
        sides = _sides(a, b, c_, data)
        found = _forces(a, b, c_, sides, S, data)
        for k in range(3):
            Z[j, k] = sides[2][1 + k].imag / _TINY
            for i in range(3):
                K[6 * i + k, j] += found[i][k].imag / _TINY
                K[6 * i + 3 + k, j] += found[3 + i][k].imag / _TINY
    for j in range(18):
        for k in range(3):
            by = data[k] * Z[j, 0] + data[3 + k] * Z[j, 1] + data[6 + k] * Z[j, 2]
            for i in range(18):
                K[i, j] += Z[i, k] * by


@compiled
def _update_stress(H: Array, nodes: Indices, h: Array, values: Array) -> None:
    """Write the stress after increments ``h`` (n, 6), to first order, to the packed data."""
    for i in range(nodes.shape[0]):
        data = values[i]
        a, b, c = nodes[i]
        z = _sides(_moved(H[a], h[a]), _moved(H[b], h[b]), _moved(H[c], h[c]), data)[2]
        end = (
            0.0,
            z[1].real + z[1].imag / _TINY,
            z[2].real + z[2].imag / _TINY,
            z[3].real + z[3].imag / _TINY,
        )
        data[14], data[15], data[16] = _stress(data, end)


class CornerSprings(LinearisedCellTerm, Springs):
    """Springs between the edges of discrete rods, on the nodes of their assembly."""

    label, conserved = "discrete rods (DiscreteRod)", True

    def __init__(self, corners: Corners, count: int) -> None:
        """Pack the springs, on an assembly with ``count`` nodes."""
        b = len(corners.nodes)
        parts = corners.stiffness.reshape(b, 9), corners.natural, corners.frames.astype(float)
        kernels = energy_kernel, force_kernel, matrix_kernel
        values = np.hstack([*parts, np.zeros((b, 3))])
        super().__init__(kernels, values, corners, count)
        self._stress = self._matrix.values[:, 14:]

    def update_stress(self, H: Array, h: Array) -> None:
        """Update the independent stress for the increment ``h`` (count, 6) from frames ``H``."""
        _update_stress(H, self.springs.nodes, h.reshape(-1, 6), self._matrix.values)
