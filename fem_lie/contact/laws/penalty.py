"""Contact forces of a penalty, as a term on all nodes."""

from __future__ import annotations

import logging
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, uncounted
from fem_lie.contact.laws.energy import EnergyWatch, PenaltyConstants, damping
from fem_lie.contact.laws.friction import Friction, renumbered
from fem_lie.contact.laws.law import ContactTerm, Penalty
from fem_lie.contact.laws.over_steps import (
    add_of_both_ends,
    add_of_start,
    empty_secants,
    set_secants,
)
from fem_lie.contact.laws.tangents import normal_rows, speed_of, tangents
from fem_lie.contact.sides.kinematics import (
    SLOTS,
    add_pulled_back,
    contact_point,
    slot,
    touched,
)
from fem_lie.contact.sides.table import GROUND, ContactPoints, KeptTable, contact_points_of
from fem_lie.contact.sides.two_sides import Sides, copied
from fem_lie.forms.abilities import (
    Done,
    Ends,
    GroundForces,
    LinearisedStress,
    LowRankTangent,
    PassageCheck,
    PassedThroughError,
    PathDependence,
    StepForces,
    StiffRows,
    ViscousForces,
)
from fem_lie.forms.term import Pairs
from fem_lie.lie.tuples import scaled, store_row

_log = logging.getLogger(__name__)

_DEEP = 0.1
"""Overlap over the least radius beyond which a message is logged, once."""


_COMPARED = 20
"""Steps in contact after which the points of friction are compared with those of the overlap."""

_UNEVEN = 4.0
"""Largest ratio of their energies, either way."""

_NONE = empty_secants(0)


class Normal(NamedTuple):
    """Gaps and forces of all pairs along the normal, each of shape (m,).

    Attributes:
        gaps: Gaps.
        elastic: Elastic forces.
        damping: Damping forces.
    """

    gaps: Array
    elastic: Array
    damping: Array

    @property
    def forces(self) -> Array:
        """Elastic and damping forces."""
        return np.asarray(self.elastic + self.damping)


@uncounted
def _measure(
    H: Array,
    v: Array,
    types: Indices,
    at: ContactPoints,
    law: PenaltyConstants,
    viscous: bool,
    out: Normal,
) -> None:
    """Set gaps and forces of all pairs along the normal."""
    for e in range(at.pairs.shape[0]):
        point = contact_point(H, at.a, at.b, at.pairs[e, 0], at.pairs[e, 1], at.kind)
        g = point.gap
        out.gaps[e], out.elastic[e], out.damping[e] = g, 0.0, 0.0
        if g < 0.0:
            out.elastic[e] = at.weight[e] * law.k * g
            if viscous:
                speed = speed_of(H, v, types, at, e, point)
                out.damping[e] = at.weight[e] * damping(law, g, speed)[0]


@compiled
def _add(
    H: Array,
    v: Array,
    types: Indices,
    table: Indices,
    law: PenaltyConstants,
    parts: tuple[bool, bool],
    grounded: bool,
    out: Array,
) -> None:
    """Add the forces of all pairs, or of pairs with ground only, to ``out``.

    ``parts``: whether the elastic and the damping forces count.
    """
    at, (elastic, viscous) = contact_points_of(table), parts
    for e in range(at.pairs.shape[0]):
        i, j = at.pairs[e]
        if grounded and at.a.owners[i] != GROUND and at.b.owners[j] != GROUND:
            continue
        point = contact_point(H, at.a, at.b, i, j, at.kind)
        if point.gap >= 0.0:
            continue
        f = at.weight[e] * law.k * point.gap if elastic else 0.0
        if viscous:
            speed = speed_of(H, v, types, at, e, point)
            f += at.weight[e] * damping(law, point.gap, speed)[0]
        if f == 0.0:
            continue
        for s in range(SLOTS):
            node, sign, w, c = slot(H, at.a, at.b, i, j, at.kind, point, s)
            if node >= 0:
                force = scaled(sign * f, point.normal)
                add_pulled_back(types[node], H[node], w, c, force, out[node])


@compiled
def _stored(H: Array, table: Indices, k: float) -> tuple[float, float]:
    """Energy of the overlaps, and the largest overlap."""
    at, total, most = contact_points_of(table), 0.0, 0.0
    for e in range(at.pairs.shape[0]):
        g = contact_point(H, at.a, at.b, at.pairs[e, 0], at.pairs[e, 1], at.kind).gap
        # the sum must not depend on near pairs that do not touch: their list is longer or shorter
        # in a resumed run
        if g < 0.0:
            total += at.weight[e] * k * g * g
            most = max(most, -g)
    return 0.5 * total, most


@uncounted
def _show(H: Array, at: ContactPoints, f: Array, X: Array, F: Array) -> None:
    """Closest points of the first side, and contact forces on it."""
    for e in range(at.pairs.shape[0]):
        i, j = at.pairs[e]
        point = contact_point(H, at.a, at.b, i, j, at.kind)
        store_row(X, e, touched(at.a, i, point))
        store_row(F, e, scaled(-f[e], point.normal))


class PenaltyForces(
    ContactTerm,
    ViscousForces,
    LinearisedStress,
    PathDependence,
    PassageCheck,
    StepForces,
    LowRankTangent,
    GroundForces,
):
    """Contact forces of one contact by penalty, with viscous damping forces."""

    label = "contacts by penalty"
    in_space = True

    def __init__(
        self,
        sides: Sides,
        law: Penalty,
        types: Indices,
        name: str = "a contact",
        friction: Friction | None = None,
        *,
        parts: bool = False,
    ) -> None:
        """Store both sides and the law.

        Args:
            sides: Both sides of the contact.
            law: Contact law; its constants are per length for lines.
            types: Types of all nodes of the bodies, in the order of their numbers, shape (n,).
            name: Name for messages.
            friction: Friction of the law; default: none.
            parts: Whether some pairs are ignored until they separate.
        """
        self._sides, self._name, self._allowed = sides, name, _DEEP * sides.radius
        self._types = types
        self._table, self._both = KeptTable(), (KeptTable(), KeptTable())
        self._law = law.normal
        self._damped = law.damping > 0.0
        self._friction, self.friction = friction, friction is not None
        self._compared, self._energies, self._stored = 0, np.zeros(2), 0.0
        self._watch = EnergyWatch(name, self._law, self._now)
        self.ignores = parts
        # free flight of conserving steps does not detect when ignored pairs separate
        self.conserved = not (self._damped or parts)
        if parts:
            self.label += " that ignore what overlaps in the beginning"

    @property
    def viscosity(self) -> ViscousForces | None:
        """Viscous forces, if the law has damping."""
        return self if self._damped else None

    @property
    def stress_update(self) -> LinearisedStress | None:
        """State of the friction springs, if the law has friction."""
        return self if self.friction else None

    @property
    def path(self) -> PathDependence | None:
        """Path dependence: by friction, or by pairs that are ignored until they separate."""
        return self if self.friction or self.ignores else None

    @property
    def passage(self) -> PassageCheck:
        """Check whether surfaces pass through each other."""
        return self

    @property
    def over_step(self) -> StepForces | None:
        """Forces of a step, if they conserve energy."""
        return self if self.conserved else None

    @property
    def low_rank(self) -> LowRankTangent | None:
        """Low-rank form of the tangent, if there are only normal forces."""
        return None if self._damped or self.friction else self

    @property
    def ground(self) -> GroundForces | None:
        """Forces on ground, if a side is fixed to ground."""
        return self if self._sides.on_ground else None

    @property
    def version(self) -> int:  # type: ignore[override]
        """Version of the list of pairs."""
        return self._sides.near.version

    @property
    def pairs(self) -> Pairs:
        """Pairs of nodes that are coupled by contact points near each other."""
        return self._sides.near.blocks

    @property
    def pair_positions(self) -> Array:
        """State of the list of pairs, for checkpoints."""
        return self._sides.pair_positions

    def restore_pairs(self, pair_positions: Array) -> None:
        """Restore the list of pairs."""
        self._sides.restore_pairs(pair_positions)

    def _measured(self, H: Array, v: Array, *, viscous: bool) -> tuple[ContactPoints, Normal]:
        """Contact points; gaps and forces along the normal."""
        at = self._sides.meet(H)
        found = Normal(*np.empty((3, len(at.pairs))))
        _measure(H, v, self._types, at, self._law, viscous, found)
        return at, found

    def energy(self, H: Array) -> float:
        """Energy stored by normal and tangential springs."""
        stored, most = _stored(H, self._table.of(self._sides.meet(H)), self._law.k)
        if most > self._allowed:
            part, self._allowed = 100 * _DEEP * most / self._allowed, np.inf
            k = self._law.k
            _log.warning(
                "%s: overlap is %.0f %% of a radius (stiffness %g). In motion smaller steps show "
                "whether steps or the stiffness allow it; at rest the stiffness is too low for "
                "the load",
                *(self._name, part, k),
            )
        held = 0.0 if self._friction is None else self._friction.energy(H)
        return float(stored) + held

    def _add_normal(
        self, H: Array, v: Array, out: Array, parts: tuple[bool, bool], *, grounded: bool = False
    ) -> None:
        """Add elastic and damping forces along the normal, as far as they count."""
        table = self._table.of(self._sides.meet(H))
        _add(H, v, self._types, table, self._law, parts, grounded, out)

    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """Add the contact forces to the residual."""
        self._add_normal(H, out, out, (True, False))
        if self._friction is not None:
            self._friction.add_forces(H, out)

    def tangent(self, H: Array, kept: Array) -> Array:
        """Tangent stiffness of each pair of nodes."""
        still = np.zeros((len(H), 6))
        blocks = self._tangents(H, still, viscous=False)[0]
        if self._friction is not None:
            self._friction.add_tangent(H, blocks)
        return blocks

    def stiff_rows(self, H: Array) -> StiffRows:
        """Rows of the low-rank tangent, without the geometric stiffness."""
        at = self._sides.meet(H)
        most = len(at.pairs)
        nodes = np.empty((most, SLOTS), dtype=np.int64)
        rows, stiffness = np.zeros((most, SLOTS, 6)), np.empty(most)
        m = normal_rows(H, self._types, at, self._law.k, nodes, rows, stiffness)
        return StiffRows(nodes[:m], rows[:m], stiffness[:m])

    def add_viscous_forces(self, H: Array, v: Array, out: Array) -> None:
        """Add the damping forces to the residual."""
        self._add_normal(H, v, out, (False, True))
        if self._friction is not None:
            self._friction.add_damping_forces(H, v, out)

    def viscous_tangent(self, H: Array, v: Array) -> tuple[Array, Array | None]:
        """Derivatives of the damping forces in twists and in frames."""
        by_frames, by_twists = self._tangents(H, v, viscous=True)
        if self._friction is not None:
            self._friction.add_damping_tangent(H, v, by_frames, by_twists)
        return by_twists, by_frames

    def _tangents(self, H: Array, v: Array, *, viscous: bool) -> tuple[Array, Array]:
        at = self._sides.meet(H)
        count = len(self._sides.near.blocks[0])
        by_frames = np.zeros((count, 6, 6))
        by_twists = np.zeros((count if viscous else 0, 6, 6))
        given = H, v, self._types, at, self._law, viscous, _NONE
        tangents(*given, by_frames, by_twists)
        return by_frames, by_twists

    # --- state of friction ---

    @property
    def linearised_values(self) -> Array:
        """State of the friction springs."""
        return np.empty(0) if self._friction is None else self._friction.linearised_values

    def restore(self, values: Array) -> None:
        """Restore the state of the friction springs."""
        assert self._friction is not None
        self._friction.restore(values)

    def _renumbered(self, values: Array, numbers: Indices) -> Array:
        """State of the friction springs, which are attached to nodes, with other numbers."""
        return values if self._friction is None else renumbered(values, numbers)

    def accept(self, H: Array, start: Array | None = None) -> None:
        """Accept frames: update ignored pairs and friction springs."""
        self._sides.near.part(H)
        if self._friction is not None:
            self._friction.accept(H, start)
            self._compare(self._friction.pressed, self._stored)
            self._stored = 0.0

    @property
    def dissipated(self) -> float:
        """Energy dissipated by friction."""
        return 0.0 if self._friction is None else self._friction.dissipated

    def friction_forces(self, H: Array, v: Array) -> Array:
        """Friction forces in the last accepted state, shape (k, 9)."""
        if self._friction is None:
            return super().friction_forces(H, v)
        return self._friction.rows(H, v)

    def check_passage(self, start: Array, end: Array) -> None:
        """Raise ``PassedThroughError`` if surfaces passed through each other in the step."""
        if (found := self._sides.passed(start, end)) is not None:
            raise PassedThroughError(self._name, *found)

    def _now(self, H: Array) -> ContactPoints:
        """Contact points at frames, for the present list of pairs."""
        at = self._sides.meet_again(H)
        return at if self._sides.of_balls else copied(at)

    def watch(self, start: Array, end: Array, h: float, middle: Array | None) -> None:
        """Add a step to the energy balance."""
        self._watch.add(start, end, h, middle)
        if self._friction is not None:
            self._compare(self._friction.pressed, self._watch.energy)

    def _compare(self, pressed: float, stored: float) -> None:
        """Log once if points of friction see far less or more than the points of the overlap.

        On lines, the former are fixed, three in each element, and the latter follow the overlap.
        """
        if self._sides.of_balls or self._compared >= _COMPARED or not stored > 0.0:
            return
        self._compared += 1
        self._energies += pressed, stored
        part = float(self._energies[0] / self._energies[1])
        if self._compared == _COMPARED and not 1.0 / _UNEVEN < part < _UNEVEN:
            _log.warning(
                "%s: friction acts at fixed points, of which each element has three; they see "
                "%.0f %% of the energy of the overlap, because the contact is shorter than the "
                "distance between them. Take shorter elements, or a lower stiffness",
                self._name,
                100.0 * part,
            )

    @property
    def watched(self) -> Array:
        """State of the energy balance."""
        return self._watch.memory

    def watch_again(self, watched: Array) -> None:
        """Restore the state of the energy balance."""
        self._watch.restore(watched)

    def update_stress(self, H: Array, h: Array) -> None:
        """Do nothing: friction springs change when frames are accepted."""

    def reset_stress(self, H: Array) -> None:
        """Do nothing: friction springs change when frames are accepted."""

    def clear_stress(self) -> None:
        """Do nothing: friction springs change when frames are accepted."""

    # --- over a step ---

    def add_over_step(self, ends: Ends, out: Array, ground: Array) -> Done:
        """Add the forces of a step whose work is the change of the stored energy."""
        both = self._sides.meet_ends(ends.start, ends.end, known=False)
        tables = tuple(kept.of(at) for kept, at in zip(self._both, both, strict=False))
        add = add_of_start if len(tables) == 1 else add_of_both_ends
        done = Done(*add(ends, self._types, tables, self._law.k, out, ground), 0.0)
        self._stored = done.stored
        if self._friction is None:
            return done
        by_friction = self._friction.add_over_step(ends, out, ground)
        return Done(*(a + b for a, b in zip(done, by_friction, strict=True)))

    def tangent_over_step(self, ends: Ends, H: Array) -> Array:
        """Tangent stiffness of the forces of a step."""
        none, still = np.empty((0, 6, 6)), np.zeros((len(H), 6))
        blocks = np.zeros((len(self._sides.near.blocks[0]), 6, 6))
        # the list of pairs must be the one that the sparsity pattern was made from
        both = self._sides.meet_ends(ends.start, ends.end, known=True)
        found = tuple(empty_secants(len(at.pairs)) for at in both)
        set_secants(ends, both, found)
        for at, secants in zip(both, found, strict=True):
            tangents(H, still, self._types, at, self._law, False, secants, blocks, none)
        if self._friction is not None:
            self._friction.add_tangent_over_step(ends, H, blocks)
        return blocks

    def overlaps(self, H: Array) -> bool:
        """Whether any pair overlaps; what else was evaluated since has no effect."""
        self._sides.take_kept_stretches()
        _, found = self._measured(H, np.empty((0, 6)), viscous=False)
        return bool((found.gaps < 0.0).any())

    def keep_gaps(self) -> None:
        """Keep the stretches of lines at the frames of the last :meth:`overlaps`."""
        self._sides.keep_stretches()

    def add_of_ground(self, H: Array, v: Array, out: Array) -> None:
        """Add the contact forces on ground."""
        self._add_normal(H, v, out, (True, self._damped), grounded=True)
        if self._friction is not None:
            self._friction.add_forces(H, out, grounded=True)
            if self._damped:
                self._friction.add_damping_forces(H, v, out, grounded=True)

    def touching(self, H: Array, v: Array) -> tuple[Indices, Array, Array, Array]:
        """Pairs in contact, with gaps, closest points and contact forces."""
        at, found = self._measured(H, v, viscous=self._damped)
        X, F = np.empty((len(at.pairs), 3)), np.empty((len(at.pairs), 3))
        _show(H, at, found.forces, X, F)
        deep = found.gaps < 0.0
        return at.pairs[deep].copy(), found.gaps[deep], X[deep], F[deep]
