r"""Strains of the beam of places and three slopes, and the compiled functions of its cells.

A point of the section is ``r + y r_y + z r_z``, with ``r`` a cubic of places and slopes ``r_x`` of
both ends and ``r_y``, ``r_z`` linear. All strains are products of vectors at three places, the two
ends and the middle:

- ``(E₁₁, 2 E₁₂, 2 E₁₃) = (½ r_x·r_x − ½, r_x·r_y, r_x·r_z)`` at all three,
- ``κ = (½ (r_y'·r_z − r_z'·r_y), r_x·r_z', −r_x·r_y')``, the twist in the middle, of the others
  four thirds of the middle less a third of the mean of both ends: on an arc of the angle α within
  the cell they are ``2 sin ½α/ℓ`` and ``sin α/ℓ``, and together ``α/ℓ`` but for ``α⁵/480ℓ``,
- ``(E₂₂, E₃₃, 2 E₂₃)`` of the section at both ends.

They are eighteen, as many as a cell has motions that are not rigid: none of them has to be where
another is wanted. Where a thin beam bends far within a cell the cubics and lines cannot be without
stretch, shear and deformation of the section everywhere, but they can be so at the nodes and in the
middle. Integrated at Gauss points they lock.

Less those of the unloaded cell they are what the energy is of. As they are quadratic in the
vectors, the geometric matrix is constant for constant stress.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import callback
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

NODES, VECTORS = 4, 8
"""A cell has the SURFACE nodes of its ends, with place and ``r_x``, then their CROSSING ones, with
``r_y`` and ``r_z``."""

STRAINS, _POINT_VECTORS = 18, 11
BEAM, CURVATURE, SECTION = 0, 9, 12
"""Where strains of the axis, curvatures, and those of the sections begin."""

_X, _Y, _Z, _DY, _DZ = 0, 3, 6, 9, 10
"""Vectors: ``r_x``, ``r_y``, ``r_z`` at one end, the middle, the other end; ``r_y'``, ``r_z'``."""


def _terms() -> Array:
    """Strain, both vectors and the factor of each product, shape (t, 4)."""
    found: list[tuple[float, ...]] = []
    for p in range(3):
        x, y, z = _X + p, _Y + p, _Z + p
        found += [(3 * p, x, x, 0.5), (3 * p + 1, x, y, 1.0), (3 * p + 2, x, z, 1.0)]
    y, z = _Y + 1, _Z + 1
    found += [(CURVATURE, _DY, z, 0.5), (CURVATURE, _DZ, y, -0.5)]
    for x, share in ((_X, -1 / 6), (_X + 1, 4 / 3), (_X + 2, -1 / 6)):
        found += [(CURVATURE + 1, x, _DZ, share), (CURVATURE + 2, x, _DY, -share)]
    for end, p in enumerate((0, 2)):
        k, y, z = SECTION + 3 * end, _Y + p, _Z + p
        found += [(k, y, y, 0.5), (k + 1, z, z, 0.5), (k + 2, y, z, 1.0)]
    return np.array(found)


def _tables(lengths: Array) -> Array:
    """The eleven vectors of those of the nodes, shape (m, 1, 11, 8), of lengths (m,)."""
    chord, rate = 1.5 / lengths, 1.0 / lengths
    T = np.zeros((len(lengths), 1, _POINT_VECTORS, VECTORS))
    # the nodes have r, r_x of both ends, then r_y, r_z of both
    T[:, 0, _X, 1] = T[:, 0, _X + 2, 3] = 1.0
    T[:, 0, _X + 1, 0], T[:, 0, _X + 1, 2] = -chord, chord
    T[:, 0, _X + 1, [1, 3]] = -0.25
    for k in range(2):
        first, last = 4 + k, 6 + k
        T[:, 0, _Y + 3 * k, first] = T[:, 0, _Y + 3 * k + 2, last] = 1.0
        T[:, 0, _Y + 3 * k + 1, [first, last]] = 0.5
        T[:, 0, _DY + k, first], T[:, 0, _DY + k, last] = -rate, rate
    return T


ELEMENT = element(
    [NodeKind.SURFACE] * 2 + [NodeKind.CROSSING] * 2,
    _terms(),
    vectors=_POINT_VECTORS,
    strains=STRAINS,
)


def data(rows: Array, lengths: Array, C: Array) -> Array:
    """Data of cells.

    Args:
        rows: Of the nodes of the cells, unloaded, shape (m, 4, 4, 3).
        lengths: Of the cells, shape (m,).
        C: Of the cells, shape (m, 18, 18).
    """
    T, (node, number) = _tables(lengths), ELEMENT.cells.coordinates.T[:2]
    return data_at_rest(ELEMENT, T, T @ rows[:, np.newaxis, node, number], C[:, np.newaxis])


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
