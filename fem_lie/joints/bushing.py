"""Bushings: springs and dampers of six components between two points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from fem_lie import _arrays, lie
from fem_lie._arrays import Array
from fem_lie.bodies.body import Point
from fem_lie.bodies.points import require_point
from fem_lie.joints.connection import BushingDefinition, Connection, ConstraintDefinition
from fem_lie.sections.section import semidefinite


@dataclass(frozen=True, eq=False)
class Bushing(Connection):
    """Linear spring and damper in all six components of the relative motion of two points.

    Frame A moves with ``a`` and frame B with ``b``. The coordinate is their relative motion ``d =
    log(A⁻¹ B)``: translations and rotations along the screw that joins both frames. With its
    initial value ``d₀``, the force conjugate to it is ``K (d − d₀) + C dd/dt``, and ``½ (d − d₀)·K
    (d − d₀)`` is the energy. A geodesic beam element of length ℓ with section stiffness ``S`` and
    without bending flexibility is a bushing with ``K = S/ℓ`` between its ends.

    :class:`~fem_lie.GeneralisedAlpha`, :class:`~fem_lie.schemes.Variational` and statics take
    bushings, :class:`~fem_lie.Explicit` those without damping; other schemes refuse them. The
    relative rotation must stay below half a turn; as the bearing of a rotor, it carries a light
    body to which a :class:`Revolute` joins the rotor. Results report force and moment on ``a`` in
    the axes of frame A.

    Attributes:
        a: A point of a body, or :func:`~fem_lie.bodies.points.ground`.
        b: A point of another body, or ground.
        stiffness: ``K``: three translational and three rotational values, or a symmetric matrix,
            shape (6, 6); force per length and moment per rad.
        damping: ``C``, as ``stiffness``; default: none.
        at: Initial position of both frames, global components; default: that of each point, and of
            the other point for ground.
        rotation: Initial axes of both frames as columns, shape (3, 3); default: global axes.
        name: Name in messages and results; default: class name and points.

    Example:
        >>> engine = fl.RigidBody(120.0, (4.0, 6.0, 5.0), position=(0, 0, 0.5))
        >>> scene = fl.Scene(gravity=(0, 0, -9.81))
        >>> _ = scene.add(engine)
        >>> mount = scene.add(
        ...     fl.joints.Bushing(
        ...         fl.ground(), engine.point("centre"), (2e5, 2e5, 4e5, 1e3, 1e3, 1e3)
        ...     )
        ... )
        >>> print(f"{1e3 * fl.statics(scene).displacement(engine.point('centre'))[-1, 2]:.3f} mm")
        -2.943 mm
    """

    a: Point
    b: Point
    stiffness: npt.ArrayLike
    damping: npt.ArrayLike | None = None
    at: npt.ArrayLike | None = None
    rotation: npt.ArrayLike | None = None
    name: str = ""

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if an argument has a wrong type."""
        require_point(self.a, "Bushing: a")
        require_point(self.b, "Bushing: b")
        _arrays.text(self.name, "Bushing: name")

    @property
    def label(self) -> str:
        """Name in messages and results."""
        return self.name or f"Bushing({self.a.label}, {self.b.label})"

    @property
    def points(self) -> list[Point]:
        """Points a and b."""
        return [self.a, self.b]

    @property
    def turns(self) -> bool:
        """Whether it depends on rotations of its points: always."""
        return True

    def check(self) -> None:
        """Raise ``ValueError`` if points, matrices or axes are invalid."""
        definition = self.bushing_definition()
        if self.a.same(self.b):
            raise ValueError(f"{self.label} joins a point to itself")
        if not (definition.stiffness.any() or definition.damping.any()):
            raise ValueError(f"{self.label}: expected a stiffness or a damping, got zeros only")

    def definitions(self) -> list[ConstraintDefinition]:
        """No definitions of constraints or springs along coordinates."""
        return []

    def bushing_definition(self) -> BushingDefinition:
        """The frames, the stiffness and the damping."""
        damping = np.zeros(6) if self.damping is None else self.damping
        return BushingDefinition(
            self.a,
            self.b,
            self._frames(),
            self._matrix(self.stiffness, "stiffness"),
            self._matrix(damping, "damping"),
        )

    def _matrix(self, given: npt.ArrayLike, what: str) -> Array:
        what = f"{self.label}: {what}"
        matrix = _arrays.numbers(given, what)
        if matrix.shape not in ((6,), (6, 6)):
            raise ValueError(
                f"{what} must be six values or a matrix of shape (6, 6), got shape {matrix.shape}"
            )
        return semidefinite(np.diag(matrix) if matrix.ndim == 1 else matrix, 6, what)

    def _frames(self) -> tuple[Array, Array]:
        """Frames A and B in the initial configuration."""
        if self.a.is_ground and self.b.is_ground:
            raise ValueError(f"{self.label}: both points are ground; a bushing needs a body")
        axes = np.eye(3)
        if self.rotation is not None:
            axes = _arrays.rotation_matrix(self.rotation, f"{self.label}: rotation")
        if self.at is not None:
            both = lie.frame(_arrays.vector(self.at, 3, f"{self.label}: at"), axes)
            return both, both
        sides = [(self.a, self.b), (self.b, self.a)]
        first, second = (other if point.is_everywhere else point for point, other in sides)
        return lie.frame(first.position, axes), lie.frame(second.position, axes)
