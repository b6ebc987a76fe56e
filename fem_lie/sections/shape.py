"""Shapes of beam sections: rectangles to polygons with holes, joined to composites."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np
import numpy.typing as npt

from fem_lie.sections.gmsh_outlines import CellSizes
from fem_lie.sections.material import Material
from fem_lie.sections.outline import Loop, Part
from fem_lie.sections.section import Section
from fem_lie.sections.section_mesh import SectionMesh
from fem_lie.sections.warping import Warping


class SectionShape:
    """Section given by outlines, with coordinates y along e₂ and z along e₃.

    ``shape.section(material)`` is the section of a beam; ``shape.warping(material)`` has details
    and draws them. Lengths may be in any unit. Cell sizes are chosen so that stiffnesses are
    accurate to 1e-3: some cells across each wall, small ones at re-entrant corners and where
    regions end on others.

    Args:
        parts: Outlines of each region by its name; regions may touch, but not overlap.
        refinement: Divides the size of all cells.

    Raises:
        ValueError: There are no parts, outlines cross or touch themselves or each other, a hole is
            outside the outline or inside another one, or the refinement is not positive.
    """

    def __init__(self, parts: Mapping[str, Part], refinement: float = 1.0) -> None:
        if not parts:
            raise ValueError("give at least one part")
        _positive(refinement=refinement)
        for part in parts.values():
            part.check()
        self.parts = dict(parts)
        self.refinement = refinement

    @classmethod
    def rectangle(cls, width: float, height: float) -> SectionShape:
        """Solid rectangle about the origin.

        Args:
            width: Side along e₂.
            height: Side along e₃.

        Raises:
            ValueError: A size is not positive.
        """
        _positive(width=width, height=height)
        return cls._single(_rectangle(width, height))

    @classmethod
    def circle(cls, radius: float) -> SectionShape:
        """Solid circle about the origin.

        Args:
            radius: Radius.

        Raises:
            ValueError: The radius is not positive.
        """
        _positive(radius=radius)
        return cls._single(Loop.circle(radius))

    @classmethod
    def tube(cls, inner_radius: float, outer_radius: float) -> SectionShape:
        """Circular tube about the origin.

        Args:
            inner_radius: Inner radius.
            outer_radius: Outer radius.

        Raises:
            ValueError: Not 0 < inner_radius < outer_radius.
        """
        _positive(inner_radius=inner_radius, outer_radius=outer_radius)
        _less("inner_radius", inner_radius, "outer_radius", outer_radius)
        return cls._single(Loop.circle(outer_radius), Loop.circle(inner_radius))

    @classmethod
    def box(cls, width: float, height: float, thickness: float) -> SectionShape:
        """Hollow rectangle about the origin, sharp corners, the same wall all around.

        Args:
            width: Width along e₂.
            height: Height along e₃.
            thickness: Wall thickness.

        Raises:
            ValueError: A size is not positive, or walls meet: thickness ≥ half a side.
        """
        _positive(width=width, height=height, thickness=thickness)
        _less("twice the thickness", 2.0 * thickness, "the smaller side", min(width, height))
        inner = _rectangle(width - 2.0 * thickness, height - 2.0 * thickness)
        return cls._single(_rectangle(width, height), inner)

    @classmethod
    def i_section(
        cls, width: float, height: float, web: float, flange: float, root_radius: float = 0.0
    ) -> SectionShape:
        """Doubly symmetric I (or H) about the origin, with the web along e₃.

        Args:
            width: Width of the flanges, along e₂.
            height: Overall height, along e₃.
            web: Thickness of the web.
            flange: Thickness of the flanges.
            root_radius: Radius of the fillets between web and flanges.

        Raises:
            ValueError: A size is not positive, or sizes are incompatible.
        """
        _positive(width=width, height=height, web=web, flange=flange)
        _less("web", web, "width", width)
        _less("twice the flange", 2.0 * flange, "height", height)
        _fits(root_radius, 0.5 * (width - web), 0.5 * height - flange)
        y, z, w, f = 0.5 * width, 0.5 * height, 0.5 * web, 0.5 * height - flange
        half = [(-y, -z), (y, -z), (y, -f), (w, -f), (w, f), (y, f)]
        points = [*half, *((-a, -b) for a, b in half)]
        return cls._single(Loop.polygon(points).rounded((3, 4, 9, 10), root_radius))

    @classmethod
    def channel(
        cls, width: float, height: float, web: float, flange: float, root_radius: float = 0.0
    ) -> SectionShape:
        """Channel open towards +e₂, its web along e₃ with the outer face at y = 0.

        Args:
            width: Overall width of the flanges, along e₂.
            height: Overall height, along e₃; z = 0 is the axis of symmetry.
            web: Thickness of the web.
            flange: Thickness of the flanges.
            root_radius: Radius of the fillets between web and flanges.

        Raises:
            ValueError: A size is not positive, or sizes are incompatible.
        """
        _positive(width=width, height=height, web=web, flange=flange)
        _less("web", web, "width", width)
        _less("twice the flange", 2.0 * flange, "height", height)
        _fits(root_radius, width - web, 0.5 * height - flange)
        z, f = 0.5 * height, 0.5 * height - flange
        lower = [(0.0, -z), (width, -z), (width, -f), (web, -f)]
        points = [*lower, *((a, -b) for a, b in reversed(lower))]
        return cls._single(Loop.polygon(points).rounded((3, 4), root_radius))

    @classmethod
    def l_section(
        cls, width: float, height: float, thickness: float, root_radius: float = 0.0
    ) -> SectionShape:
        """Angle with its outer corner at the origin and flanges along +e₂ and +e₃.

        Args:
            width: Length of the flange along e₂, overall.
            height: Length of the flange along e₃, overall.
            thickness: Thickness of both flanges.
            root_radius: Radius of the fillet between the flanges.

        Raises:
            ValueError: A size is not positive, or sizes are incompatible.
        """
        _positive(width=width, height=height, thickness=thickness)
        _less("thickness", thickness, "the shorter flange", min(width, height))
        _fits(root_radius, width - thickness, height - thickness)
        t = thickness
        points = [(0.0, 0.0), (width, 0.0), (width, t), (t, t), (t, height), (0.0, height)]
        return cls._single(Loop.polygon(points).rounded((3,), root_radius))

    @classmethod
    def polygon(cls, points: npt.ArrayLike, holes: Sequence[npt.ArrayLike] = ()) -> SectionShape:
        """Polygon with holes.

        Args:
            points: Corners (y, z) in order, either way round, shape (k, 2), k ≥ 3.
            holes: Corners of each hole likewise.

        Raises:
            ValueError: A polygon is not at least 3 different finite points, crosses or touches
                itself or another one, or a hole is not inside the outline.
        """
        loops = [Loop.polygon(hole, f"points of hole {i}") for i, hole in enumerate(holes)]
        return cls._single(Loop.polygon(points), *loops)

    @classmethod
    def joined(cls, shapes: Mapping[str, SectionShape]) -> SectionShape:
        """Composite of touching shapes, each a region of its own material.

        It has the finest refinement of the shapes.

        Args:
            shapes: Shapes of a single region each, by the region's name; see :meth:`moved`.

        Raises:
            ValueError: There are no shapes, or one has several regions.
        """
        for name, shape in shapes.items():
            if len(shape.parts) != 1:
                raise ValueError(f"{name!r} must have one region, got {len(shape.parts)}")
        parts = {name: part for name, shape in shapes.items() for part in shape.parts.values()}
        return cls(parts, max((shape.refinement for shape in shapes.values()), default=1.0))

    def moved(self, y: float, z: float) -> SectionShape:
        """Shape translated in its plane.

        Args:
            y: Displacement along e₂.
            z: Displacement along e₃.
        """
        shift = np.array([y, z], dtype=np.float64)
        if not np.isfinite(shift).all():
            raise ValueError(f"y and z must be finite, got {y!r} and {z!r}")
        parts = {name: part.moved(shift) for name, part in self.parts.items()}
        return SectionShape(parts, self.refinement)

    def refined(self, factor: float) -> SectionShape:
        """Shape with cells smaller by a factor, to check convergence.

        Args:
            factor: Factor by which cells become smaller.
        """
        return SectionShape(self.parts, self.refinement * factor)

    @cached_property
    def mesh(self) -> SectionMesh:
        """Cells of the section, generated at the first access.

        Raises:
            ValueError: Parts overlap, or the section is not connected.
        """
        from fem_lie.sections.gmsh_outlines import mesh_parts

        points = np.concatenate([part.outer.chords() for part in self.parts.values()])
        low, high = points.min(axis=0), points.max(axis=0)
        middle, size = 0.5 * (low + high), 0.5 * float(np.linalg.norm(high - low))
        # gmsh's tolerances are absolute
        parts = {name: part.moved(-middle, 1.0 / size) for name, part in self.parts.items()}
        raw = mesh_parts(parts, CellSizes.of(list(parts.values()), self.refinement))
        return SectionMesh(
            middle + size * raw.points, raw.cells, raw.regions, raw.names, raw.cell, raw.degree
        )

    def warping(self, material: Material | Mapping[str, Material]) -> Warping:
        """Properties and warping function of the section.

        Args:
            material: Material of all regions, or of each region by its name.

        Raises:
            ValueError: A region has no material or a material no region, or as :attr:`mesh`.
        """
        return Warping(self.mesh, material)

    def section(
        self,
        material: Material | Mapping[str, Material],
        at: npt.ArrayLike | None = None,
        angle: float = 0.0,
    ) -> Section:
        """Stiffness and inertia of a beam; arguments as in :meth:`~Warping.section`.

        Args:
            material: The material.
            at: Position (y, z) of the reference point.
            angle: Rotation of the section about its reference point, rad.
        """
        return self.warping(material).section(at, angle)

    @classmethod
    def _single(cls, outer: Loop, *holes: Loop) -> SectionShape:
        return cls({"section": Part(outer, holes)})


def _rectangle(width: float, height: float) -> Loop:
    y, z = 0.5 * width, 0.5 * height
    return Loop.polygon([(-y, -z), (y, -z), (y, z), (-y, z)])


def _positive(**values: float) -> None:
    for name, value in values.items():
        if not 0.0 < value < np.inf:
            raise ValueError(f"{name} must be a positive finite number, got {value!r}")


def _less(small: str, value: float, large: str, bound: float) -> None:
    if value >= bound:
        raise ValueError(f"{small} must be less than {large}, got {value!r} and {bound!r}")


def _fits(root_radius: float, *lengths: float) -> None:
    if not 0.0 <= root_radius < min(lengths):
        raise ValueError(
            f"root_radius must be at least 0 and less than {min(lengths)!r}, got {root_radius!r}"
        )
