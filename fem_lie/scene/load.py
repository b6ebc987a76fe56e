"""Loads and supports: what a scene adds to points and bodies.

A load history is a function of time (in statics: of the load factor between 0 and 1). Without one a
load is constant in dynamics and proportional to the load factor in statics. One that jumps should
say so (:class:`~fem_lie.Table`, :class:`~fem_lie.Jumps`): steps in time then end there.

In local frames a following load is constant and has no load stiffness at all; a force fixed in
space is a constant force on ``q = (x, d₁, d₂, d₃)``.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, at_time, flag, history, instance
from fem_lie.bodies.beam import Beam
from fem_lie.bodies.body import Body

History = Callable[[float], float]


def amplitudes(histories: Mapping[int, History], times: npt.ArrayLike) -> Array:
    """Factors at ``times`` (T,), shape (T, k), of k loads; keys are their numbers in the scene.

    Raises:
        ValueError: One of them is not finite; the message names load and time.
    """
    at: Array = np.asarray(times, dtype=np.float64).reshape(-1)
    if not histories:
        return np.zeros((len(at), 0))
    named = [(given, f"the history of load {k + 1}") for k, given in histories.items()]
    values = [[at_time(given, time, what) for given, what in named] for time in map(float, at)]
    factors = np.array(values, dtype=np.float64).reshape(len(at), len(histories))
    if not np.isfinite(factors).all():
        t, k = np.argwhere(~np.isfinite(factors))[0]
        raise ValueError(
            f"the history of load {list(histories)[k] + 1} is {factors[t, k]} at time {at[t]:g}"
        )
    return factors


class Load(ABC):
    """What all loads have in common; use one of the subclasses.

    Attributes:
        history: Factor as a function of time, or ``None``.
    """

    history: History | None

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if an argument is of another kind than wanted."""
        history(self.history, f"{type(self).__name__}: history")

    @property
    @abstractmethod
    def body(self) -> Body:
        """The body that carries the load."""

    @abstractmethod
    def check(self) -> None:
        """Raise ``ValueError`` if the load is not finite or the body has no such cells."""


class NodalLoad(Load):
    """Forces and moments on nodes.

    Attributes:
        following: Whether the load turns with the nodes' frames.
    """

    following: bool

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if an argument is of another kind than wanted."""
        super().__post_init__()
        flag(self.following, f"{type(self).__name__}: following")

    @abstractmethod
    def nodal(self) -> Array:
        """Force and moment at each node of the body, shape (n, 6)."""

    def on_directors(self) -> Array:
        """Force on the directors of each node beside, as ``force`` and on d₁, d₂, d₃, (n, 3, 3)."""
        return np.zeros((len(self.body.frames), 3, 3))


class StrainLoad(Load):
    """A strain that a beam would have without stress.

    Attributes:
        beam: What is strained.
        cells: Name of a group of cells; default: all.
    """

    beam: Beam
    cells: str | None

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if an argument is of another kind than wanted."""
        super().__post_init__()
        instance(self.beam, Beam, f"{type(self).__name__}: beam", "a Beam")

    @property
    def body(self) -> Beam:
        """The body that carries the load."""
        return self.beam

    @abstractmethod
    def strains(self) -> Array:
        """Strain (Γ, κ) of each cell of the body, shape (m, 6)."""

    def _in_cells(self, strain: npt.ArrayLike) -> Array:
        """The strain, (6,) or (m, 6), in the loaded cells, zero elsewhere."""
        values, cells = np.zeros((len(self.beam.stiffness), 6)), self.beam.cells_of(self.cells)
        given = np.asarray(strain, dtype=np.float64)
        values[cells] = np.broadcast_to(given, values.shape)[cells]
        return values


def histories(loads: Sequence[Load]) -> dict[int, History]:
    """Those of the loads that have one, by the loads' numbers."""
    return {k: load.history for k, load in enumerate(loads) if load.history is not None}
