"""Line meshes in space: points, cells with tangents at both ends, named groups and points.

A mesh comes from a function (:func:`straight_line`, :func:`polyline`, :func:`curve`), from gmsh or
DOLFINx (:mod:`fem_lie.mesh.reading`), or from arrays (:meth:`LineMesh.from_cells`). Lines have
corners between cells, unless the user declares the points to be on a smooth curve.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import pi, radians
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import (
    Array,
    Indices,
    find_name,
    indices_of,
    members_of,
    number,
    numbers,
    points_of,
)
from fem_lie._summary import Summarised

if TYPE_CHECKING:
    import dolfinx


def valence(cells: Indices, points: int) -> Indices:
    """Number of cells at each point."""
    return np.bincount(cells.ravel(), minlength=points)


def flipped(cells: Indices, points: int) -> npt.NDArray[np.bool_]:
    """Mask of the cells to reverse so that each follows the one before it, shape (m,).

    Along every chain the cell with the lowest number keeps its direction; a chain ends where not
    exactly two cells meet.
    """
    neighbours = _cells_at_inner_points(cells, points)
    done, flip = np.zeros((2, len(cells)), dtype=bool)
    for seed in range(len(cells)):
        if done[seed]:
            continue
        done[seed] = True
        for side in (1, 0):
            cell = seed
            while True:
                node = cells[cell, side ^ flip[cell]]
                following = neighbours[node].sum() - cell if neighbours[node, 0] >= 0 else -1
                if following < 0 or done[following]:
                    break
                done[following] = True
                flip[following] = cells[following, 1 - side] != node
                cell = following
    return flip


def circle_tangents(points: Array, cells: Indices, kink_angle: float) -> Array:
    """Unit tangents at both ends of each cell, from circles through three successive points.

    Inversion about the middle point b maps the circle through a, b, c to a line parallel to its
    tangent at b: ``t ∥ (b − a)/|b − a|² + (c − b)/|c − b|²``. At the end of a chain the same
    circle, mirrored about the chord's midpoint, gives the tangent; at a kink the chords do.

    Args:
        points: Coordinates, shape (n, 3).
        cells: Pairs of points, shape (m, 2), each following the one before it (:func:`flipped`).
        kink_angle: Angle between successive chords above which the line has a kink, rad.

    Returns:
        Tangents, shape (m, 2, 3): exact on circles, second order on other smooth lines.
    """
    chord = points[cells[:, 1]] - points[cells[:, 0]]
    length = np.linalg.norm(chord, axis=1, keepdims=True)
    unit = chord / length
    before, after = _meeting(cells, len(points))
    keep = np.einsum("ij,ij->i", unit[before], unit[after]) >= np.cos(kink_angle)
    before, after = before[keep], after[keep]
    middle = (unit / length)[before] + (unit / length)[after]
    middle /= np.linalg.norm(middle, axis=1, keepdims=True)

    tangents = np.full((len(cells), 2, 3), np.nan)
    tangents[before, 1] = middle
    tangents[after, 0] = middle
    known = np.isfinite(tangents[..., 0])
    for end in (0, 1):
        mirror = known[:, 1 - end] & ~known[:, end]
        t, u = tangents[mirror, 1 - end], unit[mirror]
        tangents[mirror, end] = 2.0 * np.einsum("ij,ij->i", t, u)[:, np.newaxis] * u - t
        alone = ~known.any(axis=1)
        tangents[alone, end] = unit[alone]
    return tangents


def halved(points: Array, cells: Indices) -> tuple[Indices, Array]:
    """Halves of three-node cells, and their tangents: those of the circle through the three nodes.

    Args:
        points: Coordinates, shape (n, 3).
        cells: Two ends and the node between of each cell, shape (m, 3).

    Returns:
        Pairs of points, both halves of a cell in succession, shape (2 m, 2), and unit tangents at
        both ends of each, shape (2 m, 2, 3).

    Raises:
        ValueError: A cell has no length, or turns by more than a right angle at its node.
    """
    a, b, m = points[cells].transpose(1, 0, 2)
    chords = np.stack([m - a, b - m], axis=1)
    lengths = np.linalg.norm(chords, axis=2, keepdims=True)
    if len(short := np.flatnonzero((lengths <= 1e-14 * np.abs(points).max()).any(axis=(1, 2)))):
        raise ValueError(
            f"cell {short[0]} has no length: two of its nodes {points[cells[short[0]]].tolist()} "
            "coincide"
        )
    units = chords / lengths
    if len(sharp := np.flatnonzero(np.einsum("mj,mj->m", units[:, 0], units[:, 1]) <= 0.0)):
        raise ValueError(
            f"cell {sharp[0]} turns by 90° or more at its middle node: expected nodes in the order "
            f"end, end, middle, got {points[cells[sharp[0]]].tolist()}"
        )
    middle = (units / lengths).sum(axis=1, keepdims=True)
    middle /= np.linalg.norm(middle, axis=2, keepdims=True)
    # the circle, mirrored about the midpoint of each chord
    ends = 2.0 * np.einsum("mkj,mlj->mk", units, middle)[..., np.newaxis] * units - middle
    tangents = np.stack([ends[:, 0], middle[:, 0], middle[:, 0], ends[:, 1]], axis=1)
    return cells[:, [0, 2, 2, 1]].reshape(-1, 2), tangents.reshape(-1, 2, 3)


def join_tangents(cells: Indices, tangents: Array, points: int, kink_angle: float) -> Array:
    """Give both sides of a point their mean tangent if they differ by less than an angle, rad.

    Curves of a CAD model that are meant to be smooth agree only as well as their data.
    """
    before, after = _meeting(cells, points)
    left, right = tangents[before, 1], tangents[after, 0]
    near = np.einsum("ij,ij->i", left, right) > np.cos(kink_angle)
    mean = left[near] + right[near]
    mean /= np.linalg.norm(mean, axis=1, keepdims=True)
    joined = tangents.copy()
    joined[before[near], 1] = mean
    joined[after[near], 0] = mean
    return joined


def _cells_at_inner_points(cells: Indices, points: int) -> Indices:
    """Both cells at each point where exactly two meet, else (−1, −1); shape (n, 2)."""
    order = np.argsort(cells.ravel(), kind="stable") // 2
    count = valence(cells, points)
    first = np.concatenate([[0], np.cumsum(count)[:-1]])
    result = np.full((points, 2), -1, dtype=np.int64)
    inner = count == 2
    result[inner] = order[first[inner, np.newaxis] + np.arange(2)]
    return result


def _meeting(cells: Indices, points: int) -> tuple[Indices, Indices]:
    """Cells before and after each point where exactly two meet and follow each other."""
    pairs = _cells_at_inner_points(cells, points)
    nodes = np.flatnonzero(pairs[:, 0] >= 0)
    first, second = pairs[nodes].T
    ends_here = cells[first, 1] == nodes
    before, after = np.where(ends_here, first, second), np.where(ends_here, second, first)
    follow = (cells[before, 1] == nodes) & (cells[after, 0] == nodes)
    return before[follow], after[follow]


CORNER_ANGLE = radians(1.0)
"""Angle below which a line is straight, up to the accuracy of coordinates."""

JOINT_ANGLE = radians(10.0)
"""Default for cells of second order: tangents at a point of one smooth line agree that well."""

KINK_ANGLE = radians(40.0)
"""Default for points on a curve: a circle of ten cells is smooth, a corner of 45° is not."""


@dataclass(frozen=True, eq=False, repr=False)
class LineMesh(Summarised):
    """Straight or curved lines divided into cells; lines may branch.

    Attributes:
        points: Coordinates, shape (n, 3); every point belongs to a cell.
        cells: Pairs of points, shape (m, 2).
        tangents: Unit tangents at the two ends of each cell, from its first to its second point,
            shape (m, 2, 3). The two sides of a point differ at a kink or branch.
        groups: Cells of each named group.
        named_points: Points of each name.
        source: DOLFINx mesh with these points, if any, and with these cells or, if they are of
            second order, with pairs of these as cells.
        slopes: For cubic cells, ``|dr/dξ|`` at both ends of each cell, 0 ≤ ξ ≤ 1, shape (m, 2);
            default: unknown.

    Raises:
        ValueError: A value is not finite, has the wrong shape or is out of range; a cell has no
            length, occurs twice or overlaps another; a point has no cell.
    """

    points: Array
    cells: Indices
    tangents: Array
    groups: Mapping[str, Indices] = field(default_factory=dict)
    named_points: Mapping[str, Indices] = field(default_factory=dict)
    source: dolfinx.mesh.Mesh | None = None
    slopes: Array | None = None

    def __post_init__(self) -> None:
        points, cells = points_of(self.points), _cells(self.cells, len(self.points))
        _check_cells(points, cells)
        tangents = _tangents(self.tangents, len(cells))
        # also refuses nan
        if not (np.abs(np.linalg.norm(tangents, axis=-1) - 1.0) < 1e-6).all():
            raise ValueError("tangents must be unit vectors")
        if self.slopes is not None:
            slopes = numbers(self.slopes, "slopes of a LineMesh")
            if slopes.shape != cells.shape or not (slopes > 0).all():
                raise ValueError(
                    f"slopes are positive lengths at both ends of {len(cells)} cells, got\n{slopes}"
                )
        for name, value in (
            ("points", points),
            ("cells", cells),
            ("tangents", tangents),
            ("groups", members_of(self.groups, len(cells), "cells")),
            ("named_points", members_of(self.named_points, len(points), "points")),
        ):
            object.__setattr__(self, name, value)

    @classmethod
    def from_cells(
        cls,
        points: npt.ArrayLike,
        cells: npt.ArrayLike,
        *,
        tangents: npt.ArrayLike | None = None,
        groups: Mapping[str, npt.ArrayLike] | None = None,
        named_points: Mapping[str, npt.ArrayLike] | None = None,
        kink_angle: float = CORNER_ANGLE,
        source: dolfinx.mesh.Mesh | None = None,
    ) -> LineMesh:
        """Mesh from arrays; straight cells with corners, or arcs on a curve.

        Cells are reversed where needed, so that along a line each follows the one before it; the
        one with the lowest number keeps its direction.

        Args:
            points: Coordinates, shape (n, 3).
            cells: Pairs of points, shape (m, 2).
            tangents: Known tangents, as in the class, nan elsewhere. If the two sides of a point
                differ by less than ``kink_angle`` both get their mean.
            groups: Cells of each named group.
            named_points: Points of each name.
            kink_angle: Angle between successive chords, rad, above which the line has a corner with
                the chords as tangents. Below, tangents are those of the circle through three
                successive points: exact on circles, second order on other smooth lines. For points
                on a curve pass more than the default of one degree: with 40 degrees a circle of ten
                cells is smooth.
            source: DOLFINx mesh with these points.

        Raises:
            ValueError: See the class.
        """
        check_kink_angle(kink_angle)
        x = points_of(points)
        given = _cells(cells, len(x))
        _check_cells(x, given)
        flip = flipped(given, len(x))
        directed = np.where(flip[:, np.newaxis], given[:, ::-1], given)
        found = circle_tangents(x, directed, kink_angle)
        if tangents is not None:
            known = _tangents(tangents, len(given))
            known = np.where(flip[:, np.newaxis, np.newaxis], -known[:, ::-1], known)
            found = join_tangents(
                directed, np.where(np.isfinite(known), known, found), len(x), kink_angle
            )
        return cls(
            x,
            directed,
            found,
            members_of(groups or {}, len(given), "cells"),
            members_of(named_points or {}, len(x), "points"),
            source,
        )

    @property
    def branching_points(self) -> Indices:
        """Points at which more than two cells meet."""
        return np.flatnonzero(valence(self.cells, len(self.points)) > 2)

    def group(self, name: str) -> Indices:
        """Cells of a group.

        Args:
            name: Name of the group.

        Raises:
            ValueError: There is no such group; the message lists those that exist.
        """
        return find_name(self.groups, name, "group of cells")

    def named(self, name: str) -> Indices:
        """Points with a name.

        Args:
            name: Name of the point.
        """
        return find_name(self.named_points, name, "named point")

    def part(self, group: str) -> LineMesh:
        """Mesh of one group, with the names that it contains.

        Args:
            group: Name of the group.
        """
        index = self.group(group)
        used, local = np.unique(self.cells[index], return_inverse=True)
        groups = {
            name: np.flatnonzero(np.isin(index, cells)) for name, cells in self.groups.items()
        }
        names = {
            name: np.flatnonzero(np.isin(used, points))
            for name, points in self.named_points.items()
        }
        return LineMesh(
            self.points[used],
            local.reshape(-1, 2),
            self.tangents[index],
            {name: cells for name, cells in groups.items() if len(cells)},
            {name: points for name, points in names.items() if len(points)},
        )


def check_kink_angle(kink_angle: float) -> None:
    """Raise ``ValueError`` if ``kink_angle`` is not an angle between 0 and π, rad."""
    number(kink_angle, "kink_angle")
    if not 0.0 <= kink_angle <= pi:
        raise ValueError(f"kink_angle must be between 0 and pi, got {kink_angle!r}")


def _cells(value: npt.ArrayLike, points: int) -> Indices:
    cells = np.asarray(value)
    if cells.ndim != 2 or cells.shape[1] != 2 or not len(cells):
        raise ValueError(f"cells must be pairs of points, shape (m, 2), got {cells.shape}")
    return indices_of(cells, points, "cells")


def _tangents(value: npt.ArrayLike, cells: int) -> Array:
    tangents = numbers(value, "tangents")
    if tangents.shape != (cells, 2, 3):
        raise ValueError(f"tangents must have shape ({cells}, 2, 3), got {tangents.shape}")
    return tangents


def _check_cells(points: Array, cells: Indices) -> None:
    length = np.linalg.norm(points[cells[:, 1]] - points[cells[:, 0]], axis=1)
    # points that coincide up to the accuracy of their coordinates
    short = np.flatnonzero(length <= 1e-14 * np.abs(points).max())
    if len(short):
        a, b = cells[short[0]]
        raise ValueError(
            f"cell {short[0]} has no length: its points {a} and {b} are both at {points[a]}"
        )
    _, first, count = np.unique(
        np.sort(cells, axis=1), axis=0, return_index=True, return_counts=True
    )
    if (count > 1).any():
        twice = first[count > 1][0]
        raise ValueError(f"cell {twice} (points {cells[twice]}) occurs twice")
    alone = np.flatnonzero(valence(cells, len(points)) == 0)
    if len(alone):
        raise ValueError(f"{len(alone)} points have no cell, the first is {alone[0]}")
    _refuse_overlaps(points, cells)


def _refuse_overlaps(points: Array, cells: Indices) -> None:
    """Raise ``ValueError`` if two cells start at a point in the same direction."""
    point = cells.ravel()
    away = points[cells[:, ::-1].ravel()] - points[point]
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    order = np.argsort(point, kind="stable")
    for step in range(1, int(valence(cells, len(points)).max())):
        a, b = order[:-step], order[step:]
        same = point[a] == point[b]
        a, b = a[same], b[same]
        on_top = np.flatnonzero(np.linalg.norm(away[a] - away[b], axis=1) < CORNER_ANGLE)
        if len(on_top):
            first, second = sorted((a[on_top[0]] // 2, b[on_top[0]] // 2))
            position = points[point[a[on_top[0]]]]
            raise ValueError(
                f"cells {first} and {second} lie on top of each other at {position}: the line goes "
                "back on itself there"
            )
