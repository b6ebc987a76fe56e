"""What solvers see of the equations of a scene: the one door from ``solve`` to ``system``."""

from fem_lie.system.equations.equations import Equations, LinearState
from fem_lie.system.instant import Forces, Instant, Plan

__all__ = ["Equations", "Forces", "Instant", "LinearState", "Plan"]
