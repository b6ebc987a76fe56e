"""Equilibrium as a result: states under given loads, with tables, forces and pictures."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.bodies.body import Point
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.pictures import bodies, diagrams
from fem_lie.pictures.bodies import Arrows
from fem_lie.pictures.page.page import Diagram, along_a_load
from fem_lie.pictures.stage import SI, Canvas, Units
from fem_lie.ranks.shared_factors import Subdomains
from fem_lie.results.states import Displaced, StateSeries, evenly, label_of, nearest
from fem_lie.scene.rotation import Rotation

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class StaticResult(StateSeries, Displaced):
    """Equilibrium states.

    Attributes:
        factors: Load factors of the accepted steps, shape (k,), the last is 1.
        frames: Frames at them, shape (k, nodes, 4, 3).
        joint_forces: Force and moment of each joint on its point ``a``, at the joint and in the
            axes that it has on that side, shape (k, j, 6).
        iterations: Linear solves of each accepted step, shape (k,).
        failed_iterations: Linear solves of steps that were given up.
        info: Bodies and joints.
        initial: Frames of the unloaded configuration, shape (nodes, 4, 3).
        steady_rotation: Of the frame in which this is an equilibrium, at load factor 1.
        seconds: Wall time from the first assembly to the last solution, without set-up.
        reactions: Force and moment of each support on its node, about it, global components, see
            :meth:`reaction`, shape (k, s, 6).
        negative_pivots: Negative eigenvalues of the tangent at each state on what constraints leave
            free, shape (k,): with none it is stable. Under loads without potential it is 1 if their
            number is odd, else 0; −1 where the matrix could not be factorised.
        factorisations: Of the matrix, in all.
        turned_back: Load factors at which the load had a maximum on the way, roughly.
        subdomains: What the solution on these took, if there are any.
    """

    factors: Array
    frames: Array
    joint_forces: Array
    iterations: Indices
    failed_iterations: int
    info: SceneInfo
    initial: Array
    steady_rotation: Rotation
    seconds: float
    reactions: Array
    negative_pivots: Indices = field(
        default_factory=lambda: np.empty(0, dtype=np.int64), kw_only=True
    )
    factorisations: int = field(default=0, kw_only=True)
    turned_back: tuple[float, ...] = field(default=(), kw_only=True)
    subdomains: Subdomains | None = field(default=None, kw_only=True)

    @property
    def stable(self) -> Flags:
        """Which states are stable, shape (k,); under loads without potential: as far as is known.

        See ``negative_pivots``.
        """
        return np.asarray(self.negative_pivots == 0)

    @property
    def total_iterations(self) -> int:
        """Linear solutions in all."""
        return int(self.iterations.sum()) + self.failed_iterations

    def plot(
        self,
        *points: Point | str | int,
        path: str | os.PathLike[str] | None = None,
        units: Units = SI,
    ) -> Figure:
        """Displacements of points over the load factor; saved if there is a path."""
        moved = [(label_of(point), self.displacement(point)) for point in points]
        return diagrams.displacements(self.factors, moved, path, units=units)

    def picture(
        self,
        path: str | os.PathLike[str],
        at: Sequence[int | float] | None = None,
        *,
        trace: Sequence[Point | str | int] = (),
        frames: bool = False,
        arrows: Arrows | None = None,
        title: str = "",
        units: Units = SI,
    ) -> None:
        """Draw the unloaded bodies and equilibrium states, the later the darker.

        Args:
            path: Name of the ``.png`` file.
            at: Which states: whole numbers are indices, others load factors, of which the nearest
                is taken; default: all if they are seven at most, or so many of them, evenly.
            trace: Points whose paths through all states are drawn, too.
            frames: Draw the nodal frames of the last state.
            arrows: Forces at the last state, such as :meth:`~fem_lie.ContactForces.arrows` has.
            title: Above the picture.
            units: For the axes.

        Raises:
            ValueError: There is no such state.
        """
        rows = self._instants(_DRAWN) if at is None else [self._row(state) for state in at]
        drawn = np.concatenate([self.initial[np.newaxis], self.frames[rows]])
        paths = self._traces(trace)
        canvas = Canvas(title, units)
        bodies.draw(
            self.info, drawn, path, paths=paths, triads=frames, arrows=arrows, canvas=canvas
        )

    def _row(self, state: int | float) -> int:
        """Number of a state that is asked for by its index or by a load factor."""
        count = len(self.factors)
        if isinstance(state, int | np.integer):
            if not -count <= state < count:
                raise ValueError(f"there are {count} states, got the index {state}")
            return int(state) % count
        return nearest(self.factors, state, "a load factor")

    def _along(self, units: Units) -> tuple[Array, str, str]:
        """Load factors."""
        return self.factors, "load factor", ""

    def _diagrams(
        self, rows: Indices, trace: Sequence[Point | str | int], units: Units
    ) -> Sequence[Diagram]:
        """The path of the first of the points."""
        if not trace:
            return ()
        moved = np.linalg.norm(self.displacement(trace[0]), axis=-1)
        return (along_a_load(moved, self.factors, label_of(trace[0]), rows, units.length),)

    def _instants(self, images: int) -> Indices:
        """Numbers of so many states at most, evenly."""
        return evenly(len(self.factors), images)

    def _traces(self, points: Sequence[Point | str | int]) -> list[Array]:
        """Paths of points through all states, from the unloaded one on."""
        starts = [self.info.frame(point, self.initial)[np.newaxis, 0] for point in points]
        return [np.vstack(parts) for parts in zip(starts, super()._traces(points), strict=True)]


@dataclass(frozen=True)
class PathResult(StaticResult):
    """Equilibrium states at the wanted loads.

    ``factors`` are the wanted load factors, ``iterations`` all linear solutions on the way to each
    of them, without those of failed steps.

    Attributes:
        load_steps: Number of accepted steps, those between the wanted loads included.
        failed_steps: Number of steps that were given up.
        seconds: Wall time from the first assembly to the last solution.
    """

    load_steps: int
    failed_steps: int
    seconds: float


_DRAWN = 7  # states in a picture, beside the unloaded one
