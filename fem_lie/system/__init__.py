"""The equations of a scene: residual, tangent matrix and invariants."""

from fem_lie.system.system import System

__all__ = ["System"]
