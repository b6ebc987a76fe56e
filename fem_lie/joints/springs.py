"""Springs, dampers, drives and gears: elements that act along relative coordinates of joints."""

from __future__ import annotations

from dataclasses import dataclass, field

from fem_lie import _arrays
from fem_lie.joints.connection import Connection, ConstraintDefinition, Coordinate, History
from fem_lie.joints.histories import PiecewiseLinear


@dataclass(frozen=True, eq=False)
class Spring(Connection):
    """Spring and damper along a coordinate ``q``: force or moment ``k (q − q₀) + c dq/dt``.

    Attributes:
        coordinate: Coordinate of a joint: ``joint.angle``, ``joint.displacement``,
            ``Distance(…).length``.
        stiffness: ``k``, moment per rad or force per length.
        damping: ``c``, moment per rad or force per length, times time.
        rest: ``q₀``; default: the initial value of the coordinate.
        name: Name in messages and results; default: from the coordinate.

    Example:
        >>> wheel = fl.RigidBody(2.0, (0.1, 0.1, 0.2), position=(1, 0, 0))
        >>> scene = fl.Scene()
        >>> _ = scene.add(wheel)
        >>> joint = scene.add(fl.joints.Prismatic(fl.ground(), wheel.point("centre"), axis=(1, 0,
        ...     0)))
        >>> _ = scene.add(fl.joints.Spring(joint.displacement, stiffness=1e3, damping=5.0))
        >>> len(scene.connections)
        1
    """

    coordinate: Coordinate
    stiffness: float = 0.0
    damping: float = 0.0
    rest: float | None = None
    name: str = ""

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if an argument has a wrong type."""
        Coordinate.require(self.coordinate, "Spring: coordinate")
        _arrays.text(self.name, "Spring: name")

    @property
    def label(self) -> str:
        """Name in messages and results."""
        return self.name or f"Spring({self.coordinate.label})"

    def check(self) -> None:
        """Raise ``ValueError`` if a value is negative or not finite, or both are zero."""
        given = {"stiffness": self.stiffness, "damping": self.damping}
        numbers = [_arrays.number(value, f"{self.label}: {k}") for k, value in given.items()]
        if min(numbers) < 0.0 or max(numbers) == 0.0:
            raise ValueError(
                f"{self.label}: stiffness and damping must be ≥ 0 and not both 0, got {numbers}"
            )
        if self.rest is not None:
            _arrays.number(self.rest, f"{self.label}: rest")

    def definitions(self) -> list[ConstraintDefinition]:
        """Definition of the coordinate as a term without constraint."""
        return [self.coordinate.as_row(-1)]

    @property
    def spring(self) -> tuple[float, float, float]:
        """Stiffness, damping and rest value."""
        rest = self.coordinate.start() if self.rest is None else self.rest
        return float(self.stiffness), float(self.damping), float(rest)

    @property
    def preloaded(self) -> bool:
        """Whether a rest value is given."""
        return self.rest is not None and float(self.stiffness) > 0.0

    def coordinates(self) -> tuple[Coordinate, ...]:
        """The coordinate along which the spring acts."""
        return (self.coordinate,)


@dataclass(frozen=True, eq=False)
class Drive(Connection):
    """Rheonomic constraint: a coordinate follows a prescribed function of time.

    Attributes:
        coordinate: Coordinate of a joint.
        function: Angle or displacement as a function of time (in statics: of the load factor),
            twice differentiable but for the times that :class:`~fem_lie.loads.PiecewiseSmooth` or a
            :class:`~fem_lie.loads.PiecewiseLinear` says; at the start the coordinate's initial
            value. Default: that value.
        name: Name in messages and results; default: from the coordinate.
        active: Whether its constraints act from the start; :class:`~fem_lie.schemes.Lock` and
            :class:`~fem_lie.schemes.Release` switch them.

    Example:
        >>> wheel = fl.RigidBody(2.0, (0.1, 0.1, 0.2), position=(1, 0, 0))
        >>> scene = fl.Scene()
        >>> _ = scene.add(wheel)
        >>> joint = scene.add(fl.joints.Revolute(fl.ground(), wheel.point("centre")))
        >>> motor = scene.add(fl.joints.Drive(joint.angle, lambda t: 2.0 * t))
        >>> len(scene.connections)
        1
    """

    coordinate: Coordinate
    function: History | None = None
    name: str = ""
    active: bool = field(default=True, kw_only=True)

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if an argument has a wrong type."""
        Coordinate.require(self.coordinate, "Drive: coordinate")
        _arrays.history(self.function, "Drive: function")
        _arrays.text(self.name, "Drive: name")
        _arrays.flag(self.active, "Drive: active")

    @property
    def label(self) -> str:
        """Name in messages and results."""
        return self.name or f"Drive({self.coordinate.label})"

    def check(self) -> None:
        """Raise ``ValueError`` if the function does not start at the value of the coordinate."""
        if isinstance(self.function, PiecewiseLinear) and self.function.jumps:
            raise ValueError(f"{self.label} jumps at the times {list(self.function.jumps)}")
        start = self.coordinate.start()
        given = start
        if self.function is not None:
            given = _arrays.number(self.function(0.0), f"{self.label} at the start")
        unit = 1.0 if self.coordinate.angular else self.coordinate.size
        if not abs(given - start) <= 1e-8 * max(unit, abs(start)):
            raise ValueError(f"{self.label} must start at {start:g}, got {given:g}")

    def definitions(self) -> list[ConstraintDefinition]:
        """Definition of the coordinate as a constraint."""
        return [self.coordinate.as_row(0)]

    @property
    def size(self) -> int:
        """Number of constraints: 1."""
        return 1

    @property
    def holds(self) -> bool:
        """Whether it keeps the present coordinate when it is activated: without a function."""
        return self.function is None

    @property
    def history(self) -> History | None:
        """Prescribed value as a function of time."""
        return self.function

    def coordinates(self) -> tuple[Coordinate, ...]:
        """The driven coordinate."""
        return (self.coordinate,)


@dataclass(frozen=True, eq=False)
class Gear(Connection):
    """Constraint that keeps ``first + ratio · second`` at its initial value.

    Two revolute joints: a pair of spur gears of radii r₁, r₂ in mesh on one carrier
    has the ratio r₂/r₁; a revolute and a prismatic joint: rack and pinion.

    Attributes:
        first: Coordinate of a joint.
        second: Coordinate of another joint.
        ratio: ``−d first / d second``.
        name: Name in messages and results; default: from the coordinates.
        active: Whether its constraints act from the start; :class:`~fem_lie.schemes.Lock` and
            :class:`~fem_lie.schemes.Release` switch them.

    Example:
        >>> scene = fl.Scene()
        >>> wheels = [fl.RigidBody(1.0, (1, 1, 2), position=(x, 0, 0)) for x in (0, 3)]
        >>> for wheel in wheels:
        ...     _ = scene.add(wheel)
        ...
        >>> first, second = (scene.add(fl.joints.Revolute(fl.ground(), w.point("centre"))) for w in
        ...     wheels)
        >>> _ = scene.add(fl.joints.Gear(first.angle, second.angle, ratio=2.0))
        >>> len(scene.connections)
        1
    """

    first: Coordinate
    second: Coordinate
    ratio: float
    name: str = ""
    active: bool = field(default=True, kw_only=True)

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if an argument has a wrong type."""
        Coordinate.require(self.first, "Gear: first")
        Coordinate.require(self.second, "Gear: second")
        _arrays.text(self.name, "Gear: name")
        _arrays.flag(self.active, "Gear: active")

    @property
    def label(self) -> str:
        """Name in messages and results."""
        return self.name or f"Gear({self.first.label}, {self.second.label})"

    def check(self) -> None:
        """Raise ``ValueError`` if the ratio is zero or infinite, or the coordinates are equal."""
        if _arrays.number(self.ratio, f"{self.label}: ratio") == 0.0:
            raise ValueError(f"{self.label}: ratio must be a number other than 0, got {self.ratio}")
        if self.first.same(self.second):
            raise ValueError(
                f"{self.label}: both are the same coordinate, which a gear would lock or leave "
                "free; give coordinates of two joints"
            )

    def definitions(self) -> list[ConstraintDefinition]:
        """Definitions of the two coordinates as terms of one constraint."""
        return [self.first.as_row(0), self.second.as_row(0, self.ratio)]

    @property
    def size(self) -> int:
        """Number of constraints: 1."""
        return 1

    @property
    def holds(self) -> bool:
        """True: it keeps the present sum when it is activated."""
        return True

    def coordinates(self) -> tuple[Coordinate, ...]:
        """The two coordinates."""
        return self.first, self.second
