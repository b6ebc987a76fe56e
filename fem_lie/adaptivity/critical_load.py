"""The load factor of a critical point as a goal: its error by the null vector of the tangent.

There the null vector φ of the tangent is the dual solution. What the recovered stress leaves of the
balance along it, only the load can take: with the load f at factor 1, and ``φ·f = 1``, ::

    λ_h − λ ≈ Σ ∫ (σ* − σ)·D⁻¹ (σ*_φ − σ_φ)

σ_φ is the derivative of the stress along φ. At bifurcations no load does work on φ.
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
    """The load factor of a limit point on the path of equilibrium.

    Attributes:
        number: Which of the limit points, counted from 1.

    Raises:
        ValueError: The number is not positive.
    """

    number: int = 1

    def __post_init__(self) -> None:
        """Raise ``ValueError`` or ``TypeError`` for what is no number of a point."""
        whole(self.number, "number")

    def check(self, scene: Scene) -> None:
        """Raise ``ValueError`` if not all that acts grows in proportion to the load factor.

        Args:
            scene: The scene.
        """
        check_proportion(scene)

    def solve(self, scene: Scene) -> EquilibriumPath:
        """The path, at whatever load, until there are so many critical points.

        Args:
            scene: The scene.
        """
        ends = PathEnds(critical_points=self.number, stop=lambda state: -1.0)
        return follow_path(scene, ends)

    def found(
        self, result: StaticResult, bodies: Sequence[Estimated], scene: Scene
    ) -> tuple[float, list[Array]]:
        """The load factor, and parts of its error.

        Args:
            result: A result of the scene.
            bodies: Bodies of the scene.
            scene: The scene.

        Raises:
            TypeError: The result is no path.
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
                f"bifurcations, wanted limit point {self.number}; it ended because "
                f"{result.reason}. With solve=... it may go on"
            )
        return limits[self.number - 1]

    def __str__(self) -> str:
        """The number of the point."""
        return f"load factor of limit point {self.number}"


def _power(scene: Scene, point: CriticalPoint, twists: Array) -> float:
    """Of the loads at factor 1, along twists of all nodes (N, 6)."""
    equations = Equations(scene, dynamics=False)
    H = equations.start.frames.copy()
    masters = equations.unknowns.masters
    H[: len(masters)] = point.frames[masters]
    forces = equations.prescribed(1.0).loads(H).reshape(-1, 6)
    own = twists[masters].copy()
    equations.supports.rotate(H, own)
    return float((forces * own).sum())
