"""What lies between both ends of a step, of nodes of any type; compiled.

Frames turn by Cayley's map (:mod:`.cayley`); of other nodes the coordinates whose increments add
move along a straight line. An increment of a node is six numbers along global axes: of a frame its
translation and the vector of Cayley's map, of other nodes both coordinate vectors.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined, inlined_uncounted, uncounted
from fem_lie._jit.stack import stack, vector_at
from fem_lie.forms.fixed_arrays import as_frames, as_sixes
from fem_lie.lie.kinds import inertia
from fem_lie.lie.kinds.kind import SLOPE, carry, first, straight
from fem_lie.lie.kinds.motion import from_local, to_local
from fem_lie.lie.tuples import (
    Vector,
    cross,
    load,
    load_row,
    minus,
    plus,
    rotate,
    rotate_back,
    store,
    store_row,
)
from fem_lie.solve.conserving.between.cayley import span_one, spin


@inlined_uncounted
def as_rows(kind: int, coordinates: Array, out: Array) -> None:
    """Both coordinate vectors (6,) of a node that is no frame as rows (4, 3); others are zero."""
    at = first(kind)
    for k in range(4):
        store_row(out, k, (0.0, 0.0, 0.0))
    for k in range(straight(kind)):
        store_row(out, at + k, load(coordinates, 3 * k))


@inlined_uncounted
def rates_of(kind: int, H: Array, V: Array, out: Array) -> None:
    """Rates (6,) of increments, from those of the rows, (4, 3)."""
    if kind < SLOPE:
        store(out, 0, load_row(V, 0))
        store(out, 3, spin(H, V))
    else:
        at = first(kind)
        store(out, 3, (0.0, 0.0, 0.0))
        for k in range(straight(kind)):
            store(out, 3 * k, load_row(V, at + k))


@uncounted
def span_all(
    kinds: Indices, H: Array, step: Array, rows: tuple[Array, Array, Array, Array]
) -> None:
    """Increments, means, ends and mid-step configurations of all nodes that move.

    Args:
        kinds: Types of the nodes, (n,).
        H: Rows at the start, (≥ n, 4, 3).
        step: Increments, (n, 6).
        rows: Increments of rows, means, ends, and nodes in the middle of the step, whose axes those
            of the unknowns are, (≥ n, 4, 3) each, overwritten.
    """
    delta, mean, end, middle = rows
    H, step, delta, mean = as_frames(H), as_sixes(step), as_frames(delta), as_frames(mean)
    end, middle, half = as_frames(end), as_frames(middle), vector_at(stack(6), 6)
    for i in range(step.shape[0]):
        kind = kinds[i]
        if kind < SLOPE:
            span_one(H[i], step[i], delta[i], mean[i], end[i], middle[i])
        else:
            for k in range(6):
                half[k] = 0.5 * step[i, k]
            carry(kind, H[i], half, middle[i])
            carry(kind, H[i], step[i], end[i])
            for k in range(4):
                store_row(mean[i], k, load_row(middle[i], k))
            as_rows(kind, step[i], delta[i])


@compiled
def span_from_python(
    kinds: Indices, H: Array, step: Array, rows: tuple[Array, Array, Array, Array]
) -> None:
    """:func:`span_all`, from Python."""
    span_all(kinds, H, step, rows)


@compiled
def keep_axes(kinds: Indices, end: Array, H: Array) -> None:
    """Give rows ``H`` the axes of ``end``, (≥ n, 4, 3), where those of a node follow its slope."""
    for i in range(kinds.shape[0]):
        if kinds[i] == SLOPE:
            store_row(H[i], 2, load_row(end[i], 2))
            store_row(H[i], 3, load_row(end[i], 3))


@inlined
def _turned(H: Array, a: Vector) -> Vector:
    return rotate(load_row(H, 1), load_row(H, 2), load_row(H, 3), a)


@compiled
def twists(
    kinds: Indices, turning: Array, H: Array, V: Array, rates: Array, v: Array, a: Array
) -> None:
    """Velocities and their rates (n, 6) along the axes of nodes ``H``.

    Args:
        kinds: Types of the nodes, (n,).
        turning: Of directors, see :func:`~fem_lie.lie.kinds.inertia.turning_of`.
        H: Rows of the nodes.
        V: Rates of all rows, (n, 4, 3).
        rates: Of the rates of increments, (n, 6).
        v: Overwritten.
        a: Overwritten.
    """
    own = np.empty(6)
    inertia.local_twists(H, V, turning, v)
    for i in range(v.shape[0]):
        kind = kinds[i]
        if kind < SLOPE:
            d1, d2, d3 = load_row(H[i], 1), load_row(H[i], 2), load_row(H[i], 3)
            for at in (0, 3):
                store(a[i], at, rotate_back(d1, d2, d3, load(rates[i], at)))
            store(a[i], 0, minus(load(a[i], 0), cross(load(v[i], 3), load(v[i], 0))))
        else:
            rates_of(kind, H[i], V[i], own)
            to_local(kind, H[i], own, rates[i], v[i], a[i])


@compiled
def spatial_rates(kinds: Indices, H: Array, v: Array, rates: Array, out: Array) -> None:
    """Accelerations of increments (n, 6), from twists ``v`` and their ``rates`` along the axes."""
    own = np.empty(6)
    for i in range(out.shape[0]):
        if kinds[i] < SLOPE:
            moved = plus(load(rates[i], 0), cross(load(v[i], 3), load(v[i], 0)))
            store(out[i], 0, _turned(H[i], moved))
            store(out[i], 3, _turned(H[i], load(rates[i], 3)))
        else:
            from_local(kinds[i], H[i], v[i], rates[i], own, out[i])
