"""Patches put together: which corners of cells are one point, and what lies along which edge."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.thin_shells.patch import SmoothPatch
from fem_lie.bodies.thin_shells.seams import Edge, Seam, points_on

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
