"""Mortar matrices of two faces of solids that lie on each other with different meshes.

Facets of the first face are cut into *segments*, each within one facet of the second: convex
polygons, clipped in the plane of the first facet after a projection of the second along its normal
(Puso, Int. J. Numer. Meth. Engng 59 (2004) 315). Gauss points on triangles of these polygons
integrate products of shape functions of both faces::

    D_ij = ∫ Φ_i N_j dA,    M_ik = ∫ Φ_i N_k dA

with one multiplier ``Φ_i`` for each corner ``i`` of the facets of the first face, linear along its
edges. Both matrices come from the same points, so that ``Σ_j D_ij = Σ_k M_ik``, and ``Σ_j D_ij x_j
= Σ_k M_ik x_k`` where the faces have no distance: forces of multipliers have no resultant and no
moment.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from scipy.spatial import cKDTree

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie.bodies.solids.faces import Faces
from fem_lie.mesh.shapes import rule, tabulated

_OPPOSITE = -0.5
"""Largest cosine between outward normals of facets that lie on each other."""

_NOTHING = 1e-12
"""Area of a segment over that of the facet below which it is round-off."""

_COVERED = 1e-6
"""Part of the area of a facet that the second face may leave uncovered."""

_MOST = 16
"""Largest number of corners of a segment: two quadrilaterals have at most eight."""

_NEWTON = 20
"""Largest number of iterations for reference coordinates; three where facets are not distorted."""

_ORDERS = {("triangle", 1): 1, ("triangle", 2): 2, ("quadrilateral", 1): 2, ("quadrilateral", 2): 4}
"""Largest degree of a shape function in the positions of a facet."""


class Face(NamedTuple):
    """A face of a solid.

    Attributes:
        facets: Its facets.
        x: Unloaded positions of the nodes of the solid, shape (n, 3).
        label: Name in messages.
    """

    facets: Faces
    x: Array
    label: str

    @property
    def corners(self) -> Indices:
        """Nodes at the corners of each facet, shape (f, 3 or 4)."""
        return self.facets.nodes[:, : 3 if self.facets.cell == "triangle" else 4]


class MortarMatrices(NamedTuple):
    """Mean values over one face and the other, with the weights of the same multipliers.

    Attributes:
        nodes: Node of the first face of each multiplier, shape (p,).
        first: Mean of nodal values of the first solid, ``D_ij / ∫ Φ_i``, shape (p, n).
        second: The same of the second solid, ``M_ik / ∫ Φ_i``, shape (p, n).
        areas: Area of each multiplier, ``∫ Φ_i``, shape (p,).
    """

    nodes: Indices
    first: sp.csr_matrix
    second: sp.csr_matrix
    areas: Array


class _Pieces(NamedTuple):
    """Plane convex pieces of facets.

    Attributes:
        corners: Positions of the corners around each, shape (m, 3 or 4, 3).
        of: Facet of each piece, shape (m,).
        centres: Means of the corners, shape (m, 3).
        normals: Unit outward normals, shape (m, 3).
        radii: Largest distance of a corner from the centre, shape (m,).
        areas: Areas, projected along the normal, shape (m,).
    """

    corners: Array
    of: Indices
    centres: Array
    normals: Array
    radii: Array
    areas: Array


class _Segments(NamedTuple):
    """Triangles of all segments.

    Attributes:
        corners: Positions of their corners, shape (t, 3, 3).
        areas: Areas, shape (t,).
        first: Piece of the first face, shape (t,).
        second: Piece of the second face, shape (t,).
    """

    corners: Array
    areas: Array
    first: Indices
    second: Indices


def mortar_matrices(first: Face, second: Face, tolerance: float) -> MortarMatrices:
    """Mortar matrices of two faces.

    Args:
        first: Face with the multipliers; it lies within the second.
        second: The other face.
        tolerance: Largest distance between the faces, a length.

    Raises:
        ValueError: The faces are further from each other, or the second does not cover the first.
    """
    a, b = _pieces(first), _pieces(second)
    segments = _segments(a, b, *_near(a, b, tolerance))
    _refuse_separate(first, second, segments)
    ξ, η, weights, of = _points(first, second, (a, b), segments, tolerance)
    _refuse_uncovered(first, second, (a, b), segments)
    return _integrated(first, second, (ξ, η), weights, of)


def _pieces(face: Face) -> _Pieces:
    drawn = face.facets.drawn()
    corners = face.x[drawn]
    centres = corners.mean(axis=1)
    arms = corners - centres[:, np.newaxis]
    across = 0.5 * np.cross(arms, np.roll(arms, -1, axis=1)).sum(axis=1)
    areas = np.linalg.norm(across, axis=1)
    of = np.repeat(np.arange(len(face.facets.nodes)), len(drawn) // len(face.facets.nodes))
    radii = np.linalg.norm(arms, axis=2).max(axis=1)
    return _Pieces(corners, of, centres, across / areas[:, np.newaxis], radii, areas)


def _near(a: _Pieces, b: _Pieces, tolerance: float) -> tuple[Indices, Indices]:
    """Pairs of pieces with opposite normals whose enclosing balls overlap."""
    reach = float(a.radii.max() + b.radii.max()) + tolerance
    found = cKDTree(b.centres).query_ball_point(a.centres, reach)
    i: Indices = np.repeat(np.arange(len(found)), [len(each) for each in found])
    j: Indices = np.concatenate([np.array(each, dtype=np.int64) for each in found])
    away = np.linalg.norm(a.centres[i] - b.centres[j], axis=1)
    facing = np.einsum("pk,pk->p", a.normals[i], b.normals[j]) < _OPPOSITE
    kept = facing & (away <= a.radii[i] + b.radii[j] + tolerance)
    return i[kept], j[kept]


@compiled
def _clip(subject: Array, count: int, p: Array, q: Array, out: Array) -> int:
    """Part of a polygon (count, 2) to the left of the line from p to q; returns its corners."""
    kept, across = 0, np.empty(count)
    for k in range(count):
        across[k] = (q[0] - p[0]) * (subject[k, 1] - p[1]) - (q[1] - p[1]) * (subject[k, 0] - p[0])
    for k in range(count):
        n = (k + 1) % count
        if across[k] >= 0.0:
            out[kept] = subject[k]
            kept += 1
        if (across[k] > 0.0 > across[n]) or (across[k] < 0.0 < across[n]):
            out[kept] = subject[k] + across[k] / (across[k] - across[n]) * (subject[n] - subject[k])
            kept += 1
    return kept


@compiled
def _set_segments(a: Array, b: Array, least: Array, out: Array, counts: Indices) -> None:
    """Set the common polygons of pairs of polygons in a plane, both counter-clockwise.

    Args:
        a: Polygons that clip, shape (p, k, 2).
        b: Polygons that are clipped, shape (p, l, 2).
        least: Smallest area of a segment, shape (p,).
        out: Corners of the segments, overwritten, shape (p, most, 2).
        counts: Their numbers, overwritten, shape (p,).
    """
    one, other = np.empty((out.shape[1], 2)), np.empty((out.shape[1], 2))
    for i in range(a.shape[0]):
        count = b.shape[1]
        one[:count] = b[i]
        for k in range(a.shape[1]):
            count = _clip(one, count, a[i, k], a[i, (k + 1) % a.shape[1]], other)
            one[:count] = other[:count]
        area = 0.0
        for k in range(1, count - 1):
            u, v = one[k] - one[0], one[k + 1] - one[0]
            area += 0.5 * (u[0] * v[1] - u[1] * v[0])
        counts[i] = count if area > least[i] else 0
        out[i, :count] = one[:count]


def _axes(normals: Array) -> Array:
    """Two unit vectors across each normal, shape (m, 2, 3), right-handed with it."""
    least = np.eye(3)[np.abs(normals).argmin(axis=1)]
    t1 = np.cross(least, normals)
    t1 /= np.linalg.norm(t1, axis=1)[:, np.newaxis]
    return np.stack([t1, np.cross(normals, t1)], axis=1)


def _segments(a: _Pieces, b: _Pieces, i: Indices, j: Indices) -> _Segments:
    """Triangles of the segments of pairs (i, j) of pieces, in the planes of the first."""
    axes, centres = _axes(a.normals)[i], a.centres[i]
    own = np.einsum("pcx,pkx->pkc", axes, a.corners[i] - centres[:, np.newaxis])
    others = np.einsum("pcx,pkx->pkc", axes, b.corners[j] - centres[:, np.newaxis])
    out, counts = np.zeros((len(i), _MOST, 2)), np.zeros(len(i), dtype=np.int64)
    least = _NOTHING * a.areas[i]
    # seen from outside of the first face, the second one runs clockwise
    turned = np.ascontiguousarray(others[:, ::-1])
    _set_segments(np.ascontiguousarray(own), turned, least, out, counts)
    fans = np.maximum(counts - 2, 0)
    pair = np.repeat(np.arange(len(i)), fans)
    corner = np.arange(len(pair)) - np.repeat(np.cumsum(fans) - fans, fans) + 1
    flat = np.stack([out[pair, 0], out[pair, corner], out[pair, corner + 1]], axis=1)
    u, v = flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]
    areas = 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    corners = centres[pair, np.newaxis] + np.einsum("tkc,tcx->tkx", flat, axes[pair])
    return _Segments(corners, areas, i[pair], j[pair])


def _points(
    first: Face, second: Face, pieces: tuple[_Pieces, _Pieces], of: _Segments, tolerance: float
) -> tuple[Array, Array, Array, tuple[Indices, Indices]]:
    """Reference coordinates of Gauss points on facets of both faces, weights, and the facets."""
    (a, b), orders = pieces, [_ORDERS[f.facets.cell, f.facets.degree] for f in (first, second)]
    at, weights = rule("triangle", _ORDERS[first.facets.cell, 1] + max(orders))
    g = len(weights)
    x = np.einsum("gk,tkx->tgx", tabulated("triangle", 1, at)[0], of.corners).reshape(-1, 3)
    axes = np.repeat(_axes(a.normals)[of.first], g, axis=0)
    i, j = np.repeat(a.of[of.first], g), np.repeat(b.of[of.second], g)
    ξ, own = _inverse(first, i, x, axes)
    η, others = _inverse(second, j, x, axes)
    gaps = np.linalg.norm(own - others, axis=1)
    _refuse_distant(first, second, gaps, own, tolerance)
    products = (2.0 * of.areas[:, np.newaxis] * weights).ravel()
    return ξ, η, products, (i, j)


def _inverse(face: Face, of: Indices, x: Array, axes: Array) -> tuple[Array, Array]:
    """Reference coordinates (p, 2) of points whose projections are ``x``, and the points."""
    facets = face.facets
    nodes = face.x[facets.nodes[of]]
    size = np.linalg.norm(nodes[:, 1] - nodes[:, 0], axis=1).max(initial=0.0)
    ξ: Array = np.full((len(x), 2), 1.0 / 3.0 if facets.cell == "triangle" else 0.5)
    for _ in range(_NEWTON):
        table = tabulated(facets.cell, facets.degree, ξ)
        found = np.einsum("pk,pkx->px", table[0], nodes)
        missing = np.einsum("pcx,px->pc", axes, x - found)
        slopes = np.einsum("pcx,dpk,pkx->pcd", axes, table[1:], nodes, optimize=True)
        change = np.linalg.solve(slopes, missing[:, :, np.newaxis])[:, :, 0]
        if np.abs(missing).max(initial=0.0) <= 1e-15 * size:
            break
        ξ = ξ + change
    return ξ, np.einsum("pk,pkx->px", tabulated(facets.cell, facets.degree, ξ)[0], nodes)


def _refuse_separate(first: Face, second: Face, found: _Segments) -> None:
    """Raise ``ValueError`` if no facets face each other."""
    if not len(found.areas):
        nodes = [face.x[np.unique(face.facets.nodes)] for face in (first, second)]
        away, _ = cKDTree(nodes[1]).query(nodes[0])
        raise ValueError(
            f"expected faces that lie on each other, but no facet of {first.label} faces one of "
            f"{second.label}: the closest nodes are {away.min():.3g} from each other"
        )


def _refuse_distant(first: Face, second: Face, gaps: Array, x: Array, tolerance: float) -> None:
    """Raise ``ValueError`` if points of the faces are not on each other."""
    worst = int(gaps.argmax())
    if gaps[worst] > tolerance:
        raise ValueError(
            f"expected faces that lie on each other, but {first.label} and {second.label} have a "
            f"distance of {gaps[worst]:.3g} at {x[worst]}; the tolerance is {tolerance:.3g}. "
            "Curved faces need facets with the same nodes on both sides"
        )


def _refuse_uncovered(
    first: Face, second: Face, pieces: tuple[_Pieces, _Pieces], of: _Segments
) -> None:
    """Raise ``ValueError`` if the second face does not cover each facet of the first once."""
    a, _ = pieces
    covered = np.bincount(of.first, of.areas, len(a.areas)) / a.areas
    worst = int(np.abs(covered - 1.0).argmax())
    if abs(covered[worst] - 1.0) > _COVERED:
        raise ValueError(
            f"expected {first.label} within {second.label}, which covers "
            f"{100.0 * covered[worst]:.4g} % of the facet at {a.centres[worst]}; the smaller face "
            "comes first"
        )


def _integrated(
    first: Face,
    second: Face,
    at: tuple[Array, Array],
    weights: Array,
    of: tuple[Indices, Indices],
) -> MortarMatrices:
    """Matrices from Gauss points at reference coordinates of facets of both faces."""
    corners = first.corners
    nodes, numbers = np.unique(corners, return_inverse=True)
    numbers = numbers.reshape(corners.shape)[of[0]]
    shapes = weights[:, np.newaxis] * tabulated(first.facets.cell, 1, at[0])[0]
    areas: Array = np.zeros(len(nodes))
    np.add.at(areas, numbers, shapes)
    shapes = shapes / areas[numbers]
    means = []
    for face, own, facet in zip((first, second), at, of, strict=True):
        values = tabulated(face.facets.cell, face.facets.degree, own)[0]
        products = shapes[:, :, np.newaxis] * values[:, np.newaxis]
        rows = np.broadcast_to(numbers[:, :, np.newaxis], products.shape)
        columns = np.broadcast_to(face.facets.nodes[facet][:, np.newaxis], products.shape)
        entries = products.ravel(), (rows.ravel(), columns.ravel())
        means.append(sp.csr_matrix(entries, shape=(len(nodes), len(face.x))))
    return MortarMatrices(nodes, means[0], means[1], areas)
