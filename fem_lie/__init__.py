"""Flexible multibody dynamics in the local frames of SE(3), as a plugin for FEniCSx."""

from fem_lie import _ffcx_warnings as _ffcx_warnings  # before anything imports DOLFINx
from fem_lie import extend as extend
from fem_lie import lie as lie
from fem_lie.adapt.critical_load import CriticalLoad
from fem_lie.adapt.estimates.estimate import ErrorEstimate
from fem_lie.adapt.estimates.hierarchical import Hierarchical
from fem_lie.adapt.estimates.recovery import Recovery
from fem_lie.adapt.estimates.residual import Residual
from fem_lie.adapt.following.loads import AdaptedLoads, LoadStretch, adapt_loads
from fem_lie.adapt.following.motion import adapt_motion
from fem_lie.adapt.following.segments import AdaptedMotion, Stretch
from fem_lie.adapt.following.transfer import Transferred, transfer
from fem_lie.adapt.frequency import Frequency
from fem_lie.adapt.goals import GoalError, goal_error
from fem_lie.adapt.loop import Adapted, adapt
from fem_lie.adapt.point_displacement import PointDisplacement
from fem_lie.adapt.refinement import refine
from fem_lie.adapt.space_error import SpaceError, space_error
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.body import Body, Point
from fem_lie.bodies.cells.element_body import ElementBody
from fem_lie.bodies.gradients.ancf_beam import AncfBeam
from fem_lie.bodies.gradients.ancf_shell import AncfShell
from fem_lie.bodies.points import ground
from fem_lie.bodies.reduced.reduced_body import ReducedBody
from fem_lie.bodies.rigid import RigidBody
from fem_lie.bodies.rods.cable import Cable
from fem_lie.bodies.rods.net import Net
from fem_lie.bodies.rods.rod import Rod
from fem_lie.bodies.rods.spline import SplineCable
from fem_lie.bodies.shells.shell import Shell
from fem_lie.bodies.solids.solid import Solid
from fem_lie.bodies.thin_shells.thin_shell import ThinShell
from fem_lie.contact.contact import Contact
from fem_lie.contact.convex.polyhedron import ConvexPolyhedron
from fem_lie.contact.laws.energy import UnresolvedContactWarning
from fem_lie.contact.laws.law import Impact, Penalty
from fem_lie.contact.pairs.lines import Cylinder, Line
from fem_lie.contact.pairs.shapes import Box, Plane, Sphere, Vertices
from fem_lie.contact.pairs.shell_surfaces import Skin
from fem_lie.contact.rings.surfaces import Rings, Rope
from fem_lie.contact.sides.surfaces import Surface
from fem_lie.elements.beams.directors import Director, director_strains
from fem_lie.elements.beams.element import Formulation
from fem_lie.elements.beams.geodesic import Geodesic
from fem_lie.elements.gradients.ancf import AncfElement
from fem_lie.elements.gradients.plate import AncfPlate
from fem_lie.elements.rods.cable import HermiteCable
from fem_lie.elements.rods.discrete import DiscreteCable
from fem_lie.elements.rods.discrete_rod import DiscreteRod
from fem_lie.elements.rods.isogeometric import IsogeometricCable
from fem_lie.elements.rods.kirchhoff import Kirchhoff
from fem_lie.elements.shells.element import (
    Displacement,
    HellingerReissner,
    HuWashizu,
    ShellFormulation,
)
from fem_lie.elements.shells.measures import (
    DECOUPLED,
    MITC3_PLUS,
    MITC4,
    MITC4_PLUS,
    MITC6,
    MITC9,
    StrainMeasures,
)
from fem_lie.elements.solids.element import Isoparametric, MeanDilatation, SolidFormulation
from fem_lie.elements.thin_shells.bicubic import BicubicHermite
from fem_lie.forms.energy import StrainEnergy
from fem_lie.forms.frames import NodalFrames, local_frame_forms
from fem_lie.forms.kernels.addresses import FrameMap
from fem_lie.forms.local_forms import LocalFrameForms
from fem_lie.joints import (
    Collar,
    Coordinate,
    Cylindrical,
    Distance,
    Drive,
    Fixed,
    Gear,
    InPlane,
    Joint,
    KnifeEdge,
    Planar,
    Prismatic,
    Revolute,
    RigidLink,
    RollingDisc,
    Screw,
    Sleeve,
    Sliding,
    Spherical,
    Spring,
    Universal,
)
from fem_lie.joints.histories import Jumps, Table
from fem_lie.joints.redundant import Redundant
from fem_lie.lie.motions import Group, Parametrisation
from fem_lie.linear.direct import ConvergenceError
from fem_lie.mesh.bicubic.patch_coupling import Seam
from fem_lie.mesh.bicubic.smooth_patch import SmoothPatch, bspline_patch, smooth_patch, spline_patch
from fem_lie.mesh.bicubic.spline_mesh import SplineMesh, spline_mesh
from fem_lie.mesh.curves import Spline, curve, polyline, straight
from fem_lie.mesh.gmsh_cells import read_curve
from fem_lie.mesh.gmsh_session import run_gmsh_script
from fem_lie.mesh.lines import LineMesh
from fem_lie.mesh.reading import from_dolfinx, read_gmsh, read_gmsh_surface, surface_from_dolfinx
from fem_lie.mesh.surfaces import SurfaceMesh, surface
from fem_lie.mesh.volume_reading import read_gmsh_volume, volume_from_dolfinx
from fem_lie.mesh.volumes import VolumeMesh, block, brick
from fem_lie.pictures.page.colours import NodalColours
from fem_lie.pictures.page.page import Page
from fem_lie.pictures.stage import Units
from fem_lie.pictures.vtk import write_resultants
from fem_lie.ranks.together import end_together
from fem_lie.reduce.axes import FixedAxes, MeanAxes, NodeAxes
from fem_lie.reduce.bases import craig_bampton, krylov, pod, with_derivatives
from fem_lie.reduce.basis import Basis, Reduced, load_basis
from fem_lie.reduce.ecsw import CellSample, ecsw
from fem_lie.reduce.making import inertial_shapes, reduced_body
from fem_lie.reduce.merged_motion import MergedMotion, RegionStretch
from fem_lie.reduce.merging import merged_motion
from fem_lie.reduce.part_files import expand, load_reduced, save_reduced
from fem_lie.reduce.reduced_statics import ReducedEquilibrium, reduced_frequencies, reduced_statics
from fem_lie.reduce.sampled_statics import SampledEquilibria, sampled_statics
from fem_lie.results.equilibrium import PathResult, StaticResult
from fem_lie.results.history import Result
from fem_lie.results.mode_shapes import BucklingModes
from fem_lie.results.path import Critical, CriticalPoint, EquilibriumPath, PathState
from fem_lie.results.record import Record, StepHistory
from fem_lie.results.stresses.contacts import ContactForces, contact_forces
from fem_lie.results.stresses.section_forces import SectionForces, section_forces
from fem_lie.results.stresses.shell_resultants import (
    Resultants,
    resultant_colours,
    resultant_series,
    resultants,
)
from fem_lie.results.stresses.solid_stress import SolidStresses, solid_stresses
from fem_lie.results.stresses.thin_resultants import ThinResultants, thin_resultants
from fem_lie.results.vibrations import Modes
from fem_lie.scene.choices import Choices
from fem_lie.scene.nodal_loads import LineLoad, PointLoad
from fem_lie.scene.pressure_loads import PressureLoad, SurfacePressure
from fem_lie.scene.scene import Scene
from fem_lie.scene.solid_loads import BulkLoad, FaceLoad, FacePressure
from fem_lie.scene.strain_loads import Eigenstrain, PreStress, Temperature
from fem_lie.scene.supports import Clamp, PrescribedMotion
from fem_lie.scene.surface_loads import AreaLoad, EdgeLoad, MassLoad, VolumeLoad
from fem_lie.sections.material import Damping, Material
from fem_lie.sections.orientation import Twisted
from fem_lie.sections.properties import SectionProperties, gram_from_rigid
from fem_lie.sections.section import Section
from fem_lie.sections.section_mesh import SectionMesh
from fem_lie.sections.shape import SectionShape
from fem_lie.sections.shell_section import Orthotropic, Ply, ShellSection
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
from fem_lie.solve.alpha.generalised_alpha import GeneralisedAlpha
from fem_lie.solve.alpha.options import Components, Index
from fem_lie.solve.composed.composed import Composed
from fem_lie.solve.composed.parts import Composition, FiveStages, NineStages, TripleJump
from fem_lie.solve.conserving.energy_momentum import EnergyDecaying, EnergyMomentum
from fem_lie.solve.explicit.asynchronous import Asynchronous
from fem_lie.solve.explicit.explicit import Explicit
from fem_lie.solve.hamel.hamel import Hamel
from fem_lie.solve.motion.policies import (
    Automatic,
    ConstraintsOnly,
    Decisions,
    EveryIteration,
    Limit,
    Never,
    Policy,
    Update,
)
from fem_lie.solve.motion.richardson import ErrorInTime, estimate_error
from fem_lie.solve.multirate.multi_rate import MultiRate
from fem_lie.solve.stability.branches import branch
from fem_lie.solve.stability.imperfections import (
    FieldImperfection,
    Imperfection,
    ModeImperfection,
    RandomImperfection,
    imperfect,
)
from fem_lie.solve.stability.linear_buckling import buckling
from fem_lie.solve.stability.path import follow_path
from fem_lie.solve.stability.path_options import (
    DisplacementControl,
    LoadControl,
    PathEnds,
    PathOptions,
)
from fem_lie.solve.stability.vibrations import vibrations
from fem_lie.solve.statics.arc_length import ArcLength
from fem_lie.solve.statics.follow import follow_loads
from fem_lie.solve.statics.load_steps import Newton
from fem_lie.solve.statics.statics import statics
from fem_lie.solve.statics.unstable import UnstableEquilibriumWarning
from fem_lie.solve.step_control import AdaptiveStep, ConstantStep
from fem_lie.solve.variational.variational import Variational
from fem_lie.system.nodes.element_rotations import CoarseElementsWarning

__all__ = [
    "DECOUPLED",
    "MITC3_PLUS",
    "MITC4",
    "MITC4_PLUS",
    "MITC6",
    "MITC9",
    "Adapted",
    "AdaptedLoads",
    "AdaptedMotion",
    "AdaptiveStep",
    "AncfBeam",
    "AncfElement",
    "AncfPlate",
    "AncfShell",
    "ArcLength",
    "AreaLoad",
    "Asynchronous",
    "Automatic",
    "Basis",
    "Beam",
    "BicubicHermite",
    "Body",
    "Box",
    "BucklingModes",
    "BulkLoad",
    "Cable",
    "CellSample",
    "Choices",
    "Clamp",
    "CoarseElementsWarning",
    "Collar",
    "Components",
    "Composed",
    "Composition",
    "ConstantStep",
    "ConstraintsOnly",
    "Contact",
    "ContactForces",
    "ConvergenceError",
    "ConvexPolyhedron",
    "Coordinate",
    "Critical",
    "CriticalLoad",
    "CriticalPoint",
    "Cylinder",
    "Cylindrical",
    "Damping",
    "Decisions",
    "Director",
    "DiscreteCable",
    "DiscreteRod",
    "Displacement",
    "DisplacementControl",
    "Distance",
    "Drive",
    "EdgeLoad",
    "Eigenstrain",
    "ElementBody",
    "EnergyDecaying",
    "EnergyMomentum",
    "EquilibriumPath",
    "ErrorEstimate",
    "ErrorInTime",
    "EveryIteration",
    "Explicit",
    "FaceLoad",
    "FacePressure",
    "FieldImperfection",
    "FiveStages",
    "Fixed",
    "FixedAxes",
    "Formulation",
    "FrameMap",
    "Frequency",
    "Gear",
    "GeneralisedAlpha",
    "Geodesic",
    "GoalError",
    "Group",
    "Hamel",
    "HellingerReissner",
    "HermiteCable",
    "Hierarchical",
    "HuWashizu",
    "Hyperelastic",
    "Impact",
    "Imperfection",
    "InPlane",
    "Index",
    "IsogeometricCable",
    "Isoparametric",
    "Joint",
    "Jumps",
    "Kirchhoff",
    "KnifeEdge",
    "Limit",
    "Line",
    "LineLoad",
    "LineMesh",
    "LoadControl",
    "LoadStretch",
    "LocalFrameForms",
    "MassLoad",
    "Material",
    "MeanAxes",
    "MeanDilatation",
    "MergedMotion",
    "ModeImperfection",
    "Modes",
    "MultiRate",
    "NeoHooke",
    "Net",
    "Never",
    "Newton",
    "NineStages",
    "NodalColours",
    "NodalFrames",
    "NodeAxes",
    "Orthotropic",
    "Page",
    "Parametrisation",
    "PathEnds",
    "PathOptions",
    "PathResult",
    "PathState",
    "Penalty",
    "Planar",
    "Plane",
    "Ply",
    "Point",
    "PointDisplacement",
    "PointLoad",
    "Policy",
    "PreStress",
    "PrescribedMotion",
    "PressureLoad",
    "Prismatic",
    "RandomImperfection",
    "Record",
    "Recovery",
    "Reduced",
    "ReducedBody",
    "ReducedEquilibrium",
    "Redundant",
    "RegionStretch",
    "Residual",
    "Result",
    "Resultants",
    "Revolute",
    "RigidBody",
    "RigidLink",
    "Rings",
    "Rod",
    "RollingDisc",
    "Rope",
    "SaintVenantKirchhoff",
    "SampledEquilibria",
    "Scene",
    "Screw",
    "Seam",
    "Section",
    "SectionForces",
    "SectionMesh",
    "SectionProperties",
    "SectionShape",
    "Shell",
    "ShellFormulation",
    "ShellSection",
    "Skin",
    "Sleeve",
    "Sliding",
    "SmoothPatch",
    "Solid",
    "SolidFormulation",
    "SolidMaterial",
    "SolidStresses",
    "SpaceError",
    "Sphere",
    "Spherical",
    "Spline",
    "SplineCable",
    "SplineMesh",
    "Spring",
    "StaticResult",
    "StepHistory",
    "StrainEnergy",
    "StrainMeasures",
    "Stretch",
    "Surface",
    "SurfaceMesh",
    "SurfacePressure",
    "Table",
    "Temperature",
    "ThinResultants",
    "ThinShell",
    "Transferred",
    "TripleJump",
    "Twisted",
    "Units",
    "Universal",
    "UnresolvedContactWarning",
    "UnstableEquilibriumWarning",
    "Update",
    "Variational",
    "Vertices",
    "VolumeLoad",
    "VolumeMesh",
    "Warping",
    "adapt",
    "adapt_loads",
    "adapt_motion",
    "block",
    "branch",
    "brick",
    "bspline_patch",
    "buckling",
    "contact_forces",
    "craig_bampton",
    "curve",
    "det_minus_one",
    "director_strains",
    "ecsw",
    "estimate_error",
    "expand",
    "expm1",
    "follow_loads",
    "follow_path",
    "from_dolfinx",
    "goal_error",
    "gram_from_rigid",
    "ground",
    "imperfect",
    "inertial_shapes",
    "krylov",
    "load_basis",
    "load_reduced",
    "local_frame_forms",
    "log1p",
    "merged_motion",
    "pod",
    "polyline",
    "read_curve",
    "read_gmsh",
    "read_gmsh_surface",
    "read_gmsh_volume",
    "reduced_body",
    "reduced_frequencies",
    "reduced_statics",
    "refine",
    "resultant_colours",
    "resultant_series",
    "resultants",
    "run_gmsh_script",
    "sampled_statics",
    "save_reduced",
    "section_forces",
    "smooth_patch",
    "solid_stresses",
    "space_error",
    "spline_mesh",
    "spline_patch",
    "statics",
    "straight",
    "surface",
    "surface_from_dolfinx",
    "thin_resultants",
    "transfer",
    "vibrations",
    "volume_from_dolfinx",
    "with_derivatives",
    "write_resultants",
]

# before anything of a script can fail on one rank alone
end_together()
