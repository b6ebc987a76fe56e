"""Parts for elements, joints, bodies, error estimates and time schemes of your own.

Each of these is one file outside the package; ``docs/how_to`` has an example of each. The parts of
scenes are in :mod:`fem_lie` itself; this module has what scenes do not show.

* **Elements from a UFL energy**: :class:`CellData`, :func:`cellwise`, :func:`present_values`,
  :class:`NodalFrames`, :func:`local_frame_forms`, :class:`LocalFrameForms`, :class:`FrameMap` of
  functions compiled by :func:`frame_function`, :class:`StrainEnergy`; loads beside them:
  :func:`dead_force`, :func:`dead_moment`, :func:`follower_force`, :func:`follower_moment`;
  other fields: :func:`derivative_in_field`, :func:`derivative_in_frames`.
* **Elements from vectors, strains and a law**, on nodes of any type: :func:`element`,
  :func:`cell_data`, :class:`CellFunctions`, :data:`CELL_SIGNATURE`, the functions of :mod:`cell`,
  :class:`NodeType` and the compiled functions of all node types, the module :mod:`node_types`;
  vectors of three numbers in these, the module :mod:`tuples`; :func:`compiled`, :func:`callback`.
* **Bodies**: :class:`FormBody` of your own forms, with inertia by :func:`kinetic_energy`;
  :class:`ElementBody` of elements of your own; any other :class:`Body` has a
  :class:`BodyModel`, which is what the assembly sees of it.
* **Error estimates**: :class:`ElementErrors`, what an estimate returns for each state.
* **Joints**: :func:`rows` selects entries of the relative motion.
* **Contact surfaces**: :class:`PointSurface`, :class:`PlaneSurface`, :class:`LineSurface`,
  :class:`PolyhedralSurface`, :class:`PatchSurface`, or :class:`GapSurface` with a gap function
  (:func:`evaluate`, :data:`GAP_SIGNATURE`). **Contact pairs** of kinds of surfaces:
  :class:`ContactPair`, :class:`PenaltyPair`, :class:`BallGapPair`, :func:`register_contact_pair`.
* **Forces and matrices of any other origin**: :class:`Term`, :class:`Pairs`; a :class:`Load`
  passes a term to the :class:`Sum` of all loads.
* **Time schemes**: :class:`Equations` with :class:`TimeState` and :class:`Plan`;
  :class:`Integrator`, :class:`Integration`, :class:`DividedIntegration`, :class:`Recorder`;
  :class:`DirectSolver` by a :class:`Method` of a package, which raises
  :class:`SingularMatrixError`; the iteration with a frozen matrix (:func:`iterate`,
  :class:`Iterated`, :class:`Verdict`, :class:`LinearRate`, :class:`QuadraticRate`, :data:`NEWTON`,
  :data:`FROZEN`); the choice of step sizes (:class:`StepChoice`, :class:`Control`,
  :class:`SymmetricControl`); the measure of convergence (:func:`unknown_scaling`,
  :func:`estimate`, :func:`failure`); consistent initial accelerations (:func:`accelerations`,
  :func:`check_velocities`).
* **Diagrams** in addition to those of results: :data:`COLOURS`, in which these draw their curves.
"""

from typing import TYPE_CHECKING

from fem_lie._public_names import public_names

if TYPE_CHECKING:
    import fem_lie.forms.small_energy.cell as cell
    import fem_lie.lie.node_types as node_types
    import fem_lie.lie.tuples as tuples
    from fem_lie._arrays import Array, Indices
    from fem_lie._jit import callback, compiled
    from fem_lie._state import attributes
    from fem_lie.adaptivity.estimates.estimate import ElementErrors
    from fem_lie.bodies.body import Body, Point
    from fem_lie.bodies.cells.element_body import ElementBody
    from fem_lie.bodies.forms.form_body import FormBody
    from fem_lie.bodies.model import BodyModel
    from fem_lie.contact.pairs.balls import BallGapPair
    from fem_lie.contact.pairs.pair import ContactPair, PenaltyPair, register_contact_pair
    from fem_lie.contact.pairs.patch_surfaces import PatchSurface
    from fem_lie.contact.sides.gap_functions import GAP_SIGNATURE, evaluate
    from fem_lie.contact.sides.surfaces import (
        GapSurface,
        LineSurface,
        PlaneSurface,
        PointSurface,
        PolyhedralSurface,
    )
    from fem_lie.elements.beams.element import CellData, cellwise, present_values
    from fem_lie.forms.energy import StrainEnergy
    from fem_lie.forms.kernels.addresses import FrameMap, frame_function
    from fem_lie.forms.local_forms import LocalFrameForms
    from fem_lie.forms.problems.coupling import derivative_in_field, derivative_in_frames
    from fem_lie.forms.problems.inertia import kinetic_energy
    from fem_lie.forms.problems.loads import (
        dead_force,
        dead_moment,
        follower_force,
        follower_moment,
    )
    from fem_lie.forms.small_energy.assembly import CellFunctions
    from fem_lie.forms.small_energy.element import CELL_SIGNATURE, cell_data, element
    from fem_lie.forms.term import Pairs, Term
    from fem_lie.joints.connection import rows
    from fem_lie.lie.node_types import NodeType, move_all
    from fem_lie.linear.direct import DirectSolver
    from fem_lie.linear.equilibrated import SingularMatrixError
    from fem_lie.linear.packages import Method
    from fem_lie.pictures.diagrams import COLOURS
    from fem_lie.scene.load import Carrier, History, Load, NodalLoad, Sum
    from fem_lie.solve.convergence import (
        DIVERGED,
        ROUND_OFF,
        Verdict,
        estimate,
        failure,
        unknown_scaling,
    )
    from fem_lie.solve.iteration import FROZEN, NEWTON, Iterated, LinearRate, QuadraticRate, iterate
    from fem_lie.solve.motion.consistent import accelerations, check_velocities
    from fem_lie.solve.motion.integration import DividedIntegration, Integration
    from fem_lie.solve.motion.integrator import Integrator, check_kinds, refuse
    from fem_lie.solve.motion.policies import PolicyState
    from fem_lie.solve.recording.recorder import Recorder
    from fem_lie.solve.refactorisation import Refactorisation
    from fem_lie.solve.step_control import Control, StepChoice
    from fem_lie.solve.symmetric_steps import SymmetricControl
    from fem_lie.system.equations import Equations, Plan, TimeState
else:
    __getattr__, __dir__ = public_names(__name__)

__all__ = [
    "CELL_SIGNATURE",
    "COLOURS",
    "DIVERGED",
    "FROZEN",
    "GAP_SIGNATURE",
    "NEWTON",
    "ROUND_OFF",
    "Array",
    "BallGapPair",
    "Body",
    "BodyModel",
    "Carrier",
    "CellData",
    "CellFunctions",
    "ContactPair",
    "Control",
    "DirectSolver",
    "DividedIntegration",
    "ElementBody",
    "ElementErrors",
    "Equations",
    "FormBody",
    "FrameMap",
    "GapSurface",
    "History",
    "Indices",
    "Integration",
    "Integrator",
    "Iterated",
    "LineSurface",
    "LinearRate",
    "Load",
    "LocalFrameForms",
    "Method",
    "NodalLoad",
    "NodeType",
    "Pairs",
    "PatchSurface",
    "PenaltyPair",
    "Plan",
    "PlaneSurface",
    "Point",
    "PointSurface",
    "PolicyState",
    "PolyhedralSurface",
    "QuadraticRate",
    "Recorder",
    "Refactorisation",
    "SingularMatrixError",
    "StepChoice",
    "StrainEnergy",
    "Sum",
    "SymmetricControl",
    "Term",
    "TimeState",
    "Verdict",
    "accelerations",
    "attributes",
    "callback",
    "cell",
    "cell_data",
    "cellwise",
    "check_kinds",
    "check_velocities",
    "compiled",
    "dead_force",
    "dead_moment",
    "derivative_in_field",
    "derivative_in_frames",
    "element",
    "estimate",
    "evaluate",
    "failure",
    "follower_force",
    "follower_moment",
    "frame_function",
    "iterate",
    "kinetic_energy",
    "move_all",
    "node_types",
    "present_values",
    "refuse",
    "register_contact_pair",
    "rows",
    "tuples",
    "unknown_scaling",
]
