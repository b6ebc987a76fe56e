"""Strain measures of shell elements: strains, stress fields and quadrature."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import pi

import basix
from ufl.core.expr import Expr

from fem_lie.elements.shells import decoupled, quadratic, strains
from fem_lie.elements.shells.strains import Point, Surface
from fem_lie.elements.shells.stress_modes import QUADRILATERAL, TRIANGLE, StressModes

Measure = Callable[[Surface, Point], Expr]
"""Covariant strain of a surface at a point, as in :mod:`fem_lie.elements.shells.strains`."""


@dataclass(frozen=True)
class StrainMeasures:
    """Strain measures of a shell element; the default is the four-node quadrilateral MITC4.

    Attributes:
        cell: Cell type.
        degree: Degree of the Lagrange nodes.
        quadrature_degree: 3 means 2×2 points on a quadrilateral.
        membrane: Membrane strain.
        bending: Bending strain.
        shear: Transverse shear strain.
        intermediate: Quantities that the others read from :attr:`Surface.intermediate`. Mixed
            elements have them as local unknowns, constrained by multipliers: the chain rule through
            a long formula is then evaluated numerically, in the condensation, and FFCx generates a
            third of the code.
        stresses: Stress fields of mixed elements, or ``None`` if there are none for these cells.
        largest_turn: Largest rotation along an edge of a cell, rad; beyond it cells fold, see
            :mod:`fem_lie.system.nodes.element_rotations`.
        bubble: Whether three-node triangles have a director bubble as local unknowns.
    """

    cell: basix.CellType = basix.CellType.quadrilateral
    degree: int = 1
    quadrature_degree: int = 3
    membrane: Measure = strains.membrane
    bending: Measure = strains.bending
    shear: Measure = strains.mitc4_shear
    intermediate: Callable[[Surface], Expr] | None = None
    stresses: StressModes | None = QUADRILATERAL
    bubble: bool = False
    largest_turn: float = pi / 2


MITC4 = StrainMeasures()
"""Four nodes; the mixed elements with these measures are those of Gruttmann & Wagner."""

MITC4_PLUS = StrainMeasures(membrane=strains.mitc4_plus_membrane)
"""Four nodes, also for distorted meshes of curved thin shells."""

DECOUPLED = StrainMeasures(
    bending=decoupled.decoupled_bending,
    intermediate=decoupled.tangents_and_cosines,
    largest_turn=pi,
)
"""Four nodes, bending strain without membrane strain; for mixed elements."""

MITC3_PLUS = StrainMeasures(
    cell=basix.CellType.triangle,
    quadrature_degree=4,
    shear=strains.mitc3_shear,
    stresses=TRIANGLE,
    bubble=True,
)
"""Three nodes and a bubble of the director; for mixed elements."""

MITC6 = StrainMeasures(
    cell=basix.CellType.triangle,
    degree=2,
    quadrature_degree=4,
    membrane=quadratic.mitc6_membrane,
    shear=quadratic.mitc6_shear,
    stresses=None,
    largest_turn=3.0,
)
"""Six nodes."""

MITC9 = StrainMeasures(
    degree=2,
    quadrature_degree=5,
    membrane=quadratic.mitc9_membrane,
    shear=quadratic.mitc9_shear,
    stresses=None,
    largest_turn=3.0,
)
"""Nine nodes."""
