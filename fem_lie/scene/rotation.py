"""Steady rotation: bodies that rotate at a constant rate are at rest in a rotating frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices, vector
from fem_lie.lie.node_types import rigid_motions
from fem_lie.scene.load import NodalLoad
from fem_lie.scene.scene import Scene, require_scene

_PARALLEL = 1e-9


@dataclass(frozen=True, eq=False)
class Rotation:
    """Constant angular velocity about an axis fixed in space.

    Attributes:
        spin: Angular velocity, global components, rad per time, shape (3,).
        about: Point on the axis, shape (3,).
    """

    spin: Array
    about: Array

    @classmethod
    def of(cls, spin: npt.ArrayLike, about: npt.ArrayLike) -> Rotation:
        """Rotation from the arguments of the user.

        Raises:
            ValueError: An argument is not three finite numbers.
        """
        return cls(vector(spin, 3, "spin"), vector(about, 3, "about"))

    def __bool__(self) -> bool:
        """Whether the angular velocity is not zero."""
        return bool(self.spin.any())

    def velocities(self, kinds: Indices, H: Array, factor: float = 1.0) -> Array:
        """Nodal velocities at ``factor`` times the rate, in the nodal axes, shape (n, 6)."""
        turns = rigid_motions(kinds, H, self.about)[:, :, 3:]
        return np.asarray(turns @ (factor * self.spin))

    def check(self, scene: Scene) -> None:
        """Raise ``ValueError`` if a load fixed in space rotates in the rotating frame.

        Nodes without frames are refused as well: the components of their velocities are not
        constant.
        """
        require_scene(scene)
        if not self:
            return
        for body in scene.bodies:
            body.model.require_frames("a steady rotation")
        self._check_parallel("gravity", scene.gravity)
        for number, load in enumerate(scene.loads, start=1):
            if isinstance(load, NodalLoad) and not load.following:
                nodal = load.nodal().reshape(-1, 2, 3)
                self._check_parallel(f"load {number}, on {load.body.label},", nodal)

    def _check_parallel(self, what: str, vectors: Array) -> None:
        axis = self.spin / np.linalg.norm(self.spin)
        if (np.abs(np.cross(axis, vectors)) > _PARALLEL * np.abs(vectors).max()).any():
            raise ValueError(
                f"{what} is fixed in space and must be parallel to the spin {self.spin}: it "
                "rotates in the rotating frame, so there is no equilibrium. For loads that "
                "rotate with the bodies take following=True"
            )
