"""Options of a path: end conditions, accuracy, and control of steps.

The control of a step is the quantity that is prescribed in it: arc length, displacement or load.
With ``Δu`` the displacements of the nodes in a step, and ``Δλ`` the change of the load factor, each
control is a distance ``g(Δu, Δλ)`` and its derivative. A step ends where the distance has the
requested length.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import inf, sqrt
from typing import Protocol

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, direction, flag, instance, number, positive, text, whole
from fem_lie.bodies.body import Point
from fem_lie.bodies.points import require_point
from fem_lie.results.path import PathState, Station
from fem_lie.solve.statics.arc_length import ArcLength, Dot, Equilibrium

_ACROSS = 1e-10  # component of a displacement over the largest one: less is round-off


class Control(Protocol):
    """Measure of the distance of a step."""

    def rate(self, u: Array, sign: float) -> float:
        """Change of the load factor per distance along the tangent ``(u, 1)``.

        ``sign`` is the direction of the load factor, if the control does not determine it.
        """
        ...

    def distance(self, moved: Array, change: float) -> float:
        """Distance of displacements (n, 3) and a change of the load factor."""
        ...

    def slope(self, moved: Array, change: float, u: Array, d: float) -> float:
        """Derivative of the distance along ``(u, d)``."""
        ...


@dataclass(frozen=True)
class Arc:
    """Length in the plane of displacement and load: ``√(rms(Δu)²/U² + Δλ²/Λ²)``.

    Attributes:
        length: Scale of displacements ``U``.
        load: Scale of the load factor ``Λ``.
        dot: Inner product of two arrays with a row for each node, over all ranks.
    """

    length: float
    load: float
    dot: Dot

    def inner(self, u: Array, d: float, v: Array, e: float) -> float:
        """Inner product of two directions."""
        one = np.ones(len(u))
        mean = self.dot(u, v) / self.dot(one, one)
        return mean / self.length**2 + d * e / self.load**2

    def norm(self, u: Array, d: float) -> float:
        """Length of a direction."""
        return sqrt(self.inner(u, d, u, d))

    def rate(self, u: Array, sign: float) -> float:
        """Change of the load factor per length along the tangent ``(u, 1)``."""
        return sign / self.norm(u, 1.0)

    def distance(self, moved: Array, change: float) -> float:
        """Length of displacements (n, 3) and a change of the load factor."""
        return self.norm(moved, change)

    def slope(self, moved: Array, change: float, u: Array, d: float) -> float:
        """Derivative of the length along ``(u, d)``."""
        length = self.norm(moved, change)
        return self.inner(moved, change, u, d) / length if length else self.norm(u, d)


@dataclass(frozen=True)
class Along:
    """Displacement along a fixed pattern: of one node, or the amplitude of a mode.

    Attributes:
        pattern: The pattern, shape (n, 3).
        unit: Displacement of distance one.
        of: Structure with these nodes, for sums over all ranks.
    """

    pattern: Array
    unit: float
    of: Equilibrium

    def rate(self, u: Array, sign: float) -> float:
        """Change of the load factor per displacement along the pattern.

        Infinite perpendicular to it.
        """
        along = self.of.dot(self.pattern, u)
        if abs(along) <= _ACROSS * self.of.maximum(u):
            return inf
        return self.unit / along

    def distance(self, moved: Array, change: float) -> float:
        """Displacement along the pattern, independent of the load."""
        return self.of.dot(self.pattern, moved) / self.unit

    def slope(self, moved: Array, change: float, u: Array, d: float) -> float:
        """Derivative of that displacement along ``u``."""
        return self.distance(u, d)


@dataclass(frozen=True)
class Load:
    """Change of the load factor.

    Attributes:
        load: Change of distance one.
    """

    load: float

    def rate(self, u: Array, sign: float) -> float:
        """Change of the load factor of distance one."""
        return sign * self.load

    def distance(self, moved: Array, change: float) -> float:
        """Change of the load factor, independent of displacements."""
        return abs(change) / self.load

    def slope(self, moved: Array, change: float, u: Array, d: float) -> float:
        """Derivative of that change along ``d``."""
        return float(np.copysign(d, change)) / self.load if change else d / self.load


@dataclass(frozen=True)
class DisplacementControl:
    """Steps of equal displacement of a point, up to a target.

    Attributes:
        point: The point.
        direction: Direction of the displacement, global components.
        to: Displacement in this direction at which the path ends; steps are fractions of it.
    """

    point: Point
    direction: npt.ArrayLike
    to: float

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if an argument has a wrong type."""
        require_point(self.point, "DisplacementControl: point")
        number(self.to, "DisplacementControl: to")

    def check(self) -> None:
        """Raise ``ValueError`` if the point is ground, or direction or displacement are zero."""
        if self.point.is_ground:
            raise ValueError("displacement control needs a point of a body, got ground")
        direction(self.direction, f"direction of control at {self.point.label}")
        positive(self.to, "displacement to go to under displacement control")

    def along(self, of: Equilibrium, count: int, node: int | None) -> Along:
        """Control of the node of the point.

        Args:
            of: The structure.
            count: Number of its nodes, of those that this rank owns.
            node: Index of the node of the point among them; ``None``: another rank owns it.
        """
        pattern = np.zeros((count, 3))
        if node is not None:
            pattern[node] = direction(self.direction, f"direction of control at {self.point.label}")
        return Along(pattern, self.to, of)


@dataclass(frozen=True)
class LoadControl:
    """Steps of equal load; they fail at limit points."""


Observer = Callable[[PathState], float]


@dataclass(frozen=True)
class PathEnds:
    """End conditions of a path; the first one that is met ends it.

    Attributes:
        factor: The load factor reaches this value; default: none.
        load_range: The load factor leaves this range.
        stop: This function of the state becomes positive.
        critical_points: This number of limit points and bifurcations is found; default: never.
        steps: Largest number of steps.
    """

    factor: float | None = None
    load_range: tuple[float, float] = (-inf, inf)
    stop: Observer | None = None
    critical_points: int | None = None
    steps: int = 300

    def __post_init__(self) -> None:
        """Check the conditions."""
        whole(self.steps, "PathEnds: steps")
        if self.factor is not None:
            number(self.factor, "PathEnds: factor")
        if self.critical_points is not None:
            whole(self.critical_points, "PathEnds: critical_points")
        if self.stop is not None:
            instance(self.stop, Callable, "PathEnds: stop", "a function of the state or None")
        low, high = self.load_range
        if not low < high:
            raise ValueError(f"load_range must be two increasing factors, got {self.load_range!r}")

    def check_start(self, start: Station | None) -> None:
        """Raise ``ValueError`` if the path would end where it begins.

        Args:
            start: State in which the path begins, or ``None``: unloaded.
        """
        factor = 0.0 if start is None else start.factor
        low, high = self.load_range
        if not low <= factor <= high:
            raise ValueError(
                f"the path leaves the range of load factors where it begins: {factor:g} is not in "
                f"{self.load_range}"
            )
        if self.factor == factor:
            raise ValueError(
                f"the load factor at which the path ends must be not where it begins, got "
                f"{self.factor!r}"
            )


@dataclass(frozen=True)
class PathOptions:
    """Options of the computation of a path.

    Attributes:
        locate: Relative tolerance of the load at limit points and bifurcations, or ``None`` to
            leave them between the states.
        linearised_stress: Iterate on the stress by linearised updates; otherwise plain Newton.
        arc_length: Tolerance and largest number of iterations.
        petsc_options_prefix: Prefix for the choice of the linear solver.
    """

    locate: float | None = 1e-6
    linearised_stress: bool = True
    arc_length: ArcLength = field(default_factory=ArcLength)
    petsc_options_prefix: str = "fem_lie_path_"

    def __post_init__(self) -> None:
        """Check the options."""
        flag(self.linearised_stress, "PathOptions: linearised_stress")
        instance(self.arc_length, ArcLength, "PathOptions: arc_length", "an ArcLength")
        text(self.petsc_options_prefix, "PathOptions: petsc_options_prefix")
        if self.locate is not None:
            number(self.locate, "PathOptions: locate")
            if not 0 < self.locate < 1:
                raise ValueError(
                    f"locate must be a relative tolerance between 0 and 1, got {self.locate!r}"
                )
