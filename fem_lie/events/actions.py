"""Actions of events: what they do to a running scene."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, Protocol

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

    def scale(self, item: Any, factor: float) -> None:
        """Set the factor of a load, spring or force law.

        Args:
            item: The item.
            factor: The factor.
        """

    def locked(self, connection: Connection) -> bool:
        """Whether the constraints of a connection act.

        Args:
            connection: A joint, drive or gear.
        """

    def factor(self, item: Any) -> float:
        """Current factor of a load, spring or force law.

        Args:
            item: The item.
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

    def changes(self, scene: Switchboard) -> bool:
        """Whether it changes anything now.

        Args:
            scene: The running scene.
        """
        return True

    @property
    def switched(self) -> Connection | None:
        """Connection whose constraints it switches, or ``None``."""
        return None

    @property
    def scaled(self) -> tuple[Any, float | None] | None:
        """Load, spring or force law whose factor it sets, and that at the start if it is known."""
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
        linear = self.connection.tie_definition() is not None
        if not (self.connection.size or linear) or self.connection.velocity_definitions():
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

    def changes(self, scene: Switchboard) -> bool:
        """Whether the constraints do not act yet."""
        return not scene.locked(self.connection)


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

    def changes(self, scene: Switchboard) -> bool:
        """Whether the constraints act."""
        return scene.locked(self.connection)


@dataclass(frozen=True, eq=False)
class Scale(Action):
    """Set the factor of a load, spring or force law: 0 switches it off, 1 on.

    The factor multiplies the history of a load, and forces and derivatives of a law.

    Attributes:
        item: A load, spring or force law of the scene.
        factor: Its factor from the event on.
        initial: Its factor before any event; default: 1, or what another event says.

    Example:
        >>> rocket = fl.RigidBody(1.0, (0.1, 0.1, 0.1))
        >>> scene = fl.Scene()
        >>> _ = scene.add(rocket)
        >>> thrust = scene.add(fl.PointLoad(rocket.point("centre"), force=(0, 0, 20.0)))
        >>> burnt = fl.schemes.Scale(thrust, 0.0)
        >>> _ = scene.add(fl.schemes.Event(lambda state: state.time - 0.5, burnt))
        >>> result = fl.GeneralisedAlpha().run(scene, duration=1.0, step=0.01)
        >>> print(result.position(rocket.point("centre"))[-1, 2].round(4))
        7.5
    """

    item: Any
    factor: float
    initial: float | None = None

    def __post_init__(self) -> None:
        """Raise an error if a factor is not a finite number."""
        _arrays.number(self.factor, "Scale: factor")
        if self.initial is not None:
            _arrays.number(self.initial, "Scale: initial")

    @property
    def scaled(self) -> tuple[Any, float | None]:
        """The item, and its factor at the start if it is known."""
        return self.item, self.initial

    def act(self, scene: Switchboard) -> None:
        """Set the factor."""
        scene.scale(self.item, float(self.factor))

    def changes(self, scene: Switchboard) -> bool:
        """Whether the factor is another one."""
        return scene.factor(self.item) != float(self.factor)
