"""Friction of one penalty contact: tractions from step to step."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.contact.laws import friction_over_steps as over_steps
from fem_lie.contact.laws.anchors import (
    Anchors,
    CoulombLaw,
    add_tractions,
    empty_anchors,
    found,
    overlap_energy,
    packed,
    set_anchors,
    set_rows,
    slip_work,
    tractions,
    unpacked,
)
from fem_lie.contact.laws.damped_friction import add_damping_tangents, damping_tractions
from fem_lie.contact.laws.friction_tangents import add_traction_tangents
from fem_lie.contact.sides.two_sides import Sides, Stations
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
        self._anchors = empty_anchors(0)
        self._ahead: tuple[Indices, Array] | None = None
        self.dissipated = self.pressed = 0.0
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

    def accept(self, H: Array, start: Array | None = None) -> None:
        """Set new anchors at frames ``H``, with springs that keep their present elongation.

        Args:
            H: Frames at the end of a step.
            start: Frames at its start, if there was a step.
        """
        (at, keys, a, b), _, τ = self._tractions(H)
        self.pressed = overlap_energy(H, at, self._law.normal)
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
        set_anchors(H, self._middle(H, start), self._types, at, a, b, springs, anchors)
        anchors.keys[:], anchors.forces[:] = keys, forces
        self._anchors = anchors

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
        (at, keys, *_), which, τ = self._damping_tractions(H, v)
        rows, known = np.zeros((len(keys), FRICTION_COLUMNS)), which >= 0
        forces = at.weight[: len(τ), np.newaxis] * τ
        forces[known] += self._anchors.forces[which[known]]
        set_rows(H, self._types, at, which, forces, rows)
        return rows[rows[:, 6:].any(axis=1)]

    # --- over a step ---

    def add_over_step(self, ends: Ends, out: Array, ground: Array) -> Done:
        """Add tractions of a step; :meth:`accept` keeps their springs for the next step."""
        (at, keys, *_), arms, _, over = self._over_step(ends)
        self._ahead = keys.copy(), over.held
        over_steps.add_over_step(ends, self._types, at, arms, over.τ, out, ground)
        return Done(*over_steps.energies(self._law, at, over))

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
        self.dissipated, self._anchors = float(values[0]), unpacked(values[1:])


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
