"""Sections of any shape: what follows for a beam from how they warp.

The problem and its solution are in :mod:`fem_lie.sections.warping_fields`.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices
from fem_lie.sections.material import Material
from fem_lie.sections.outlines.mesh import SectionMesh
from fem_lie.sections.properties import SectionProperties
from fem_lie.sections.section import Section
from fem_lie.sections.warping_fields import WarpingFields

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_DRAWN_PIECES = 4  # of a cell's edge


class Warping:
    """How a section of given materials warps, and what follows for a beam.

    Args:
        mesh: Its cells.
        material: Of all regions, or of each region by its name.
        degree: Of the Lagrange elements of warping functions.

    Attributes:
        mesh: As given.
        properties: Area, moments, torsion constant, shear centre and factors, in the coordinates of
            the mesh.
        points: Points (y, z) at which the warping function is kept, for drawing, shape (n, 2).
        function: Axial displacement there per unit of twist about the shear centre, length²,
            shape (n,).
        triangles: Points of triangles between them, shape (t, 3).

    Raises:
        ValueError: A region has no material, a material no region, or the degree is less than 2.
    """

    mesh: SectionMesh
    properties: SectionProperties
    points: Array
    function: Array
    triangles: Indices

    def __init__(
        self, mesh: SectionMesh, material: Material | Mapping[str, Material], degree: int = 3
    ) -> None:
        if degree < 2:
            raise ValueError(f"degree must be at least 2, got {degree!r}")
        self.mesh = mesh
        materials = _materials(mesh.names, material)
        # dimensionless about the middle of the section, so that units do not matter
        low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
        middle, size = 0.5 * (low + high), 0.5 * float(np.linalg.norm(high - low))
        fields = WarpingFields(mesh, (mesh.points - middle) / size, materials, degree)
        torsion = fields.torsion()
        factors = fields.shear_factors(torsion)
        self.triangles, (y, z, function) = fields.drawn([*fields.r, torsion.function])
        self.points = middle + size * (fields.centroid + np.column_stack([y, z]))
        self.function = size**2 * function
        self.properties = SectionProperties(
            E=fields.EA / fields.area,
            G=fields.GA / fields.area,
            area=size**2 * fields.area,
            centroid=middle + size * fields.centroid,
            second_moments=size**4 * fields.EI * fields.area / fields.EA,
            torsion_constant=size**4 * torsion.stiffness * fields.area / fields.GA,
            shear_centre=middle + size * (fields.centroid + torsion.shear_centre),
            shear_factors=factors,
            warping_constant=size**6 * torsion.warping * fields.area / fields.EA,
        )
        units = np.array([size, size**2, size**2, size**2])
        inertia = fields.inertia * np.outer(units, units)
        self._inertia = inertia if inertia[0, 0] > 0.0 else None

    def section(self, at: npt.ArrayLike | None = None, angle: float = 0.0) -> Section:
        """Stiffness and inertia with the beam's axis through a point, in axes turned by an angle.

        Args:
            at: Point (y, z) in the coordinates of the mesh; default: the centroid. The shear centre
                is ``warping.properties.shear_centre``.
            angle: From the mesh's y axis to the section's e₂, towards z; in the principal axes it
                is ``warping.properties.principal_angle``.

        Raises:
            ValueError: The point is not two finite numbers or the angle not finite.
        """
        point = self.properties.centroid if at is None else np.asarray(at, dtype=np.float64)
        if point.shape != (2,) or not np.isfinite(point).all():
            raise ValueError(f"at must be a point (y, z), got {at!r}")
        properties = self.properties.offset(*self.properties.centroid)
        centred = Section(
            properties.stiffness,
            self._inertia,
            self.mesh.outline() - self.properties.centroid,
            properties,
        )
        return centred.offset(*(point - self.properties.centroid)).rotated(-angle)

    def plot(self, axes: Axes) -> None:
        """Draw regions, warping function, centroid, shear centre and principal axes."""
        from fem_lie.sections.diagram import draw

        draw(self, axes)

    def picture(self, path: str | os.PathLike[str] | None = None) -> Figure:
        """The same as a figure of its own, written to a file if one is given."""
        from fem_lie.sections.diagram import picture

        return picture(self, path)


def _materials(
    names: tuple[str, ...], material: Material | Mapping[str, Material]
) -> list[Material]:
    """Material of each region."""
    if isinstance(material, Material):
        return [material] * len(names)
    for name in material:
        if name not in names:
            raise ValueError(f"there is no region {name!r}; there are: {', '.join(names)}")
    for name in names:
        if name not in material:
            raise ValueError(f"region {name!r} has no material; given are: {', '.join(material)}")
    return [material[name] for name in names]
