"""Events: what happens when a function of the state passes through zero."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from fem_lie import _arrays
from fem_lie.events.actions import Action, Switchboard
from fem_lie.events.state import State
from fem_lie.joints.connection import Connection

Condition: TypeAlias = Callable[[State], float]
"""Function of the state whose zero is the event."""

Reaction: TypeAlias = Action | Callable[[State], None]
"""Action of the package, or function of the user."""


@dataclass(frozen=True, eq=False)
class Event:
    """Actions at the time when a function of the state passes through zero.

    An event of actions that change nothing, such as :class:`~fem_lie.schemes.Lock` of what is
    locked, does not happen.

    The step in which the function changes its sign is repeated with a size that ends there. Results
    have two rows at the time of an event: before and after its actions. The events of a run are in
    ``result.steps``: times, numbers and lost energy.

    :class:`~fem_lie.GeneralisedAlpha` with steps of any kind has events; other schemes refuse them.

    Attributes:
        condition: Function of the :class:`~fem_lie.events.state.State`, continuous in time.
        action: :class:`~fem_lie.schemes.Lock`, :class:`~fem_lie.schemes.Release`,
            :class:`~fem_lie.schemes.Scale`, :class:`~fem_lie.schemes.Stop`, a function of the
            state, or a sequence of these. A function may change what histories and force laws
            read; checkpoints do not save that.
        direction: 1 if the function must rise, −1 if it must fall; 0: either.
        repeated: Whether it happens again each time; otherwise only the first time.
        name: Name in messages.

    Example:
        >>> ball = fl.RigidBody(1.0, (0.1, 0.1, 0.1), position=(0, 0, 1.0))
        >>> scene = fl.Scene(gravity=(0, 0, -10.0))
        >>> _ = scene.add(ball)
        >>> _ = scene.add(fl.schemes.Event(lambda state: state.position(ball.point("centre"))[2],
        ...     fl.schemes.Stop()))
        >>> result = fl.GeneralisedAlpha().run(scene, duration=1.0, step=0.01)
        >>> print(f"{result.times[-1]:.6f}")
        0.447214
    """

    condition: Condition
    action: Reaction | Sequence[Reaction]
    direction: int = 0
    repeated: bool = False
    name: str = ""

    def __post_init__(self) -> None:
        """Raise an error if an argument has a wrong type or value."""
        if not callable(self.condition):
            raise TypeError(
                "Event: condition must be a function of the state, got "
                f"{_arrays.shown(self.condition)}"
            )
        for action in self.actions:
            if not (isinstance(action, Action) or callable(action)):
                raise TypeError(
                    "Event: action must be Lock, Release, Scale, Stop, a function of the state, or "
                    f"a sequence of these, got {_arrays.shown(action)}"
                )
        if self.direction not in (-1, 0, 1):
            raise ValueError(f"Event: expected direction 1, −1 or 0, got {self.direction}")
        _arrays.flag(self.repeated, "Event: repeated")
        _arrays.text(self.name, "Event: name")

    @property
    def actions(self) -> tuple[Reaction, ...]:
        """All actions, in order."""
        given = self.action
        return tuple(given) if isinstance(given, Sequence) else (given,)

    @property
    def label(self) -> str:
        """Name in messages."""
        return self.name or getattr(self.condition, "__name__", "event")

    def changes(self, scene: Switchboard) -> bool:
        """Whether its actions change anything now.

        Args:
            scene: The running scene.
        """
        return any(not isinstance(a, Action) or a.changes(scene) for a in self.actions)

    @property
    def switched(self) -> list[Connection]:
        """Connections whose constraints it switches."""
        found = (each.switched for each in self.actions if isinstance(each, Action))
        return [each for each in found if each is not None]

    @property
    def scaled(self) -> list[tuple[Any, float | None]]:
        """Items whose factors it sets, and their factors at the start if they are known."""
        found = (each.scaled for each in self.actions if isinstance(each, Action))
        return [each for each in found if each is not None]
