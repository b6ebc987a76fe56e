"""Springs between successive edges of discrete rods: bending without frames or twist.

Between edges ``e`` and ``f`` that turn by the angle ``φ`` the curvature over the length ``ℓ``, half
of both edges, is that of ``κb = 2 e × f/(|e||f| + e·f)``, whose length is ``2 tan φ/2``::

    W = ½ EI/ℓ (|κb| − κ₀)²,    |κb|² = 4 (1 − x)/(1 + x),    x = e·f/(|e||f|)

with the natural one ``κ₀``, without a direction. (Bergou, Wardetzky, Robinson, Audoly & Grinspun,
*ACM Trans. Graph.* 27 (2008) 63; Jawed, Novelia & O'Reilly, *A Primer on the Kinematics of Discrete
Elastic Rods*, 2018.) At a clamped end ``e`` is fixed in space, and ``ℓ`` is half of ``f``.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt
from typing import NamedTuple, TypeAlias

import numba
import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import callback, inlined
from fem_lie.elements.rods.springs import Springs
from fem_lie.forms.kernels.addresses import UFCX_SIGNATURE, Pointer
from fem_lie.lie.tuples import (
    Vector,
    combined,
    dot,
    load_row,
    minus,
    plus,
    rotate_back,
    scaled,
)

_DATA = 36
"""Numbers of the cell follow the rows of its three nodes: ``EI/ℓ``, ``κ₀``, what is added to e."""

_STRAIGHT = 1e-12
"""Natural ``|κb|`` that is round-off of places along a straight line."""


class Successive(NamedTuple):
    """Edges that bend together.

    Attributes:
        nodes: Ends of the first edge and of the second one, which begins where the first ends,
            shape (b, 3).
        edges: Both, shape (b, 2).
    """

    nodes: Indices
    edges: Indices


class Bends(NamedTuple):
    """Springs between edges.

    Attributes:
        nodes: As of :class:`Successive`; at a clamped end the first two are the same.
        stiffness: ``EI/ℓ``, shape (b,).
        natural: ``κ₀``, shape (b,).
        fixed: First edges where they are fixed in space, zero elsewhere, shape (b, 3).
    """

    nodes: Indices
    stiffness: Array
    natural: Array
    fixed: Array

    @classmethod
    def between(cls, places: Array, along: Successive, flexibility: Array, natural: bool) -> Bends:
        """Of successive edges.

        Args:
            places: Of the nodes, as laid, shape (n, 3).
            along: Which.
            flexibility: ``ℓ/EI`` of each edge, shape (m,).
            natural: Whether they are naturally as they are laid.
        """
        e, f = np.diff(places[along.nodes], axis=1).swapaxes(0, 1)
        u, v = (a / np.linalg.norm(a, axis=1, keepdims=True) for a in (e, f))
        size = 2 * np.linalg.norm(u - v, axis=1) / np.linalg.norm(u + v, axis=1)
        stiffness = 2.0 / flexibility[along.edges].sum(axis=1)
        own: Array = np.where(size > _STRAIGHT, size, 0.0) if natural else np.zeros(len(size))
        return cls(along.nodes, np.asarray(stiffness), own, np.zeros_like(e))

    @classmethod
    def at_ends(cls, nodes: Indices, fixed: Array, flexibility: Array) -> Bends:
        """Of ends whose direction does not change, over half of their edges.

        Args:
            nodes: The end, and the other node of its edge, shape (b, 2).
            fixed: First edges, shape (b, 3).
            flexibility: ``ℓ/EI`` of the edges, shape (b,).
        """
        return cls(nodes[:, [0, 0, 1]], np.asarray(2.0 / flexibility), np.zeros(len(nodes)), fixed)

    @classmethod
    def joined(cls, parts: Sequence[Bends]) -> Bends:
        """All of them."""
        return cls(*(np.concatenate(column) for column in zip(*parts, strict=True)))


_Corner: TypeAlias = tuple[Vector, Vector, float, float, float]
"""Both edges' directions and lengths, and ``x``."""


@inlined
def _edges(H: Array, data: Array) -> _Corner:
    middle = load_row(H[1], 0)
    e = plus(minus(middle, load_row(H[0], 0)), (data[2], data[3], data[4]))
    f = minus(load_row(H[2], 0), middle)
    α, β = sqrt(dot(e, e)), sqrt(dot(f, f))
    u, v = scaled(1.0 / α, e), scaled(1.0 / β, f)
    return u, v, α, β, dot(u, v)


@inlined
def _curvature(u: Vector, v: Vector, x: float) -> float:
    """``|κb|``, of which ``1 − x`` would lose the digits."""
    gap = minus(u, v)
    return sqrt(2.0 * dot(gap, gap) / (1.0 + x))


@inlined
def _slopes(corner: _Corner, data: Array) -> tuple[float, float]:
    """``W′`` and ``W″`` in ``x``."""
    u, v, _, _, x = corner
    first, second = -8.0 / (1.0 + x) ** 2, 16.0 / (1.0 + x) ** 3
    g, more = 0.5 * data[0], 0.0
    if data[1] > 0.0:
        κ = _curvature(u, v, x)
        if κ > 0.0:
            g, more = g * (1.0 - data[1] / κ), 0.25 * data[0] * data[1] / κ**3
        else:
            g = 0.0  # straight, and bent alike to all sides
    return g * first, more * first**2 + g * second


@inlined
def _beside(u: Vector, v: Vector) -> Vector:
    """``v − x u``, of which the digits would be lost where both are nearly the same."""
    gap = minus(v, u)
    return combined(1.0, gap, 0.5 * dot(gap, gap), u)


@inlined
def _spread(H: Array, e: Vector, f: Vector, out: Array) -> None:
    """Forces on both edges to those on the three nodes, along the axes of these; (3, ≥ 3)."""
    forces = scaled(-1.0, e), minus(e, f), f
    for i in range(3):
        axes = load_row(H[i], 1), load_row(H[i], 2), load_row(H[i], 3)
        own = rotate_back(axes[0], axes[1], axes[2], forces[i])
        for k in range(3):
            out[i, k] += own[k]


@callback(UFCX_SIGNATURE)
def energy_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """``W`` of a spring."""
    H, data = numba.carray(w, (3, 4, 3)), numba.carray(w, (_DATA + 5,))[_DATA:]
    u, v, _, _, cosine = _edges(H, data)
    value = numba.carray(A, (1,))
    value[0] += 0.5 * data[0] * (_curvature(u, v, cosine) - data[1]) ** 2


@callback(UFCX_SIGNATURE)
def force_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Its gradient, ``W′ ∂x/∂e = W′ (v − x u)/|e|`` and the like of ``f``."""
    H, data = numba.carray(w, (3, 4, 3)), numba.carray(w, (_DATA + 5,))[_DATA:]
    corner = _edges(H, data)
    u, v, α, β, _ = corner
    slope, _ = _slopes(corner, data)
    e, f = scaled(slope / α, _beside(u, v)), scaled(slope / β, _beside(v, u))
    _spread(H, e, f, numba.carray(A, (3, 6)))


@inlined
def _across(u: Vector, a: Vector) -> Vector:
    return minus(a, scaled(dot(u, a), u))


@inlined
def _own(u: Vector, v: Vector, α: float, x: float, d: Vector) -> Vector:
    """``∂²x/∂e∂e d = −((v − x u) u·d + u (v − x u)·d + x (d − u u·d))/|e|²``."""
    a = _beside(u, v)
    sum_ = plus(plus(scaled(dot(u, d), a), scaled(dot(a, d), u)), scaled(x, _across(u, d)))
    return scaled(-1.0 / α**2, sum_)


@callback(UFCX_SIGNATURE)
def matrix_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Its Hessian, column by column."""
    H, data = numba.carray(w, (3, 4, 3)), numba.carray(w, (_DATA + 5,))[_DATA:]
    K = numba.carray(A, (3, 6, 3, 6))
    corner = _edges(H, data)
    u, v, α, β, cosine = corner
    slope, curve = _slopes(corner, data)
    a, b = scaled(1.0 / α, _beside(u, v)), scaled(1.0 / β, _beside(v, u))
    for j in range(3):
        for k in range(3):
            d = load_row(H[j], 1 + k)
            de = scaled(-1.0 if j == 0 else 1.0 if j == 1 else 0.0, d)
            df = scaled(-1.0 if j == 1 else 1.0 if j == 2 else 0.0, d)
            size = curve * (dot(a, de) + dot(b, df))
            mixed = slope / (α * β)
            e = combined(size, a, slope, _own(u, v, α, cosine, de))
            f = combined(size, b, slope, _own(v, u, β, cosine, df))
            e = plus(e, scaled(mixed, _across(u, _across(v, df))))
            f = plus(f, scaled(mixed, _across(v, _across(u, de))))
            _spread(H, e, f, K[:, :, j, k])


class BendingSprings(Springs):
    """Springs between the edges of discrete rods, on the nodes of their assembly."""

    label = "bending springs"

    def __init__(self, bends: Bends, count: int) -> None:
        """Pack the springs, on the nodes of an assembly of so many."""
        values = np.column_stack([bends.stiffness, bends.natural, bends.fixed])
        super().__init__((energy_kernel, force_kernel, matrix_kernel), values, bends, count)
        self._matrix.used = 3
