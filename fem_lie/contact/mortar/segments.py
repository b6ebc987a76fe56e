"""Mortar segments of a line: parts of its elements that face one element of the second surface.

The closest point is smooth within such a part, so that Gauss points integrate products of shape
functions of both sides exactly, whatever the meshes are.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled, uncounted
from fem_lie.contact.sides.curves import Opposite, Strands, at, nearest
from fem_lie.contact.sides.gauss_points import (
    GAUSS,
    GAUSS_AT,
    GAUSS_WEIGHT,
    set_position,
    set_sliding,
)
from fem_lie.contact.sides.patch_contacts import Workspace, set_closest, workspace_for
from fem_lie.contact.sides.patches import NET, Nearest, Patches, is_triangle, nearest_on
from fem_lie.contact.sides.surfaces import MOST_NODES
from fem_lie.contact.sides.table import ContactPoints
from fem_lie.lie.tuples import Vector

_STEPS = 8
"""Steps of an element at whose ends the opposite elements are compared."""

_ZERO = 1e-15
"""Accuracy of the ends of a part, relative to the element."""

_MOST = 64
"""Largest number of parts of a step; a line along an edge may face both sides alternately."""

NOTHING, END = -1, -2
"""Opposite element of points whose closest point is elsewhere, or at a free end or boundary."""

_EQUAL = 1.0 - 1e-12
"""Ratio of squared distances that count as equal, for the same point on two patches."""


class Second(NamedTuple):
    """Second surface: elements of lines or patches; the other is empty.

    Attributes:
        lines: Elements of lines.
        patches: Patches.
        near: Elements of the first line and patches near them, sorted, shape (k, 2).
    """

    lines: Strands
    patches: Patches
    near: Indices


class _Facing(NamedTuple):
    """An element of the first line, and a run of elements of the second surface near it.

    Attributes:
        a: Elements of the first line.
        i: The element.
        b: The second surface.
        other: First and last element of a line, or pairs with patches.
        workspace: Workspace for closest points on patches.
    """

    a: Strands
    i: int
    b: Second
    other: Opposite
    workspace: Workspace


@uncounted
def _nearest_patch(of: _Facing, P: Vector) -> tuple[int, Nearest]:
    """The closest patch, and the point on it."""
    best, W, C = -1, of.workspace.W, of.workspace.C
    b, found = of.b.patches, Nearest(np.inf, 0.0, 0.0, -1, -1)
    for q in range(of.other.first, of.other.last + 1):
        j = of.b.near[q, 1]
        here = nearest_on(is_triangle(b, j), b.straight, b.nets[j], P, W, C)
        if here.square < _EQUAL * found.square:
            best, found = j, here
    return best, found


@uncounted
def _facing(of: _Facing, s: float) -> int:
    """Element of the second surface that is closest, or :data:`NOTHING`, :data:`END`."""
    P, b = at(of.a.curves[of.i], s), of.b.lines
    if of.b.patches.radii.shape[0] > 0:
        j, found = _nearest_patch(of, P)
        at_boundary = found.edge >= 0 and of.b.patches.at_edges[j, found.edge] == 1
        return END if at_boundary else j
    square, j, σ = nearest(b, of.other, P)
    if square == np.inf:
        return NOTHING
    if (σ <= 0.0 and b.before[j] < 0) or (σ >= 1.0 and b.after[j] < 0):
        return END
    return int(j)


@uncounted
def _border(of: _Facing, low: float, high: float, part: int) -> tuple[float, float]:
    """Bounds of the point where a line leaves the element that it faces at ``low``."""
    while high - low > _ZERO:
        s = 0.5 * (low + high)
        if s in (low, high):
            break
        if _facing(of, s) == part:
            low = s
        else:
            high = s
    return low, high


@uncounted
def _set_parts(of: _Facing, parts: Array) -> int:
    """Set the parts of an element that face one element each, shape (m, 2); return their number."""
    count, start, part = 0, 0.0, _facing(of, 0.0)
    for k in range(_STEPS):
        low, high = k / _STEPS, (k + 1) / _STEPS
        last = _facing(of, high)
        for _ in range(_MOST):
            if part == last:
                break
            within, low = _border(of, low, high, part)
            parts[count, 0], parts[count, 1] = start, within
            start, part, count = low, _facing(of, low), count + 1
        part = last
    parts[count, 0], parts[count, 1] = start, 1.0
    return count + 1


@uncounted
def _set_first(
    a: Strands, i: int, ends: tuple[float, float], p: int, out: ContactPoints, count: int
) -> float:
    """Set a Gauss point of a part on the first line; return its parameter."""
    low, high = ends
    s = 0.5 * (low + high) + 0.5 * (high - low) * GAUSS_AT[p]
    set_position(a, i, s, out.a, count)
    out.pairs[count, 0] = out.pairs[count, 1] = count
    out.weight[count] = 0.5 * (high - low) * GAUSS_WEIGHT[p] * a.lengths[i]
    return s


@uncounted
def _set_second(of: _Facing, P: Vector, out: ContactPoints, count: int) -> int:
    """Set the closest point to ``P`` as second point; return its element, or :data:`NOTHING`."""
    b = of.b
    if b.patches.radii.shape[0] > 0:
        j, found = _nearest_patch(of, P)
        set_closest(b.patches, j, found, P, of.workspace.W, out, count)
        return j
    square, j, σ = nearest(b.lines, of.other, P)
    if square == np.inf:
        return NOTHING
    set_position(b.lines, j, σ, out.b, count)
    set_sliding(b.lines, j, σ, P, out.sliding, count)
    return int(j)


@compiled
def set_segments(
    a: Strands,
    b: Second,
    runs: Indices,
    out: ContactPoints,
    at_s: Array,
    of: Indices,
    beyond: Flags,
) -> int:
    """Set the Gauss points of the mortar segments of all elements near the second surface.

    Args:
        a: Elements of the first line, with current curves.
        b: Second surface, with current curves or nets.
        runs: Elements of the first line with first and last element of a run of the second line, or
            with first and last pair with patches, shape (r, ≥ 3).
        out: Overwritten.
        at_s: Parameters of the points on their elements, overwritten, shape (m,).
        of: Elements of both surfaces, overwritten, shape (m, 2).
        beyond: Whether the closest point is a free end or on a boundary, overwritten, shape (m,).

    Returns:
        The number of points, which is the size of ``out`` if that is too small.
    """
    count, nowhere, parts = 0, (0.0, 0.0, 0.0), np.empty((_STEPS * _MOST + 1, 2))
    workspace = workspace_for(0)
    for run in range(runs.shape[0]):
        i = runs[run, 0]
        other = Opposite(runs[run, 1], runs[run, 2], nowhere, nowhere, 0.0)
        facing = _Facing(a, i, b, other, workspace)
        for part in range(_set_parts(facing, parts)):
            for p in range(GAUSS):
                if count == out.weight.shape[0]:
                    return count
                s = _set_first(a, i, (parts[part, 0], parts[part, 1]), p, out, count)
                j = _set_second(facing, at(a.curves[i], s), out, count)
                if j == NOTHING:
                    continue
                beyond[count] = _facing(facing, s) == END
                at_s[count], of[count, 0], of[count, 1] = s, i, j
                count += 1
    return count


def no_patches() -> Patches:
    """Empty surface of patches."""
    none, some = np.empty((0, MOST_NODES), dtype=np.int64), np.empty((0, MOST_NODES, 2, 3))
    given = none, none, some[:, :, 0], some, np.empty(0), none, none, none
    return Patches(*given, np.empty((0, NET, 3)), True)
