"""Friction of mortar contact: one tangential spring per node of a line, which slips by Coulomb.

The mean slip of a node ``A`` since the last accepted state is that of the material points which
faced each other there, ``P_q`` and ``Q_q``, with the weights ``w_q Φ_A ψ'`` of contact forces::

    u_A = Σ w_q Φ_A ψ' (P_q − Q_q) / W_A + R_A e_A,  W_A = Σ w_q Φ_A ψ'
    τ_A = k u_T,  u_T = u_A − n_A n_A·u_A       while |τ_A| ≤ μ p_A, else τ_A = μ p_A u_T/|u_T|

``e_A`` is the elongation of the spring in that state, along the axes ``R_A`` of a node with a
frame, or constant in space if there is none, so that the other surface is on ground; ``n_A`` is
the mean normal with the same weights at present. Slips are linear in nodal coordinates, and the
same for all observers. When a state is accepted, the spring of a node keeps its traction, and new
points face each other; springs are those of pressures, whose numbers persist.

Puso & Laursen, Comput. Methods Appl. Mech. Engrg. 193 (2004) 4891; Gitterle, Popp, Gee & Wall, Int.
J. Numer. Methods Engrg. 84 (2010) 543.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.sparse import bsr_array, coo_array, csr_array

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled
from fem_lie.contact.laws.anchors import empty_anchors, set_anchors
from fem_lie.contact.laws.derivatives import (
    add_turning,
    derivatives,
    set_derivatives,
    store_motion,
)
from fem_lie.contact.laws.law import FrictionConstants
from fem_lie.contact.mortar.sides import MortarPoints
from fem_lie.contact.sides.kinematics import SLOTS, contact_point
from fem_lie.contact.sides.table import ContactPoints
from fem_lie.lie.node_types import POSITION_GRADIENT
from fem_lie.lie.tuples import load_row


class Weighted(NamedTuple):
    """Points of a state with the weights of their contact forces.

    Attributes:
        of: The points.
        weights: ``w ψ'``, shape (m,).
        changes: ``w ψ''``, shape (m,).
        rows: Derivatives of the gaps in the twists of the nodes in their slots, shape (m, s, 6).
        nodes: These nodes, −1 where there is none, shape (m, s).
        normals: Normals out of the second surface, shape (m, 3).
    """

    of: MortarPoints
    weights: Array
    changes: Array
    rows: Array
    nodes: Indices
    normals: Array

    def means(self, values: Array, count: int) -> Array:
        """Sums ``Σ w ψ' Φ_A`` of values (m, c) of the points for each node, shape (count, c)."""
        found = np.zeros((count, values.shape[1]))
        each = (self.of.shapes * self.weights[:, np.newaxis])[:, :, np.newaxis]
        np.add.at(found, self.of.pressures, each * values[:, np.newaxis])
        return found


def summed(of: MortarPoints, nodes: Indices, rows: Array, shape: tuple[int, int]) -> csr_array:
    """Sums ``Σ_q Φ_A`` of rows in twists over the points, shape (c pressures, 6 nodes).

    Args:
        of: The points.
        nodes: Nodes of the rows, −1 where there is none, shape (m, s).
        rows: Rows of each point, shape (m, s, c, 6).
        shape: Numbers of pressures and of nodes.
    """
    c = rows.shape[2]
    e, s = np.nonzero((nodes >= 0) & rows.any(axis=(2, 3)))
    values = of.shapes[e][:, :, np.newaxis, np.newaxis] * rows[e, s][:, np.newaxis]
    at = c * of.pressures[e][:, :, np.newaxis] + np.arange(c)
    to = 6 * nodes[e, s][:, np.newaxis] + np.arange(6)
    A = np.broadcast_to(at[:, :, :, np.newaxis], values.shape)
    B = np.broadcast_to(to[:, np.newaxis, np.newaxis], values.shape)
    full = c * shape[0], 6 * shape[1]
    return coo_array((values.ravel(), (A.ravel(), B.ravel())), full).tocsr()


@compiled
def set_normal_rows(H: Array, types: Indices, at: ContactPoints, out: Array) -> None:
    """Set the derivatives of the normals in the twists of the nodes, zero on entry, (m, s, 3, 6).

    Args:
        H: Nodal coordinates.
        types: Types of all nodes, shape (n,).
        at: Contact points.
        out: Overwritten.
    """
    by = derivatives()
    for e in range(at.pairs.shape[0]):
        point = contact_point(H, at.a, at.b, at.pairs[e, 0], at.pairs[e, 1], at.kind)
        scale = set_derivatives(H, types, at, e, point, by)
        for s in range(SLOTS):
            for r in range(3):
                for p in range(6 if by.nodes[s] >= 0 else 0):
                    out[e, s, r, p] = by.N[s, r, p] / scale


@compiled
def _set_motions(
    H: Array, types: Indices, nodes: Indices, weights: Array, arms: Array, out: Array
) -> None:
    """Set the motions of points of nodes (k,) per motion of these, zero on entry, (k, 3, 6)."""
    for s in range(nodes.shape[0]):
        node, c = nodes[s], load_row(arms, s)
        store_motion(types[node], H[node], 1.0, weights[s], c, out[s])


@compiled
def _add_turnings(
    H: Array, types: Indices, nodes: Indices, weights: Array, arms: Array, f: Array, out: Array
) -> None:
    """Add the derivatives of forces (k, 3) on points as axes of nodes (k,) rotate, (k, 6, 6)."""
    for s in range(nodes.shape[0]):
        node, c = nodes[s], load_row(arms, s)
        add_turning(types[node], H[node], load_row(f, s), weights[s], c, out[s])


class Slips(NamedTuple):
    """Mean slips ``u_A = Σ (w x + R c) + o``, linear in nodal coordinates.

    Attributes:
        pressures: Pressure ``A`` of each summand, shape (k,).
        nodes: Nodes, shape (k,).
        weights: ``w``, shape (k,).
        arms: ``c``, shape (k, 3); the last ones are the elongations ``e`` of the springs along
            the axes of frames.
        fixed: ``o``, contribution of ground, and of springs without a frame, shape (n, 3).
        lengths: ``W``, zero where no points face each other, shape (n,).
        grounded: Whether the second surface, or the first, is on ground, shape (n,).
        framed: Whether a frame has the spring, shape (n,).
    """

    pressures: Indices
    nodes: Indices
    weights: Array
    arms: Array
    fixed: Array
    lengths: Array
    grounded: Flags
    framed: Flags

    @property
    def springs(self) -> slice:
        """The summands that are springs."""
        return slice(len(self.nodes) - np.count_nonzero(self.framed), None)

    def rotated(self, H: Array) -> Array:
        """``R c``, global components, shape (k, 3)."""
        return np.einsum("ki,kij->kj", self.arms, H[self.nodes, 1:])

    def values(self, H: Array) -> Array:
        """Slips at frames ``H``, shape (n, 3)."""
        found = self.fixed.copy()
        moved = self.weights[:, np.newaxis] * H[self.nodes, 0] + self.rotated(H)
        np.add.at(found, self.pressures, moved)
        return found

    def on_nodes(self, τ: Array) -> Array:
        """Forces ``W τ`` of tractions (n, 3) on the summands, global components, shape (k, 3)."""
        return np.asarray((self.lengths[:, np.newaxis] * τ)[self.pressures])

    def motions(self, H: Array, types: Indices) -> Array:
        """Derivatives of the summands in the motions of their nodes, shape (k, 3, 6).

        Args:
            H: Frames.
            types: Types of all nodes, shape (count,).
        """
        found = np.zeros((len(self.nodes), 3, 6))
        _set_motions(H, types, self.nodes, self.weights, self.arms, found)
        return found

    def rows(self, H: Array, types: Indices) -> csr_array:
        """Derivatives in the motions of all nodes, shape (3 n, 6 count)."""
        blocks = self.motions(H, types)
        at = 3 * self.pressures[:, np.newaxis] + np.arange(3)
        to = 6 * self.nodes[:, np.newaxis] + np.arange(6)
        A = np.broadcast_to(at[:, :, np.newaxis], blocks.shape)
        B = np.broadcast_to(to[:, np.newaxis], blocks.shape)
        shape = 3 * len(self.lengths), 6 * len(types)
        return coo_array((blocks.ravel(), (A.ravel(), B.ravel())), shape).tocsr()


def no_slips(n: int) -> Slips:
    """Slips of pressures that face nothing."""
    none, flags = np.empty(0, dtype=np.int64), np.zeros(n, dtype=np.bool_)
    fixed = np.zeros((n, 3))
    return Slips(none, none, np.empty(0), np.empty((0, 3)), fixed, np.zeros(n), flags, flags)


def _packed(slips: Slips) -> Array:
    """Slips as a flat array."""
    each = np.column_stack([slips.pressures, slips.nodes, slips.weights, slips.arms])
    rest = np.column_stack([slips.fixed, slips.lengths, slips.grounded, slips.framed])
    return np.concatenate([rest.ravel(), each.ravel()])


def _unpacked(values: Array, n: int) -> Slips:
    """Slips of ``n`` pressures from the array that :func:`_packed` returned."""
    rest, each = values[: 6 * n].reshape(n, 6), values[6 * n :].reshape(-1, 6)
    numbers = each[:, :2].astype(np.int64)
    fixed, lengths = rest[:, :3].copy(), rest[:, 3].copy()
    grounded, framed = (rest[:, 4:] != 0.0).T
    weights, arms = each[:, 2].copy(), each[:, 3:].copy()
    return Slips(numbers[:, 0], numbers[:, 1], weights, arms, fixed, lengths, grounded, framed)


class _Tractions(NamedTuple):
    """Tractions on the second surface, each of shape (n, 3) or (n,).

    Attributes:
        slip: ``u``.
        across: ``u_T``.
        normals: ``n``.
        sizes: Lengths of ``Σ w Φ ψ' n``, of which ``n`` is the direction.
        along: Direction of ``u_T``, zero without slip.
        factors: Traction over that of the spring alone.
        slips: Whether a node slips.
        τ: Tractions.
    """

    slip: Array
    across: Array
    normals: Array
    sizes: Array
    along: Array
    factors: Array
    slips: Flags
    τ: Array


class MortarFriction:
    """Tangential springs of the nodes of a line.

    Attributes:
        dissipated: Energy dissipated by slip in all accepted steps, J.
    """

    def __init__(self, count: int, law: FrictionConstants, types: Indices) -> None:
        """Nothing faces the line yet; see :meth:`accept`.

        Args:
            count: Number of pressures.
            law: Constants.
            types: Types of all nodes, shape (n,).
        """
        self._law, self._types = law, types
        self.dissipated = 0.0
        self._slips = no_slips(count)
        self._before: Array = np.zeros((count, 3))

    def _tractions(self, H: Array, points: Weighted, p: Array) -> _Tractions:
        """Tractions at pressures ``p`` (n,)."""
        u = self._slips.values(H)
        n = points.means(points.normals, len(p))
        sizes = np.linalg.norm(n, axis=1)
        near = np.where(sizes > 0.0, sizes, 1.0)
        n /= near[:, np.newaxis]
        across = u - (u * n).sum(axis=1, keepdims=True) * n
        size, most = np.linalg.norm(across, axis=1), self._law.μ * p
        slips = self._law.k * size > most
        factors = np.ones_like(p)
        factors[slips] = most[slips] / (self._law.k * size[slips])
        along = np.zeros_like(u)
        along[slips] = across[slips] / size[slips, np.newaxis]
        τ = self._law.k * factors[:, np.newaxis] * across
        return _Tractions(u, across, n, near, along, factors, slips, τ)

    def add_forces(self, H: Array, points: Weighted, p: Array, out: Array) -> None:
        """Add the friction forces to the residual."""
        self._add(H, self._tractions(H, points, p).τ, out)

    def add_of_ground(self, H: Array, points: Weighted, p: Array, out: Array) -> None:
        """Add forces between nodes and ground."""
        τ = self._tractions(H, points, p).τ
        self._add(H, np.where(self._slips.grounded[:, np.newaxis], τ, 0.0), out)

    def _add(self, H: Array, τ: Array, out: Array) -> None:
        slips = self._slips
        forces = np.einsum("kij,ki->kj", slips.motions(H, self._types), slips.on_nodes(τ))
        np.add.at(out, slips.nodes, forces)

    def at_points(self, H: Array, points: Weighted, p: Array) -> Array:
        """Friction forces on the first surface at the points, shape (m, 3)."""
        τ = self._tractions(H, points, p).τ
        mean = (points.of.shapes[:, :, np.newaxis] * τ[points.of.pressures]).sum(axis=1)
        return np.asarray(-points.weights[:, np.newaxis] * mean)

    def energy(self, H: Array, points: Weighted, p: Array) -> float:
        """Energy of the springs, J."""
        squares = (self._tractions(H, points, p).τ ** 2).sum(axis=1)
        return float(self._slips.lengths @ squares) / (2.0 * self._law.k)

    # --- derivatives ---

    def tangent(
        self, H: Array, points: Weighted, p: Array, by_pressure: csr_array
    ) -> tuple[csr_array, Indices, Array]:
        """Tangent stiffness: a matrix of all nodes, and blocks (k, 6, 6) of single nodes (k,).

        Args:
            H: Frames.
            points: Points.
            p: Pressures, shape (n,).
            by_pressure: Derivatives of the pressures in all twists, shape (n, 6 nodes).
        """
        found, slips, count = self._tractions(H, points, p), self._slips, len(self._types)
        U, N = slips.rows(H, self._types), self._normal_rows(H, points, (len(p), count))
        by_slip, by_normal = self._by_slip_and_normal(found)
        limits = self._law.μ * found.along[:, :, np.newaxis]
        δτ = _diagonal(by_slip) @ U + _diagonal(by_normal) @ N + _diagonal(limits) @ by_pressure
        weighted = U.multiply(np.repeat(slips.lengths, 3)[:, np.newaxis]).tocsr()
        # axes rotate along which forces are written
        blocks = np.zeros((len(slips.nodes), 6, 6))
        given = H, self._types, slips.nodes, slips.weights, slips.arms
        _add_turnings(*given, slips.on_nodes(found.τ), blocks)
        return (weighted.T @ δτ).tocsr(), slips.nodes, blocks

    def _by_slip_and_normal(self, of: _Tractions) -> tuple[Array, Array]:
        """Derivatives of ``τ`` in ``u`` and ``Σ w Φ ψ' n`` at constant limits, (n, 3, 3) each."""
        n, u, t, one = of.normals, of.slip, of.along, np.eye(3)
        across = one - n[:, :, np.newaxis] * n[:, np.newaxis]
        turned = (u * n).sum(axis=1)[:, np.newaxis, np.newaxis] * one
        turned = turned + n[:, :, np.newaxis] * u[:, np.newaxis]
        D = one - t[:, :, np.newaxis] * t[:, np.newaxis]
        D = (self._law.k * of.factors)[:, np.newaxis, np.newaxis] * D
        return D @ across, -D @ turned @ across / of.sizes[:, np.newaxis, np.newaxis]

    def _normal_rows(self, H: Array, points: Weighted, shape: tuple[int, int]) -> csr_array:
        """Derivatives of ``Σ w Φ ψ' n`` in all twists, shape (3 n, 6 nodes)."""
        rows = np.zeros((*points.nodes.shape, 3, 6))
        set_normal_rows(H, self._types, points.of.at, rows)
        rows *= points.weights[:, np.newaxis, np.newaxis, np.newaxis]
        changed = points.changes[:, np.newaxis] * points.normals
        rows += changed[:, np.newaxis, :, np.newaxis] * points.rows[:, :, np.newaxis]
        return summed(points.of, points.nodes, rows, shape)

    # --- steps ---

    def _set_springs(self, H: Array, τ: Array) -> None:
        """Set elongations to those of tractions."""
        slips, e = self._slips, τ / self._law.k
        nodes, own = slips.nodes[slips.springs], slips.pressures[slips.springs]
        slips.arms[slips.springs] = np.einsum("kij,kj->ki", H[nodes, 1:], e[own])
        others = (slips.lengths > 0.0) & ~slips.framed
        slips.fixed[others] += e[others]

    def accept(self, H: Array, points: Weighted, p: Array) -> None:
        """Let the points of frames ``H`` face each other, with springs that keep their traction."""
        found, before = self._tractions(H, points, p), self._slips.lengths
        # by the trapezoidal rule; springs store the rest of the work
        slip = found.across - found.τ / self._law.k
        done = 0.5 * ((self._before + found.τ) * slip).sum(axis=1)
        self.dissipated += float(before @ done)
        self._slips, self._before = _facing(H, self._types, points, len(p)), found.τ
        self._set_springs(H, found.τ)

    @property
    def state(self) -> Array:
        """State for checkpoints, flat."""
        slips = _packed(self._slips)
        return np.concatenate([[self.dissipated], self._before.ravel(), slips])

    def renumbered(self, values: Array, numbers: Indices) -> Array:
        """A state with other numbers of the nodes.

        Args:
            values: The state.
            numbers: New number of each node, shape (n,).
        """
        n = len(self._before)
        slips = _unpacked(values[1 + 3 * n :], n)
        slips = slips._replace(nodes=numbers[slips.nodes])
        return np.concatenate([values[: 1 + 3 * n], _packed(slips)])

    def restore(self, values: Array) -> None:
        """Restore the state that :attr:`state` returned."""
        n = len(self._before)
        self.dissipated = float(values[0])
        self._before = values[1 : 1 + 3 * n].reshape(n, 3).copy()
        self._slips = _unpacked(values[1 + 3 * n :], n)


def _diagonal(blocks: Array) -> bsr_array:
    """Block-diagonal matrix of blocks (n, r, c)."""
    n, r, c = blocks.shape
    return bsr_array((blocks, np.arange(n), np.arange(n + 1)), shape=(n * r, n * c))


def _facing(H: Array, types: Indices, points: Weighted, count: int) -> Slips:
    """Slips of the points of a state, with springs that are not elongated."""
    of, m = points.of, len(points.of.at.pairs)
    anchors = empty_anchors(m)
    set_anchors(H, H, types, of.at, of.at.a, of.at.b, np.zeros((m, 3)), anchors)
    lengths = points.means(np.ones((m, 1)), count)[:, 0]
    each = of.shapes * points.weights[:, np.newaxis]
    per = np.divide(each, lengths[of.pressures], out=np.zeros_like(each), where=each != 0.0)
    fixed = np.zeros((count, 3))
    np.add.at(fixed, of.pressures, per[:, :, np.newaxis] * anchors.fixed[:, np.newaxis])
    e, side, s = np.nonzero((per != 0.0)[:, :, np.newaxis] & (anchors.nodes >= 0)[:, np.newaxis])
    A, node = of.pressures[e, side], anchors.nodes[e, s]
    w = per[e, side] * anchors.weights[e, s]
    c = per[e, side, np.newaxis] * anchors.arms[e, s]
    at = of.at
    on_ground = (at.a.owners[at.pairs[:, 0]] < 0) | (at.b.owners[at.pairs[:, 1]] < 0)
    grounded = np.zeros(count, dtype=np.bool_)
    grounded[of.pressures[on_ground & (points.weights > 0.0)]] = True
    rotates = types[node] < POSITION_GRADIENT
    carriers, framed = _carriers(A[rotates], node[rotates], np.abs(w[rotates]), count, len(H))
    held = np.flatnonzero(framed)
    carriers, zero = carriers[held], np.zeros(len(held))
    slips = Slips(A, node, w, c, fixed, lengths, grounded, framed)
    return slips._replace(
        pressures=np.concatenate([A, held]),
        nodes=np.concatenate([node, carriers]),
        weights=np.concatenate([w, zero]),
        arms=np.concatenate([c, np.zeros((len(held), 3))]),
    )


def _carriers(A: Indices, node: Indices, w: Array, count: int, nodes: int) -> tuple[Indices, Flags]:
    """Node with the largest weight in each slip, and whether there is one, shapes (count,)."""
    total = coo_array((w, (A, node)), (count, nodes)).tocsr()
    some = np.asarray(total.sum(axis=1)).ravel() > 0.0
    return np.asarray(total.argmax(axis=1)).ravel().astype(np.int64), some
