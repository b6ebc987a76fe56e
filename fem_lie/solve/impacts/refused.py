"""Scenes that contacts by impacts cannot be in."""

from __future__ import annotations

from fem_lie.lie.kinds.kind import SLOPE
from fem_lie.system.equations import Equations


def refuse_impacts(equations: Equations) -> None:
    """Refuse what contacts by impacts cannot be with.

    Raises:
        ValueError: Nodes are no frames, or held along fixed axes, or constraints are of velocities.
    """
    unknowns = equations.unknowns
    wanted = "Impact is for rigid bodies, beams and shells whose nodes are frames"
    if (unknowns.kinds >= SLOPE).any():
        raise ValueError(
            f"{wanted}, not for cables, nets, solids, thin shells and bodies in few shapes; give "
            "Penalty"
        )
    if equations.supports:
        raise ValueError(f"{wanted} and are not held along fixed axes (Shell.guide); give Penalty")
    if unknowns.of_velocities:
        raise ValueError(f"{wanted}, without joints that roll; give Penalty")
