"""Supports of thin shells: clamps, hinges, planes of symmetry, rollers.

Where positions are held along an edge, their derivative along it is held, too. Constraints are
along the axes of a point, which then do not rotate.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Flags, Indices, direction
from fem_lie.bodies.body import Body, Point
from fem_lie.bodies.model import BodyModel
from fem_lie.lie.node_types import NodeType, set_all_axes
from fem_lie.mesh.bicubic.patch_coupling import Edge

_AGREE = 1e-9
_ACROSS = 1e-6  # components of slopes that are meant to be normal to a plane

_KINDS = np.array([int(NodeType.SURFACE_GRADIENT), int(NodeType.MIXED_DERIVATIVE)])

PLACE, ALONG_A, ALONG_B, MIXED = range(4)
"""Vectors of a point: position, surface gradients along a and b, mixed derivative or director."""

_HALVES = ((0, 0), (0, 1), (1, 1), (1, 0))
"""Of each vector: 1 if the second node of the point has it, and its index in that node."""


class HeldSurfaceModel(BodyModel):
    """Model of a body of points with positions and surface gradients.

    Attributes:
        points_count: Number of points; their second nodes come after all first nodes.
        has_thickness_director: Whether the fourth vector of a point is a director across the
            thickness, and not the mixed derivative.
    """

    points_count: int
    has_thickness_director: ClassVar[bool] = False
    _edges: dict[str, Edge]

    def edge(self, name: str) -> Edge:
        """Edge, or corner as an edge of one point.

        Args:
            name: Name of an edge or corner.

        Raises:
            ValueError: There is no such edge; the message lists what exists.
        """
        if name in self._edges:
            return self._edges[name]
        if name in self.point_names:
            none = np.empty(0, dtype=np.int64)
            return Edge(np.array([self.point_names[name]]), -1, none, 0)
        known = ", ".join([*self._edges, *self.point_names])
        raise ValueError(f"{self.label} has no edge or corner {name!r}; it has: {known}")

    def nodes(self, where: str) -> Indices:
        """Numbers of the points of an edge or corner.

        Args:
            where: Name of an edge or corner.
        """
        return self.edge(where).points

    def axes_are_held(self) -> Flags:
        """Mask of the points with held components along their axes, shape (n,)."""
        found = self.held.reshape(2, self.points_count, 2, 3).sum(axis=-1) % 3 > 0
        return np.asarray(found[0].any(axis=1) | found[1].any(axis=1))

    def constraints(self, point: int, vector: int) -> Flags:
        """View of the constraints of a vector of a point, shape (3,).

        Args:
            point: Number of the point.
            vector: Index of the vector.
        """
        second, half = _HALVES[vector]
        return self.held[point + second * self.points_count, 3 * half : 3 * half + 3]

    def axis_along(self, point: int, n: Array, name: str) -> int:
        """Index of the axis of a point along ``n``; its axes are rotated if there is none.

        Args:
            point: Number of the point.
            n: Unit vector, shape (3,).
            name: Name of the edge, for messages.

        Raises:
            ValueError: The point is held along directions neither parallel nor perpendicular.
        """
        first, second = point, point + self.points_count
        coordinates = self.frames[first]
        axes = np.array([np.cross(coordinates[2], coordinates[3]), coordinates[2], coordinates[3]])
        found = np.flatnonzero(np.abs(axes @ n) > 1.0 - _AGREE)
        if len(found):
            return int(found[0])
        held = np.array([self.constraints(point, k) for k in range(4)])
        used = np.asarray(held[held.sum(axis=1) % 3 > 0].any(axis=0)).reshape(3)
        if np.abs(axes[used] @ n).max(initial=0.0) > _AGREE:
            raise ValueError(
                f"{name!r} of {self.label}: the point at {coordinates[0]} is held along "
                f"{axes[used].tolist()} already, neither parallel nor perpendicular to "
                f"{n.tolist()}"
            )
        free = np.flatnonzero(~used)
        axis = int(free[np.abs(axes[free] @ n).argmax()])
        one, last = (axis + 1) % 3, (axis + 2) % 3
        if used[last] or (not used[one] and abs(axes[last] @ n) < abs(axes[one] @ n)):
            one, last = last, one
        # the axis that is used, or closer to perpendicular, changes least
        new = np.empty((3, 3))
        new[axis] = n * np.sign(axes[axis] @ n)
        new[one] = axes[one] - (axes[one] @ n) * n
        new[one] /= np.linalg.norm(new[one])
        new[last] = np.cross(new[(last + 1) % 3], new[(last + 2) % 3])
        both = self.frames[[first, second]]
        set_all_axes(_KINDS, both, np.array([new, new]))
        self.frames[[first, second]] = both
        return axis

    def check_symmetry(self, edge: Edge, n: Array, name: str) -> None:
        """Raise ``ValueError`` unless an edge is on a plane of symmetry.

        Args:
            edge: The edge.
            n: Unit normal of the plane, shape (3,).
            name: Name of the edge, for messages.
        """
        if edge.along < 0:
            raise ValueError(f"a plane of symmetry needs an edge of {self.label}, got {name!r}")
        across = ALONG_B - edge.along
        x, coordinates = self.frames[edge.points], self.frames[edge.points + self.points_count]
        slopes = x[:, 1] if across == ALONG_A else coordinates[:, 2]
        sizes = np.linalg.norm(slopes, axis=1)
        skew = np.linalg.norm(np.cross(slopes, n), axis=1) / sizes
        height = np.ptp(x[:, 0] @ n)
        if height > _ACROSS * self.size or skew.max() > _ACROSS:
            raise ValueError(
                f"{name!r} of {self.label} is not on a plane of symmetry with the normal {n}: "
                f"positions vary by {height:.2e} along it, and the sine between it and the "
                f"parameter lines that end there is up to {skew.max():.2e}"
            )


class HeldSurface(Body):
    """Body of points with positions and surface gradients, and its supports."""

    model: HeldSurfaceModel

    def clamp(self, name: str) -> list[Point]:
        """Hold positions and normals of an edge or corner; strains across the edge stay free.

        Args:
            name: Name of an edge or corner.

        Returns:
            Held points, for :meth:`fem_lie.Result.reaction`.

        Raises:
            ValueError: There is no such edge; the message lists what exists.
        """
        model, edge = self.model, self.model.edge(name)
        for point in map(int, edge.points):
            slopes = model.frames[point, 1], model.frames[point + model.points_count, 2]
            n = direction(np.cross(*slopes), f"the normal of {self.label}")
            axis = model.axis_along(point, n, name)
            model.constraints(point, PLACE)[:] = True
            for k in (ALONG_A, ALONG_B, MIXED):
                if k == ALONG_A + edge.along:
                    model.constraints(point, k)[:] = True
                elif k == MIXED and model.has_thickness_director:
                    model.constraints(point, k)[np.arange(3) != axis] = True
                elif not model.has_thickness_director and (k != MIXED or edge.along >= 0):
                    model.constraints(point, k)[axis] = True
        return self.points(name)

    def hinge(self, name: str) -> list[Point]:
        """Hold the positions of an edge or corner, not the normals.

        Args:
            name: Name of an edge or corner.

        Returns:
            Held points, for :meth:`fem_lie.Result.reaction`.

        Raises:
            ValueError: There is no such edge; the message lists what exists.
        """
        model, edge = self.model, self.model.edge(name)
        for point in edge.points:
            model.constraints(point, PLACE)[:] = True
            if edge.along >= 0:
                model.constraints(point, ALONG_A + edge.along)[:] = True
        return self.points(name)

    def roller(self, name: str, normal: npt.ArrayLike) -> list[Point]:
        """Hold displacements of an edge or corner along a direction fixed in space.

        Two rollers along the same edge are a diaphragm.

        Args:
            name: Name of the edge or corner.
            normal: The direction, global components.

        Returns:
            Held points, for :meth:`fem_lie.Result.reaction`.

        Raises:
            ValueError: There is no such edge, the direction is zero, or a point is held along
                directions that are neither parallel nor perpendicular to it.
        """
        model, edge = self.model, self.model.edge(name)
        n = direction(normal, f"the direction of roller {name!r}")
        for point in edge.points:
            axis = model.axis_along(int(point), n, name)
            model.constraints(point, PLACE)[axis] = True
            if edge.along >= 0:
                model.constraints(point, ALONG_A + edge.along)[axis] = True
        return self.points(name)

    def symmetry(self, name: str, normal: npt.ArrayLike) -> list[Point]:
        """Hold an edge on a plane of symmetry: the surface continues as its mirror image.

        Args:
            name: Name of the edge.
            normal: Normal of the plane, global components.

        Returns:
            Held points, for :meth:`fem_lie.Result.reaction`.

        Raises:
            ValueError: There is no such edge, it is not in a plane with that normal, or the
                parameter lines that end on it are not normal to the plane.
        """
        for point, axis in self._mirrored(name, normal, "symmetry"):
            self.model.constraints(point, PLACE)[axis] = True
        return self.points(name)

    def guided(self, name: str, normal: npt.ArrayLike) -> list[Point]:
        """Hold the slopes of :meth:`symmetry`, not the positions along the normal.

        The points of the edge slide along the normal, each by itself; joints
        :class:`~fem_lie.joints.InPlane` to a rigid body let them stay in one plane.

        Args:
            name: Name of the edge.
            normal: Normal of the plane in which the edge is at the start, global components.

        Returns:
            The points, for joints.

        Raises:
            ValueError: As for :meth:`symmetry`.
        """
        self._mirrored(name, normal, "guided")
        return self.points(name)

    def _mirrored(self, name: str, normal: npt.ArrayLike, what: str) -> list[tuple[int, int]]:
        """Hold slopes that a mirror image reverses; points, and the components along the normal."""
        model, edge, found = self.model, self.model.edge(name), []
        n = direction(normal, f"the normal of {what} {name!r}")
        model.check_symmetry(edge, n, name)
        for point in map(int, edge.points):
            axis = model.axis_along(point, n, name)
            others = np.arange(3) != axis
            model.constraints(point, ALONG_A + edge.along)[axis] = True
            model.constraints(point, ALONG_B - edge.along)[others] = True
            model.constraints(point, MIXED)[~others if model.has_thickness_director else others] = (
                True
            )
            found.append((point, axis))
        return found
