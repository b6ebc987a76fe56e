"""Drilling energy of six-parameter shells, ``∫ ½ γ c²``, assembled beside the forms of five.

``c = a₁·x,₂ − a₂·x,₁`` (:mod:`fem_lie.elements.shells.drilling_strain`) with tangents ``a = Σ Nᵢ
Rᵢ Aᵢ`` that nodes carry is bilinear in positions and directors: its derivatives in twists ``(u,
η)`` of the nodes are written down here, for cells of any kind and degree, and need no form::

    ∂c/∂u_j = R_jᵀ (a₁ G₂_j − a₂ G₁_j)        ∂c/∂η_j = N_j (A₁ × R_jᵀ x,₂ − A₂ × R_jᵀ x,₁)

with the slopes ``G`` of the shape functions in the unloaded surface. The stress γ c is carried.
"""

from __future__ import annotations

from collections.abc import Iterable
from enum import Enum, auto
from typing import TypeAlias

import basix
import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie.forms.term import Pairs, Term
from fem_lie.lie.motions import add_turning, add_turnings
from fem_lie.mesh.shapes import rule, tabulated

PlainShapes: TypeAlias = tuple[Array, Array, Array]
"""Shape functions at the points (g, k), their slopes G at those of all cells (m, g, 2, k), and what
nodes carry, A (m, k, 2, 3)."""


@compiled
def _point(
    H: Array,
    nodes: Indices,
    shapes: tuple[Array, Array, Array],
    work: tuple[Array, Array, Array],
    n: Array,
) -> float:
    """``x,₁ x,₂`` and ``a₁ a₂`` at a point, and the gradient ``n`` (k, 6) of ``c``; returns c.

    ``shapes`` are N, G and A there, ``work`` is x, a, and room for two vectors.
    """
    (N, G, A), (x, a, y) = shapes, work
    k = nodes.shape[0]
    x[:], a[:] = 0.0, 0.0
    for i in range(k):
        frame = H[nodes[i]]
        for b in range(2):
            for j in range(3):
                x[b, j] += G[b, i] * frame[0, j]
                for d in range(3):
                    a[b, j] += N[i] * A[i, b, d] * frame[1 + d, j]
    for i in range(k):
        frame = H[nodes[i]]
        for d in range(3):
            n[i, d] = 0.0
            for j in range(3):
                n[i, d] += frame[1 + d, j] * (a[0, j] * G[1, i] - a[1, j] * G[0, i])
        _local(frame, x[1], y[0])
        _local(frame, x[0], y[1])
        for d in range(3):
            e, f = (d + 1) % 3, (d + 2) % 3
            n[i, 3 + d] = N[i] * (
                A[i, 0, e] * y[0, f]
                - A[i, 0, f] * y[0, e]
                - A[i, 1, e] * y[1, f]
                + A[i, 1, f] * y[1, e]
            )
    return float(np.dot(a[0], x[1]) - np.dot(a[1], x[0]))


@compiled
def _local(frame: Array, v: Array, out: Array) -> None:
    for d in range(3):
        out[d] = frame[1 + d, 0] * v[0] + frame[1 + d, 1] * v[1] + frame[1 + d, 2] * v[2]


@compiled
def _strains(
    H: Array, cells: Indices, shapes: PlainShapes, rest: Array, h: Array, out: tuple[Array, Array]
) -> None:
    """``c`` and its change along twists ``h`` (n, 6), both in ``out``, of shape (m, g)."""
    (N, G, A), (c, change) = shapes, out
    x, a, y = np.empty((2, 3)), np.empty((2, 3)), np.empty((2, 3))
    n = np.empty((cells.shape[1], 6))
    for e in range(cells.shape[0]):
        for g in range(N.shape[0]):
            here = N[g], G[e, g], A[e]
            c[e, g] = _point(H, cells[e], here, (x, a, y), n) - rest[e, g]
            change[e, g] = 0.0
            for i in range(cells.shape[1]):
                for k in range(6):
                    change[e, g] += n[i, k] * h[cells[e, i], k]


@compiled
def _add_forces(
    H: Array, cells: Indices, shapes: PlainShapes, rest: Array, weight: Array, out: Array
) -> None:
    N, G, A = shapes
    x, a, y = np.empty((2, 3)), np.empty((2, 3)), np.empty((2, 3))
    n = np.empty((cells.shape[1], 6))
    for e in range(cells.shape[0]):
        for g in range(N.shape[0]):
            here = N[g], G[e, g], A[e]
            c = _point(H, cells[e], here, (x, a, y), n) - rest[e, g]
            for i in range(cells.shape[1]):
                for k in range(6):
                    out[cells[e, i], k] += weight[e, g] * c * n[i, k]


@compiled
def _add_tangent(
    H: Array,
    cells: Indices,
    shapes: PlainShapes,
    factors: tuple[Array, Array],
    place: Indices,
    K: Array,
) -> None:
    """Second derivative along :func:`~fem_lie.lie.motions.retract`.

    ``∂r/∂h`` in twists is ``w n nᵀ + S ∂n/∂h`` with the carried stress ``S`` times area; what that
    motion has beyond is of the carried forces ``S n``, too.
    """
    (N, G, A), (weight, stress) = shapes, factors
    k = cells.shape[1]
    x, a, y = np.empty((2, 3)), np.empty((2, 3)), np.empty((2, 3))
    n, force, Q, M = np.empty((k, 6)), np.empty(6), np.empty((3, 3)), np.empty((3, 3))
    for e in range(cells.shape[0]):
        for g in range(N.shape[0]):
            _point(H, cells[e], (N[g], G[e, g], A[e]), (x, a, y), n)
            w, S = weight[e, g], stress[e, g]
            for j in range(k):
                frame, own = H[cells[e, j]], K[place[e, j, j]]
                for d in range(6):
                    force[d] = S * n[j, d]
                add_turning(force, 1.0, own)
                _local(frame, x[1], y[0])
                _local(frame, x[0], y[1])
                for d in range(3):
                    # (R_jᵀ b)^ and A (R_jᵀ x)^ of the node's own turning
                    p, q = (d + 1) % 3, (d + 2) % 3
                    own[q, 3 + p] += S * n[j, d]
                    own[p, 3 + q] -= S * n[j, d]
                    for f in range(3):
                        own[3 + d, 3 + f] += (
                            S * N[g, j] * (y[0, d] * A[e, j, 0, f] - y[1, d] * A[e, j, 1, f])
                        )
                    own[3 + d, 3 + d] -= (
                        S * N[g, j] * (np.dot(A[e, j, 0], y[0]) - np.dot(A[e, j, 1], y[1]))
                    )
                for i in range(k):
                    block, across = K[place[e, j, i]], K[place[e, i, j]]
                    for d in range(6):
                        for f in range(6):
                            block[d, f] += w * n[j, d] * n[i, f]
                    other = H[cells[e, i]]
                    for d in range(3):
                        for f in range(3):
                            Q[d, f] = np.dot(frame[1 + d], other[1 + f])
                    # Q (G₁_j Â₂_i − G₂_j Â₁_i) N_i: translation of j, rotation of i
                    for d in range(3):
                        s = (
                            S
                            * N[g, i]
                            * (G[e, g, 0, j] * A[e, i, 1, d] - G[e, g, 1, j] * A[e, i, 0, d])
                        )
                        M[d, d] = 0.0
                        M[(d + 2) % 3, (d + 1) % 3] = s
                        M[(d + 1) % 3, (d + 2) % 3] = -s
                    for d in range(3):
                        for f in range(3):
                            value = 0.0
                            for p in range(3):
                                value += Q[d, p] * M[p, f]
                            block[d, 3 + f] += value
                            across[3 + f, d] += value


class DrillingAssembly(Term):
    """Forces, tangent and energy on the nodes of an assembly of shells.

    Attributes:
        carried: Stress γ c at the points of integration, flat.
    """

    label, of_bodies, carries = "drilling of shells with six parameters", True, True

    def __init__(
        self,
        frames: Array,
        cells: Indices,
        kind: basix.CellType,
        degree: int,
        quadrature_degree: int,
        directions: Array,
        stiffness: Array,
        pattern: tuple[Indices, Indices],
    ) -> None:
        """Evaluate the unloaded surface.

        Args:
            frames: Unloaded frames of the nodes, shape (n, 4, 3).
            cells: Nodes of each cell, shape (m, k).
            kind: Of the cells.
            degree: Of their edges.
            quadrature_degree: As of the element.
            directions: Vector of each cell whose projection onto the surface is the first axis.
            stiffness: γ of each cell, shape (m,).
            pattern: Rows and columns of the blocks of the tangent.
        """
        points, w = rule(kind.name, quadrature_degree)
        middle = np.asarray(basix.geometry(kind)).mean(axis=0, keepdims=True)
        table = tabulated(kind.name, degree, np.vstack([points, middle]))
        self._cells, N = cells.astype(np.int64), np.ascontiguousarray(table[0, :-1])
        tangents = np.einsum("agk,mkj->mgaj", table[1:], frames[cells, 0])
        normal = np.cross(tangents[:, :, 0], tangents[:, :, 1])
        e2 = np.cross(normal, directions[:, np.newaxis])
        axes = np.stack([np.cross(e2, normal), e2], axis=2)
        axes /= np.linalg.norm(axes, axis=-1, keepdims=True)
        inverse = np.linalg.inv(np.einsum("mgaj,mgbj->mgab", tangents, axes)[:, :-1])
        G = np.einsum("mgba,agk->mgbk", inverse, table[1:, :-1])
        # what nodes carry are the axes of the centre
        A = np.einsum("mbj,mkdj->mkbd", axes[:, -1], frames[cells, 1:])
        self._shapes: PlainShapes = N, G, A
        area = w * np.linalg.norm(normal[:, :-1], axis=-1)
        self._area, self._weight = area, area * stiffness[:, np.newaxis]
        self._gamma = stiffness[:, np.newaxis]
        self._rest, self._stress = np.zeros_like(area), np.zeros_like(area)
        self._change = np.zeros_like(area)
        self._rest[:] = self._strain(frames, np.zeros((len(frames), 6)))[0]
        indptr, indices = pattern
        key = np.repeat(np.arange(len(frames)), np.diff(indptr)) * len(frames) + indices
        pairs = len(frames) * self._cells[:, :, np.newaxis] + self._cells[:, np.newaxis]
        self._place = np.searchsorted(key, pairs)
        rows = np.repeat(np.arange(len(frames)), np.diff(indptr))
        self._pairs = rows, indices.astype(np.int64)
        self._diagonal = np.flatnonzero(rows == indices)
        self._all = np.ones(len(frames), dtype=bool)

    @property
    def carried(self) -> Array:
        """See the class; a view."""
        return self._stress.reshape(-1)

    def _strain(self, H: Array, h: Array) -> tuple[Array, Array]:
        c = np.empty_like(self._rest)
        _strains(H, self._cells, self._shapes, self._rest, h.reshape(-1, 6), (c, self._change))
        return c, self._change

    @property
    def pairs(self) -> Pairs:
        """Those of the shells."""
        return self._pairs

    def room(self) -> Array:
        """For all forces."""
        return np.zeros((len(self._all), 6))

    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """Add the forces at frames ``H`` to ``out``, shape (n, 6)."""
        forces = self.room() if kept is None else kept
        forces[:] = 0.0
        _add_forces(H, self._cells, self._shapes, self._rest, self._weight, forces)
        out += forces

    def energy(self, H: Array) -> float:
        """Stored energy."""
        c, _ = self._strain(H, np.zeros((len(H), 6)))
        return float(0.5 * np.sum(self._weight * c**2))

    def tangent(self, H: Array, kept: Array) -> Array:
        """Derivatives in twists, with the carried stress."""
        blocks = np.zeros((len(self._pairs[0]), 6, 6))
        factors = self._weight, self._area * self._stress
        _add_tangent(H, self._cells, self._shapes, factors, self._place, blocks)
        add_turnings(kept, -1.0, self._diagonal, self._all, blocks)
        return blocks

    def restore(self, carried: Array) -> None:
        """See the base class."""
        self.carried[:] = carried

    def clear_stress(self) -> None:
        """See the base class."""
        self.carried[:] = 0.0

    def reset_stress(self, H: Array) -> None:
        """See the base class."""
        self.carry(H, np.zeros((len(H), 6)))

    def carry(self, H: Array, h: Array) -> None:
        """Carry the stress on to the end of the increment ``h`` (n, 6) from frames ``H``."""
        c, change = self._strain(H, h)
        self._stress[:] = self._gamma * (c + change)


FRACTION = 0.01
"""γ over ``G t³/h²``; from 1 to 1e-8 nothing changes (docs/six_parameters.md)."""

_SHEAR, _TWIST = 2, 5  # of the eight strains


class Parameters(Enum):
    """Unknowns of the nodes of a shell.

    ``AUTOMATIC``: five, or six where something needs the sixth: a joint, link, prescribed motion or
    moment that takes hold of the rotation of a node, a kink or a branch. ``FIVE``: a place and a
    director. ``FIVE_CARRIED``: the same, and the frames are turned about their directors as the
    mid-surface turns, after each time step: nothing depends on it but how long a matrix can be
    kept. ``SIX``: whole frames.
    """

    AUTOMATIC = auto()
    FIVE = auto()
    FIVE_CARRIED = auto()
    SIX = auto()


def drilling_stiffness(
    stiffness: Array, areas: Array, cells: Indices, bound: Iterable[int]
) -> Array:
    """γ of each cell, force per length, shape (m,).

    Args:
        stiffness: Section stiffness of each cell, shape (m, 8, 8).
        areas: Of the cells, shape (m,).
        cells: Nodes of each cell, shape (m, k).
        bound: Nodes that take moments about their normals alone.
    """
    membrane = stiffness[:, _SHEAR, _SHEAR]
    soft = FRACTION * 12.0 * stiffness[:, _TWIST, _TWIST] / areas
    around = np.isin(cells, list(bound)).any(axis=1)
    return np.where(around, membrane, np.minimum(soft, membrane))
