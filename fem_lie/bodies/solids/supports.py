"""Supports of solids: faces, curves and points that are held, whole or along a direction."""

from __future__ import annotations

from abc import abstractmethod

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices, direction
from fem_lie.bodies.body import Body, Point

_SAME = 1e-9  # sine, as of directions that are meant to be equal


class SupportedSolid(Body):
    """A body whose nodes are places."""

    @abstractmethod
    def nodes(self, where: str) -> Indices:
        """Numbers of the nodes of a named part."""

    def clamp(self, name: str) -> list[Point]:
        """Hold all nodes of a named face, curve, point or group of cells.

        Returns:
            The points that are held, for :meth:`fem_lie.Result.reaction`.

        Raises:
            ValueError: There is nothing of this name; the message lists what exists.
        """
        self.held[self.nodes(name), :3] = True
        return self.points(name)

    def roller(self, name: str, normal: npt.ArrayLike) -> list[Point]:
        """Hold displacements along a direction fixed in space, as on a plane of symmetry.

        The nodes' axes are turned so that one is that direction, and stay so. What is held already
        stays held.

        Args:
            name: A named face, curve, point or group of cells.
            normal: The direction, global components.

        Returns:
            The points that are held, for :meth:`fem_lie.Result.reaction`.

        Raises:
            ValueError: There is nothing of this name, or the direction is zero.
        """
        n = direction(normal, f"the direction of roller {name!r}")
        for node in self.nodes(name):
            self._hold_along(int(node), n)
        return self.points(name)

    def _hold_along(self, node: int, along: Array) -> None:
        held, axes = self.held[node, :3], self.frames[node, 1:]
        before = axes[held]
        rest = along - before.T @ (before @ along)
        size = np.linalg.norm(rest)
        if size <= _SAME:
            return
        rest /= size
        free = axes[~held]
        match = np.abs(free @ rest)
        if match.max() < 1.0 - _SAME:
            free = _beside(np.vstack([before, rest]))
            known = np.vstack([before, rest])
            turned = np.vstack([known, free])
            turned[2] *= np.sign(np.linalg.det(turned))
            velocity = axes.T @ self.velocities[node, :3]
            self.frames[node, 1:] = turned
            self.velocities[node, :3] = turned @ velocity
            held[:] = np.arange(3) < len(known)
            return
        held[np.flatnonzero(~held)[match.argmax()]] = True


def _beside(known: Array) -> Array:
    """Unit vectors across some that are across each other, shape (3 − k, 3)."""
    return np.asarray(np.linalg.svd(known)[2][len(known) :])
