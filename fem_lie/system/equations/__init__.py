"""What solvers see of the equations of a scene: the one door from ``solve`` to ``system``."""

from fem_lie.system.equations.equations import Equations, LinearState
from fem_lie.system.time_state import Forces, Plan, TimeState

__all__ = ["Equations", "Forces", "LinearState", "Plan", "TimeState"]
