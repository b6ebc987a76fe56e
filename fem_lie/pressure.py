"""Pressure on beams: forces normal to the current axis, with their load stiffness.

On the piece between nodes i and j acts ``f = (x_j − x_i) × ½ (R_i + R_j) w``, half on each node,
with ``w`` the axis across the face, in the nodes' frames, times the pressure.
"""

from __future__ import annotations

import numpy as np

from fem_lie._jit import Array, Indices, compiled


@compiled
def _across(H: Array, i: int, j: int, w: Array, out: Array) -> None:
    """``½ (R_i + R_j) w``."""
    for a in range(3):
        out[a] = 0.0
        for k in range(3):
            out[a] += 0.5 * (H[i, 1 + k, a] + H[j, 1 + k, a]) * w[k]


@compiled
def _cross(a: Array, b: Array, out: Array) -> None:
    out[0] = a[1] * b[2] - a[2] * b[1]
    out[1] = a[2] * b[0] - a[0] * b[2]
    out[2] = a[0] * b[1] - a[1] * b[0]


@compiled
def _add_forces(H: Array, pairs: Indices, w: Array, out: Array) -> None:
    """``out −= forces`` in the nodes' frames, shape (n, 6)."""
    across, f = np.empty(3), np.empty(3)
    for e in range(pairs.shape[0]):
        i, j = pairs[e]
        _across(H, i, j, w[e], across)
        _cross(H[j, 0] - H[i, 0], across, f)
        for node in (i, j):
            for k in range(3):
                out[node, k] -= 0.5 * (
                    H[node, 1 + k, 0] * f[0] + H[node, 1 + k, 1] * f[1] + H[node, 1 + k, 2] * f[2]
                )


@compiled
def _tangent(H: Array, pairs: Indices, w: Array, blocks: Array) -> None:
    """``blocks[e, a, b]`` (6, 6): derivative of the forces on node a of piece e in twists of b."""
    across, f, change = np.empty(3), np.empty(3), np.empty(3)
    turned, unit = np.empty(3), np.empty(3)
    blocks[:] = 0.0
    for e in range(pairs.shape[0]):
        i, j = pairs[e]
        _across(H, i, j, w[e], across)
        chord = H[j, 0] - H[i, 0]
        _cross(chord, across, f)
        for b in range(2):
            node = pairs[e, b]
            sign = -1.0 if b == 0 else 1.0
            for column in range(6):
                if column < 3:
                    # δx along a director
                    _cross(sign * H[node, 1 + column], across, change)
                else:
                    # δ(R w) = R (η × w)
                    unit[:] = 0.0
                    unit[column - 3] = 1.0
                    _cross(unit, w[e], turned)
                    for k in range(3):
                        unit[k] = 0.5 * (
                            H[node, 1, k] * turned[0]
                            + H[node, 2, k] * turned[1]
                            + H[node, 3, k] * turned[2]
                        )
                    _cross(chord, unit, change)
                for a in range(2):
                    for k in range(3):
                        blocks[e, a, b, k, column] -= 0.5 * np.dot(H[pairs[e, a], 1 + k], change)
        for a in range(2):
            # the force's components turn with the frame: δ(Rᵀ f) = (Rᵀ f) × η
            n0 = 0.5 * np.dot(H[pairs[e, a], 1], f)
            n1 = 0.5 * np.dot(H[pairs[e, a], 2], f)
            n2 = 0.5 * np.dot(H[pairs[e, a], 3], f)
            block = blocks[e, a, a]
            block[0, 4] += n2
            block[0, 5] -= n1
            block[1, 3] -= n2
            block[1, 5] += n0
            block[2, 3] += n1
            block[2, 4] -= n0


class Pressure:
    """All pressures of a scene.

    Attributes:
        rows: Nodes of the blocks of the tangent, with ``columns``.
        across: ``w`` of each piece, shape (s, 3); it may be changed.
    """

    def __init__(self, pairs: Indices) -> None:
        """Keep the pieces: pairs of nodes, shape (s, 2)."""
        self._pairs = pairs
        self.across = np.zeros((len(pairs), 3))
        self.rows = np.repeat(pairs, 2, axis=1).ravel()
        self.columns = np.tile(pairs, (1, 2)).ravel()
        self._blocks = np.empty((len(pairs), 2, 2, 6, 6))

    def add_forces(self, H: Array, out: Array) -> None:
        """Subtract the forces at frames ``H`` from ``out``, shape (n, 6)."""
        _add_forces(H, self._pairs, self.across, out)

    def tangent(self, H: Array) -> Array:
        """Blocks of the derivative of what :meth:`add_forces` adds, shape (4 s, 6, 6)."""
        _tangent(H, self._pairs, self.across, self._blocks)
        return self._blocks.reshape(-1, 6, 6)
