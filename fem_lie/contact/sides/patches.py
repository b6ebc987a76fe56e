"""Cells of shells as smooth patches with a radius: closest points, compiled.

A patch is cubic, from positions and tangents at its corners,
``Q = Σ Nₖ xₖ + Mₖ₀ Rₖ tₖ₀ + Mₖ₁ Rₖ tₖ₁``, with tangents perpendicular to the director. Its edges
are Hermite cubics that neighbours share, as they do the tangent planes at corners. A quadrilateral
is Ferguson's patch without twists, which is smooth across edges of regular meshes; a triangle is
Bézier's, whose middle control point makes it exact for parabolas.

A patch without tangents is bilinear in positions, ``Q = Σ Lₖ xₖ``: it has straight edges, and kinks
across them.

J. Ferguson, Multivariable curve interpolation, J. ACM 11 (1964) 221; A. Vlachos et al., Curved PN
triangles, I3D 2001.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined_uncounted, uncounted
from fem_lie.contact.sides.curves import at, project, slopes, weights
from fem_lie.contact.sides.surfaces import MOST_NODES
from fem_lie.contact.sides.table import GROUND, UNUSED
from fem_lie.lie.motions import global_components
from fem_lie.lie.tuples import Vector, dot, load_row, minus, plus, scaled, store_row

NET = 3 * MOST_NODES
"""Number of vectors of a patch: positions of the corners, then two tangents at each."""

VALUE, BY_U, BY_V, BY_UU, BY_UV, BY_VV = range(6)
"""Rows of shape functions and their derivatives."""

_WORKSPACE = 6
ROWS = 9
"""Number of rows of arrays for them, with workspace."""

_TURNS = 30
_ZERO = 1e-14
"""Accuracy of a position on a patch, relative to its size."""


class Patches(NamedTuple):
    """Cells of one surface.

    Attributes:
        nodes: Nodes of the corners in DOLFINx's order, or ground, :data:`.UNUSED` after the third
            of a triangle, (m, 4).
        slots: Index of the node of each corner among those that a contact point depends on: that of
            the corner, or 0 for all corners on one frame, shape (m, 4).
        offsets: Offsets of the corners in the frames of their nodes, shape (m, 4, 3).
        tangents: Tangents in the frames of the corners: along both axes of a quadrilateral, to both
            other corners of a triangle, shape (m, 4, 2, 3).
        radii: Half of the thickness, shape (m,).
        corners: Mesh points of the corners, equal for equal positions, negative after the third of
            a triangle, shape (m, 4).
        at_corners: Number of patches that share each corner, shape (m, 4).
        at_edges: Number of patches that share each edge, in the order of :func:`edge_ends`, (m, 4).
        nets: Present control nets, shape (m, 12, 3).
        straight: Whether patches have no tangents; these are zero.
    """

    nodes: Indices
    slots: Indices
    offsets: Array
    tangents: Array
    radii: Array
    corners: Indices
    at_corners: Indices
    at_edges: Indices
    nets: Array
    straight: bool


class Nearest(NamedTuple):
    """Closest point on a patch.

    Attributes:
        square: Squared distance.
        u: First parameter.
        v: Second parameter.
        edge: Edge that the point is on, or −1.
        end: End of the edge that the point is, 0 or 1, or −1.
    """

    square: float
    u: float
    v: float
    edge: int
    end: int


@inlined_uncounted
def is_triangle(patches: Patches, j: int) -> bool:
    """Whether a patch is a triangle."""
    return bool(patches.corners[j, 3] < 0)


@compiled
def set_nets(H: Array, patches: Patches) -> None:
    """Set positions and tangents of the corners at frames ``H``."""
    for j in range(patches.nodes.shape[0]):
        for k in range(MOST_NODES):
            node, net = patches.nodes[j, k], patches.nets[j]
            if node == UNUSED:
                break
            x = load_row(patches.offsets[j], k)
            if node != GROUND:
                x = plus(load_row(H[node], 0), global_components(H[node], x))
            store_row(net, k, x)
            for a in range(2):
                t = load_row(patches.tangents[j, k], a)
                if node != GROUND:
                    t = global_components(H[node], t)
                store_row(net, MOST_NODES + 2 * k + a, t)


@inlined_uncounted
def _set_cubics(s: float, W: Array, row: int) -> None:
    """Hermite's functions and their first and second derivatives."""
    W[row, 0], W[row, 1], W[row, 2], W[row, 3] = weights(s)
    W[row, 4], W[row, 5], W[row, 6], W[row, 7] = slopes(s)
    W[row, 8], W[row, 9] = 12.0 * s - 6.0, 6.0 - 12.0 * s
    W[row, 10], W[row, 11] = 6.0 * s - 4.0, 6.0 * s - 2.0


@uncounted
def _set_quadrilateral(u: float, v: float, W: Array) -> None:
    """Shape functions of a quadrilateral and their derivatives."""
    _set_cubics(u, W, _WORKSPACE)
    _set_cubics(v, W, _WORKSPACE + 1)
    A, B, row = W[_WORKSPACE], W[_WORKSPACE + 1], 0
    for total in range(3):
        for q in range(total + 1):
            p = total - q
            for k in range(4):
                a, b = 4 * p + k % 2, 4 * q + k // 2
                W[row, k] = A[a] * B[b]
                W[row, 4 + 2 * k] = A[2 + a] * B[b]
                W[row, 5 + 2 * k] = A[a] * B[2 + b]
            row += 1


@uncounted
def _set_triangle(u: float, v: float, W: Array) -> None:
    """Shape functions of a triangle and their derivatives; those of the fourth corner are zero."""
    W[:] = 0.0
    λ, G, B = W[_WORKSPACE], W[_WORKSPACE + 1], W[_WORKSPACE + 2]
    λ[0], λ[1], λ[2] = 1.0 - u - v, u, v
    for i in range(3):
        for part in range(3):
            # N, then M to the next corner and to the one after it
            j = (i + max(part, 1)) % 3
            k = 3 - i - j
            a, b, c = λ[i], λ[j], λ[k]
            bubble = 2.0 if part == 0 else 0.5
            value = bubble * a * b * c
            G[i], G[j], G[k] = bubble * b * c, bubble * a * c, bubble * a * b
            ii, ij, ik, jk = 0.0, bubble * c, bubble * b, bubble * a
            if part == 0:
                value += a * a * (a + 3.0 * (b + c))
                G[i] += 3.0 * a * a + 6.0 * a * (b + c)
                G[j] += 3.0 * a * a
                G[k] += 3.0 * a * a
                ii, ij, ik = 6.0 * (a + b + c), ij + 6.0 * a, ik + 6.0 * a
            else:
                value += a * a * b
                G[i] += 2.0 * a * b
                G[j] += a * a
                ii, ij = 2.0 * b, ij + 2.0 * a
            # pairs of corners, by the index of the third one
            B[3 + i], B[3 + j], B[3 + k] = jk, ik, ij
            B[i], B[j], B[k] = ii, 0.0, 0.0
            n = i if part == 0 else MOST_NODES + 2 * i + part - 1
            W[VALUE, n], W[BY_U, n], W[BY_V, n] = value, G[1] - G[0], G[2] - G[0]
            W[BY_UU, n] = B[1] - 2.0 * B[5] + B[0]
            W[BY_UV, n] = B[3] - B[5] - B[4] + B[0]
            W[BY_VV, n] = B[2] - 2.0 * B[4] + B[0]


@inlined_uncounted
def linear(triangle: bool, k: int, u: float, v: float) -> float:
    """Weight of a corner in a bilinear patch."""
    if triangle:
        if k == 0:
            return 1.0 - u - v
        return u if k == 1 else v
    return (u if k % 2 else 1.0 - u) * (v if k // 2 else 1.0 - v)


@uncounted
def _set_straight(triangle: bool, u: float, v: float, W: Array) -> None:
    """Shape functions of a patch without tangents; those of the tangents are zero."""
    W[:] = 0.0
    for k in range(3 if triangle else MOST_NODES):
        W[VALUE, k] = linear(triangle, k, u, v)
        W[BY_U, k] = linear(triangle, k, 1.0, v) - linear(triangle, k, 0.0, v)
        W[BY_V, k] = linear(triangle, k, u, 1.0) - linear(triangle, k, u, 0.0)
        if not triangle:
            W[BY_UV, k] = 1.0 if k == 0 or k == 3 else -1.0


@uncounted
def set_shapes(triangle: bool, straight: bool, u: float, v: float, W: Array) -> None:
    """Shape functions of a patch and their derivatives, shape (9, 12)."""
    if straight:
        _set_straight(triangle, u, v, W)
    elif triangle:
        _set_triangle(u, v, W)
    else:
        _set_quadrilateral(u, v, W)


@inlined_uncounted
def combination(net: Array, W: Array, row: int) -> Vector:
    """Position on a patch or one of its derivatives."""
    x = (0.0, 0.0, 0.0)
    for k in range(NET):
        x = plus(x, scaled(W[row, k], load_row(net, k)))
    return x


@inlined_uncounted
def bends_at(net: Array, W: Array, separation: Vector) -> tuple[float, float, float]:
    """Second derivatives of half the squared distance: ``Q,ₐ·Q,ᵦ − Δ·Q,ₐᵦ``."""
    tu, tv = combination(net, W, BY_U), combination(net, W, BY_V)
    return (
        dot(tu, tu) - dot(separation, combination(net, W, BY_UU)),
        dot(tu, tv) - dot(separation, combination(net, W, BY_UV)),
        dot(tv, tv) - dot(separation, combination(net, W, BY_VV)),
    )


@inlined_uncounted
def edge_ends(triangle: bool, edge: int) -> tuple[int, int]:
    """Corners at both ends of an edge."""
    if triangle:
        return edge, (edge + 1) % 3
    if edge < 2:
        return 2 * edge, 2 * edge + 1
    return edge - 2, edge


@inlined_uncounted
def edge_slope(triangle: bool, edge: int) -> tuple[float, float]:
    """Derivatives of ``u`` and ``v`` along an edge."""
    if triangle:
        return (1.0, 0.0) if edge == 0 else ((-1.0, 1.0) if edge == 1 else (0.0, -1.0))
    return (1.0, 0.0) if edge < 2 else (0.0, 1.0)


@inlined_uncounted
def _edge_start(triangle: bool, edge: int) -> tuple[float, float]:
    if triangle:
        return (0.0, 0.0) if edge == 0 else ((1.0, 0.0) if edge == 1 else (0.0, 1.0))
    return (0.0, 1.0 * edge) if edge < 2 else (1.0 * (edge - 2), 0.0)


@uncounted
def _set_edge(triangle: bool, straight: bool, net: Array, edge: int, C: Array) -> None:
    """An edge as a cubic, shape (4, 3)."""
    p, q = edge_ends(triangle, edge)
    store_row(C, 0, load_row(net, p))
    store_row(C, 1, load_row(net, q))
    if straight:
        chord = minus(load_row(net, q), load_row(net, p))
        store_row(C, 2, chord)
        store_row(C, 3, chord)
    elif triangle:
        store_row(C, 2, load_row(net, MOST_NODES + 2 * p))
        store_row(C, 3, scaled(-1.0, load_row(net, MOST_NODES + 2 * q + 1)))
    else:
        a = 0 if edge < 2 else 1
        store_row(C, 2, load_row(net, MOST_NODES + 2 * p + a))
        store_row(C, 3, load_row(net, MOST_NODES + 2 * q + a))


@uncounted
def _within(triangle: bool, straight: bool, net: Array, P: Vector, W: Array) -> Nearest:
    """The closest point in the interior, or an infinite distance if there is none."""
    u = v = 1.0 / 3.0 if triangle else 0.5
    none = Nearest(np.inf, 0.0, 0.0, -1, -1)
    for _ in range(_TURNS):
        set_shapes(triangle, straight, u, v, W)
        separation = minus(P, combination(net, W, VALUE))
        tu, tv = combination(net, W, BY_U), combination(net, W, BY_V)
        f, g = dot(separation, tu), dot(separation, tv)
        a, b, c = bends_at(net, W, separation)
        if a <= 0.0 or a * c - b * b <= 0.0:
            a, b, c = dot(tu, tu), dot(tu, tv), dot(tv, tv)
        size = a * c - b * b
        if size <= 0.0:
            return none
        du, dv = (c * f - b * g) / size, (a * g - b * f) / size
        longest = max(abs(du), abs(dv))
        if longest > 0.5:
            du, dv = 0.5 * du / longest, 0.5 * dv / longest
        u, v = u + du, v + dv
        if not (-1.0 < u < 2.0 and -1.0 < v < 2.0):
            return none
        if longest < _ZERO:
            break
    inside = u >= 0.0 and v >= 0.0 and (u + v <= 1.0 if triangle else (u <= 1.0 and v <= 1.0))
    set_shapes(triangle, straight, u, v, W)
    separation = minus(P, combination(net, W, VALUE))
    a, b, c = bends_at(net, W, separation)
    if not inside or a <= 0.0 or a * c - b * b <= 0.0:
        return none
    return Nearest(dot(separation, separation), u, v, -1, -1)


@uncounted
def nearest_on(
    triangle: bool, straight: bool, net: Array, P: Vector, W: Array, C: Array
) -> Nearest:
    """Closest point to ``P`` on a patch (12, 3); ``W`` (9, 12), ``C`` (4, 3): workspace."""
    found = _within(triangle, straight, net, P, W)
    if found.square < np.inf:
        return found
    for edge in range(3 if triangle else 4):
        _set_edge(triangle, straight, net, edge, C)
        s = project(C, P)
        separation = minus(P, at(C, s))
        square = dot(separation, separation)
        if square < found.square:
            u, v = _edge_start(triangle, edge)
            du, dv = edge_slope(triangle, edge)
            end = 0 if s == 0.0 else (1 if s == 1.0 else -1)
            found = Nearest(square, u + s * du, v + s * dv, edge, end)
    return found
