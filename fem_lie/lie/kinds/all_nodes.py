"""What :mod:`.motion` and :mod:`.forces` do with one node, for all nodes of any kinds: compiled."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled, inlined, uncounted
from fem_lie._jit.copies import copy_matrix
from fem_lie.lie import motions
from fem_lie.lie.kinds.forces import pull, push
from fem_lie.lie.kinds.kind import SLOPE, axes, set_axes
from fem_lie.lie.kinds.motion import (
    bend,
    follow,
    from_group,
    from_local,
    move,
    rigid,
    settle,
    shown,
    tangent,
    to_group,
    turn,
    turn_back,
)
from fem_lie.lie.tuples import (
    Vector,
    cross,
    load,
    load_frame,
    load_row,
    minus,
    plus,
    rotate,
    rotate_back,
    store,
    store_row,
    store_rows,
)


@compiled
def all_axes(kinds: Indices, H: Array) -> Array:
    """:func:`axes` of nodes (n,) as rows, shape (n, 3, 3)."""
    out = np.empty((kinds.shape[0], 3, 3))
    for i in range(kinds.shape[0]):
        d1, d2, d3 = axes(kinds[i], H[i])
        store_rows(out[i], 0, d1, d2, d3)
    return out


class Written(NamedTuple):
    """How velocities, accelerations and the like of all nodes are written, k of them.

    Attributes:
        local: Which have components in the axes of nodes of any kind, shape (k,); others have
            global ones, but for what of frames is in their axes.
        rate_of: Of which each is the rate, −1 for none, shape (k,).
    """

    local: Flags
    rate_of: Indices


def write_in_new_axes(
    kinds: Indices, nodes: Indices, before: Array, after: Array, written: Written, motion: Array
) -> None:
    """Write in the axes of some nodes what was written in those they had.

    The spin of a frame is about its first axis, and goes along with it.

    Args:
        kinds: Of all nodes, shape (n,).
        nodes: Which, shape (m,).
        before: Their rows as they were, shape (m, 4, 3).
        after: As they are, likewise.
        written: How ``motion`` is written.
        motion: Velocities, accelerations and the like, changed, shape (k, n, 6).
    """
    _write_in_new_axes(kinds, nodes, before, after, *written, motion)


@compiled
def _write_in_new_axes(
    kinds: Indices,
    nodes: Indices,
    before: Array,
    after: Array,
    local: Flags,
    rate_of: Indices,
    motion: Array,
) -> None:
    for m in range(nodes.shape[0]):
        i = nodes[m]
        kind = kinds[i]
        frame = kind < SLOPE
        old, new = axes(kind, before[m]), axes(kind, after[m])
        # rates first, which need velocities as they were
        for rates in (True, False):
            for k in range(motion.shape[0]):
                # of frames all is in them, but for the translations of those on R³×SO(3)
                if (rate_of[k] >= 0) != rates or not (local[k] or (frame and kind & 1 == 0)):
                    continue
                if not frame:
                    for half in range(2):
                        moved = _turned(old, new, load(motion[k, i], 3 * half))
                        store(motion[k, i], 3 * half, moved)
                    continue
                u = load(motion[k, i], 0)
                if not rates:
                    store(motion[k, i], 0, _turned(old, new, u))
                    continue
                v, ω = load(motion[rate_of[k], i], 0), load(motion[rate_of[k], i], 3)
                # ẍ = R (v̇ + ω × v) is the same in both
                moved = _turned(old, new, plus(u, cross(ω, v)))
                store(motion[k, i], 0, minus(moved, cross(ω, _turned(old, new, v))))


@inlined
def _turned(
    old: tuple[Vector, Vector, Vector], new: tuple[Vector, Vector, Vector], a: Vector
) -> Vector:
    """What has components ``a`` in some axes, in others."""
    return rotate_back(new[0], new[1], new[2], rotate(old[0], old[1], old[2], a))


@compiled
def set_all_axes(kinds: Indices, H: Array, R: Array) -> None:
    """:func:`set_axes` of nodes (n,) to rows (n, 3, 3)."""
    for i in range(kinds.shape[0]):
        set_axes(kinds[i], H[i], load_row(R[i], 0), load_row(R[i], 1), load_row(R[i], 2))


@compiled
def move_all(kinds: Indices, H: Array, d: Array, out: Array) -> None:
    """:func:`move` for nodes (n,)."""
    for i in range(kinds.shape[0]):
        move(kinds[i], H[i], d[i], out[i])


@compiled
def follow_all(kinds: Indices, H: Array, h: Array, out: Array) -> None:
    """:func:`follow` for nodes (n,)."""
    for i in range(kinds.shape[0]):
        follow(kinds[i], H[i], h[i], out[i])


@compiled
def twists(kinds: Indices, d: Array, x: Array, out: Array) -> None:
    """``T(d) x`` of all nodes, shapes (n, 6)."""
    T = np.empty((6, 6))
    for i in range(kinds.shape[0]):
        tangent(kinds[i], d[i], T)
        for k in range(6):
            out[i, k] = 0.0
            for n in range(6):
                out[i, k] += T[k, n] * x[i, n]


@compiled
def all_from_local(
    kinds: Indices, H: Array, twist: Array, rate: Array, v: Array, vdot: Array
) -> None:
    """:func:`from_local` for nodes (n,)."""
    for i in range(kinds.shape[0]):
        from_local(kinds[i], H[i], twist[i], rate[i], v[i], vdot[i])


@compiled
def all_to_group(kinds: Indices, H: Array, x: Array) -> None:
    """:func:`to_group` for nodes (n,), shape (n, 6), in place."""
    for i in range(kinds.shape[0]):
        to_group(kinds[i], H[i], x[i])


@compiled
def all_from_group(kinds: Indices, H: Array, x: Array) -> None:
    """:func:`from_group` for nodes (n,), shape (n, 6), in place."""
    for i in range(kinds.shape[0]):
        from_group(kinds[i], H[i], x[i])


@compiled
def bend_all(kinds: Indices, v: Array, vdot: Array, out: Array) -> None:
    """:func:`bend` for nodes (n,), shapes (n, 6)."""
    for i in range(kinds.shape[0]):
        bend(kinds[i], v[i], vdot[i], out[i])


@compiled
def turn_all(kinds: Indices, H: Array, r: Array) -> None:
    """:func:`turn` for the rows (6 n,) of nodes (n,) at the head of ``r``."""
    for i in range(kinds.shape[0]):
        turn(kinds[i], H[i], r[6 * i : 6 * i + 6])


@compiled
def turn_all_back(kinds: Indices, H: Array, r: Array) -> None:
    """:func:`turn_back` for the rows (6 n,) of nodes (n,) at the head of ``r``."""
    for i in range(kinds.shape[0]):
        turn_back(kinds[i], H[i], r[6 * i : 6 * i + 6])


@compiled
def rigid_motions(kinds: Indices, H: Array, about: Array) -> Array:
    """:func:`rigid` for nodes (n,), turning about a place (3,), shape (n, 6, 6)."""
    out, node = np.empty((kinds.shape[0], 6, 6)), np.empty((4, 3))
    for i in range(kinds.shape[0]):
        copy_matrix(H[i], node)
        for c in range(3):
            node[0, c] -= about[c]
        rigid(kinds[i], node, out[i])
    return out


@uncounted
def shown_all(kinds: Indices, H: Array, v: Array, out: Array) -> None:
    """:func:`shown` for nodes (n,), shapes (n, 6)."""
    for i in range(kinds.shape[0]):
        shown(kinds[i], H[i], v[i], out[i])


@uncounted
def push_all(kinds: Indices, H: Array, v: Array, out: Array) -> None:
    """:func:`push` for nodes (n,), shape (n, 4, 3)."""
    for i in range(kinds.shape[0]):
        push(kinds[i], H[i], v[i], out[i])


@uncounted
def pull_all(kinds: Indices, H: Array, f: Array, sign: float, r: Array) -> None:
    """:func:`pull` for nodes (n,), shapes (n, 4, 3) and (6 n,)."""
    for i in range(kinds.shape[0]):
        pull(kinds[i], H[i], f[i], sign, r[6 * i : 6 * i + 6])


@inlined
def _go_straight(H: Array, h: Array) -> None:
    """Move a frame by ``x + R u``, ``R exp(η)``; the first half of ``h`` is lost."""
    x, d1, d2, d3 = load_frame(H)
    moved = plus(x, rotate(d1, d2, d3, load(h, 0)))
    store(h, 0, (0.0, 0.0, 0.0))
    lie.retract(H, h, H)
    lie.reorthonormalise(H)
    store_row(H, 0, moved)


@compiled
def advance(
    kinds: Indices,
    H: Array,
    dx: Array,
    held: Flags,
    uncoupled: Flags,
    straight: Flags,
) -> None:
    """Move the nodes by ``−dx`` in their axes.

    Frames by ``H exp(−dx)``, or where they are uncoupled by :func:`fem_lie.lie.motions.retract`, or
    where they go straight by ``x + R u``, ``R exp(η)``.
    """
    h = np.empty((1, 6))
    for i in range(held.shape[0]):
        if not held[i].all():
            for k in range(6):
                h[0, k] = -dx[6 * i + k]
            if uncoupled[i]:
                motions.retract(H[i : i + 1], h)
            elif straight[i] and kinds[i] < SLOPE:
                _go_straight(H[i], h[0])
            else:
                follow(kinds[i], H[i], h[0], H[i])
                settle(kinds[i], H[i])
