"""Events: what happens when a function of the state passes through zero."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeAlias

from fem_lie import _arrays
from fem_lie._arrays import Array
from fem_lie.bodies.body import Point
from fem_lie.joints.connection import Connection


class State(Protocol):
    """State of a running scene, as conditions and actions of events see it.

    Attributes:
        time: The time.
    """

    time: float

    def position(self, point: Point | str) -> Array:
        """Position of a point, global components, shape (3,)."""

    def rotation(self, point: Point | str) -> Array:
        """Rotation of a point's frame, local to global, shape (3, 3)."""

    def velocity(self, point: Point | str) -> Array:
        """Velocity of a point (translation, rotation) in its local frame, shape (6,)."""

    def coordinate(self, joint: Connection | str, name: str | None = None) -> float:
        """Relative coordinate of a joint: an unwrapped angle in rad, or a length."""

    def rate(self, joint: Connection | str, name: str | None = None) -> float:
        """Rate of a relative coordinate."""


class Switchboard(Protocol):
    """What actions of the package can do in a running scene."""

    def lock(self, connection: Connection) -> None:
        """Activate the constraints of a connection.

        Args:
            connection: A joint, drive or gear.

        Raises:
            ValueError: The state contradicts them.
        """

    def release(self, connection: Connection) -> None:
        """Deactivate the constraints of a connection.

        Args:
            connection: A joint, drive or gear.
        """

    def stop(self) -> None:
        """End the run."""


class Action(ABC):
    """Base class of what an event does to the scene."""

    @abstractmethod
    def act(self, scene: Switchboard) -> None:
        """Do it.

        Args:
            scene: The running scene.
        """

    @property
    def switched(self) -> Connection | None:
        """Connection whose constraints it switches, or ``None``."""
        return None


@dataclass(frozen=True)
class Stop(Action):
    """End the run: the result ends at the event.

    Example:
        >>> event = fl.schemes.Event(lambda state: state.time - 0.5, fl.schemes.Stop())
    """

    def act(self, scene: Switchboard) -> None:
        """End the run."""
        scene.stop()


@dataclass(frozen=True, eq=False)
class _Switch(Action):
    """Switch the constraints of a joint, drive or gear of the scene.

    Attributes:
        connection: A joint, drive or gear with constraints of positions.
    """

    connection: Connection

    def __post_init__(self) -> None:
        """Raise an error if the connection has no constraint that can be switched."""
        name = type(self).__name__
        _arrays.instance(self.connection, Connection, name, "a joint, drive or gear")
        if not self.connection.size or self.connection.velocity_definitions():
            raise ValueError(
                f"{name}: {self.connection.label} has no constraints of positions, expected a "
                "joint, drive or gear that has"
            )

    @property
    def switched(self) -> Connection:
        """The connection."""
        return self.connection


@dataclass(frozen=True, eq=False)
class Lock(_Switch):
    """Activate the constraints of a joint, drive or gear: a plastic impact in it.

    Velocities change by the impulse that stops the relative motion with the least loss of energy;
    momentum is conserved. A drive without a function and a gear hold the coordinates where they
    are; other constraints must be closed at the event.

    Example:
        >>> panel = fl.RigidBody(5.0, (0.1, 0.4, 0.4), position=(0.5, 0, 0))
        >>> scene = fl.Scene()
        >>> _ = scene.add(panel)
        >>> hinge = scene.add(fl.joints.Revolute(fl.ground(), panel.point("centre"), at=(0, 0, 0)))
        >>> latch = scene.add(fl.joints.Drive(hinge.angle, active=False))
        >>> stop = fl.schemes.Event(lambda state: state.coordinate(hinge) - 1.5,
        ...     fl.schemes.Lock(latch))
        >>> _ = scene.add(stop)
    """

    def act(self, scene: Switchboard) -> None:
        """Activate the constraints."""
        scene.lock(self.connection)


@dataclass(frozen=True, eq=False)
class Release(_Switch):
    """Deactivate the constraints of a joint, drive or gear: the bodies move on freely.

    Example:
        >>> panel = fl.RigidBody(5.0, (0.1, 0.4, 0.4), position=(0.5, 0, 0))
        >>> scene = fl.Scene()
        >>> _ = scene.add(panel)
        >>> hold = scene.add(fl.joints.Fixed(fl.ground(), panel.point("centre")))
        >>> _ = scene.add(fl.schemes.Event(lambda state: state.time - 1.0,
        ...     fl.schemes.Release(hold)))
    """

    def act(self, scene: Switchboard) -> None:
        """Deactivate the constraints."""
        scene.release(self.connection)


Condition: TypeAlias = Callable[[State], float]
"""Function of the state whose zero is the event."""

Reaction: TypeAlias = Action | Callable[[State], None]
"""Action of the package, or function of the user."""


@dataclass(frozen=True, eq=False)
class Event:
    """Actions at the time when a function of the state passes through zero.

    The step in which the function changes its sign is repeated with a size that ends there. Results
    have two rows at the time of an event: before and after its actions. The events of a run are in
    ``result.steps``: times, numbers and lost energy.

    :class:`~fem_lie.GeneralisedAlpha` with steps of any kind has events; other schemes refuse them.

    Attributes:
        condition: Function of the :class:`~fem_lie.joints.events.State`, continuous in time.
        action: :class:`~fem_lie.schemes.Lock`, :class:`~fem_lie.schemes.Release`,
            :class:`~fem_lie.schemes.Stop`, a function of the state, or a sequence of these. A
            function may change what histories and force laws read; checkpoints do not save that.
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
                    "Event: action must be Lock, Release, Stop, a function of the state, or a "
                    f"sequence of these, got {_arrays.shown(action)}"
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

    @property
    def switched(self) -> list[Connection]:
        """Connections whose constraints it switches."""
        found = (each.switched for each in self.actions if isinstance(each, Action))
        return [each for each in found if each is not None]
