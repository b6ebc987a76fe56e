"""A path of equilibrium as a result: states, stability, critical points, pictures."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from fem_lie._arrays import Array, Flags, Indices, number
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.pictures.path_diagram import PathCurve, plot_paths
from fem_lie.pictures.stage import SI, Units
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.mode_shapes import ModeLook, ModeShapes, moved_along
from fem_lie.results.states import Displaced

if TYPE_CHECKING:
    from matplotlib.figure import Figure


_BESIDE = (0.0, 0.5, 1.0)  # in pictures of a mode: the critical state, and parts of the amplitude


class Critical(Enum):
    """Kinds of critical points.

    At a ``LIMIT`` point the load has an extremum along the path; at a ``BIFURCATION`` it goes on,
    and other paths cross.
    """

    LIMIT = "limit point"
    BIFURCATION = "bifurcation"


@dataclass(frozen=True, eq=False)
class PathState(Displaced):
    """One state, for functions that observe a path or stop it.

    Attributes:
        factor: Load factor.
        frames: Of all nodes, shape (n, 4, 3).
        initial: The same, unloaded.
        negative_pivots: Negative eigenvalues of the tangent.
        info: Bodies and joints.
    """

    factor: float
    frames: Array
    initial: Array
    negative_pivots: int
    info: SceneInfo


@dataclass(frozen=True, eq=False)
class CriticalPoint(Displaced, ModeShapes):
    """A point of a path where the tangent is singular.

    Attributes:
        kind: Limit point or bifurcation.
        factor: Load factor: the extremum, or the middle of the bracket.
        bracket: Load factors of the states between which it was located.
        negative_pivots: Negative eigenvalues of the tangent before and after; 0 and 1 for an even
            and an odd number if the loads have no potential.
        has_potential: Whether the loads have one. If not, as with moments about fixed axes, the
            determinant of the tangent changes its sign there; flutter is not looked for.
        eigenvalues: Smallest eigenvalues of the tangent there, in units of energy; none if SLEPc
            found none.
        shapes: Their modes: local increments of all nodes, the largest displacement is 1, or the
            largest rotation of a mode that only turns, shape (k, n, 6).
        turns_only: Which of them have no displacement beyond round-off, shape (k,).
        station: The state before it.
        index: Its number among the states of the path.
        frames: Frames of all nodes in the numbering of the system, shape (n, 4, 3); for those of a
            point see :meth:`position`, :meth:`displacement` and :meth:`rotation`.
        initial: The same, unloaded.
        info: Bodies and joints.
    """

    kind: Critical
    factor: float
    bracket: tuple[float, float]
    negative_pivots: tuple[int, int]
    has_potential: bool
    eigenvalues: Array
    shapes: Array
    turns_only: Flags
    station: Station
    index: int
    frames: Array
    initial: Array
    info: SceneInfo

    @property
    def crossed(self) -> bool:
        """Whether it is a bifurcation that the path has passed from one side branch to the other.

        Then the load turns there, but the number of negative pivots is the same on both sides.
        """
        before, after = self.negative_pivots
        return self.kind is Critical.BIFURCATION and before == after

    def moved(self, mode: int, amplitude: float) -> Array:
        """Frames beside the critical state, along a mode, shape (n, 4, 3).

        Args:
            mode: Counted from 1.
            amplitude: Largest displacement.

        Raises:
            ValueError: There is no such mode, or it only turns.
        """
        along = np.array([number(amplitude, "amplitude")])
        return moved_along(self.displacing_shape(mode), self.frames, along)[0]

    def _look(self, mode: int) -> ModeLook:
        size = float(np.linalg.norm(np.ptp(self.frames[:, 0], axis=0)))
        return ModeLook(f"{self.kind.value} at load factor {self.factor:.6g}", size, _BESIDE)

    def __str__(self) -> str:
        """One line."""
        before, after = self.negative_pivots
        return (
            f"{self.kind.value} at load factor {self.factor:.8g} "
            f"(negative pivots {before} before, {after} after"
            f"{'' if self.has_potential else '; loads without potential, by the determinant'})"
        )


@dataclass(frozen=True)
class EquilibriumPath(StaticResult):
    """States of equilibrium along a path, critical points among them.

    ``factors``, ``frames`` and ``iterations`` are those of the states, the first being where the
    path began.

    Attributes:
        negative_pivots: Negative eigenvalues of the tangent at each state, shape (k,); a state with
            none is stable.
        critical: Limit points and bifurcations, in their order.
        observed: The quantities that were observed, each of shape (k,).
        complete: Whether the path came to its wanted end.
        reason: Why it ended.
        failed_steps: Number of steps that were given up, or repeated shorter.
        locating_iterations: Linear solutions that went into locating points.
        stations: The states, to begin with again: ``follow_path(scene, start=path.stations[3])``.
    """

    negative_pivots: Indices
    critical: tuple[CriticalPoint, ...]
    observed: Mapping[str, Array]
    complete: bool
    reason: str
    failed_steps: int
    locating_iterations: int
    stations: tuple[Station, ...]

    def __len__(self) -> int:
        """Number of states."""
        return len(self.factors)

    @property
    def limits(self) -> tuple[CriticalPoint, ...]:
        """The limit points."""
        return tuple(c for c in self.critical if c.kind is Critical.LIMIT)

    @property
    def bifurcations(self) -> tuple[CriticalPoint, ...]:
        """The bifurcations."""
        return tuple(c for c in self.critical if c.kind is Critical.BIFURCATION)

    @property
    def total_iterations(self) -> int:
        """Linear solutions in all."""
        return super().total_iterations + self.locating_iterations

    def plot_path(
        self,
        values: Array | str,
        path: str | os.PathLike[str] | None = None,
        *,
        label: str = "",
        load: tuple[float, str] = (1.0, "load factor"),
        others: Sequence[tuple[EquilibriumPath, Array]] = (),
        reference: tuple[Array, Array, str] | None = None,
        shape: bool = True,
        units: Units = SI,
    ) -> Figure:
        """Load over a quantity, stable states drawn through and unstable ones dashed.

        Args:
            values: Of all states, shape (k,), or the name of an observed quantity.
            path: Name of the file if it is to be saved.
            label: What the values are.
            load: Load at factor 1, and what it is.
            others: Further paths with their values, such as branches.
            reference: Values, loads and name of points to be drawn with it.
            shape: Draw the last state beside the curve.
            units: For the axes.

        Raises:
            ValueError: Nothing was observed under this name, or the values are not of all states.
        """
        own = self._values(values)
        name = label or (values if isinstance(values, str) else "")
        paths = [self._curve(own), *(other._curve(other._values(v)) for other, v in others)]
        rows = sorted({0, *(point.index for point in self.critical), len(self) - 1})
        return plot_paths(
            paths,
            path,
            (name, load[1]),
            load[0],
            reference=reference,
            states=(self.info, self.frames[rows]) if shape else None,
            units=units,
        )

    def _curve(self, values: Array) -> PathCurve:
        """The path in a diagram of ``values`` (k,)."""
        critical = [(point.index, point.factor, point.kind.value) for point in self.critical]
        return PathCurve(values, self.factors, self.negative_pivots, critical)

    def _values(self, values: Array | str) -> Array:
        if isinstance(values, str):
            if values not in self.observed:
                known = ", ".join(self.observed) or "nothing"
                raise ValueError(f"{values!r} was not observed along the path, but {known}")
            return self.observed[values]
        given = np.asarray(values, dtype=np.float64)
        if given.shape != self.factors.shape:
            raise ValueError(f"values must have shape {self.factors.shape}, got {given.shape}")
        return given


class Metric(Protocol):
    """How long a way along a path is."""

    def norm(self, u: Array, d: float, /) -> float:
        """Of displacements (n, 3) and a change of the load factor."""


@dataclass(frozen=True, eq=False)
class Station:
    """A polished state on a path, with what the next step needs.

    Attributes:
        factor: Load factor.
        state: Of the model: frames, multipliers, carried stress.
        places: Positions of the nodes, shape (n, 3).
        velocity: Displacements per change of the load factor, shape (n, 3).
        response: ``K⁻¹f``.
        sign: Direction of the load factor along the path, ±1.
        negative: Negative eigenvalues of the tangent.
        iterations: Linear solutions of the step that led here.
        test: Smallest eigenvalue of the tangent if asked for, or nan.
    """

    factor: float
    state: Any
    places: Array
    velocity: Array
    response: Array
    sign: float
    negative: int
    iterations: int
    test: float = np.nan

    def direction(self, metric: Metric) -> tuple[Array, float]:
        """Unit tangent of the path: displacements and load factor."""
        scale = self.sign / metric.norm(self.velocity, 1.0)
        return scale * self.velocity, scale
