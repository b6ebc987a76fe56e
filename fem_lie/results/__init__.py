"""Results: histories, equilibria, paths, modes and files."""

from fem_lie.results.history import Result

__all__ = ["Result"]
