"""Flexible multibody dynamics in the local frames of SE(3), as a plugin for FEniCSx."""

from typing import TYPE_CHECKING

from fem_lie import _ffcx_warnings as _ffcx_warnings  # before anything imports DOLFINx
from fem_lie._public_names import public_names

if TYPE_CHECKING:
    import fem_lie.adaptivity as adaptivity
    import fem_lie.contact as contact
    import fem_lie.elements as elements
    import fem_lie.extend as extend
    import fem_lie.joints as joints
    import fem_lie.lie as lie
    import fem_lie.loads as loads
    import fem_lie.mesh as mesh
    import fem_lie.post as post
    import fem_lie.reduction as reduction
    import fem_lie.schemes as schemes
    import fem_lie.sections as sections
    import fem_lie.stability as stability
    from fem_lie.bodies.beams.beam import Beam
    from fem_lie.bodies.gradients.ancf_beam import AncfBeam
    from fem_lie.bodies.gradients.ancf_shell import AncfShell
    from fem_lie.bodies.membranes.membrane import Membrane
    from fem_lie.bodies.points import ground
    from fem_lie.bodies.rigid import RigidBody
    from fem_lie.bodies.rods.cable import Cable
    from fem_lie.bodies.rods.net import Net
    from fem_lie.bodies.rods.rod import Rod
    from fem_lie.bodies.rods.spline import SplineCable
    from fem_lie.bodies.shells.shell import Shell
    from fem_lie.bodies.solids.solid import Solid
    from fem_lie.bodies.thin_shells.thin_shell import ThinShell
    from fem_lie.forms.frames import NodalFrames, local_frame_forms
    from fem_lie.forms.problems.frame_problem import FrameProblem
    from fem_lie.linear.direct import ConvergenceError
    from fem_lie.results.equilibrium import StaticResult
    from fem_lie.results.history import Result
    from fem_lie.scene.nodal_loads import LineLoad, PointLoad
    from fem_lie.scene.scene import Scene
    from fem_lie.scene.supports import Clamp, PrescribedMotion
    from fem_lie.scene.surface_loads import AreaLoad
    from fem_lie.sections.material import Material
    from fem_lie.sections.section import Section
    from fem_lie.sections.shell_section import ShellSection
    from fem_lie.solve.alpha.generalised_alpha import GeneralisedAlpha
    from fem_lie.solve.conserving.energy_momentum import EnergyDecaying, EnergyMomentum
    from fem_lie.solve.explicit.explicit import Explicit
    from fem_lie.solve.stability.linear_buckling import buckling
    from fem_lie.solve.stability.path import follow_path
    from fem_lie.solve.stability.vibrations import vibrations
    from fem_lie.solve.statics.follow import follow_loads
    from fem_lie.solve.statics.statics import statics
else:
    __getattr__, __dir__ = public_names(__name__)

__version__ = "0.1.0"

__all__ = [
    "AncfBeam",
    "AncfShell",
    "AreaLoad",
    "Beam",
    "Cable",
    "Clamp",
    "ConvergenceError",
    "EnergyDecaying",
    "EnergyMomentum",
    "Explicit",
    "FrameProblem",
    "GeneralisedAlpha",
    "LineLoad",
    "Material",
    "Membrane",
    "Net",
    "NodalFrames",
    "PointLoad",
    "PrescribedMotion",
    "Result",
    "RigidBody",
    "Rod",
    "Scene",
    "Section",
    "Shell",
    "ShellSection",
    "Solid",
    "SplineCable",
    "StaticResult",
    "ThinShell",
    "adaptivity",
    "buckling",
    "contact",
    "elements",
    "extend",
    "follow_loads",
    "follow_path",
    "ground",
    "joints",
    "lie",
    "loads",
    "local_frame_forms",
    "mesh",
    "post",
    "reduction",
    "schemes",
    "sections",
    "stability",
    "statics",
    "vibrations",
]
