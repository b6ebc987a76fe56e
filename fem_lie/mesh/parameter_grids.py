"""Points at equal steps of the parameters of surfaces and volumes, whose ends may be joined."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import product

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices, points_of, text

PARAMETERS = "abc"
"""Names of parameters, in order."""

_LEAST = 3
"""Least number of cells around: two would have two common edges."""

_SAME = 1e-9
"""Distance of ends that are one, over the size of the mesh."""


class ParameterGrid:
    """Points ``(i/n, j/m, …)``; along closed parameters the last is the first one.

    Attributes:
        number: Number of the point at each step of the parameters.
        parameters: Parameters of each point, shape (points, parameters).
        open: Indices of the parameters that are not closed.
    """

    def __init__(self, cells: Sequence[int], degree: int, closed: str) -> None:
        """Number the points.

        Args:
            cells: Number of cells along each parameter.
            degree: Steps within a cell.
            closed: Names of the closed parameters.

        Raises:
            ValueError: There is no such parameter, or it has less than three cells.
        """
        text(closed, "closed")
        self._closed, self._names = closed, PARAMETERS[: len(cells)]
        if not set(closed) <= set(self._names):
            raise ValueError(
                f"closed: expected parameters whose ends meet, of {', '.join(self._names)}, such "
                f"as 'a', got {closed!r}"
            )
        for name, count in zip(self._names, cells, strict=True):
            if name in closed and count < _LEAST:
                raise ValueError(
                    f"closed={closed!r}: expected three cells or more along {name}, got {count}"
                )
        joins = [int(name in closed) for name in self._names]
        steps = [degree * count for count in cells]
        shape = [step + 1 - join for step, join in zip(steps, joins, strict=True)]
        inner = np.arange(np.prod(shape)).reshape(shape)
        self.number: Indices = np.pad(inner, [(0, join) for join in joins], mode="wrap")
        self.parameters: Array = np.indices(shape).reshape(len(cells), -1).T / steps
        self.open = [k for k, join in enumerate(joins) if not join]

    def points(self, function: Callable[..., npt.ArrayLike]) -> Array:
        """Positions of the points, shape (points, 3).

        Args:
            function: Position at given parameters, shape (3,).

        Raises:
            ValueError: Closed ends do not meet, or positions are not finite.
        """
        found = _positions(function, self.parameters)
        size = float(np.linalg.norm(np.ptp(found, axis=0)))
        for k, name in enumerate(self._names):
            if k in self.open:
                continue
            first = self.parameters[:, k] == 0.0
            last = self.parameters[first]
            last[:, k] = 1.0
            gap = float(np.linalg.norm(_positions(function, last) - found[first], axis=1).max())
            if not gap <= _SAME * size:
                raise ValueError(
                    f"closed={self._closed!r}: expected the points at {name}=1 to be those at "
                    f"{name}=0, got points with a distance of {gap:.3g}"
                )
        return found

    @property
    def corners(self) -> dict[str, Indices]:
        """Points at the ends of all parameters: "00", "10" and so on; closed ones begin only."""
        ends = [(0, 1) if k in self.open else (0,) for k in range(len(self._names))]
        return {
            "".join(map(str, at)): np.atleast_1d(self.number[tuple(-i for i in at)])
            for at in product(*ends)
        }


def _positions(function: Callable[..., npt.ArrayLike], parameters: Array) -> Array:
    return points_of([function(*map(float, each)) for each in parameters])
