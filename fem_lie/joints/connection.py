"""What joints, springs, drives and gears have in common: terms in the relative motion of frames.

See :mod:`fem_lie.joints.equations.terms` for the relative motion ``z = (Δ, Q)``, selections and
functions.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, instance
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.body import Body, Point
from fem_lie.joints.equations import functions as joint_functions
from fem_lie.joints.equations.relative_motion import relative_motion

History = Callable[[float], float]


class LostBranchError(ArithmeticError):
    """A step rotates a joint so far that its angles or axes are not those that are meant."""


NO_ANGLE = np.zeros((2, 12))
"""Of pairs of frames whose angle is not used."""

_TRANSPOSED = np.array([0, 1, 2, 3, 6, 9, 4, 7, 10, 5, 8, 11])


def rows(*entries: dict[int, float]) -> Array:
    """Selection rows from {index in z = (Δ₁ Δ₂ Δ₃ Q₁₁ Q₁₂ … Q₃₃): factor}."""
    selection = np.zeros((len(entries), 12))
    for row, entry in zip(selection, entries, strict=True):
        for index, factor in entry.items():
            row[index] = factor
    return selection


class ConstraintDefinition(NamedTuple):
    """A pair of frames, and terms in their relative motion.

    Attributes:
        a: Point that carries frame A; likewise ``b``.
        frames: The two frames in the initial configuration, each (4, 3).
        selection: Linear part of the terms, shape (t, 12).
        functions: Factors of angle, distance and tilt in them, shape (t, 3).
        rows: The constraint of the connection that each term is a part of; −1: it is its spring.
        angle: Sine and cosine of the angle, shape (2, 12).
        reversible: Whether the sides may be exchanged, see :meth:`exchanged`.
    """

    a: Point
    b: Point
    frames: tuple[Array, Array]
    selection: Array
    functions: Array
    rows: Sequence[int]
    angle: Array = NO_ANGLE
    reversible: bool = False

    def exchanged(self) -> ConstraintDefinition:
        """The same with sides A and B exchanged.

        Of a reversible one, ``Δ`` along the axis changes its sign then and ``Q`` is transposed,
        while what is selected of ``Q`` is zero on both sides or in neither.
        """
        selection = self.selection.copy()
        selection[:, :3] *= -1.0
        return ConstraintDefinition(
            self.b,
            self.a,
            self.frames[::-1],
            selection,
            self.functions,
            self.rows,
            np.ascontiguousarray(self.angle[:, _TRANSPOSED]),
            self.reversible,
        )


class VelocityConstraintDefinition(NamedTuple):
    """A pair of frames whose relative velocity is bound, see :mod:`~.equations.rolling`.

    Attributes:
        a: Point that carries frame A.
        b: Point that carries frame B.
        frames: The two frames in the initial configuration, each (4, 3).
        selection: Components of the twist of B against A in the axes of B, shape (k, 6).
        radius: Of a disc about e₃ of B, whose two constraints turn with the point of contact.
    """

    a: Point
    b: Point
    frames: tuple[Array, Array]
    selection: Array
    radius: float = 0.0


class Connection(ABC):
    """What ties frames of bodies to each other; use one of the subclasses.

    Attributes:
        name: How errors and results call it.
    """

    name: str

    @property
    @abstractmethod
    def label(self) -> str:
        """Name for messages and results."""

    @abstractmethod
    def definitions(self) -> list[ConstraintDefinition]:
        """Pairs of frames and terms; the force that results report is that of the first."""

    @property
    def size(self) -> int:
        """Number of constraints of positions."""
        return 0

    def velocity_definitions(self) -> list[VelocityConstraintDefinition]:
        """Constraints of velocities."""
        return []

    @property
    def history(self) -> History | None:
        """What its only constraint is to be, as a function of time; ``None``: constant."""
        return None

    @property
    def spring(self) -> tuple[float, float, float] | None:
        """Stiffness, damping and rest value of the term without constraint."""
        return None

    @property
    def preloaded(self) -> bool:
        """Whether its spring has a rest value that may differ from its value at the start."""
        return False

    def coordinates(self) -> tuple[Coordinate, ...]:
        """Relative coordinates between two frames that results report."""
        return ()

    @property
    def coordinate_names(self) -> tuple[str, ...]:
        """How results call the coordinates."""
        return tuple(coordinate.name for coordinate in self.coordinates())

    def sliding_definition(self) -> SlidingConstraintDefinition | None:
        """What slides along a beam, if anything does."""
        return None

    @abstractmethod
    def check(self) -> None:
        """Raise ``ValueError`` if it is bad in itself."""

    @property
    def points(self) -> list[Point]:
        """What it is attached to."""
        return [
            point for definition in self.definitions() for point in (definition.a, definition.b)
        ]

    @property
    def bodies(self) -> list[Body | None]:
        """Those of its points, ``None`` for ground."""
        return [point.body for point in self.points]

    @property
    def turns(self) -> bool:
        """Whether it feels rotations of its points."""
        for definition in self.definitions():
            by_place = any(
                point.body is not None
                and np.abs(frame[0] - point.position).max() > 1e-9 * point.size
                for point, frame in zip(
                    (definition.a, definition.b), definition.frames, strict=True
                )
            )
            used = definition.functions[:, [joint_functions.ANGLE, joint_functions.TILT]].any()
            if by_place or used or definition.selection[:, 3:].any():
                return True
        return False


class Coordinate(NamedTuple):
    """A relative coordinate of a joint: for springs, drives and gears, and in results.

    Attributes:
        definition: Its pair of frames with the coordinate as the only term.
        name: What results call it: ``angle`` (rad, unwrapped), ``displacement``, ``length``.
        joint: Whose it is.
    """

    definition: ConstraintDefinition
    name: str
    joint: Connection

    @staticmethod
    def require(value: object, what: str) -> None:
        """Refuse what is no coordinate.

        Args:
            value: What was given.
            what: For what, as "Drive: coordinate".

        Raises:
            TypeError: It is something else.
        """
        wanted = "a coordinate of a joint such as joint.angle"
        if isinstance(value, Connection):
            known = ", ".join(value.coordinate_names) or "none"
            wanted = f"{wanted} ({type(value).__name__} has: {known})"
        instance(value, Coordinate, what, wanted)

    @property
    def label(self) -> str:
        """For messages."""
        return f"{self.name} of {self.joint.label}"

    @property
    def angular(self) -> bool:
        """Whether it is an angle, and no length."""
        definition = self.definition
        return not (
            definition.selection[:, :3].any()
            or definition.functions[:, joint_functions.DISTANCE].any()
        )

    @property
    def size(self) -> float:
        """Of the bodies that it ties: a length beside which its own errors count."""
        return max(
            point.size for point in (self.definition.a, self.definition.b) if not point.is_ground
        )

    @property
    def binds(self) -> bool:
        """Whether its joint forbids any motion: a :class:`Distance` does not."""
        return self.joint.size > 0 or bool(self.joint.velocity_definitions())

    def same(self, other: Coordinate) -> bool:
        """Whether it is the same function of the motion as another, but for its sign."""
        return any(
            self._equals(definition)
            for definition in (other.definition, other.definition.exchanged())
        )

    def _equals(self, definition: ConstraintDefinition) -> bool:
        mine = self.definition
        if not (mine.a.same(definition.a) and mine.b.same(definition.b)):
            return False
        pairs = (
            (mine.selection, definition.selection),
            (mine.functions, definition.functions),
            (mine.angle, definition.angle),
            (np.array(mine.frames), np.array(definition.frames)),
        )
        return all(np.array_equal(own, others) for own, others in pairs)

    def start(self) -> float:
        """Its value in the initial configuration."""
        z, f, definition = np.empty(12), np.zeros(3), self.definition
        relative_motion(*definition.frames, z)
        joint_functions.values(z, definition.angle, 0.0, f)
        return float(definition.selection[0] @ z + definition.functions[0] @ f)

    def as_row(self, row: int, factor: float = 1.0) -> ConstraintDefinition:
        """Its tie as a term of constraint ``row``, times ``factor``; −1: of a spring."""
        definition = self.definition
        return definition._replace(
            selection=factor * definition.selection,
            functions=factor * definition.functions,
            rows=(row,),
        )


class SlidingConstraintDefinition(NamedTuple):
    """A frame that slides along the elements of a beam.

    Attributes:
        beam: Its elements follow each other; likewise ``starts`` of arclength at each.
        starts: Arclength at the start of each element, shape (e,).
        b: Point that carries the frame.
        frame: In the initial configuration, that of the section it is at, shape (4, 3).
        selection: Of the relative motion against that section, shape (k, 12).
        advance: Factors of the arclength, shape (k,).
        arclength: In the initial configuration.
    """

    beam: Beam
    starts: Array
    b: Point
    frame: Array
    selection: Array
    advance: Array
    arclength: float
