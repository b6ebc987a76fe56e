"""Estimates of the discretisation error, goals, mesh refinement, and adaptive solutions."""

from typing import TYPE_CHECKING

from fem_lie._public_names import public_names

if TYPE_CHECKING:
    from fem_lie.adaptivity.critical_load import LimitLoadGoal
    from fem_lie.adaptivity.discretisation_error import SpaceError, space_error
    from fem_lie.adaptivity.estimates.estimate import ErrorEstimate
    from fem_lie.adaptivity.estimates.hierarchical import HierarchicalEstimate
    from fem_lie.adaptivity.estimates.recovery import RecoveryEstimate
    from fem_lie.adaptivity.estimates.residual import ResidualEstimate
    from fem_lie.adaptivity.following.loads import AdaptedLoads, LoadSegment, adapt_loads
    from fem_lie.adaptivity.following.motion import adapt_motion
    from fem_lie.adaptivity.following.segments import AdaptedMotion, MotionSegment
    from fem_lie.adaptivity.following.transfer import Transferred, transfer
    from fem_lie.adaptivity.frequency import FrequencyGoal
    from fem_lie.adaptivity.goals import GoalError, goal_error
    from fem_lie.adaptivity.loop import Adapted, adapt
    from fem_lie.adaptivity.point_displacement import PointDisplacementGoal
    from fem_lie.adaptivity.refinement import refine
else:
    __getattr__, __dir__ = public_names(__name__)

__all__ = [
    "Adapted",
    "AdaptedLoads",
    "AdaptedMotion",
    "ErrorEstimate",
    "FrequencyGoal",
    "GoalError",
    "HierarchicalEstimate",
    "LimitLoadGoal",
    "LoadSegment",
    "MotionSegment",
    "PointDisplacementGoal",
    "RecoveryEstimate",
    "ResidualEstimate",
    "SpaceError",
    "Transferred",
    "adapt",
    "adapt_loads",
    "adapt_motion",
    "goal_error",
    "refine",
    "space_error",
    "transfer",
]
