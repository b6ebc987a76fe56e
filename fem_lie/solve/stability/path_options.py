"""Where a path is to end, and how it is computed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import inf

from fem_lie._arrays import flag, instance, number, text, whole
from fem_lie.results.path import PathState, Station
from fem_lie.solve.statics.arc_length import ArcLength

Observer = Callable[[PathState], float]


@dataclass(frozen=True)
class PathEnds:
    """Where a path ends: wherever one of these comes first.

    Attributes:
        factor: When it gets to this load factor; default: none.
        load_range: Where it leaves these load factors.
        stop: Function of the state; where it becomes positive.
        critical_points: When so many limit points and bifurcations are found; default: never.
        steps: At most so many.
    """

    factor: float | None = None
    load_range: tuple[float, float] = (-inf, inf)
    stop: Observer | None = None
    critical_points: int | None = None
    steps: int = 300

    def __post_init__(self) -> None:
        """Raise ``ValueError`` or ``TypeError`` for what is no end."""
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
        """Raise ``ValueError`` if the path would end where it begins."""
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
    """How a path is computed.

    Attributes:
        locate: Relative tolerance of the load at limit points and bifurcations, or ``None`` to
            leave them between the states.
        carried_stress: Carry the stress as an iterate; otherwise plain Newton.
        arc_length: Tolerance and largest number of iterations.
        petsc_options_prefix: Prefix for the choice of the linear solver.
    """

    locate: float | None = 1e-6
    carried_stress: bool = True
    arc_length: ArcLength = field(default_factory=ArcLength)
    petsc_options_prefix: str = "fem_lie_path_"

    def __post_init__(self) -> None:
        """Raise ``ValueError`` or ``TypeError`` for what is no option."""
        flag(self.carried_stress, "PathOptions: carried_stress")
        instance(self.arc_length, ArcLength, "PathOptions: arc_length", "an ArcLength")
        text(self.petsc_options_prefix, "PathOptions: petsc_options_prefix")
        if self.locate is not None:
            number(self.locate, "PathOptions: locate")
            if not 0 < self.locate < 1:
                raise ValueError(
                    f"locate must be a relative tolerance between 0 and 1, got {self.locate!r}"
                )
