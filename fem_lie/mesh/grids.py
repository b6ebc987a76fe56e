"""Surface meshes from functions of two parameters."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import (
    Indices,
    instance,
    points_of,
    whole_number,
)
from fem_lie.mesh.shapes import DEGREES
from fem_lie.mesh.surfaces import SurfaceMesh


def surface(
    function: Callable[[float, float], npt.ArrayLike],
    cells: tuple[int, int],
    *,
    cell: str = "quadrilateral",
    degree: int = 1,
) -> SurfaceMesh:
    """Smooth surface over the unit square ``(a, b)``, cut at equal steps of both parameters.

    Its sides are the curves "a=0", "a=1", "b=0" and "b=1", its corners the points "00", "10", "01"
    and "11". Triangles are two for each square. The normals are those of the cells; give
    :class:`~fem_lie.bodies.shells.shell.Shell` a director where they are known.

    Args:
        function: Point at ``(a, b)``, shape (3,).
        cells: Numbers along a and b.
        cell: ``"quadrilateral"`` or ``"triangle"``.
        degree: 1 or 2.

    Raises:
        ValueError: A cell has no area, or something is out of range.
    """
    if cell not in DEGREES or degree not in (1, 2):
        raise ValueError(
            "wanted cells 'triangle' or 'quadrilateral' of degree 1 or 2, got "
            f"{cell!r} of degree {degree!r}"
        )
    instance(function, Callable, "a surface", "a function of a and b from 0 to 1")
    if not isinstance(cells, Sequence) or len(cells) != 2:
        raise ValueError(f"cells must be two numbers, along a and b, got {cells!r}")
    n, m = (degree * whole_number(count) for count in cells)
    places = [(i / n, j / m) for i in range(n + 1) for j in range(m + 1)]
    number = np.arange(len(places)).reshape(n + 1, m + 1)
    sides = {"a=0": number[0], "a=1": number[-1], "b=0": number[:, 0], "b=1": number[:, -1]}
    return SurfaceMesh.from_cells(
        points_of([function(a, b) for a, b in places]),
        _grid_cells(number, cell, degree),
        cell,
        curves={name: _edges(along, degree) for name, along in sides.items()},
        named_points={f"{i}{j}": np.atleast_1d(number[-i, -j]) for i in (0, 1) for j in (0, 1)},
    )


def _edges(along: Indices, degree: int) -> Indices:
    """Edges of successive points: two ends, and what is between."""
    parts = [along[:-1:degree], along[degree::degree], *([along[1::2]] if degree == 2 else [])]
    return np.column_stack(parts)


def _grid_cells(number: Indices, cell: str, degree: int) -> Indices:
    """Cells on a grid of points, in DOLFINx's order."""
    found = []
    for i in range(0, number.shape[0] - 1, degree):
        for j in range(0, number.shape[1] - 1, degree):
            s = number[i : i + degree + 1, j : j + degree + 1]
            corners = np.array([s[0, 0], s[-1, 0], s[0, -1], s[-1, -1]])
            if cell == "quadrilateral":
                middles = [s[1, 0], s[0, 1], s[-1, 1], s[1, -1], s[1, 1]] if degree == 2 else []
                found.append([*corners, *middles])
                continue
            lower = [s[-1, 1], s[1, 1], s[1, 0]] if degree == 2 else []
            upper = [s[1, -1], s[0, 1], s[1, 1]] if degree == 2 else []
            found.append([*corners[[0, 1, 3]], *lower])
            found.append([*corners[[0, 3, 2]], *upper])
    return np.array(found, dtype=np.int64)
