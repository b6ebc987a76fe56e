"""Cross-sections, shell sections, solid materials and damping."""

from typing import TYPE_CHECKING

from fem_lie._public_names import public_names

if TYPE_CHECKING:
    from fem_lie.sections.distortion.distortion import Distortion
    from fem_lie.sections.material import Damping
    from fem_lie.sections.orientation import Twisted
    from fem_lie.sections.properties import SectionProperties, director_mass_matrix
    from fem_lie.sections.section_mesh import SectionMesh
    from fem_lie.sections.shape import SectionShape
    from fem_lie.sections.shell_section import Orthotropic, Ply
    from fem_lie.sections.solid_materials import (
        Hyperelastic,
        NeoHooke,
        SaintVenantKirchhoff,
        SolidMaterial,
        det_minus_one,
        expm1,
        log1p,
    )
    from fem_lie.sections.warping import Warping
else:
    __getattr__, __dir__ = public_names(__name__)

__all__ = [
    "Damping",
    "Distortion",
    "Hyperelastic",
    "NeoHooke",
    "Orthotropic",
    "Ply",
    "SaintVenantKirchhoff",
    "SectionMesh",
    "SectionProperties",
    "SectionShape",
    "SolidMaterial",
    "Twisted",
    "Warping",
    "det_minus_one",
    "director_mass_matrix",
    "expm1",
    "log1p",
]
