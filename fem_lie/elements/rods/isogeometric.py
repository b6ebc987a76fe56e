"""Isogeometric cable: cubic spline, continuously differentiable, of any parametrisation.

Between two knots a cubic spline with double inner knots is the cubic through positions and
derivatives ``dr/du`` at both. So its nodes are those of the Hermite cable, which is this element
with the arc length as parameter ``u``. With ``J = |dr/du|`` of the initial, unstretched curve,
strains are per arc length::

    ε = |r_u|/J − 1,    κ = |r_u × r_uu|/(|r_u|² J),    ds = J du

so that a curve of any parameter speed is initially unstretched, and knot insertion does not change
it. Quadrature points and the tension-only law are those of the Hermite cable. (Isogeometric cables:
Raknes, Deng, Bazilevs, Benson, Mathisen & Kvamsdal, CMAME 263 (2013) 127.)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_lie._arrays import Array
from fem_lie.elements.beams.element import CellData
from fem_lie.elements.rods.cable import HermiteCable, derivatives, signs
from fem_lie.forms.frames import NodalFrames


@dataclass(frozen=True)
class IsogeometricCable(HermiteCable):
    """Cable element of a cubic spline; options as of :class:`~fem_lie.elements.HermiteCable`."""

    def speeds(self, ends: Array, lengths: Array, along: Array) -> Array:
        """Arc length per parameter of the initial curve, shape (m, p)."""
        rate, _ = derivatives(ends, signs(ends) * lengths, along)
        return np.asarray(np.linalg.norm(rate, axis=-1))

    def inertia(self, nodal: NodalFrames, cells: CellData) -> Array:
        """Mass matrix ``∫ ρA Nᵢ Nⱼ J du``."""
        ends = nodal.frames[np.asarray(nodal.function.function_space.dofmap.list)]
        weights, positions, directors = self.line_shapes(ends, cells.lengths)
        shapes = np.stack([positions, directors[..., 0]], axis=-1)
        found = np.zeros((len(ends), 2, 4, 2, 4))
        mass = cells.density[:, 0, 0, np.newaxis] * weights
        found[:, :, :2, :, :2] = np.einsum("mp,mpia,mpjb->miajb", mass, shapes, shapes)
        return found
