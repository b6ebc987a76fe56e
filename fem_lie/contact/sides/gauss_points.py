"""Gauss points of overlapping lines: each is a ball with a position linear in nodes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined_uncounted, uncounted
from fem_lie.contact.sides.curves import (
    Opposite,
    Strands,
    bend,
    nearest,
    plane_of,
    set_overlaps,
    slope,
    slopes,
    weights,
)
from fem_lie.contact.sides.curves import at as position_at
from fem_lie.contact.sides.kinematics import position
from fem_lie.contact.sides.passage import are_apart
from fem_lie.contact.sides.surfaces import MOST_NODES, Piece
from fem_lie.contact.sides.table import (
    GROUND,
    PLANE,
    UNUSED,
    ContactPoints,
    Nodes,
    Samples,
    Side,
    Sliding,
    empty_side,
    number_of,
)
from fem_lie.lie.tuples import Vector, combined, dot, load_row, minus, plus, scaled, store_row

GAUSS = 3
GAUSS_AT, GAUSS_WEIGHT = np.polynomial.legendre.leggauss(GAUSS)
"""Positions in [−1, 1] and weights of the integration points."""

STEPS = 256
"""Largest number of steps of a curved segment; the gap has two extrema at most in each of them."""

_STRAIGHT = 1e-4
"""Distance from the chord over the sum of the radii up to which a segment is straight."""

_BULGE = 1.1
"""Reach of segments from their midpoints over the initial reach: allows for stretching."""


def strands_of(pieces: Sequence[Piece], nodes: Nodes) -> Strands:
    """Segments of lines as packed arrays."""
    m = len(pieces)
    numbers = np.full((m, MOST_NODES), UNUSED)
    weights_, arms = np.zeros((m, MOST_NODES, 4)), np.zeros((m, MOST_NODES, 4, 3))
    after = np.array([piece.following for piece in pieces], dtype=np.int64)
    before = np.full(m, -1)
    before[after[after >= 0]] = np.flatnonzero(after >= 0)
    for i, piece in enumerate(pieces):
        k = len(piece.owners)
        numbers[i, :k] = [number_of(*owner, nodes) for owner in piece.owners]
        weights_[i, :k], arms[i, :k] = piece.weights, piece.arms
    return Strands(
        numbers,
        weights_,
        arms,
        np.array([piece.length for piece in pieces]),
        np.array([piece.chord for piece in pieces]),
        np.ones(m),
        np.array([piece.radius for piece in pieces]),
        before,
        after,
        np.zeros((m, 4, 3)),
        np.zeros(m),
    )


def middles_of(pieces: Sequence[Piece], strands: Strands) -> Side:
    """Balls about the midpoints of segments that enclose the segments."""
    found = empty_side(len(pieces))
    w = np.array(weights(0.5))
    found.nodes[:] = strands.nodes
    found.weights[:] = strands.weights @ w
    found.arms[:] = np.einsum("makj,k->maj", strands.arms, w)
    found.radii[:] = strands.radii + 0.5 * _BULGE * strands.lengths
    # each segment has an owner of its own: segments of the same body touch those of the other side
    found.owners[:] = np.where(strands.nodes[:, 0] == GROUND, GROUND, strands.nodes[:, 0])
    return found


def line_samples(pieces: Sequence[Piece], nodes: Nodes) -> Samples:
    """Gauss points of whole segments of lines as samples."""
    strands = strands_of(pieces, nodes)
    m, found = len(pieces), empty_side(GAUSS * len(pieces))
    for q in range(GAUSS):
        w = np.array(weights(0.5 + 0.5 * GAUSS_AT[q]))
        found.weights[q::GAUSS] = strands.weights @ w
        found.arms[q::GAUSS] = np.einsum("makj,k->maj", strands.arms, w)
    found.nodes[:] = np.repeat(strands.nodes, GAUSS, axis=0)
    found.radii[:] = np.repeat(strands.radii, GAUSS)
    found.owners[:] = found.nodes[:, 0]
    measures = np.tile(0.5 * GAUSS_WEIGHT, m) * np.repeat(strands.lengths, GAUSS)
    return Samples(found, found, measures)


def intervals() -> Array:
    """Workspace for the overlapping intervals of a segment."""
    return np.empty((4 * STEPS, 2))


@uncounted
def set_position(strands: Strands, i: int, s: float, out: Side, q: int) -> None:
    """Store a point of a segment as a ball."""
    for a in range(MOST_NODES):
        out.nodes[q, a] = strands.nodes[i, a]
    _set_factors(strands, i, weights(s), out.weights[q], out.arms[q])
    out.radii[q] = strands.radii[i]
    out.owners[q] = strands.nodes[i, 0]


@uncounted
def set_sliding(b: Strands, j: int, σ: float, P: Vector, out: Sliding, q: int) -> None:
    """Set how the closest point to ``P`` moves along a segment."""
    D = b.curves[j]
    separation, t = minus(P, position_at(D, σ)), slope(D, σ)
    store_row(out.slopes[q], 0, scaled(1.0 if 0.0 < σ < 1.0 else 0.0, t))
    out.bends[q, 0] = dot(t, t) - dot(separation, bend(D, σ))
    _set_factors(b, j, slopes(σ), out.weights[q, 0], out.arms[q, 0])


@inlined_uncounted
def _set_factors(
    strands: Strands, i: int, w: tuple[float, float, float, float], by_positions: Array, arms: Array
) -> None:
    """Set the weights of the nodes of a segment, (4,) and (4, 3), for weights of its vectors."""
    m0, m1 = w[2] * strands.stretches[i], w[3] * strands.stretches[i]
    for a in range(MOST_NODES):
        x, c = strands.weights[i, a], strands.arms[i, a]
        by_positions[a] = w[0] * x[0] + w[1] * x[1] + m0 * x[2] + m1 * x[3]
        ends = combined(w[0], load_row(c, 0), w[1], load_row(c, 1))
        tangents = combined(m0, load_row(c, 2), m1, load_row(c, 3))
        store_row(arms, a, plus(ends, tangents))


def lines_of(strands: Strands) -> Indices:
    """Number of the line that each segment is on, shape (m,)."""
    starts = strands.after[:-1] != np.arange(1, len(strands.after))
    return np.cumsum(np.append(0, starts)).astype(np.int64)


@uncounted
def _add_points(
    a: Strands,
    i: int,
    b: Strands,
    other: Opposite,
    block: Indices,
    parts: Array,
    out: ContactPoints,
    count: int,
) -> int:
    """Add the Gauss points of the intervals where a segment overlaps its opposite."""
    C, bulge, flat = a.curves[i], a.bulges[i], out.kind == PLANE
    for j in range(other.first, other.last + 1):
        bulge = max(bulge, b.bulges[j])
    steps = STEPS if bulge > _STRAIGHT * other.reach else 1
    for part in range(set_overlaps(C, b, other, steps, parts)):
        low, high = parts[part]
        for p in range(GAUSS):
            if count == out.weight.shape[0]:
                return count
            s = 0.5 * (low + high) + 0.5 * (high - low) * GAUSS_AT[p]
            if flat:
                out.pairs[count, 1], out.first[count] = other.first, block[0]
            else:
                square, j, σ = nearest(b, other, position_at(C, s))
                if square == np.inf:
                    continue
                set_position(b, j, σ, out.b, count)
                out.pairs[count, 1], out.first[count] = count, block[j - other.first]
                set_sliding(b, j, σ, position_at(C, s), out.sliding, count)
            set_position(a, i, s, out.a, count)
            out.pairs[count, 0] = count
            out.weight[count] = 0.5 * (high - low) * GAUSS_WEIGHT[p] * a.lengths[i]
            count += 1
    return count


@uncounted
def set_points(
    H: Array,
    a: Strands,
    b: Strands,
    planes: Side,
    runs: Indices,
    blocks: Indices,
    parts: Array,
    out: ContactPoints,
) -> int:
    """Set the Gauss points of all overlapping intervals; ``parts``: workspace for these.

    Runs are divided between segments that may touch and have others between them that cannot. So
    contact points do not depend on the margin of the list of pairs where a line bends around and
    touches with both of its sides.

    Returns:
        Their number, which is the size of ``out`` if that is too small.
    """
    count, nowhere = 0, (0.0, 0.0, 0.0)
    for run in range(runs.shape[0]):
        i, first, last, e = runs[run, 0], runs[run, 1], runs[run, 2], runs[run, 3]
        if out.kind == PLANE:
            other = plane_of(H, planes, first, a.radii[i])
            if not are_apart(a, i, a, other):
                count = _add_points(a, i, a, other, blocks[e:], parts, out, count)
            continue
        # groups of segments that may touch, divided in the middle of those between that cannot
        reach, low, last_near = a.radii[i] + b.radii[first], first, -1
        for j in range(first, last + 1):
            if are_apart(a, i, b, Opposite(j, j, nowhere, nowhere, reach)):
                continue
            if -1 < last_near < j - 1:
                middle = (last_near + j) // 2
                other = Opposite(low, middle, nowhere, nowhere, reach)
                count = _add_points(a, i, b, other, blocks[e + low - first :], parts, out, count)
                low = middle + 1
            last_near = j
        if last_near > -1:
            other = Opposite(low, last, nowhere, nowhere, reach)
            count = _add_points(a, i, b, other, blocks[e + low - first :], parts, out, count)
    return count


@compiled
def set_nearest_of_lines(
    H: Array,
    samples: Samples,
    b: Strands,
    runs: Indices,
    blocks: Indices,
    beyond: float,
    out: ContactPoints,
    keys: Indices,
) -> int:
    """Set the closest points of lines to points of a first side; return their number.

    Args:
        H: Frames.
        samples: The points.
        b: Segments of lines, with curves at these frames.
        runs: Points, and the first and the last of consecutive segments near them, first pair.
        blocks: First matrix block of each pair.
        beyond: Distance over the sum of the radii up to which points are set.
        out: Overwritten.
        keys: Points and first segments, overwritten; shape (0, 2): not needed.
    """
    count, nowhere = 0, (0.0, 0.0, 0.0)
    for run in range(runs.shape[0]):
        i, first, last, e = runs[run, 0], runs[run, 1], runs[run, 2], runs[run, 3]
        P, reach = position(H, samples.at, i), samples.at.radii[i] + b.radii[first]
        square, j, σ = nearest(b, Opposite(first, last, nowhere, nowhere, reach), P)
        if not square < (beyond * reach) ** 2:
            continue
        set_position(b, j, σ, out.b, count)
        set_sliding(b, j, σ, P, out.sliding, count)
        out.pairs[count, 0], out.pairs[count, 1] = i, count
        out.weight[count], out.first[count] = samples.measures[i], blocks[e + j - first]
        if keys.shape[0] > 0:
            keys[count, 0], keys[count, 1] = i, first
        count += 1
    return count


@compiled
def set_separations(
    start: Array, end: Array, a: Side, b: Strands, runs: Indices, feet: Side, out: Array
) -> None:
    """Vectors from the closest points of lines to points, at both ends of a step, (2, r, 3).

    Those at the end are from the material points that were closest at the start.

    Args:
        start: Frames at the start of the step, at which ``b`` has its curves.
        end: Frames at the end.
        a: The points.
        b: Segments of lines.
        runs: See :func:`runs_of`.
        feet: Closest points at the start, overwritten.
        out: Overwritten; infinite if another segment is closer.
    """
    nowhere = (0.0, 0.0, 0.0)
    for run in range(runs.shape[0]):
        i, first, last = runs[run, 0], runs[run, 1], runs[run, 2]
        P = position(start, a, i)
        square, j, σ = nearest(b, Opposite(first, last, nowhere, nowhere, 0.0), P)
        out[:, run] = np.inf
        if square < np.inf:
            set_position(b, j, σ, feet, run)
            store_row(out[0], run, minus(P, position(start, feet, run)))
            store_row(out[1], run, minus(position(end, a, i), position(end, feet, run)))


def runs_of(pairs: Indices, after: Indices | None) -> Indices:
    """Runs of consecutive second segments: first point, first and last segment, first pair; (r, 4).

    Args:
        pairs: Points or segments and segments near them, sorted, shape (m, 2).
        after: Segment that continues each segment; ``None``: planes, which nothing continues.
    """
    i, j = pairs.T
    begins = np.ones(len(i), dtype=np.bool_)
    if after is not None and len(i):
        begins[1:] = ~((i[1:] == i[:-1]) & (j[1:] == j[:-1] + 1) & (after[j[:-1]] == j[1:]))
    first = np.flatnonzero(begins)
    last = np.append(first[1:], len(i))[: len(first)] - 1
    return np.stack([i[first], j[first], j[last], first], axis=1)


@uncounted
def set_stations(
    H: Array,
    a: Strands,
    b: Strands,
    planes: Side,
    runs: Indices,
    blocks: Indices,
    out: ContactPoints,
    keys: Indices,
) -> int:
    """Set the Gauss points of whole elements and their closest points; return their number.

    ``keys`` identify them: the number of the Gauss point, and the first opposite segment.
    """
    count = 0
    for run in range(runs.shape[0]):
        i, first, last, e = runs[run, 0], runs[run, 1], runs[run, 2], runs[run, 3]
        nowhere = (0.0, 0.0, 0.0)
        for p in range(GAUSS):
            s = 0.5 + 0.5 * GAUSS_AT[p]
            if out.kind == PLANE:
                out.pairs[count, 1], out.first[count] = first, blocks[e]
            else:
                other = Opposite(first, last, nowhere, nowhere, a.radii[i] + b.radii[first])
                P = position_at(a.curves[i], s)
                square, j, σ = nearest(b, other, P)
                if square == np.inf:
                    continue
                set_position(b, j, σ, out.b, count)
                set_sliding(b, j, σ, P, out.sliding, count)
                out.pairs[count, 1], out.first[count] = count, blocks[e + j - first]
            set_position(a, i, s, out.a, count)
            out.pairs[count, 0] = count
            out.weight[count] = 0.5 * GAUSS_WEIGHT[p] * a.lengths[i]
            keys[count, 0], keys[count, 1] = GAUSS * i + p, first
            count += 1
    return count
