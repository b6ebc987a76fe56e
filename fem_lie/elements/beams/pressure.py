"""Pressure on beams: follower forces normal to the current axis, with their load stiffness.

On the segment between nodes i and j acts ``f = (x_j − x_i) × ½ (R_i + R_j) w``, half on each node.
``w`` is the axis across the loaded face, in the nodal frames, times the pressure.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined
from fem_lie.forms.term import Pairs, PushedPieces, Term
from fem_lie.lie.motions import global_components, local_components
from fem_lie.lie.tuples import Vector, cross, load, load_row, minus, negative, plus, scaled, store


@inlined
def _chord(H: Array, i: int, j: int) -> Vector:
    """``x_j − x_i``."""
    return minus(load_row(H[j], 0), load_row(H[i], 0))


@inlined
def _across(H: Array, i: int, j: int, w: Vector) -> Vector:
    """``½ (R_i + R_j) w``."""
    return scaled(0.5, plus(global_components(H[i], w), global_components(H[j], w)))


@compiled
def _add_forces(H: Array, pairs: Indices, w: Array, out: Array) -> None:
    """Subtract the pressure forces, in the nodal frames, from ``out`` (n, 6)."""
    for e in range(pairs.shape[0]):
        i, j = pairs[e]
        half = scaled(0.5, cross(_chord(H, i, j), _across(H, i, j, load(w, 0))))
        for node in (i, j):
            store(out[node], 0, minus(load(out[node], 0), local_components(H[node], half)))


@compiled
def _tangent(H: Array, pairs: Indices, w: Array, blocks: Array) -> None:
    """``blocks[e, a, b]`` (6, 6): derivative of forces on node a of segment e in twists of b."""
    unit = np.eye(3)
    blocks[:] = 0.0
    for e in range(pairs.shape[0]):
        i, j = pairs[e]
        chord, across = _chord(H, i, j), _across(H, i, j, load(w, 0))
        half = scaled(0.5, cross(chord, across))
        for b in range(2):
            node = pairs[e, b]
            for k in range(3):
                # δx along a director, and δ(R w) = R (η × w)
                shift = scaled(b - 0.5, cross(load_row(H[node], 1 + k), across))
                turned = global_components(H[node], cross(load_row(unit, k), load(w, 0)))
                turn = scaled(0.25, cross(chord, turned))
                for a in range(2):
                    frame, block = H[pairs[e, a]], blocks[e, a, b]
                    block[0, k], block[1, k], block[2, k] = negative(local_components(frame, shift))
                    column = negative(local_components(frame, turn))
                    block[0, 3 + k], block[1, 3 + k], block[2, 3 + k] = column
        for a in range(2):
            # the components rotate with the frame: δ(Rᵀ f) = (Rᵀ f) × η
            n0, n1, n2 = local_components(H[pairs[e, a]], half)
            block = blocks[e, a, a]
            block[0, 4] += n2
            block[0, 5] -= n1
            block[1, 3] -= n2
            block[1, 5] += n0
            block[2, 3] += n1
            block[2, 4] -= n0


class Pressure(Term):
    """Pressure on a beam, with its load stiffness."""

    label, load, of_bodies, conserved = "pressure on beams", True, True, True

    def __init__(self, pairs: Indices, across: Array) -> None:
        """Store the segments, pairs of nodes (s, 2), and ``w``, shape (3,)."""
        self._pairs, self._across = pairs, across
        rows, columns = np.repeat(pairs, 2, axis=1).ravel(), np.tile(pairs, (1, 2)).ravel()
        self._coupled: Pairs = rows, columns
        self._blocks = np.empty((len(pairs), 2, 2, 6, 6))

    @property
    def pairs(self) -> Pairs:
        """Node pairs of all segments."""
        return self._coupled

    @property
    def contents(self) -> tuple[Array | Indices, ...]:
        """Arrays on which the forces depend, for fingerprints."""
        return self._pairs, self._across

    @property
    def pieces(self) -> PushedPieces:
        """Segments and ``w`` times the amplitude, for conserving schemes."""
        return PushedPieces(
            self._pairs, np.tile(self.amplitude * self._across, (len(self._pairs), 1))
        )

    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """Subtract the pressure forces from ``out``."""
        _add_forces(H, self._pairs, self.amplitude * self._across, out)

    def tangent(self, H: Array, kept: Array) -> Array:
        """Load stiffness, one block per node pair, shape (4 s, 6, 6)."""
        _tangent(H, self._pairs, self.amplitude * self._across, self._blocks)
        return self._blocks.reshape(-1, 6, 6)
