"""Drilling carried along: frames of five-parameter shells that turn as the mid-surface does.

Nothing in such a shell depends on how a frame has turned about its director; a frame that follows
the rigid motion leaves the matrix as it was in local axes. With ``F = d_γ·x,β`` in the axes that
the node's frame had in the unloaded state, the frame lags behind the polar rotation of the
mid-surface by ``ψ = atan2(F₂₁ − F₁₂, F₁₁ + F₂₂)``. Of the cells at a node F is the sum.
"""

from __future__ import annotations

from math import atan2, cos, sin

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled
from fem_lie.bodies.shells.shell import Shell
from fem_lie.elements.shells.drilling import Parameters
from fem_lie.lie.kinds import Written
from fem_lie.mesh.shapes import nodes_of, tabulated
from fem_lie.system.nodes.numbering import Numbering


@compiled
def _lag(H: Array, cells: Indices, slopes: Array, moves: Flags, lag: Array) -> None:
    """ψ of each node, shape (n,)."""
    sums = np.zeros((lag.shape[0], 2))
    gradient = np.empty((2, 3))
    for e in range(cells.shape[0]):
        for i in range(cells.shape[1]):
            node = cells[e, i]
            gradient[:] = 0.0
            for b in range(2):
                for k in range(cells.shape[1]):
                    for j in range(3):
                        gradient[b, j] += slopes[e, i, b, k] * H[cells[e, k], 0, j]
            d1, d2 = H[node, 1], H[node, 2]
            sums[node, 0] += np.dot(d2, gradient[0]) - np.dot(d1, gradient[1])
            sums[node, 1] += np.dot(d1, gradient[0]) + np.dot(d2, gradient[1])
    for i in range(lag.shape[0]):
        lag[i] = atan2(sums[i, 0], sums[i, 1]) if moves[i] else 0.0


@compiled
def _turn_rows(a: Array, at: int, c: float, s: float) -> None:
    """Rows ``at`` and ``at + 1`` in axes that are turned about the third."""
    first = c * a[at] + s * a[at + 1]
    a[at + 1] = c * a[at + 1] - s * a[at]
    a[at] = first


@compiled
def _turn_frames(H: Array, lag: Array) -> None:
    for i in range(lag.shape[0]):
        if lag[i] != 0.0:
            c, s = cos(lag[i]), sin(lag[i])
            for j in range(3):
                _turn_rows(H[i, :, j], 1, c, s)


@compiled
def _turn_motion(motion: Array, kinds: Indices, local: Flags, lag: Array) -> None:
    for i in range(lag.shape[0]):
        if lag[i] != 0.0:
            c, s = cos(lag[i]), sin(lag[i])
            for k in range(motion.shape[0]):
                _turn_rows(motion[k, i], 3, c, s)
                # velocities of the group R³×SO(3) have global components
                if local[k] or not kinds[i] & 1:
                    _turn_rows(motion[k, i], 0, c, s)


class CarriedDrilling:
    """Frames to be turned about their directors."""

    def __init__(self, numbering: Numbering, held: Flags, joined: Indices) -> None:
        """Keep the slopes of the unloaded cells.

        Args:
            numbering: Of all nodes.
            held: Which unknowns of the leaders are zero, shape (n, 6); frames in which a rotation
                is held stay as they are.
            joined: Leaders with joints, whose axes belong to the frames.
        """
        chosen = [
            body
            for body in numbering.nodes
            if isinstance(body, Shell) and body.parameters is Parameters.FIVE_CARRIED
        ]
        leader = numbering.attachment.leader
        self._parts = [
            (leader[numbering.nodes[body][body.connectivity]], _slopes(body)) for body in chosen
        ]
        self._lag = np.zeros(numbering.count)
        self._moves: Flags = np.logical_not(held[:, 3:5].any(axis=1)).reshape(-1)
        self._moves[joined[joined < numbering.count]] = False
        self._moves_here = [self._only(cells) for cells, _ in self._parts]

    def _only(self, cells: Indices) -> Flags:
        here = np.zeros(len(self._moves), dtype=bool)
        here[cells] = True
        return np.logical_and(here, self._moves)

    def __bool__(self) -> bool:
        """Whether there is anything to turn."""
        return bool(self._parts)

    def turn(self, H: Array) -> None:
        """Turn the frames at the head of ``H`` (≥ n, 4, 3)."""
        for (cells, slopes), moves in zip(self._parts, self._moves_here, strict=True):
            _lag(H, cells, slopes, moves, self._lag)
            _turn_frames(H, self._lag)

    def turn_motion(self, H: Array, motion: Array, kinds: Indices, written: Written) -> None:
        """Turn the frames and what is written in them.

        Args:
            H: Frames, shape (≥ n, 4, 3).
            motion: Velocities, accelerations and the like, shape (k, n, 6).
            kinds: Group of each node, shape (n,).
            written: How ``motion`` is written.
        """
        for (cells, slopes), moves in zip(self._parts, self._moves_here, strict=True):
            _lag(H, cells, slopes, moves, self._lag)
            _turn_frames(H, self._lag)
            _turn_motion(motion, kinds, written.local, self._lag)


def _slopes(body: Shell) -> Array:
    """Derivatives of the shape functions at each node of a cell in its frame, (m, k, 2, k)."""
    cell, degree = body.mesh.cell, body.mesh.degree
    table = tabulated(cell, degree, nodes_of(cell, degree))[1:]
    x, frames = body.frames[body.connectivity, 0], body.frames[body.connectivity]
    tangents = np.einsum("aik,mkj->miaj", table, x)
    jacobian = np.einsum("miaj,mibj->miab", tangents, frames[:, :, 1:3])
    return np.asarray(np.einsum("miba,aik->mibk", np.linalg.inv(jacobian), table))
