"""Controllers: factors of loads and force laws, computed at samples or with the motion."""

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

OfState: TypeAlias = Callable[[State, Array], npt.ArrayLike]
"""Numbers as a function of the state of the scene and of that of the controller."""


def _check_actuators(kind: str, actuators: object) -> None:
    """Raise ``ValueError`` if actuators are no sequence, or there are none."""
    if not isinstance(actuators, Sequence) or not actuators:
        raise ValueError(
            f"{kind}: actuators must be a sequence of loads, springs or force laws, got "
            f"{_arrays.shown(actuators)}"
        )


def _numbers(kind: str, what: str, value: npt.ArrayLike) -> Array:
    """Finite numbers, shape (k,), or ``ValueError``."""
    found = np.atleast_1d(_arrays.numbers(value, f"{kind}: {what}")).ravel()
    if not np.isfinite(found).all():
        raise ValueError(f"{kind}: expected finite numbers in {what}, got {value!r}")
    return found


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
        _check_actuators("Controller", self.actuators)
        _arrays.positive(self.period, "Controller: period")
        _numbers("Controller", "memory", self.memory)
        _arrays.text(self.name, "Controller: name")

    @property
    def start(self) -> Array:
        """Memory at the first sample, shape (k,)."""
        return _numbers("Controller", "memory", self.memory)

    @property
    def numbers(self) -> Array:
        """Numbers on which it depends besides its function, shape (1 + k,)."""
        return np.append(self.period, self.start)

    @property
    def label(self) -> str:
        """Name in messages."""
        return self.name or getattr(self.update, "__name__", "controller")


@dataclass(frozen=True, eq=False)
class ContinuousController:
    """Controller with a state of its own, which is integrated together with the motion.

    The state ``x`` obeys an ordinary differential equation, and the outputs ``u`` are the factors
    by which the actuators are multiplied at every time::

        ẋ = f(state, x)        u = g(state, x)

    Both are functions of the :class:`~fem_lie.events.state.State` of the scene: of its time,
    positions, coordinates and rates. A controller without a state of its own, such as a
    proportional one, has ``initial=()``.

    Motion and controller are solved together at the end of each step, without a delay. The step of
    ``x`` is the second-order backward formula (BDF2): generalised-α for first-order equations with
    a spectral radius of zero (Jansen, Whiting & Hulbert, CMAME 190 (2000) 305), which damps filters
    that are faster than the steps. The state is in checkpoints: a resumed run is the same to the
    last bit. Adaptive steps estimate the error of the motion, not that of ``x``: give them a
    ``largest`` step that resolves the controller.

    :class:`~fem_lie.GeneralisedAlpha` with steps of any kind has such controllers.

    Attributes:
        rate: Function ``f`` that returns ``ẋ``, shape (k,).
        output: Function ``g`` that returns a factor for each actuator.
        actuators: Loads, springs and force laws of the scene.
        initial: State at the start, k numbers; default: none.
        name: Name in messages.

    Example:
        >>> cart = fl.RigidBody(1.0, (0.1, 0.1, 0.1))
        >>> scene = fl.Scene()
        >>> _ = scene.add(cart)
        >>> thrust = scene.add(fl.PointLoad(cart.point("centre"), force=(1.0, 0.0, 0.0)))
        >>> gap = lambda state: 1.0 - state.position(cart.point("centre"))[0]
        >>> pid = fl.schemes.ContinuousController(  # integral, and the filtered error
        ...     rate=lambda state, x: [gap(state), (gap(state) - x[1]) / 0.05],
        ...     output=lambda state, x: 9.0 * gap(state) + 5.0 * x[0] + 90.0 * (gap(state) - x[1]),
        ...     actuators=[thrust], initial=[0.0, 1.0])
        >>> _ = scene.add(pid)
        >>> result = fl.GeneralisedAlpha().run(scene, duration=15.0, step=0.05)
        >>> print(result.position(cart.point("centre"))[-1, 0].round(2))
        1.0
    """

    rate: OfState
    output: OfState
    actuators: Sequence[Any]
    initial: npt.ArrayLike = ()
    name: str = ""

    def __post_init__(self) -> None:
        """Raise an error if an argument has a wrong type or value."""
        for what in ("rate", "output"):
            if not callable(getattr(self, what)):
                raise TypeError(
                    f"ContinuousController: {what} must be a function of the state of the scene "
                    f"and of the controller, got {_arrays.shown(getattr(self, what))}"
                )
        _check_actuators("ContinuousController", self.actuators)
        _numbers("ContinuousController", "initial", self.initial)
        _arrays.text(self.name, "ContinuousController: name")

    @property
    def start(self) -> Array:
        """State at the start, shape (k,)."""
        return _numbers("ContinuousController", "initial", self.initial)

    @property
    def numbers(self) -> Array:
        """Numbers on which it depends besides its functions, shape (k,)."""
        return self.start

    @property
    def label(self) -> str:
        """Name in messages."""
        return self.name or getattr(self.rate, "__name__", "controller")
