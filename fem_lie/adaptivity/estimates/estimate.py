"""Base class of error estimates in space: element errors, one function for each kind of body."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from fem_lie._arrays import Array
from fem_lie._summary import Summarised
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.gradients.ancf_beam import AncfBeam
from fem_lie.bodies.gradients.ancf_shell import AncfShell
from fem_lie.bodies.rods.cable import Cable
from fem_lie.bodies.rods.cable_body import CableBody
from fem_lie.bodies.shells.shell import Shell, require_one_type
from fem_lie.bodies.solids.solid import Solid
from fem_lie.bodies.thin_shells.thin_shell import ThinShell
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.history import Result
from fem_lie.results.states import require_states, state_number
from fem_lie.scene import Scene
from fem_lie.scene.scene import require_scene

Estimated = Beam | Shell | ThinShell | AncfShell | AncfBeam | CableBody | Solid
"""Bodies whose error can be estimated."""

Refined = Beam | Shell | ThinShell | Cable | AncfBeam
"""Those of them that adaptive loops refine."""


@dataclass(frozen=True, eq=False, repr=False)
class ElementErrors(Summarised):
    """Errors of the m elements of a body in one state.

    Attributes:
        squares: Squared error of each element, an energy, shape (m,).
        energy: Squared energy norm of the stress, ``∫ σ·D⁻¹σ``.
    """

    squares: Array
    energy: float


class Estimator(Protocol):
    """Function that estimates the errors of one kind of body."""

    def __call__(
        self, result: Result | StaticResult, body: Any, scene: Scene, steps: Sequence[int], /
    ) -> list[ElementErrors]:
        """Errors in each of these states."""


class ErrorEstimate(ABC):
    """Base class of error estimates in space."""

    @abstractmethod
    def estimators(self) -> Mapping[type, Estimator]:
        """The function for each supported kind of body."""

    def errors(
        self, result: Result | StaticResult, body: Estimated, scene: Scene, steps: Sequence[int]
    ) -> list[ElementErrors]:
        """Errors of the elements of a body in some states.

        Args:
            result: A result of the scene.
            body: A body of the scene.
            scene: The scene.
            steps: Numbers of the states.

        Raises:
            ValueError: The body is not in that scene or result, its kind or its elements are not
                supported by this estimate, or there is no such state.
        """
        chosen = steps_of(result, body, scene, steps, tuple(self.estimators()))
        for kind, estimator in self.estimators().items():
            if isinstance(body, kind):
                return estimator(result, body, scene, chosen)
        raise AssertionError("unsupported bodies have been refused")


def steps_of(
    result: Result | StaticResult,
    body: Estimated,
    scene: Scene,
    steps: Sequence[int],
    kinds: tuple[type, ...],
) -> list[int]:
    """Indices of the states in which the error of a body is estimated.

    Raises:
        ValueError: The body is not in the scene or of another kind, or there is no such state.
    """
    require_states(result)
    require_scene(scene)
    if not isinstance(body, kinds):
        known = " and ".join(f"{kind.__name__}s" for kind in kinds)
        raise ValueError(f"the error in space is estimated for {known}, got {body!r}")
    if body not in scene.bodies:
        raise ValueError(f"{body.label} is not in the scene")
    if isinstance(body, Shell):
        require_one_type(body, "the error in space")
    return [state_number(step, len(result.frames)) for step in steps]
