"""Attachment frames of a scene on its independent nodes: frames, Jacobians and nodal forces."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie.attachments.attachment import (
    AttachmentFrame,
    AttachmentKind,
    bend,
    changes,
    cores,
    locate,
    spread,
)
from fem_lie.bodies.body import Body, Point
from fem_lie.system.nodes.numbering import Numbering


class _Alike(NamedTuple):
    """Attachments of one type and number of nodes.

    Attributes:
        kind: Type of the attachments.
        masters: Master nodes of their nodes, shape (g, k).
        offsets: Frames of the nodes in those of the master nodes, (g, k, 4, 3).
        turns: Maps from motions of master nodes to motions of nodes, (g, k, 6, 6).
        data: Parameters of each attachment, (g, d).
        lead: Whether all of their nodes are master nodes, so that no map is needed.
    """

    kind: AttachmentKind
    masters: Indices
    offsets: Array
    turns: Array
    data: Array
    lead: bool

    def nodes(self, H: Array) -> Array:
        """Nodal coordinates of their nodes, shape (g, k, 4, 3)."""
        rows = H[self.masters]
        return rows if self.lead else lie.se3_compose(rows, self.offsets)

    @property
    def averaged(self) -> bool:
        """Whether they have mean coordinates."""
        return self.kind.means is not None

    def spread(self, H: Array) -> Array:
        """Derivatives of mean coordinates in motions of the master nodes, (g k, r, 6)."""
        if self.kind.means is None:
            return np.empty((0, 0, 6))
        S = spread(self.kind.means, self.nodes(H), self.data)
        return (S if self.lead else S @ self.turns).reshape(-1, *S.shape[2:])


class HeldAttachments:
    """Attachments of a scene, type by type; each has an *entry* for each of its nodes.

    Attributes:
        count: Number of attachments.
        of: Attachment of each entry, shape (e,).
        nodes: Master node of each entry, shape (e,).
        rows: Master nodes of pairs of entries of one attachment without mean coordinates, shape
            (p,); ``columns`` likewise.
        kinds: Type of each attachment.
        averaged: Number of each attachment among those with mean coordinates, −1 of others, shape
            (g,).
    """

    def __init__(self, points: Sequence[Point], numbering: Numbering) -> None:
        """Collect the attachments of points; equal attachments of several points are one.

        Args:
            points: Points with an attachment.
            numbering: Numbering of the nodes.
        """
        self._frames = numbering.frames
        sorts: dict[tuple[AttachmentKind, int, int], dict[tuple[Body, AttachmentFrame], None]] = {}
        for point in points:
            body, attachment = _known(point)
            sort = attachment.kind, len(attachment.nodes), len(attachment.data)
            sorts.setdefault(sort, {})[body, attachment] = None
        order = [key for keys in sorts.values() for key in keys]
        self._numbers = {key: number for number, key in enumerate(order)}
        self.count = len(order)
        self._sorts = [_alike(kind, list(keys), numbering) for (kind, _, _), keys in sorts.items()]
        self.kinds = [attachment.kind for _, attachment in order]
        sizes = np.array([len(attachment.nodes) for _, attachment in order], dtype=np.int64)
        self.of: Indices = np.repeat(np.arange(self.count), sizes)
        averaged = np.array([kind.means is not None for kind in self.kinds], dtype=bool)
        self.averaged: Indices = np.where(averaged, np.cumsum(averaged) - 1, -1)
        none = np.empty(0, dtype=np.int64)
        self.nodes: Indices = np.concatenate([none, *(s.masters.ravel() for s in self._sorts)])
        masters = [sort.masters for sort in self._sorts if not sort.averaged]
        square = [np.repeat(each[:, :, np.newaxis], each.shape[1], axis=2) for each in masters]
        self.rows: Indices = np.concatenate([none, *(each.ravel() for each in square)])
        turned = [each.transpose(0, 2, 1).ravel() for each in square]
        self.columns: Indices = np.concatenate([none, *turned])

    @property
    def coordinates(self) -> int:
        """Number of mean coordinates of each averaging attachment."""
        return max((k.means.size for k in self.kinds if k.means is not None), default=0)

    def number(self, point: Point) -> int:
        """Number of the attachment of a point."""
        return self._numbers[_known(point)]

    def locate(self, H: Array) -> tuple[Array, Array]:
        """Attachment frames (g, 4, 3), and their Jacobian for each entry, (e, 6, 6)."""
        frames: list[Array] = [np.empty((0, 4, 3))]
        moves: list[Array] = [np.empty((0, 6, 6))]
        for sort in self._sorts:
            found, J = locate(sort.kind, sort.nodes(H), sort.data)
            frames.append(found)
            moves.append((J if sort.lead else J @ sort.turns).reshape(-1, 6, 6))
        return np.concatenate(frames), np.concatenate(moves)

    def bend(self, H: Array, forces: Array) -> Array:
        """Geometric stiffness of ``forces`` (g, 6), for each of ``rows``, (p, 6, 6).

        The forces are constant in the frames of the attachments.
        """
        blocks: list[Array] = [np.empty((0, 6, 6))]
        first = 0
        for sort in self._sorts:
            own = forces[first : first + len(sort.data)]
            first += len(own)
            if sort.averaged:
                continue
            K = bend(sort.kind, sort.nodes(H), sort.data, np.ascontiguousarray(own))
            K = K.transpose(0, 1, 3, 2, 4)
            if not sort.lead:
                left = sort.turns.transpose(0, 1, 3, 2)[:, :, np.newaxis]
                K = left @ K @ sort.turns[:, np.newaxis]
            blocks.append(K.reshape(-1, 6, 6))
        return np.concatenate(blocks)

    def spread(self, H: Array) -> Array:
        """Derivatives of mean coordinates in motions of the entries, (e, r, 6)."""
        found = [sort.spread(H) for sort in self._sorts if sort.averaged]
        return np.concatenate(found) if found else np.empty((0, 0, 6))

    def cores(self, H: Array, forces: Array) -> tuple[Array, Array]:
        """``L`` (w, 6, r), ``C`` (w, r, r) of averaging attachments, for forces (g, 6) on all."""
        of_means, of_forces, first = [], [], 0
        for sort in self._sorts:
            own = forces[first : first + len(sort.data)]
            first += len(own)
            if sort.kind.means is not None:
                X = sort.nodes(H)
                L, C = cores(sort.kind.means, X, sort.data, np.ascontiguousarray(own))
                of_means.append(L)
                of_forces.append(C)
        return np.concatenate(of_means), np.concatenate(of_forces)

    def changes(self, H: Array, v: Array) -> Array:
        """Rates of the attachments' twists at constant twists ``v`` of the nodes, shape (g, 6)."""
        found: list[Array] = [np.empty((0, 6))]
        for sort in self._sorts:
            h = np.einsum("gkij,gkj->gki", sort.turns, v[sort.masters])
            found.append(changes(sort.kind, sort.nodes(H), sort.data, h))
        return np.concatenate(found)

    def nearest(self, attachment: int, position: Array) -> tuple[int, Array]:
        """Node of an attachment nearest to a point at the start, and the point in its frame."""
        masters = self.nodes[self.of == attachment]
        away = position - self._frames[masters, 0]
        k = int(np.linalg.norm(away, axis=1).argmin())
        return int(masters[k]), np.asarray(self._frames[masters[k], 1:] @ away[k])


def _known(point: Point) -> tuple[Body, AttachmentFrame]:
    attachment = point.joint_attachment
    assert point.body is not None and attachment is not None
    return point.body, attachment


def _alike(
    kind: AttachmentKind, keys: Sequence[tuple[Body, AttachmentFrame]], numbering: Numbering
) -> _Alike:
    master_map = numbering.master_map
    nodes = np.array([numbering.nodes[body][list(attachment.nodes)] for body, attachment in keys])
    data = np.array([attachment.data for _, attachment in keys], dtype=np.float64)
    offsets = master_map.offset[nodes]
    turns = lie.se3_adjoint(lie.se3_inverse(offsets))
    lead = bool(np.isin(nodes, master_map.masters).all())
    return _Alike(kind, master_map.master[nodes], offsets, turns, data, lead)
