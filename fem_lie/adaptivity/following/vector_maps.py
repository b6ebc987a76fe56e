r"""Nodes with coordinate vectors on another mesh: each vector is a sum of vectors of the old nodes.

Positions and position gradients of a new node are those that the old elements interpolate at the
closest point, ``q_new = C q`` (:mod:`.interpolation`). On curved bodies the undeformed new nodes
are not quite there. ``C`` is therefore corrected by the smallest coefficients with which it
reproduces the undeformed new mesh::

    C Q = Q_new,    Σ C (of positions) = 1 for positions, 0 for gradients

So translations, rotations and homogeneous deformations of the whole body are transferred exactly,
of membranes whose new nodes leave the surface as far as the cells around do not lie in one plane.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.sparse as sp

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.adaptivity.following.interpolation import ROWS, Sums, sums_on
from fem_lie.bodies.model import BodyModel
from fem_lie.lie.node_types import (
    MIXED_DERIVATIVE,
    TRAITS,
    NodeType,
    pull_all_back,
    push_all_forward,
    retract_all,
)

_FLAT = 1e-6  # extent of a cell, over its size, in which corrections would be large
_ZERO = 1e-15
_AT_NODE = 1e-9  # of the body


class VectorMap(NamedTuple):
    """Motion of nodes with coordinate vectors from that of the nodes of another mesh.

    Attributes:
        nodes: Old node at which each new one is, −1 if it is between nodes, shape (n,).
        coefficients: Coefficients of old in new vectors, shape (4 n, 4 o).
        old: Old nodes, undeformed.
        new: New nodes, undeformed.
        away: Distance of new nodes from the old mesh over the size of its cells, shape (n,).
    """

    nodes: Indices
    coefficients: sp.csr_matrix
    old: BodyModel
    new: BodyModel
    away: Array

    @property
    def between(self) -> Flags:
        """Whether each point is inside an element."""
        return self.nodes < 0

    def motion(self, frames: Array, velocities: Array) -> tuple[Array, Array]:
        """Coordinates (n, 4, 3) and velocities (n, 6) of the new nodes.

        Args:
            frames: Coordinates of the old nodes, shape (o, 4, 3).
            velocities: Their velocities along their axes, shape (o, 6).
        """
        kinds, rates = self.new.node_types, np.zeros_like(frames)
        push_all_forward(self.old.node_types, frames, velocities, rates)
        H, n = self.new.frames.copy(), len(self.new.frames)
        there = _has_vector(kinds)[..., np.newaxis]
        moved = np.where(there, self._new(frames) - H, 0.0)
        d: Array = np.zeros(6 * n)
        v: Array = np.zeros(6 * n)
        pull_all_back(kinds, H, moved, 1.0, d)
        retract_all(kinds, H, d.reshape(n, 6), H)
        update = self.new.axes_update()
        if update is not None:
            update(H)
        pull_all_back(kinds, H, np.where(there, self._new(rates), 0.0), 1.0, v)
        return H, v.reshape(n, 6)

    def _new(self, vectors: Array) -> Array:
        return np.asarray(self.coefficients @ vectors.reshape(-1, 3)).reshape(-1, ROWS, 3)


def _has_vector(kinds: Indices) -> Flags:
    """Which rows of the nodes are coordinate vectors, shape (n, 4)."""
    found = np.zeros((len(kinds), ROWS), dtype=bool)
    for kind in np.unique(kinds):
        found[np.ix_(kinds == kind, list(TRAITS[NodeType(kind)].rows))] = True
    return found


def _reproducing(sums: Sums, old: BodyModel, new: BodyModel) -> Array:
    """Coefficients with which undeformed old vectors give the undeformed new ones, (n, r, k)."""
    Q: Array = old.frames.reshape(-1, 3)[sums.columns]
    T: Array = new.frames.reshape(-1, 3)[sums.vectors]
    middle = Q[:, sums.positions].mean(axis=1, keepdims=True)
    Q = Q - sums.positions[:, np.newaxis] * middle
    T = T - sums.at[:, np.newaxis] * middle
    size = np.linalg.norm(Q[:, sums.positions], axis=2).max(axis=1)[:, np.newaxis]
    # gradients over the size of a cell are lengths, too
    units = np.where(_are_lengths(old)[sums.columns], 1.0, size)
    conditions = np.empty((len(Q), 4, Q.shape[1]))
    conditions[:, :3] = ((units / size)[..., np.newaxis] * Q).swapaxes(1, 2)
    conditions[:, 3] = sums.positions
    left = np.empty((len(Q), 4, len(sums.at)))
    left[:, :3] = ((T - sums.values @ Q) / size[..., np.newaxis]).swapaxes(1, 2)
    left[:, 3] = sums.at - sums.values[:, :, sums.positions].sum(axis=2)
    change = units[..., np.newaxis] * (np.linalg.pinv(conditions, rcond=_FLAT) @ left)
    return np.asarray(sums.values + change.swapaxes(1, 2))


def _are_lengths(model: BodyModel) -> Flags:
    """Which coordinate vectors are lengths, four for each node, shape (4 n,)."""
    found = np.zeros((len(model.frames), ROWS), dtype=bool)
    first = np.where(model.node_types >= MIXED_DERIVATIVE, 1, 0)
    nodes = np.arange(len(found))
    for k in range(2):
        found[nodes, first + k] = model.node_lengths[:, k]
    return found.ravel()


def vector_map(old: BodyModel, new: BodyModel) -> VectorMap:
    """Motion of the nodes of one body from that of another mesh of the same body.

    Raises:
        ValueError: States of such bodies are not transferred.
    """
    sums = sums_on(old, new)
    values = _reproducing(sums, old, new)
    values[np.abs(values) <= _ZERO * np.abs(values).max(axis=2, keepdims=True)] = 0.0
    rows = np.broadcast_to(sums.vectors[..., np.newaxis], values.shape)
    columns = np.broadcast_to(sums.columns[:, np.newaxis], values.shape)
    shape = ROWS * len(new.frames), ROWS * len(old.frames)
    C = sp.csr_matrix((values.ravel(), (rows.ravel(), columns.ravel())), shape=shape)
    points = len(sums.vectors)
    nodes = np.full(len(new.frames), -1)
    first = new.frames[:points, 0]
    gap = np.linalg.norm(first[:, np.newaxis] - old.frames[sums.columns // ROWS, 0], axis=2)
    gap[:, ~sums.positions] = np.inf
    best = gap.argmin(axis=1)
    at = gap.min(axis=1) <= _AT_NODE * new.size
    nodes[:points][at] = sums.columns[np.arange(points), best][at] // ROWS
    for second in range(points, len(nodes), points):
        own = nodes[:points]
        nodes[second : second + points] = np.where(own < 0, -1, own + len(old.frames) // 2)
    return VectorMap(nodes, C, old, new, sums.away)
