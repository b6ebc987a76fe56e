"""Contact pairs of the package: which surfaces can touch, and why others cannot."""

from __future__ import annotations

from fem_lie.contact.pairs.balls import BallGapPair, BallPair, BallPlanePair, PolyhedronPlanePair
from fem_lie.contact.pairs.lines import LinePair, LinePlanePair
from fem_lie.contact.pairs.pair import ContactPair, register_contact_pair
from fem_lie.contact.pairs.polyhedra import BallPolyhedronPair, PolyhedronPolyhedronPair
from fem_lie.contact.pairs.ropes import ALONE, RopeRingPair
from fem_lie.contact.pairs.shell_pairs import BallShellPair, ShellPair, ShellPlanePair
from fem_lie.contact.pairs.shell_surfaces import ShellSurface
from fem_lie.contact.rings.surfaces import Rings, Rope
from fem_lie.contact.sides.surfaces import (
    ContactSurface,
    GapSurface,
    LineSurface,
    PlaneSurface,
    PointSurface,
    PolyhedralSurface,
)

_TWO_PLANES = (
    "planes touch points, not each other; give the corners of one of them as Box or Vertices"
)
_LINES = "lines touch lines, bars and planes, not balls"
_SHELLS = "shells touch shells, balls and planes, not lines"
_CORNERS = "the corners of a box do not touch shells"

PAIRS: tuple[tuple[type[ContactSurface], type[ContactSurface], type[ContactPair] | str], ...] = (
    (PointSurface, PlaneSurface, BallPlanePair),
    (PointSurface, PointSurface, BallPair),
    (PointSurface, GapSurface, BallGapPair),
    (PolyhedralSurface, PlaneSurface, PolyhedronPlanePair),
    (PolyhedralSurface, PolyhedralSurface, PolyhedronPolyhedronPair),
    (PointSurface, PolyhedralSurface, BallPolyhedronPair),
    (LineSurface, LineSurface, LinePair),
    (LineSurface, PlaneSurface, LinePlanePair),
    (ShellSurface, ShellSurface, ShellPair),
    (PointSurface, ShellSurface, BallShellPair),
    (ShellSurface, PlaneSurface, ShellPlanePair),
    (Rope, Rings, RopeRingPair),
    (PlaneSurface, PlaneSurface, _TWO_PLANES),
    (LineSurface, PointSurface, _LINES),
    (LineSurface, PolyhedralSurface, _LINES),
    (ShellSurface, LineSurface, _SHELLS),
    (ShellSurface, PolyhedralSurface, _CORNERS),
    (Rope, ContactSurface, ALONE),
    (Rings, ContactSurface, ALONE),
)
"""Kinds of both surfaces, and their contact pair or the reason why there is none."""

for _row in PAIRS:
    register_contact_pair(*_row)
