"""What slides along flexible beams: see :mod:`fem_lie.joints.equations.sliding`."""

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
from fem_lie.elements.beams.geodesic import Geodesic
from fem_lie.joints.connection import (
    Connection,
    ConstraintDefinition,
    History,
    SlidingConstraintDefinition,
    rows,
)

_ON_AXIS = 1e-6  # of the beam's size: places nearer to its axis are on it
_ON_LINE = ({1: 1.0}, {2: 1.0})


@dataclass(frozen=True, eq=False)
class Sliding(Connection):
    """A point slides along the axis of a beam without friction, over all of its elements.

    The place on the beam is where the point lies in the cross-section. It may leave the beam at
    neither end. The force that results report is that on the beam, in the axes of its section.

    Attributes:
        beam: One smooth line of geodesic elements.
        b: A point of another body, or ground.
        at: Place of the joint in the initial configuration, on the axis; default: the point ``b``.
        travel: Arclength from the beam's start as a function of time; default: free.
        name: How errors and results call it; default: after what it joins.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> tube = fl.Section.circle(0.01, steel)
        >>> beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), tube, cells=4)
        >>> bead = fl.RigidBody(0.1, (1e-4, 1e-4, 1e-4), position=(0.5, 0, 0))
        >>> scene = fl.Scene()
        >>> for body in (beam, bead):
        ...     _ = scene.add(body)
        ...
        >>> _ = scene.add(fl.Sliding(beam, bead.point("centre")))
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
        """Raise ``TypeError`` if an argument is of another kind than wanted."""
        kind = type(self).__name__
        instance(self.beam, Beam, f"{kind}: beam", "a Beam")
        require_point(self.b, f"{kind}: b")
        history(self.travel, f"{kind}: travel")
        text(self.name, f"{kind}: name")

    @property
    def label(self) -> str:
        """Name for messages and results."""
        return self.name or f"{type(self).__name__}({self.beam.label}, {self.b.label})"

    def check(self) -> None:
        """Raise ``ValueError`` if the beam is none for it, or the place not on it."""
        self.sliding_definition()

    def definitions(self) -> list[ConstraintDefinition]:
        """None that is fixed to a node of the beam."""
        return []

    @property
    def points(self) -> list[Point]:
        """What slides."""
        return [self.b]

    @property
    def bodies(self) -> list[Body | None]:
        """The beam and the body."""
        return [self.beam, self.b.body]

    @property
    def turns(self) -> bool:
        """Yes: it is fixed to a frame."""
        return True

    @property
    def history(self) -> History | None:
        """The travel."""
        return self.travel

    @property
    def coordinate_names(self) -> tuple[str, ...]:
        """Where it is on the beam."""
        return ("arclength",)

    def sliding_definition(self) -> SlidingConstraintDefinition:
        """Where it starts, and what is bound.

        Raises:
            ValueError: The beam is no smooth line of geodesic elements, the place is not on its
                axis, or the travel does not start there.
        """
        elements, lengths = self.beam.elements, self.beam.lengths
        chained = (elements[1:, 0] == elements[:-1, 1]).all()
        if not chained or not isinstance(self.beam.formulation, Geodesic):
            raise ValueError(
                f"{self.label}: the beam must be one smooth line of geodesic elements from its "
                "start to its end"
            )
        place = self.b.position if self.at is None else vector(self.at, 3, f"{self.label}: at")
        starts = np.cumsum(lengths) - lengths
        s, gap = _nearest(self.beam, elements, starts, place)
        if gap > _ON_AXIS * self.beam.size:
            frame = _axis_frame(self.beam, elements, starts, s)
            raise ValueError(
                f"{self.label}: the place {place} is {gap:g} off the beam's axis, more than "
                f"{_ON_AXIS:g} of its size {self.beam.size:g}; give at=... on the axis, such as "
                f"at=({', '.join(f'{x:.9g}' for x in frame[0])}), to which the point is joined by "
                "a rigid link"
            )
        if self.travel is not None:
            begin = at_time(self.travel, 0.0, f"{self.label}: travel")
            if not abs(begin - s) <= 1e-6 * self.beam.size:
                raise ValueError(
                    f"{self.label}: travel must start at arclength {s:g}, got {begin:g}"
                )
            s = begin
        # on the axis, and where travel starts: a gap would be closed in the first step
        frame = _axis_frame(self.beam, elements, starts, s)
        driven = int(self.travel is not None)
        selection = np.vstack([self.selection, np.zeros((driven, 12))])
        advance = np.append(np.zeros(len(self.selection)), np.ones(driven))
        return SlidingConstraintDefinition(self.beam, starts, self.b, frame, selection, advance, s)


class Collar(Sliding):
    """Slides along a beam and keeps its direction, free to spin about its axis.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> tube = fl.Section.circle(0.01, steel)
        >>> beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), tube, cells=4)
        >>> bead = fl.RigidBody(0.1, (1e-4, 1e-4, 1e-4), position=(0.5, 0, 0))
        >>> scene = fl.Scene()
        >>> for body in (beam, bead):
        ...     _ = scene.add(body)
        ...
        >>> _ = scene.add(fl.Collar(beam, bead.point("centre")))
        >>> len(scene.connections)
        1
    """

    selection = rows(*_ON_LINE, {6: 1.0}, {9: 1.0})


class Sleeve(Sliding):
    """Slides along a beam and turns with its section: a prismatic joint on the axis.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> tube = fl.Section.circle(0.01, steel)
        >>> beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), tube, cells=4)
        >>> bead = fl.RigidBody(0.1, (1e-4, 1e-4, 1e-4), position=(0.5, 0, 0))
        >>> scene = fl.Scene()
        >>> for body in (beam, bead):
        ...     _ = scene.add(body)
        ...
        >>> _ = scene.add(fl.Sleeve(beam, bead.point("centre")))
        >>> len(scene.connections)
        1
    """

    selection = rows(*_ON_LINE, {10: 0.5, 8: -0.5}, {5: 0.5, 9: -0.5}, {6: 0.5, 4: -0.5})


def _axis_frame(beam: Beam, elements: Indices, starts: Array, s: float) -> Array:
    """Frame of the axis at an arclength, shape (4, 3)."""
    e = max(int(np.searchsorted(starts, s, side="right")) - 1, 0)
    a, b = beam.frames[elements[e, :2]]
    return lie.se3_retract(a, (s - starts[e]) / beam.lengths[e] * lie.se3_relative(a, b))


def _nearest(beam: Beam, elements: Indices, starts: Array, place: Array) -> tuple[float, float]:
    """Arclength of the axis next to a place, and the distance.

    Each element is searched: next to a node either side may be the nearer one.
    """
    a, b = beam.frames[elements[:, 0]], beam.frames[elements[:, 1]]
    d = lie.se3_relative(a, b)
    ξ = np.linspace(0.0, 1.0, 9)
    points = lie.se3_retract(a[:, np.newaxis], ξ[:, np.newaxis] * d[:, np.newaxis])
    distance = np.linalg.norm(points[:, :, 0] - place, axis=2)
    at = ξ[distance.argmin(axis=1)]
    for _ in range(30):
        frames = lie.se3_retract(a, at[:, np.newaxis] * d)
        gap = np.einsum("eij,ej->ei", frames[:, 1:], place - frames[:, 0])
        slope = -d[:, 0] + np.cross(gap, d[:, 3:])[:, 0]
        # where all of a far element is equally near there is no slope
        step = np.divide(gap[:, 0], slope, out=np.zeros_like(at), where=slope != 0.0)
        at = np.clip(at - step, 0.0, 1.0)
    frames = lie.se3_retract(a, at[:, np.newaxis] * d)
    off = np.linalg.norm(place - frames[:, 0], axis=1)
    e = int(off.argmin())
    return float(starts[e] + at[e] * beam.lengths[e]), float(off[e])
