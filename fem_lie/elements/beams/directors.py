"""Beam in positions and directors, ``R³ × SO(3)``: strain measures in UFL.

``Γ = Rᵀ x′ − Γ₀``, ``κ = axial(Rᵀ R′) − κ₀`` with ``R = [d₁ d₂ d₃]`` interpolated as it is (Simo &
Vu-Quoc, CMAME 58 (1986) 79; Romero & Armero, IJNME 54 (2002) 1683). With one-point quadrature on
two nodes, or two-point on three, there is no shear locking. Both measures are invariant under
superposed rigid motion, as products of vectors that rotate together.

Interpolated directors are not orthonormal between the nodes. With two nodes that rotate by θ
against each other, the middle has ``κ ∝ sin θ`` and shrinks ``Γ`` by ``cos θ/2``: too soft.
:func:`midpoint_strains` undoes it. With three nodes the shrinkage is of higher order than the
element where rotations are smooth. An alternating rotation, though, would shorten ``x′`` in the
axes of the directors without shear, and elements of length h would buckle in tension at
``24 EI/h²``: :func:`orthonormal_strains` takes that back.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import ufl
from ufl.core.expr import Expr
from ufl.variable import Variable

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie.elements.beams.element import (
    BeamFormulation,
    CellData,
    bending_share,
    cellwise,
    flexible_cells,
    present_values,
    with_bending_flexibility,
    with_elongation,
)
from fem_lie.forms.energy import StrainEnergy
from fem_lie.forms.frames import NodalFrames, local_frame_forms
from fem_lie.forms.local_forms import LocalFrameForms


def arc_derivative(f: Expr, domain: ufl.Mesh) -> Expr:
    """``f′ = df/ds`` along the mesh line, for ``f`` of shape ``(3,)``."""
    J = ufl.Jacobian(domain)
    tangent = ufl.as_vector([J[i, 0] for i in range(3)])
    return ufl.dot(ufl.grad(f), tangent / ufl.sqrt(ufl.dot(tangent, tangent)))


def director_strains(q: NodalFrames) -> tuple[Expr, Expr]:
    """``(Rᵀ x′, axial(Rᵀ R′))``, each of shape ``(3,)``, components along the directors.

    Subtract the values of the unloaded configuration to get Γ and κ. (Simo & Vu-Quoc 1986, eq. 2.)

    Args:
        q: Frames on a line mesh.
    """
    domain = q.function.function_space.mesh
    x, d = q.position, q.directors
    dx, dd = arc_derivative(x, domain), [arc_derivative(a, domain) for a in d]

    def turn(a: int, b: int) -> Expr:
        return (ufl.dot(d[a], dd[b]) - ufl.dot(d[b], dd[a])) / 2

    stretch = ufl.as_vector([ufl.dot(a, dx) for a in d])
    return stretch, ufl.as_vector([turn(2, 1), turn(0, 2), turn(1, 0)])


def midpoint_strains(q: NodalFrames) -> tuple[Expr, Expr, Variable]:
    """Strains at the midpoint of two-node cells, with the mean rotation and the exact angle.

    The directors' mean is ``A = R_m (c 1 + (1 − c) n nᵀ)``, ``c = cos θ/2``, if ``R_Aᵀ R_B``
    rotates by θ about ``n`` and ``R_m`` is the midpoint rotation; their plain curvature is ``w/L``
    with ``w = n sin θ``. Hence, in closed form,

    - ``R_mᵀ x′ = Aᵀx′/c − w (w · Aᵀx′) / (4 c³ (1 + c))``, exactly, with ``c² = (tr AᵀA − 1)/2``;
    - ``κ L = n θ = (w/c) F(sin² θ/4)``, ``sin² θ/4 = (1 − c)/2``, where ``F(sin² φ/2) = φ/sin φ``
      is a truncated Gauss continued fraction: relative error 1e-12 for θ = 45°, 6e-9 for 90°.
      (Huygens' rule, ``n (sin θ + 4 tan θ/2)/3``, has an error of θ⁵/120, but of θ⁵/20 in the
      moment, which is 2 % for 45°.)

    Evaluate them at the midpoint only (quadrature of degree 0 or 1), for θ below π, where c = 0.

    Args:
        q: Frames of degree 1 on a line mesh of straight cells.

    Returns:
        Both strains, and the plain quantities ``(Aᵀx′, w/L, c²)`` in which they are written, for
        ``through`` of :class:`~fem_lie.forms.energy.StrainEnergy`.
    """
    c2 = (sum(ufl.dot(d, d) for d in q.directors) - 1) / 2
    stretch, curvature = director_strains(q)
    z = ufl.variable(ufl.as_vector([*stretch, *curvature, c2]))
    stretch, curvature = (ufl.as_vector([z[i + k] for i in range(3)]) for k in (0, 3))
    c2 = z[6]
    L, c = ufl.CellVolume(q.function.function_space.mesh), ufl.sqrt(c2)
    lever = L**2 * ufl.dot(curvature, stretch) / (4 * c * c2 * (1 + c))
    return stretch / c - lever * curvature, curvature * (_angle_over_sine((1 - c) / 2) / c), z


def orthonormal_strains(q: NodalFrames) -> tuple[Expr, Expr, Variable]:
    """Strains with directors that are orthonormal to second order.

    The interpolated ``A = [d₁ d₂ d₃]`` is ``R U`` with ``U ≈ 1 − E``, ``E = ½ (1 − AᵀA)``. Hence::

        Rᵀ x′ = (1 + E) Aᵀ x′,    axial(RᵀR′) = (1 + tr E − E) axial(AᵀA′),

    to first order in ``E``, which is of second order in the rotation along an element.

    Args:
        q: Frames on a line mesh.

    Returns:
        Both strains, and the plain quantities ``(Aᵀx′, axial(AᵀA′), AᵀA)`` in which they are
        written, for ``through`` of :class:`~fem_lie.forms.energy.StrainEnergy`.
    """
    d = q.directors
    products = [ufl.dot(d[i], d[j]) for i, j in _PAIRS]
    stretch, curvature = director_strains(q)
    z = ufl.variable(ufl.as_vector([*stretch, *curvature, *products]))
    at = {pair: 6 + k for k, pair in enumerate(_PAIRS)}
    G = ufl.as_matrix([[z[at[min(i, j), max(i, j)]] for j in range(3)] for i in range(3)])
    a, κ = (ufl.as_vector([z[i + k] for i in range(3)]) for k in (0, 3))
    E = (ufl.Identity(3) - G) / 2
    return a + E * a, κ + ufl.tr(E) * κ - E * κ, z


_PAIRS = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]


def _angle_over_sine(u: Expr) -> Expr:
    """``φ/sin φ`` of ``u = sin² φ/2``, by five terms of Gauss' continued fraction.

    ``arcsin x / √(1 − x²) = x/(1 − 1·2 x²/(3 − 1·2 x²/(5 − 3·4 x²/(7 − 3·4 x²/(9 − 5·6 x²/(11 …``,
    without a singularity at zero. (Abramowitz & Stegun 4.4.44.)
    """
    fraction: Expr | float = 11.0
    for odd, factor in ((9, 30), (7, 12), (5, 12), (3, 2), (1, 2)):
        fraction = odd - factor * u / fraction
    return 1 / fraction


_FOLDS = 2.7312  # rad: of three nodes, where ∂²W/∂φ² of the middle one is no longer positive


@dataclass(frozen=True)
class DirectorBeam(BeamFormulation):
    """Beam element with interpolated positions and directors, ``R³ × SO(3)``.

    Degree 1 has two nodes and one quadrature point with the strains of :func:`midpoint_strains`;
    because of the straight chord it is of second order. Degree 2 has three nodes, two points and
    the :func:`orthonormal_strains` per length of its own quadratic line: at these points
    derivatives of quadratic interpolation are superconvergent, and nodal values are of fourth
    order. Neither locks. The strains of the unloaded frames are subtracted, so that an unloaded
    line is stress-free, however curved and twisted.

    Attributes:
        degree: 1 or 2; a cell has ``degree + 1`` nodes.
        bending_flexibility: Add the residual bending flexibility (MacNeal 1978) to degree 1, as in
            :class:`~fem_lie.elements.beams.geodesic.GeodesicBeam`. Degree 2 has linear moments
            already, and does not use it.

    Raises:
        ValueError: The degree is neither 1 nor 2.
    """

    degree: int = 1
    bending_flexibility: bool = True

    def __post_init__(self) -> None:
        if self.degree not in (1, 2):
            raise ValueError(f"the degree of a Director must be 1 or 2, got {self.degree!r}")

    @property
    def largest_turn(self) -> float:
        """Largest rotation along an element, rad: π, less with three nodes.

        With three nodes the middle node becomes unstable beyond it.
        """
        return _FOLDS if self.degree == 2 else super().largest_turn

    def effective_stiffness(self, stiffness: Array, relative: Array) -> Array:
        """Section stiffness, with the residual bending flexibility for two nodes, (m, 6, 6)."""
        if self.degree == 2 or not self.bending_flexibility:
            return stiffness
        lengths = np.linalg.norm(relative[:, :3], axis=1, keepdims=True)
        return with_bending_flexibility(stiffness, lengths * np.eye(1, 6))

    def mean_stress(self, stress: Array, frames: Array, ends: Array) -> Array:
        """Mean stress along section axes; for degree 1 shear follows from end moments, too."""
        if self.degree == 2:
            return stress
        a, b = frames[:, 0], frames[:, 1]
        middle = lie.se3_retract(a, 0.5 * lie.se3_relative(a, b))
        force = np.einsum("mij,mi->mj", b[:, 1:], ends[:, 1, :3])
        along = np.einsum("mij,mj->mi", middle[:, 1:], force)
        return np.concatenate([along, stress[:, 0, 3:]], axis=1)[:, np.newaxis]

    def forms(self, nodal: NodalFrames, cells: CellData) -> LocalFrameForms:
        """DOLFINx forms of energy, forces and tangent of interpolated positions and directors."""
        mesh = nodal.function.function_space.mesh
        points = 2 * self.degree - 1  # the degree to which 1 and 2 Gauss points are exact
        # arc per length of the mesh: strains are per arc, and so is the energy
        share: Array | None = None
        if self.degree == 1:
            if self.bending_flexibility:
                section = cells.stiffness
                # the mesh is straight from node to node
                cells = flexible_cells(cells, cells.lengths[:, np.newaxis] * np.eye(1, 6))
                share = bending_share(section, cells.stiffness)
            stretch, curvature, through = midpoint_strains(nodal)
            arc = cellwise(mesh, cells.lengths) / ufl.CellVolume(mesh)
        else:
            stretch, curvature, through = orthonormal_strains(nodal)
            slope = arc_derivative(nodal.position, mesh)
            arc = present_values(ufl.sqrt(ufl.dot(slope, slope)), mesh, points)
        strain = ufl.as_vector([*stretch, *curvature]) / arc
        strain = strain - present_values(strain, mesh, points)
        if share is not None:
            shear = ufl.as_vector([strain[1], strain[2]])
            strain = with_elongation(strain, shear, cellwise(mesh, share))
        stiffness = cellwise(mesh, cells.stiffness)
        energy = StrainEnergy(
            strain=strain - cells.eigenstrain,
            law=lambda strain: 0.5 * ufl.inner(strain, stiffness * strain),
            dx=ufl.Measure("dx", domain=mesh, metadata={"quadrature_degree": points}),
            weight=arc,
            viscosity=None if cells.viscosity is None else cellwise(mesh, cells.viscosity),
            through=through,
        )
        return local_frame_forms(energy, nodal)
