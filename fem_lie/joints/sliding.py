"""Joints that slide along flexible beams, see :mod:`fem_lie.joints.equations.sliding`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from fem_lie import lie
from fem_lie._arrays import Array, Indices, at_time, history, instance, text, vector
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.body import Body, Point
from fem_lie.bodies.points import require_point
from fem_lie.elements.beams.geodesic import GeodesicBeam
from fem_lie.joints.connection import (
    Connection,
    ConstraintDefinition,
    History,
    SlidingConstraintDefinition,
    rows,
)

_ON_AXIS = 1e-6  # largest distance from the axis over the size of the beam
_ON_LINE = ({1: 1.0}, {2: 1.0})


@dataclass(frozen=True, eq=False)
class Sliding(Connection):
    """A point slides along the axis of a beam without friction, across all of its elements.

    The arc length on the beam is that of the section in whose plane the point lies. The point must
    not leave the beam. The force in results acts on the beam, in the axes of the section.

    Attributes:
        beam: Beam that is one smooth line of geodesic elements.
        b: A point of another body, or ground.
        at: Initial position of the joint, on the axis of the beam; default: the point ``b``.
        travel: Arc length from the start of the beam as a function of time; default: free.
        name: Name in messages and results; default: class name, beam and point.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> tube = fl.Section.circle(0.01, steel)
        >>> beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), tube, cells=4)
        >>> bead = fl.RigidBody(0.1, (1e-4, 1e-4, 1e-4), position=(0.5, 0, 0))
        >>> scene = fl.Scene()
        >>> for body in (beam, bead):
        ...     _ = scene.add(body)
        ...
        >>> _ = scene.add(fl.joints.Sliding(beam, bead.point("centre")))
        >>> len(scene.connections)
        1
    """

    beam: Beam
    b: Point
    at: npt.ArrayLike | None = None
    travel: History | None = None
    name: str = ""

    selection: ClassVar[Array] = rows(*_ON_LINE)

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if an argument has a wrong type."""
        kind = type(self).__name__
        instance(self.beam, Beam, f"{kind}: beam", "a Beam")
        require_point(self.b, f"{kind}: b")
        history(self.travel, f"{kind}: travel")
        text(self.name, f"{kind}: name")

    @property
    def label(self) -> str:
        """Name in messages and results."""
        return self.name or f"{type(self).__name__}({self.beam.label}, {self.b.label})"

    def check(self) -> None:
        """Raise ``ValueError`` if the beam is unsuitable, or the point is not on its axis."""
        self.sliding_definition()

    def definitions(self) -> list[ConstraintDefinition]:
        """No definitions between fixed frames."""
        return []

    @property
    def points(self) -> list[Point]:
        """The sliding point."""
        return [self.b]

    @property
    def bodies(self) -> list[Body | None]:
        """The beam and the body of the point."""
        return [self.beam, self.b.body]

    @property
    def turns(self) -> bool:
        """Whether it depends on rotations: always."""
        return True

    @property
    def history(self) -> History | None:
        """Prescribed arc length as a function of time."""
        return self.travel

    @property
    def coordinate_names(self) -> tuple[str, ...]:
        """Name of the coordinate: arc length on the beam."""
        return ("arclength",)

    def sliding_definition(self) -> SlidingConstraintDefinition:
        """Definition with the initial arc length and the constrained components.

        Raises:
            ValueError: The beam is not one smooth line of geodesic elements, the point is not on
                its axis, or the travel does not start there.
        """
        elements, lengths = self.beam.model.elements, self.beam.model.lengths
        chained = (elements[1:, 0] == elements[:-1, 1]).all()
        if not chained or not isinstance(self.beam.model.formulation, GeodesicBeam):
            raise ValueError(
                f"{self.label}: the beam must be one smooth line of geodesic elements from its "
                "start to its end"
            )
        position = self.b.position if self.at is None else vector(self.at, 3, f"{self.label}: at")
        starts = np.cumsum(lengths) - lengths
        s, gap = _nearest(self.beam, elements, starts, position)
        size = self.beam.model.size
        if gap > _ON_AXIS * size:
            frame = _axis_frame(self.beam, elements, starts, s)
            raise ValueError(
                f"{self.label}: the position {position} is {gap:g} off the beam's axis, more than "
                f"{_ON_AXIS:g} of its size {size:g}; give at=... on the axis, such as "
                f"at=({', '.join(f'{x:.9g}' for x in frame[0])}), to which the point is joined by "
                "a rigid link"
            )
        if self.travel is not None:
            begin = at_time(self.travel, 0.0, f"{self.label}: travel")
            if not abs(begin - s) <= 1e-6 * self.beam.model.size:
                raise ValueError(
                    f"{self.label}: travel must start at arclength {s:g}, got {begin:g}"
                )
            s = begin
        # exactly on the axis and at the start of the travel: the first step would close a gap
        frame = _axis_frame(self.beam, elements, starts, s)
        driven = int(self.travel is not None)
        selection = np.vstack([self.selection, np.zeros((driven, 12))])
        advance = np.append(np.zeros(len(self.selection)), np.ones(driven))
        return SlidingConstraintDefinition(self.beam, starts, self.b, frame, selection, advance, s)


class Collar(Sliding):
    """Slides along a beam with its axis tangent to that of the beam; the spin is free.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> tube = fl.Section.circle(0.01, steel)
        >>> beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), tube, cells=4)
        >>> bead = fl.RigidBody(0.1, (1e-4, 1e-4, 1e-4), position=(0.5, 0, 0))
        >>> scene = fl.Scene()
        >>> for body in (beam, bead):
        ...     _ = scene.add(body)
        ...
        >>> _ = scene.add(fl.joints.Collar(beam, bead.point("centre")))
        >>> len(scene.connections)
        1
    """

    selection = rows(*_ON_LINE, {6: 1.0}, {9: 1.0})


class Sleeve(Sliding):
    """Slides along a beam and rotates with the section: a prismatic joint on the axis.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> tube = fl.Section.circle(0.01, steel)
        >>> beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), tube, cells=4)
        >>> bead = fl.RigidBody(0.1, (1e-4, 1e-4, 1e-4), position=(0.5, 0, 0))
        >>> scene = fl.Scene()
        >>> for body in (beam, bead):
        ...     _ = scene.add(body)
        ...
        >>> _ = scene.add(fl.joints.Sleeve(beam, bead.point("centre")))
        >>> len(scene.connections)
        1
    """

    selection = rows(*_ON_LINE, {10: 0.5, 8: -0.5}, {5: 0.5, 9: -0.5}, {6: 0.5, 4: -0.5})


def _axis_frame(beam: Beam, elements: Indices, starts: Array, s: float) -> Array:
    """Frame of the beam at an arc length, shape (4, 3)."""
    e = max(int(np.searchsorted(starts, s, side="right")) - 1, 0)
    a, b = beam.frames[elements[e, :2]]
    return lie.se3_retract(a, (s - starts[e]) / beam.model.lengths[e] * lie.se3_relative(a, b))


def _nearest(beam: Beam, elements: Indices, starts: Array, position: Array) -> tuple[float, float]:
    """Arc length of the point of the axis closest to a position, and the distance.

    Every element is searched, since the closest element is not known beforehand.
    """
    a, b = beam.frames[elements[:, 0]], beam.frames[elements[:, 1]]
    d = lie.se3_relative(a, b)
    ξ = np.linspace(0.0, 1.0, 9)
    points = lie.se3_retract(a[:, np.newaxis], ξ[:, np.newaxis] * d[:, np.newaxis])
    distance = np.linalg.norm(points[:, :, 0] - position, axis=2)
    at = ξ[distance.argmin(axis=1)]
    for _ in range(30):
        frames = lie.se3_retract(a, at[:, np.newaxis] * d)
        gap = np.einsum("eij,ej->ei", frames[:, 1:], position - frames[:, 0])
        slope = -d[:, 0] + np.cross(gap, d[:, 3:])[:, 0]
        # no slope: all points of a far element have the same distance
        step = np.divide(gap[:, 0], slope, out=np.zeros_like(at), where=slope != 0.0)
        at = np.clip(at - step, 0.0, 1.0)
    frames = lie.se3_retract(a, at[:, np.newaxis] * d)
    off = np.linalg.norm(position - frames[:, 0], axis=1)
    e = int(off.argmin())
    return float(starts[e] + at[e] * beam.model.lengths[e]), float(off[e])
