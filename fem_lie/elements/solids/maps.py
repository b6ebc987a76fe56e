"""How places of nodes, and the volumes of cells, move with nodes of kind ``POINT``.

Nodes store four rows, of which the first is the place and the others are axes ``R``; unknowns are
displacements along these, ``δx = R h``. Flat coordinates are the places, and for
:data:`PLACES_AND_VOLUME` the volume of a cell with eight nodes beside them::

    v = Σ_g w_g g₁·(g₂ × g₃),    g_b = Σ_i x_i ∂N_i/∂ξ_b

which two points along each direction integrate exactly.
"""

from __future__ import annotations

import numba
import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled
from fem_lie.forms.kernels.addresses import Pointer
from fem_lie.forms.kernels.frame_map import FrameMap, frame_function
from fem_lie.lie.tuples import (
    Vector,
    cross,
    dot,
    load,
    load_row,
    plus,
    rotate,
    rotate_back,
    scaled,
    store,
    store_row,
)
from fem_lie.mesh.shapes import rule, tabulated

_NODES = 8


def _slopes() -> tuple[Array, Array]:
    """Slopes of the shape functions at the points of integration, (g, 8, 3), and weights (g,)."""
    points, weights = rule("hexahedron", 3)
    slopes = tabulated("hexahedron", 1, points)[1:]
    return np.ascontiguousarray(slopes.transpose(1, 2, 0)), weights


_SLOPES, _WEIGHTS = _slopes()


@compiled
def _tangents(x: Array, g: int) -> tuple[Vector, Vector, Vector]:
    """``g_b`` at a point of integration, of places in the first rows of ``x`` (8, ≥ 1, 3)."""
    a = b = c = (0.0, 0.0, 0.0)
    for i in range(_NODES):
        place, d = load_row(x[i], 0), load_row(_SLOPES[g], i)
        a, b, c = (
            plus(a, scaled(d[0], place)),
            plus(b, scaled(d[1], place)),
            plus(c, scaled(d[2], place)),
        )
    return a, b, c


@compiled
def volume(x: Array) -> float:
    """Volume of a cell with eight nodes, negative if its first three edges are left-handed.

    Args:
        x: Rows of its nodes, of which the first is the place, shape (8, any, 3).
    """
    total = 0.0
    for g in range(_WEIGHTS.shape[0]):
        a, b, c = _tangents(x, g)
        total += _WEIGHTS[g] * dot(a, cross(b, c))
    return total


@compiled
def _volume_slopes(x: Array, out: Array) -> None:
    """``∂v/∂x_i``, shape (8, 3)."""
    out[:] = 0.0
    for g in range(_WEIGHTS.shape[0]):
        a, b, c = _tangents(x, g)
        bc, ca, ab = cross(b, c), cross(c, a), cross(a, b)
        for i in range(_NODES):
            d = scaled(_WEIGHTS[g], load_row(_SLOPES[g], i))
            rise = plus(plus(scaled(d[0], bc), scaled(d[1], ca)), scaled(d[2], ab))
            store_row(out, i, plus(load_row(out, i), rise))


@compiled
def _add_volume_bend(H: Array, force: float, A: Array) -> None:
    """``A += force · R_iᵀ (∂²v/∂x_i∂x_j) R_j``, shape (8, 6, 8, 6)."""
    for i in range(_NODES):
        for j in range(_NODES):
            lever = (0.0, 0.0, 0.0)
            for g in range(_WEIGHTS.shape[0]):
                a, b, c = _tangents(H, g)
                n = scaled(_WEIGHTS[g], cross(load_row(_SLOPES[g], i), load_row(_SLOPES[g], j)))
                part = plus(plus(scaled(n[0], a), scaled(n[1], b)), scaled(n[2], c))
                lever = plus(lever, part)
            axes = load_row(H[i], 1), load_row(H[i], 2), load_row(H[i], 3)
            for k in range(3):
                change = cross(load_row(H[j], 1 + k), scaled(force, lever))
                for m in range(3):
                    A[i, m, j, k] += dot(axes[m], change)


@compiled
def _add_pulled(H: Array, f: Array, r: Array) -> None:
    """``r_i += R_iᵀ f_i`` for each node, shapes (n, 4, 3), (n, 3) and (n, 6)."""
    for i in range(f.shape[0]):
        own = rotate_back(load_row(H[i], 1), load_row(H[i], 2), load_row(H[i], 3), load_row(f, i))
        store(r[i], 0, plus(load(r[i], 0), own))


@compiled
def _push_places(H: Array, h: Array, out: Array) -> None:
    """``δx_i = R_i h_i``."""
    for i in range(h.shape[0]):
        moved = rotate(load_row(H[i], 1), load_row(H[i], 2), load_row(H[i], 3), load(h[i], 0))
        store_row(out, i, moved)


@frame_function
def _places(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    H, x = numba.carray(state, (nodes, 4, 3)), numba.carray(y, (nodes, 3))
    for i in range(nodes):
        store_row(x, i, load_row(H[i], 0))


@frame_function
def _pull(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    H, f = numba.carray(state, (nodes, 4, 3)), numba.carray(given, (nodes, 3))
    _add_pulled(H, f, numba.carray(out, (nodes, 6)))


@frame_function
def _push(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    H, h = numba.carray(state, (nodes, 4, 3)), numba.carray(given, (nodes, 6))
    _push_places(H, h, numba.carray(out, (nodes, 3)))


@frame_function
def _with_volume(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    H = numba.carray(state, (nodes, 4, 3))
    x, whole = numba.carray(y, (nodes, 3)), numba.carray(y, (3 * nodes + 1,))
    for i in range(nodes):
        store_row(x, i, load_row(H[i], 0))
    whole[3 * nodes] = volume(H)


@frame_function
def _pull_volume(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    H, whole = numba.carray(state, (nodes, 4, 3)), numba.carray(given, (3 * nodes + 1,))
    f, slopes = numba.carray(given, (nodes, 3)), np.empty((_NODES, 3))
    r = numba.carray(out, (nodes, 6))
    _add_pulled(H, f, r)
    if whole[3 * nodes] != 0.0:
        _volume_slopes(H, slopes)
        slopes *= whole[3 * nodes]
        _add_pulled(H, slopes, r)


@frame_function
def _push_volume(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    H, h = numba.carray(state, (nodes, 4, 3)), numba.carray(given, (nodes, 6))
    dx, whole = numba.carray(out, (nodes, 3)), numba.carray(out, (3 * nodes + 1,))
    slopes = np.empty((_NODES, 3))
    _push_places(H, h, dx)
    _volume_slopes(H, slopes)
    total = 0.0
    for i in range(nodes):
        total += dot(load_row(slopes, i), load_row(dx, i))
    whole[3 * nodes] = total


@frame_function
def _bend_volume(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    H, whole = numba.carray(state, (nodes, 4, 3)), numba.carray(given, (3 * nodes + 1,))
    _add_volume_bend(H, whole[3 * nodes], numba.carray(out, (nodes, 6, nodes, 6)))


PLACES = FrameMap(_places, _pull, _push, None, values=12, unknowns=6)
"""Flat coordinates are the places of the nodes, whatever cell and degree."""

PLACES_AND_VOLUME = FrameMap(
    _with_volume, _pull_volume, _push_volume, _bend_volume, values=12, unknowns=6
)
"""Places of the eight nodes of a cell, then its volume."""
