"""Volume meshes from functions of three parameters."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import combinations, product

import dolfinx
import numpy as np
import numpy.typing as npt

from fem_lie import _compat
from fem_lie._arrays import Array, Indices, instance, points_of, whole_number
from fem_lie.mesh.volumes.volume_mesh import VolumeMesh, entities_on

_PARAMETERS = "abc"
_TETRAHEDRA = ((0, 1, 3, 7), (0, 1, 7, 5), (0, 5, 7, 4), (0, 3, 2, 7), (0, 6, 4, 7), (0, 2, 6, 7))
"""Six of a hexahedron, about its diagonal."""


def block(
    function: Callable[[float, float, float], npt.ArrayLike],
    cells: tuple[int, int, int],
    *,
    cell: str = "hexahedron",
) -> VolumeMesh:
    """Volume over the unit cube ``(a, b, c)``, cut at equal steps of the three parameters.

    Its faces are "a=0", "a=1" and so on, its edges the curves "a=0,b=0" and so on, its corners the
    points "000" to "111". Edges of cells are straight; a tetrahedral mesh has six cells for each
    hexahedron.

    Args:
        function: Point at ``(a, b, c)``, shape (3,).
        cells: Numbers along a, b and c.
        cell: ``"hexahedron"`` or ``"tetrahedron"``.

    Raises:
        ValueError: A cell has no volume, or something is out of range.
    """
    if cell not in ("hexahedron", "tetrahedron"):
        raise ValueError(f"wanted cells 'hexahedron' or 'tetrahedron', got {cell!r}")
    instance(function, Callable, "a block", "a function of a, b and c from 0 to 1")
    if not isinstance(cells, Sequence) or len(cells) != 3:
        raise ValueError(f"cells must be three numbers, along a, b and c, got {cells!r}")
    counts = [whole_number(count) for count in cells]
    steps = [range(n + 1) for n in counts]
    parameters = np.array(
        [[i / n for i, n in zip(at, counts, strict=True)] for at in product(*steps)]
    )
    points = points_of([function(*(float(p) for p in at)) for at in parameters])
    mesh = _compat.create_surface_mesh(points, _grid_cells(counts, cell), cell, 1)
    return _named(mesh, parameters[mesh.geometry.input_global_indices])


def brick(
    lengths: npt.ArrayLike,
    cells: tuple[int, int, int],
    *,
    origin: npt.ArrayLike = (0.0, 0.0, 0.0),
    cell: str = "hexahedron",
) -> VolumeMesh:
    """Box of equal cells with a corner at ``origin``; a, b and c go along x, y and z.

    Args:
        lengths: Of its edges, shape (3,).
        cells: Numbers along them.
        origin: Corner with the smallest coordinates.
        cell: See :func:`block`.

    Raises:
        ValueError: A length is not positive, or something is out of range.
    """
    edges, start = (points_of([value])[0] for value in (lengths, origin))
    if not (edges > 0.0).all():
        raise ValueError(f"a brick needs three positive lengths, got {lengths!r}")
    return block(lambda a, b, c: start + edges * np.array([a, b, c]), cells, cell=cell)


def _named(mesh: dolfinx.mesh.Mesh, parameters: Array) -> VolumeMesh:
    """With the names of faces, edges and corners; parameters of each node, shape (n, 3)."""
    sides = {
        f"{name}={end}": np.flatnonzero(parameters[:, k] == end)
        for k, name in enumerate(_PARAMETERS)
        for end in (0, 1)
    }
    edges = {
        f"{one},{other}": np.intersect1d(sides[one], sides[other])
        for one, other in combinations(sides, 2)
        if one[0] != other[0]
    }
    corners = {
        "".join(map(str, at)): np.flatnonzero((parameters == at).all(axis=1))
        for at in product((0, 1), repeat=3)
    }
    return VolumeMesh(
        mesh,
        faces={name: entities_on(mesh, 2, nodes) for name, nodes in sides.items()},
        curves={name: entities_on(mesh, 1, nodes) for name, nodes in edges.items()},
        named_points={name: entities_on(mesh, 0, nodes) for name, nodes in corners.items()},
    )


def _grid_cells(counts: Sequence[int], cell: str) -> Indices:
    """Cells on a grid of points, in DOLFINx's order."""
    number = np.arange(np.prod([n + 1 for n in counts])).reshape([n + 1 for n in counts])
    ends = [number[i:n, j:m, k:p] for i, n, j, m, k, p in _corners(counts)]
    hexahedra = np.stack([each.ravel() for each in ends], axis=1)
    if cell == "hexahedron":
        return hexahedra
    return hexahedra[:, np.array(_TETRAHEDRA)].reshape(-1, 4)


def _corners(counts: Sequence[int]) -> list[tuple[int, int, int, int, int, int]]:
    """Slices of the grid that hold each corner of all cells, the first parameter fastest."""
    n, m, p = counts
    return [(i, n + i, j, m + j, k, p + k) for k in (0, 1) for j in (0, 1) for i in (0, 1)]
