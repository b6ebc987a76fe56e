"""Contact pairs of the package: which surfaces can touch, and why others cannot."""

from __future__ import annotations

from fem_lie.contact.laws.law import ContactLaw, Impact, Penalty
from fem_lie.contact.pairs import sampled
from fem_lie.contact.pairs.balls import BallGapPair, BallPair, BallPlanePair, PolyhedronPlanePair
from fem_lie.contact.pairs.lines import LinePair, LinePlanePair
from fem_lie.contact.pairs.pair import ContactPair, register_contact_pair
from fem_lie.contact.pairs.patch_surfaces import PatchSurface
from fem_lie.contact.pairs.polyhedra import (
    NO_PENALTY,
    BallPolyhedronPair,
    PolyhedronPolyhedronPair,
)
from fem_lie.contact.pairs.ropes import ALONE, RopeRingPair
from fem_lie.contact.rings.surfaces import Rings, Rope
from fem_lie.contact.sides.surfaces import (
    ContactSurface,
    GapSurface,
    HollowSurface,
    LineSurface,
    PlaneSurface,
    PointSurface,
    PolyhedralSurface,
)

_TWO_PLANES = (
    "planes touch points, not each other; give the corners of one of them as Box or Vertices"
)
_NO_POINTS = (
    "expected a surface with points, such as Sphere, Vertices, Line or ShellSurface, to touch a "
    "plane, a hollow sphere or a surface with a gap function; two of these have no points"
)
_CORNERS = (
    "the faces of a polyhedron have no points to touch a surface with a gap function; if that is "
    "hollow, so that only corners touch it, register BallGapPair for both"
)

PAIRS: tuple[tuple[type[ContactSurface], type[ContactSurface], type[ContactPair] | str], ...] = (
    (PointSurface, PlaneSurface, BallPlanePair),
    (PointSurface, PointSurface, BallPair),
    (PointSurface, GapSurface, BallGapPair),
    (PointSurface, LineSurface, sampled.BallLinePair),
    (PointSurface, PatchSurface, sampled.PointPatchPair),
    (PolyhedralSurface, PlaneSurface, PolyhedronPlanePair),
    (LineSurface, LineSurface, LinePair),
    (LineSurface, PlaneSurface, LinePlanePair),
    (LineSurface, HollowSurface, sampled.LineHollowPair),
    (LineSurface, GapSurface, sampled.LineGapPair),
    (LineSurface, PolyhedralSurface, sampled.LineOnPolyhedronPair),
    (LineSurface, PatchSurface, sampled.LinePatchPair),
    (PatchSurface, PatchSurface, sampled.PatchPair),
    (PatchSurface, PlaneSurface, sampled.PatchPlanePair),
    (PatchSurface, HollowSurface, sampled.PatchHollowPair),
    (PatchSurface, GapSurface, sampled.PatchGapPair),
    (PatchSurface, PolyhedralSurface, sampled.PatchPolyhedronPair),
    (Rope, Rings, RopeRingPair),
    (PlaneSurface, PlaneSurface, _TWO_PLANES),
    (PlaneSurface, HollowSurface, _NO_POINTS),
    (HollowSurface, HollowSurface, _NO_POINTS),
    (HollowSurface, GapSurface, _NO_POINTS),
    (PlaneSurface, GapSurface, _NO_POINTS),
    (GapSurface, GapSurface, _NO_POINTS),
    (PolyhedralSurface, GapSurface, _CORNERS),
    (Rope, ContactSurface, ALONE),
    (Rings, ContactSurface, ALONE),
)
"""Kinds of both surfaces, and their contact pair or the reason why there is none."""

BY_LAW: tuple[
    tuple[type[ContactSurface], type[ContactSurface], type[ContactPair] | str, type[ContactLaw]],
    ...,
] = (
    (PolyhedralSurface, PolyhedralSurface, PolyhedronPolyhedronPair, Impact),
    (PolyhedralSurface, PolyhedralSurface, NO_PENALTY, Penalty),
    (PointSurface, PolyhedralSurface, BallPolyhedronPair, Impact),
    (PointSurface, PolyhedralSurface, sampled.BallOnPolyhedronPair, Penalty),
    (PolyhedralSurface, HollowSurface, sampled.PolyhedronHollowPair, Penalty),
)
"""The same for kinds whose pair depends on the law, with the law."""

for _row in PAIRS:
    register_contact_pair(*_row)
for _own in BY_LAW:
    register_contact_pair(*_own)
