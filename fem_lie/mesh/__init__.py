"""Meshes of lines, surfaces and volumes: from gmsh, from DOLFINx, and from functions."""

from typing import TYPE_CHECKING

from fem_lie._public_names import public_names

if TYPE_CHECKING:
    from fem_lie.mesh.bicubic.patch_coupling import PatchCoupling
    from fem_lie.mesh.bicubic.smooth_patch import (
        SmoothPatch,
        bspline_patch,
        smooth_patch,
        spline_patch,
    )
    from fem_lie.mesh.bicubic.spline_mesh import SplineMesh, spline_mesh
    from fem_lie.mesh.curves import Spline, curve, polyline, straight_line
    from fem_lie.mesh.gmsh_cells import read_curve
    from fem_lie.mesh.gmsh_session import run_gmsh_script
    from fem_lie.mesh.lines import LineMesh
    from fem_lie.mesh.mixed_surfaces import MixedSurfaceMesh
    from fem_lie.mesh.reading import (
        lines_from_dolfinx,
        read_gmsh_lines,
        read_gmsh_surface,
        read_gmsh_volume,
        surface_from_dolfinx,
        volume_from_dolfinx,
    )
    from fem_lie.mesh.surfaces import SurfaceMesh, parametric_surface
    from fem_lie.mesh.volumes import VolumeMesh, brick, parametric_volume
else:
    __getattr__, __dir__ = public_names(__name__)

__all__ = [
    "LineMesh",
    "MixedSurfaceMesh",
    "PatchCoupling",
    "SmoothPatch",
    "Spline",
    "SplineMesh",
    "SurfaceMesh",
    "VolumeMesh",
    "brick",
    "bspline_patch",
    "curve",
    "lines_from_dolfinx",
    "parametric_surface",
    "parametric_volume",
    "polyline",
    "read_curve",
    "read_gmsh_lines",
    "read_gmsh_surface",
    "read_gmsh_volume",
    "run_gmsh_script",
    "smooth_patch",
    "spline_mesh",
    "spline_patch",
    "straight_line",
    "surface_from_dolfinx",
    "volume_from_dolfinx",
]
