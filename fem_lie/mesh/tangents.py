"""Topology and tangents of lines that are given by points and cells alone."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices

_SAME_TANGENT = np.cos(np.radians(1.0))


def valence(cells: Indices, points: int) -> Indices:
    """Number of cells at each point."""
    return np.bincount(cells.ravel(), minlength=points)


def flipped(cells: Indices, points: int) -> npt.NDArray[np.bool_]:
    """Which cells to turn round so that each follows the one before it, shape (m,).

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

    Inversion about the middle point b turns the circle through a, b, c into a line parallel to its
    tangent at b: ``t ∥ (b − a)/|b − a|² + (c − b)/|c − b|²``. At the end of a chain the same
    circle, mirrored about the chord's middle, gives the tangent; at a kink the chords do.

    Args:
        points: Coordinates, shape (n, 3).
        cells: Pairs of points, shape (m, 2), each following the one before it (:func:`flipped`).
        kink_angle: Where successive chords turn by more than this angle the line has a kink, rad.

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


def join_tangents(cells: Indices, tangents: Array, points: int) -> Array:
    """Give both sides of a point their mean tangent where they differ by less than a degree.

    Curves of a CAD model that are meant to be smooth meet only as well as their data.
    """
    before, after = _meeting(cells, points)
    left, right = tangents[before, 1], tangents[after, 0]
    near = np.einsum("ij,ij->i", left, right) > _SAME_TANGENT
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
