"""Coulomb's law as a return mapping, and the anchors of friction by penalty; compiled.

When a step is accepted, each pair of places that are near gets an anchor on both sides, material
points at the place of contact, of which the second is short of it by what the spring is stretched.
With ``u = P − Q`` of the anchors at any frames after that, linear in the rows of their nodes, and
``n`` and ``p`` the normal and the force along it there::

    τ = k u_T,  u_T = u − n n·u          while |τ| ≤ μ p, else τ = μ p u_T/|u_T|

So anchors turn with their nodes, and what rolls takes them along from step to step.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined_uncounted
from fem_lie.contact.sides.gauss_points import Meeting
from fem_lie.contact.sides.kinematics import SLOTS, gap, place
from fem_lie.contact.sides.surfaces import MOST_NODES
from fem_lie.contact.sides.table import GROUND, UNUSED, Side
from fem_lie.lie.motions import global_components, local_components
from fem_lie.lie.tuples import (
    Vector,
    combined,
    cross,
    dot,
    load_row,
    minus,
    plus,
    scaled,
    store_row,
)


class CoulombLaw(NamedTuple):
    """Constants of a contact by penalty with friction, for a weight of one.

    Attributes:
        k: Normal stiffness.
        μ: Coefficient of friction.
        holding: Stiffness of the springs across the normal.
    """

    k: float
    μ: float
    holding: float


@inlined_uncounted
def limit(law: CoulombLaw, depth: float) -> float:
    """The largest traction at an overlap."""
    return law.μ * law.k * depth


@inlined_uncounted
def returned(law: CoulombLaw, stretch: float, most: float) -> tuple[float, bool]:
    """Size of the traction of a spring, and whether it slips.

    Args:
        law: Constants.
        stretch: Of the spring, not negative.
        most: The :func:`limit`.
    """
    trial = law.holding * stretch
    if trial <= most or stretch == 0.0:
        return trial, False
    return most, True


class Anchors(NamedTuple):
    """``u = Σ (w x + R c) + o`` of pairs of places.

    Attributes:
        keys: What tells one pair from others, shape (m, 2).
        nodes: Of both sides, negative where there is none, shape (m, 8).
        weights: ``w``, negative on the second side, shape (m, 8).
        levers: ``c``, likewise, shape (m, 8, 3).
        fixed: ``o``, of what is on ground, shape (m, 3).
    """

    keys: Indices
    nodes: Indices
    weights: Array
    levers: Array
    fixed: Array


_COLUMNS = 2 + SLOTS + SLOTS + 3 * SLOTS + 3


def empty_anchors(m: int) -> Anchors:
    """Room for ``m`` pairs."""
    return Anchors(
        np.zeros((m, 2), dtype=np.int64),
        np.full((m, SLOTS), UNUSED),
        np.zeros((m, SLOTS)),
        np.zeros((m, SLOTS, 3)),
        np.zeros((m, 3)),
    )


def packed(anchors: Anchors) -> Array:
    """Anchors as numbers, flat."""
    m = len(anchors.keys)
    if not m:
        return np.empty(0)
    return np.concatenate([part.reshape(m, -1) for part in anchors], axis=1).ravel()


def unpacked(numbers: Array) -> Anchors:
    """What was :func:`packed`."""
    rows = numbers.reshape(-1, _COLUMNS)
    ends = np.cumsum([2, SLOTS, SLOTS, 3 * SLOTS])
    keys, nodes, weights, levers, fixed = np.split(rows, ends, axis=1)
    return Anchors(
        keys.astype(np.int64),
        nodes.astype(np.int64),
        weights.copy(),
        levers.reshape(-1, SLOTS, 3).copy(),
        fixed.copy(),
    )


def found(known_keys: Indices, keys: Indices) -> Indices:
    """Which of known pairs are those of other keys; −1: none."""
    index = np.full(len(keys), -1, dtype=np.int64)
    if not len(known_keys) or not len(keys):
        return index
    most = 1 + max(int(known_keys[:, 1].max()), int(keys[:, 1].max()))
    known = known_keys[:, 0] * most + known_keys[:, 1]
    wanted, order = keys[:, 0] * most + keys[:, 1], np.argsort(known, kind="stable")
    at = np.minimum(np.searchsorted(known[order], wanted), len(known) - 1)
    there = known[order][at] == wanted
    index[there] = order[at][there]
    return index


@inlined_uncounted
def _anchor(H: Array, side: Side, i: int, off: Vector, sign: float, out: Anchors, e: int) -> None:
    """A place of a side, moved by ``off``, as a material point."""
    first = 0 if sign > 0.0 else MOST_NODES
    for k in range(MOST_NODES):
        node = side.nodes[i, k]
        if node == UNUSED:
            break
        w, c = side.weights[i, k], load_row(side.levers[i], k)
        if node == GROUND:
            moved = combined(sign, c, sign * w, off)
            store_row(out.fixed, e, plus(load_row(out.fixed, e), moved))
            continue
        out.nodes[e, first + k], out.weights[e, first + k] = node, sign * w
        moved = combined(sign, c, sign * w, local_components(H[node], off))
        store_row(out.levers[e], first + k, moved)


@compiled
def set_anchors(H: Array, at: Meeting, a: Side, b: Side, springs: Array, out: Anchors) -> None:
    """Anchors at frames ``H`` with springs stretched by ``springs`` (m, 3), into empty ones.

    Args:
        H: Frames.
        at: Pairs of places.
        a: What anchors of the first side are fixed to.
        b: Of the second.
        springs: By how much the second is short.
        out: Overwritten.
    """
    for e in range(at.pairs.shape[0]):
        i, j = at.pairs[e]
        _, n, P = gap(H, at.a, at.b, i, j, at.flat)
        off = scaled(-at.a.radii[i], n)
        _anchor(H, a, i, plus(off, minus(P, place(H, a, i))), 1.0, out, e)
        short = minus(plus(P, off), load_row(springs, e))
        _anchor(H, b, j, minus(short, place(H, b, j)), -1.0, out, e)


@inlined_uncounted
def stretch_of(H: Array, anchors: Anchors, q: int) -> Vector:
    """``u`` of an anchor."""
    u = load_row(anchors.fixed, q)
    for s in range(SLOTS):
        node = anchors.nodes[q, s]
        if node >= 0:
            u = plus(u, scaled(anchors.weights[q, s], load_row(H[node], 0)))
            u = plus(u, global_components(H[node], load_row(anchors.levers[q], s)))
    return u


class Traction(NamedTuple):
    """Traction of one pair, for a weight of one.

    Attributes:
        τ: Its components, global.
        along: Its direction, where it slips.
        size: ``|u_T|``.
        slips: Whether it does.
    """

    τ: Vector
    along: Vector
    size: float
    slips: bool


@inlined_uncounted
def traction(law: CoulombLaw, g: float, n: Vector, u: Vector) -> Traction:
    """Of a pair that overlaps."""
    across = combined(1.0, u, -dot(n, u), n)
    size = np.sqrt(dot(across, across))
    τ, slips = returned(law, size, limit(law, -g))
    if not slips:
        return Traction(scaled(law.holding, across), (0.0, 0.0, 0.0), size, False)
    along = scaled(1.0 / size, across)
    return Traction(scaled(τ, along), along, size, True)


@compiled
def tractions(
    H: Array, at: Meeting, anchors: Anchors, which: Indices, law: CoulombLaw, out: Array
) -> None:
    """Tractions on the second side, of pairs without an anchor none: (m, 3)."""
    for e in range(at.pairs.shape[0]):
        i, j = at.pairs[e]
        store_row(out, e, (0.0, 0.0, 0.0))
        g, n, _ = gap(H, at.a, at.b, i, j, at.flat)
        if g < 0.0 and which[e] >= 0:
            store_row(out, e, traction(law, g, n, stretch_of(H, anchors, which[e])).τ)


@compiled
def add_tractions(
    H: Array, at: Meeting, anchors: Anchors, which: Indices, τ: Array, grounded: bool, out: Array
) -> None:
    """Add tractions to forces, of all pairs or of those with ground alone."""
    for e in range(at.pairs.shape[0]):
        i, j = at.pairs[e]
        q, t = which[e], scaled(at.weight[e], load_row(τ, e))
        apart = at.a.owners[i] != GROUND and at.b.owners[j] != GROUND
        if q < 0 or dot(t, t) == 0.0 or (grounded and apart):
            continue
        for s in range(SLOTS):
            node = anchors.nodes[q, s]
            if node < 0:
                continue
            f = local_components(H[node], t)
            moment = cross(load_row(anchors.levers[q], s), f)
            for k in range(3):
                out[node, k] += anchors.weights[q, s] * f[k]
                out[node, 3 + k] += moment[k]
