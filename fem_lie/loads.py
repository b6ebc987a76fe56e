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
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from fem_lie._jit import Array
from fem_lie._wanted import at_time, flag, history, instance, number, numbers
from fem_lie.beam import Beam
from fem_lie.bodies import Body, Point, direction, require_point, vector

History = Callable[[float], float]

_ORTHONORMAL = 1e-8  # rotations that are given with single precision are not


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
        """See the base class."""
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
        """See the base class."""
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


@dataclass(frozen=True, eq=False)
class PointLoad(NodalLoad):
    """Force and moment at a point.

    Attributes:
        point: Where.
        force: Three components: global if fixed in space, of the node's frame if following.
        moment: Likewise: about axes fixed in space, or about axes that follow the node.
        following: Whether the load turns with the node's frame.
        history: Factor as a function of time.
    """

    point: Point
    force: npt.ArrayLike = (0.0, 0.0, 0.0)
    moment: npt.ArrayLike = (0.0, 0.0, 0.0)
    following: bool = False
    history: History | None = None

    def __post_init__(self) -> None:
        """See the base class."""
        super().__post_init__()
        require_point(self.point, "PointLoad: point")

    def check(self) -> None:
        """Raise ``ValueError`` if it is not finite or acts on ground."""
        vector(self.force, 3, f"force at {self.point.label}")
        vector(self.moment, 3, f"moment at {self.point.label}")
        if self.point.is_ground:
            raise ValueError("a load needs a point of a body, got ground")

    def axis(self) -> Array:
        """Of the moment before anything moves, global components, shape (3,)."""
        moment = np.asarray(self.moment, dtype=np.float64)
        return moment @ self.point.frame[1:] if self.following else moment

    @property
    def body(self) -> Body:
        """The body that carries the load."""
        assert self.point.body is not None
        return self.point.body

    def nodal(self) -> Array:
        """Force and moment at each node of the body, shape (n, 6)."""
        values = np.zeros((len(self.body.frames), 6))
        values[self.point.node, :3] = self.force
        values[self.point.node, 3:] = self.moment
        return values


@dataclass(frozen=True, eq=False)
class LineLoad(NodalLoad):
    """Force and moment per reference length on all of a beam or on some of its cells.

    Attributes:
        beam: What carries it.
        force: Three components per length: global if fixed in space, local if following.
        moment: Likewise.
        cells: Name of a group of cells; default: all.
        following: Whether the load turns with the nodes' frames.
        history: Factor as a function of time.
    """

    beam: Body
    force: npt.ArrayLike = (0.0, 0.0, 0.0)
    moment: npt.ArrayLike = (0.0, 0.0, 0.0)
    cells: str | None = None
    following: bool = False
    history: History | None = None

    def __post_init__(self) -> None:
        """See the base class."""
        super().__post_init__()
        instance(self.beam, Beam, "LineLoad: beam", "a Beam (on shells: EdgeLoad)")

    def check(self) -> None:
        """See the base class."""
        vector(self.force, 3, f"line force on {self.body.label}")
        vector(self.moment, 3, f"line moment on {self.body.label}")
        self.body.cells_of(self.cells)

    @property
    def body(self) -> Body:
        """The body that carries the load."""
        return self.beam

    def nodal(self) -> Array:
        """Consistent nodal forces and moments of the interpolation, shape (n, 6)."""
        values = np.zeros((len(self.body.frames), 6))
        nodes, shares = self.body.consistent_shares()
        chosen = self.body.cells_of(self.cells)
        density = np.concatenate([self.force, self.moment]).astype(np.float64)
        np.add.at(values, nodes[chosen], shares[chosen, :, np.newaxis] * density)
        return values

    def on_directors(self) -> Array:
        """What the bow of the axis carries to the ends, shape (n, 3, 3)."""
        values = np.zeros((len(self.body.frames), 3, 3))
        nodes, _ = self.body.consistent_shares()
        chosen, levers = self.body.cells_of(self.cells), self.body.consistent_levers()
        force = np.asarray(self.force, dtype=np.float64)
        np.add.at(values, nodes[chosen], levers[chosen, :, :, np.newaxis] * force)
        return values


@dataclass(frozen=True, eq=False)
class PressureLoad(Load):
    """Pressure on one face of a beam: always normal to the axis, per *current* length.

    The force per length is ``p x' × w`` with ``w`` the axis across the face, which turns with the
    section; its load stiffness is in the matrix. It has no potential.

    Attributes:
        beam: What carries it.
        pressure: Force per current length (pressure times the width of the face).
        direction: Local components of the push in the unloaded configuration, across the axis.
        cells: Name of a group of cells; default: all.
        history: Factor as a function of time.
    """

    beam: Beam
    pressure: float
    direction: npt.ArrayLike = (0.0, 0.0, 1.0)
    cells: str | None = None
    history: History | None = None

    def __post_init__(self) -> None:
        """See the base class."""
        super().__post_init__()
        instance(self.beam, Beam, "PressureLoad: beam", "a Beam (on shells: SurfacePressure)")

    def check(self) -> None:
        """Raise ``ValueError`` if it is not finite, or its direction is zero or along the axis."""
        push = direction(self.direction, f"direction of the pressure on {self.beam.label}")
        number(self.pressure, f"pressure on {self.beam.label}")
        if abs(push[0]) > 1e-9:
            raise ValueError(
                f"the direction of the pressure on {self.beam.label} must be across the axis "
                f"(0, y, z), got {self.direction}"
            )
        self.beam.cells_of(self.cells)

    @property
    def body(self) -> Beam:
        """The body that carries the load."""
        return self.beam

    def across(self) -> Array:
        """``w = m × e₁`` times the pressure, shape (3,)."""
        push = direction(self.direction, f"direction of the pressure on {self.beam.label}")
        return self.pressure * np.cross(push, [1.0, 0.0, 0.0])


@dataclass(frozen=True, eq=False)
class Eigenstrain(StrainLoad):
    """A strain without stress, such as that of growth or of an actuator.

    Attributes:
        beam: What is strained.
        strain: (Γ₁, Γ₂, Γ₃, κ₁, κ₂, κ₃).
        cells: Name of a group of cells; default: all.
        history: Factor as a function of time.
    """

    beam: Beam
    strain: npt.ArrayLike
    cells: str | None = None
    history: History | None = None

    def check(self) -> None:
        """See the base class."""
        vector(self.strain, 6, f"eigenstrain of {self.beam.label}")
        self.beam.cells_of(self.cells)

    def strains(self) -> Array:
        """Strain of each cell, shape (m, 6)."""
        return self._in_cells(self.strain)


@dataclass(frozen=True, eq=False)
class Temperature(StrainLoad):
    """Change of temperature with a constant gradient over the section.

    A point (y, z) of the section is warmer by ``rise + gradient · (y, z)``.

    Attributes:
        beam: What is warmed.
        rise: At the axis.
        expansion: Coefficient of thermal expansion, per temperature.
        gradient: Along e₂ and e₃, temperature per length.
        cells: Name of a group of cells; default: all.
        history: Factor as a function of time.
    """

    beam: Beam
    rise: float
    expansion: float
    gradient: npt.ArrayLike = (0.0, 0.0)
    cells: str | None = None
    history: History | None = None

    def check(self) -> None:
        """See the base class."""
        vector([self.rise, self.expansion], 2, f"rise and expansion of {self.beam.label}")
        vector(self.gradient, 2, f"gradient of temperature of {self.beam.label}")
        self.beam.cells_of(self.cells)

    def strains(self) -> Array:
        """Strain of each cell, shape (m, 6): ε = α ΔT(y, z) = Γ₁ + z κ₂ − y κ₃."""
        y, z = np.asarray(self.gradient, dtype=np.float64)
        strain = self.expansion * np.array([self.rise, 0, 0, 0, z, -y])
        return self._in_cells(strain)


@dataclass(frozen=True, eq=False)
class PreStress(StrainLoad):
    """Force and moment that the section has in the unloaded configuration.

    Attributes:
        beam: What is stressed.
        resultant: (N₁, N₂, N₃, M₁, M₂, M₃) in the section's frame.
        cells: Name of a group of cells; default: all.
        history: Factor as a function of time.
    """

    beam: Beam
    resultant: npt.ArrayLike
    cells: str | None = None
    history: History | None = None

    def check(self) -> None:
        """See the base class."""
        vector(self.resultant, 6, f"pre-stress of {self.beam.label}")
        self.beam.cells_of(self.cells)

    def strains(self) -> Array:
        """Strain of each cell, shape (m, 6): −D⁻¹ times the resultant."""
        resultant = np.asarray(self.resultant, dtype=np.float64)
        strain = np.linalg.solve(self.beam.element_stiffness, -resultant[:, np.newaxis])
        return self._in_cells(strain[..., 0])


@dataclass(frozen=True, eq=False)
class Clamp:
    """The point's frame does not move."""

    point: Point

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if it is no point."""
        require_point(self.point, "Clamp: point")

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
            start it must be the point's initial frame. If its velocity or acceleration jumps,
            :class:`~fem_lie.Jumps` says when.
    """

    point: Point
    motion: Callable[[float], Array]

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if it is no point, or the motion no function."""
        require_point(self.point, "PrescribedMotion: point")
        instance(self.motion, Callable, "PrescribedMotion: motion", "a function of time")

    def check(self) -> None:
        """Raise ``ValueError`` if the motion does not start at the point's frame."""
        if self.point.is_ground:
            raise ValueError("a prescribed motion needs a point of a body, got ground")
        start = numbers(self.motion(0.0), f"the motion of {self.point.label}")
        gap = np.inf
        if start.shape == (4, 3):
            away = np.abs(start - self.point.frame)
            size = max(self.point.size, np.abs(self.point.position).max())
            gap = max(away[0].max() / size, away[1:].max())
        if not gap <= 1e-8:
            raise ValueError(
                f"the motion of {self.point.label} must start at its frame\n{self.point.frame},\n"
                f"got\n{start}"
            )

    def frame(self, time: float) -> Array:
        """Where the motion is at ``time``, shape (4, 3).

        Raises:
            ValueError: That is not a place and three unit vectors, each across the others, of a
                right-handed system.
        """
        frame = numbers(self.motion(time), f"the motion of {self.point.label}")
        if frame.shape != (4, 3) or not np.isfinite(frame).all():
            raise ValueError(
                f"the motion of {self.point.label} must be a finite frame of shape (4, 3); at time "
                f"{time:g} it is\n{frame}"
            )
        axes = frame[1:]
        if np.abs(axes @ axes.T - np.eye(3)).max() > _ORTHONORMAL or np.linalg.det(axes) < 0.0:
            raise ValueError(
                f"the motion of {self.point.label} must be a place and right-handed orthonormal "
                f"axes; at time {time:g} it is\n{frame}"
            )
        return frame


def histories(loads: Sequence[Load]) -> dict[int, History]:
    """Those of the loads that have one, by the loads' numbers."""
    return {k: load.history for k, load in enumerate(loads) if load.history is not None}
