"""Supports of surfaces: clamps, hinges, planes of symmetry, and directions held in space.

They are written on the nodes that bear the numbers of the mesh's points; where a surface has a kink
or branches, the other nodes of a place follow these.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices, direction
from fem_lie.bodies.body import Body, Point
from fem_lie.mesh.surfaces import SurfaceMesh


class SupportedSurface(Body):
    """Body on a surface mesh with third directors that are normal to it, or nearly so.

    Attributes:
        mesh: Surface mesh; its points are the first nodes of the body.
    """

    mesh: SurfaceMesh

    def nodes(self, where: str) -> Indices:
        """Numbers of the nodes of a named curve, group of cells or group of points.

        Where the surface has a kink or branches, one node stands for all at a position: the others
        are rigidly attached to it.

        Args:
            where: Name of the point, curve, face or group.
        """
        return self.mesh.nodes(where)

    def clamp(self, name: str) -> list[Point]:
        """Hold positions and directors of a named curve, group of cells or group of points.

        Args:
            name: Name of a curve, group of cells or group of points.

        Returns:
            Held points, for :meth:`fem_lie.Result.reaction`.

        Raises:
            ValueError: There is no such set; the message lists what exists.
        """
        self.held[self.nodes(name)] = True
        return self.points(name)

    def hinge(self, name: str) -> list[Point]:
        """Hold positions, not directors, of a named curve or group.

        Args:
            name: Name of a curve, group of cells or group of points.

        Returns:
            Held points, for :meth:`fem_lie.Result.reaction`.

        Raises:
            ValueError: There is no such set; the message lists what exists.
        """
        self.held[self.nodes(name), :3] = True
        return self.points(name)

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
        nodes, n = self.nodes(name), direction(normal, f"the normal of symmetry {name!r}")
        all_sides = np.isin(self.masters, nodes)
        heights, tilts = self.frames[nodes, 0] @ n, self.frames[all_sides, 3] @ n
        if np.ptp(heights) > 1e-6 * self.size or np.abs(tilts).max() > 1e-6:
            raise ValueError(
                f"{name!r} of {self.label} is not on a plane of symmetry with the normal {n}: "
                f"positions vary by {np.ptp(heights):.2e} along it, directors by "
                f"{np.abs(tilts).max():.2e}; give an exact director"
            )
        for node in nodes:
            self._bind(int(node), n)
        return self.points(name)

    def roller(self, name: str, normal: npt.ArrayLike) -> list[Point]:
        """Hold displacements along a direction fixed in space; directors stay free.

        Two rollers at the same nodes are a diaphragm. Constraints of earlier calls remain.

        Args:
            name: A named point, curve or group.
            normal: The direction, global components.

        Returns:
            Held points, for :meth:`fem_lie.Result.reaction`.

        Raises:
            ValueError: There is no such set, or the direction is zero.
        """
        nodes, n = self.nodes(name), direction(normal, f"the direction of roller {name!r}")
        for node in nodes:
            self._hold_along(int(node), n)
        return self.points(name)

    def _hold_along(self, node: int, along: Array) -> None:
        """Hold one more translation of a node, along axes that are fixed in space."""
        held, axes = self.held[node], self.supports[node]
        own = axes if np.isfinite(axes[0, 0]) else self.frames[node, 1:]
        before = own[held[:3]]
        rest = along - before.T @ (before @ along)
        if np.linalg.norm(rest) <= 1e-9:
            return  # already held, as where a diaphragm meets a plane of symmetry
        known = np.vstack([before, rest / np.linalg.norm(rest)])
        # the others are any that are perpendicular
        free = np.linalg.svd(known)[2][len(known) :]
        self.supports[node] = np.vstack([known, free])
        held[:3] = np.arange(3) < len(known)

    def _bind(self, node: int, normal: Array) -> None:
        """Rotate the frame of a node and hold motions out of the plane, drilling included."""
        H, held = self.frames[node], self.held[node]
        if held.all():
            return
        if held[4] and abs(H[2] @ normal) < 1.0 - 1e-6:
            raise ValueError(
                f"node {node} of {self.label} is on planes of symmetry that are not perpendicular"
            )
        tilt = 3 if held[4] else 4
        if tilt == 4:
            # the director stays as it is to the last digit
            e1 = normal - (normal @ H[3]) * H[3]
            H[1] = e1 / np.linalg.norm(e1)
            H[2] = np.cross(H[3], H[1])
        held[tilt] = held[5] = True
        if np.isfinite(self.supports[node, 0, 0]):
            self._hold_along(node, normal)
        else:
            held[4 - tilt] = True
