"""Supports of surfaces: clamps, hinges, planes of symmetry, and directions held in space.

They are written on the nodes that bear the numbers of the mesh's points; where a surface has a kink
or branches, the other nodes of a point follow these.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices, direction
from fem_lie.bodies.body import Body, Point
from fem_lie.bodies.shells.surface_nodes import SurfaceNodes


class SupportedSurface(Body):
    """Body on a surface mesh with supports along named curves, groups of cells and points."""

    model: SurfaceNodes

    def clamp(self, name: str) -> list[Point]:
        """Hold positions and directors of a named curve, group of cells or group of points.

        Args:
            name: Name of a curve, group of cells or group of points.

        Returns:
            Held points, for :meth:`fem_lie.Result.reaction`.

        Raises:
            ValueError: There is no such set; the message lists what exists.
        """
        self.model.held[self.nodes(name)] = True
        return self.points(name)

    def hinge(self, name: str, *, axis: npt.ArrayLike | None = None) -> list[Point]:
        """Hold positions of a named curve or group; directors rotate freely, or about an axis.

        Along a straight edge a hinge without an axis is a soft simple support, and one whose axis
        is the edge is a hard one: directors do not tilt along the edge. Where two such edges meet,
        directors are fixed.

        Args:
            name: Name of a curve, group of cells or group of points.
            axis: Axis about which directors rotate, global components, perpendicular to them;
                default: any.

        Returns:
            Held points, for :meth:`fem_lie.Result.reaction`.

        Raises:
            ValueError: There is no such set (the message lists what exists), or directors are not
                perpendicular to the axis.
        """
        if axis is not None:
            self._rotate_about(name, axis, "hinge")
        self.model.held[self.nodes(name), :3] = True
        return self.points(name)

    def _rotate_about(self, name: str, axis: npt.ArrayLike, what: str) -> None:
        """Let directors of the nodes rotate about an axis only."""
        nodes, n = self.nodes(name), direction(axis, f"the axis of {what} {name!r}")
        along = np.abs(self.model.frames[np.isin(self.model.masters, nodes), 3] @ n)
        if along.max() > 1e-6:
            raise ValueError(
                f"directors of {name!r} of {self.label} have components up to {along.max():.2e} "
                f"along the axis {n} of {what}; expected an axis perpendicular to them, such as "
                "the direction of a straight edge"
            )
        for node in nodes:
            self.model.hold_axis(int(node), n)

    def symmetry(self, name: str, normal: npt.ArrayLike) -> list[Point]:
        """Hold the nodes of a named curve on a plane of symmetry.

        Nodal frames are rotated about their directors until e₁, or e₂ where two planes meet, is the
        normal. The nodes have no translation along it and no rotation of the director out of the
        plane, exactly in every state.

        Args:
            name: A named curve or group.
            normal: Normal of the plane, global components.

        Returns:
            Held points, for :meth:`fem_lie.Result.reaction`.

        Raises:
            ValueError: There is no such set, the nodes are not in one plane with that normal, a
                director is not in that plane, or a node is on planes that are not perpendicular to
                each other.
        """
        nodes, n = self._in_plane(name, normal, "symmetry")
        for node in nodes:
            self.model.hold_rotations(int(node), n)
            self.model.hold_normal(int(node), n)
        return self.points(name)

    def guided(self, name: str, normal: npt.ArrayLike) -> list[Point]:
        """Hold the rotations of :meth:`symmetry`, not the translation along the normal.

        The nodes slide along the normal, each by itself; joints :class:`~fem_lie.joints.InPlane` to
        a rigid body let them stay in one plane.

        Args:
            name: A named curve or group.
            normal: Normal of the plane in which the nodes are at the start, global components.

        Returns:
            The points, for joints.

        Raises:
            ValueError: As for :meth:`symmetry`.
        """
        nodes, n = self._in_plane(name, normal, "guided")
        for node in nodes:
            self.model.hold_rotations(int(node), n)
        return self.points(name)

    def _in_plane(self, name: str, normal: npt.ArrayLike, what: str) -> tuple[Indices, Array]:
        """Nodes that are in one plane with their directors, and the unit normal of the plane."""
        nodes, n = self.nodes(name), direction(normal, f"the normal of {what} {name!r}")
        model = self.model
        all_sides = np.isin(model.masters, nodes)
        heights, tilts = model.frames[nodes, 0] @ n, model.frames[all_sides, 3] @ n
        if np.ptp(heights) > 1e-6 * model.size or np.abs(tilts).max() > 1e-6:
            raise ValueError(
                f"{name!r} of {self.label} is not on a plane of symmetry with the normal {n}: "
                f"positions vary by {np.ptp(heights):.2e} along it, directors by "
                f"{np.abs(tilts).max():.2e}; give the normal of its plane, and on curved surfaces "
                "an exact director"
            )
        return nodes, n

    def roller(
        self, name: str, normal: npt.ArrayLike, *, axis: npt.ArrayLike | None = None
    ) -> list[Point]:
        """Hold displacements along a direction fixed in space.

        Two rollers at the same nodes are a diaphragm. Constraints of earlier calls remain.

        Args:
            name: A named point, curve or group.
            normal: The direction, global components.
            axis: Axis about which directors rotate, as for :meth:`hinge`; default: any.

        Returns:
            Held points, for :meth:`fem_lie.Result.reaction`.

        Raises:
            ValueError: There is no such set, the direction is zero, or directors are not
                perpendicular to the axis.
        """
        if axis is not None:
            self._rotate_about(name, axis, "roller")
        nodes, n = self.nodes(name), direction(normal, f"the direction of roller {name!r}")
        for node in nodes:
            self.model.hold_along(int(node), n)
        return self.points(name)
