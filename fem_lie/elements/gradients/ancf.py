"""Fully parametrised ANCF beam: positions and three position gradients; sections deform.

A point of the section is ``r + y r_y + z r_z``; ``r`` is the cubic through the positions and
gradients ``r_x`` of both ends, and ``r_y``, ``r_z`` are linear. All strains are products of vectors
at three points, the two ends and the midpoint:

- ``(E₁₁, 2 E₁₂, 2 E₁₃) = (½ r_x·r_x − ½, r_x·r_y, r_x·r_z)`` at all three,
- ``κ = (½ (r_y'·r_z − r_z'·r_y), r_x·r_z', −r_x·r_y')``, the twist at the midpoint, of the others
  four thirds of the midpoint value less a third of the mean of both ends: on an arc of the angle α
  within the cell these are ``2 sin ½α/ℓ`` and ``sin α/ℓ``, and together ``α/ℓ`` up to ``α⁵/480ℓ``,
- ``(E₂₂, E₃₃, 2 E₂₃)`` of the section at both ends.

There are eighteen, as many as a cell has deformation modes, so that none of them constrains
another. In a thin beam with large bending within a cell, cubics and lines cannot be free of axial
strain, shear and deformation of the section everywhere, but they can be so at the nodes and at the
midpoint. Integrated at Gauss points they lock. The strains of the unloaded cell are subtracted. As
they are quadratic in the vectors, the geometric stiffness is constant for constant stress.

The strains of the axis and the curvatures have the stiffness ``D`` of the section. With
``b = (E₁₁, 2E₁₂, 2E₁₃, κ₁, κ₂, κ₃)``, its mean ``b̄`` by Simpson's rule over ends and midpoint, and
``D*`` the stiffness with the residual bending flexibility of MacNeal,
:func:`~fem_lie.elements.beams.element.with_bending_flexibility`::

    W = ½ ℓ b̄·D* b̄ + ½ ℓ Σ wₚ (bₚ − b̄)·D (bₚ − b̄) + ½ ½ℓ Σ_ends a·M a

So the mean stress is that of end forces for small deflections, where ``D`` would lock. The last
term is that of the section, ``a = (E₂₂ + ν E₁₁, E₃₃ + ν E₁₁, 2E₂₃)``: with the elasticity of an
isotropic solid the energy of ``(E₁₁, E₂₂, E₃₃)`` is exactly ``½ EA E₁₁²`` and ``½ a·M a``. Bending
has ``E I`` without that, since the section may be curved across the bending direction; in a solid
with linear ``r_y``, ``r_z`` it could not, and would be stiffer by ``(1 − ν)/((1 + ν)(1 − 2ν))``.

Sources: J. Gerstmayr & A. A. Shabana, *Nonlinear Dyn.* 45 (2006) 109; K. Nachbagauer, A. S.
Pechstein, H. Irschik & J. Gerstmayr, *Multibody Syst. Dyn.* 26 (2011) 245 (closed form, and why the
solid locks); M. Patel & A. A. Shabana, *J. Sound Vib.* 432 (2018) 200 (the strain split).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, number
from fem_lie._jit import callback
from fem_lie.attachments.at_nodes import on_section
from fem_lie.attachments.attachment import AttachmentFrame
from fem_lie.elements.beams.element import with_bending_flexibility
from fem_lie.forms.kernels.addresses import Pointer
from fem_lie.forms.small_energy.assembly import CellFunctions
from fem_lie.forms.small_energy.cell import (
    add_energy,
    add_forces,
    add_tangent_at_stress,
    update_stress,
)
from fem_lie.forms.small_energy.element import CELL_SIGNATURE, data_at_rest, element
from fem_lie.lie.node_types.node_type import NodeType
from fem_lie.mesh.bicubic.hermite import lagrange

NODES, VECTORS = 4, 8
"""Nodes of a cell: the SURFACE_GRADIENT nodes of both ends, with position and ``r_x``, then their
MIXED_DERIVATIVE nodes, with ``r_y`` and ``r_z``. Vectors: four at each end.
"""

STRAINS, _POINT_VECTORS = 18, 11
BEAM, CURVATURE, SECTION = 0, 9, 12
"""First index of the strains of the axis, of the curvatures, and of the strains of the sections."""

_X, _Y, _Z, _DY, _DZ = 0, 3, 6, 9, 10
"""Vectors: ``r_x``, ``r_y``, ``r_z`` at one end, midpoint, other end; ``r_y'``, ``r_z'``."""


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
    """Eleven vectors from those of the nodes, shape (m, 1, 11, 8), for lengths (m,)."""
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
    [NodeType.SURFACE_GRADIENT] * 2 + [NodeType.MIXED_DERIVATIVE] * 2,
    _terms(),
    vectors=_POINT_VECTORS,
    strains=STRAINS,
)


def data(coordinates: Array, lengths: Array, C: Array) -> Array:
    """Data of cells.

    Args:
        coordinates: Unloaded coordinates of the nodes of the cells, shape (m, 4, 4, 3).
        lengths: Lengths of the cells, shape (m,).
        C: Stiffness on the strains of each cell, shape (m, 18, 18).
    """
    T, (node, number) = _tables(lengths), ELEMENT.cells.coordinates.T[:2]
    return data_at_rest(ELEMENT, T, T @ coordinates[:, np.newaxis, node, number], C[:, np.newaxis])


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

_SIMPSON = np.array([1.0, 4.0, 1.0]) / 6
_SAMPLES = np.array([0.0, 0.5, 1.0])
"""Points of the strains of the axis."""
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(4)
_NODE = np.array([0, 0, 2, 2, 1, 1, 3, 3])
_ROW = np.array([0, 1, 1, 2, 0, 1, 1, 2])
"""Index of the vectors ``(r, r_x, r_y, r_z)`` of both ends in the coordinates of a cell's nodes."""


@dataclass(frozen=True)
class AncfElement:
    """Finite element of :class:`~fem_lie.AncfBeam`.

    Attributes:
        poisson: Poisson's ratio of the sections; default: that of a section with known moduli, else
            zero.
        bending_flexibility: Whether the mean stress has the residual bending flexibility.

    Raises:
        ValueError: Poisson's ratio is not between −1 and 0.5.
    """

    poisson: float | None = None
    bending_flexibility: bool = True

    def __post_init__(self) -> None:
        """Check Poisson's ratio."""
        if self.poisson is not None:
            check_poisson(number(self.poisson, "AncfElement: poisson"))

    def stiffness(self, D: Array, poisson: Array, ends: Array, lengths: Array) -> Array:
        """Stiffness ``C`` of cells on their strains, shape (m, 18, 18).

        Args:
            D: Section stiffness on (Γ, κ), shape (m, 6, 6).
            poisson: Poisson's ratio of the sections, shape (m,).
            ends: Unloaded frames of both ends, shape (m, 2, 4, 3).
            lengths: Lengths of the cells, shape (m,).
        """
        mean, b = self._mean_stiffness(D, ends), _axis_strains()
        average = np.einsum("p,pik->ik", _SIMPSON, b)
        rest = b - average
        C = np.einsum("ia,mij,jb->mab", average, mean, average, optimize=True)
        C += np.einsum("p,pia,mij,pjb->mab", _SIMPSON, rest, D, rest, optimize=True)
        for end in range(2):
            a = _section_strains(end, poisson)
            C += 0.5 * np.einsum("mia,mij,mjb->mab", a, _across(D[:, 0, 0], poisson), a)
        return np.asarray(lengths[:, np.newaxis, np.newaxis] * C)

    def _mean_stiffness(self, D: Array, ends: Array) -> Array:
        """Stiffness ``D*`` of the mean strains, shape (m, 6, 6)."""
        if not self.bending_flexibility:
            return D
        return with_bending_flexibility(D, lie.se3_relative(ends[:, 0], ends[:, 1]))

    def stress(
        self, D: Array, poisson: Array, ends: Array, lengths: Array, at: Array
    ) -> tuple[Array, Array]:
        """Stress at points of cells as a function of their strains, and its compliance.

        The nine components are ``D (b − b̄) + D* b̄`` and ``M a``; ``b`` is the parabola through
        its three values, ``a`` linear.

        Args:
            D: Section stiffness on (Γ, κ), shape (m, 6, 6).
            poisson: Poisson's ratio of the sections, shape (m,).
            ends: Unloaded frames of both ends, shape (m, 2, 4, 3).
            lengths: Lengths of the cells, shape (m,).
            at: Points from 0 to 1, shape (q,).

        Returns:
            Matrices, shape (m, q, 9, 18), and compliance, shape (m, 9, 9).
        """
        b, across = _axis_strains(), _across(D[:, 0, 0], poisson)
        own = np.einsum("qp,pik->qik", lagrange(_SAMPLES, at), b)
        mean = np.einsum(
            "mij,jk->mik", self._mean_stiffness(D, ends) - D, _SIMPSON @ b.swapaxes(0, 1)
        )
        section = [np.einsum("mij,mjk->mik", across, _section_strains(k, poisson)) for k in (0, 1)]
        found = np.empty((len(D), len(at), 9, STRAINS))
        found[:, :, :6] = np.einsum("mij,qjk->mqik", D, own) + mean[:, np.newaxis]
        found[:, :, 6:] = np.einsum("kq,kmij->mqij", np.stack([1 - at, at]), np.stack(section))
        compliance = np.zeros((len(D), 9, 9))
        compliance[:, :6, :6], compliance[:, 6:, 6:] = np.linalg.inv(D), np.linalg.inv(across)
        return found, compliance

    def attachment_frame(self, nodes: Sequence[int], part: float, length: float) -> AttachmentFrame:
        """Attachment frame of the section at a point within a cell.

        Args:
            nodes: Nodes of the cell.
            part: Unloaded arc length from its first end over its length.
            length: Length of the cell.
        """
        shares = np.zeros((NODES, 2, 3))
        shares[:2, :, 0] = np.array(_hermite(part, length)).reshape(2, 2)
        for k in range(2):
            shares[2, k, 1 + k], shares[3, k, 1 + k] = 1 - part, part
        return on_section(nodes, shares)

    def inertia(self, density: Array, lengths: Array) -> Array:
        """Mass matrix in the nodal coordinates of cells, shape (m, 4, 4, 4, 4).

        Args:
            density: Mass matrix of (x, d₁, d₂, d₃) per length, shape (m, 4, 4).
            lengths: Lengths of the cells, shape (m,).
        """
        s, w = 0.5 + 0.5 * _POINTS, 0.5 * _WEIGHTS
        N = np.zeros((len(lengths), len(s), 4, VECTORS))
        h = lengths[:, np.newaxis]
        for vector, shape in zip((0, 1, 4, 5), _hermite(s, h), strict=True):
            N[:, :, 0, vector] = shape
        for k in (2, 3):
            N[:, :, k, k], N[:, :, k, 4 + k] = 1 - s, s
        M = np.einsum("m,p,mpia,mij,mpjb->mab", lengths, w, N, density, N, optimize=True)
        found = np.zeros((len(lengths), NODES, 4, NODES, 4))
        a, b = np.meshgrid(range(VECTORS), range(VECTORS), indexing="ij")
        found[:, _NODE[a], _ROW[a], _NODE[b], _ROW[b]] = M
        return found


def _hermite(s: Array | float, h: Array | float) -> tuple[Array | float, ...]:
    """Shape functions of position and gradient, first of one end, at ``s`` for lengths ``h``."""
    r = 1 - s
    return r**2 * (1 + 2 * s), h * s * r**2, s**2 * (3 - 2 * s), h * s**2 * (s - 1)


def check_poisson(value: float) -> float:
    """Raise ``ValueError`` if ``value`` is not Poisson's ratio of a stable compressible solid."""
    if not -1.0 < value < 0.5:
        raise ValueError(f"Poisson's ratio must lie between -1 and 0.5, got {value!r}")
    return value


def _axis_strains() -> Array:
    """Matrix from all strains to ``b`` at the three points, shape (3, 6, 18)."""
    b = np.zeros((3, 6, STRAINS))
    for p in range(3):
        for k in range(3):
            b[p, k, 3 * p + k] = b[p, 3 + k, CURVATURE + k] = 1.0
    return b


def _section_strains(end: int, poisson: Array) -> Array:
    """Matrix from all strains to ``a`` at an end, shape (m, 3, 18)."""
    a = np.zeros((len(poisson), 3, STRAINS))
    for k in range(3):
        a[:, k, SECTION + 3 * end + k] = 1.0
    a[:, 0, 6 * end] = a[:, 1, 6 * end] = poisson
    return a


def _across(EA: Array, poisson: Array) -> Array:
    """Section matrix ``M``, shape (m, 3, 3)."""
    M = np.zeros((len(EA), 3, 3))
    lame = EA * poisson / ((1 + poisson) * (1 - 2 * poisson))
    M[:, 2, 2] = 0.5 * EA / (1 + poisson)
    M[:, 0, 1] = M[:, 1, 0] = lame
    M[:, 0, 0] = M[:, 1, 1] = lame + 2 * M[:, 2, 2]
    return M
