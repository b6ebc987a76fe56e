"""Scenes: bodies, joints, loads, supports and choices."""

from fem_lie.scene.scene import Scene

__all__ = ["Scene"]
