"""Error of one number of the solution, by a dual solution: where it is made, and which sign it has.

The goal is a linear number of the motion, ``j·u``, beside the state. With the dual solution z,
``K z = j`` in the tangent K of the state, its error is, to leading order, that of the stresses of
both in each other (R. Becker & R. Rannacher, Acta Numerica 10 (2001) 1)::

    J(u) − J(u_h) ≈ Σ ∫ (σ* − σ)·D⁻¹ (σ*_z − σ_z)

σ_z is the derivative of the stress resultants along z, in local frames, and σ*_z what is recovered
from it.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp
import scipy.sparse.linalg

from fem_lie import lie
from fem_lie._arrays import Array, Indices, direction, instance
from fem_lie.adapt.error_picture import draw_error
from fem_lie.adapt.space_error import Estimated, fields_of, worst
from fem_lie.pictures.units import SI, Units
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.states import nodes_in
from fem_lie.scene import Scene
from fem_lie.system.equations import Equations

_STEP = 1e-5  # of the model, in differences
_PIVOT = 0.01  # the smallest on the diagonal, of the largest in its column


@dataclass(frozen=True, eq=False)
class PointDisplacement:
    """The displacement of a node in a direction.

    Attributes:
        point: Its name, "body.point"; a scene on another mesh has a point of that name, too.
        along: Direction in space, shape (3,).

    Raises:
        ValueError: The direction is zero.
    """

    point: str
    along: npt.ArrayLike

    def __post_init__(self) -> None:
        object.__setattr__(self, "along", direction(self.along, "along"))

    def value(self, result: StaticResult) -> float:
        """The number in the last state."""
        node = result.info.node(self.point)
        moved = result.frames[-1, node, 0] - result.initial[node, 0]
        return float(moved @ np.asarray(self.along))

    def load(self, result: StaticResult) -> tuple[int, Array]:
        """The node and the force and moment on it, (6,) in its axes, that do work on it."""
        node = result.info.node(self.point)
        force = result.frames[-1, node, 1:] @ np.asarray(self.along)
        return node, np.concatenate([force, np.zeros(3)])


def dual_motion(scene: Scene, result: StaticResult, goal: PointDisplacement) -> Array:
    """Twists of all nodes (N, 6) under the load of a goal, in the tangent of the last state.

    Raises:
        ValueError: The scene has no such point, the state is none of equilibrium, or the tangent is
            singular there.
    """
    equations = Equations(scene, dynamics=False)
    unknowns = equations.unknowns
    state = equations.small_motions(result.steady_rotation)
    state.move(result.frames)
    node, wrench = goal.load(result)
    free = ~unknowns.held
    own = np.cumsum(free).reshape(free.shape)[unknowns.leaders[node]] - 1
    j = np.zeros(int(free.sum()))
    for i in own[free[unknowns.leaders[node]]]:
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


def goal_error(
    result: StaticResult, bodies: Sequence[Estimated], scene: Scene, goal: PointDisplacement
) -> GoalError:
    """Estimate the error of a goal in the last state.

    Args:
        result: Of statics or of a path.
        bodies: Beams and shells to whose elements the error is attributed.
        scene: What was solved.
        goal: What is wanted.

    Raises:
        ValueError: See :func:`~fem_lie.adapt.space_error.space_error` and :func:`dual_motion`; a
            beam whose elements bow: their displacements are better than their stress says.
    """
    instance(goal, PointDisplacement, "goal", "a PointDisplacement")
    for body in bodies:
        if getattr(getattr(body, "formulation", None), "bending_flexibility", False):
            raise ValueError(
                f"elements of {body.label} have the flexibility of forces that vary within, and "
                "displacements better than their stress: estimate goals with "
                f"{type(body.formulation).__name__}(bending_flexibility=False)"
            )
    z = dual_motion(scene, result, goal)
    size = np.abs(z).max(axis=0)
    length = float(np.ptp(result.frames[-1, :, 0], axis=0).max())
    step = _STEP / max(size[:3].max() / length, size[3:].max())
    frames = np.array([lie.se3_retract(result.frames[-1], s * step * z) for s in (-1, 0, 1)])
    beside = replace(result, frames=frames, factors=np.repeat(result.factors[-1], 3))
    parts = []
    for body in bodies:
        before, now, behind = fields_of(beside, body, scene, (0, 1, 2))
        parts.append(now.work(now.missing, (behind.missing - before.missing) / (2.0 * step)))
    states = [result.frames[-1][nodes_in(result.info, body)] for body in bodies]
    return GoalError(goal, goal.value(result), tuple(bodies), tuple(states), tuple(parts))


@dataclass(frozen=True, eq=False)
class GoalError:
    """Estimated error of a goal; made by :func:`goal_error`.

    Attributes:
        goal: What is wanted.
        value: As computed.
        bodies: To whose elements the error is attributed.
        frames: Of their nodes, shape (n, 4, 3) each.
        parts: What each element adds to the error, with its sign, shape (m,) for each body.
    """

    goal: PointDisplacement
    value: float
    bodies: tuple[Estimated, ...]
    frames: tuple[Array, ...]
    parts: tuple[Array, ...]

    @property
    def estimate(self) -> float:
        """True less computed value; ``value + estimate`` is better than both."""
        return float(sum(part.sum() for part in self.parts))

    @property
    def relative(self) -> float:
        """Sum of the amounts of what elements add, over the better value.

        It bounds the part of the estimate, in which errors of both signs may cancel by chance.
        """
        better = abs(self.value + self.estimate)
        return float(self.squares.sum()) / better if better else 0.0

    @property
    def squares(self) -> Array:
        """Amounts of what elements add, of all bodies one after the other: what to refine by."""
        return np.abs(np.concatenate(self.parts))

    def worst(self, part: float = 0.5) -> Indices:
        """The fewest elements that have this part of the sum of all amounts, worst first.

        Raises:
            ValueError: It is not above 0 and at most 1.
        """
        return worst(self.squares, part)

    def picture(
        self,
        path: str | os.PathLike[str],
        body: Estimated | None = None,
        *,
        title: str = "",
        units: Units = SI,
    ) -> None:
        """Draw the amounts of a body, as :meth:`SpaceError.picture` does.

        Args:
            path: Name of the ``.png`` file.
            body: One of :attr:`bodies`; default: the first.
            title: Above the picture; default: the error in words.
            units: For the axes.

        Raises:
            ValueError: The name does not end in ``.png``, or the body is none of these.
        """
        chosen = self.bodies[0] if body is None else body
        if chosen not in self.bodies:
            raise ValueError(f"bodies are {[b.label for b in self.bodies]}, got {chosen!r}")
        k = self.bodies.index(chosen)
        squares = np.abs(self.parts[k])
        draw_error(chosen, self.frames[k], squares, path, title or str(self), units)

    def __str__(self) -> str:
        """One line."""
        return (
            f"{self.goal.point} along {np.asarray(self.goal.along)}: {self.value:.6g}, error "
            f"{self.estimate:+.2g}, at most {100 * self.relative:.2g} %"
        )
