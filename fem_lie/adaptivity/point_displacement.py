"""Goal: the displacement of a point, with its error from a dual solution, including the sign.

The goal is a linear functional of the motion from the state, ``j·u``. With the dual solution z,
``K z = j`` with the tangent stiffness K of the state, its error is, to leading order, the product
of the stress errors of both (R. Becker & R. Rannacher, Acta Numerica 10 (2001) 1)::

    J(u) − J(u_h) ≈ Σ ∫ (σ* − σ)·D⁻¹ (σ*_z − σ_z)

σ_z is the derivative of the stress resultants along z, in local frames, and σ*_z the stress
recovered from it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp
import scipy.sparse.linalg

from fem_lie._arrays import Array, direction
from fem_lie.adaptivity.estimates.estimate import Estimated
from fem_lie.adaptivity.goals import Goal, fields_along
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.results.equilibrium import StaticResult
from fem_lie.scene import Scene
from fem_lie.solve.statics.follow import follow_loads
from fem_lie.system.equations import Equations

_PIVOT = 0.01  # least diagonal entry relative to the largest in its column


@dataclass(frozen=True, eq=False)
class PointDisplacementGoal(Goal):
    """Goal: the displacement of a node in a direction.

    Attributes:
        point: Name of the node, "body.point"; scenes on all meshes need a point of this name.
        along: Direction, global components, shape (3,).

    Raises:
        ValueError: The direction is zero.
    """

    point: str
    along: npt.ArrayLike

    def __post_init__(self) -> None:
        object.__setattr__(self, "along", direction(self.along, "along"))

    def value(self, result: StaticResult) -> float:
        """The displacement in the last state.

        Args:
            result: A result of the scene.
        """
        node = result.info.node(self.point)
        moved = result.frames[-1, node, 0] - result.info.undeformed[node, 0]
        return float(moved @ np.asarray(self.along))

    def load(self, result: StaticResult) -> tuple[int, Array]:
        """The node, and the force and moment on it, (6,) in its axes, that are dual to the goal.

        Args:
            result: A result of the scene.
        """
        node = result.info.node(self.point)
        force = result.frames[-1, node, 1:] @ np.asarray(self.along)
        return node, np.concatenate([force, np.zeros(3)])

    def check(self, scene: Scene) -> None:
        """Raise ``ValueError`` if the scene has no such point.

        Args:
            scene: The scene.
        """
        SceneInfo.of(scene.bodies).node(self.point)

    def solve(self, scene: Scene) -> StaticResult:
        """Equilibrium under increasing loads.

        Args:
            scene: The scene.
        """
        return follow_loads(scene)

    def found(
        self, result: StaticResult, bodies: Sequence[Estimated], scene: Scene
    ) -> tuple[float, list[Array]]:
        """The displacement in the last state, and the contribution of each element to its error.

        Args:
            result: A result of the scene.
            bodies: Bodies of the scene.
            scene: The scene.

        Raises:
            ValueError: See :func:`dual_motion`.
        """
        z = dual_motion(scene, result, self)
        parts = []
        for body in bodies:
            now, missing = fields_along(result, body, scene, z)
            parts.append(now.work(now.missing, missing))
        return self.value(result), parts

    def __str__(self) -> str:
        """The point and the direction."""
        return f"{self.point} along {np.asarray(self.along)}"


def dual_motion(scene: Scene, result: StaticResult, goal: PointDisplacementGoal) -> Array:
    """Twists of all nodes (N, 6) under the dual load of a goal, with the tangent of the last state.

    Raises:
        ValueError: The scene has no such point, the state is no equilibrium, or the tangent
            stiffness is singular.
    """
    equations = Equations(scene, dynamics=False)
    unknowns = equations.unknowns
    state = equations.small_motions(result.steady_rotation)
    state.move(result.info.renumbered(result.frames, unknowns.bodies))
    node, wrench = goal.load(result)
    free = ~unknowns.held
    master = equations.arrays.master[node]
    own = np.cumsum(free).reshape(free.shape)[master] - 1
    j = np.zeros(int(free.sum()))
    for i in own[free[master]]:
        unit = np.zeros(len(j), dtype=np.complex128)
        unit[i] = 1.0
        j[i] = state.twists(unit)[node].real @ wrench
    K, B = state.stiffness()
    matrix = sp.bmat([[K, B.T], [B, None]], format="csc") if B.shape[0] else K.tocsc()
    try:
        solve = scipy.sparse.linalg.splu(
            matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=_PIVOT
        )
    except RuntimeError as error:
        raise ValueError(f"the tangent of the state is singular: {error}") from None
    z = solve.solve(np.concatenate([j, np.zeros(B.shape[0])]))[: len(j)]
    return np.asarray(state.twists(z.astype(np.complex128)).real)
