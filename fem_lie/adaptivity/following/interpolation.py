"""Interpolation of coordinate vectors within the elements of bodies, as sums of nodal vectors.

Each body whose nodes are not frames has one function, which finds the closest points of its cells
and their positions and gradients, with derivatives in the parameters of the new mesh.
"""

from __future__ import annotations

from functools import singledispatch
from inspect import unwrap
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.adaptivity.following.closest_cells import Cells, Closest, LagrangeCells
from fem_lie.bodies.gradients.ancf_beam import AncfBeamModel
from fem_lie.bodies.gradients.ancf_shell import AncfShellModel
from fem_lie.bodies.membranes.membrane import MembraneModel
from fem_lie.bodies.model import BodyModel
from fem_lie.bodies.rods.cable_body import CableModel
from fem_lie.bodies.solids.model import SolidModel
from fem_lie.bodies.thin_shells.smooth_surface import SmoothSurfaceModel
from fem_lie.elements.gradients import plate
from fem_lie.elements.rods.cable import signs
from fem_lie.elements.thin_shells.nodal_coordinates import VECTORS, node_of, row_of
from fem_lie.lie.node_types import NodeType
from fem_lie.mesh.bicubic import hermite

ROWS = 4
"""Coordinate vectors of a node, of which some may have no meaning."""

_AROUND = 6  # cells whose nodes correct positions on membranes and discrete cables
# without the compiler, which takes longer than 16 calls
_NODE, _ROW = (np.array([unwrap(of)(a) for a in range(VECTORS)]) for of in (node_of, row_of))


class Sums(NamedTuple):
    """Vectors of new points as sums of old ones, as the elements interpolate them.

    Attributes:
        vectors: Number of each new vector, four for a node, shape (n, r).
        columns: Numbers of the k old vectors for each point, shape (n, k).
        values: Coefficients, shape (n, r, k).
        positions: Which of the k old vectors are positions, shape (k,).
        at: Which of the r new vectors are positions, shape (r,).
        away: Distance of each point from the closest one over the size of a cell, shape (n,).
    """

    vectors: Indices
    columns: Indices
    values: Array
    positions: Flags
    at: Flags
    away: Array


@singledispatch
def sums_on(old: BodyModel, new: BodyModel) -> Sums:
    """Vectors of new points as sums of those of the old nodes, as the elements interpolate them.

    Raises:
        ValueError: States of such bodies are not transferred.
    """
    raise ValueError(
        "expected a beam, rod, shell, cable, net, thin shell, ANCF body, membrane or solid to "
        f"change the mesh, {new.label} is a {new.class_name} with nodes of other types"
    )


@sums_on.register
def _on_cables(old: CableModel, new: CableModel) -> Sums:
    x, ends = new.frames[:, 0], old.frames[old.elements[:, :2]]
    if old.node_type is NodeType.POSITION:
        return _on_threads(old, x)
    lengths = signs(ends) * old.lengths
    vectors = ends[:, :, :2].reshape(len(ends), 4, 3)
    closest = _cubic(vectors, lengths).closest(x)
    value, slope = _hermite(closest.at[:, 0], lengths[closest.cells])
    columns = _vectors(old.elements[closest.cells, :2], (0, 1)).reshape(len(x), 4)
    tangents = np.einsum("nk,nkj->nj", slope, vectors[closest.cells])
    # gradients per parameter of the new mesh, which may run the other way
    rate = np.einsum("nj,nj->n", new.frames[:, 1], tangents) / (tangents**2).sum(axis=1)
    values = np.stack([value, rate[:, np.newaxis] * slope], axis=1)
    return Sums(
        _vectors(np.arange(len(x)), (0, 1)),
        columns,
        values,
        np.array([True, False, True, False]),
        np.array([True, False]),
        closest.away,
    )


def _on_threads(old: CableModel, x: Array) -> Sums:
    """Positions on cubics through the nodes of discrete cables, with tangents of three nodes.

    Between two edges the tangent is that of the parabola through their ends; the cubic of an edge
    at an end of a thread has no curvature there, where the moment is zero. On straight edges a new
    node would leave the bending of both to the old nodes.
    """
    edges = old.elements[:, :2]
    closest = LagrangeCells("interval", 1, edges, old.frames[:, 0]).cells.closest(x)
    columns, slopes = _around(old)
    cells, s = closest.cells, closest.at[:, :1]
    value, _ = _hermite(s[:, 0], np.ones(len(s)))
    values = np.zeros((len(x), 4))
    values[:, 1], values[:, 2] = value[:, 0], value[:, 2]
    values += value[:, 1:2] * slopes[cells, 0] + value[:, 3:] * slopes[cells, 1]
    return _positions(x, closest, columns[cells], values, edges[closest.near[:, :_AROUND]])


def _around(old: CableModel) -> tuple[Indices, Array]:
    """Nodes before, at both ends of and after each edge, (m, 4), and its slopes in them, (m, 2, 4).

    Slopes at both ends are derivatives over the edge; a missing node is replaced by the end.
    """
    edges, h = old.elements[:, :2], old.lengths
    nodes, ratio = edges[:, [0, 0, 1, 1]].copy(), np.full((len(edges), 2), np.inf)
    for k, other in ((0, 1), (1, 0)):
        own, next_ = old.successive.edges[:, k], old.successive.edges[:, other]
        side = (edges[own, 1] == old.successive.nodes[:, 1]).astype(np.int64)
        nodes[own, 3 * side] = old.successive.nodes[:, 2 * other]
        ratio[own, side] = h[next_] / h[own]
    chord = np.array([0.0, -1.0, 1.0, 0.0])
    beyond = np.array([[-1.0, 1.0, 0.0, 0.0], [0.0, 0.0, -1.0, 1.0]])
    r, alone = ratio[..., np.newaxis], np.isinf(ratio)
    with np.errstate(invalid="ignore"):
        slopes = (r * chord + beyond / r) / (1.0 + r)
    slopes[alone] = chord
    for k in (0, 1):
        ends = alone[:, k] & ~alone[:, 1 - k]
        slopes[ends, k] = 1.5 * chord - 0.5 * slopes[ends, 1 - k]
    return nodes, slopes


@sums_on.register
def _on_ancf_beams(old: AncfBeamModel, new: AncfBeamModel) -> Sums:
    points, ends = new.points_count, old.frames[old.elements[:, :2]]
    vectors = ends[:, :, :2].reshape(len(ends), 4, 3)
    closest = _cubic(vectors, old.lengths).closest(new.frames[:points, 0])
    s, own = closest.at[:, 0], old.elements[closest.cells]
    value, slope = _hermite(s, old.lengths[closest.cells])
    # (x, r_x) of both ends, then (r_y, r_z) of both
    first, second = _vectors(own[:, :2], (0, 1)), _vectors(own[:, 2:], (1, 2))
    columns = np.concatenate([first, second], axis=1).reshape(points, 8)
    values = np.zeros((points, 4, 8))
    values[:, 0, :4], values[:, 1, :4] = value, slope
    for k in range(2):
        values[:, 2 + k, 4 + k], values[:, 2 + k, 6 + k] = 1 - s, s
    number = np.arange(points)
    return Sums(
        np.concatenate([_vectors(number, (0, 1)), _vectors(points + number, (1, 2))], axis=1),
        columns,
        values,
        np.array([True, False, True, False] + 4 * [False]),
        np.array([True, False, False, False]),
        closest.away,
    )


@sums_on.register
def _on_smooth_surfaces(old: SmoothSurfaceModel, new: SmoothSurfaceModel) -> Sums:
    points, vectors, table = new.points_count, old.hermite_vectors(), type(old).table

    def evaluate(cells: Indices, ξ: Array) -> tuple[Array, Array]:
        found = np.einsum("pka,paj->pkj", table(ξ)[:, :3], vectors[cells])
        return found[:, 0], found[:, 1:]

    frames = new.frames
    closest = Cells("quadrilateral", vectors[:, ::4], evaluate).closest(
        frames[:points, 0], np.asarray(np.cross(frames[:points, 1], frames[points:, 2]))
    )
    cells, shapes = closest.cells, table(closest.at)
    X = np.einsum("pka,paj->pkj", shapes, vectors[cells])
    given = np.stack([frames[:points, 1], frames[points:, 2]], axis=1)
    J = np.einsum("paj,pjb->pab", given, np.linalg.pinv(X[:, 1:3]))
    gradients = np.einsum("pab,pbk->pak", J, shapes[:, 1:3])
    values = np.concatenate(
        [shapes[:, :1], gradients, _fourth(new, closest.at, shapes, J)[:, np.newaxis]], axis=1
    )
    values = values @ old.hermite_matrices()[cells]
    number = np.arange(points)
    return Sums(
        np.concatenate([_vectors(number, (0, 1)), _vectors(points + number, (2, 1))], axis=1),
        ROWS * old.connectivity[cells][:, _NODE] + _ROW,
        values,
        np.arange(VECTORS) % 4 == 0,
        np.array([True, False, False, False]),
        closest.away,
    )


def _fourth(new: SmoothSurfaceModel, ξ: Array, shapes: Array, J: Array) -> Array:
    """Coefficients (p, 16) of Hermite vectors in the fourth vector of new points.

    The mixed derivative in new parameters is ``x_ij J_1i J_2j``, times the area by which nodes are
    scaled; the director of a thick shell is interpolated.
    """
    if isinstance(new, AncfShellModel):
        return np.asarray(plate.directors(ξ)[:, 0])
    area = float(np.prod(new.sizes[0, :2]) / new.sizes[0, 2])
    a, b = J.swapaxes(0, 1)[..., np.newaxis]
    second = shapes[:, [hermite.BENT_ALONG, hermite.BENT_ACROSS, hermite.TWISTED]].swapaxes(0, 1)
    along, across, mixed = second
    return np.asarray(
        area
        * (
            a[:, 0] * b[:, 0] * along
            + a[:, 1] * b[:, 1] * across
            + (a[:, 0] * b[:, 1] + a[:, 1] * b[:, 0]) * mixed
        )
    )


@sums_on.register
def _on_solids(old: SolidModel, new: SolidModel) -> Sums:
    cells = LagrangeCells(old.mesh.cell, old.degree, old.connectivity, old.positions)
    return _on_lagrange(cells, new.positions)


@sums_on.register
def _on_membranes(old: MembraneModel, new: MembraneModel) -> Sums:
    mesh = old.mesh
    cells = LagrangeCells(mesh.cell, mesh.degree, old.connectivity, old.frames[:, 0])
    return _on_lagrange(cells, new.frames[:, 0], _AROUND)


def _on_lagrange(given: LagrangeCells, x: Array, around: int = 0) -> Sums:
    """Positions of new nodes, with nodes of further cells around to correct them."""
    closest = given.cells.closest(x)
    others = given.connectivity[closest.near[:, :around]]
    own = given.connectivity[closest.cells]
    return _positions(x, closest, own, given.shapes(closest.at)[0], others)


def _positions(x: Array, closest: Closest, own: Indices, values: Array, others: Indices) -> Sums:
    """Positions of new nodes from those of k nodes, (n, k), and of others that correct them."""
    further = others.reshape(len(x), -1)
    return Sums(
        _vectors(np.arange(len(x)), (0,)),
        ROWS * np.concatenate([own, further], axis=1),
        np.pad(values, ((0, 0), (0, further.shape[1])))[:, np.newaxis],
        np.ones(own.shape[1] + further.shape[1], dtype=bool),
        np.array([True]),
        closest.away,
    )


def _vectors(nodes: Indices, rows: tuple[int, ...]) -> Indices:
    """Numbers of rows of the coordinates of nodes, shape (…, r)."""
    return np.asarray(ROWS * nodes[..., np.newaxis] + np.array(rows))


def _cubic(vectors: Array, lengths: Array) -> Cells:
    """Cells of cubics through positions and gradients of both ends, vectors (m, 4, 3)."""

    def evaluate(cells: Indices, ξ: Array) -> tuple[Array, Array]:
        value, slope = _hermite(ξ[:, 0], lengths[cells])
        own = vectors[cells]
        along = np.einsum("pk,pkj->pj", slope, own) * lengths[cells, np.newaxis]
        return np.einsum("pk,pkj->pj", value, own), along[:, np.newaxis]

    return Cells("interval", vectors[:, ::2], evaluate)


def _hermite(s: Array, length: Array) -> tuple[Array, Array]:
    """Cubics of position and gradient of both ends at fractions (p,), and derivatives, (p, 4)."""
    r = 1 - s
    value = r**2 * (1 + 2 * s), length * s * r**2, s**2 * (3 - 2 * s), -length * s**2 * r
    slope = -6 * s * r / length, r * (1 - 3 * s), 6 * s * r / length, s * (3 * s - 2)
    return np.stack(value, axis=1), np.stack(slope, axis=1)
