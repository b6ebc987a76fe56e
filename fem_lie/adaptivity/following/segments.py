"""A motion whose mesh has changed now and then: a result for each mesh, chained."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.adaptivity.following.transfer import Transferred
from fem_lie.adaptivity.refinement import Followed
from fem_lie.results.history import Result
from fem_lie.scene import Scene


@dataclass(frozen=True, eq=False)
class MotionSegment(Generic[Followed]):
    """A part of a motion on one mesh.

    Attributes:
        begin: When it begins; times of its result count from there.
        mesh: Of the body that is refined.
        scene: On it.
        result: Of this part.
        error: Largest estimated error in space, over the largest norm of the stress so far.
        change: What the change to this mesh has done; ``None`` for the first.
    """

    begin: float
    mesh: Followed
    scene: Scene
    result: Result
    error: float
    change: Transferred | None


@dataclass(frozen=True, eq=False)
class AdaptedMotion(Generic[Followed]):
    """What :func:`~fem_lie.adaptivity.adapt_motion` has found.

    Arrays over all times have two rows where the mesh changes: before and after.

    Attributes:
        segments: One for each mesh.
        tolerance: What was asked for.
        space: Its part for the stress, of the largest norm of the stress so far.
        time: Its part for places, of the size of the motion.
        element_steps: Elements times steps, those made in vain included.
    """

    segments: tuple[MotionSegment[Followed], ...]
    tolerance: float
    space: float
    time: float
    element_steps: int

    @property
    def times(self) -> Array:
        """Of all kept states, shape (T,)."""
        return np.concatenate([part.begin + part.result.times for part in self.segments])

    @property
    def cells(self) -> Indices:
        """Elements of each mesh, shape (k,)."""
        return np.array([len(part.mesh.cells) for part in self.segments], dtype=np.int64)

    @property
    def steps(self) -> Indices:
        """Steps on each mesh, shape (k,)."""
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
        """Potential of gravity and of forces without a history, shape (T,)."""
        return np.concatenate([part.result.potential for part in self.segments])

    @property
    def momentum(self) -> Array:
        """Linear momentum, shape (T, 3)."""
        return np.concatenate([part.result.momentum for part in self.segments])

    @property
    def angular_momentum(self) -> Array:
        """About the origin, shape (T, 3)."""
        return np.concatenate([part.result.angular_momentum for part in self.segments])

    def position(self, point: str) -> Array:
        """Positions of a named point such as "beam.end", shape (T, 3).

        Args:
            point: Name of a point with that of its body, such as "beam.end".

        Raises:
            ValueError: There is no such point.
        """
        return np.concatenate([part.result.position(point) for part in self.segments])

    @property
    def momentum_error(self) -> float:
        """Largest relative change of momenta where the mesh changed."""
        changes = [part.change.momentum_error for part in self.segments if part.change]
        return max(changes, default=0.0)

    @property
    def energy_change(self) -> float:
        """Sum of what changes of the mesh have done to the energy."""
        return sum(part.change.energy_change for part in self.segments if part.change)

    def __str__(self) -> str:
        """What was allowed, and what it took."""
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
    """Steps that were made, also those that were not accepted."""
    if result.steps is None:
        return int(len(result.times) - 1)
    return len(result.steps.sizes) + len(result.steps.rejected)
