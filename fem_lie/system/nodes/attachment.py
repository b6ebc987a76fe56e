"""Nodes that follow others rigidly: kinks, branches and rigid links without any constraint.

Each node of the bodies has the frame ``H = H_leader C`` with a constant ``C``; its twist is
``Ad(C⁻¹)`` times that of its leader, a force on it ``Ad⁻ᵀ(C)`` times as much on the leader, and its
``q = (x, d₁, d₂, d₃)`` a constant linear function of the leader's. Nothing is linearised.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled


@compiled
def expand(H: Array, leader: Indices, C: Array, out: Array) -> None:
    """Frames ``out`` of all nodes from those of their leaders."""
    for i in range(leader.shape[0]):
        lie.compose(H[leader[i]], C[i], out[i])


@compiled
def expand_twists(v: Array, leader: Indices, C: Array, out: Array) -> None:
    """Likewise twists."""
    for i in range(leader.shape[0]):
        lie.apply_adjoint_inverse(C[i], v[leader[i]], out[i])


@compiled
def expand_motion(
    H: Array, v: Array, leader: Indices, C: Array, frames: Array, twists: Array
) -> None:
    """Both, but no twists into an array without rows."""
    expand(H, leader, C, frames)
    if twists.shape[0] > 0:
        expand_twists(v, leader, C, twists)


@compiled
def collect(f: Array, leader: Indices, C: Array, out: Array) -> None:
    """Add forces on all nodes, in their frames, to those on their leaders, ``out``."""
    moved = np.empty(6)
    for i in range(leader.shape[0]):
        lie.apply_adjoint_inverse_transposed(C[i], f[i], moved)
        for k in range(6):
            out[leader[i], k] += moved[k]


class Attachment:
    """Which node follows which.

    Attributes:
        trivial: Whether every node leads itself.
        count: Number of leaders.
        leader: Number of each node's leader among the leaders, shape (N,).
        offset: Frame ``C`` of each node in its leader's frame, shape (N, 4, 3).
        leaders: Nodes that lead, shape (count,).
    """

    def __init__(self, frames: Array, pairs: Iterable[tuple[int, int]]) -> None:
        """Find the leaders.

        Args:
            frames: Initial frames of all nodes, shape (N, 4, 3).
            pairs: Nodes that are tied to each other; the second follows what the first follows.
        """
        root = np.arange(len(frames))

        def find(node: int) -> int:
            while root[node] != node:
                root[node] = root[root[node]]
                node = int(root[node])
            return node

        tied = list(pairs)
        for a, b in tied:
            root[find(b)] = find(a)
        roots: Indices = np.arange(len(frames), dtype=np.int64)
        some = sorted({node for pair in tied for node in pair})
        roots[some] = [find(node) for node in some]
        self.leaders: Indices = np.flatnonzero(roots == np.arange(len(frames)))
        self.leader: Indices = np.searchsorted(self.leaders, roots)
        self.count = len(self.leaders)
        self.trivial = self.count == len(frames)
        self.offset = np.tile(lie.frame(np.zeros(3), np.eye(3)), (len(frames), 1, 1))
        follows = roots != np.arange(len(frames))
        inverse = lie.se3_inverse(frames[roots[follows]])
        self.offset[follows] = lie.se3_compose(inverse, frames[follows])

    def frames(self, H: Array) -> Array:
        """Frames of all nodes from those of the leaders (first rows of ``H``), shape (N, 4, 3)."""
        if self.trivial:
            return H[: self.count]
        out = np.empty((len(self.leader), 4, 3))
        expand(H, self.leader, self.offset, out)
        return out

    def twists(self, v: Array) -> Array:
        """Twists of all nodes from those of the leaders, shape (N, 6)."""
        if self.trivial:
            return v[: self.count]
        out = np.empty((len(self.leader), 6))
        expand_twists(v, self.leader, self.offset, out)
        return out

    def collect(self, forces: Array, out: Array) -> None:
        """Add forces on all nodes (N, 6), in their frames, to those on the leaders, ``out``."""
        collect(forces, self.leader, self.offset, out)

    def linear(self) -> Array:
        """``W`` with ``q = W q_leader`` for each node, shape (N, 4, 4)."""
        W = np.zeros((len(self.leader), 4, 4))
        W[:, 0, 0] = 1.0
        W[:, :, 1:] = self.offset
        return W
