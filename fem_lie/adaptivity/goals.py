"""Goal-oriented error estimates: the base class of goals, and the error of a goal.

A goal has a dual motion z. Its error is made of the difference of the derivative of the stress
along z, σ_z, and the stress σ*_z recovered from it. Each goal is a file.
"""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices, instance
from fem_lie._summary import Summarised
from fem_lie.adaptivity.discretisation_error import draw_error, worst
from fem_lie.adaptivity.estimates.estimate import Estimated
from fem_lie.adaptivity.estimates.recovery import fields_of
from fem_lie.adaptivity.estimates.stress_fields import StressFields
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.shells.shell import Shell
from fem_lie.pictures.stage import SI, Units
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.states import nodes_in
from fem_lie.scene import Scene

_STEP = 1e-5  # increment for numerical derivatives, over the length of the model


class Goal(ABC):
    """Base class of goals: a scalar of the solution that has to be accurate."""

    @abstractmethod
    def check(self, scene: Scene) -> None:
        """Raise ``ValueError`` if the scene does not have this quantity; nothing is solved."""

    @abstractmethod
    def solve(self, scene: Scene) -> StaticResult:
        """Result from which the goal is computed, by default."""

    @abstractmethod
    def found(
        self, result: StaticResult, bodies: Sequence[Estimated], scene: Scene
    ) -> tuple[float, Sequence[Array]]:
        """Value of the goal, and contributions of the elements of each body to its error, (m,)."""

    @abstractmethod
    def __str__(self) -> str:
        """Short description."""


def goal_error(
    result: StaticResult, bodies: Sequence[Estimated], scene: Scene, goal: Goal
) -> GoalError:
    """Estimate the error of a goal in the last state.

    Args:
        result: Result of statics or of a path.
        bodies: Beams and shells to whose elements the error is attributed.
        scene: The scene that was solved.
        goal: The goal.

    Raises:
        ValueError: See :func:`~fem_lie.adaptivity.space_error` and the goal; or a body
            is no Beam or Shell, or a beam with bending flexibility, whose displacements are more
            accurate than its stress.
    """
    instance(goal, Goal, "goal", "a PointDisplacement, a Frequency or a CriticalLoad")
    for body in bodies:
        if not isinstance(body, Beam | Shell):
            raise ValueError(
                f"goals are estimated for Beams and Shells, {body.label} is a "
                f"{type(body).__name__}: omit the goal, for the error in the energy norm"
            )
        if getattr(getattr(body.model, "formulation", None), "bending_flexibility", False):
            raise ValueError(
                f"elements of {body.label} have the flexibility of forces that vary within, and "
                "displacements better than their stress: estimate goals with "
                f"{type(body.model.formulation).__name__}(bending_flexibility=False)"
            )
    value, parts = goal.found(result, bodies, scene)
    states = [result.frames[-1][nodes_in(result.info, body)] for body in bodies]
    return GoalError(goal, value, tuple(bodies), tuple(states), tuple(parts))


def fields_along(
    result: StaticResult, body: Estimated, scene: Scene, z: Array
) -> tuple[StressFields, Array]:
    """Stress in the last state, and the change of its error along twists z (N, 6) of all nodes.

    The change has the shape of the stress, (m, q, b); it is computed by finite differences.
    """
    size = np.abs(z).max(axis=0)
    length = float(np.ptp(result.frames[-1, :, 0], axis=0).max())
    step = _STEP / max(size[:3].max() / length, size[3:].max())
    frames = np.array([lie.se3_retract(result.frames[-1], s * step * z) for s in (-1, 0, 1)])
    around = replace(result, frames=frames, factors=np.repeat(result.factors[-1], 3))
    before, now, behind = fields_of(around, body, scene, (0, 1, 2))
    return now, (behind.missing - before.missing) / (2.0 * step)


@dataclass(frozen=True, eq=False, repr=False)
class GoalError(Summarised):
    """Estimated error of a goal; made by :func:`goal_error`.

    Attributes:
        goal: The goal.
        value: Computed value.
        bodies: Bodies to whose elements the error is attributed.
        frames: Frames of their nodes, shape (n, 4, 3) each.
        parts: Signed contribution of each element to the error, shape (m,) for each body.
    """

    goal: Goal
    value: float
    bodies: tuple[Estimated, ...]
    frames: tuple[Array, ...]
    parts: tuple[Array, ...]

    @property
    def estimate(self) -> float:
        """Estimated exact minus computed value; ``value + estimate`` is the corrected value."""
        return float(sum(part.sum() for part in self.parts))

    @property
    def relative(self) -> float:
        """Sum of the magnitudes of element contributions, relative to the corrected value.

        It is a bound of the estimate, in which contributions of both signs may cancel.
        """
        better = abs(self.value + self.estimate)
        return float(self.squares.sum()) / better if better else 0.0

    @property
    def squares(self) -> Array:
        """Magnitudes of element contributions, body by body: refinement indicators."""
        return np.abs(np.concatenate(self.parts))

    def worst(self, part: float = 0.5) -> Indices:
        """The fewest elements with this fraction of the sum of all magnitudes, the largest first.

        Args:
            part: Fraction of the sum of all amounts, between 0 and 1.

        Raises:
            ValueError: The fraction is not above 0 and at most 1.
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
        """Draw the magnitudes of a body, as :meth:`SpaceError.picture` does.

        Args:
            path: Name of the ``.png`` file.
            body: One of :attr:`bodies`; default: the first.
            title: Title of the picture; default: description of the error.
            units: Units of the axes.

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
            f"{self.goal}: {self.value:.6g}, error "
            f"{self.estimate:+.2g}, at most {100 * self.relative:.2g} %"
        )
