"""Joints between two frames of beams, rigid bodies and ground.

A joint is its selection of the relative motion ``(Δ, Q)`` that it forbids, see
:mod:`fem_lie.constraints`; a new joint of this kind is a new class with that selection.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from fem_lie._jit import Array
from fem_lie.bodies import Point


def _rows(*entries: dict[int, float]) -> Array:
    """Selection rows from {index in z = (Δ₁ Δ₂ Δ₃ Q₁₁ Q₁₂ … Q₃₃): factor}."""
    rows = np.zeros((len(entries), 12))
    for row, entry in zip(rows, entries, strict=True):
        for index, factor in entry.items():
            row[index] = factor
    return rows


_COINCIDE = ({0: 1.0}, {1: 1.0}, {2: 1.0})
_SAME_AXIS = ({8: -1.0}, {5: 1.0})  # −Q₂₃ = 0, Q₁₃ = 0: moments about e₁ and e₂ of A
_NO_TURN = ({10: 0.5, 8: -0.5}, {5: 0.5, 9: -0.5}, {6: 0.5, 4: -0.5})  # axial(skew Q)


@dataclass(frozen=True, eq=False)
class Joint:
    """What all joints have in common; use one of the subclasses.

    A subclass states its ``selection`` of ``(Δ, Q)``. If it forbids the same with the two sides
    exchanged, a side that does not move by itself becomes B, because the Jacobian on A's side of
    what touches ``Δ`` alone is constant in local frames; otherwise it is not ``reversible``.

    Attributes:
        a: A point of a body, or :func:`~fem_lie.bodies.ground`.
        b: A point of another body, or ground.
        at: Where the joint is in the initial configuration (global, length); default: where the
            two points coincide. Given, the points are joined to it by rigid links.
        axis: Direction of the joint's e₃ in the initial configuration, global components.
        name: How errors and results call it; default: class name and number.
    """

    a: Point
    b: Point
    at: npt.ArrayLike | None = None
    axis: npt.ArrayLike = (0.0, 0.0, 1.0)
    name: str = ""

    selection: ClassVar[Array]
    reversible: ClassVar[bool] = True

    def frame(self) -> Array:
        """The joint's frame in the initial configuration, shape (4, 3).

        Raises:
            ValueError: The points do not coincide and ``at`` is not given, or the axis is zero.
        """
        axis = np.asarray(self.axis, dtype=np.float64)
        if axis.shape != (3,) or not np.isfinite(axis).all() or not axis.any():
            raise ValueError(f"{self.label}: axis must be a non-zero vector of 3, got {self.axis}")
        e3 = axis / np.linalg.norm(axis)
        e1 = np.cross(np.eye(3)[np.argmin(np.abs(e3))], e3)
        e1 /= np.linalg.norm(e1)
        return np.array([self._place(), e1, np.cross(e3, e1), e3])

    @property
    def label(self) -> str:
        """Name for messages: the user's, or the class and what is joined."""
        return self.name or f"{type(self).__name__}({self.a.label}, {self.b.label})"

    def _place(self) -> Array:
        if self.at is not None:
            at = np.asarray(self.at, dtype=np.float64)
            if at.shape != (3,) or not np.isfinite(at).all():
                raise ValueError(f"{self.label}: at must be a point of 3 numbers, got {self.at}")
            return at
        moving = [point for point in (self.a, self.b) if not point.is_ground]
        if not moving:
            raise ValueError(f"{self.label}: both points are ground; a joint needs a body")
        places = [point.position for point in moving]
        size = max(point.size for point in moving)
        gap = np.linalg.norm(places[-1] - places[0])
        if gap > 1e-9 * size:
            raise ValueError(
                f"{self.label}: the points are {gap:g} apart, at {places[0]} and {places[-1]}; "
                "let them coincide, or give at=... to join them there by rigid links"
            )
        return places[0]


class Fixed(Joint):
    """No relative motion."""

    selection = _rows(*_COINCIDE, *_NO_TURN)


class Spherical(Joint):
    """Common point."""

    selection = _rows(*_COINCIDE)


class InPlane(Joint):
    """Point ``b`` stays in the plane through ``a`` with the normal ``axis`` fixed to ``a``.

    Both coincide in the initial configuration. With ground as ``a``: no displacement of ``b`` along
    ``axis``.
    """

    selection = _rows({2: 1.0})
    reversible = False


class Revolute(Joint):
    """Common point and common axis e₃."""

    selection = _rows(*_COINCIDE, *_SAME_AXIS)


@dataclass(frozen=True, eq=False)
class RigidLink:
    """Point ``b`` follows point ``a`` as if both were one rigid body.

    There are no multipliers, no constraint equations and no reported force: the node of ``b`` loses
    its unknowns. :class:`Fixed` is the same with a joint force.

    Attributes:
        a: A point of a body.
        b: A point of this or another body, anywhere.
    """

    a: Point
    b: Point

    def check(self) -> None:
        """Raise ``ValueError`` if a point is ground, or both are the same."""
        if self.a.is_ground or self.b.is_ground:
            raise ValueError("a rigid link needs two points of bodies, got ground; use a Clamp")
        if self.a.body is self.b.body and self.a.node == self.b.node:
            raise ValueError(f"the rigid link joins {self.a.label} to itself")

    @property
    def label(self) -> str:
        """For messages."""
        return f"RigidLink({self.a.label}, {self.b.label})"
