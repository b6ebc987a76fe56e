"""Time integration schemes, step sizes, events, refactorisation policies, and Newton's method."""

from typing import TYPE_CHECKING

from fem_lie._public_names import public_names

if TYPE_CHECKING:
    from fem_lie.events.actions import Lock, Release, Scale, Stop
    from fem_lie.events.controller import ContinuousController, Controller
    from fem_lie.events.event import Event
    from fem_lie.events.sensor import Sensor
    from fem_lie.linear.choice import SkewPart
    from fem_lie.results.record import Record
    from fem_lie.scene.matrix_terms import MatrixTerms
    from fem_lie.solve.alpha.options import ConstraintIndex, MatrixFrame
    from fem_lie.solve.composed.composed import Composed
    from fem_lie.solve.composed.parts import Composition, FiveStages, NineStages, TripleJump
    from fem_lie.solve.explicit.asynchronous import Asynchronous
    from fem_lie.solve.hamel.hamel import Hamel
    from fem_lie.solve.motion.consistent import set_initial_velocities
    from fem_lie.solve.motion.policies import (
        Automatic,
        ConstraintsOnly,
        EveryIteration,
        FactoriseOnce,
        IterationLimit,
        RefactorisationPolicy,
    )
    from fem_lie.solve.motion.richardson import TimeErrorEstimate, estimate_time_error
    from fem_lie.solve.multirate.multi_rate import MultiRate
    from fem_lie.solve.statics.load_steps import Newton
    from fem_lie.solve.step_control import AdaptiveStep, ConstantStep
    from fem_lie.solve.symmetric_steps import SymmetricStep
    from fem_lie.solve.trees.munthe_kaas import MuntheKaas
    from fem_lie.solve.variational.variational import Variational
    from fem_lie.system.nodes.element_rotations import CoarseElementsWarning
else:
    __getattr__, __dir__ = public_names(__name__)

__all__ = [
    "AdaptiveStep",
    "Asynchronous",
    "Automatic",
    "CoarseElementsWarning",
    "Composed",
    "Composition",
    "ConstantStep",
    "ConstraintIndex",
    "ConstraintsOnly",
    "ContinuousController",
    "Controller",
    "Event",
    "EveryIteration",
    "FactoriseOnce",
    "FiveStages",
    "Hamel",
    "IterationLimit",
    "Lock",
    "MatrixFrame",
    "MatrixTerms",
    "MultiRate",
    "MuntheKaas",
    "Newton",
    "NineStages",
    "Record",
    "RefactorisationPolicy",
    "Release",
    "Scale",
    "Sensor",
    "SkewPart",
    "Stop",
    "SymmetricStep",
    "TimeErrorEstimate",
    "TripleJump",
    "Variational",
    "estimate_time_error",
    "set_initial_velocities",
]
