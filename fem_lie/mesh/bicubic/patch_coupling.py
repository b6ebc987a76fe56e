"""Edges of patches, patches put together at corners, and coupled along edges."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import cos, radians
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices, positive, text
from fem_lie.mesh.bicubic import hermite
from fem_lie.mesh.bicubic.smooth_patch import SmoothPatch

_PER_CELL = 2  # a cubic edge follows any other at two Gauss points per cell, and no further
_SAMPLES, _PASSES = 9, 14
_APART, _KINK = 0.05, radians(15.0)  # of a cell; between normals


class Edge(NamedTuple):
    """Points along an edge of a patch, or points alone.

    Attributes:
        points: One after the other, shape (n,).
        along: Which derivative is along them, 0 or 1, or −1 of a single point.
        cells: Cell at each piece between two points, shape (n − 1,).
        side: At which end of the cells' other parameter, 0 or 1.
    """

    points: Indices
    along: int
    cells: Indices
    side: int


@dataclass(frozen=True)
class Seam:
    """Two edges of patches that are held together: as smooth surfaces go on, whatever parameters.

    Places and normals are held by springs, at two points per cell of the edge that has more cells.

    Attributes:
        first: Name of an edge, as of a :class:`~fem_lie.ThinShell`: "roof.a=1".
        second: Of the other.
        stiffness: Of these springs, in stiffness of the shell across a cell.

    Raises:
        ValueError: The stiffness is not positive.

    Example:
        >>> steel = fl.ShellSection.layer(0.01, fl.Material(2e11, 0.3, 7800.0))
        >>> left = fl.smooth_patch(lambda a, b: (a, b, 0), (2, 3))
        >>> right = fl.smooth_patch(lambda a, b: (1 + a, 0.5 * b + 0.5 * b**2, 0), (2, 2))
        >>> sides = {"left": left, "right": right}
        >>> plate = fl.ThinShell(sides, steel, seams=[fl.Seam("left.a=1", "right.a=0")])
    """

    first: str
    second: str
    stiffness: float = 1e3

    def __post_init__(self) -> None:
        """Check the names and the number."""
        text(self.first, "Seam: first")
        text(self.second, "Seam: second")
        positive(self.stiffness, "Seam: stiffness")


class SeamPoints(NamedTuple):
    """Points along seams.

    Attributes:
        nodes: Of the cell on one side, then of that on the other, shape (b, 16).
        sizes: Of both cells, as :mod:`fem_lie.elements.thin_shells.rows` has them, shape (b, 6).
        shapes: Of ``r``, ``r₁``, ``r₂`` of one side, then of the other, shape (b, 6, 16).
        taken: ``D`` and ``C``, shape (b, 6).
        stiffness: ``w N`` and ``w M``, shape (b, 2).
    """

    nodes: Indices
    sizes: Array
    shapes: Array
    taken: Array
    stiffness: Array

    @classmethod
    def joined(cls, parts: list[SeamPoints]) -> SeamPoints:
        """All of several."""
        return cls(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def seam_points(
    seam: Seam,
    edges: tuple[Edge, Edge],
    vectors: Array,
    cells: tuple[Indices, Array],
    stiffness: Array,
) -> SeamPoints:
    """Where both sides are held together.

    Args:
        seam: Of the edges.
        edges: Both.
        vectors: Of the interpolation of all cells, shape (m, 16, 3).
        cells: Nodes of each, (m, 8), and sizes, (m, 3).
        stiffness: Of their sections, shape (m, 8, 8).

    Raises:
        ValueError: The edges do not lie on each other, or meet with a kink.
    """
    if len(edges[0].cells) < len(edges[1].cells):
        edges = edges[1], edges[0]
    (A, B), (ξ, weights) = edges, hermite.gauss(_PER_CELL)
    own = np.repeat(A.cells, _PER_CELL)
    at = np.tile(ξ, len(A.cells))
    first = _shapes(A, at)
    q = vectors[own]
    x, r1, r2 = np.einsum("bca,baj->cbj", first, q)
    pieces, where = _nearest(B, vectors[B.cells], x)
    other = B.cells[pieces]
    second = _shapes(B, where)
    y, s1, s2 = np.einsum("bca,baj->cbj", second, vectors[other])
    lengths = np.linalg.norm((r1, r2)[A.along], axis=1) * np.tile(weights, len(A.cells))
    n, m = (_unit(np.cross(*slopes)) for slopes in ((r1, r2), (s1, s2)))
    _check(seam, lengths, np.linalg.norm(x - y, axis=1), np.einsum("bj,bj->b", n, m))
    basis = np.stack([r1, r2, n], axis=-1)
    taken = np.concatenate([_solved(basis, y - x), _solved(basis, m - n)], axis=1)
    # a cell's size across, by which stiffness of the shell is that of a spring
    across = np.linalg.norm((r2, r1)[A.along], axis=1)
    D = stiffness[own]
    factor = seam.stiffness * lengths / across
    springs = np.stack([D[:, :2, :2].max(axis=(1, 2)), D[:, 3:5, 3:5].max(axis=(1, 2))], axis=1)
    nodes, sizes = cells
    return SeamPoints(
        np.concatenate([nodes[own], nodes[other]], axis=1),
        np.concatenate([sizes[own], sizes[other]], axis=1),
        np.concatenate([first, second], axis=1),
        taken,
        factor[:, np.newaxis] * springs,
    )


def _shapes(edge: Edge, at: Array) -> Array:
    """Of place and both slopes at places along pieces of an edge, shape (b, 3, 16)."""
    points = np.full((len(at), 2), float(edge.side))
    points[:, edge.along] = at
    return np.asarray(hermite.table(points)[:, : hermite.ACROSS + 1])


def _nearest(edge: Edge, q: Array, x: Array) -> tuple[Indices, Array]:
    """Piece of an edge of cells with vectors ``q``, and where on it, next to places (b, 3)."""
    shape = len(x), len(q)
    low: Array = np.zeros(shape)
    high: Array = np.ones(shape)
    parts = np.linspace(0.0, 1.0, _SAMPLES)
    for _ in range(_PASSES):
        grid = low[..., np.newaxis] + parts * (high - low)[..., np.newaxis]
        shapes = _shapes(edge, grid.ravel())[:, 0].reshape(*grid.shape, -1)
        places = np.einsum("bcga,caj->bcgj", shapes, q)
        away = np.linalg.norm(places - x[:, np.newaxis, np.newaxis], axis=-1)
        best = away.argmin(axis=2)[..., np.newaxis]
        middle = np.take_along_axis(grid, best, axis=2)[..., 0]
        step = (high - low) / (_SAMPLES - 1)
        low, high = np.maximum(middle - step, 0.0), np.minimum(middle + step, 1.0)
    piece = np.take_along_axis(away, best, axis=2)[..., 0].argmin(axis=1)
    return piece, middle[np.arange(len(x)), piece]


def _check(seam: Seam, lengths: Array, gaps: Array, cosines: Array) -> None:
    far = gaps > _APART * _PER_CELL * lengths
    if far.any():
        raise ValueError(
            f"the edges {seam.first!r} and {seam.second!r} are to be one seam, but are up to "
            f"{gaps.max():.3g} from each other, with cells of about {_PER_CELL * lengths.max():.3g}"
        )
    if cosines.min() < cos(_KINK):
        raise ValueError(
            f"the seam of {seam.first!r} and {seam.second!r} has a kink of "
            f"{np.degrees(np.arccos(np.clip(cosines.min(), -1, 1))):.0f}° between normals; patches "
            "are sewn together where the surface goes on smoothly, with normals to the same side"
        )


def _solved(basis: Array, wanted: Array) -> Array:
    return np.asarray(np.linalg.solve(basis, wanted[..., np.newaxis])[..., 0])


def _unit(a: Array) -> Array:
    return np.asarray(a / np.linalg.norm(a, axis=-1, keepdims=True))


def points_on(seams: Sequence[Seam], edges: dict[str, Edge], label: str) -> set[int]:
    """Points on edges of seams.

    Raises:
        ValueError: There is no such edge.
    """
    found: set[int] = set()
    for name in (name for seam in seams for name in (seam.first, seam.second)):
        if name not in edges:
            known = ", ".join(edges)
            raise ValueError(f"{label} has no edge {name!r} for a seam; it has: {known}")
        found.update(int(point) for point in edges[name].points)
    return found


_PLACES, _SLOPES = 1e-7, 1e-5  # relative, as surfaces that are meant to go on smoothly


class Joined(NamedTuple):
    """Points and cells of all patches.

    Attributes:
        rows: Place, ∂u, ∂v and ∂u∂v of each point, shape (n, 4, 3).
        corners: Points of each cell: (0, 0), (1, 0), (0, 1), (1, 1), shape (m, 4).
        sizes: Of each cell along u and v, shape (m, 2).
        edges: By name.
        named: Corners of the patches by name.
        groups: Cells of each patch by name.
        hanging: Which corners of each cell hang, as a code, shape (m,).
    """

    rows: Array
    corners: Indices
    sizes: Array
    edges: dict[str, Edge]
    named: dict[str, int]
    groups: dict[str, Indices]
    hanging: Array


def joined(
    patches: Mapping[str, SmoothPatch], *, one: bool, label: str, seams: Sequence[Seam] = ()
) -> Joined:
    """Number points and cells.

    Args:
        patches: By name; one without a name is called "".
        one: Whether points of edges at one place are one point.
        label: Of the body, for messages.
        seams: Edges whose points stay apart where slopes are not the same.

    Raises:
        ValueError: Slopes of points that are to be one are not the same, or there is no edge of a
            seam.
    """
    rows, corners, sizes = [], [], []
    edges: dict[str, Edge] = {}
    named: dict[str, int] = {}
    groups: dict[str, Indices] = {}
    points = cells = 0
    for name, patch in patches.items():
        na, nb = patch.rows.shape[0] - 1, patch.rows.shape[1] - 1
        number = points + np.arange((na + 1) * (nb + 1)).reshape(na + 1, nb + 1)
        cell = cells + np.arange(na * nb).reshape(na, nb)
        quads = [number[:-1, :-1], number[1:, :-1], number[:-1, 1:], number[1:, 1:]]
        corners.append(np.stack(quads, axis=-1).reshape(-1, 4))
        rows.append(patch.rows.reshape(-1, 4, 3))
        sizes.append(np.stack(np.meshgrid(*patch.sizes, indexing="ij"), axis=-1).reshape(-1, 2))
        prefix = f"{name}." if name else ""
        for side in (0, 1):
            at = -side
            edges[f"{prefix}a={side}"] = Edge(number[at], 1, cell[at], side)
            edges[f"{prefix}b={side}"] = Edge(number[:, at], 0, cell[:, at], side)
            for other in (0, 1):
                named[f"{prefix}{side}{other}"] = int(number[at, -other])
        if name:
            groups[name] = cell.ravel()
        points, cells = points + number.size, cells + cell.size
    found = Joined(
        np.concatenate(rows),
        np.concatenate(corners),
        np.concatenate(sizes),
        edges,
        named,
        groups,
        np.zeros(cells),
    )
    sewn = points_on(seams, edges, label)
    return _merged(found, sewn, label) if one else found


def _merged(found: Joined, sewn: set[int], label: str) -> Joined:
    """Points of edges that are at one place made one, but for those that are sewn together."""
    outer = np.unique(np.concatenate([edge.points for edge in found.edges.values()]))
    size = float(np.linalg.norm(np.ptp(found.rows[:, 0], axis=0)))
    same: Indices = np.arange(len(found.rows))
    for k, point in enumerate(outer[1:], start=1):
        before = outer[:k]
        away = np.linalg.norm(found.rows[before, 0] - found.rows[point, 0], axis=1)
        near = before[away <= _PLACES * size]
        for other in near:
            apart = {int(point), int(other)} <= sewn
            if _same_slopes(found.rows[other], found.rows[point], size, label, refuse=not apart):
                same[point] = same[other]
                break
    kept, number = np.unique(same, return_inverse=True)
    return Joined(
        found.rows[kept],
        number[found.corners],
        found.sizes,
        {name: edge._replace(points=number[edge.points]) for name, edge in found.edges.items()},
        {name: int(number[point]) for name, point in found.named.items()},
        found.groups,
        found.hanging,
    )


def _same_slopes(a: Array, b: Array, size: float, label: str, *, refuse: bool) -> bool:
    gaps = np.abs(a - b).max(axis=1) * [1.0, 1.0, 1.0, size]
    same = bool(gaps[1:].max() <= _SLOPES)
    if refuse and not same:
        raise ValueError(
            f"patches of {label} are to be joined at {a[0]}, where the parametrisations do not "
            "agree: derivatives along a, along b and mixed, of parameters that are lengths, are\n"
            f"{a[1:]} and\n{b[1:]}. Give functions with the same slopes on both sides (a along a, "
            "of the same speed), sew the edges by a Seam, or say joined=False; a kink cannot be "
            "joined"
        )
    return same


def frames_of(rows: Array, fourth: Array) -> Array:
    """Rows of the nodes, but for the axes, (2 n, 4, 3).

    Args:
        rows: Place and derivatives of each point, shape (n, 4, 3).
        fourth: Its fourth vector, shape (n, 3).
    """
    count = len(rows)
    frames = np.zeros((2 * count, 4, 3))
    frames[:count, :2] = rows[:, :2]
    frames[count:, 0], frames[count:, 2] = rows[:, 0], rows[:, 2]
    frames[count:, 1] = fourth
    return frames
