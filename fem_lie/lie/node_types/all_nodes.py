"""Loops over nodes of the operations of :mod:`.motion` and :mod:`.forces`: compiled."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled, inlined, uncounted
from fem_lie._jit.copies import copy_matrix
from fem_lie.lie import motions
from fem_lie.lie.node_types.forces import pull_back, push_forward
from fem_lie.lie.node_types.motion import (
    cubic_term,
    from_group,
    from_local,
    go_on,
    move,
    reorthonormalise,
    result_twist,
    retract,
    rigid_twists,
    tangent,
    to_global_components,
    to_group,
    to_local,
    to_nodal_components,
)
from fem_lie.lie.node_types.node_type import POSITION_GRADIENT, axes, set_axes
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
def all_axes(node_types: Indices, H: Array) -> Array:
    """Axes of nodes as rows, shape (n, 3, 3), see :func:`axes`."""
    out = np.empty((node_types.shape[0], 3, 3))
    for i in range(node_types.shape[0]):
        d1, d2, d3 = axes(node_types[i], H[i])
        store_rows(out[i], 0, d1, d2, d3)
    return out


class Written(NamedTuple):
    """Components in which velocities, accelerations and similar fields of all nodes are stored.

    There are k such fields.

    Attributes:
        local: Fields with components along the axes of nodes of all types, shape (k,); others have
            global components, except for those of frames that are local by their group.
        rate_of: Index of the field of which each is the rate, −1 for none, shape (k,).
    """

    local: Flags
    rate_of: Indices


def change_axes(
    node_types: Indices,
    nodes: Indices,
    before: Array,
    after: Array,
    written: Written,
    motion: Array,
) -> None:
    """Transform velocities and similar fields of some nodes to new axes of these nodes.

    The spin of a frame is about its first axis, and is rotated with it.

    Args:
        node_types: Types of all nodes, shape (n,).
        nodes: Nodes with new axes, shape (m,).
        before: Their coordinates with the old axes, shape (m, 4, 3).
        after: Their coordinates with the new axes, shape (m, 4, 3).
        written: Components in which ``motion`` is stored.
        motion: Velocities, accelerations and similar fields, transformed in place, shape (k, n, 6).
    """
    _write_in_new_axes(node_types, nodes, before, after, *written, motion)


@compiled
def _write_in_new_axes(
    node_types: Indices,
    nodes: Indices,
    before: Array,
    after: Array,
    local: Flags,
    rate_of: Indices,
    motion: Array,
) -> None:
    for m in range(nodes.shape[0]):
        i = nodes[m]
        node_type = node_types[i]
        frame = node_type < POSITION_GRADIENT
        old, new = axes(node_type, before[m]), axes(node_type, after[m])
        # rates first, which need velocities as they were
        for rates in (True, False):
            for k in range(motion.shape[0]):
                # fields of frames are local, except for translations on R³×SO(3)
                if (rate_of[k] >= 0) != rates or not (local[k] or (frame and node_type & 1 == 0)):
                    continue
                if not frame:
                    for part in range(2):
                        moved = _in_new_axes(old, new, load(motion[k, i], 3 * part))
                        store(motion[k, i], 3 * part, moved)
                    continue
                u = load(motion[k, i], 0)
                if not rates:
                    store(motion[k, i], 0, _in_new_axes(old, new, u))
                    continue
                v, ω = load(motion[rate_of[k], i], 0), load(motion[rate_of[k], i], 3)
                # ẍ = R (v̇ + ω × v) is the same in both
                moved = _in_new_axes(old, new, plus(u, cross(ω, v)))
                store(motion[k, i], 0, minus(moved, cross(ω, _in_new_axes(old, new, v))))


@inlined
def _in_new_axes(
    old: tuple[Vector, Vector, Vector], new: tuple[Vector, Vector, Vector], a: Vector
) -> Vector:
    """Components in the new axes of a vector with components ``a`` in the old ones."""
    return rotate_back(new[0], new[1], new[2], rotate(old[0], old[1], old[2], a))


@compiled
def set_all_axes(node_types: Indices, H: Array, R: Array) -> None:
    """Rotate the axes of nodes (n,) to the rows of ``R`` (n, 3, 3), see :func:`set_axes`."""
    for i in range(node_types.shape[0]):
        set_axes(node_types[i], H[i], load_row(R[i], 0), load_row(R[i], 1), load_row(R[i], 2))


@compiled
def move_all(node_types: Indices, H: Array, d: Array, out: Array) -> None:
    """:func:`move` for nodes (n,).

    Args:
        node_types: Node types, shape (n,).
        H: Frames of all nodes, shape (n, 4, 3).
        d: Increments of all nodes, shape (n, 6).
        out: The result, written in place.
    """
    for i in range(node_types.shape[0]):
        move(node_types[i], H[i], d[i], out[i])


@compiled
def go_all_on(node_types: Indices, start: Array, H: Array, out: Array) -> None:
    """:func:`go_on` for nodes (n,)."""
    for i in range(node_types.shape[0]):
        go_on(node_types[i], start[i], H[i], out[i])


@compiled
def retract_all(node_types: Indices, H: Array, h: Array, out: Array) -> None:
    """:func:`retract` for nodes (n,)."""
    for i in range(node_types.shape[0]):
        retract(node_types[i], H[i], h[i], out[i])


@compiled
def twists(node_types: Indices, d: Array, x: Array, out: Array) -> None:
    """``T(d) x`` of all nodes, shapes (n, 6)."""
    T = np.empty((6, 6))
    for i in range(node_types.shape[0]):
        tangent(node_types[i], d[i], T)
        for k in range(6):
            out[i, k] = 0.0
            for n in range(6):
                out[i, k] += T[k, n] * x[i, n]


@compiled
def all_from_local(
    node_types: Indices, H: Array, twist: Array, rate: Array, v: Array, vdot: Array
) -> None:
    """:func:`from_local` for nodes (n,)."""
    for i in range(node_types.shape[0]):
        from_local(node_types[i], H[i], twist[i], rate[i], v[i], vdot[i])


@compiled
def all_to_local(
    node_types: Indices, H: Array, v: Array, vdot: Array, twist: Array, rate: Array
) -> None:
    """:func:`to_local` for nodes (n,)."""
    for i in range(node_types.shape[0]):
        to_local(node_types[i], H[i], v[i], vdot[i], twist[i], rate[i])


@compiled
def all_to_group(node_types: Indices, H: Array, x: Array) -> None:
    """:func:`to_group` for nodes (n,), shape (n, 6), in place."""
    for i in range(node_types.shape[0]):
        to_group(node_types[i], H[i], x[i])


@compiled
def all_from_group(node_types: Indices, H: Array, x: Array) -> None:
    """:func:`from_group` for nodes (n,), shape (n, 6), in place."""
    for i in range(node_types.shape[0]):
        from_group(node_types[i], H[i], x[i])


@compiled
def all_cubic_terms(node_types: Indices, v: Array, vdot: Array, out: Array) -> None:
    """:func:`cubic_term` for nodes (n,), shapes (n, 6)."""
    for i in range(node_types.shape[0]):
        cubic_term(node_types[i], v[i], vdot[i], out[i])


@compiled
def all_to_global_components(node_types: Indices, H: Array, r: Array) -> None:
    """:func:`to_global_components` for the first 6 n entries of ``r``, those of nodes (n,)."""
    for i in range(node_types.shape[0]):
        to_global_components(node_types[i], H[i], r[6 * i : 6 * i + 6])


@compiled
def all_to_nodal_components(node_types: Indices, H: Array, r: Array) -> None:
    """:func:`to_nodal_components` for the first 6 n entries of ``r``, those of nodes (n,)."""
    for i in range(node_types.shape[0]):
        to_nodal_components(node_types[i], H[i], r[6 * i : 6 * i + 6])


@compiled
def rigid_motions(node_types: Indices, H: Array, about: Array) -> Array:
    """:func:`rigid_twists` of nodes (n,), rotations about ``about`` (3,), shape (n, 6, 6)."""
    out, node = np.empty((node_types.shape[0], 6, 6)), np.empty((4, 3))
    for i in range(node_types.shape[0]):
        copy_matrix(H[i], node)
        for c in range(3):
            node[0, c] -= about[c]
        rigid_twists(node_types[i], node, out[i])
    return out


@uncounted
def all_result_twists(node_types: Indices, H: Array, v: Array, out: Array) -> None:
    """:func:`result_twist` for nodes (n,), shapes (n, 6)."""
    for i in range(node_types.shape[0]):
        result_twist(node_types[i], H[i], v[i], out[i])


@uncounted
def push_all_forward(node_types: Indices, H: Array, v: Array, out: Array) -> None:
    """:func:`push_forward` for nodes (n,), shape (n, 4, 3)."""
    for i in range(node_types.shape[0]):
        push_forward(node_types[i], H[i], v[i], out[i])


@uncounted
def pull_all_back(node_types: Indices, H: Array, f: Array, sign: float, r: Array) -> None:
    """:func:`pull_back` for nodes (n,), shapes (n, 4, 3) and (6 n,)."""
    for i in range(node_types.shape[0]):
        pull_back(node_types[i], H[i], f[i], sign, r[6 * i : 6 * i + 6])


@inlined
def _go_straight(H: Array, h: Array) -> None:
    """Move a frame by ``x + R u``, ``R exp(η)`` with ``h = (u, η)``; ``h[:3]`` is overwritten."""
    x, d1, d2, d3 = load_frame(H)
    moved = plus(x, rotate(d1, d2, d3, load(h, 0)))
    store(h, 0, (0.0, 0.0, 0.0))
    lie.retract(H, h, H)
    lie.reorthonormalise(H)
    store_row(H, 0, moved)


@compiled
def advance(
    node_types: Indices,
    H: Array,
    dx: Array,
    held: Flags,
    separates_director: Flags,
    separates_rotation: Flags,
) -> None:
    """Move the nodes by ``−dx`` along their axes.

    Frames move by ``H exp(−dx)``; by :func:`fem_lie.lie.motions.retract` where translation and
    rotation move separately; by ``x + R u``, ``R exp(η)`` where ``separates_rotation`` is set.
    """
    h = np.empty((1, 6))
    for i in range(held.shape[0]):
        if not held[i].all():
            for k in range(6):
                h[0, k] = -dx[6 * i + k]
            if separates_director[i]:
                motions.retract(H[i : i + 1], h)
            elif separates_rotation[i] and node_types[i] < POSITION_GRADIENT:
                _go_straight(H[i], h[0])
            else:
                retract(node_types[i], H[i], h[0], H[i])
                reorthonormalise(node_types[i], H[i])
