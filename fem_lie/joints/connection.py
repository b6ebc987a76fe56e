"""Base class of joints, springs, drives and gears, and the records that define their constraints.

Constraints are terms in the relative motion ``z = (Δ, Q)`` of two frames, see
:mod:`fem_lie.joints.equations.terms`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp

from fem_lie._arrays import Array, Indices, instance
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.body import Body, Point
from fem_lie.joints.equations import functions as joint_functions
from fem_lie.joints.equations.relative_motion import relative_motion
from fem_lie.joints.laws import Law

History = Callable[[float], float]


class LostBranchError(ArithmeticError):
    """A joint moves so far in one step that its angle or axes are ambiguous, or off its beam."""


NO_ANGLE = np.zeros((2, 12))
"""Angle rows of a pair of frames without an angle."""

_TRANSPOSED = np.array([0, 1, 2, 3, 6, 9, 4, 7, 10, 5, 8, 11])


def rows(*entries: dict[int, float]) -> Array:
    """Selection rows (k, 12) from {index in z = (Δ₁ Δ₂ Δ₃ Q₁₁ Q₁₂ … Q₃₃): factor}.

    Args:
        entries: Factors by index, a dictionary for each row.
    """
    selection = np.zeros((len(entries), 12))
    for row, entry in zip(selection, entries, strict=True):
        for index, factor in entry.items():
            row[index] = factor
    return selection


class ConstraintDefinition(NamedTuple):
    """Definition of constraints: a pair of frames, and terms in their relative motion.

    Attributes:
        a: Point to which frame A is fixed.
        b: Point to which frame B is fixed.
        frames: Frames A and B in the initial configuration, each (4, 3).
        selection: Linear part of the terms, shape (t, 12).
        functions: Factors of angle, distance, tilt and angular velocity in the terms, shape (t, 6),
            see :mod:`~.equations.functions`.
        rows: Number of the constraint of the connection to which each term belongs; −1: spring
            term.
        angle: Rows of sine and cosine of the angle, shape (2, 12).
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
        """The same constraints with frames A and B exchanged.

        For a reversible definition, ``Δ`` along the axis changes its sign and ``Q`` is transposed;
        the selected components of ``Q`` vanish in both orders.
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
    """Definition of velocity constraints between two frames, see :mod:`~.equations.rolling`.

    Attributes:
        a: Point to which frame A is fixed.
        b: Point to which frame B is fixed.
        frames: Frames A and B in the initial configuration, each (4, 3).
        selection: Components of the twist of B relative to A, in the axes of B, shape (k, 6).
        radius: Radius of a disc about e₃ of B, whose two constraints refer to the point of contact;
            0: no disc.
    """

    a: Point
    b: Point
    frames: tuple[Array, Array]
    selection: Array
    radius: float = 0.0


class BushingDefinition(NamedTuple):
    """Definition of springs and dampers in six components, see :mod:`~.equations.bushings`.

    Attributes:
        a: Point to which frame A is fixed.
        b: Point to which frame B is fixed.
        frames: Frames A and B in the initial configuration, each (4, 3).
        stiffness: Stiffness of the relative motion, shape (6, 6).
        damping: Damping of the relative motion, shape (6, 6).
    """

    a: Point
    b: Point
    frames: tuple[Array, Array]
    stiffness: Array
    damping: Array


class TieDefinition(NamedTuple):
    """Definition of equal mean positions of nodes of two bodies, ``Σ D x₁ = Σ M x₂``.

    Attributes:
        first: Body of the nodes with multipliers.
        second: The other body.
        nodes: Node of the first body of each multiplier, shape (p,).
        adjacent: Pairs of multipliers whose nodes are corners of one facet, in both orders, (a, 2).
        own: ``D``, weights of the nodes of the first body, rows have the sum 1; shape (p, n).
        others: ``M``, weights of the nodes of the second body, shape (p, k).
        areas: Area of each multiplier, shape (p,).
    """

    first: Body
    second: Body
    nodes: Indices
    adjacent: Indices
    own: sp.csr_matrix
    others: sp.csr_matrix
    areas: Array


class FrictionDefinition(NamedTuple):
    """Definition of friction in a joint, see :mod:`~.equations.friction`.

    Attributes:
        joint: The joint whose constraint forces press its surfaces together.
        data: Numbers of the law, shape (10,).
    """

    joint: Connection
    data: Array


class Bounds(NamedTuple):
    """Range of a coordinate in which its constraint does not act.

    Attributes:
        lower: Smallest value.
        upper: Largest value.
        restitution: Coefficient of restitution of impacts at both ends.
        unit: Size of the coordinate: 1 for angles, that of the bodies for lengths.
    """

    lower: float
    upper: float
    restitution: float
    unit: float


class Connection(ABC):
    """Base class of whatever connects frames of bodies.

    Attributes:
        name: Name in messages and results.
        active: Whether its constraints act from the start.
    """

    name: str
    active: bool = True

    @property
    @abstractmethod
    def label(self) -> str:
        """Name in messages and results."""

    @abstractmethod
    def definitions(self) -> list[ConstraintDefinition]:
        """Definitions of position constraints; results report the force of the first."""

    @property
    def summed(self) -> bool:
        """Whether results report the sum over all definitions, which then have one frame A."""
        return False

    @property
    def size(self) -> int:
        """Number of position constraints in relative motions, see :meth:`definitions`."""
        return 0

    def velocity_definitions(self) -> list[VelocityConstraintDefinition]:
        """Definitions of velocity constraints."""
        return []

    @property
    def history(self) -> History | None:
        """Prescribed value of the last constraint as a function of time; ``None``: constant."""
        return None

    @property
    def holds(self) -> bool:
        """Whether its constraints, when they are activated, keep the present coordinates."""
        return False

    @property
    def bounds(self) -> Bounds | None:
        """Range in which its only constraint does not act, ``None``: it is no limit."""
        return None

    @property
    def spring(self) -> tuple[float, float, float] | None:
        """Stiffness, damping and rest value of the spring term; ``None``: no spring."""
        return None

    @property
    def force_law(self) -> Law | None:
        """Force law of the spring term instead of stiffness and damping; ``None``: no law."""
        return None

    @property
    def friction(self) -> FrictionDefinition | None:
        """Friction that its spring terms are, ``None``: they are not."""
        return None

    @property
    def fingerprint(self) -> Array | None:
        """Numbers that differ if its force law, friction or limits do; ``None``: it has none."""
        return None

    @property
    def preloaded(self) -> bool:
        """Whether the spring has a rest value that may differ from its initial value."""
        return False

    def coordinates(self) -> tuple[Coordinate, ...]:
        """Coordinates of the relative motion in results, lengths or rad; default: none."""
        return ()

    @property
    def coordinate_names(self) -> tuple[str, ...]:
        """Names of the coordinates in results."""
        return tuple(coordinate.name for coordinate in self.coordinates())

    def sliding_definition(self) -> SlidingConstraintDefinition | None:
        """Definition of a frame that slides along a beam, or ``None``."""
        return None

    def bushing_definition(self) -> BushingDefinition | None:
        """Definition of springs and dampers in six components, or ``None``."""
        return None

    def tie_definition(self) -> TieDefinition | None:
        """Definition of equal mean positions of two faces, or ``None``."""
        return None

    @property
    def force_side(self) -> tuple[Point, Array] | None:
        """Point ``a`` and the axes of its force at the start, (3, 3); ``None`` if it slides."""
        for pair in self.definitions():
            return pair.a, pair.frames[0][1:]
        for rolling in self.velocity_definitions():
            return rolling.a, rolling.frames[0][1:]
        bushing = self.bushing_definition()
        return None if bushing is None else (bushing.a, bushing.frames[0][1:])

    @abstractmethod
    def check(self) -> None:
        """Raise ``ValueError`` if the connection is invalid."""

    @property
    def points(self) -> list[Point]:
        """Points to which it is attached."""
        return [
            point for definition in self.definitions() for point in (definition.a, definition.b)
        ]

    @property
    def bodies(self) -> list[Body | None]:
        """Bodies of its points; ``None`` for ground."""
        return [point.body for point in self.points]

    @property
    def turns(self) -> bool:
        """Whether it depends on rotations of its points."""
        for definition in self.definitions():
            by_place = any(
                point.body is not None
                and np.abs(frame[0] - point.position).max() > 1e-9 * point.size
                for point, frame in zip(
                    (definition.a, definition.b), definition.frames, strict=True
                )
            )
            used = np.delete(definition.functions, joint_functions.DISTANCE, axis=1).any()
            if by_place or used or definition.selection[:, 3:].any():
                return True
        return False


class Coordinate(NamedTuple):
    """Relative coordinate of a joint, for springs, drives, gears and results.

    Attributes:
        definition: Pair of frames, with the coordinate as the only term.
        name: Name in results: ``angle`` (rad, unwrapped), ``displacement``, ``length``.
        joint: The joint.
    """

    definition: ConstraintDefinition
    name: str
    joint: Connection

    @staticmethod
    def require(value: object, what: str) -> None:
        """Raise ``TypeError`` if ``value`` is not a coordinate.

        Args:
            value: The argument.
            what: Name of the argument, as "Drive: coordinate".

        Raises:
            TypeError: It is not a coordinate.
        """
        expected = "a coordinate of a joint such as joint.angle"
        if isinstance(value, Connection):
            known = ", ".join(value.coordinate_names) or "none"
            expected = f"{expected} ({type(value).__name__} has: {known})"
        instance(value, Coordinate, what, expected)

    @property
    def label(self) -> str:
        """Name of the joint in messages."""
        return f"{self.name} of {self.joint.label}"

    @property
    def angular(self) -> bool:
        """Whether it is an angle; otherwise it is a length."""
        definition = self.definition
        return not (
            definition.selection[:, :3].any()
            or definition.functions[:, joint_functions.DISTANCE].any()
        )

    @property
    def size(self) -> float:
        """Size of the connected bodies: the length scale for tolerances of the coordinate."""
        return max(
            point.size for point in (self.definition.a, self.definition.b) if not point.is_ground
        )

    @property
    def binds(self) -> bool:
        """Whether its joint has any constraint; :class:`Distance` has none."""
        return self.joint.size > 0 or bool(self.joint.velocity_definitions())

    def same(self, other: Coordinate) -> bool:
        """Whether it is the same function of the motion as another coordinate, up to its sign.

        Args:
            other: Another coordinate.
        """
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
        """Value in the initial configuration."""
        z, f, definition = np.empty(12), np.zeros(3), self.definition
        relative_motion(*definition.frames, z)
        joint_functions.values(z, definition.angle, 0.0, f)
        return float(definition.selection[0] @ z + definition.functions[0, : len(f)] @ f)

    def as_row(self, row: int, factor: float = 1.0) -> ConstraintDefinition:
        """Coordinate times ``factor`` as a term of constraint ``row``; −1: spring.

        Args:
            row: Number of the constraint.
            factor: Factor of the coordinate in the constraint.
        """
        definition = self.definition
        return definition._replace(
            selection=factor * definition.selection,
            functions=factor * definition.functions,
            rows=(row,),
        )


class SlidingConstraintDefinition(NamedTuple):
    """Definition of a frame that slides along the elements of a beam.

    Attributes:
        beam: Beam whose elements form one line.
        starts: Arc length at the start of each element, shape (e,).
        b: Point to which the sliding frame is fixed.
        frame: Sliding frame in the initial configuration, equal to the section frame there, (4, 3).
        selection: Constrained components of the motion relative to the section, shape (k, 12).
        advance: Factor of the arc length in each constraint, shape (k,).
        arclength: Arc length of the frame in the initial configuration.
    """

    beam: Beam
    starts: Array
    b: Point
    frame: Array
    selection: Array
    advance: Array
    arclength: float
