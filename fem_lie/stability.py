"""Equilibrium paths, critical points, imperfections, and modes of vibration and buckling."""

from typing import TYPE_CHECKING

from fem_lie._public_names import public_names

if TYPE_CHECKING:
    from fem_lie.results.mode_shapes import BucklingModes
    from fem_lie.results.path import CriticalPoint, CriticalPointType, EquilibriumPath, PathState
    from fem_lie.results.vibrations.campbell import CampbellDiagram
    from fem_lie.results.vibrations.flutter import Instability, StabilityLimit
    from fem_lie.results.vibrations.modes import Modes
    from fem_lie.solve.small_motions.campbell import campbell
    from fem_lie.solve.small_motions.flutter import flutter
    from fem_lie.solve.small_motions.unbalance import Unbalance, unbalance_response
    from fem_lie.solve.stability.branches import switch_branch
    from fem_lie.solve.stability.imperfections import (
        FieldImperfection,
        Imperfection,
        ModeImperfection,
        RandomImperfection,
        apply_imperfections,
    )
    from fem_lie.solve.stability.path_options import (
        DisplacementControl,
        LoadControl,
        PathEnds,
        PathOptions,
    )
    from fem_lie.solve.statics.arc_length import ArcLength, Equilibrium
    from fem_lie.solve.statics.unstable import UnstableEquilibriumWarning
else:
    __getattr__, __dir__ = public_names(__name__)

__all__ = [
    "ArcLength",
    "BucklingModes",
    "CampbellDiagram",
    "CriticalPoint",
    "CriticalPointType",
    "DisplacementControl",
    "Equilibrium",
    "EquilibriumPath",
    "FieldImperfection",
    "Imperfection",
    "Instability",
    "LoadControl",
    "ModeImperfection",
    "Modes",
    "PathEnds",
    "PathOptions",
    "PathState",
    "RandomImperfection",
    "StabilityLimit",
    "Unbalance",
    "UnstableEquilibriumWarning",
    "apply_imperfections",
    "campbell",
    "flutter",
    "switch_branch",
    "unbalance_response",
]
