"""States of a scene, whatever found them."""

from __future__ import annotations

from typing import Protocol

from fem_lie._arrays import Array, shown
from fem_lie.bodies.catalogue import SceneInfo


class States(Protocol):
    """Any result with frames: of statics, of paths, of dynamics."""

    @property
    def frames(self) -> Array:
        """Frames of all nodes at all steps, shape (k, N, 4, 3)."""

    @property
    def info(self) -> SceneInfo:
        """Which nodes are those of the body."""


def require_states(value: object) -> None:
    """Raise ``TypeError`` if it is no result of statics, of a path or of dynamics."""
    if not (hasattr(value, "info") and hasattr(value, "frames")):
        raise TypeError(f"wanted is a result of statics, a path or dynamics, got {shown(value)}")
