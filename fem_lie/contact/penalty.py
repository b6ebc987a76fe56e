"""Forces of contacts by penalty: a term on all nodes."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined
from fem_lie.contact.kinematics import SLOTS, add_row, bends, gap, rate, slot
from fem_lie.contact.laws import Penalty
from fem_lie.contact.pairs import NearPairs
from fem_lie.contact.table import GROUND, Side
from fem_lie.forms.term import Pairs, Term
from fem_lie.lie.tuples import Vector, minus, scaled, store_row


@inlined
def _damping(k: float, c: float, g: float, speed: float) -> tuple[float, float, float]:
    """What damping adds to ``k g``, and how that changes with ``g`` and ``ġ``: nothing pulls."""
    if k * g + c * speed >= 0.0:
        return -k * g, -k, 0.0
    return c * speed, 0.0, c


@inlined
def _add_force(
    H: Array,
    a: Side,
    b: Side,
    i: int,
    j: int,
    flat: bool,
    P: Vector,
    f: float,
    n: Vector,
    out: Array,
) -> None:
    """Add ``f b`` of a pair."""
    for s in range(SLOTS):
        node, sign, w, c = slot(H, a, b, i, j, flat, P, s)
        if node >= 0:
            add_row(H, node, sign * f, w, c, n, out)


@inlined
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


@inlined
def _wanted(a: Side, b: Side, i: int, j: int, grounded: bool) -> bool:
    """Whether a pair counts: all do, or those with ground."""
    return not grounded or a.owners[i] == GROUND or b.owners[j] == GROUND


@compiled
def _energy(H: Array, a: Side, b: Side, pairs: Indices, flat: bool, k: float) -> float:
    total = 0.0
    for e in range(pairs.shape[0]):
        g, _, _ = gap(H, a, b, pairs[e, 0], pairs[e, 1], flat)
        if g < 0.0:
            total += 0.5 * k * g * g
    return total


@compiled
def _add_forces(
    H: Array, a: Side, b: Side, pairs: Indices, flat: bool, k: float, grounded: bool, out: Array
) -> None:
    """``out += k g b``; ``grounded``: of pairs with ground alone."""
    for e in range(pairs.shape[0]):
        i, j = pairs[e]
        g, n, P = gap(H, a, b, i, j, flat)
        if g < 0.0 and _wanted(a, b, i, j, grounded):
            _add_force(H, a, b, i, j, flat, P, k * g, n, out)


@compiled
def _add_damping(
    H: Array,
    v: Array,
    a: Side,
    b: Side,
    pairs: Indices,
    flat: bool,
    k: float,
    c: float,
    grounded: bool,
    out: Array,
) -> None:
    """What damping adds to these."""
    for e in range(pairs.shape[0]):
        i, j = pairs[e]
        g, n, P = gap(H, a, b, i, j, flat)
        if g < 0.0 and _wanted(a, b, i, j, grounded):
            f, _, _ = _damping(k, c, g, _speed(H, v, a, b, i, j, flat, P, n))
            _add_force(H, a, b, i, j, flat, P, f, n, out)


@compiled
def _touching(
    H: Array,
    v: Array,
    a: Side,
    b: Side,
    pairs: Indices,
    flat: bool,
    k: float,
    c: float,
    g: Array,
    X: Array,
    F: Array,
) -> None:
    """Gaps, nearest points of the first side, and forces on it."""
    for e in range(pairs.shape[0]):
        i, j = pairs[e]
        g[e], n, P = gap(H, a, b, i, j, flat)
        f = 0.0
        if g[e] < 0.0:
            f = -k * g[e]
            if c > 0.0:
                f -= _damping(k, c, g[e], _speed(H, v, a, b, i, j, flat, P, n))[0]
        store_row(X, e, minus(P, scaled(a.radii[i], n)))
        store_row(F, e, scaled(f, n))


@compiled
def _tangents(
    H: Array,
    v: Array,
    a: Side,
    b: Side,
    pairs: Indices,
    flat: bool,
    k: float,
    c: float,
    viscous: bool,
    by_frames: Array,
    by_twists: Array,
) -> None:
    """Derivatives of the forces, or of what damping adds, in frames and in twists."""
    nodes, rows, changes = (
        np.empty(SLOTS, dtype=np.int64),
        np.zeros((SLOTS, 6)),
        np.zeros((SLOTS, 6)),
    )
    D, G = np.zeros((SLOTS, 2, 3, 6)), np.zeros((SLOTS, SLOTS, 6, 6))
    at = 0
    for e in range(pairs.shape[0]):
        i, j = pairs[e]
        g, n, P = gap(H, a, b, i, j, flat)
        bends(H, a, b, i, j, flat, nodes, rows, D, G)
        f, by_gap, by_speed = k * g, k, 0.0
        if viscous:
            f, by_gap, by_speed = _damping(k, c, g, _speed(H, v, a, b, i, j, flat, P, n))
            _changes_of_speed(v, nodes, G, changes)
        for s in range(SLOTS):
            for t in range(SLOTS):
                if nodes[s] < 0 or nodes[t] < 0:
                    continue
                if g < 0.0:
                    for p in range(6):
                        for q in range(6):
                            to_frame = by_gap * rows[t, q] + by_speed * changes[t, q]
                            by_frames[at, p, q] = f * G[s, t, p, q] + rows[s, p] * to_frame
                            if viscous:
                                by_twists[at, p, q] = by_speed * rows[s, p] * rows[t, q]
                at += 1


@inlined
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
    """The forces of one contact by penalty, with damping as forces that depend on twists.

    Attributes:
        near: Pairs that may touch.
    """

    label = "contacts by penalty"

    def __init__(self, a: Side, b: Side, law: Penalty, *, flat: bool, same: bool) -> None:
        """Keep both sides.

        Args:
            a: First side.
            b: Second side.
            law: Stiffness and damping.
            flat: Whether the second side are planes.
            same: Whether both sides are the same.
        """
        self._sides, self._flat, self._law = (a, b), flat, law
        self.pairs_near = NearPairs(a, b, flat=flat, same=same)
        self.viscous = self.in_space = law.damping > 0.0
        self.on_ground = bool((a.owners == GROUND).any() or (b.owners == GROUND).any())

    @property
    def version(self) -> int:  # type: ignore[override]
        """Of the list of pairs."""
        return self.pairs_near.version

    @property
    def pairs(self) -> Pairs:
        """Of those that are near each other."""
        return self.pairs_near.blocks

    @property
    def seen(self) -> Array:
        """See the base class."""
        return self.pairs_near.seen

    def see_again(self, seen: Array) -> None:
        """See the base class."""
        self.pairs_near.see_again(seen)

    def energy(self, H: Array) -> float:
        """See the base class."""
        self.pairs_near.update(H)
        return _energy(H, *self._sides, self.pairs_near.now, self._flat, self._law.stiffness)

    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """See the base class."""
        self._add(H, out, grounded=False)

    def _add(self, H: Array, out: Array, *, grounded: bool) -> None:
        self.pairs_near.update(H)
        pairs = self.pairs_near.now
        _add_forces(H, *self._sides, pairs, self._flat, self._law.stiffness, grounded, out)

    def tangent(self, H: Array, kept: Array) -> Array:
        """See the base class."""
        still = np.zeros((len(H), 6))
        return self._tangents(H, still, viscous=False)[0]

    def add_viscous_forces(self, H: Array, v: Array, out: Array) -> None:
        """See the base class."""
        self._add_viscous(H, v, out, grounded=False)

    def _add_viscous(self, H: Array, v: Array, out: Array, *, grounded: bool) -> None:
        self.pairs_near.update(H)
        law, pairs = self._law, self.pairs_near.now
        numbers = law.stiffness, law.damping
        _add_damping(H, v, *self._sides, pairs, self._flat, *numbers, grounded, out)

    def viscous_tangent(self, H: Array, v: Array) -> tuple[Array, Array | None]:
        """See the base class."""
        by_frames, by_twists = self._tangents(H, v, viscous=True)
        return by_twists, by_frames

    def _tangents(self, H: Array, v: Array, *, viscous: bool) -> tuple[Array, Array]:
        count, law = len(self.pairs_near.blocks[0]), self._law
        by_frames = np.zeros((count, 6, 6))
        by_twists = np.zeros((count if viscous else 0, 6, 6))
        pairs, numbers = (self.pairs_near.now, self._flat), (law.stiffness, law.damping)
        _tangents(H, v, *self._sides, *pairs, *numbers, viscous, by_frames, by_twists)
        return by_frames, by_twists

    def add_of_ground(self, H: Array, v: Array, out: Array) -> None:
        """See the base class."""
        self._add(H, out, grounded=True)
        if self.viscous:
            self._add_viscous(H, v, out, grounded=True)

    def touching(self, H: Array, v: Array) -> tuple[Indices, Array, Array, Array]:
        """Which places touch, and how.

        Args:
            H: Frames of all nodes.
            v: Their twists.

        Returns:
            Pairs of places (k, 2), gaps (k,), nearest points of the first side (k, 3), and forces
            on it (k, 3), global components.
        """
        self.pairs_near.update(H)
        pairs, law = self.pairs_near.now, self._law
        g, X, F = np.empty(len(pairs)), np.empty((len(pairs), 3)), np.empty((len(pairs), 3))
        numbers = law.stiffness, law.damping
        _touching(H, v, *self._sides, pairs, self._flat, *numbers, g, X, F)
        deep = g < 0.0
        return pairs[deep], g[deep], X[deep], F[deep]
