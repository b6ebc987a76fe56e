"""Patch coupling of thin shells: positions and normals of two cells at one point of their edges.

With positions ``r``, covariant tangents ``r₁, r₂`` and normals ``n`` of both sides at a point of
the coupling, ``w`` its fraction of the length, ``N`` and ``M`` stiffness per length::

    e = (r_A − r_B + D (r₁, r₂, n)_A, n_A − n_B + C (r₁, r₂, n)_A),    W = ½ w (N |e_r|² + M |e_n|²)

where the constants ``D``, ``C`` are such that the unloaded shell has ``e = 0``; rigid motion causes
no strain either. Both sides may have any parametrisations.
"""

from __future__ import annotations

import math

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import callback, compiled
from fem_lie.elements.thin_shells.nodal_coordinates import COORDINATES, CORNERS, VECTORS
from fem_lie.forms.cell_sums import Pattern
from fem_lie.forms.kernels.addresses import Pointer
from fem_lie.forms.small_energy.assembly import CellFunctions, ElementCells
from fem_lie.forms.small_energy.cell import (
    add_energy,
    add_forces,
    add_tangent_at_stress,
    update_stress,
)
from fem_lie.forms.small_energy.element import CELL_SIGNATURE, cell_data, element
from fem_lie.lie.node_types.node_type import NodeType
from fem_lie.lie.tuples import Vector, cross, dot, scaled
from fem_lie.mesh.bicubic.patch_coupling import CouplingPoints


@compiled
def _unit_normal(slopes: tuple[float, float, float, float, float, float]) -> Vector:
    """Unit normal of two tangents."""
    m = cross(slopes[:3], slopes[3:])
    return scaled(1.0 / math.sqrt(dot(m, m)), m)


_GAP, _TURN = 4, 5
"""Linear vectors: tangents of both sides, then ``r_A − r_B + D (r₁, r₂)`` and ``C (r₁, r₂)``."""
_UNIT, _UNIT_D, _UNIT_C = 6, 9, 12
"""Constant vectors: unit vectors, and these times the factors of ``n_A`` in both strains."""
_NORMALS = 15, 16
_LINEAR, _CONSTANT, _STRAINS = 6, 9, 6


def _products() -> list[tuple[int, int, int, float]]:
    """Strain, both vectors and the factor of each product."""
    found = []
    for k in range(3):
        found += [(k, _GAP, _UNIT + k, 1.0), (k, _NORMALS[0], _UNIT_D + k, 1.0)]
        found += [(3 + k, _TURN, _UNIT + k, 1.0), (3 + k, _NORMALS[0], _UNIT_C + k, 1.0)]
        found += [(3 + k, _NORMALS[1], _UNIT + k, -1.0)]
    return found


ELEMENT = element(
    ([NodeType.SURFACE_GRADIENT] * CORNERS + [NodeType.MIXED_DERIVATIVE] * CORNERS) * 2,
    _products(),
    vectors=_LINEAR,
    constants=_CONSTANT,
    strains=_STRAINS,
    derive=_unit_normal,
    inputs=[(0, 1), (2, 3)],
)


def _data(points: CouplingPoints) -> Array:
    """Data of the cells."""
    b = len(points.nodes)
    scales = np.ones((b, 2, 1, VECTORS))
    for k in range(3):
        scales[..., 1 + k :: 4] = points.sizes.reshape(b, 2, 1, 3)[..., k : k + 1]
    shapes = (points.shapes.reshape(b, 2, 3, VECTORS) * scales).transpose(1, 2, 0, 3)
    (r, r1, r2), (s, s1, s2) = shapes
    D, C = points.taken[:, :3, np.newaxis], points.taken[:, 3:, np.newaxis]
    none = np.zeros_like(r)
    linear = [
        (r1, none),
        (r2, none),
        (none, s1),
        (none, s2),
        (r + D[:, 0] * r1 + D[:, 1] * r2, -s),
        (C[:, 0] * r1 + C[:, 1] * r2, none),
    ]
    tables = np.stack(
        [np.concatenate([side[:, COORDINATES] for side in each], axis=1) for each in linear], axis=1
    )
    factors = np.column_stack([np.ones(b), points.taken[:, 2], 1.0 + points.taken[:, 5]])
    constants = factors[:, :, np.newaxis, np.newaxis] * np.eye(3)
    law = np.zeros((b, _STRAINS, 1 + _STRAINS))
    law[:, range(_STRAINS), range(1, 1 + _STRAINS)] = np.repeat(points.stiffness, 3, axis=1)
    parameters = np.hstack([law[:, :, 0], law[:, :, 1:].reshape(b, -1)])
    return cell_data(
        ELEMENT,
        tables[:, np.newaxis],
        parameters[:, np.newaxis],
        constants=constants.reshape(b, 1, _CONSTANT, 3),
    )


@callback(CELL_SIGNATURE)
def energy_of_point(A: Pointer, w: Pointer, h: Pointer) -> None:
    """Energy of a point."""
    add_energy(ELEMENT, A, w)


@callback(CELL_SIGNATURE)
def forces_of_point(A: Pointer, w: Pointer, h: Pointer) -> None:
    """Forces of a point."""
    add_forces(ELEMENT, A, w)


@callback(CELL_SIGNATURE)
def tangent_of_point(A: Pointer, w: Pointer, h: Pointer) -> None:
    """Tangent stiffness of a point."""
    add_tangent_at_stress(ELEMENT, A, w)


@callback(CELL_SIGNATURE)
def stress_of_point(A: Pointer, w: Pointer, h: Pointer) -> None:
    """Linearised stress of a point."""
    update_stress(ELEMENT, A, w, h)


class CouplingSprings(ElementCells):
    """Springs at the points of couplings, on the nodes of their assembly."""

    label, of_bodies = "couplings", True

    def __init__(self, points: CouplingPoints, count: int) -> None:
        """Pack the points, on an assembly with ``count`` nodes."""
        self._pattern, self._points = Pattern.of(points.nodes, count), points
        functions = CellFunctions(
            energy_of_point, forces_of_point, tangent_of_point, stress_of_point
        )
        self._bind(ELEMENT, functions, points.nodes, _data(points))

    @property
    def contents(self) -> CouplingPoints:
        """Record of the points."""
        return self._points
