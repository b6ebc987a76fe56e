"""A motion whose mesh changes at some times: a chain of results, one for each mesh."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._summary import Summarised
from fem_lie.adaptivity.following.transfer import Transferred
from fem_lie.adaptivity.refinement import Refinable
from fem_lie.results.history import Result
from fem_lie.scene import Scene


@dataclass(frozen=True, eq=False, repr=False)
class MotionSegment(Summarised, Generic[Refinable]):
    """A time segment of a motion on one mesh.

    Attributes:
        begin: Start of the segment; times of its result are relative to it.
        mesh: Mesh of the refined body.
        scene: Scene on this mesh.
        result: Result of the segment.
        error: Largest estimated error in space, relative to the largest norm of the stress so far.
        change: Energies and momenta before and after the change to this mesh; ``None`` for the
            first.
    """

    begin: float
    mesh: Refinable
    scene: Scene
    result: Result
    error: float
    change: Transferred | None


@dataclass(frozen=True, eq=False, repr=False)
class AdaptedMotion(Summarised, Generic[Refinable]):
    """Result of :func:`~fem_lie.adaptivity.adapt_motion`.

    Arrays over all times have two rows where the mesh changes: before and after.

    Attributes:
        segments: One for each mesh.
        tolerance: Requested tolerance.
        space: Its part for the stress, relative to the largest norm of the stress so far.
        time: Its part for positions, relative to the size of the motion.
        element_steps: Number of elements times number of steps, including repeated segments.
    """

    segments: tuple[MotionSegment[Refinable], ...]
    tolerance: float
    space: float
    time: float
    element_steps: int

    @property
    def times(self) -> Array:
        """Times of all recorded states, shape (T,)."""
        return np.concatenate([part.begin + part.result.times for part in self.segments])

    @property
    def cells(self) -> Indices:
        """Number of elements of each mesh, shape (k,)."""
        return np.array([len(part.mesh.cells) for part in self.segments], dtype=np.int64)

    @property
    def steps(self) -> Indices:
        """Number of steps on each mesh, shape (k,)."""
        return np.array([steps_of(part.result) for part in self.segments], dtype=np.int64)

    @property
    def kinetic(self) -> Array:
        """Kinetic energy, shape (T,)."""
        return np.concatenate([part.result.kinetic for part in self.segments])

    @property
    def elastic(self) -> Array:
        """Elastic energy, shape (T,)."""
        return np.concatenate([part.result.elastic for part in self.segments])

    @property
    def potential(self) -> Array:
        """Potential energy of gravity and of constant loads, shape (T,)."""
        return np.concatenate([part.result.potential for part in self.segments])

    @property
    def momentum(self) -> Array:
        """Linear momentum, shape (T, 3)."""
        return np.concatenate([part.result.momentum for part in self.segments])

    @property
    def angular_momentum(self) -> Array:
        """Angular momentum about the origin, shape (T, 3)."""
        return np.concatenate([part.result.angular_momentum for part in self.segments])

    def position(self, point: str) -> Array:
        """Positions of a named point such as "beam.end", global components, shape (T, 3).

        Args:
            point: Name of a point with that of its body, such as "beam.end".

        Raises:
            ValueError: There is no such point.
        """
        return np.concatenate([part.result.position(point) for part in self.segments])

    def displacement(self, point: str) -> Array:
        """Displacements of a named point from the undeformed configuration, shape (T, 3).

        Args:
            point: As for :meth:`position`.

        Raises:
            ValueError: There is no such point.
        """
        return np.concatenate([part.result.displacement(point) for part in self.segments])

    @property
    def iterations(self) -> Indices:
        """Number of linear solutions on all meshes kept, up to each time, shape (T,)."""
        ends = np.cumsum([0, *(part.result.total_iterations for part in self.segments)])
        parts = zip(ends, self.segments, strict=False)
        return np.concatenate([before + part.result.iterations for before, part in parts])

    @property
    def momentum_error(self) -> float:
        """Largest relative change of momenta where the mesh changed."""
        changes = [part.change.momentum_error for part in self.segments if part.change]
        return max(changes, default=0.0)

    @property
    def energy_change(self) -> float:
        """Sum of the energy changes where the mesh changed."""
        return sum(part.change.energy_change for part in self.segments if part.change)

    def __str__(self) -> str:
        """Allowed errors, meshes and costs."""
        worst = max(part.error for part in self.segments)
        return (
            f"tolerance {100 * self.tolerance:.3g} %: {100 * self.space:.3g} % in space, "
            f"{100 * self.time:.3g} % in time\n"
            f"{len(self.segments)} meshes of {self.cells.min()} to {self.cells.max()} elements, "
            f"{self.steps.sum()} steps, {self.element_steps} element steps; error in space up to "
            f"{100 * worst:.2g} %\nmomenta kept to {self.momentum_error:.1g}, energy changed by "
            f"{self.energy_change:.2g}"
        )


def steps_of(result: Result) -> int:
    """Number of steps, including rejected ones."""
    if result.steps is None:
        return int(len(result.times) - 1)
    return len(result.steps.sizes) + len(result.steps.rejected)
