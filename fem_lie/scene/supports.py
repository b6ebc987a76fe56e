"""Supports: clamps and prescribed motions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fem_lie._arrays import Array, instance, numbers
from fem_lie.bodies.body import Point
from fem_lie.bodies.points import require_node, require_point

_ORTHONORMAL = 1e-8  # single precision does not meet it


@dataclass(frozen=True, eq=False)
class Clamp:
    """A support that holds the position and the rotation of a point.

    Attributes:
        point: The point of a body.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> tube = fl.Section.circle(0.01, steel)
        >>> beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), tube, cells=4)
        >>> scene = fl.Scene()
        >>> _ = scene.add(beam)
        >>> _ = scene.add(fl.Clamp(beam.point("start")))
        >>> len(scene.clamps)
        1
    """

    point: Point

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if ``point`` is not a point."""
        require_point(self.point, "Clamp: point")

    def check(self) -> None:
        """Raise ``ValueError`` if the point is ground."""
        if self.point.is_ground:
            raise ValueError("a clamp needs a point of a body, got ground")
        body = self.point.body
        if body is not None and body.model.has_paired_nodes:
            raise ValueError(
                f"a clamp holds one node, and a point of {body.label} is several: hold it by "
                f"{type(body).__name__}.clamp"
            )
        require_node(self.point, "a clamp")
        if body is not None:
            body.model.require_direction(self.point.node)


@dataclass(frozen=True, eq=False)
class PrescribedMotion:
    """The frame of a point follows a prescribed function of time.

    Attributes:
        point: The point of a body.
        motion: Frame ``H(t)``, shape (4, 3) as in :mod:`fem_lie.lie`, twice differentiable; at the
            start it must be the point's initial frame. If its velocity or acceleration jumps,
            declare the times by :class:`~fem_lie.loads.PiecewiseSmooth`.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> tube = fl.Section.circle(0.01, steel)
        >>> beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), tube, cells=4)
        >>> def lifted(t):
        ...     return np.array([(0, 0, 0.1 * t), (1, 0, 0), (0, 1, 0), (0, 0, 1)])
        ...
        >>> scene = fl.Scene()
        >>> _ = scene.add(beam)
        >>> _ = scene.add(fl.PrescribedMotion(beam.point("start"), lifted))
        >>> len(scene.motions)
        1
    """

    point: Point
    motion: Callable[[float], Array]

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if ``point`` is not a point or ``motion`` is not a function."""
        require_point(self.point, "PrescribedMotion: point")
        instance(self.motion, Callable, "PrescribedMotion: motion", "a function of time")

    def check(self) -> None:
        """Raise ``ValueError`` if the motion does not start at the frame of the point."""
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
        """Prescribed frame at ``time``, shape (4, 3).

        Args:
            time: Time.

        Raises:
            ValueError: The value is not a finite position and right-handed orthonormal axes.
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
                f"the motion of {self.point.label} must be a position and right-handed orthonormal "
                f"axes; at time {time:g} it is\n{frame}"
            )
        return frame
