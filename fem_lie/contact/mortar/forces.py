"""Contact forces of mortar contact, by penalty and by Lagrange multipliers.

Along the first line with arc length ``s``, the pressure is ``p = Σ Φ_A p_A`` with linear shape
functions ``Φ_A``. Each node has one gap, and one pressure by the augmented Lagrangian::

    g_A = ∫ Φ_A ψ(g) ds / w_A,  w_A = ∫ Φ_A ds,  p_A = max(0, λ_A − k g_A)
    Π = Σ w_A (p_A² − λ_A²)/(2 k),  δΠ = −Σ p_A ∫ Φ_A ψ' δg ds

With ``λ_A = 0`` this is a penalty on the mean gap of a node. A multiplier is updated to ``p_A``
where the solver updates independent stress, so that Newton's method ends at ``g_A = 0`` where
``p_A > 0``; the forces then do not depend on ``k``. Its tangent has the geometric stiffness of
``λ_A``: for large ``k`` this is Newton's method on the saddle point, with the active set of
``λ_A − k g_A > 0``. Gaps beyond ``c``, the least radius, count as ``c``, so that points that are
not near each other need not be known; parts of the first line that face a free end of the second
have no pressure and no gap.

Puso & Laursen, Comput. Methods Appl. Mech. Engrg. 193 (2004) 601; Alart & Curnier, ibid. 92 (1991)
353.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array, csr_array

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled
from fem_lie.contact.laws.energy import PenaltyConstants
from fem_lie.contact.laws.law import ContactTerm, FrictionConstants
from fem_lie.contact.laws.over_steps import empty_secants
from fem_lie.contact.laws.tangents import tangents
from fem_lie.contact.mortar.friction import MortarFriction, Weighted, summed
from fem_lie.contact.mortar.sides import MortarPoints, MortarSides
from fem_lie.contact.sides.kinematics import SLOTS, contact_point, pulled_back, slot, touched
from fem_lie.contact.sides.table import ContactPoints
from fem_lie.forms.abilities import (
    FRICTION_COLUMNS,
    GroundForces,
    LinearisedStress,
    PassageCheck,
    PassedThroughError,
    PathDependence,
)
from fem_lie.forms.term import Pairs
from fem_lie.lie.tuples import scaled, store, store_row

_CLOSED = 1e-12
"""Mean gap over the least radius up to which a node without pressure is in contact."""


@compiled
def set_gap_rows(
    H: Array, types: Indices, at: ContactPoints, g: Array, nodes: Indices, rows: Array, X: Array
) -> None:
    """Set gaps, their derivatives in twists, and points on the first surface.

    Args:
        H: Nodal coordinates.
        types: Types of all nodes, shape (n,).
        at: Contact points.
        g: Gaps, overwritten, shape (m,).
        nodes: Nodes of each gap, −1 where there is none, overwritten, shape (m, s).
        rows: Derivatives in the twists of these nodes, zero on entry, shape (m, s, 6).
        X: Points on the surface and normals, overwritten, shape (m, 2, 3).
    """
    for e in range(at.pairs.shape[0]):
        i, j = at.pairs[e]
        point = contact_point(H, at.a, at.b, i, j, at.kind)
        g[e] = point.gap
        store_row(X[e], 0, touched(at.a, i, point))
        store_row(X[e], 1, point.normal)
        for s in range(SLOTS):
            node, sign, w, c = slot(H, at.a, at.b, i, j, at.kind, point, s)
            nodes[e, s] = max(node, -1)
            if node >= 0:
                force, moment = pulled_back(types[node], H[node], w, c, scaled(sign, point.normal))
                store(rows[e, s], 0, force)
                store(rows[e, s], 3, moment)


class _Limited(NamedTuple):
    """Limited gaps ``ψ(g)`` with two derivatives, each of shape (m,)."""

    ψ: Array
    slope: Array
    bend: Array


def limited(g: Array, c: float) -> _Limited:
    """Limited gaps.

    Args:
        g: Gaps, shape (m,).
        c: Gap from which on all count as ``c/2``.
    """
    t = np.clip(g / c, 0.0, 1.0)
    ψ = np.minimum(g, 0.0) + c * (t - t**3 + 0.5 * t**4)
    return _Limited(ψ, 1.0 - 3.0 * t**2 + 2.0 * t**3, np.asarray(6.0 * (t**2 - t) / c))


class _Found(NamedTuple):
    """Points of a state with their gaps.

    Attributes:
        of: The points.
        gaps: Gaps at the points, shape (m,).
        nodes: Nodes of each gap, shape (m, s).
        rows: Derivatives of the gaps, shape (m, s, 6).
        positions: Points on the first surface, shape (m, 3).
        normals: Normals out of the second surface, shape (m, 3).
        limited: Limited gaps; their slope and bend are zero beyond the second line.
        means: Mean gap of each pressure, shape (n,).
    """

    of: MortarPoints
    gaps: Array
    nodes: Indices
    rows: Array
    positions: Array
    normals: Array
    limited: _Limited
    means: Array

    def at_points(self, p: Array) -> Array:
        """Integration weights times pressures (n,) at the points, shape (m,)."""
        return np.asarray(self.of.at.weight * (self.of.shapes * p[self.of.pressures]).sum(axis=1))

    def forces(self, p: Array) -> Array:
        """Forces of pressures (n,) at the points, shape (m,)."""
        return np.asarray(self.at_points(p) * self.limited.slope)

    @property
    def weighted(self) -> Weighted:
        """The points with the weights of their forces."""
        weights, changes = (
            self.of.at.weight * each for each in (self.limited.slope, self.limited.bend)
        )
        return Weighted(self.of, weights, changes, self.rows, self.nodes, self.normals)


class MortarForces(ContactTerm, PassageCheck, GroundForces, LinearisedStress, PathDependence):
    """Contact forces by a penalty on the mean gaps of nodes."""

    label = "mortar contacts"
    in_space = True

    def __init__(
        self,
        sides: MortarSides,
        stiffness: float,
        types: Indices,
        name: str,
        friction: FrictionConstants | None = None,
    ) -> None:
        """Store both sides.

        Args:
            sides: Both sides of the contact.
            stiffness: ``k``, force per length of the first line and gap.
            types: Types of all nodes of the bodies, in the order of their numbers, shape (n,).
            name: Name for messages.
            friction: Constants of friction; default: none.
        """
        self._sides, self._k, self._types, self._name = sides, stiffness, types, name
        self._friction: MortarFriction | None = None
        if friction is not None:
            self._friction = MortarFriction(len(sides.lengths), friction, types)
            self.friction, self.label = True, f"{self.label} with friction"
        self.multipliers: Array = np.zeros(len(sides.lengths))
        self._known, self._pairs, self._keys = -1, _no_pairs(), np.empty(0, dtype=np.int64)

    @property
    def passage(self) -> PassageCheck:
        """Check whether surfaces pass through each other."""
        return self

    @property
    def stress_update(self) -> LinearisedStress | None:
        """State of friction, if there is any."""
        return self if self._friction is not None else None

    @property
    def path(self) -> PathDependence | None:
        """Path dependence by friction."""
        return self if self._friction is not None else None

    @property
    def ground(self) -> GroundForces | None:
        """Forces on ground, if a side is fixed to ground."""
        return self if self._sides.sides.on_ground else None

    # --- pattern ---

    @property
    def version(self) -> int:  # type: ignore[override]
        """Version of the list of pairs."""
        return self._sides.near.version

    @property
    def pairs(self) -> Pairs:
        """Pairs of nodes that a pressure couples."""
        if self._known != self.version:
            self._known = self.version
            A, nodes = self._sides.couplings
            n = len(self._types)
            by = coo_array((np.ones(len(A)), (A, nodes)), (len(self.multipliers), n)).tocsr()
            coupled = (by.T @ by).tocoo()
            self._keys = np.sort(coupled.row.astype(np.int64) * n + coupled.col)
            self._pairs = self._keys // max(n, 1), self._keys % max(n, 1)
        return self._pairs

    @property
    def pair_positions(self) -> Array:
        """State of the list of pairs, for checkpoints."""
        return self._sides.near.pair_positions

    def restore_pairs(self, pair_positions: Array) -> None:
        """Restore the list of pairs."""
        self._sides.near.restore_pairs(pair_positions)

    # --- pressures ---

    def _gaps(self, H: Array) -> _Found:
        """Points with gaps, and the mean gaps of the nodes."""
        of = self._sides.points(H)
        m, c, lengths = len(of.at.pairs), self._sides.radius, self._sides.lengths
        g, nodes = np.empty(m), np.empty((m, SLOTS), dtype=np.int64)
        rows, X = np.zeros((m, SLOTS, 6)), np.empty((m, 2, 3))
        set_gap_rows(H, self._types, of.at, g, nodes, rows, X)
        ψ = _Limited(*(np.where(of.beyond, 0.0, each) for each in limited(g, c)))
        less = of.at.weight * (ψ.ψ - 0.5 * c)
        total = 0.5 * c * lengths
        np.add.at(total, of.pressures, of.shapes * less[:, np.newaxis])
        return _Found(of, g, nodes, rows, X[:, 0], X[:, 1], ψ, total / lengths)

    def _pressures(self, found: _Found) -> tuple[Array, Flags]:
        """Pressures of the nodes (n,), and which of them are in contact."""
        p = self.multipliers - self._k * found.means
        closed = p >= -self._k * _CLOSED * self._sides.radius
        return np.where(closed, np.maximum(p, 0.0), 0.0), closed

    def pressures(self, H: Array) -> Array:
        """Contact force per length at the nodes of the line, shape (n,), N/m."""
        return self._pressures(self._gaps(H))[0]

    def mean_gaps(self, H: Array) -> Array:
        """Mean gaps of the nodes of the line, shape (n,), m."""
        return self._gaps(H).means

    # --- forces ---

    def energy(self, H: Array) -> float:
        """Potential of the forces at constant multipliers, J."""
        found = self._gaps(H)
        p = self._pressures(found)[0]
        squares = p * p - self.multipliers * self.multipliers
        held = 0.0 if self._friction is None else self._friction.energy(H, found.weighted, p)
        return float(self._sides.lengths @ squares) / (2.0 * self._k) + held

    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """Add the contact forces to the residual."""
        found = self._gaps(H)
        p = self._pressures(found)[0]
        _add(found, found.forces(p), out)
        if self._friction is not None:
            self._friction.add_forces(H, found.weighted, p, out)

    def add_of_ground(self, H: Array, v: Array, out: Array) -> None:
        """Add forces between nodes and ground."""
        found = self._gaps(H)
        p, at = self._pressures(found)[0], found.of.at
        grounded = (at.a.owners[at.pairs[:, 0]] < 0) | (at.b.owners[at.pairs[:, 1]] < 0)
        _add(found, np.where(grounded, found.forces(p), 0.0), out)
        if self._friction is not None:
            self._friction.add_of_ground(H, found.weighted, p, out)

    def tangent(self, H: Array, kept: Array) -> Array:
        """Tangent stiffness of each pair of nodes."""
        found = self._gaps(H)
        p, closed = self._pressures(found)
        blocks, rows = np.zeros((len(self.pairs[0]), 6, 6)), self._rows(found)
        by_pressure = self._by_pressure(rows, closed)
        self._add_matrix(-(rows.T @ by_pressure), blocks)
        self._add_geometric(H, found, found.at_points(self._geometric_pressures(p)), blocks)
        if self._friction is not None:
            K, nodes, own = self._friction.tangent(H, found.weighted, p, by_pressure)
            self._add_matrix(K, blocks)
            self._add_blocks(nodes, nodes, own, blocks)
        return blocks

    def _geometric_pressures(self, p: Array) -> Array:
        """Pressures of the geometric stiffness."""
        return p

    def _by_pressure(self, rows: csr_array, closed: Flags) -> csr_array:
        """Derivatives of the pressures in all twists, shape (n, 6 nodes)."""
        factors = np.where(closed, -self._k / self._sides.lengths, 0.0)
        return rows.multiply(factors[:, np.newaxis]).tocsr()

    def _rows(self, found: _Found) -> csr_array:
        """Derivatives of ``w_A g_A`` in the twists of all nodes, shape (n, 6 nodes)."""
        by_gap = found.of.at.weight * found.limited.slope
        rows = by_gap[:, np.newaxis, np.newaxis, np.newaxis] * found.rows[:, :, np.newaxis]
        return summed(found.of, found.nodes, rows, (len(self.multipliers), len(self._types)))

    def _add_matrix(self, K: csr_array, blocks: Array) -> None:
        """Add a matrix (6 nodes, 6 nodes)."""
        K = K.tocoo()
        at, known = self._positions(K.row // 6, K.col // 6)
        entries = at[known], K.row[known] % 6, K.col[known] % 6
        np.add.at(blocks, entries, K.data[known])

    def _add_blocks(self, rows: Indices, columns: Indices, own: Array, blocks: Array) -> None:
        """Add blocks (k, 6, 6) of pairs of nodes."""
        at, known = self._positions(rows, columns)
        np.add.at(blocks, at[known], own[known])

    def _positions(self, rows: Indices, columns: Indices) -> tuple[Indices, Flags]:
        """Positions of pairs of nodes among :attr:`pairs`, and which of them are there.

        Friction springs may be on nodes of elements that are not near any more.
        """
        if not len(self._keys):
            return np.zeros(len(rows), dtype=np.int64), np.zeros(len(rows), dtype=np.bool_)
        keys = rows.astype(np.int64) * len(self._types) + columns
        at = np.minimum(np.searchsorted(self._keys, keys), len(self._keys) - 1)
        return at, self._keys[at] == keys

    def _add_geometric(self, H: Array, found: _Found, f: Array, blocks: Array) -> None:
        """Add the derivatives of the forces at constant pressures, ``f`` (m,) at the points."""
        moves, at = found.nodes >= 0, found.of.at
        both = moves[:, :, np.newaxis] & moves[:, np.newaxis]
        counts = both.sum(axis=(1, 2))
        own = np.zeros((int(counts.sum()), 6, 6))
        first = np.cumsum(counts) - counts
        none = PenaltyConstants(1.0, 0.0, 0.0)
        over = empty_secants(len(f))
        p = np.divide(f, at.weight, out=np.zeros_like(f), where=f > 0.0)
        over.by_gap[:], over.σ[:] = -p * found.limited.bend, -p * found.limited.slope
        still = np.zeros((len(H), 6))
        given = H, still, self._types, at._replace(first=first), none, False, over
        tangents(*given, own, np.zeros((0, 6, 6)))
        e, s, t = np.nonzero(both)
        acts = over.σ[e] != 0.0
        e, s, t = e[acts], s[acts], t[acts]
        self._add_blocks(found.nodes[e, s], found.nodes[e, t], own[acts], blocks)

    # --- results ---

    def _shown(self, H: Array) -> tuple[Indices, Array, Array, Array]:
        found = self._gaps(H)
        f = found.forces(self._pressures(found)[0])
        some = f > 0.0
        F = f[some, np.newaxis] * found.normals[some]
        return found.of.at.pairs[some].copy(), found.gaps[some], found.positions[some], F

    def touching(self, H: Array, v: Array) -> tuple[Indices, Array, Array, Array]:
        """Integration points with forces: numbers, gaps, positions and forces on the line."""
        return self._shown(H)

    # --- steps ---

    def accept(self, H: Array, start: Array | None = None) -> None:
        """Accept the present tractions of friction."""
        if self._friction is not None:
            found = self._gaps(H)
            self._friction.accept(H, found.weighted, self._pressures(found)[0])

    @property
    def dissipated(self) -> float:
        """Energy dissipated by friction."""
        return 0.0 if self._friction is None else self._friction.dissipated

    def friction_forces(self, H: Array, v: Array) -> Array:
        """Friction forces in the last accepted state, columns of the base class, shape (k, 9)."""
        if self._friction is None:
            return super().friction_forces(H, v)
        found = self._gaps(H)
        p = self._pressures(found)[0]
        return _shown_rows(found, self._friction.at_points(H, found.weighted, p))

    # --- state ---

    @property
    def linearised_values(self) -> Array:
        """State of friction."""
        return np.empty(0) if self._friction is None else self._friction.state

    def restore(self, values: Array) -> None:
        """Restore the state of friction."""
        if self._friction is not None:
            self._friction.restore(values)

    def _renumbered(self, values: Array, numbers: Indices) -> Array:
        """State of friction, whose slips are of nodes, with other numbers."""
        return values if self._friction is None else self._friction.renumbered(values, numbers)

    def update_stress(self, H: Array, h: Array) -> None:
        """Do nothing: springs of a penalty change when frames are accepted."""

    def reset_stress(self, H: Array) -> None:
        """Do nothing: springs of a penalty change when frames are accepted."""

    def clear_stress(self) -> None:
        """Do nothing: springs of a penalty change when frames are accepted."""

    def check_passage(self, start: Array, end: Array) -> None:
        """Raise ``PassedThroughError`` if surfaces passed through each other in the step."""
        if (found := self._sides.passed(start, end)) is not None:
            raise PassedThroughError(self._name, *found)

    def watch(self, start: Array, end: Array, h: float, middle: Array | None) -> None:
        """Do nothing: a mortar contact keeps no energy balance of its own."""

    @property
    def watched(self) -> Array:
        """Empty."""
        return np.empty(0)

    def watch_again(self, watched: Array) -> None:
        """Do nothing."""


class MultiplierForces(MortarForces):
    """Contact forces by multipliers, which are independent unknowns like an independent stress."""

    label = "mortar contacts with multipliers"
    friction = True

    @property
    def stress_update(self) -> LinearisedStress:
        """The multipliers."""
        return self

    @property
    def path(self) -> PathDependence:
        """The multipliers of the last accepted state."""
        return self

    @property
    def linearised_values(self) -> Array:
        """The multipliers."""
        return self.multipliers

    def restore(self, values: Array) -> None:
        """Restore the multipliers."""
        self.multipliers = values.copy()

    def update_stress(self, H: Array, h: Array) -> None:
        """Update the multipliers to the pressures that are linear in the increment."""
        found = self._gaps(H)
        closed = self._pressures(found)[1]
        by_pressure = self._by_pressure(self._rows(found), closed)
        size = min(len(h), len(self._types))
        change = by_pressure[:, : 6 * size] @ h[:size].ravel()
        p = self.multipliers - self._k * found.means + change
        self.multipliers = np.where(closed, np.maximum(p, 0.0), 0.0)

    def _geometric_pressures(self, p: Array) -> Array:
        """The multipliers: Newton's method on the saddle point, to which ``k g`` is no pressure."""
        return self.multipliers

    def clear_stress(self) -> None:
        """Set the multipliers to zero."""
        self.multipliers = np.zeros_like(self.multipliers)

    def accept(self, H: Array, start: Array | None = None) -> None:
        """Accept the pressures as multipliers of the next step."""
        self.multipliers = self.pressures(H)

    def touching(self, H: Array, v: Array) -> tuple[Indices, Array, Array, Array]:
        """Nothing: frames do not determine the forces, which :meth:`friction_forces` returns."""
        return np.empty((0, 2), dtype=np.int64), np.empty(0), np.empty((0, 3)), np.empty((0, 3))

    def friction_forces(self, H: Array, v: Array) -> Array:
        """Contact forces in the last accepted state, columns of the base class, shape (k, 9)."""
        found = self._gaps(H)
        return _shown_rows(found, found.forces(self.multipliers)[:, np.newaxis] * found.normals)


def _shown_rows(found: _Found, F: Array) -> Array:
    """Rows of points with forces ``F`` (m, 3) on the line, shape (k, 9)."""
    rows = np.empty((len(F), FRICTION_COLUMNS))
    rows[:, :2], rows[:, 2] = found.of.at.pairs, found.gaps
    rows[:, 3:6], rows[:, 6:] = found.positions, F
    return rows[F.any(axis=1)]


def _no_pairs() -> Pairs:
    none = np.empty(0, dtype=np.int64)
    return none, none


def _add(found: _Found, f: Array, out: Array) -> None:
    """Add forces (m,) of the points to the residual."""
    e, s = np.nonzero((found.nodes >= 0) & (f[:, np.newaxis] != 0.0))
    np.add.at(out, found.nodes[e, s], -f[e, np.newaxis] * found.rows[e, s])
