"""Equilibrium as a result: states under given loads, with tables, forces and pictures."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from fem_lie import lie
from fem_lie._arrays import Array, Flags
from fem_lie.bodies.body import Point
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.joints import Connection
from fem_lie.pictures.units import SI, Units
from fem_lie.results.reactions import Support, reaction
from fem_lie.scene.rotation import Rotation

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class StaticResult:
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
    """

    factors: Array
    frames: Array
    joint_forces: Array
    iterations: npt.NDArray[np.int64]
    failed_iterations: int
    info: SceneInfo
    initial: Array
    steady_rotation: Rotation
    seconds: float
    reactions: Array
    negative_pivots: npt.NDArray[np.int64] = field(
        default_factory=lambda: np.empty(0, dtype=np.int64), kw_only=True
    )
    factorisations: int = field(default=0, kw_only=True)
    turned_back: tuple[float, ...] = field(default=(), kw_only=True)

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

    def position(self, point: Point | str) -> Array:
        """Positions of a point at all steps, shape (k, 3)."""
        return self.frames[:, self.info.node(point), 0]

    def joint_force(self, joint: Connection | str) -> Array:
        """Force and moment of a joint on its point ``a``, in its axes there, shape (k, 6)."""
        return self.joint_forces[:, self.info.joint(joint)]

    def reaction(self, *supports: Support) -> Array:
        """Force and moment of a clamp or guide, or of several together, shape (k, 6).

        See :meth:`fem_lie.Result.reaction`.
        """
        return reaction(self, supports)

    def rotation(self, point: Point | str) -> Array:
        """Rotation matrices of a point at all steps, shape (k, 3, 3)."""
        return lie.rotation(self.frames[:, self.info.node(point)])

    def plot(
        self,
        *points: Point | str,
        path: str | os.PathLike[str] | None = None,
        units: Units = SI,
    ) -> Figure:
        """Displacements of points over the load factor; saved if there is a path."""
        from fem_lie.pictures.diagrams import displacements

        moved = [
            (
                point if isinstance(point, str) else point.label,
                self.position(point) - self.initial[self.info.node(point), 0],
            )
            for point in points
        ]
        return displacements(self.factors, moved, path, units=units)

    def picture(
        self,
        path: str | os.PathLike[str],
        at: Sequence[int | float] | None = None,
        *,
        trace: Sequence[Point | str] = (),
        frames: bool = False,
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
            title: Above the picture.
            units: For the axes.

        Raises:
            ValueError: There is no such state.
        """
        from fem_lie.pictures.bodies import draw

        states = np.concatenate([self.initial[np.newaxis], self.frames])
        paths = [states[:, self.info.node(point), 0] for point in trace]
        drawn = states[[0, *(1 + row for row in self._rows(at))]]
        draw(self.info, drawn, path, paths=paths, triads=frames, title=title, units=units)

    def _rows(self, at: Sequence[int | float] | None) -> list[int]:
        """Numbers of the states to be drawn."""
        count = len(self.factors)
        if at is None:
            even = np.linspace(0, count - 1, min(_DRAWN, count))
            return [int(row) for row in even.round()]
        rows = []
        for state in at:
            if isinstance(state, int | np.integer):
                if not -count <= state < count:
                    raise ValueError(f"there are {count} states, got the index {state}")
                rows.append(int(state) % count)
            elif np.isfinite(state):
                rows.append(int(np.abs(self.factors - state).argmin()))
            else:
                raise ValueError(f"a load factor must be finite, got {state}")
        return rows


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
