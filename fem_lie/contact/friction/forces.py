"""Friction of one contact by penalty: what is carried from step to step, and the forces."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.contact.friction import over_steps
from fem_lie.contact.friction.anchors import (
    Anchors,
    add_tractions,
    empty_anchors,
    found,
    packed,
    set_anchors,
    tractions,
    unpacked,
)
from fem_lie.contact.friction.coulomb import CoulombLaw
from fem_lie.contact.friction.tangents import add_traction_tangents
from fem_lie.contact.sides.gauss_points import Meeting
from fem_lie.contact.sides.meeting import Sides, Stations
from fem_lie.forms.abilities import Done, Ends


class Friction:
    """Springs across the normal that slip, between anchors on both sides."""

    def __init__(self, sides: Sides, law: CoulombLaw, H: Array) -> None:
        """Anchor all that is near.

        Args:
            sides: That touch.
            law: With friction; of lines per length.
            H: Frames in the beginning.
        """
        self._sides, self._law = sides, law
        self._anchors = empty_anchors(0)
        self._ahead: tuple[Indices, Array] | None = None
        self.accept(H)

    def _tractions(self, H: Array) -> tuple[Stations, Indices, Array]:
        """Pairs, their anchors, and tractions (m, 3)."""
        stations = self._sides.stations(H)
        which, τ = found(self._anchors.keys, stations.keys), np.empty((len(stations.keys), 3))
        tractions(H, stations.at, self._anchors, which, self._law, τ)
        return stations, which, τ

    def add_forces(self, H: Array, out: Array, *, grounded: bool = False) -> None:
        """Add all forces, or those of what touches ground, to ``out`` (≥ nodes, 6)."""
        stations, which, τ = self._tractions(H)
        add_tractions(H, stations.at, self._anchors, which, τ, grounded, out)

    def energy(self, H: Array) -> float:
        """Of the springs."""
        stations, _, τ = self._tractions(H)
        weight = stations.at.weight[: len(τ)]
        return 0.5 / self._law.holding * float((τ * τ).sum(axis=1) @ weight)

    def add_tangent(self, H: Array, blocks: Array) -> None:
        """Add derivatives of the forces to blocks of the pairs that are near."""
        stations = self._sides.stations(H)
        which = found(self._anchors.keys, stations.keys)
        none = np.empty((0, 7))
        add_traction_tangents(H, stations.at, self._anchors, which, self._law, none, blocks)

    def accept(self, H: Array) -> None:
        """Anchor anew at frames ``H``, with springs as they are stretched there."""
        (at, keys, a, b), _, τ = self._tractions(H)
        if self._ahead is not None:
            known, over = self._ahead
            # those that were not near have the last row
            τ = np.concatenate([over, np.zeros((1, 3))])[found(known, keys)]
            self._ahead = None
        anchors = empty_anchors(len(at.pairs))
        set_anchors(H, at, a, b, np.asarray(τ / self._law.holding), anchors)
        anchors.keys[:] = keys
        self._anchors = anchors

    # --- over a step of points and balls ---

    def add_over_step(self, ends: Ends, at: Meeting, out: Array, ground: Array) -> Done:
        """Add tractions over a step, which :meth:`accept` then goes on from."""
        levers, _, measured, τ = self._over_step(ends, at)
        self._ahead = at.pairs.copy(), τ
        over_steps.add_over_step(ends, at, levers, τ, out, ground)
        return Done(*over_steps.energies(self._law, at, measured, τ))

    def add_tangent_over_step(self, ends: Ends, at: Meeting, H: Array, blocks: Array) -> None:
        """Add twice their derivative in frames ``H`` half-way."""
        levers, which, measured, _ = self._over_step(ends, at)
        add_traction_tangents(H, at, levers, which, self._law, measured, blocks)

    def _over_step(self, ends: Ends, at: Meeting) -> tuple[Anchors, Indices, Array, Array]:
        m = len(at.pairs)
        which, levers = found(self._anchors.keys, at.pairs), empty_anchors(m)
        measured, τ = over_steps.room(m)
        over_steps.set_over_step(ends, at, self._anchors, which, self._law, levers, measured, τ)
        return levers, np.where(which >= 0, np.arange(m), -1), measured, τ

    @property
    def carried(self) -> Array:
        """Anchors."""
        return packed(self._anchors)

    def restore(self, carried: Array) -> None:
        """Have these anchors again."""
        self._ahead = None
        self._anchors = unpacked(carried)
