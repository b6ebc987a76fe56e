"""Sides of a contact: lines as the first, patches of surfaces as the second; compiled.

Contact forces are integrated over the parts of a segment that overlap the patches, so that a line
may cross an edge anywhere. The gap is evaluated at equal steps. Since it changes by no more than
the distance along the segment, most steps are known to have no overlap; in the others the minimum
and the zeros of the gap are searched.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined_uncounted, uncounted
from fem_lie.contact.pairs.point_sides import PatchSides, PointSides
from fem_lie.contact.sides.curves import Strands, at, set_curves
from fem_lie.contact.sides.gauss_points import (
    GAUSS,
    GAUSS_AT,
    GAUSS_WEIGHT,
    line_samples,
    middles_of,
    set_position,
    strands_of,
)
from fem_lie.contact.sides.passage import Passage
from fem_lie.contact.sides.patch_contacts import Workspace, add_contacts_of, far, workspace_for
from fem_lie.contact.sides.patches import Patches, is_triangle, nearest_on, set_nets
from fem_lie.contact.sides.surfaces import Piece
from fem_lie.contact.sides.table import (
    ROUND,
    ContactPoints,
    Nodes,
    Samples,
    Side,
    Stations,
    empty_contacts,
    empty_side,
    least,
)
from fem_lie.contact.sides.two_sides import first_of

_STEPS = 4
"""Steps of a segment at whose ends the gap is evaluated; each has integration points of its own,
because the gap has kinks where patches end."""

_LONGER = 1.2
"""Largest ratio of the speed along a segment to its length."""

_GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
_TURNS = 60
_ZERO = 1e-10
"""Accuracy of the ends of a part."""

_LOWEST = 1e-5
"""Accuracy of a minimum, which need only be within an overlap."""


@uncounted
def _gap(
    a: Strands,
    i: int,
    b: Patches,
    near: Indices,
    ends: tuple[int, int],
    s: float,
    workspace: Workspace,
) -> float:
    """Gap at a point of a segment to the patches near it."""
    P, found, (W, C, _) = at(a.curves[i], s), np.inf, workspace
    for q in range(ends[0], ends[1]):
        j = near[q, 1]
        reach = a.radii[i] + b.radii[j]
        if not far(b.nets[j], is_triangle(b, j), P, reach + a.lengths[i]):
            square = nearest_on(is_triangle(b, j), b.straight, b.nets[j], P, W, C).square
            found = min(found, np.sqrt(square) - reach)
    return found


@uncounted
def _zero(
    a: Strands,
    i: int,
    b: Patches,
    near: Indices,
    ends: tuple[int, int],
    out: float,
    within: float,
    workspace: Workspace,
) -> float:
    """End of an overlap between a point outside and one inside of it."""
    for _ in range(_TURNS):
        s = 0.5 * (out + within)
        if abs(out - within) < _ZERO:
            return s
        if _gap(a, i, b, near, ends, s, workspace) < 0.0:
            within = s
        else:
            out = s
    return 0.5 * (out + within)


@uncounted
def _lowest(
    a: Strands,
    i: int,
    b: Patches,
    near: Indices,
    ends: tuple[int, int],
    low: float,
    high: float,
    workspace: Workspace,
) -> float:
    """A point of a step with a negative gap, or else the one with the least gap."""
    s, r = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    gs = _gap(a, i, b, near, ends, s, workspace)
    gr = _gap(a, i, b, near, ends, r, workspace)
    while high - low > _LOWEST and gs >= 0.0 and gr >= 0.0:
        if gs < gr:
            high, r, gr = r, s, gs
            s = high - _GOLDEN * (high - low)
            gs = _gap(a, i, b, near, ends, s, workspace)
        else:
            low, s, gs = s, r, gr
            r = low + _GOLDEN * (high - low)
            gr = _gap(a, i, b, near, ends, r, workspace)
    return s if gs < gr else r


@inlined_uncounted
def _may_touch(ga: float, gb: float, length: float) -> bool:
    """Whether a step between gaps at its ends may overlap."""
    return ga + gb < _LONGER * length / _STEPS


@uncounted
def _set_parts(
    a: Strands,
    i: int,
    b: Patches,
    near: Indices,
    ends: tuple[int, int],
    workspace: Workspace,
    parts: Array,
) -> int:
    """Set the parts of the steps of a segment with a negative gap, (_STEPS, 2); their number."""
    count, ga = 0, _gap(a, i, b, near, ends, 0.0, workspace)
    for k in range(_STEPS):
        low, high = k / _STEPS, (k + 1) / _STEPS
        gb = _gap(a, i, b, near, ends, high, workspace)
        if ga >= 0.0 and gb >= 0.0:
            s = 0.5 * (low + high)
            touches = _may_touch(ga, gb, a.lengths[i])
            if touches:
                s = _lowest(a, i, b, near, ends, low, high, workspace)
                touches = _gap(a, i, b, near, ends, s, workspace) < 0.0
            if touches:
                parts[count, 0] = _zero(a, i, b, near, ends, low, s, workspace)
                parts[count, 1] = _zero(a, i, b, near, ends, high, s, workspace)
                count += 1
        else:
            parts[count, 0], parts[count, 1] = low, high
            if ga >= 0.0:
                parts[count, 0] = _zero(a, i, b, near, ends, low, high, workspace)
            if gb >= 0.0:
                parts[count, 1] = _zero(a, i, b, near, ends, high, low, workspace)
            count += 1
        ga = gb
    return count


@uncounted
def _set_contacts(
    H: Array,
    a: Strands,
    b: Patches,
    near: Indices,
    blocks: Indices,
    workspace: Workspace,
    parts: Array,
    out: ContactPoints,
    fixed: Side,
    keys: Indices,
) -> int:
    count, last, point = 0, 0, 0
    while last < near.shape[0]:
        first, i = last, near[last, 0]
        while last < near.shape[0] and near[last, 0] == i:
            last += 1
        number = 1
        if keys.shape[0] > 0:
            parts[0, 0], parts[0, 1] = 0.0, 1.0
        else:
            number = _set_parts(a, i, b, near, (first, last), workspace, parts)
        for part in range(number):
            middle, half = 0.5 * (parts[part, 0] + parts[part, 1]), 0.5
            half *= parts[part, 1] - parts[part, 0]
            for p in range(GAUSS):
                if point == out.a.radii.shape[0]:
                    return out.weight.shape[0]
                set_position(a, i, middle + half * GAUSS_AT[p], out.a, point)
                measure = half * GAUSS_WEIGHT[p] * a.lengths[i]
                given = H, out.a, point, measure, b, near, blocks, (first, last), workspace
                count = add_contacts_of(*given, out, fixed, keys, GAUSS * i + p, count)
                point += 1
    return count


@compiled
def set_line_contacts(
    H: Array,
    a: Strands,
    b: Patches,
    near: Indices,
    blocks: Indices,
    out: ContactPoints,
    fixed: Side,
    keys: Indices,
) -> int:
    """Set the contact points of overlapping parts, or of whole segments for friction springs.

    Args:
        H: Frames.
        a: Segments of lines, with curves at these frames.
        b: Patches, with nets at these frames.
        near: Segments and patches near them, sorted.
        blocks: First matrix block of each pair.
        out: Overwritten.
        fixed: Material points on patches for friction springs, overwritten.
        keys: Identifiers of pairs with friction springs, overwritten; shape (0, 2): none.

    Returns:
        The number of contact points, which is the size of ``out`` if that is too small.
    """
    space, parts = workspace_for(near.shape[0]), np.empty((_STEPS, 2))
    return _set_contacts(H, a, b, near, blocks, space, parts, out, fixed, keys)


class LinePatchSides(PointSides):
    """Lines, and patches of surfaces."""

    def __init__(self, pieces: Sequence[Piece], b: Patches, nodes: Nodes) -> None:
        """Store both sides.

        Args:
            pieces: Segments of the lines.
            b: Patches.
            nodes: Gives the numbers of the nodes of a body in the scene.
        """
        self._lines, none = strands_of(pieces, nodes), np.empty((0, 2), dtype=np.int64)
        self._whole, self._b = PatchSides(line_samples(pieces, nodes), b, none), b
        middles, one = middles_of(pieces, self._lines), np.ones(len(pieces))
        given = Samples(middles, middles, one), self._whole.near_balls, b.radii, none
        super().__init__(*given)
        self.radius = least(self._lines.radii, b.radii)
        self._most = GAUSS

    def _space(self) -> ContactPoints:
        most = self._most * len(self.near.now) + 1
        return empty_contacts(empty_side(most), empty_side(most), ROUND, most)

    def _find(self, H: Array, place: int) -> ContactPoints:
        while len((found := super()._find(H, place)).pairs) == len(self._room(place).weight):
            self._most *= 2
            del self._rooms[place]
            self._station_room = None
        return found

    def _found(
        self, H: Array, workspace: ContactPoints, fixed: Side, keys: Indices
    ) -> ContactPoints:
        set_nets(H, self._b)
        set_curves(H, self._lines, False)
        near = self.near.now, self.near.first
        k = set_line_contacts(H, self._lines, self._b, *near, workspace, fixed, keys)
        return first_of(workspace, k)

    def _space_of_stations(self) -> Stations:
        found = super()._space_of_stations()
        return found._replace(a=found.at.a)

    def passed(self, start: Array, end: Array) -> Passage | None:
        """A point of a line that passed through a patch."""
        return self._whole.passed(start, end)
