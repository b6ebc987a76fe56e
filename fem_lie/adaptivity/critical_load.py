"""Goal: the load factor of a limit point, with its error from the null vector of the tangent.

At the limit point the null vector φ of the tangent stiffness is the dual solution. The residual of
the recovered stress along φ can be balanced by the load only. With the load f at factor 1, and
``φ·f = 1``, ::

    λ_h − λ ≈ Σ ∫ (σ* − σ)·D⁻¹ (σ*_φ − σ_φ)

σ_φ is the derivative of the stress along φ. At bifurcations the load does no work along φ, so they
cannot be a goal.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from fem_lie._arrays import Array, whole
from fem_lie.adaptivity.estimates.estimate import Estimated
from fem_lie.adaptivity.goals import Goal, fields_along
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.path import CriticalPoint, EquilibriumPath
from fem_lie.scene import Scene
from fem_lie.solve.stability.path import follow_path
from fem_lie.solve.stability.path_options import PathEnds
from fem_lie.solve.statics.follow import check_proportion
from fem_lie.system.equations import Equations


@dataclass(frozen=True)
class LimitLoadGoal(Goal):
    """Goal: the load factor of a limit point on the equilibrium path.

    Attributes:
        number: Number of the limit point along the path, counted from 1.

    Raises:
        ValueError: The number is not positive.
    """

    number: int = 1

    def __post_init__(self) -> None:
        """Raise ``ValueError`` or ``TypeError`` if ``number`` is not a positive integer."""
        whole(self.number, "number")

    def check(self, scene: Scene) -> None:
        """Raise ``ValueError`` unless all loads are proportional to the load factor.

        Args:
            scene: The scene.
        """
        check_proportion(scene)

    def solve(self, scene: Scene) -> EquilibriumPath:
        """Equilibrium path up to this number of critical points, at any load.

        Args:
            scene: The scene.
        """
        ends = PathEnds(critical_points=self.number, stop=lambda state: -1.0)
        return follow_path(scene, ends)

    def found(
        self, result: StaticResult, bodies: Sequence[Estimated], scene: Scene
    ) -> tuple[float, list[Array]]:
        """The load factor, and the contribution of each element to its error.

        Args:
            result: A result of the scene.
            bodies: Bodies of the scene.
            scene: The scene.

        Raises:
            TypeError: The result is not a path.
            ValueError: The path has fewer limit points.
        """
        point = self._point(result)
        there = replace(result, frames=point.frames[np.newaxis], factors=np.array([point.factor]))
        phi = point.shapes[0]
        power = _power(scene, point, phi)
        parts = []
        for body in bodies:
            now, missing = fields_along(there, body, scene, phi / power)
            parts.append(-now.work(now.missing, missing))
        return point.factor, parts

    def _point(self, result: StaticResult) -> CriticalPoint:
        if not isinstance(result, EquilibriumPath):
            raise TypeError(f"a critical load needs a path of fl.follow_path, got {result!r}")
        limits = result.limits
        if len(limits) < self.number:
            raise ValueError(
                f"the path has {len(limits)} limit points and {len(result.bifurcations)} "
                f"bifurcations, expected limit point {self.number}; it ended because "
                f"{result.reason}. Give solve=... to continue it"
            )
        return limits[self.number - 1]

    def __str__(self) -> str:
        """Description with the number of the point."""
        return f"load factor of limit point {self.number}"


def _power(scene: Scene, point: CriticalPoint, twists: Array) -> float:
    """Power of the loads at factor 1 for twists of all nodes (N, 6)."""
    equations = Equations(scene, dynamics=False)
    H = equations.start.frames.copy()
    masters = equations.unknowns.masters
    H[: len(masters)] = point.frames[masters]
    forces = equations.prescribed(1.0).loads(H).reshape(-1, 6)
    own = twists[masters].copy()
    equations.supports.rotate(H, own)
    return float((forces * own).sum())
