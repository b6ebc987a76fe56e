"""Gauss points of lines that overlap: each a ball whose place is linear in two nodes' rows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import inlined_uncounted, uncounted
from fem_lie.contact.sides.curves import (
    Opposite,
    Strands,
    bend,
    nearest,
    overlaps,
    plane_of,
    slope,
    slopes,
    weights,
)
from fem_lie.contact.sides.curves import at as place_at
from fem_lie.contact.sides.passage import are_apart
from fem_lie.contact.sides.surfaces import MOST_NODES, Piece
from fem_lie.contact.sides.table import GROUND, Nodes, Side, empty_side, number_of
from fem_lie.lie.motions import local_components
from fem_lie.lie.tuples import Vector, cross, dot, load_row, minus, plus, scaled, store_row

GAUSS = 3
_AT, _WEIGHT = np.polynomial.legendre.leggauss(GAUSS)

_BULGE = 1.1
"""Half lengths of pieces over half their lengths at first: by how much they may be stretched."""


class Sliding(NamedTuple):
    """How second places on lines and patches follow the first ones, along up to two directions.

    ``g`` is least there, so its second derivative has ``−Σ m mᵀ/s`` beside that at a constant
    place, with ``m = ∂²g/∂σ∂h`` and ``s = ∂²g/∂σ²`` of directions with ``∂²g/∂σ∂τ = 0``.

    Attributes:
        slopes: ``Q'``; zero where the second place stays at an end, shape (m, 2, 3).
        bends: ``|Δ| s = Q'·Q' − Δ·Q''``, shape (m, 2).
        weights: Derivatives of the weights of all nodes, shape (m, 2, 4).
        levers: And of their levers, shape (m, 2, 4, 3).
    """

    slopes: Array
    bends: Array
    weights: Array
    levers: Array


def no_sliding(m: int) -> Sliding:
    """Of places that stay where they are on their side."""
    k = MOST_NODES
    return Sliding(
        np.zeros((m, 2, 3)), np.ones((m, 2)), np.zeros((m, 2, k)), np.zeros((m, 2, k, 3))
    )


@inlined_uncounted
def slides(sliding: Sliding, e: int, k: int) -> bool:
    """Whether a place follows along one of both directions."""
    t = sliding.slopes[e, k]
    return bool(t[0] != 0.0 or t[1] != 0.0 or t[2] != 0.0)


@inlined_uncounted
def set_slide(
    H: Array,
    sliding: Sliding,
    e: int,
    k: int,
    slot: int,
    node: int,
    n: Vector,
    distance: float,
    D: Array,
    out: Array,
) -> None:
    """``−m`` in the motion of a slot, of which ``D`` (3, 6) is that of ``Δ``: shape (6,)."""
    t = load_row(sliding.slopes[e], k)
    for p in range(6):
        out[p] = (t[0] * D[0, p] + t[1] * D[1, p] + t[2] * D[2, p]) / distance
    if slot >= MOST_NODES:
        f = local_components(H[node], n)
        turning = cross(load_row(sliding.levers[e, k], slot - MOST_NODES), f)
        for p in range(3):
            out[p] += sliding.weights[e, k, slot - MOST_NODES] * f[p]
            out[3 + p] += turning[p]


class Meeting(NamedTuple):
    """Places that push each other apart, where they overlap.

    Attributes:
        a: First places.
        b: Second ones, or planes.
        flat: Whether they are planes.
        pairs: Of places, shape (m, 2).
        weight: Length that each stands for, or one, shape (m,).
        first: The first block of a matrix of each, shape (m,).
        sliding: Of second places.
    """

    a: Side
    b: Side
    flat: bool
    pairs: Indices
    weight: Array
    first: Indices
    sliding: Sliding


def strands_of(pieces: Sequence[Piece], nodes: Nodes) -> Strands:
    """Pieces of lines in arrays."""
    numbers = [[number_of(*owner, nodes) for owner in piece.owners] for piece in pieces]
    goes_on: Flags = np.array([piece.goes_on for piece in pieces], dtype=np.bool_)
    return Strands(
        np.array(numbers, dtype=np.int64).reshape(-1, 2),
        np.array([piece.ends for piece in pieces]).reshape(-1, 2, 3),
        np.array([piece.tangents for piece in pieces]).reshape(-1, 2, 3),
        np.array([piece.length for piece in pieces]),
        np.array([piece.chord for piece in pieces]),
        np.ones(len(pieces)),
        np.array([piece.radius for piece in pieces]),
        goes_on,
        np.zeros((len(pieces), 4, 3)),
        np.zeros(len(pieces)),
    )


def middles_of(pieces: Sequence[Piece], strands: Strands) -> Side:
    """Balls about the middles of pieces that have all of them within."""
    found = empty_side(len(pieces))
    found.nodes[:, :2] = strands.nodes
    w = weights(0.5)
    found.weights[:, :2] = w[:2]
    found.levers[:, :2] = 0.5 * strands.ends
    found.levers[:, 0] += w[2] * strands.tangents[:, 0]
    found.levers[:, 1] += w[3] * strands.tangents[:, 1]
    found.radii[:] = strands.radii + 0.5 * _BULGE * strands.lengths
    # those of a body are a frame of its own for each piece: it is the other side that they touch
    found.owners[:] = np.where(strands.nodes[:, 0] == GROUND, GROUND, strands.nodes[:, 0])
    return found


@uncounted
def _set_place(strands: Strands, i: int, s: float, out: Side, q: int) -> None:
    """A place on a piece as a ball."""
    w = weights(s)
    out.nodes[q, 0], out.nodes[q, 1] = strands.nodes[i, 0], strands.nodes[i, 1]
    out.weights[q, 0], out.weights[q, 1] = w[0], w[1]
    _set_levers(strands, i, w, out.levers[q])
    out.radii[q] = strands.radii[i]
    out.owners[q] = strands.nodes[i, 0]


@uncounted
def _set_sliding(b: Strands, j: int, σ: float, P: Vector, out: Sliding, q: int) -> None:
    """How a place follows ``P``."""
    D, (w0, w1, m0, m1) = b.curves[j], slopes(σ)
    apart, t = minus(P, place_at(D, σ)), slope(D, σ)
    store_row(out.slopes[q], 0, scaled(1.0 if 0.0 < σ < 1.0 else 0.0, t))
    out.bends[q, 0] = dot(t, t) - dot(apart, bend(D, σ))
    out.weights[q, 0, 0], out.weights[q, 0, 1] = w0, w1
    _set_levers(b, j, (w0, w1, m0, m1), out.levers[q, 0])


@inlined_uncounted
def _set_levers(strands: Strands, i: int, w: tuple[float, float, float, float], out: Array) -> None:
    ends, tangents = strands.ends[i], strands.tangents[i]
    for k in range(2):
        p, t = load_row(ends, k), load_row(tangents, k)
        w_, m = (w[0], w[2]) if k == 0 else (w[1], w[3])
        store_row(out, k, plus(scaled(w_, p), scaled(m * strands.stretches[i], t)))


@uncounted
def set_points(
    H: Array, a: Strands, b: Strands, planes: Side, runs: Indices, blocks: Indices, out: Meeting
) -> int:
    """Gauss points of all that overlap; how many."""
    count = 0
    for run in range(runs.shape[0]):
        i, first, last, e = runs[run, 0], runs[run, 1], runs[run, 2], runs[run, 3]
        if out.flat:
            other = plane_of(H, planes, first, a.radii[i])
        else:
            nowhere = (0.0, 0.0, 0.0)
            other = Opposite(first, last, nowhere, nowhere, a.radii[i] + b.radii[first])
        if are_apart(a, i, a if out.flat else b, other):
            continue
        C = a.curves[i]
        from_, to, later, end = overlaps(C, a if out.flat else b, other)
        for part in range(2):
            low, high = (from_, to) if part == 0 else (later, end)
            for p in range(GAUSS if high > low else 0):
                s = 0.5 * (low + high) + 0.5 * (high - low) * _AT[p]
                if out.flat:
                    out.pairs[count, 1], out.first[count] = first, blocks[e]
                else:
                    square, j, σ = nearest(b, other, place_at(C, s))
                    if square == np.inf:
                        continue
                    _set_place(b, j, σ, out.b, count)
                    out.pairs[count, 1], out.first[count] = count, blocks[e + j - first]
                    _set_sliding(b, j, σ, place_at(C, s), out.sliding, count)
                _set_place(a, i, s, out.a, count)
                out.pairs[count, 0] = count
                out.weight[count] = 0.5 * (high - low) * _WEIGHT[p] * a.lengths[i]
                count += 1
    return count


@uncounted
def set_stations(
    H: Array,
    a: Strands,
    b: Strands,
    planes: Side,
    runs: Indices,
    blocks: Indices,
    out: Meeting,
    keys: Indices,
) -> int:
    """Gauss points of whole elements and what is nearest; how many.

    ``keys`` tell them apart: the number of the point on the line, and the first piece opposite.
    """
    count = 0
    for run in range(runs.shape[0]):
        i, first, last, e = runs[run, 0], runs[run, 1], runs[run, 2], runs[run, 3]
        nowhere = (0.0, 0.0, 0.0)
        for p in range(GAUSS):
            s = 0.5 + 0.5 * _AT[p]
            if out.flat:
                out.pairs[count, 1], out.first[count] = first, blocks[e]
            else:
                other = Opposite(first, last, nowhere, nowhere, a.radii[i] + b.radii[first])
                square, j, σ = nearest(b, other, place_at(a.curves[i], s))
                if square == np.inf:
                    continue
                _set_place(b, j, σ, out.b, count)
                out.pairs[count, 1], out.first[count] = count, blocks[e + j - first]
            _set_place(a, i, s, out.a, count)
            out.pairs[count, 0] = count
            out.weight[count] = 0.5 * _WEIGHT[p] * a.lengths[i]
            keys[count, 0], keys[count, 1] = GAUSS * i + p, first
            count += 1
    return count
