"""Where public names are: the errors for names that have moved or are in another namespace."""

import sys
from collections.abc import Callable
from typing import NoReturn

RENAMED = {
    "Choices": "fl.schemes.MatrixTerms",
    "Components": "fl.schemes.MatrixFrame",
    "Critical": "fl.stability.CriticalPointType",
    "CriticalLoad": "fl.adaptivity.LimitLoadGoal",
    "Decisions": "fl.extend.PolicyState",
    "Director": "fl.elements.DirectorBeam",
    "Displacement": "fl.elements.DisplacementBased",
    "ErrorInTime": "fl.schemes.TimeErrorEstimate",
    "Formulation": "fl.elements.BeamFormulation",
    "Frequency": "fl.adaptivity.FrequencyGoal",
    "Geodesic": "fl.elements.GeodesicBeam",
    "Hierarchical": "fl.adaptivity.HierarchicalEstimate",
    "Index": "fl.schemes.ConstraintIndex",
    "Instant": "fl.extend.TimeState",
    "Jumps": "fl.loads.PiecewiseSmooth",
    "Kirchhoff": "fl.elements.KirchhoffRod",
    "Limit": "fl.schemes.IterationLimit",
    "LoadStretch": "fl.adaptivity.LoadSegment",
    "Never": "fl.schemes.FactoriseOnce",
    "Parameters": "fl.Shell(..., drilling=True or False)",
    "PathResult": "fl.StaticResult",
    "PointDisplacement": "fl.adaptivity.PointDisplacementGoal",
    "Policy": "fl.schemes.RefactorisationPolicy",
    "Recovery": "fl.adaptivity.RecoveryEstimate",
    "Reduced": "fl.reduction.ReducedStates",
    "ReducedBody": "fl.reduction.ReducedOrderBody",
    "Redundant": "fl.joints.RedundantConstraints",
    "RegionStretch": "fl.reduction.RegionSegment",
    "Residual": "fl.adaptivity.ResidualEstimate",
    "Seam": "fl.mesh.PatchCoupling",
    "Skin": "fl.contact.ShellSurface",
    "Stretch": "fl.adaptivity.MotionSegment",
    "Surface": "fl.contact.ContactSurface",
    "Table": "fl.loads.PiecewiseLinear",
    "Update": "fl.extend.Refactorisation",
    "block": "fl.mesh.parametric_volume",
    "branch": "fl.stability.switch_branch",
    "estimate_error": "fl.schemes.estimate_time_error",
    "expand": "fl.reduction.recover_full_motion",
    "from_dolfinx": "fl.mesh.lines_from_dolfinx",
    "gram_from_rigid": "fl.sections.director_mass_matrix",
    "imperfect": "fl.stability.apply_imperfections",
    "inertial_shapes": "fl.reduction.inertial_modes",
    "read_gmsh": "fl.mesh.read_gmsh_lines",
    "reduced_body": "fl.reduction.reduced_order_body",
    "straight": "fl.mesh.straight_line",
    "surface": "fl.mesh.parametric_surface",
}
"""Names of earlier versions, and what they are called now."""


def unknown_name(module: str) -> Callable[[str], NoReturn]:
    """A module's ``__getattr__``, which says where a name that the module does not have is.

    Args:
        module: Name of the module, ``fem_lie`` or a namespace in it.
    """

    def fail(name: str) -> NoReturn:
        """Raise ``AttributeError`` with the new name, or the namespace that has the name."""
        message = f"{module} has no {name!r}"
        if name in RENAMED:
            message += f"; it is {RENAMED[name]} now (fl is fem_lie)"
        elif namespaces := _namespaces_with(name):
            message += f"; expected {' or '.join(namespaces)} (fl is fem_lie)"
        raise AttributeError(message, name=name, obj=sys.modules[module])

    return fail


def _namespaces_with(name: str) -> list[str]:
    """Public names that end in this one, as users write them."""
    package = sys.modules["fem_lie"]
    modules = {"fl": package} | {
        f"fl.{each}": sys.modules[f"fem_lie.{each}"]
        for each in getattr(package, "__all__", ())
        if f"fem_lie.{each}" in sys.modules
    }
    return [
        f"{shown}.{name}"
        for shown, module in modules.items()
        if name in getattr(module, "__all__", ())
    ]
