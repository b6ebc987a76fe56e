"""Rigid bodies: one node with its frame, and an inertia tensor."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from fem_lie import lie
from fem_lie._arrays import Array, direction, numbers, positive, rotation_matrix, vector
from fem_lie.attachments.at_nodes import at_node
from fem_lie.bodies.body import Body
from fem_lie.bodies.catalogue import box_corners
from fem_lie.bodies.model import BodyModel, MaterialPoint
from fem_lie.lie.motions import Group
from fem_lie.sections.properties import director_mass_matrix

_ROUND = 24
"""Corners of a drawn circle."""

_ANGLES = 2.0 * np.pi * np.arange(_ROUND) / _ROUND

_DISC: Array = np.column_stack([np.ones(_ROUND), np.cos(_ANGLES), np.sin(_ANGLES)])
"""Corners of a circle of radius 1 about e₁, at the height 1, shape (n, 3)."""

_SPHERE: Array = np.vstack(
    [(np.cos(a), np.sin(a), np.sin(a)) * _DISC for a in np.linspace(0.0, np.pi, _ROUND // 2 + 1)]
)
"""Corners of a sphere of radius 1 about e₁, those at the poles repeated, shape (n, 3)."""


class RigidBodyModel(BodyModel):
    """Node and inertia of a rigid body.

    Attributes:
        mass_matrix: Constant mass matrix of (x, d₁, d₂, d₃), shape (4, 4).
    """

    group = Group.R3xSO3

    def __init__(
        self, frame: Array, mass_matrix: Array, size: float, class_name: str, name: str
    ) -> None:
        """Take the frame at the centre of mass, shape (4, 3), and the mass matrix."""
        self.mass_matrix = mass_matrix
        super().__init__(
            frame[np.newaxis],
            class_name=class_name,
            size=size,
            points={"centre": 0},
            # of the box of uniform density with the same second moments, m b²/12 each
            corners=box_corners(
                np.sqrt(12.0 * np.diag(mass_matrix)[1:].clip(0.0) / mass_matrix[0, 0])
            ),
            name=name,
        )

    def closest(self, position: Array) -> MaterialPoint:
        """Material point at any position, with the axes of the body.

        Args:
            position: Position in the reference configuration, shape (3,).
        """
        H = self.frames[0]
        offset = np.vstack([H[1:] @ (position - H[0]), np.eye(3)])
        name = ", ".join(f"{component:g}" for component in position)
        return MaterialPoint(0, f"at ({name})", at_node(0, offset))


class RigidBody(Body):
    """Rigid body with its frame at the centre of mass.

    It moves on R³×SO(3) by default, which is more accurate for free flight and spin; SE(3) is more
    accurate for rotation about a fixed axis (docs/measured/groups.md).

    ``point("centre")`` is the centre of mass, ``point((x, y, z))`` the material point at a
    position, with the axes of the body. :meth:`box`, :meth:`ball` and :meth:`cylinder` know their
    inertia.

    Example:
        >>> wheel = fl.RigidBody(2.0, (0.1, 0.1, 0.2), position=(1, 0, 0))
        >>> wheel.add_velocity(omega=(0, 0, 3), about=(0, 0, 0))
        >>> wheel.velocities.round(12)
        array([[0., 3., 0., 0., 0., 3.]])
    """

    model: RigidBodyModel

    def __init__(
        self,
        mass: float,
        inertia: npt.ArrayLike,
        position: npt.ArrayLike = (0.0, 0.0, 0.0),
        rotation: npt.ArrayLike | None = None,
        *,
        name: str = "",
    ) -> None:
        """Create the body at rest.

        Args:
            mass: Mass.
            inertia: Inertia tensor about the centre of mass in the body's axes, shape (3, 3), or
                its three principal values, mass times length squared.
            position: Centre of mass, global components.
            rotation: Body axes as columns, shape (3, 3); default: global axes.
            name: Name in messages and results.

        Raises:
            ValueError: The mass is not positive, no body can have the inertia, or ``rotation`` is
                not a rotation matrix.
        """
        tensor = numbers(inertia, "inertia")
        tensor = np.diag(tensor) if tensor.shape == (3,) else tensor
        mass_matrix = director_mass_matrix(mass, tensor)
        R = np.eye(3) if rotation is None else rotation_matrix(rotation, "rotation")
        frame = lie.frame(vector(position, 3, "position"), R)
        # radius of gyration: the only length that a rigid body has
        size = float(np.sqrt(np.trace(tensor) / mass))
        super().__init__(RigidBodyModel(frame, mass_matrix, size, type(self).__name__, name))

    @classmethod
    def box(
        cls,
        mass: float,
        edges: npt.ArrayLike,
        position: npt.ArrayLike = (0.0, 0.0, 0.0),
        rotation: npt.ArrayLike | None = None,
        *,
        name: str = "",
    ) -> RigidBody:
        """Box of uniform density.

        Args:
            mass: Mass.
            edges: Lengths of its edges along its axes, shape (3,).
            position: Its centre, global components.
            rotation: Its axes as columns, shape (3, 3); default: global axes.
            name: Name in messages and results.

        Raises:
            ValueError: The mass or an edge is not positive, or ``rotation`` is not a rotation
                matrix.
        """
        squares = np.array([positive(edge, "an edge") for edge in vector(edges, 3, "edges")]) ** 2
        return cls(mass, mass / 12.0 * (squares.sum() - squares), position, rotation, name=name)

    @classmethod
    def ball(
        cls,
        mass: float,
        radius: float,
        position: npt.ArrayLike = (0.0, 0.0, 0.0),
        rotation: npt.ArrayLike | None = None,
        *,
        name: str = "",
    ) -> RigidBody:
        """Ball of uniform density.

        Args:
            mass: Mass.
            radius: Radius.
            position: Its centre, global components.
            rotation: Its axes as columns, shape (3, 3); default: global axes.
            name: Name in messages and results.

        Raises:
            ValueError: Mass or radius is not positive, or ``rotation`` is not a rotation matrix.
        """
        moment = 0.4 * mass * positive(radius, "radius") ** 2
        body = cls(mass, (moment, moment, moment), position, rotation, name=name)
        body.model.corners = radius * _SPHERE
        return body

    @classmethod
    def cylinder(
        cls,
        mass: float,
        radius: float,
        start: npt.ArrayLike,
        end: npt.ArrayLike,
        *,
        name: str = "",
    ) -> RigidBody:
        """Cylinder of uniform density: a rod, a shaft or, if it is short, a disc.

        Its first axis e₁ points from ``start`` to ``end``.

        Args:
            mass: Mass.
            radius: Radius.
            start: Centre of the first face, global components.
            end: Centre of the other face, global components.
            name: Name in messages and results.

        Raises:
            ValueError: Mass or radius is not positive, or start and end coincide.

        Example:
            >>> rod = fl.RigidBody.cylinder(0.2, 0.01, start=(0, 0, 0), end=(1, 0, 0))
            >>> hinge = fl.joints.Revolute(fl.ground(), rod.point((0, 0, 0)), axis=(0, 1, 0))
            >>> hinge.frame()[0]
            array([0., 0., 0.])
        """
        a, b = vector(start, 3, "start"), vector(end, 3, "end")
        e1, r = direction(b - a, "the axis from start to end"), positive(radius, "radius")
        e2 = np.cross(e1, np.eye(3)[np.abs(e1).argmin()])
        e2 /= np.linalg.norm(e2)
        across = mass * (r**2 / 4.0 + float((b - a) @ (b - a)) / 12.0)
        R = np.column_stack([e1, e2, np.cross(e1, e2)])
        body = cls(mass, (mass * r**2 / 2.0, across, across), 0.5 * (a + b), R, name=name)
        half = 0.5 * float(np.linalg.norm(b - a))
        body.model.corners = np.vstack([(x, r, r) * _DISC for x in (-half, half)])
        return body
