"""Equilibrium paths as results: states, stability, critical points, pictures."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, ClassVar, NamedTuple, Protocol

import numpy as np

from fem_lie._arrays import Array, Flags, Indices, number
from fem_lie._summary import Summarised
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.pictures.path_diagram import PathCurve, plot_paths
from fem_lie.pictures.stage import SI, Units
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.files.tables import Columns
from fem_lie.results.mode_shapes import ModeLook, ModeShapes, moved_along
from fem_lie.results.states import Displaced

if TYPE_CHECKING:
    from matplotlib.figure import Figure


_BESIDE = (0.0, 0.5, 1.0)  # in pictures of a mode: fractions of the amplitude


class CriticalPointType(Enum):
    """Types of critical points.

    At a ``LIMIT`` point the load has an extremum along the path. At a ``BIFURCATION`` other paths
    cross, and the load does not have an extremum in general.
    """

    LIMIT = "limit point"
    BIFURCATION = "bifurcation"


@dataclass(frozen=True, eq=False, repr=False)
class PathState(Summarised, Displaced):
    """One state of a path, for functions that observe or stop a path.

    Attributes:
        factor: Load factor.
        frames: Frames of all nodes, shape (n, 4, 3).
        negative_pivots: Number of negative eigenvalues of the tangent stiffness.
        info: Bodies and joints.
    """

    factor: float
    frames: Array
    negative_pivots: int
    info: SceneInfo


@dataclass(frozen=True, eq=False, repr=False)
class CriticalPoint(Summarised, Displaced, ModeShapes):
    """A point of a path at which the tangent stiffness is singular.

    Attributes:
        kind: Limit point or bifurcation.
        factor: Load factor: the extremum, or the midpoint of the bracket.
        bracket: Load factors of the states between which the point was located.
        negative_pivots: Number of negative eigenvalues of the tangent stiffness before and after; 0
            and 1 for an even and an odd number if the loads have no potential.
        has_potential: Whether the loads have a potential. If not, as for moments about fixed axes,
            the determinant of the tangent stiffness changes its sign at the point; flutter is not
            detected.
        eigenvalues: Smallest eigenvalues of the tangent stiffness, in units of energy; empty if
            SLEPc did not converge.
        shapes: Their modes: local increments of all nodes, shape (k, n, 6). The largest
            displacement is 1, or the largest rotation of a mode with rotations only.
        rotation_only: Whether each mode has no displacement beyond round-off, shape (k,).
        station: The last state of the path before the point.
        index: Index of that state among the states of the path.
        frames: Frames of all nodes in the numbering of the system, shape (n, 4, 3); for those of a
            point see :meth:`position`, :meth:`displacement` and :meth:`rotation`.
        info: Bodies and joints.
    """

    kind: CriticalPointType
    factor: float
    bracket: tuple[float, float]
    negative_pivots: tuple[int, int]
    has_potential: bool
    eigenvalues: Array
    shapes: Array
    rotation_only: Flags
    station: Station
    index: int
    frames: Array
    info: SceneInfo

    @property
    def crossed(self) -> bool:
        """Whether the path itself is a branch that passes through the bifurcation.

        The load then has an extremum there, but the number of negative pivots is the same on both
        sides.
        """
        before, after = self.negative_pivots
        return self.kind is CriticalPointType.BIFURCATION and before == after

    def moved(self, mode: int, amplitude: float) -> Array:
        """Frames along a mode from the critical state, shape (n, 4, 3).

        Args:
            mode: Counted from 1.
            amplitude: Largest displacement.

        Raises:
            ValueError: There is no such mode, or it has rotations only.
        """
        along = np.array([number(amplitude, "amplitude")])
        return moved_along(self.displacing_shape(mode), self.frames, along)[0]

    def _look(self, mode: int) -> ModeLook:
        size = float(np.linalg.norm(np.ptp(self.frames[:, 0], axis=0)))
        return ModeLook(f"{self.kind.value} at load factor {self.factor:.6g}", size, _BESIDE)

    def __str__(self) -> str:
        """One line: type, load factor, stability."""
        before, after = self.negative_pivots
        return (
            f"{self.kind.value} at load factor {self.factor:.8g} "
            f"(negative pivots {before} before, {after} after"
            f"{'' if self.has_potential else '; loads without potential, by the determinant'})"
        )


class Metric(Protocol):
    """Norm of an increment along a path."""

    def norm(self, u: Array, d: float, /) -> float:
        """Norm of displacements (n, 3) and a change of the load factor."""


class EquilibriumState(NamedTuple):
    """State of a scene in equilibrium, as a path stores it.

    Attributes:
        frames: Frames of all nodes, shape (n, 4, 3).
        multipliers: Lagrange multipliers of the constraints.
        saved: Variables that depend on the path, by name, such as stresses of mixed elements.
    """

    frames: Array
    multipliers: Array
    saved: dict[str, Array]


@dataclass(frozen=True, eq=False, repr=False)
class Station(Summarised):
    """An equilibrium state on a path, with all that the next step needs.

    Attributes:
        factor: Load factor.
        state: State of the model: frames, Lagrange multipliers, stresses of mixed elements.
        positions: Positions of the nodes, shape (n, 3).
        velocity: Derivative of displacements in the load factor, shape (n, 3).
        response: ``K⁻¹f``.
        sign: Direction of the load factor along the path, ±1.
        negative: Number of negative eigenvalues of the tangent stiffness.
        iterations: Number of linear solutions of the step to this state.
        test: Smallest eigenvalue of the tangent stiffness if requested, or nan.
    """

    factor: float
    state: EquilibriumState
    positions: Array
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


PATH_RECORDS = (CriticalPointType, CriticalPoint, Station, EquilibriumState)
"""Records in a path, besides those of the scene."""


@dataclass(frozen=True, repr=False)
class EquilibriumPath(StaticResult):
    """Equilibrium states along a path, with critical points.

    ``factors``, ``frames`` and ``iterations`` are those of the states; the first state is the start
    of the path.

    Attributes:
        negative_pivots: Number of negative eigenvalues of the tangent stiffness at each state,
            shape (k,); a state with none is stable.
        critical: Limit points and bifurcations, in order.
        observed: Observed quantities by name, each of shape (k,).
        complete: Whether the path reached the requested end.
        reason: Why the path ended.
        locating_iterations: Number of linear solutions to locate critical points.
        stations: The states as starting points of other paths:
            ``follow_path(scene, start=path.stations[3])``.
    """

    negative_pivots: Indices
    critical: tuple[CriticalPoint, ...]
    observed: Mapping[str, Array]
    complete: bool
    reason: str
    locating_iterations: int
    stations: tuple[Station, ...]

    _PARTS: ClassVar[tuple[type, ...]] = (*StaticResult._PARTS, *PATH_RECORDS)

    def _quantities(self) -> Columns:
        """Observed quantities, stability and forces."""
        return dict(self.observed) | super()._quantities()

    def __len__(self) -> int:
        """Number of states."""
        return len(self.factors)

    @property
    def limits(self) -> tuple[CriticalPoint, ...]:
        """The limit points."""
        return tuple(c for c in self.critical if c.kind is CriticalPointType.LIMIT)

    @property
    def bifurcations(self) -> tuple[CriticalPoint, ...]:
        """The bifurcations."""
        return tuple(c for c in self.critical if c.kind is CriticalPointType.BIFURCATION)

    @property
    def total_iterations(self) -> int:
        """Number of linear solutions, including rejected steps and those that located points."""
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
        """Plot the load over a quantity; stable parts are solid, unstable parts dashed.

        Args:
            values: Values at all states, shape (k,), or the name of an observed quantity.
            path: Name of the file if the plot is to be saved.
            label: Label of the values.
            load: Load at factor 1, and its label.
            others: Further paths with their values, such as branches.
            reference: Values, loads and label of reference points.
            shape: Whether to draw the last state next to the curve.
            units: Units of the axes.

        Raises:
            ValueError: No quantity of this name was observed, or the values have a wrong shape.
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
