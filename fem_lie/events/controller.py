"""Controllers: factors of loads and force laws, computed at samples in time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from fem_lie import _arrays
from fem_lie._arrays import Array
from fem_lie.events.state import State

Update: TypeAlias = Callable[[State, Array], tuple[npt.ArrayLike, npt.ArrayLike]]
"""Factors of the actuators and new memory, as a function of the state and of the memory."""


@dataclass(frozen=True, eq=False)
class Controller:
    """Sampled controller, whose outputs are held between samples (zero-order hold).

    At the times 0, T, 2 T, … it computes the factors by which its actuators are multiplied until
    the next sample. Steps end there. Its memory, such as the sum of an integral part, is in
    checkpoints: a resumed run is the same to the last bit.

    :class:`~fem_lie.GeneralisedAlpha` with steps of any kind has controllers.

    Attributes:
        update: Function of the :class:`~fem_lie.events.state.State` and of the memory that returns
            a factor for each actuator, and the new memory.
        actuators: Loads, springs and force laws of the scene.
        period: Time T between samples.
        memory: Memory at the first sample, any number of numbers; default: none.
        name: Name in messages.

    Example:
        >>> cart = fl.RigidBody(1.0, (0.1, 0.1, 0.1))
        >>> scene = fl.Scene()
        >>> _ = scene.add(cart)
        >>> thrust = scene.add(fl.PointLoad(cart.point("centre"), force=(1.0, 0.0, 0.0)))
        >>> def held_at_one(state, memory):
        ...     gap = 1.0 - state.position(cart.point("centre"))[0]
        ...     return [20.0 * gap + 100.0 * (gap - memory[0])], [gap]
        >>> _ = scene.add(fl.schemes.Controller(held_at_one, [thrust], period=0.05, memory=[1.0]))
        >>> result = fl.GeneralisedAlpha().run(scene, duration=4.0, step=0.01)
        >>> print(result.position(cart.point("centre"))[-1, 0].round(2))
        1.0
    """

    update: Update
    actuators: Sequence[Any]
    period: float
    memory: npt.ArrayLike = ()
    name: str = ""

    def __post_init__(self) -> None:
        """Raise an error if an argument has a wrong type or value."""
        if not callable(self.update):
            raise TypeError(
                f"Controller: update must be a function of the state and of the memory, got "
                f"{_arrays.shown(self.update)}"
            )
        if not isinstance(self.actuators, Sequence) or not self.actuators:
            raise ValueError(
                "Controller: actuators must be a sequence of loads, springs or force laws, got "
                f"{_arrays.shown(self.actuators)}"
            )
        _arrays.positive(self.period, "Controller: period")
        if not np.isfinite(self.start).all():
            raise ValueError(f"Controller: expected finite numbers in memory, got {self.memory!r}")
        _arrays.text(self.name, "Controller: name")

    @property
    def start(self) -> Array:
        """Memory at the first sample, shape (k,)."""
        return np.atleast_1d(_arrays.numbers(self.memory, "Controller: memory")).ravel()

    @property
    def label(self) -> str:
        """Name in messages."""
        return self.name or getattr(self.update, "__name__", "controller")
