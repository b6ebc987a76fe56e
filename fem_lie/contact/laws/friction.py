"""Friction of one penalty contact: tractions from step to step."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit.packed_arrays import PackedArrays
from fem_lie.contact.laws import friction_over_steps as over_steps
from fem_lie.contact.laws import packed_friction
from fem_lie.contact.laws.anchors import (
    Anchors,
    CoulombLaw,
    add_tractions,
    empty_anchors,
    found,
    packed,
    unpacked,
)
from fem_lie.contact.laws.damped_friction import add_damping_tangents, damping_tractions
from fem_lie.contact.laws.friction_tangents import add_traction_tangents
from fem_lie.contact.sides.table import KeptTable, Stations
from fem_lie.contact.sides.two_sides import Sides
from fem_lie.forms.abilities import FRICTION_COLUMNS, Done, Ends
from fem_lie.lie.node_types import go_all_on


class Friction:
    """Tangential springs that slip, between anchors on both sides.

    Attributes:
        dissipated: Energy dissipated by slip in all accepted steps, except in those of conserving
            schemes, which account for it themselves, J.
        pressed: Energy of the overlaps at the points of friction in the last accepted state, J.
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
        self._stations = KeptTable()
        self._hold(empty_anchors(0))
        self._ahead: tuple[Indices, Array] | None = None
        self.dissipated = self.pressed = 0.0
        self.accept(H)

    def _hold(self, anchors: Anchors) -> None:
        self._anchors, self._packed = anchors, PackedArrays(anchors)

    def _tables(self, H: Array) -> tuple[Indices, Indices]:
        """Tables of the stations at frames ``H`` and of the anchors."""
        return self._stations.of_stations(self._sides.stations(H)), self._packed.addresses

    def add_forces(self, H: Array, out: Array, *, grounded: bool = False) -> None:
        """Add all friction forces, or those of pairs with ground, to ``out`` (≥ nodes, 6)."""
        packed_friction.add_friction(H, self._types, *self._tables(H), self._law, grounded, out)

    def add_damping_forces(self, H: Array, v: Array, out: Array, *, grounded: bool = False) -> None:
        """Add what dampers and the limit by the whole normal force change, to ``out``."""
        stations, which, τ = self._damping_tractions(H, v)
        add_tractions(H, self._types, stations.at, self._anchors, which, τ, grounded, out)

    def _damping_tractions(self, H: Array, v: Array) -> tuple[Stations, Indices, Array]:
        """Pairs, index of their anchors, and the viscous part of tractions (m, 3)."""
        stations = self._sides.stations(H)
        which, τ = found(self._anchors.keys, stations.keys), np.empty((len(stations.keys), 3))
        given = H, v, self._types, stations.at, self._anchors, which, self._law
        damping_tractions(*given, τ)
        return stations, which, τ

    def add_damping_tangent(self, H: Array, v: Array, by_frames: Array, by_twists: Array) -> None:
        """Add the derivatives of :meth:`add_damping_forces` to blocks of pairs of nodes."""
        stations = self._sides.stations(H)
        which = found(self._anchors.keys, stations.keys)
        given = H, v, self._types, stations.at, self._anchors, which, self._law
        add_damping_tangents(*given, by_frames, by_twists)

    def energy(self, H: Array) -> float:
        """Energy stored in the tangential springs."""
        return float(packed_friction.spring_energy(H, *self._tables(H), self._law))

    def add_tangent(self, H: Array, blocks: Array) -> None:
        """Add derivatives of the friction forces to the blocks of pairs of nodes."""
        stations = self._sides.stations(H)
        which = found(self._anchors.keys, stations.keys)
        none = over_steps.empty_slips(0)
        given = H, self._types, stations.at, self._anchors, which, self._law, none
        add_traction_tangents(*given, blocks)

    def accept(self, H: Array, start: Array | None = None) -> None:
        """Set new anchors at frames ``H``, with springs that keep their present elongation.

        Args:
            H: Frames at the end of a step.
            start: Frames at its start, if there was a step.
        """
        found_stations = self._sides.stations(H)
        stations, keys = self._stations.of_stations(found_stations), found_stations.keys
        before, over_step = self._packed, self._ahead is not None
        if self._ahead is None:
            τ: Array = np.empty((len(keys), 3))
            packed_friction.set_tractions(H, stations, before.addresses, self._law, τ)
        else:
            known, over = self._ahead
            # pairs without anchors have index −1, the last row
            τ = np.concatenate([over, np.zeros((1, 3))])[found(known, keys)]
            self._ahead = None
        if len(keys) != len(self._anchors.keys):
            self._hold(empty_anchors(len(keys)))
        anchors = before.addresses, self._packed.addresses
        given = H, self._middle(H, start), self._types, stations, anchors, self._law, τ
        self.pressed, lost = packed_friction.set_again(*given)
        if not over_step:
            self.dissipated += lost

    def _middle(self, H: Array, start: Array | None) -> Array:
        """Frames in the middle of the next step, if the motion goes on as from ``start``."""
        if start is None:
            return H
        middle = H.copy()
        go_all_on(self._types, start, H, middle)
        return middle

    def rows(self, H: Array, v: Array) -> Array:
        """Friction forces in the last accepted state, with ``H`` and twists ``v``, shape (k, 9).

        Columns are those of :meth:`~fem_lie.forms.abilities.PathDependence.friction_forces`.
        """
        found_stations = self._sides.stations(H)
        rows = np.zeros((len(found_stations.keys), FRICTION_COLUMNS))
        tables = self._stations.of_stations(found_stations), self._packed.addresses
        k = packed_friction.friction_rows(H, v, self._types, *tables, self._law, rows)
        return rows[:k]

    # --- over a step ---

    def add_over_step(self, ends: Ends, out: Array, ground: Array) -> Done:
        """Add tractions of a step; :meth:`accept` keeps their springs for the next step."""
        found_stations = self._sides.stations_over_step(ends.end)
        stations, keys = self._stations.of_stations(found_stations), found_stations.keys
        held = np.empty((len(keys), 3))
        given = ends, self._types, stations, self._packed.addresses, self._law, held
        done = packed_friction.add_over_step(*given, out, ground)
        self._ahead = keys.copy(), held
        return Done(*done)

    def add_tangent_over_step(self, ends: Ends, H: Array, blocks: Array) -> None:
        """Add twice the derivative of the tractions of a step in midpoint frames ``H``."""
        stations, arms, which, over = self._over_step(ends)
        given = H, self._types, stations.at, arms, which, self._law, over
        add_traction_tangents(*given, blocks)

    def _over_step(self, ends: Ends) -> tuple[Stations, Anchors, Indices, over_steps.Slips]:
        """Pairs at the end, anchors, index of each, and variables of the tractions."""
        stations = self._sides.stations_over_step(ends.end)
        m = len(stations.keys)
        which, arms = found(self._anchors.keys, stations.keys), empty_anchors(m)
        over = over_steps.empty_slips(m)
        given = ends, self._types, stations.at, self._anchors, which, self._law
        over_steps.set_over_step(*given, arms, over)
        return stations, arms, np.where(which >= 0, np.arange(m), -1), over

    @property
    def linearised_values(self) -> Array:
        """The dissipated energy and all anchors as a flat array, for checkpoints."""
        return np.concatenate([[self.dissipated], packed(self._anchors)])

    def restore(self, values: Array) -> None:
        """Restore the anchors that :attr:`linearised_values` returned."""
        self._ahead = None
        self.dissipated = float(values[0])
        self._hold(unpacked(values[1:]))


def renumbered(values: Array, numbers: Indices) -> Array:
    """State of friction, :attr:`Friction.linearised_values`, with other numbers of the nodes.

    Args:
        values: The state.
        numbers: New number of each node, shape (n,).
    """
    anchors = unpacked(values[1:])
    moving = anchors.nodes >= 0
    anchors.nodes[moving] = numbers[anchors.nodes[moving]]
    return np.concatenate([values[:1], packed(anchors)])
