"""Ties: faces of two solids with different meshes that move together."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from fem_lie._arrays import flag, instance, text
from fem_lie.bodies.body import Point
from fem_lie.bodies.solids.solid import Solid
from fem_lie.contact.mortar.face_segments import Face, mortar_matrices
from fem_lie.joints.connection import Connection, ConstraintDefinition, TieDefinition

_DISTANCE = 1e-6
"""Largest distance of the faces over the size of the smaller solid."""


@dataclass(frozen=True, eq=False)
class Tie(Connection):
    """Faces of two solids, meshed independently, are glued: a mortar tie.

    The displacements of both faces agree in the mean, with a weight for each corner of the facets
    of the first face: ``∫ Φ_i (x₁ − x₂) dA = 0``. A state of constant stress passes the face
    exactly, whatever the meshes are. Facets may be triangles or quadrilaterals of either degree.
    The constraints are linear in nodal positions; they hold for any rotation, do no work, and have
    multipliers without resultant and moment, so that conserving schemes conserve momenta.

    The faces must lie on each other up to 1e-6 of the size of the smaller solid, so that they are
    plane, or have facets with the same nodes; and the first one within the second. If it may be
    either, the finer face comes first. Corners of the first face that a support holds have no
    multiplier along the held direction; their weight is added to that of adjacent corners. If
    further constraints hold them (several ties that meet in an edge, a coupling), redundant ones
    are treated as those of joints: :class:`~fem_lie.joints.RedundantConstraints`.

    Results report force and moment that the second face exerts on the first, global components,
    about the corner of the first face that is closest to its centre.

    Attributes:
        first: Solid whose facets have the multipliers.
        first_face: Name of its face.
        second: The other solid.
        second_face: Name of its face.
        name: Name in messages and results; default: class name and faces.
        active: Whether it acts from the start; :class:`~fem_lie.schemes.Lock` and
            :class:`~fem_lie.schemes.Release` switch it.

    Example:
        >>> rubber = fl.sections.NeoHooke(E=1e6, nu=0.3, density=1100.0)
        >>> left = fl.Solid.brick((0.1, 0.1, 0.1), rubber, cells=(3, 3, 3), name="left")
        >>> right = fl.Solid.brick(
        ...     (0.1, 0.1, 0.1), rubber, cells=(2, 2, 2), origin=(0.1, 0, 0), name="right"
        ... )
        >>> _ = left.clamp("a=0")
        >>> scene = fl.Scene()
        >>> for body in (left, right):
        ...     _ = scene.add(body)
        ...
        >>> _ = scene.add(fl.loads.FaceLoad(right, "a=1", force=(0.0, 0.0, -100.0)))
        >>> glue = scene.add(fl.joints.Tie(left, "a=1", right, "a=0"))
        >>> force = fl.statics(scene).joint_force(glue, axes="global")[-1, :3]
        >>> print(force.round(6) + 0.0)
        [ 0.  0. -1.]
    """

    first: Solid
    first_face: str
    second: Solid
    second_face: str
    name: str = ""
    active: bool = field(default=True, kw_only=True)

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if an argument has a wrong type."""
        for side in ("first", "second"):
            instance(getattr(self, side), Solid, f"Tie: {side}", "a Solid")
            text(getattr(self, f"{side}_face"), f"Tie: {side}_face")
        text(self.name, "Tie: name")
        flag(self.active, "Tie: active")

    @property
    def label(self) -> str:
        """Name in messages and results."""
        sides = (self.first, self.first_face), (self.second, self.second_face)
        return self.name or f"Tie({', '.join(f'{body.label}.{face}' for body, face in sides)})"

    def check(self) -> None:
        """Raise ``ValueError`` if there is no such face, or the faces do not fit."""
        if self.first is self.second:
            raise ValueError(f"{self.label}: expected faces of two solids, got {self.first.label}")
        self.tie_definition()

    def definitions(self) -> list[ConstraintDefinition]:
        """No constraints between two frames."""
        return []

    def tie_definition(self) -> TieDefinition:
        """The weights of all nodes."""
        return self._definition

    @cached_property
    def _definition(self) -> TieDefinition:
        first, second = (
            Face(body.model.facets(name), body.model.positions, f"{body.label}.{name}")
            for body, name in ((self.first, self.first_face), (self.second, self.second_face))
        )
        sizes = [body.model.size for body in (self.first, self.second)]
        try:
            found = mortar_matrices(first, second, _DISTANCE * min(sizes))
        except ValueError as error:
            raise ValueError(f"{self.label}: {error}") from None
        pairs = first.corners[:, :, np.newaxis], first.corners[:, np.newaxis]
        edges = np.stack(np.broadcast_arrays(*pairs), axis=-1).reshape(-1, 2)
        edges = np.unique(edges[edges[:, 0] != edges[:, 1]], axis=0)
        return TieDefinition(
            self.first,
            self.second,
            found.nodes,
            np.searchsorted(found.nodes, edges),
            found.first,
            found.second,
            found.areas,
        )

    @property
    def points(self) -> list[Point]:
        """All nodes of both faces."""
        sides = (self.first, self.first_face), (self.second, self.second_face)
        return [point for body, face in sides for point in body.points(face)]
