"""Interface of the equations of a scene for solvers: all that ``solve`` uses of ``system``."""

from fem_lie.system.equations.equations import Equations, LinearState
from fem_lie.system.time_state import Forces, Plan, TimeState

__all__ = ["Equations", "Forces", "LinearState", "Plan", "TimeState"]
