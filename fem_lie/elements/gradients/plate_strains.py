"""Strains of the plate of places and three slopes, as products of vectors: tables of numbers."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.elements.gradients import coons
from fem_lie.elements.thin_shells import hermite

GRID = np.array([0.0, 0.5, 1.0])
STRAINS = 44


class _Places(NamedTuple):
    """Where strains begin: membrane at two edges of three places, shear likewise, nine of 2 E₁₂."""

    E11: int = 0
    E22: int = 6
    E12: int = 12
    S1: int = 21
    S2: int = 27


E = _Places()
K11, K22, K12, E33, MIDDLE = 33, 35, 37, 38, 42

_R1, _R2, _D, _D1, _D2 = 0, 9, 18, 27, 36
"""Levers at nine places, the second parameter runs first: slopes, director and its slopes."""
LEVERS = 45


def levers() -> Array:
    """Of the vectors of a cell, shape (45, 16)."""
    at = hermite.products(GRID, GRID)
    places, across = coons.table(at), coons.directors(at)
    parts = places[:, 1], places[:, 2], across[:, 0], across[:, 1], across[:, 2]
    return np.concatenate(parts)


def _edge(k: int, side: int, place: int) -> int:
    """Number in the grid of a place on an edge along ``k``."""
    i, j = (place, 2 * side) if k == 0 else (2 * side, place)
    return 3 * i + j


def terms() -> tuple[Indices, Array]:
    """Strain and both levers of each product (t, 3), and its factor (t,)."""
    found: list[tuple[float, ...]] = []
    for k, (r, d, membrane, shear, bent) in enumerate(
        ((_R1, _D1, E.E11, E.S1, K11), (_R2, _D2, E.E22, E.S2, K22))
    ):
        for side in range(2):
            for place, share in enumerate((-1 / 6, 4 / 3, -1 / 6)):
                at, number = _edge(k, side, place), 3 * side + place
                found.append((membrane + number, r + at, r + at, 0.5))
                found.append((shear + number, r + at, _D + at, 1.0))
                found.append((bent + side, r + at, d + at, share))
    for at in range(9):
        found.append((E.E12 + at, _R1 + at, _R2 + at, 1.0))
    found += [(MIDDLE, _R1 + 4, _R1 + 4, 0.5), (MIDDLE + 1, _R2 + 4, _R2 + 4, 0.5)]
    found += [(K12, _R1 + 4, _D2 + 4, 1.0), (K12, _R2 + 4, _D1 + 4, 1.0)]
    for corner, at in enumerate((0, 6, 2, 8)):
        found.append((E33 + corner, _D + at, _D + at, 0.5))
    table = np.array(found)
    return table[:, :3].astype(np.int64), np.ascontiguousarray(table[:, 3])
