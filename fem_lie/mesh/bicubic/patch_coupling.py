"""Edges of patches, joined patches, and coupling of patches along edges."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import cos, radians
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices, positive, text
from fem_lie.mesh.bicubic import hermite
from fem_lie.mesh.bicubic.smooth_patch import SmoothPatch

_PER_CELL = 2  # at more points than two per cell, cubic edges lock
_SAMPLES, _PASSES = 9, 14
_APART, _KINK = 0.05, radians(15.0)  # of a cell; between normals


class Edge(NamedTuple):
    """Points along an edge of a patch, or a single point.

    Attributes:
        points: Points in order along the edge, shape (n,).
        along: Index of the derivative along the edge, 0 or 1, or −1 for a single point.
        cells: Cell at each segment between two points, shape (n − 1,).
        side: End of the cells' other parameter at which the edge is, 0 or 1.
    """

    points: Indices
    along: int
    cells: Indices
    side: int


@dataclass(frozen=True)
class PatchCoupling:
    """Smooth coupling of two coincident edges of patches with any parametrisations.

    Positions and normals are coupled by springs, at two points per cell of the edge with more
    cells.

    Attributes:
        first: Name of an edge, as of a :class:`~fem_lie.ThinShell`: "roof.a=1".
        second: Name of the other edge.
        stiffness: Stiffness of the springs, relative to that of the shell across a cell.

    Raises:
        ValueError: The stiffness is not positive.

    Example:
        >>> steel = fl.ShellSection.layer(0.01, fl.Material(2e11, 0.3, 7800.0))
        >>> left = fl.mesh.smooth_patch(lambda a, b: (a, b, 0), (2, 3))
        >>> right = fl.mesh.smooth_patch(lambda a, b: (1 + a, 0.5 * b + 0.5 * b**2, 0), (2, 2))
        >>> sides = {"left": left, "right": right}
        >>> plate = fl.ThinShell(sides, steel, couplings=[fl.mesh.PatchCoupling("left.a=1",
        ...     "right.a=0")])
    """

    first: str
    second: str
    stiffness: float = 1e3

    def __post_init__(self) -> None:
        """Check the names and the number."""
        text(self.first, "PatchCoupling: first")
        text(self.second, "PatchCoupling: second")
        positive(self.stiffness, "PatchCoupling: stiffness")


class CouplingPoints(NamedTuple):
    """Points at which edges are coupled.

    Attributes:
        nodes: Nodes of the cell on one side, then on the other, shape (b, 16).
        sizes: Sizes of both cells, (b, 6), see :mod:`.thin_shells.nodal_coordinates`.
        shapes: Shape functions of ``r``, ``r₁``, ``r₂`` of one side, then of the other, (b, 6, 16).
        taken: Initial gaps ``D`` and ``C``, shape (b, 6).
        stiffness: ``w N`` and ``w M``, shape (b, 2).
    """

    nodes: Indices
    sizes: Array
    shapes: Array
    taken: Array
    stiffness: Array

    @classmethod
    def joined(cls, parts: list[CouplingPoints]) -> CouplingPoints:
        """Concatenation of several records."""
        return cls(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def coupling_points(
    coupling: PatchCoupling,
    edges: tuple[Edge, Edge],
    vectors: Array,
    cells: tuple[Indices, Array],
    stiffness: Array,
) -> CouplingPoints:
    """Points at which both edges are coupled.

    Args:
        coupling: The coupling.
        edges: Both edges.
        vectors: Hermite vectors of all cells, shape (m, 16, 3).
        cells: Nodes of each cell, (m, 8), and sizes, (m, 3).
        stiffness: Section stiffness of each cell, shape (m, 8, 8).

    Raises:
        ValueError: The edges are not coincident, or meet at a kink.
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
    _check(coupling, lengths, np.linalg.norm(x - y, axis=1), np.einsum("bj,bj->b", n, m))
    basis = np.stack([r1, r2, n], axis=-1)
    taken = np.concatenate([_solved(basis, y - x), _solved(basis, m - n)], axis=1)
    # size of a cell across the edge, which relates the stiffness of shell and spring
    across = np.linalg.norm((r2, r1)[A.along], axis=1)
    D = stiffness[own]
    factor = coupling.stiffness * lengths / across
    springs = np.stack([D[:, :2, :2].max(axis=(1, 2)), D[:, 3:5, 3:5].max(axis=(1, 2))], axis=1)
    nodes, sizes = cells
    return CouplingPoints(
        np.concatenate([nodes[own], nodes[other]], axis=1),
        np.concatenate([sizes[own], sizes[other]], axis=1),
        np.concatenate([first, second], axis=1),
        taken,
        factor[:, np.newaxis] * springs,
    )


def _shapes(edge: Edge, at: Array) -> Array:
    """Shape functions of position and gradients at points along an edge, shape (b, 3, 16)."""
    points = np.full((len(at), 2), float(edge.side))
    points[:, edge.along] = at
    return np.asarray(hermite.table(points)[:, : hermite.ACROSS + 1])


def _nearest(edge: Edge, q: Array, x: Array) -> tuple[Indices, Array]:
    """Segment of an edge, and parameter in it, closest to each position (b, 3)."""
    shape = len(x), len(q)
    low: Array = np.zeros(shape)
    high: Array = np.ones(shape)
    parts = np.linspace(0.0, 1.0, _SAMPLES)
    for _ in range(_PASSES):
        grid = low[..., np.newaxis] + parts * (high - low)[..., np.newaxis]
        shapes = _shapes(edge, grid.ravel())[:, 0].reshape(*grid.shape, -1)
        positions = np.einsum("bcga,caj->bcgj", shapes, q)
        away = np.linalg.norm(positions - x[:, np.newaxis, np.newaxis], axis=-1)
        best = away.argmin(axis=2)[..., np.newaxis]
        middle = np.take_along_axis(grid, best, axis=2)[..., 0]
        step = (high - low) / (_SAMPLES - 1)
        low, high = np.maximum(middle - step, 0.0), np.minimum(middle + step, 1.0)
    piece = np.take_along_axis(away, best, axis=2)[..., 0].argmin(axis=1)
    return piece, middle[np.arange(len(x)), piece]


def _check(coupling: PatchCoupling, lengths: Array, gaps: Array, cosines: Array) -> None:
    far = gaps > _APART * _PER_CELL * lengths
    if far.any():
        raise ValueError(
            f"the edges {coupling.first!r} and {coupling.second!r} are to be coupled, but are "
            f"up to {gaps.max():.3g} from each other, with cells of about "
            f"{_PER_CELL * lengths.max():.3g}"
        )
    if cosines.min() < cos(_KINK):
        raise ValueError(
            f"the coupling of {coupling.first!r} and {coupling.second!r} has a kink of "
            f"{np.degrees(np.arccos(np.clip(cosines.min(), -1, 1))):.0f}° between normals; "
            "expected a smooth surface, with normals to the same side"
        )


def _solved(basis: Array, right: Array) -> Array:
    return np.asarray(np.linalg.solve(basis, right[..., np.newaxis])[..., 0])


def _unit(a: Array) -> Array:
    return np.asarray(a / np.linalg.norm(a, axis=-1, keepdims=True))


def points_on(couplings: Sequence[PatchCoupling], edges: dict[str, Edge], label: str) -> set[int]:
    """Points on coupled edges.

    Raises:
        ValueError: There is no such edge.
    """
    found: set[int] = set()
    for name in (name for coupling in couplings for name in (coupling.first, coupling.second)):
        if name not in edges:
            known = ", ".join(edges)
            raise ValueError(f"{label} has no edge {name!r} to couple; it has: {known}")
        found.update(int(point) for point in edges[name].points)
    return found


_PLACES, _SLOPES = 1e-7, 1e-5  # relative, as surfaces that are meant to go on smoothly


class Joined(NamedTuple):
    """Points and cells of all patches.

    Attributes:
        nodal_vectors: Position, ∂u, ∂v and ∂u∂v of each point, shape (n, 4, 3).
        corners: Points of each cell: (0, 0), (1, 0), (0, 1), (1, 1), shape (m, 4).
        sizes: Sizes of each cell along u and v, shape (m, 2).
        edges: Edges by name.
        named: Corners of the patches by name.
        groups: Cells of each patch by name.
        hanging: Code of the hanging corners of each cell, shape (m,).
    """

    nodal_vectors: Array
    corners: Indices
    sizes: Array
    edges: dict[str, Edge]
    named: dict[str, int]
    groups: dict[str, Indices]
    hanging: Array


def joined(
    patches: Mapping[str, SmoothPatch],
    *,
    one: bool,
    label: str,
    couplings: Sequence[PatchCoupling] = (),
) -> Joined:
    """Number the points and cells of all patches.

    Args:
        patches: Patches by name; a single patch without a name has the key "".
        one: Whether coincident points of edges are merged.
        label: Label of the body, for messages.
        couplings: Coupled edges, whose points stay separate where gradients differ.

    Raises:
        ValueError: Gradients of points to be merged differ, or a coupled edge does not exist.
    """
    nodal_vectors, corners, sizes = [], [], []
    edges: dict[str, Edge] = {}
    named: dict[str, int] = {}
    groups: dict[str, Indices] = {}
    points = cells = 0
    for name, patch in patches.items():
        na, nb = patch.nodal_vectors.shape[0] - 1, patch.nodal_vectors.shape[1] - 1
        number = points + np.arange((na + 1) * (nb + 1)).reshape(na + 1, nb + 1)
        cell = cells + np.arange(na * nb).reshape(na, nb)
        quads = [number[:-1, :-1], number[1:, :-1], number[:-1, 1:], number[1:, 1:]]
        corners.append(np.stack(quads, axis=-1).reshape(-1, 4))
        nodal_vectors.append(patch.nodal_vectors.reshape(-1, 4, 3))
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
        np.concatenate(nodal_vectors),
        np.concatenate(corners),
        np.concatenate(sizes),
        edges,
        named,
        groups,
        np.zeros(cells),
    )
    coupled = points_on(couplings, edges, label)
    return _merged(found, coupled, label) if one else found


def _merged(found: Joined, coupled: set[int], label: str) -> Joined:
    """Merge coincident points of edges, except those on coupled edges."""
    outer = np.unique(np.concatenate([edge.points for edge in found.edges.values()]))
    size = float(np.linalg.norm(np.ptp(found.nodal_vectors[:, 0], axis=0)))
    same: Indices = np.arange(len(found.nodal_vectors))
    for k, point in enumerate(outer[1:], start=1):
        before = outer[:k]
        away = np.linalg.norm(
            found.nodal_vectors[before, 0] - found.nodal_vectors[point, 0], axis=1
        )
        near = before[away <= _PLACES * size]
        for other in near:
            apart = {int(point), int(other)} <= coupled
            if _same_slopes(
                found.nodal_vectors[other],
                found.nodal_vectors[point],
                size,
                label,
                refuse=not apart,
            ):
                same[point] = same[other]
                break
    kept, number = np.unique(same, return_inverse=True)
    return Joined(
        found.nodal_vectors[kept],
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
            "of the same speed), couple the edges by a Seam, or pass joined=False; a kink cannot "
            "be joined"
        )
    return same


def frames_of(nodal_vectors: Array, fourth: Array) -> Array:
    """Nodal coordinates without axes, shape (2 n, 4, 3).

    Args:
        nodal_vectors: Position and derivatives of each point, shape (n, 4, 3).
        fourth: Fourth vector of each point, shape (n, 3).
    """
    count = len(nodal_vectors)
    frames = np.zeros((2 * count, 4, 3))
    frames[:count, :2] = nodal_vectors[:, :2]
    frames[count:, 0], frames[count:, 2] = nodal_vectors[:, 0], nodal_vectors[:, 2]
    frames[count:, 1] = fourth
    return frames
