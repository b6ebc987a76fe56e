"""Sensors: named quantities of a run at the ends of all steps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from fem_lie import _arrays
from fem_lie.events.state import State


@dataclass(frozen=True, eq=False)
class Sensor:
    """Named quantity that is sampled at the start and at the end of every step of a run.

    ``result.sensor(name)`` has its values at the times ``result.steps.sensor_times``, whichever
    states are recorded. :class:`~fem_lie.GeneralisedAlpha` with steps of any kind has sensors.

    Attributes:
        name: Name in results.
        quantity: Function of the :class:`~fem_lie.events.state.State` that returns a number.

    Example:
        >>> ball = fl.RigidBody(1.0, (0.1, 0.1, 0.1), position=(0, 0, 1.0))
        >>> scene = fl.Scene(gravity=(0, 0, -10.0))
        >>> _ = scene.add(ball)
        >>> _ = scene.add(fl.schemes.Sensor("height", lambda state:
        ...     state.position(ball.point("centre"))[2]))
        >>> result = fl.GeneralisedAlpha().run(scene, duration=0.1, step=0.01, save_every=10)
        >>> print(len(result.times), result.sensor("height").round(4)[:3])
        2 [1.     0.9995 0.998 ]
    """

    name: str
    quantity: Callable[[State], float]

    def __post_init__(self) -> None:
        """Raise an error if an argument has a wrong type."""
        _arrays.text(self.name, "Sensor: name")
        if not self.name:
            raise ValueError("Sensor: expected a name, got an empty text")
        if not callable(self.quantity):
            raise TypeError(
                "Sensor: quantity must be a function of the state, got "
                f"{_arrays.shown(self.quantity)}"
            )
