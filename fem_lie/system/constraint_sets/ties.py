"""Constraints that are linear in the positions of many nodes: ties of faces.

For the corner ``i`` of the first face, ``g_i = Σ_j D_ij x_j − Σ_k M_ik x_k`` vanishes. The
constraints of a corner are the components of ``g_i`` along the axes ``d_a`` that its node has at
the start, constant in space. Where a support holds ``d_a`` of the corner ``b``, its constraint
would follow from others: it is left out, and ``d_a (d_a·g_b)`` is added in equal parts to ``g_i``
of adjacent corners that are free to move along ``d_a`` (if there are none, nothing is changed).
Multipliers still represent a constant traction then.

The Jacobian is constant in space, so there is no geometric stiffness.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.sparse as sp

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.bodies.body import Body, Point
from fem_lie.joints.connection import TieDefinition
from fem_lie.linear.saddle_point import Incidences
from fem_lie.system.constraint_sets.constraint_set import (
    ConstrainedFrames,
    ConstraintSet,
    Numbered,
    Place,
    Start,
)

_FREE = 1e-9
"""Part of a direction along which a corner moves that is round-off."""


class Ties(ConstraintSet):
    """Set of ties; all act on nodes with positions."""

    what = "ties of faces (Tie)"

    def __init__(
        self, items: Sequence[Numbered], constrained: ConstrainedFrames, start: Start
    ) -> None:
        """Build the constant Jacobian."""
        found = [
            (given.number, definition)
            for given in items
            if (definition := given.item.tie_definition()) is not None
        ]
        self.start, self._count = start, constrained.count
        parts = [_rows(definition, constrained) for _, definition in found]
        self.owner = np.repeat(
            np.array([number for number, _ in found], dtype=np.int64),
            [part.shape[0] for part in parts],
        )
        self.angular, self.targets = np.zeros(self.m, dtype=bool), np.zeros(self.m)
        shape = 0, 3 * constrained.count
        self._jacobian = sp.vstack([sp.csr_matrix(shape), *parts], format="csr")
        ptr, nodes, self._factors = _by_node(self._jacobian)
        self.incidences = Incidences(ptr, nodes)
        self._rows = self.incidences.rows
        none = np.empty(0, dtype=np.int64)
        self.pairs = none, none
        self._sides = [
            (number, *_side(definition, constrained, self.owner == number, self._jacobian))
            for number, definition in found
        ]

    @property
    def empty(self) -> bool:
        """Whether there is no tie."""
        return self.m == 0

    @property
    def bound(self) -> Indices:
        """No rows: axes of nodes do not matter."""
        return np.empty(0, dtype=np.int64)

    def evaluate(
        self, H: Array, v: Array, multipliers: Array, scale: Array, count: int, r: Array
    ) -> None:
        """Add constraint forces ``Bᵀλ`` to ``r``; set its rows ``scale · Φ``."""
        own, n = self.own, self._count
        forces = (self._jacobian.T @ multipliers[own]).reshape(n, 3)
        r[: 6 * n].reshape(n, 6)[:, :3] += np.einsum("nij,nj->ni", H[:n, 1:], forces)
        r[6 * count :][own] = scale[own] * self._violations(H)

    def _violations(self, H: Array) -> Array:
        found: Array = self._jacobian @ H[: self._count, 0].ravel()
        return found - self.targets

    def values(self, H: Array, v: Array, out: Array) -> None:
        """Set the violations ``Φ`` in its rows of ``out``."""
        out[self.own] = self._violations(H)

    def jacobian(self, H: Array, rows: Array) -> None:
        """Add ``∂Φ/∂h``, one row of six per incidence, to the constraint Jacobian ``rows``."""
        first, axes = self.start.incidence, H[self.incidences.nodes, 1:]
        own = rows[first : first + len(axes)]
        own[:, :3] += np.einsum("eij,ej->ei", axes, self._factors)

    def geometric(self, H: Array, multipliers: Array, index: Indices, K: Array) -> None:
        """Add nothing: the constraints are linear."""

    def rates(self, H: Array, v: Array, first: Array, second: Array) -> None:
        """Set first rates; second rates are zero at constant velocities of positions."""
        nodes = self.incidences.nodes
        moved = np.einsum("eij,ei->ej", H[nodes, 1:], v[nodes, :3])
        products = np.einsum("ej,ej->e", self._factors, moved)
        first[self.own] = np.bincount(self._rows, products, self.m)
        second[self.own] = 0.0

    def initial(self, H: Array) -> Array:
        """Targets that keep the distance of the faces, which is round-off or within tolerance."""
        return self._violations(H) + self.targets

    def wrenches(self, H: Array, v: Array, multipliers: Array, out: Array) -> None:
        """Add force and moment on the first face, about its corner of :meth:`places`."""
        for number, corner, nodes, rows in self._sides:
            forces = -(rows.T @ multipliers[self.own]).reshape(-1, 3)
            out[number, :3] += forces.sum(axis=0)
            arms = H[nodes, 0] - H[corner, 0]
            out[number, 3:] += np.cross(arms, forces).sum(axis=0)

    def places(self) -> dict[int, Place]:
        """The corner of the first face that is closest to its centre; axes are global."""
        return {
            number: Place(corner, np.zeros(3), self._count, np.eye(3))
            for number, corner, _, _ in self._sides
        }

    @property
    def outward(self) -> bool:
        """Whether there are dampers, or connections to ground or prescribed motions: never."""
        return False


def _numbers(body: Body, nodes: Indices, constrained: ConstrainedFrames) -> Indices:
    """Rows of nodes of a body."""
    return np.array([constrained.of(Point(body, int(node))) for node in nodes], dtype=np.int64)


def _rows(tie: TieDefinition, constrained: ConstrainedFrames) -> sp.csr_matrix:
    """Jacobian of a tie in all positions, global components, shape (m, 3 n)."""
    corners = _numbers(tie.first, tie.nodes, constrained)
    axes = constrained.frames[corners, 1:]
    held = constrained.held[corners, :3]
    left_out, passed = _passed_on(axes, held, tie.adjacent)
    parts = []
    for body, weights, sign in ((tie.first, tie.own, 1.0), (tie.second, tie.others, -1.0)):
        used = np.unique(weights.indices)
        numbers = _numbers(body, used, constrained)
        entries = sign * weights[:, used].tocoo()
        placed = entries.data, (entries.row, numbers[entries.col])
        shape = len(corners), constrained.count
        parts.append(sp.csr_matrix(placed, shape=shape))
    vectors = sp.kron(parts[0] + parts[1], sp.identity(3), format="csr")
    along = sp.block_diag(list(axes), format="csr")
    complete = (along @ (sp.identity(3 * len(corners)) + passed) @ vectors).tocsr()
    kept: sp.csr_matrix = complete[np.flatnonzero(~left_out.ravel())]
    kept.eliminate_zeros()
    return kept


def _passed_on(axes: Array, held: Flags, adjacent: Indices) -> tuple[Flags, sp.csr_matrix]:
    """Constraints that are left out (p, 3), and the map of their parts to others (3 p, 3 p).

    Args:
        axes: Axes of the corners as rows, shape (p, 3, 3).
        held: Axes along which a corner is held, shape (p, 3).
        adjacent: Pairs of adjacent corners, in both orders, shape (a, 2).
    """
    p, (b, i) = len(axes), adjacent.T
    # the part of each axis of b along which i can move
    free = axes[i].transpose(0, 2, 1) @ (~held[i][:, :, np.newaxis] * axes[i])
    moves = np.linalg.norm(np.einsum("axy,acy->acx", free, axes[b]), axis=2) > _FREE
    takes = held[b] & moves
    count = np.zeros((p, 3))
    np.add.at(count, b, takes)
    left_out = held & (count > 0.0)
    pair, a = np.nonzero(takes)
    shares = 1.0 / count[b[pair], a]
    d = axes[b[pair], a]
    blocks = shares[:, np.newaxis, np.newaxis] * d[:, :, np.newaxis] * d[:, np.newaxis]
    rows, columns = (3 * np.repeat(each[pair], 9) for each in (i, b))
    within = np.divmod(np.tile(np.arange(9), len(pair)), 3)
    placed = blocks.ravel(), (rows + within[0], columns + within[1])
    return left_out, sp.csr_matrix(placed, shape=(3 * p, 3 * p))


def _by_node(jacobian: sp.csr_matrix) -> tuple[Indices, Indices, Array]:
    """First incidence of each row, nodes, and factors of their positions, shape (e, 3)."""
    entries = jacobian.tocoo()
    count = jacobian.shape[1] // 3
    keys = entries.row.astype(np.int64) * count + entries.col // 3
    known, of = np.unique(keys, return_inverse=True)
    factors = np.zeros((len(known), 3))
    factors[of, entries.col % 3] = entries.data
    rows, nodes = np.divmod(known, max(count, 1))
    return np.searchsorted(rows, np.arange(jacobian.shape[0] + 1)).astype(np.int64), nodes, factors


def _side(
    tie: TieDefinition, constrained: ConstrainedFrames, own: Flags, jacobian: sp.csr_matrix
) -> tuple[int, Indices, sp.csr_matrix]:
    """Row of the corner closest to the centre, those of the first face, and their Jacobian."""
    x = constrained.frames[_numbers(tie.first, tie.nodes, constrained), 0]
    centre = tie.areas @ x / tie.areas.sum()
    corner = tie.nodes[[np.linalg.norm(x - centre, axis=1).argmin()]]
    nodes = _numbers(tie.first, np.unique(tie.own.indices), constrained)
    columns = (3 * nodes[:, np.newaxis] + np.arange(3)).ravel()
    rows = sp.diags(own.astype(np.float64)) @ jacobian[:, columns]
    return int(_numbers(tie.first, corner, constrained)[0]), nodes, rows.tocsr()
