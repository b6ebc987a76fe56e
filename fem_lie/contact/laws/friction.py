"""Friction of one penalty contact: tractions from step to step, and their derivatives."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined_uncounted
from fem_lie.contact.laws import friction_over_steps as over_steps
from fem_lie.contact.laws.anchors import (
    Anchors,
    CoulombLaw,
    Traction,
    add_tractions,
    empty_anchors,
    found,
    limit,
    packed,
    set_anchors,
    set_rows,
    slip_work,
    stretch_of,
    traction,
    tractions,
    unpacked,
)
from fem_lie.contact.laws.derivatives import (
    add_turning,
    column,
    derivatives,
    set_derivatives,
    store_motion,
)
from fem_lie.contact.sides.kinematics import SLOTS, contact_point
from fem_lie.contact.sides.table import ContactPoints
from fem_lie.contact.sides.two_sides import Sides, Stations
from fem_lie.forms.abilities import FRICTION_COLUMNS, Done, Ends
from fem_lie.lie.tuples import Vector, combined, dot, load_row, scaled


@inlined_uncounted
def _change(
    law: CoulombLaw, t: Traction, n: Vector, u: Vector, δu: Vector, δn: Vector, δg: float
) -> Vector:
    """Variation of a traction."""
    δacross = combined(1.0, δu, -dot(n, δu) - dot(δn, u), n)
    δacross = combined(1.0, δacross, -dot(n, u), δn)
    if not t.slips:
        return scaled(law.holding, δacross)
    turned = combined(1.0, δacross, -dot(t.along, δacross), t.along)
    return combined(dot(t.τ, t.along) / t.size, turned, limit(law, -δg), t.along)


@compiled
def add_traction_tangents(
    H: Array,
    types: Indices,
    at: ContactPoints,
    anchors: Anchors,
    which: Indices,
    law: CoulombLaw,
    given: over_steps.Slips,
    blocks: Array,
) -> None:
    """Add derivatives of the friction forces in twists, for anchors on the nodes of the pair.

    ``given`` are the variables of a step for forces of a step, where tractions depend on the end of
    the step and all else on its midpoint, so that their derivative has a factor of two; those of no
    pair for forces at frames.
    """
    over_step, by = given.gaps.shape[0] > 0, derivatives()
    A, T = np.zeros((SLOTS, 3, 6)), np.zeros((SLOTS, 3, 6))
    for e in range(at.pairs.shape[0]):
        q, weight = which[e], at.weight[e]
        point = contact_point(H, at.a, at.b, at.pairs[e, 0], at.pairs[e, 1], at.kind)
        g, n = point.gap, point.normal
        if over_step and q >= 0:
            g, n = given.gaps[e], load_row(given.normals, e)
        if g >= 0.0 or q < 0:
            continue
        scale, nodes = set_derivatives(H, types, at, e, point, by), by.nodes
        if _others(nodes, anchors.nodes[q]):
            continue
        u = load_row(given.stretches, e) if over_step else stretch_of(H, anchors, q)
        t, fraction = traction(law, g, n, u), 2.0 * weight if over_step else weight
        for s in range(SLOTS):
            if nodes[s] >= 0:
                c, node = load_row(anchors.arms[q], s), nodes[s]
                store_motion(types[node], H[node], 1.0, anchors.weights[q, s], c, A[s])
                for p in range(6):
                    δu, δn = column(A[s], p), scaled(1.0 / scale, column(by.N[s], p))
                    δτ = _change(law, t, n, u, δu, δn, by.rows[s, p])
                    T[s, 0, p], T[s, 1, p], T[s, 2, p] = δτ
        block = at.first[e]
        for s in range(SLOTS):
            for o in range(SLOTS):
                if nodes[s] < 0 or nodes[o] < 0:
                    continue
                for p in range(6):
                    for r in range(6):
                        total = dot(column(A[s], p), column(T[o], r))
                        blocks[block, p, r] += fraction * total
                if s == o:
                    f, w = scaled(weight, t.τ), anchors.weights[q, s]
                    c, node = load_row(anchors.arms[q], s), nodes[s]
                    add_turning(types[node], H[node], f, w, c, blocks[block])
                block += 1


@inlined_uncounted
def _others(nodes: Indices, own: Indices) -> bool:
    """Whether the anchor has moved on to other elements than those of the pair."""
    for s in range(SLOTS):
        if nodes[s] != own[s] and (nodes[s] >= 0 or own[s] >= 0):
            return True
    return False


class Friction:
    """Tangential springs that slip, between anchors on both sides.

    Attributes:
        dissipated: Energy dissipated by slip in all accepted steps, except in those of conserving
            schemes, which account for it themselves, J.
    """

    def __init__(self, sides: Sides, law: CoulombLaw, types: Indices, H: Array) -> None:
        """Set anchors for all pairs that are near each other.

        Args:
            sides: Both sides of the contact.
            law: Constants of the law; per length for lines.
            types: Types of all nodes, shape (n,).
            H: Initial frames.
        """
        self._sides, self._law, self._types = sides, law, types
        self._anchors = empty_anchors(0)
        self._ahead: tuple[Indices, Array] | None = None
        self.dissipated = 0.0
        self.accept(H)

    def _tractions(self, H: Array) -> tuple[Stations, Indices, Array]:
        """Pairs, index of their anchors, and tractions (m, 3)."""
        stations = self._sides.stations(H)
        which, τ = found(self._anchors.keys, stations.keys), np.empty((len(stations.keys), 3))
        tractions(H, stations.at, self._anchors, which, self._law, τ)
        return stations, which, τ

    def add_forces(self, H: Array, out: Array, *, grounded: bool = False) -> None:
        """Add all friction forces, or those of pairs with ground, to ``out`` (≥ nodes, 6)."""
        stations, which, τ = self._tractions(H)
        add_tractions(H, self._types, stations.at, self._anchors, which, τ, grounded, out)

    def energy(self, H: Array) -> float:
        """Energy stored in the tangential springs."""
        stations, _, τ = self._tractions(H)
        weight = stations.at.weight[: len(τ)]
        return 0.5 / self._law.holding * float((τ * τ).sum(axis=1) @ weight)

    def add_tangent(self, H: Array, blocks: Array) -> None:
        """Add derivatives of the friction forces to the blocks of pairs of nodes."""
        stations = self._sides.stations(H)
        which = found(self._anchors.keys, stations.keys)
        none = over_steps.empty_slips(0)
        given = H, self._types, stations.at, self._anchors, which, self._law, none
        add_traction_tangents(*given, blocks)

    def accept(self, H: Array) -> None:
        """Set new anchors at frames ``H``, with springs that keep their present elongation."""
        (at, keys, a, b), _, τ = self._tractions(H)
        over_step = self._ahead is not None
        if self._ahead is not None:
            known, over = self._ahead
            # pairs without anchors have index −1, the last row
            τ = np.concatenate([over, np.zeros((1, 3))])[found(known, keys)]
            self._ahead = None
        springs: Array = np.asarray(τ / self._law.holding)
        forces = at.weight[: len(τ), np.newaxis] * τ
        if not over_step:
            now = found(keys, self._anchors.keys)
            self.dissipated += slip_work(H, self._anchors, now, forces, springs)
        anchors = empty_anchors(len(at.pairs))
        set_anchors(H, at, a, b, springs, anchors)
        anchors.keys[:], anchors.forces[:] = keys, forces
        self._anchors = anchors

    def rows(self, H: Array) -> Array:
        """Friction forces in the last accepted state, with frames ``H``, shape (k, 9).

        Columns are those of :meth:`~fem_lie.forms.abilities.PathDependence.friction_forces`.
        """
        at, keys, *_ = self._sides.stations(H)
        which = found(self._anchors.keys, keys)
        rows = np.zeros((len(keys), FRICTION_COLUMNS))
        set_rows(H, at, self._anchors, which, rows)
        return rows[rows[:, 6:].any(axis=1)]

    # --- over a step of points and balls ---

    def add_over_step(self, ends: Ends, at: ContactPoints, out: Array, ground: Array) -> Done:
        """Add tractions of a step; :meth:`accept` keeps their springs for the next step."""
        arms, _, over = self._over_step(ends, at)
        self._ahead = at.pairs.copy(), over.τ
        over_steps.add_over_step(ends, at, arms, over.τ, out, ground)
        return Done(*over_steps.energies(self._law, at, over))

    def add_tangent_over_step(self, ends: Ends, at: ContactPoints, H: Array, blocks: Array) -> None:
        """Add twice the derivative of the tractions of a step in midpoint frames ``H``."""
        arms, which, over = self._over_step(ends, at)
        given = H, self._types, at, arms, which, self._law, over
        add_traction_tangents(*given, blocks)

    def _over_step(
        self, ends: Ends, at: ContactPoints
    ) -> tuple[Anchors, Indices, over_steps.Slips]:
        m = len(at.pairs)
        which, arms = found(self._anchors.keys, at.pairs), empty_anchors(m)
        over = over_steps.empty_slips(m)
        over_steps.set_over_step(ends, at, self._anchors, which, self._law, arms, over)
        return arms, np.where(which >= 0, np.arange(m), -1), over

    @property
    def linearised_values(self) -> Array:
        """The dissipated energy and all anchors as a flat array, for checkpoints."""
        return np.concatenate([[self.dissipated], packed(self._anchors)])

    def restore(self, values: Array) -> None:
        """Restore the anchors that :attr:`linearised_values` returned."""
        self._ahead = None
        self.dissipated, self._anchors = float(values[0]), unpacked(values[1:])
