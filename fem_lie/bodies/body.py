"""What a scene is made of: bodies with nodal frames, and points on them.

A body is nodes with frames, inertia, and perhaps an elastic assembly shared with all bodies of its
kind. It knows nothing of unknowns, solvers or other bodies.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from fem_lie import lie
from fem_lie._arrays import LARGEST, Array, choice, instance, numbers, text
from fem_lie.lie.motions import Group

if TYPE_CHECKING:
    from fem_lie.bodies.turning import Turning
    from fem_lie.forms.assembly import Assembly

_ORTHONORMAL = 1e-8  # as of prescribed motions


def vector(value: npt.ArrayLike, size: int, what: str) -> Array:
    """``value`` as finite numbers of shape ``(size,)``.

    Raises:
        ValueError: It is something else; the message says what was given for what.
    """
    try:
        array = numbers(value, what)
    except TypeError:
        raise ValueError(f"{what} must be {size} numbers, got {value!r}") from None
    if array.shape != (size,) or not np.isfinite(array).all():
        raise ValueError(f"{what} must be {size} finite numbers, got {value!r}")
    if not (np.abs(array) < LARGEST).all():
        raise ValueError(f"{what} must be {size} numbers below {LARGEST:g}, got {value!r}")
    return array


def direction(value: npt.ArrayLike, what: str) -> Array:
    """A unit vector along ``value``, shape (3,), however long that is.

    Raises:
        ValueError: It is zero, or not three finite numbers.
    """
    given = vector(value, 3, what)
    largest = np.abs(given).max()
    if largest == 0.0:
        raise ValueError(f"{what} must not be zero, got {value!r}")
    # squares of very small or large numbers are none
    scaled = given / largest
    return np.asarray(scaled / np.linalg.norm(scaled))


class HeldRotation(NamedTuple):
    """Something that takes hold of the rotation of a node.

    Attributes:
        node: Which one.
        other: What holds it, the same for all nodes that are held by the same rigid thing.
        what: Its name for messages.
        axis: The only axis of its moment, if there is but one, global components.
    """

    node: int
    other: Hashable
    what: str
    axis: Array | None = None


Holds: TypeAlias = Mapping["Body", Sequence[HeldRotation]]
"""What takes hold of the rotations of each body's nodes in a scene; bodies may be missing."""

NO_HOLDS: Holds = MappingProxyType({})


class Body:
    """Nodes that move.

    Attributes:
        frames: Initial frames of the nodes, shape (n, 4, 3), see :mod:`fem_lie.lie`.
        velocities: Initial local velocities (translation, rotation), shape (n, 6).
        cells: Pairs of nodes, for drawing, shape (m, 2).
        outline: Outline of the section in (e₂, e₃), shape (k, 2), or of that of each cell, shape
            (m, k, 2), nan where there is none; or ``None``: for drawing.
        box: Edges of a box about a rigid body's frame, shape (3,), or ``None``: for drawing.
        size: A length of the body, for tolerances.
        leaders: The node that each node follows rigidly, itself if it is free, shape (n,).
        group: On which its nodes move in time integration.
        faces: Corners of cells that are surfaces, for drawing, shape (m, 3 or 4).
        thickness: Of those, shape (m,), for drawing.
        held: Which unknowns (translation, rotation) of the nodes are zero, shape (n, 6).
        supports: Axes fixed in space along which ``held`` translations are, nan where they are the
            node's own, shape (n, 3, 3).
        uncoupled: Whether statics moves its nodes, and those that follow them or that they follow,
            by ``x + R u``, ``R exp(η₁, η₂, 0) exp(η₃)``, and not by ``H exp(h)``.
        name: How messages and results call it; the scene gives one if it is empty.
    """

    uncoupled: ClassVar[bool] = False

    def __init__(
        self,
        frames: Array,
        *,
        cells: npt.NDArray[np.int64],
        outline: Array | None,
        size: float,
        points: dict[str, int],
        box: Array | None = None,
        leaders: npt.NDArray[np.int64] | None = None,
        group: Group = Group.SE3,
        name: str = "",
    ) -> None:
        """Keep copies of the frames; velocities start at zero."""
        text(name, f"{type(self).__name__}: name")
        self.frames = np.array(frames, dtype=np.float64)
        self.velocities = np.zeros((len(self.frames), 6))
        self.cells, self.outline, self.box = cells, outline, box
        self.size, self.name = size, name
        self.leaders = np.arange(len(self.frames)) if leaders is None else leaders
        self.group = choice(group, Group, f"{type(self).__name__}: group")
        self.faces: npt.NDArray[np.int64] = np.empty((0, 4), dtype=np.int64)
        self.thickness: Array = np.empty(0)
        self.held = np.zeros((len(self.frames), 6), dtype=bool)
        self.supports = np.full((len(self.frames), 3, 3), np.nan)
        self._points = points

    @property
    def kind(self) -> Hashable:
        """Bodies of one kind are assembled together by :meth:`assemble`."""
        return type(self).__name__

    @classmethod
    def assemble(cls, bodies: Sequence[Any], holds: Holds = NO_HOLDS) -> Assembly | None:
        """The assembly of bodies of one kind, or ``None`` if they are rigid.

        Args:
            bodies: Of one :attr:`kind`; either all or none of them drill.
            holds: What takes hold of the rotations of their nodes.
        """
        return None

    def __getitem__(self, name: str) -> Point:
        """The point with this name.

        Raises:
            ValueError: There is none; the message lists those that exist.
            TypeError: It is no name.
        """
        text(name, f"the name of a point of {self.label}")
        if name not in self._points:
            known = ", ".join(sorted(self._points)) or "none"
            raise ValueError(f"{self.label} has no point {name!r}; it has: {known}")
        return Point(self, self._points[name], name)

    @property
    def label(self) -> str:
        """The name, or the class if there is none yet."""
        return self.name or type(self).__name__

    @property
    def point_names(self) -> dict[str, int]:
        """Named points and their nodes."""
        return dict(self._points)

    def node(self, index: int) -> Point:
        """Point at a node.

        Raises:
            ValueError: There is no such node.
            TypeError: It is no whole number.
        """
        instance(index, int | np.integer, f"the number of a node of {self.label}", "whole")
        if not -len(self.frames) <= index < len(self.frames):
            raise ValueError(f"{self.label} has nodes 0 … {len(self.frames) - 1}, got {index}")
        return Point(self, index % len(self.frames), f"node {index}")

    def drills(self, holds: Sequence[HeldRotation] = ()) -> bool:
        """Whether its nodes turn about their third directors.

        Args:
            holds: What takes hold of their rotations.

        Raises:
            ValueError: They would have to, but cannot.
        """
        return True

    def drilling_told(self, holds: Sequence[HeldRotation]) -> tuple[bool, Array | None]:
        """Whether its nodes drill if these things hold them, and how stiff its cells are then."""
        return self.drills(holds), None

    def check(self) -> None:
        """Raise ``ValueError`` if frames or velocities of nodes have been set to what is none."""
        shape, count = self.velocities.shape, len(self.frames)
        if shape != (count, 6) or not np.isfinite(self.velocities).all():
            raise ValueError(
                f"velocities of {self.label} must be finite and of shape ({count}, 6), got\n"
                f"{self.velocities}"
            )
        axes = self.frames[:, 1:]
        gap = np.abs(axes @ axes.transpose(0, 2, 1) - np.eye(3)).max(axis=(1, 2))
        right = np.linalg.det(axes) > 0.0
        finite = np.isfinite(self.frames).all(axis=(1, 2))
        bad = np.flatnonzero(~(finite & (gap <= _ORTHONORMAL) & right))
        if len(bad):
            raise ValueError(
                f"frames of {self.label} must be a place and right-handed orthonormal axes; that "
                f"of node {bad[0]} is\n{self.frames[bad[0]]}"
            )

    def turn(self, omega: npt.ArrayLike, about: Point | npt.ArrayLike) -> None:
        """Add a rigid rotation to the initial velocities.

        Args:
            omega: Angular velocity, global components, rad per time.
            about: A point of a body, or a place, that stays at rest in this rotation.
        """
        centre = about.position if isinstance(about, Point) else vector(about, 3, "about")
        spin = vector(omega, 3, "omega")
        self._add_velocity(np.cross(spin, self.frames[:, 0] - centre), spin)

    def move(self, velocity: npt.ArrayLike) -> None:
        """Add a translation, global components, to the initial velocities."""
        given = vector(velocity, 3, "velocity")
        self._add_velocity(np.tile(given, (len(self.frames), 1)), np.zeros(3))

    def turning(self) -> Turning | None:
        """How far its elements may turn from end to end, or ``None`` if it has none."""
        return None

    def cells_of(self, group: str | None = None) -> npt.NDArray[np.int64]:
        """Elements of a named group (default: all).

        Raises:
            ValueError: The body has no elements, or no such group.
        """
        raise ValueError(f"{self.label} has no cells to put a load on")

    def consistent_shares(self) -> tuple[npt.NDArray[np.int64], Array]:
        """Nodes of each element, shape (m, k), and the length that each of them carries, (m, k).

        Raises:
            ValueError: The body has no elements.
        """
        raise ValueError(f"{self.label} has no cells to put a load on")

    def consistent_levers(self) -> Array:
        """What a unit line force on each element does on the directors of its nodes, (m, k, 3).

        Raises:
            ValueError: The body has no elements.
        """
        raise ValueError(f"{self.label} has no cells to put a load on")

    def _add_velocity(self, translation: npt.NDArray[Any], spin: Array) -> None:
        self.velocities[:, :3] += np.einsum("nij,nj->ni", self.frames[:, 1:], translation)
        self.velocities[:, 3:] += self.frames[:, 1:] @ spin


@dataclass(frozen=True, eq=False)
class Point:
    """A node of a body, or ground (``body`` is ``None``): where joints and loads are attached."""

    body: Body | None
    node: int = 0
    name: str = ""

    def __post_init__(self) -> None:
        """Raise ``ValueError`` or ``TypeError`` if there is no such body or node."""
        instance(self.body, Body | None, "Point: body", "a body, or None for ground")
        instance(self.node, int | np.integer, "Point: node", "the number of a node")
        text(self.name, "Point: name")
        if self.body is not None and not 0 <= self.node < len(self.body.frames):
            last = len(self.body.frames) - 1
            raise ValueError(f"{self.body.label} has nodes 0 … {last}, got {self.node}")

    @property
    def is_ground(self) -> bool:
        """Whether it is fixed in space."""
        return self.body is None

    @property
    def position(self) -> Array:
        """Initial position of the node, shape (3,)."""
        return np.zeros(3) if self.body is None else self.body.frames[self.node, 0]

    @property
    def frame(self) -> Array:
        """Initial frame of the node, shape (4, 3)."""
        return (
            lie.frame(np.zeros(3), np.eye(3)) if self.body is None else self.body.frames[self.node]
        )

    @property
    def size(self) -> float:
        """A length of the body."""
        return 1.0 if self.body is None else self.body.size

    @property
    def label(self) -> str:
        """For messages and results."""
        return "ground" if self.body is None else f"{self.body.label}.{self.name}"


def require_point(value: object, what: str) -> None:
    """Refuse what is no point of a body and not ground.

    Args:
        value: What was given.
        what: For what, as "PointLoad: point".

    Raises:
        TypeError: It is something else.
    """
    instance(value, Point, what, "a point such as beam.end, body['tip'], body.node(3) or ground()")


def ground() -> Point:
    """What does not move."""
    return Point(None)
