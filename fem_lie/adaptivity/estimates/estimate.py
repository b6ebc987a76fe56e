"""What every estimate of the error in space is: errors of elements, one way per kind of body."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from fem_lie._arrays import Array
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.shells.shell import Shell
from fem_lie.bodies.thin_shells.thin_shell import ThinShell
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.history import Result
from fem_lie.results.states import require_states, state_number
from fem_lie.scene import Scene
from fem_lie.scene.scene import require_scene

Estimated = Beam | Shell | ThinShell
"""Bodies whose error can be estimated."""


@dataclass(frozen=True, eq=False)
class ElementErrors:
    """Of m elements of a body in one state.

    Attributes:
        squares: Square of the error of each element, an energy, shape (m,).
        energy: Square of the norm of the stress, ``∫ σ·D⁻¹σ``.
    """

    squares: Array
    energy: float


class Way(Protocol):
    """How the errors of one kind of body are found in some states."""

    def __call__(
        self, result: Result | StaticResult, body: Any, scene: Scene, steps: Sequence[int], /
    ) -> list[ElementErrors]:
        """Errors in each of these states."""


class ErrorEstimate(ABC):
    """An estimate of the error in space; each is a file, or one for each kind of body."""

    @abstractmethod
    def ways(self) -> Mapping[type, Way]:
        """How it is done for each kind of body that it knows."""

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
            ValueError: The body is not in that scene or result, is of no kind that this estimate
                knows, has elements that it is not for, or there is no such step.
        """
        chosen = steps_of(result, body, scene, steps, tuple(self.ways()))
        for kind, way in self.ways().items():
            if isinstance(body, kind):
                return way(result, body, scene, chosen)
        raise AssertionError("other bodies are refused before")


def steps_of(
    result: Result | StaticResult,
    body: Estimated,
    scene: Scene,
    steps: Sequence[int],
    kinds: tuple[type, ...],
) -> list[int]:
    """Numbers of states of a body whose error is asked for.

    Raises:
        ValueError: It is not in the scene, of another kind, or there is no such state.
    """
    require_states(result)
    require_scene(scene)
    if not isinstance(body, kinds):
        known = " and ".join(f"{kind.__name__}s" for kind in kinds)
        raise ValueError(f"the error in space is estimated for {known}, got {body!r}")
    if body not in scene.bodies:
        raise ValueError(f"{body.label} is not in the scene")
    return [state_number(step, len(result.frames)) for step in steps]
