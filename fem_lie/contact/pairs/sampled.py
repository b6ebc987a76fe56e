"""Contact pairs of surfaces whose contact forces are summed over points of the first surface.

Points, balls and corners of polyhedra have point forces; lines have forces per length, in their
Gauss points; surfaces of patches have forces per area. The second surface is one that gives the gap
of any point: lines, patches, planes, hollow spheres, or a gap function.
"""

from __future__ import annotations

from abc import abstractmethod

import numpy as np

from fem_lie.contact.pairs.line_patches import LinePatchSides
from fem_lie.contact.pairs.lines import piece_arrays
from fem_lie.contact.pairs.pair import ContactPair, PenaltyPair, bodies_of
from fem_lie.contact.pairs.patch_surfaces import (
    PatchSurface,
    corner_areas,
    joined_patches,
    polyhedral_patches,
)
from fem_lie.contact.pairs.point_sides import CurveSides, PatchSides
from fem_lie.contact.sides.gauss_points import line_samples
from fem_lie.contact.sides.patches import Patches
from fem_lie.contact.sides.surfaces import (
    GapSurface,
    HollowSurface,
    LineSurface,
    PlaneSurface,
    PointSurface,
    PolyhedralSurface,
)
from fem_lie.contact.sides.table import (
    LEVEL,
    PLANE,
    ROUND,
    UNUSED,
    Nodes,
    Samples,
    Side,
    balls_side,
    joined_samples,
    level_side,
    planes_side,
    point_samples,
)
from fem_lie.contact.sides.two_sides import Balls, Sides

_NONE = np.empty((0, 2), dtype=np.int64)


class _SampledPair(PenaltyPair):
    """A first surface of points."""

    @abstractmethod
    def samples(self, nodes: Nodes) -> Samples:
        """Points of the first surface.

        Args:
            nodes: Gives the numbers of the nodes of a body in the scene.
        """

    def contents(self, nodes: Nodes) -> tuple[object, ...]:
        """All that the contact forces depend on."""
        at, _, measures = self.samples(nodes)
        return *at.arrays, measures, *self.second(nodes), self.a is self.b, repr(self.law)

    @abstractmethod
    def second(self, nodes: Nodes) -> tuple[object, ...]:
        """All that the contact forces depend on, of the second surface."""


# --- first surfaces ---


class _OfPoints(_SampledPair):
    """Points or balls."""

    a: PointSurface

    def samples(self, nodes: Nodes) -> Samples:
        """The centres."""
        return point_samples(self.a.balls(), nodes)


class _OfLines(_SampledPair):
    """Lines."""

    a: LineSurface

    power = 1

    def samples(self, nodes: Nodes) -> Samples:
        """Gauss points."""
        return line_samples(self.a.pieces(), nodes)


class _OfPatches(_SampledPair):
    """Surfaces of patches."""

    a: PatchSurface

    power = 2

    def samples(self, nodes: Nodes) -> Samples:
        """Gauss points."""
        return self.a.samples(self.a.patches(nodes))


# --- second surfaces ---


class _OnPatches(_SampledPair):
    """Patches as second surface."""

    @abstractmethod
    def patches(self, nodes: Nodes) -> Patches:
        """The patches.

        Args:
            nodes: Gives the numbers of the nodes of a body in the scene.
        """

    def meeting(self, nodes: Nodes) -> Sides:
        """Both sides, for the evaluation of contact points."""
        return PatchSides(self.samples(nodes), self.patches(nodes), _NONE)

    def second(self, nodes: Nodes) -> tuple[object, ...]:
        """The geometry of the patches."""
        b = self.patches(nodes)
        return b.nodes, b.offsets, b.tangents, b.radii, b.corners


class _OnSurfaces(_OnPatches):
    """Surfaces of patches as second surface."""

    b: PatchSurface

    def patches(self, nodes: Nodes) -> Patches:
        """All patches."""
        return self.b.patches(nodes)


class _OnPolyhedra(_OnPatches):
    """A polyhedron as second surface: balls about points touch its faces, edges and corners."""

    b: PolyhedralSurface

    def patches(self, nodes: Nodes) -> Patches:
        """The faces."""
        return polyhedral_patches(self.b, nodes, straight=True)


class OnSide(ContactPair):
    """A second surface whose parts need no search for closest points.

    Attributes:
        touches: Kind of the pairs of points.
    """

    touches: int

    @abstractmethod
    def side(self, nodes: Nodes) -> Side:
        """The second side.

        Args:
            nodes: Gives the numbers of the nodes of a body in the scene.
        """

    def second(self, nodes: Nodes) -> tuple[object, ...]:
        """All that the contact forces depend on, of the second surface: the arrays of its side.

        Args:
            nodes: Gives the numbers of the nodes of a body in the scene.
        """
        return tuple(self.side(nodes).arrays)


class OnPlanes(OnSide):
    """Planes."""

    b: PlaneSurface

    touches = PLANE

    def side(self, nodes: Nodes) -> Side:
        """The planes."""
        return planes_side(self.b.faces(), nodes)


class OnGap(OnSide):
    """A surface with a gap function."""

    b: GapSurface

    touches = LEVEL

    def side(self, nodes: Nodes) -> Side:
        """The surface."""
        return level_side(self.b, nodes)

    def second(self, nodes: Nodes) -> tuple[object, ...]:
        """The arrays of the second side, the class of the surface and its parameters."""
        surface = type(self.b).__qualname__, tuple(float(each) for each in self.b.parameters)
        return *super().second(nodes), *surface


class InHollow(OnSide):
    """Hollow spheres."""

    b: HollowSurface

    touches = ROUND

    def side(self, nodes: Nodes) -> Side:
        """The hollow spheres."""
        return balls_side(self.b.balls(), nodes)


class _OnSide(OnSide, _SampledPair):
    """Points on such a surface."""

    def meeting(self, nodes: Nodes) -> Sides:
        """Both sides, for the evaluation of contact points."""
        at, fixed, measures = self.samples(nodes)
        b = self.side(nodes)
        return Balls(at, b, kind=self.touches, same=False, areas=measures, fixed=fixed)


# --- pairs ---


class PatchPair(_OfPatches, _OnSurfaces):
    """Two surfaces of patches, or one that touches itself; integrated over the first."""

    def check(self) -> None:
        """Raise ``ValueError`` for two surfaces of one body, or for an overlap at the start."""
        if self.a is not self.b and set(bodies_of(self.a)) & set(bodies_of(self.b)):
            raise ValueError(f"{self.label}: a shell touches itself by one surface, given twice")
        super().check()

    def meeting(self, nodes: Nodes) -> Sides:
        """Both sides, for the evaluation of contact points."""
        if self.a is not self.b:
            return super().meeting(nodes)
        patches = self.b.patches(nodes)
        at, fixed, areas = self.a.samples(patches)
        # each pair of faces has contact points on both of them
        g = len(areas) // len(patches.nodes)
        pairs = self.b.neighbours(patches)
        first = (g * pairs[:, :1] + np.arange(g)).ravel()
        left_out = np.stack([first, np.repeat(pairs[:, 1], g)], axis=1)
        return PatchSides(Samples(at, fixed, 0.5 * areas), patches, left_out)


class PointPatchPair(_OfPoints, _OnSurfaces):
    """Balls on a surface of patches."""


class _LinesOnPatches(_OfLines, _OnPatches):
    """Lines on patches; the parts that overlap are integrated over."""

    def meeting(self, nodes: Nodes) -> Sides:
        """Both sides, for the evaluation of contact points."""
        return LinePatchSides(self.a.pieces(), self.patches(nodes), nodes)


class LinePatchPair(_LinesOnPatches, _OnSurfaces):
    """Lines on a surface of patches."""


class BallOnPolyhedronPair(_OfPoints, _OnPolyhedra):
    """Balls on a polyhedron."""

    def check(self) -> None:
        """Raise ``ValueError`` for points instead of balls, or for an overlap."""
        if any(ball.radius <= 0.0 for ball in self.a.balls()):
            raise ValueError(
                f"{self.label}: points do not touch polyhedra; give balls, boxes or planes"
            )
        super().check()


class LineOnPolyhedronPair(_LinesOnPatches, _OnPolyhedra):
    """Lines on a polyhedron."""


class PatchPolyhedronPair(_OfPatches, _OnPatches):
    """A surface of patches and a polyhedron.

    Half of the forces is that of the Gauss points of the patches on the polyhedron, half that of
    the corners of the polyhedron on the patches: these touch a flat surface first, its faces a
    convex one. A corner has the share of a face as area.
    """

    b: PolyhedralSurface

    def samples(self, nodes: Nodes) -> Samples:
        """Corners, and Gauss points."""
        corners = point_samples(self.b.balls(), nodes)
        areas = corner_areas(self.b.polyhedron())
        at, fixed, measures = super().samples(nodes)
        return joined_samples(
            [Samples(*corners[:2], 0.5 * areas), Samples(at, fixed, 0.5 * measures)]
        )

    def patches(self, nodes: Nodes) -> Patches:
        """Patches of the surface, and faces of the polyhedron."""
        surface = self.a.patches(nodes)
        return joined_patches(surface, polyhedral_patches(self.b, nodes, straight=surface.straight))

    def meeting(self, nodes: Nodes) -> Sides:
        """Both sides, for the evaluation of contact points."""
        samples, patches = self.samples(nodes), self.patches(nodes)
        owner, corners = samples.at.owners[0], samples.at.radii == 0.0
        own = np.where(corners, owner, UNUSED), np.where(patches.radii == 0.0, owner, UNUSED)
        return PatchSides(samples, patches, _NONE, own)


class PatchPlanePair(_OfPatches, OnPlanes, _OnSide):
    """A surface of patches and planes."""


class PatchGapPair(_OfPatches, OnGap, _OnSide):
    """A surface of patches and one with a gap function."""


class PatchHollowPair(_OfPatches, InHollow, _OnSide):
    """A surface of patches in hollow spheres."""


class PolyhedronHollowPair(InHollow, _OnSide):
    """A polyhedron in hollow spheres, which only its corners touch."""

    a: PolyhedralSurface

    def samples(self, nodes: Nodes) -> Samples:
        """The corners."""
        return point_samples(self.a.balls(), nodes)


class LineGapPair(_OfLines, OnGap, _OnSide):
    """Lines and a surface with a gap function."""


class LineHollowPair(_OfLines, InHollow, _OnSide):
    """Lines in hollow spheres."""


class BallLinePair(_OfPoints):
    """Balls on lines."""

    b: LineSurface

    def meeting(self, nodes: Nodes) -> Sides:
        """Both sides, for the evaluation of contact points."""
        return CurveSides(self.samples(nodes), self.b.pieces(), nodes)

    def second(self, nodes: Nodes) -> tuple[object, ...]:
        """The geometry of the lines."""
        return tuple(piece_arrays(self.b.pieces(), nodes))
