"""Points of one mesh of a body that correspond to the nodes of another mesh of the same body.

Both meshes are compared in the undeformed configuration. A node corresponds to the closest point of
an element of the other mesh, with a constant offset from there: ``H = H_point C`` with a constant
``C``. So rigid motions are transferred exactly, and also fields that are constant in elements, such
as the strain of geodesic beams. Cells of shells are bent as their directors are, see
:class:`Bulges`.
"""

from __future__ import annotations

from typing import NamedTuple

import basix
import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Indices
from fem_lie.adaptivity.following.closest_cells import LagrangeCells
from fem_lie.adaptivity.following.vector_maps import VectorMap, vector_map
from fem_lie.attachments.attachment import AttachmentFrame, AttachmentKind, locate
from fem_lie.attachments.between_frames import interpolated
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.body import Body
from fem_lie.bodies.shells.mixed import MixedShellModel
from fem_lie.bodies.shells.model import ShellModel
from fem_lie.bodies.shells.shell import Shell
from fem_lie.lie.node_types import NodeType
from fem_lie.mesh.surfaces import SurfaceMesh

_NEAR = 4  # candidate elements
_AT_NODE = 1e-9  # distance from a node relative to an element
_OFF = 0.2  # largest distance relative to an element for meshes of the same body
_ROUNDS = 20  # iterations of Newton's method along an element
_SAME = 9  # digits to which distances are compared
_BLOCK = 256  # nodes per block when distances from all elements are computed


class Bulges(NamedTuple):
    """Distances of points from the flat cells in which they are, along their directors.

    Between nodes a and b directors are interpolated, and the surface is bent with them, so that the
    transverse shear strain of an edge is the same along all of it: at a fraction s of the edge the
    distance is ``½ s (1 − s) (x_b − x_a)·(d_b − d_a)``. On straight edges the parts of a bent cell
    would be sheared, which in thin shells is far stiffer than bending.

    Attributes:
        points: Point of each pair of a point and an edge of its cell, shape (p,).
        ends: Nodes a and b of the edge, shape (p, 2).
        weights: ``½ s (1 − s)`` of the edge, fading towards the other edges, shape (p,).
    """

    points: Indices
    ends: Indices
    weights: Array

    @classmethod
    def none(cls) -> Bulges:
        """No point inside a flat cell."""
        return cls(np.empty(0, dtype=np.int64), np.empty((0, 2), dtype=np.int64), np.empty(0))

    def heights(self, count: int, frames: Array, velocities: Array) -> tuple[Array, Array]:
        """Distances of all points and their rates, shape (n,), for nodal frames and twists."""
        u, ω = np.split(velocities, 2, axis=1)
        moved = np.einsum("nij,ni->nj", frames[:, 1:], u)
        turned = np.einsum("nij,ni->nj", frames[:, 1:], np.cross(ω, [0.0, 0.0, 1.0]))
        a, b = self.ends.T
        Δx, Δd, u, d = (of[b] - of[a] for of in (frames[:, 0], frames[:, 3], moved, turned))
        edges = (Δx * Δd).sum(axis=1), (u * Δd).sum(axis=1) + (Δx * d).sum(axis=1)
        height, rate = (
            np.asarray(np.bincount(self.points, self.weights * e, count), dtype=np.float64)
            for e in edges
        )
        return height, rate


class MeshPoints(NamedTuple):
    """Points on a mesh, one for each node of another mesh.

    Attributes:
        nodes: Node at which a point is, −1 if it is inside an element, shape (n,).
        attachments: Attachment frames of points inside elements, in order.
        bulges: Distances of points from flat cells.
        offset: Frame of the node relative to the point, shape (n, 4, 3).
    """

    nodes: Indices
    attachments: list[AttachmentFrame]
    bulges: Bulges
    offset: Array

    @property
    def between(self) -> Flags:
        """Whether each point is inside an element."""
        return self.nodes < 0

    def motion(self, frames: Array, velocities: Array) -> tuple[Array, Array]:
        """Frames (n, 4, 3) and twists (n, 6) of the nodes of the other mesh."""
        own, H, v = self.nodes, np.empty_like(self.offset), np.empty((len(self.nodes), 6))
        at = ~self.between
        H[at], v[at] = frames[own[at]], velocities[own[at]]
        between = np.flatnonzero(self.between)
        sorts: dict[tuple[AttachmentKind, int], list[int]] = {}
        for k, attachment in enumerate(self.attachments):
            sorts.setdefault((attachment.kind, len(attachment.nodes)), []).append(k)
        for (kind, _), members in sorts.items():
            nodes = np.array([self.attachments[k].nodes for k in members])
            data = np.array([self.attachments[k].data for k in members], dtype=np.float64)
            found, J = locate(kind, np.ascontiguousarray(frames[nodes]), data)
            H[between[members]] = found
            v[between[members]] = np.einsum("gkij,gkj->gi", J, velocities[nodes])
        height, rate = self.bulges.heights(len(H), frames, velocities)
        H[:, 0] += height[:, np.newaxis] * H[:, 3]
        v[:, :3] += np.stack([height * v[:, 4], -height * v[:, 3], rate], axis=1)
        back = lie.se3_adjoint(lie.se3_inverse(self.offset))
        return lie.se3_compose(H, self.offset), np.einsum("nij,nj->ni", back, v)


def mesh_points(old: Body, new: Body) -> MeshPoints | VectorMap:
    """Points of the mesh of one body that correspond to the nodes of another.

    Raises:
        ValueError: The bodies are not two meshes of the same body.
    """
    if type(old) is not type(new):
        raise ValueError(
            f"{new.label} was a {type(old).__name__}, now it is a {type(new).__name__}"
        )
    if _same(old, new):
        return _with_offsets(np.arange(len(new.frames)), [], Bulges.none(), old, new)
    if (old.model.node_types != NodeType.FRAME).any():
        found = vector_map(old.model, new.model)
        _check_near(old, new.frames, found.away)
        return found
    if isinstance(old, Beam):
        return _with_offsets(*_on_lines(old, new.frames), Bulges.none(), old, new)
    if isinstance(old, Shell):
        return _with_offsets(*_on_surface(old, new.frames), old, new)
    raise ValueError(
        f"expected a body on a line, a surface or in a volume to change the mesh, {new.label} is a "
        f"{type(new).__name__}"
    )


def _with_offsets(
    nodes: Indices, attachments: list[AttachmentFrame], bulges: Bulges, old: Body, new: Body
) -> MeshPoints:
    """Points with the offsets of the new nodes in the undeformed configuration."""
    found = MeshPoints(nodes, attachments, bulges, np.tile(np.eye(4, 3, -1), (len(nodes), 1, 1)))
    at, _ = found.motion(old.frames, np.zeros((len(old.frames), 6)))
    return found._replace(offset=lie.se3_compose(lie.se3_inverse(at), new.frames))


def _same(old: Body, new: Body) -> bool:
    """Whether the nodes are the same, in the same order."""
    if old.frames.shape != new.frames.shape:
        return False
    return bool(np.abs(old.frames - new.frames).max() <= _AT_NODE * old.model.size)


def _on_lines(old: Beam, frames: Array) -> tuple[Indices, list[AttachmentFrame]]:
    """Closest points of each node, on the geodesics between the ends of all elements."""
    ends = old.frames[old.model.elements[:, :2]]
    d = lie.se3_relative(ends[:, 0], ends[:, 1])
    near = _near_chords(ends[:, :, 0], frames[:, 0])
    part = np.full(near.shape, 0.5)
    x = frames[:, np.newaxis, 0]
    for _ in range(_ROUNDS):
        here = lie.se3_retract(ends[near, 0], part[..., np.newaxis] * d[near])
        along = np.einsum("nkji,nkj->nki", here[..., 1:, :], d[near, :3])
        step = np.einsum("nki,nki->nk", x - here[..., 0, :], along)
        moved = np.clip(part + step / np.einsum("nki,nki->nk", along, along), 0.0, 1.0)
        done = np.abs(moved - part).max() < 1e-14
        part = moved
        if done:
            break
    here = lie.se3_retract(ends[near, 0], part[..., np.newaxis] * d[near])
    away = np.linalg.norm(here[..., 0, :] - x, axis=2) / old.model.lengths[near]
    turned = np.linalg.norm(lie.se3_relative(here, frames[:, np.newaxis])[..., 3:], axis=2)
    # lines that cross without a joint differ only in direction
    best = np.lexsort((turned, np.round(away, 9)), axis=1)[:, 0]
    rows = np.arange(len(frames))
    _check_near(old, frames, away[rows, best])
    nodes, attachments = np.full(len(frames), -1), []
    for i, (element, at) in enumerate(zip(near[rows, best], part[rows, best], strict=True)):
        point = old.point_in_cell(int(element), float(at))
        if point.attachment is None:
            nodes[i] = point.node
        else:
            attachments.append(point.attachment)
    return nodes, attachments


def _near_chords(ends: Array, x: Array) -> Indices:
    """The elements with the closest chords (m, 2, 3) to points (n, 3), shape (n, ≤ 4)."""
    start, along = ends[:, 0], ends[:, 1] - ends[:, 0]
    squares, count = (along**2).sum(axis=1), min(_NEAR, len(ends))
    found = []
    for first in range(0, len(x), _BLOCK):
        off = x[first : first + _BLOCK, np.newaxis] - start
        part = np.clip(np.einsum("nmi,mi->nm", off, along) / squares, 0.0, 1.0)
        away = np.linalg.norm(off - part[..., np.newaxis] * along, axis=2)
        found.append(np.argpartition(away, count - 1, axis=1)[:, :count])
    return np.asarray(np.concatenate(found), dtype=np.int64)


def _on_surface(old: Shell, frames: Array) -> tuple[Indices, list[AttachmentFrame], Bulges]:
    """Closest points of each node, on cells that interpolate positions and directors."""
    found = [_on_cells(part, frames) for part in _parts(old.model)]
    best = np.argmin([np.round(away, _SAME) for away, *_ in found], axis=0)
    away, connectivity, shares, bulges = zip(*found, strict=True)
    _check_near(old, frames, np.choose(best, away))
    nodes, attachments = np.full(len(frames), -1), []
    for i, part in enumerate(best):
        cell, share = connectivity[part][i], shares[part][i]
        if share.max() > 1.0 - _AT_NODE:
            nodes[i] = cell[share.argmax()]
        else:
            attachments.append(interpolated([int(node) for node in cell], share))
    chosen = [best[each.points] == part for part, each in enumerate(bulges)]
    fields = (
        np.concatenate([field[keep] for field, keep in zip(column, chosen, strict=True)])
        for column in zip(*bulges, strict=True)
    )
    return nodes, attachments, Bulges(*fields)


def _parts(model: ShellModel | MixedShellModel) -> list[tuple[ShellModel, Indices]]:
    """Models of cells of one type, and the numbers of their nodes."""
    if isinstance(model, MixedShellModel):
        return [(part.model, part.nodes) for part in model.parts]
    return [(model, np.arange(len(model.frames)))]


def _on_cells(
    part: tuple[ShellModel, Indices], frames: Array
) -> tuple[Array, Indices, Array, Bulges]:
    """Distances (n,) of nodes from the closest cells, nodes of these (n, k), shape functions."""
    model, numbers = part
    mesh, x = model.mesh, model.frames[:, 0]
    cells = LagrangeCells(mesh.cell, mesh.degree, model.connectivity, x)
    closest = cells.cells.closest(frames[:, 0], frames[:, 3])
    shares = cells.shapes(closest.at)[0]
    shares[np.abs(shares) < _AT_NODE] = 0.0
    shares /= shares.sum(axis=1, keepdims=True)
    nodes = numbers[model.connectivity[closest.cells]]
    return closest.away, nodes, shares, _bulges(mesh, nodes, shares)


def _bulges(mesh: SurfaceMesh, nodes: Indices, shares: Array) -> Bulges:
    """Bulges of points in cells with nodes (n, k), with shape functions (n, k) there."""
    if mesh.degree > 1:  # these are bent
        return Bulges.none()
    sides = np.array(basix.topology(basix.CellType[mesh.cell])[1])
    N = shares[:, sides]
    product = N.prod(axis=2)
    # the bubble of an edge, which vanishes on all others
    across = N.sum(axis=2) if mesh.cell == "quadrilateral" else np.ones_like(product)
    weights = 0.5 * np.divide(product, across, out=np.zeros_like(product), where=product > 0.0)
    points, edge = weights.nonzero()
    return Bulges(points, nodes[points[:, np.newaxis], sides[edge]], weights[points, edge])


def _check_near(old: Body, frames: Array, away: Array) -> None:
    if away.max() > _OFF:
        node = int(away.argmax())
        raise ValueError(
            f"{old.label} has no element at {frames[node, 0]}, the position of node {node} of the "
            "other mesh: expected meshes of the same line or surface"
        )
