"""Strains of the plate of places and three slopes, and the compiled functions of its cells.

Strains are sums of products of vectors, the energy is ``½ ε·C ε`` of those less the strains of the
unloaded cell, with the ``C`` of :mod:`.plate`. Nodes are those of thin shells, with the slope
across the thickness where these have the mixed derivative.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import callback
from fem_lie.elements.gradients import coons
from fem_lie.elements.thin_shells import hermite
from fem_lie.elements.thin_shells.rows import COORDINATES, CORNERS
from fem_lie.forms.kernels.addresses import Pointer
from fem_lie.forms.small_energy.assembly import CellFunctions
from fem_lie.forms.small_energy.cell import (
    add_energy,
    add_forces,
    add_tangent_at_stress,
    update_stress,
)
from fem_lie.forms.small_energy.element import CELL_SIGNATURE, data_at_rest, element
from fem_lie.lie.kinds.kind import NodeKind

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
"""Vectors at nine places, the second parameter runs first: slopes, director and its slopes."""
_POINT_VECTORS = 45


def _interpolation() -> Array:
    """The 45 vectors of those of the interpolation, shape (45, 16)."""
    at = hermite.products(GRID, GRID)
    places, across = coons.table(at), coons.directors(at)
    parts = places[:, 1], places[:, 2], across[:, 0], across[:, 1], across[:, 2]
    return np.concatenate(parts)


def _edge(k: int, side: int, place: int) -> int:
    """Number in the grid of a place on an edge along ``k``."""
    i, j = (place, 2 * side) if k == 0 else (2 * side, place)
    return 3 * i + j


def _terms() -> Array:
    """Strain, both vectors and the factor of each product, shape (t, 4)."""
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
    return np.array(found)


_INTERPOLATION, _TERMS = _interpolation(), _terms()
ELEMENT = element(
    [NodeKind.SURFACE] * CORNERS + [NodeKind.CROSSING] * CORNERS,
    _TERMS,
    vectors=_POINT_VECTORS,
    strains=STRAINS,
)


def data(q: Array, extraction: Array, C: Array) -> Array:
    """Data of cells.

    Args:
        q: Vectors of the interpolation, unloaded, shape (m, 16, 3).
        extraction: These of the coordinate vectors of nodes, shape (m, 16, 16).
        C: Of the cells, shape (m, 44, 44).
    """
    T = (_INTERPOLATION @ extraction)[:, np.newaxis, :, COORDINATES]
    return data_at_rest(ELEMENT, T, (_INTERPOLATION @ q)[:, np.newaxis], C[:, np.newaxis])


@callback(CELL_SIGNATURE)
def energy_of_cell(A: Pointer, w: Pointer, h: Pointer) -> None:
    """Energy of a cell."""
    add_energy(ELEMENT, A, w)


@callback(CELL_SIGNATURE)
def forces_of_cell(A: Pointer, w: Pointer, h: Pointer) -> None:
    """Forces of a cell."""
    add_forces(ELEMENT, A, w)


@callback(CELL_SIGNATURE)
def tangent_of_cell(A: Pointer, w: Pointer, h: Pointer) -> None:
    """Tangent stiffness of a cell."""
    add_tangent_at_stress(ELEMENT, A, w)


@callback(CELL_SIGNATURE)
def stress_of_cell(A: Pointer, w: Pointer, h: Pointer) -> None:
    """Linearised stress of a cell."""
    update_stress(ELEMENT, A, w, h)


FUNCTIONS = CellFunctions(energy_of_cell, forces_of_cell, tangent_of_cell, stress_of_cell)
