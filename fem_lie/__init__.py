"""Flexible multibody dynamics in the local frames of SE(3), as a plugin for FEniCSx."""

from fem_lie.beam import Beam, Damping
from fem_lie.bodies import Body, Point, ground
from fem_lie.buckling_modes import BucklingModes
from fem_lie.choices import Choices, Redundant
from fem_lie.drilling import Parameters
from fem_lie.element_turns import CoarseElementsWarning
from fem_lie.elements.directors import Director, director_strains
from fem_lie.elements.formulation import Formulation
from fem_lie.elements.geodesic import Geodesic
from fem_lie.elements.shell_formulation import (
    Displacement,
    HellingerReissner,
    HuWashizu,
    ShellFormulation,
)
from fem_lie.elements.shell_measures import (
    DECOUPLED,
    MITC3_PLUS,
    MITC4,
    MITC4_PLUS,
    MITC6,
    MITC9,
    StrainMeasures,
)
from fem_lie.frames import NodalFrames, local_frame_forms
from fem_lie.groups import Group, Parametrisation
from fem_lie.histories import Jumps, Table
from fem_lie.imperfections import (
    FieldImperfection,
    Imperfection,
    ModeImperfection,
    RandomImperfection,
    imperfect,
)
from fem_lie.inertia import gram_from_rigid
from fem_lie.io import from_dolfinx, read_gmsh, read_gmsh_surface, surface_from_dolfinx
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
from fem_lie.kernel import FrameMap, LocalFrameForms, StrainEnergy
from fem_lie.loads import (
    Clamp,
    Eigenstrain,
    LineLoad,
    PointLoad,
    PrescribedMotion,
    PressureLoad,
    PreStress,
    Temperature,
)
from fem_lie.mesh import LineMesh
from fem_lie.modes import Modes
from fem_lie.plot import Units
from fem_lie.resultants import Resultants, resultant_series, resultants
from fem_lie.results import Result
from fem_lie.rigid import RigidBody
from fem_lie.scene import Scene
from fem_lie.section import Material, Section
from fem_lie.section_forces import SectionForces, section_forces
from fem_lie.section_mesh import SectionMesh
from fem_lie.section_properties import SectionProperties
from fem_lie.section_shape import SectionShape
from fem_lie.shell import Shell
from fem_lie.shell_loads import AreaLoad, EdgeLoad, MassLoad, SurfacePressure, VolumeLoad
from fem_lie.shell_section import Orthotropic, Ply, ShellSection
from fem_lie.solve.arc_length import ArcLength
from fem_lie.solve.branches import branch
from fem_lie.solve.buckling import buckling
from fem_lie.solve.controls import DisplacementControl, LoadControl
from fem_lie.solve.energy_decaying import EnergyDecaying
from fem_lie.solve.energy_momentum import EnergyMomentum
from fem_lie.solve.equilibrium import statics
from fem_lie.solve.follow import PathResult, follow_loads
from fem_lie.solve.generalised_alpha import GeneralisedAlpha
from fem_lie.solve.linear import ConvergenceError
from fem_lie.solve.options import Components, Index
from fem_lie.solve.path import follow_path
from fem_lie.solve.path_result import Critical, CriticalPoint, EquilibriumPath, PathState
from fem_lie.solve.policies import (
    Automatic,
    ConstraintsOnly,
    Decisions,
    EveryIteration,
    Limit,
    Never,
    Policy,
    Update,
)
from fem_lie.solve.statics import StaticResult
from fem_lie.solve.step_control import AdaptiveStep, ConstantStep
from fem_lie.solve.unstable import UnstableEquilibriumWarning
from fem_lie.solve.vibrations import vibrations
from fem_lie.step_history import StepHistory
from fem_lie.surface import SurfaceMesh, surface
from fem_lie.vtk import write_resultants
from fem_lie.warping import Warping

__all__ = [
    "DECOUPLED",
    "MITC3_PLUS",
    "MITC4",
    "MITC4_PLUS",
    "MITC6",
    "MITC9",
    "AdaptiveStep",
    "ArcLength",
    "AreaLoad",
    "Automatic",
    "Beam",
    "Body",
    "BucklingModes",
    "Choices",
    "Clamp",
    "CoarseElementsWarning",
    "Collar",
    "Components",
    "ConstantStep",
    "ConstraintsOnly",
    "ConvergenceError",
    "Coordinate",
    "Critical",
    "CriticalPoint",
    "Cylindrical",
    "Damping",
    "Decisions",
    "Director",
    "Displacement",
    "DisplacementControl",
    "Distance",
    "Drive",
    "EdgeLoad",
    "Eigenstrain",
    "EnergyDecaying",
    "EnergyMomentum",
    "EquilibriumPath",
    "EveryIteration",
    "FieldImperfection",
    "Fixed",
    "Formulation",
    "FrameMap",
    "Gear",
    "GeneralisedAlpha",
    "Geodesic",
    "Group",
    "HellingerReissner",
    "HuWashizu",
    "Imperfection",
    "InPlane",
    "Index",
    "Joint",
    "Jumps",
    "KnifeEdge",
    "Limit",
    "LineLoad",
    "LineMesh",
    "LoadControl",
    "LocalFrameForms",
    "MassLoad",
    "Material",
    "ModeImperfection",
    "Modes",
    "Never",
    "NodalFrames",
    "Orthotropic",
    "Parameters",
    "Parametrisation",
    "PathResult",
    "PathState",
    "Planar",
    "Ply",
    "Point",
    "PointLoad",
    "Policy",
    "PreStress",
    "PrescribedMotion",
    "PressureLoad",
    "Prismatic",
    "RandomImperfection",
    "Redundant",
    "Result",
    "Resultants",
    "Revolute",
    "RigidBody",
    "RigidLink",
    "RollingDisc",
    "Scene",
    "Screw",
    "Section",
    "SectionForces",
    "SectionMesh",
    "SectionProperties",
    "SectionShape",
    "Shell",
    "ShellFormulation",
    "ShellSection",
    "Sleeve",
    "Sliding",
    "Spherical",
    "Spring",
    "StaticResult",
    "StepHistory",
    "StrainEnergy",
    "StrainMeasures",
    "SurfaceMesh",
    "SurfacePressure",
    "Table",
    "Temperature",
    "Units",
    "Universal",
    "UnstableEquilibriumWarning",
    "Update",
    "VolumeLoad",
    "Warping",
    "branch",
    "buckling",
    "director_strains",
    "follow_loads",
    "follow_path",
    "from_dolfinx",
    "gram_from_rigid",
    "ground",
    "imperfect",
    "local_frame_forms",
    "read_gmsh",
    "read_gmsh_surface",
    "resultant_series",
    "resultants",
    "section_forces",
    "statics",
    "surface",
    "surface_from_dolfinx",
    "vibrations",
    "write_resultants",
]
