"""Loads and supports: what a scene adds to points and bodies.

A load history is a function of time (in statics: of the load factor between 0 and 1). Without one a
load is constant in dynamics and proportional to the load factor in statics.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from fem_lie._jit import Array
from fem_lie.bodies import Body, Point, vector

History = Callable[[float], float]


def amplitudes(histories: Mapping[int, History], times: npt.ArrayLike) -> Array:
    """Factors at ``times`` (T,), shape (T, k), of k loads; keys are their numbers in the scene.

    Raises:
        ValueError: One of them is not finite; the message names load and time.
    """
    at: Array = np.asarray(times, dtype=np.float64).reshape(-1)
    if not histories:
        return np.zeros((len(at), 0))
    values = [[history(time) for history in histories.values()] for time in map(float, at)]
    factors = np.array(values, dtype=np.float64).reshape(len(at), len(histories))
    if not np.isfinite(factors).all():
        t, k = np.argwhere(~np.isfinite(factors))[0]
        raise ValueError(
            f"the history of load {list(histories)[k] + 1} is {factors[t, k]} at time {at[t]:g}"
        )
    return factors


@dataclass(frozen=True, eq=False)
class PointLoad:
    """Force and moment at a point.

    Attributes:
        point: Where.
        force: Three components: global if fixed in space, of the node's frame if following.
        moment: Likewise.
        following: Whether the load turns with the node's frame.
        history: Factor as a function of time.
    """

    point: Point
    force: npt.ArrayLike = (0.0, 0.0, 0.0)
    moment: npt.ArrayLike = (0.0, 0.0, 0.0)
    following: bool = False
    history: History | None = None

    def check(self) -> None:
        """Raise ``ValueError`` if the load is not finite or acts on ground."""
        vector(self.force, 3, f"force at {self.point.label}")
        vector(self.moment, 3, f"moment at {self.point.label}")
        if self.point.is_ground:
            raise ValueError("a load needs a point of a body, got ground")

    @property
    def body(self) -> Body:
        """The body that carries the load."""
        assert self.point.body is not None
        return self.point.body

    def nodal(self) -> Array:
        """Force and moment at each node of the body, shape (n, 6)."""
        values = _zeros(self.body)
        values[self.point.node, :3] = self.force
        values[self.point.node, 3:] = self.moment
        return values


@dataclass(frozen=True, eq=False)
class LineLoad:
    """Force and moment per reference length on all of a body or on some of its cells.

    Attributes:
        body: The beam.
        force: Three components per length: global if fixed in space, local if following.
        moment: Likewise.
        cells: Name of a group of cells; default: all.
        following: Whether the load turns with the nodes' frames.
        history: Factor as a function of time.
    """

    body: Body
    force: npt.ArrayLike = (0.0, 0.0, 0.0)
    moment: npt.ArrayLike = (0.0, 0.0, 0.0)
    cells: str | None = None
    following: bool = False
    history: History | None = None

    def check(self) -> None:
        """Raise ``ValueError`` if the load is not finite or the body has no such cells."""
        vector(self.force, 3, f"line force on {self.body.label}")
        vector(self.moment, 3, f"line moment on {self.body.label}")
        self.body.cell_lengths(self.cells)

    def nodal(self) -> Array:
        """Consistent nodal forces and moments of linear interpolation, shape (n, 6)."""
        values = _zeros(self.body)
        index, lengths = self.body.cell_lengths(self.cells)
        for side in range(2):
            for columns, density in ((slice(0, 3), self.force), (slice(3, 6), self.moment)):
                share = 0.5 * np.outer(lengths, np.asarray(density, dtype=np.float64))
                np.add.at(values[:, columns], self.body.cells[index, side], share)
        return values


@dataclass(frozen=True, eq=False)
class Clamp:
    """The point's frame does not move."""

    point: Point

    def check(self) -> None:
        """Raise ``ValueError`` if the point is ground."""
        if self.point.is_ground:
            raise ValueError("a clamp needs a point of a body, got ground")


@dataclass(frozen=True, eq=False)
class PrescribedMotion:
    """The point's frame follows a given motion.

    Attributes:
        point: What moves.
        motion: Frame ``H(t)``, shape (4, 3) as in :mod:`fem_lie.lie`, twice differentiable; at the
            start it must be the point's initial frame.
    """

    point: Point
    motion: Callable[[float], Array]

    def check(self) -> None:
        """Raise ``ValueError`` if the motion does not start at the point's frame."""
        if self.point.is_ground:
            raise ValueError("a prescribed motion needs a point of a body, got ground")
        start = np.asarray(self.motion(0.0), dtype=np.float64)
        gap = np.abs(start - self.point.frame).max() if start.shape == (4, 3) else np.inf
        if not gap <= 1e-8 * max(1.0, np.abs(self.point.frame).max()):
            raise ValueError(
                f"the motion of {self.point.label} must start at its frame\n{self.point.frame},\n"
                f"got\n{start}"
            )


Load = PointLoad | LineLoad


def histories(loads: Sequence[Load]) -> dict[int, History]:
    """Those of the loads that have one, by the loads' numbers."""
    return {k: load.history for k, load in enumerate(loads) if load.history is not None}


def _zeros(body: Body) -> Array:
    return np.zeros((len(body.frames), 6))
