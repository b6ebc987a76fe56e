"""Actions of events: what they do to a running scene."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Protocol

from fem_lie import _arrays
from fem_lie.joints.connection import Connection


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
        if self.connection.bounds is not None:
            raise ValueError(f"{name}: {self.connection.label} is a limit, which switches itself")
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
