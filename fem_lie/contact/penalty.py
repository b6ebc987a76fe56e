"""Forces of contacts by penalty: a term on all nodes."""

from __future__ import annotations

import logging
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined_uncounted, uncounted
from fem_lie.contact.kinematics import SLOTS, add_row, bends, gap, place, rate, slot
from fem_lie.contact.laws import Penalty
from fem_lie.contact.meeting import Meeting, Sides
from fem_lie.contact.over_steps import BY_GAP, CHANGE, END, SLOPE, add_secants, mixed
from fem_lie.contact.surfaces import MOST_NODES
from fem_lie.contact.table import GROUND, Side
from fem_lie.forms.term import Done, Ends, Pairs, Term
from fem_lie.lie.motions import local_components
from fem_lie.lie.tuples import Vector, cross, dot, load_row, minus, scaled, store_row

_log = logging.getLogger(__name__)

_DEEP = 0.1
"""Part of the least radius: what overlaps by more is told of, once."""


_NONE = np.empty((0, 0))


class Numbers(NamedTuple):
    """Of a law, for a weight of one.

    Attributes:
        k: Stiffness.
        c: Damping.
        ramp: Overlap over which that grows.
    """

    k: float
    c: float
    ramp: float


@inlined_uncounted
def _damping(law: Numbers, g: float, speed: float) -> tuple[float, float, float]:
    """What damping adds to ``k g``, and how that changes with ``g`` and ``ġ``: nothing pulls."""
    part, by_gap = 1.0, 0.0
    if -g < law.ramp:
        part, by_gap = -g / law.ramp, -1.0 / law.ramp
    if law.k * g + part * law.c * speed >= 0.0:
        return -law.k * g, -law.k, 0.0
    return part * law.c * speed, by_gap * law.c * speed, part * law.c


@inlined_uncounted
def _speed(
    H: Array, v: Array, a: Side, b: Side, i: int, j: int, flat: bool, P: Vector, n: Vector
) -> float:
    """``ġ`` of a pair."""
    found = 0.0
    for s in range(SLOTS):
        node, sign, w, c = slot(H, a, b, i, j, flat, P, s)
        if node >= 0:
            found += sign * rate(H, v, node, w, c, n)
    return found


@uncounted
def _measure(H: Array, v: Array, at: Meeting, law: Numbers, viscous: bool, out: Array) -> None:
    """Gap, force of stiffness and what damping adds, along the normal, of each pair: (3, m)."""
    for e in range(at.pairs.shape[0]):
        i, j = at.pairs[e]
        g, n, P = gap(H, at.a, at.b, i, j, at.flat)
        out[0, e], out[1, e], out[2, e] = g, 0.0, 0.0
        if g < 0.0:
            out[1, e] = at.weight[e] * law.k * g
            if viscous:
                speed = _speed(H, v, at.a, at.b, i, j, at.flat, P, n)
                out[2, e] = at.weight[e] * _damping(law, g, speed)[0]


@uncounted
def _add(H: Array, at: Meeting, f: Array, grounded: bool, out: Array) -> None:
    """``out += f b``, of all pairs or of those with ground alone."""
    for e in range(at.pairs.shape[0]):
        i, j = at.pairs[e]
        if f[e] == 0.0 or (grounded and at.a.owners[i] != GROUND and at.b.owners[j] != GROUND):
            continue
        _, n, P = gap(H, at.a, at.b, i, j, at.flat)
        for s in range(SLOTS):
            node, sign, w, c = slot(H, at.a, at.b, i, j, at.flat, P, s)
            if node >= 0:
                add_row(H, node, sign * f[e], w, c, n, out)


@uncounted
def _show(H: Array, at: Meeting, f: Array, X: Array, F: Array) -> None:
    """Nearest points of the first side, and forces on it."""
    for e in range(at.pairs.shape[0]):
        i, j = at.pairs[e]
        _, n, P = gap(H, at.a, at.b, i, j, at.flat)
        store_row(X, e, minus(P, scaled(at.a.radii[i], n)))
        store_row(F, e, scaled(-f[e], n))


@compiled
def _tangents(
    H: Array,
    v: Array,
    at: Meeting,
    law: Numbers,
    viscous: bool,
    given: Array,
    by_frames: Array,
    by_twists: Array,
) -> None:
    """Derivatives of the forces, or of what damping adds, in frames and in twists: added.

    ``given`` are secants of a step instead, (≥ 2, m), or nothing, (0, 0).
    """
    over_step = given.shape[0] > 0
    nodes, rows, changes = (
        np.empty(SLOTS, dtype=np.int64),
        np.zeros((SLOTS, 6)),
        np.zeros((SLOTS, 6)),
    )
    D, G = np.zeros((SLOTS, 2, 3, 6)), np.zeros((SLOTS, SLOTS, 6, 6))
    for e in range(at.pairs.shape[0]):
        i, j = at.pairs[e]
        g, n, P = gap(H, at.a, at.b, i, j, at.flat)
        if over_step:
            if given[SLOPE, e] == 0.0:
                continue
        elif g >= 0.0:
            continue
        bends(H, at.a, at.b, i, j, at.flat, nodes, rows, D, G)
        if not at.flat:
            _slide(H, at, e, n, nodes, D, G)
        f, by_gap, by_speed = law.k * g, law.k, 0.0
        if viscous:
            speed = _speed(H, v, at.a, at.b, i, j, at.flat, P, n)
            f, by_gap, by_speed = _damping(law, g, speed)
            _changes_of_speed(v, nodes, G, changes)
        elif over_step:
            f, by_gap = law.k * given[SLOPE, e], law.k * given[BY_GAP, e]
        block, weight = at.first[e], at.weight[e]
        for s in range(SLOTS):
            for t in range(SLOTS):
                if nodes[s] < 0 or nodes[t] < 0:
                    continue
                for p in range(6):
                    for q in range(6):
                        to_frame = by_gap * rows[t, q] + by_speed * changes[t, q]
                        change = f * G[s, t, p, q] + rows[s, p] * to_frame
                        by_frames[block, p, q] += weight * change
                        if viscous:
                            by_twists[block, p, q] += weight * by_speed * rows[s, p] * rows[t, q]
                block += 1


@inlined_uncounted
def _slide(H: Array, at: Meeting, e: int, n: Vector, nodes: Indices, D: Array, G: Array) -> None:
    """``−m mᵀ/s``: the second place follows the first; see :class:`~.meeting.Sliding`."""
    i, j = at.pairs[e]
    t, slides = load_row(at.sliding.slopes, e), at.sliding
    if t[0] == t[1] == t[2] == 0.0:
        return
    apart = minus(place(H, at.a, i), place(H, at.b, j))
    distance = np.sqrt(dot(apart, apart))
    for s in range(SLOTS):
        if nodes[s] < 0:
            continue
        # −m, in what was room for turns of the normal
        for p in range(6):
            along = t[0] * D[s, 0, 0, p] + t[1] * D[s, 0, 1, p] + t[2] * D[s, 0, 2, p]
            D[s, 1, 0, p] = along / distance
        if s >= MOST_NODES:
            f = local_components(H[nodes[s]], n)
            turning = cross(load_row(slides.levers[e], s - MOST_NODES), f)
            for p in range(3):
                D[s, 1, 0, p] += slides.weights[e, s - MOST_NODES] * f[p]
                D[s, 1, 0, 3 + p] += turning[p]
    for a in range(SLOTS):
        for b in range(SLOTS):
            if nodes[a] >= 0 and nodes[b] >= 0:
                for p in range(6):
                    for q in range(6):
                        product = D[a, 1, 0, p] * D[b, 1, 0, q]
                        G[a, b, p, q] -= product * distance / slides.bends[e]


@inlined_uncounted
def _changes_of_speed(v: Array, nodes: Indices, G: Array, changes: Array) -> None:
    """``∂ġ/∂h`` at constant twists, of each slot."""
    changes[:] = 0.0
    for s in range(SLOTS):
        for t in range(SLOTS):
            if nodes[s] < 0 or nodes[t] < 0:
                continue
            for p in range(6):
                for q in range(6):
                    changes[t, q] += v[nodes[s], p] * G[s, t, p, q]


class PenaltyForces(Term):
    """The forces of one contact by penalty, with damping as forces that depend on twists."""

    label = "contacts by penalty"

    def __init__(self, sides: Sides, law: Penalty, name: str = "a contact") -> None:
        """Keep both sides.

        Args:
            sides: That touch.
            law: Stiffness and damping; of lines per length.
            name: For messages.
        """
        self._sides, self._name, self._allowed = sides, name, _DEEP * sides.radius
        self._law = Numbers(float(law.stiffness), float(law.damping), float(law.ramp))
        self.viscous = self.in_space = law.damping > 0.0
        self.on_ground = sides.on_ground
        self.conserved = self.secant = not self.viscous

    @property
    def version(self) -> int:  # type: ignore[override]
        """Of the list of pairs."""
        return self._sides.near.version

    @property
    def pairs(self) -> Pairs:
        """Of those that are near each other."""
        return self._sides.near.blocks

    @property
    def seen(self) -> Array:
        """See the base class."""
        return self._sides.seen

    def see_again(self, seen: Array) -> None:
        """See the base class."""
        self._sides.see_again(seen)

    def _measured(self, H: Array, v: Array, *, viscous: bool) -> tuple[Meeting, Array]:
        """Where sides meet; gaps, forces of stiffness and what damping adds, shape (3, m)."""
        at = self._sides.meet(H)
        found = np.empty((3, len(at.pairs)))
        _measure(H, v, at, self._law, viscous, found)
        return at, found

    def energy(self, H: Array) -> float:
        """See the base class."""
        _, found = self._measured(H, np.empty((0, 6)), viscous=False)
        deep = np.minimum(found[0], 0.0)
        most = -float(deep.min(initial=0.0))
        if most > self._allowed:
            part, self._allowed = 100 * _DEEP * most / self._allowed, np.inf
            k = self._law.k
            _log.warning(
                "%s: overlap is %.0f %% of a radius (stiffness %g): raise it", self._name, part, k
            )
        return 0.5 * float(found[1] @ deep)

    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """See the base class."""
        at, found = self._measured(H, out, viscous=False)
        _add(H, at, found[1], False, out)

    def tangent(self, H: Array, kept: Array) -> Array:
        """See the base class."""
        still = np.zeros((len(H), 6))
        return self._tangents(H, still, viscous=False)[0]

    def add_viscous_forces(self, H: Array, v: Array, out: Array) -> None:
        """See the base class."""
        at, found = self._measured(H, v, viscous=True)
        _add(H, at, found[2], False, out)

    def viscous_tangent(self, H: Array, v: Array) -> tuple[Array, Array | None]:
        """See the base class."""
        by_frames, by_twists = self._tangents(H, v, viscous=True)
        return by_twists, by_frames

    def _tangents(self, H: Array, v: Array, *, viscous: bool) -> tuple[Array, Array]:
        at = self._sides.meet(H)
        count = len(self._sides.near.blocks[0])
        by_frames = np.zeros((count, 6, 6))
        by_twists = np.zeros((count if viscous else 0, 6, 6))
        _tangents(H, v, at, self._law, viscous, _NONE, by_frames, by_twists)
        return by_frames, by_twists

    # --- over a step ---

    def add_over_step(self, ends: Ends, out: Array, ground: Array) -> Done:
        """See the base class."""
        k, work = self._law.k, 0.0
        parts = mixed(ends, self._sides.meet_ends(ends.start, ends.end, known=False))
        for at, secants, share in parts:
            add_secants(ends, at, k, share, out, ground)
            work += share * float((secants[SLOPE] * secants[CHANGE]) @ at.weight)
        at, secants, _ = parts[-1]
        return Done(k * float(secants[END] @ at.weight), k * work, 0.0)

    def tangent_over_step(self, ends: Ends, H: Array) -> Array:
        """See the base class."""
        none, still = np.empty((0, 6, 6)), np.zeros((len(H), 6))
        blocks = np.zeros((len(self._sides.near.blocks[0]), 6, 6))
        # the list of pairs is that of the pattern of the matrix
        for at, secants, share in mixed(
            ends, self._sides.meet_ends(ends.start, ends.end, known=True)
        ):
            _tangents(H, still, at, self._law, False, share * secants, blocks, none)
        return blocks

    def overlaps(self, H: Array) -> bool:
        """See the base class."""
        touches = bool((self._measured(H, np.empty((0, 6)), viscous=False)[1][0] < 0.0).any())
        if not touches:
            self._sides.settle()
        return touches

    def add_of_ground(self, H: Array, v: Array, out: Array) -> None:
        """See the base class."""
        at, found = self._measured(H, v, viscous=self.viscous)
        _add(H, at, found[1] + found[2], True, out)

    def touching(self, H: Array, v: Array) -> tuple[Indices, Array, Array, Array]:
        """Which places touch, and how.

        Args:
            H: Frames of all nodes.
            v: Their twists.

        Returns:
            Pairs of places (k, 2), gaps (k,), nearest points of the first side (k, 3), and forces
            on it (k, 3), global components.
        """
        at, found = self._measured(H, v, viscous=self.viscous)
        X, F = np.empty((len(at.pairs), 3)), np.empty((len(at.pairs), 3))
        _show(H, at, found[1] + found[2], X, F)
        deep = found[0] < 0.0
        return at.pairs[deep].copy(), found[0, deep], X[deep], F[deep]
