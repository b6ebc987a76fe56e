"""Rows of velocities of contacts in the twists of all nodes, for bodies of whatever sort."""

from __future__ import annotations

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie._jit import uncounted
from fem_lie.contact.impact.records import Touch
from fem_lie.contact.impact.rows import axis_of, tangents
from fem_lie.contact.sides.kinematics import SLOTS, gap, place, slot
from fem_lie.contact.sides.surfaces import MOST_NODES
from fem_lie.contact.sides.table import Side
from fem_lie.lie.motions import local_components
from fem_lie.lie.tuples import cross, minus, plus, scaled


def on_leaders(side: Side, leader: Indices, offset: Array) -> Side:
    """The same places, by the nodes that their nodes follow.

    Args:
        side: On all nodes.
        leader: Of each node, shape (N,).
        offset: Its frame in that of its leader, shape (N, 4, 3).
    """
    moved = side._replace(
        nodes=side.nodes.copy(), levers=side.levers.copy(), normals=side.normals.copy()
    )
    for i, k in np.argwhere(side.nodes >= 0):
        node = side.nodes[i, k]
        x, R = lie.position(offset[node]), lie.rotation(offset[node])
        moved.nodes[i, k] = leader[node]
        moved.levers[i, k] = side.weights[i, k] * x + R @ side.levers[i, k]
        if k == 0:
            moved.normals[i] = R @ side.normals[i]
    return moved


@uncounted
def choose_axes(H: Array, touch: Touch, chosen: Indices, axis: Indices) -> None:
    """Axes by which tangents of contacts are chosen, shape (k,)."""
    for e in range(chosen.shape[0]):
        axis[e] = axis_of(H, touch, chosen[e])


@uncounted
def set_rows(H: Array, touch: Touch, chosen: Indices, axis: Indices, B: Array) -> None:
    """Rows along normals and two tangents, in the twists of all rows of frames.

    Args:
        H: Frames of all rows.
        touch: Pairs.
        chosen: Which of them, shape (k,).
        axis: See :func:`choose_axes`.
        B: Overwritten, shape (k, 3, rows, 6).
    """
    B[:] = 0.0
    for e in range(chosen.shape[0]):
        c = chosen[e]
        i, j = touch.pairs[c]
        _, n, P = gap(H, touch.a, touch.b, i, j, touch.flat[c])
        at = minus(P, scaled(touch.a.radii[i], n))
        t1, t2 = tangents(H, touch, j, n, axis[e])
        beyond = minus(at, P if touch.flat[c] else place(H, touch.b, j))
        for s in range(SLOTS):
            node, sign, w, lever = slot(H, touch.a, touch.b, i, j, touch.flat[c], P, s)
            if node < 0:
                continue
            # the point of contact turns with its nodes
            off = minus(at, P) if s < MOST_NODES else beyond
            lever = plus(lever, scaled(w, local_components(H[node], off)))
            for k in range(3):
                d = n if k == 0 else (t1 if k == 1 else t2)
                f = local_components(H[node], scaled(sign, d))
                moment = cross(lever, f)
                for x in range(3):
                    B[e, k, node, x] += w * f[x]
                    B[e, k, node, 3 + x] += moment[x]


@uncounted
def show_places(H: Array, touch: Touch, chosen: Indices, axis: Indices, out: Array) -> None:
    """Points of the first sides that are nearest, normals and tangents, shape (k, 4, 3)."""
    for e in range(chosen.shape[0]):
        i, j = touch.pairs[chosen[e]]
        _, n, P = gap(H, touch.a, touch.b, i, j, touch.flat[chosen[e]])
        at = minus(P, scaled(touch.a.radii[i], n))
        t1, t2 = tangents(H, touch, j, n, axis[e])
        for k in range(3):
            out[e, 0, k], out[e, 1, k], out[e, 2, k], out[e, 3, k] = at[k], n[k], t1[k], t2[k]
