"""Flexible multibody dynamics in the local frames of SE(3), as a plugin for FEniCSx."""

from fem_lie.beam import Beam, Damping
from fem_lie.bodies import Body, Point, ground
from fem_lie.choices import Choices
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
from fem_lie.io import from_dolfinx, read_gmsh, read_gmsh_surface, surface_from_dolfinx
from fem_lie.joints import Fixed, InPlane, Joint, Revolute, RigidLink, Spherical
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
from fem_lie.results import Result
from fem_lie.rigid import RigidBody
from fem_lie.scene import Scene
from fem_lie.section import Material, Section
from fem_lie.section_mesh import SectionMesh
from fem_lie.section_properties import SectionProperties
from fem_lie.section_shape import SectionShape
from fem_lie.shell import Shell
from fem_lie.shell_loads import AreaLoad, EdgeLoad
from fem_lie.shell_section import Orthotropic, Ply, ShellSection
from fem_lie.solve.arc_length import ArcLength
from fem_lie.solve.energy_decaying import EnergyDecaying
from fem_lie.solve.energy_momentum import EnergyMomentum
from fem_lie.solve.follow import PathResult, follow_loads
from fem_lie.solve.generalised_alpha import Components, GeneralisedAlpha
from fem_lie.solve.linear import ConvergenceError
from fem_lie.solve.policies import Automatic, EveryIteration, Limit, Never, Policy
from fem_lie.solve.statics import StaticResult, statics
from fem_lie.solve.vibrations import vibrations
from fem_lie.surface import SurfaceMesh, surface
from fem_lie.warping import Warping

__all__ = [
    "DECOUPLED",
    "MITC3_PLUS",
    "MITC4",
    "MITC4_PLUS",
    "MITC6",
    "MITC9",
    "ArcLength",
    "AreaLoad",
    "Automatic",
    "Beam",
    "Body",
    "Choices",
    "Clamp",
    "Components",
    "ConvergenceError",
    "Damping",
    "Director",
    "Displacement",
    "EdgeLoad",
    "Eigenstrain",
    "EnergyDecaying",
    "EnergyMomentum",
    "EveryIteration",
    "Fixed",
    "Formulation",
    "FrameMap",
    "GeneralisedAlpha",
    "Geodesic",
    "Group",
    "HellingerReissner",
    "HuWashizu",
    "InPlane",
    "Joint",
    "Limit",
    "LineLoad",
    "LineMesh",
    "LocalFrameForms",
    "Material",
    "Modes",
    "Never",
    "NodalFrames",
    "Orthotropic",
    "Parametrisation",
    "PathResult",
    "Ply",
    "Point",
    "PointLoad",
    "Policy",
    "PreStress",
    "PrescribedMotion",
    "PressureLoad",
    "Result",
    "Revolute",
    "RigidBody",
    "RigidLink",
    "Scene",
    "Section",
    "SectionMesh",
    "SectionProperties",
    "SectionShape",
    "Shell",
    "ShellFormulation",
    "ShellSection",
    "Spherical",
    "StaticResult",
    "StrainEnergy",
    "StrainMeasures",
    "SurfaceMesh",
    "Temperature",
    "Units",
    "Warping",
    "director_strains",
    "follow_loads",
    "from_dolfinx",
    "ground",
    "local_frame_forms",
    "read_gmsh",
    "read_gmsh_surface",
    "statics",
    "surface",
    "surface_from_dolfinx",
    "vibrations",
]
