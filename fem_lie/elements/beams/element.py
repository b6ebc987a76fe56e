"""What a beam element family must provide: nodes per cell, and the forms of its energy."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import pi
from typing import ClassVar

import basix.ufl
import dolfinx
import numpy as np
import ufl
from dolfinx import fem
from ufl.core.expr import Expr

from fem_lie import _compat, lie
from fem_lie._arrays import Array
from fem_lie.attachments.attachment import AttachmentFrame
from fem_lie.attachments.between_frames import interpolated
from fem_lie.forms.frames import NodalFrames
from fem_lie.forms.local_forms import LocalFrameForms
from fem_lie.lie.node_types import TRAITS, NodeType


@dataclass(frozen=True, eq=False)
class CellData:
    """What the cells of one line mesh are made of, in the mesh's order.

    Attributes:
        lengths: Arc length of each unloaded cell, shape (m,).
        stiffness: Section stiffness on (Γ, κ), shape (m, 6, 6).
        density: Mass matrix of inertia per length, shape (m, 4, 4), zero without mass.
        eigenstrain: Strain without stress, a DG0 function of shape (6,) that changes with time.
        viscosity: Stress per strain rate (Γ̇, κ̇), shape (m, 6, 6), or ``None``.
        slopes: ``|dr/dξ|`` of cubics at both ends, zero for lines that are none, shape (m, 2).
    """

    lengths: Array
    stiffness: Array
    density: Array
    eigenstrain: fem.Function
    viscosity: Array | None
    slopes: Array


class BeamFormulation(ABC):
    """An element along a line: subclass it in one file, as a frozen dataclass of its options.

    Attributes:
        node_type: What its nodes are.
        degree: Of the nodal interpolation; a cell has ``degree + 1`` nodes.
        bows: Whether the axis of a cell of two nodes is the parabola with their tangents, for
            inertia and line loads; otherwise it is the interpolated one.
        viscous: Whether it has viscous forces.
        bends: Whether it bends and twists by itself, and not against the next one.
    """

    node_type: ClassVar[NodeType] = NodeType.FRAME
    degree: int
    bows: ClassVar[bool] = False
    viscous: ClassVar[bool] = True
    bends: ClassVar[bool] = True

    def require_bends(self, what: str) -> None:
        """Raise ``ValueError`` if ``what`` asks for bending within elements that have none.

        Args:
            what: What the user asked for, for the message.
        """
        if not self.bends:
            raise ValueError(
                f"{what} is not known of {self}, whose elements bend against each other and not "
                "within: take Kirchhoff() or an element of beams"
            )

    @property
    def largest_turn(self) -> float:
        """Of an element from end to end, rad, see :mod:`fem_lie.system.nodes.element_rotations`.

        It is π, where a rotation has two logarithms, unless the element folds before.
        """
        return pi

    def effective_stiffness(self, stiffness: Array, relative: Array) -> Array:
        """What the element takes for the section stiffness of its cells, shape (m, 6, 6).

        Args:
            stiffness: Of the section, shape (m, 6, 6).
            relative: Relative motion of the cells' ends, unloaded, shape (m, 6).
        """
        return stiffness

    @property
    def slackens(self) -> bool:
        """Whether it goes slack, with an energy that is convex all the same."""
        return False

    def check(self, stiffness: Array) -> None:
        """Raise ``ValueError`` if it has no unknowns for a section stiffness (6, 6).

        Args:
            stiffness: Section stiffness, shape (6, 6).
        """
        return

    def placed(self, frames: Array, stretch: float) -> Array:
        """Rows of the nodes, shape (n, 4, 3), that lie along a line.

        Args:
            frames: Places, and axes of which e₁ is the tangent, shape (n, 4, 3).
            stretch: Length of the line over that of the body, unstretched.
        """
        return frames

    def attachment(self, node: int) -> AttachmentFrame | None:
        """By what joints hold a node: ``None`` for the frame of its rows.

        Args:
            node: Number of the node.
        """
        return None

    def shares(self, ends: Array, lengths: Array) -> Array:
        """Length that each node of the cells carries, integrals of its shapes, (m, degree + 1).

        Args:
            ends: Rows of both ends, shape (m, 2, 4, 3).
            lengths: Of the cells, shape (m,).
        """
        return np.asarray(lengths[:, np.newaxis] * _INTEGRALS[self.degree])

    def levers(self, ends: Array, lengths: Array) -> Array:
        """What a unit line force on each cell does on the first vectors of its ends, (m, 2, 3).

        The default is ``∫ ½ (s − s²) (t_A − t_B) ℓ ds`` of a bowed axis, along the axes of A.

        Args:
            ends: Rows of both ends, shape (m, 2, 4, 3).
            lengths: Of the cells, shape (m,).
        """
        levers = np.zeros((len(lengths), 2, 3))
        if self.bows:
            moved = lie.se3_relative(ends[:, 0], ends[:, 1])[:, :3]  # ℓ times the slope
            along = lengths[:, np.newaxis] * moved / 12
            levers[:, 0], levers[:, 1] = along, -along
        return levers

    def place(self, nodes: Sequence[int], ξ: float) -> AttachmentFrame:
        """The frame at ``0 ≤ ξ ≤ 1`` along an element, as it is interpolated.

        The default is that of positions and directors.

        Args:
            nodes: Of the element, its two ends first.
            ξ: Arc length from its first end over its length, unloaded.
        """
        return interpolated(nodes, _SHAPES[self.degree](ξ))

    @abstractmethod
    def forms(self, nodal: NodalFrames, cells: CellData) -> LocalFrameForms:
        """Energy, forces and tangent.

        Args:
            nodal: Frames of ``degree`` on a line mesh, in the unloaded configuration.
            cells: What the cells are made of.
        """

    def mean_stress(self, stress: Array, frames: Array, ends: Array) -> Array:
        """Elastic force and moment in the axes of the section at the points of integration.

        The default is the stress itself, where strains are those of sections.

        Args:
            stress: That does work on the element's own strains, shape (m, g, 6).
            frames: Of the element's nodes, ends first, shape (m, k, 4, 3).
            ends: Elastic force and moment at both ends, in the frames there, shape (m, 2, 6).
        """
        return stress

    def inertia(self, nodal: NodalFrames, cells: CellData) -> Array:
        """Constant matrix of (x, d₁, d₂, d₃) of each cell's nodes, shape (m, k, r, k, r).

        It may be of the first ``r`` of these rows alone, where others have no inertia. The default
        is consistent with the interpolation of all by the Lagrange polynomials of the
        formulation's degree, 1 or 2.

        Args:
            nodal: As for :meth:`forms`.
            cells: What the cells are made of.
        """
        rows = TRAITS[self.node_type].rows.stop
        weighted = cells.lengths[:, np.newaxis, np.newaxis] * cells.density[:, :rows, :rows]
        return np.einsum("ij,eab->eiajb", _LAGRANGE[self.degree], weighted)


_SHAPES: dict[int, Callable[[float], Sequence[float]]] = {
    1: lambda ξ: (1.0 - ξ, ξ),
    2: lambda ξ: ((1.0 - ξ) * (1.0 - 2.0 * ξ), ξ * (2.0 * ξ - 1.0), 4.0 * ξ * (1.0 - ξ)),
}
"""Shape functions on a cell of unit length, ends first."""

_INTEGRALS = {1: np.array([1 / 2, 1 / 2]), 2: np.array([1 / 6, 1 / 6, 2 / 3])}
"""Of the shape functions on a cell of unit length, ends first."""

_LAGRANGE = {
    1: np.array([[2.0, 1], [1, 2]]) / 6,
    2: np.array([[4.0, -1, 2], [-1, 4, 2], [2, 2, 16]]) / 30,
}
"""Integrals of products of the shape functions on a cell of unit length, ends first."""


def cellwise(mesh: dolfinx.mesh.Mesh, values: Array) -> fem.Function:
    """Values of any shape, one for each cell, as a DG0 function.

    Args:
        mesh: The mesh.
        values: Values.
    """
    element = basix.ufl.element("DG", mesh.basix_cell(), 0, shape=values.shape[1:])
    f = fem.Function(fem.functionspace(mesh, element))
    f.x.array[:] = values.ravel()
    return f


def present_values(expression: Expr, mesh: dolfinx.mesh.Mesh, degree: int) -> fem.Function:
    """Values of an expression now, at the points of a quadrature of a degree.

    Args:
        expression: UFL expression.
        mesh: The mesh.
        degree: Degree of the cell.
    """
    element = basix.ufl.quadrature_element(
        _compat.cell_name(mesh.ufl_domain()), value_shape=expression.ufl_shape, degree=degree
    )
    f = fem.Function(fem.functionspace(mesh, element))
    f.interpolate(_compat.expression(expression, element.custom_quadrature()[0]))
    return f


def with_bending_flexibility(stiffness: Array, relative: Array) -> Array:
    """Section stiffness with which elements are exact for small deflections, whatever their shape.

    In equilibrium without loads a force and moment σ̄ in the middle is ``Ad(exp(s d₀))ᵀ σ̄`` at
    ``−½ ≤ s ≤ ½``, so that the complementary energy of the mean stress has the compliance::

        S⁻¹ ∫ A(s) C A(s)ᵀ ds S⁻ᵀ,    A(s) = Ad(exp(s d₀)),    S = ∫ A(s) ds.

    For a straight element of a diagonal section this is ``1/GA* = 1/GA + ℓ²/(12 EI)``, the residual
    bending flexibility of MacNeal, Comput. Struct. 8 (1978) 175; for others it is that of arcs and
    helices.

    Args:
        stiffness: Section stiffness per cell, shape (m, 6, 6).
        relative: Relative motion ``d₀`` of its ends, unloaded, shape (m, 6).
    """
    effective = _inverse(_of_the_mean(_inverse(stiffness), relative))
    return np.asarray(0.5 * (effective + _transposed(effective)))


def bending_share(section: Array, effective: Array) -> Array:
    """Share of the mean shear strain that is bending between the ends, shape (m, 2, 2).

    With :func:`with_bending_flexibility` the mean shear ``Γ_t = (Γ₂, Γ₃)`` of an element is shear
    of its sections and, by ``β = F Γ_t``, a deflection of its ends from its mean frame::

        F = (C* − C) C*⁻¹,    C, C* the shear parts of both compliances.

    Args:
        section: Section stiffness of each cell, shape (m, 6, 6).
        effective: The same with the bending flexibility.
    """
    C, total = (_inverse(D)[:, 1:3, 1:3] for D in (section, effective))
    return np.asarray((total - C) @ np.linalg.inv(total))


S_SHAPE = 1 / 10
"""Excess of an axis that bends between its ends over its chord, per square of the slope of that.

The cubic that is parallel to the mean frame at both ends and deflects by ``β`` per length has the
slope ``β (3/2 − 6 s²)`` at ``−½ ≤ s ≤ ½``. Half of the mean square is ``3/5 β²``, of which the
chord has ``1/2 β²``.
"""


def with_elongation(strain: Expr, shear: Expr, share: Expr) -> Expr:
    """Strain (6,) with the length of an axis that bends between the ends of its element.

    With ``X = 1 + Γ₁`` along the mean frame and ``β = F Γ_t`` across it the chord is
    ``C = √(X² + β²)``, and the axial strain ``C (1 + β²/10 C²) − 1``; for small slopes this is
    ``Γ₁ + 3/5 β²``. With ``Γ₁`` alone the projection of the axis would count as its length. Tension
    ``N`` would then soften the mean shear by ``N``, as it does with true shear, and an element of
    length ``h`` would buckle in tension at ``N = 12 EI/h²``, though it is bending that the mean
    shear stands for.

    Args:
        strain: Mean strain ``(Γ, κ)`` of the element, shape (6,).
        shear: Mean shear ``Γ_t`` since the unloaded configuration, shape (2,).
        share: ``F`` of :func:`bending_share`, shape (2, 2).
    """
    β = share * shear
    X, square = 1 + strain[0], ufl.inner(β, β)
    C = ufl.sqrt(X**2 + square)
    # C − X without cancellation
    longer = square / (C + abs(X)) + abs(X) - X + S_SHAPE * square / C
    return strain + ufl.as_vector([longer, 0, 0, 0, 0, 0])


def flexible_cells(cells: CellData, relative: Array) -> CellData:
    """The cells as :func:`with_bending_flexibility` has them, the viscosity likewise.

    Parts in series add their compliances ``C`` and, for slow motion, the products ``C η C`` with
    their viscosities; a viscosity ``τ D`` of the section becomes τ times the new stiffness.

    Args:
        cells: With the stiffness and viscosity of the section.
        relative: Relative motion of the cells' ends, unloaded, shape (m, 6).
    """
    stiffness, viscosity = with_bending_flexibility(cells.stiffness, relative), cells.viscosity
    if viscosity is not None:
        C = _inverse(cells.stiffness)
        viscosity = stiffness @ _of_the_mean(C @ viscosity @ C, relative) @ stiffness
    return replace(cells, stiffness=stiffness, viscosity=viscosity)


def _of_the_mean(compliance: Array, relative: Array) -> Array:
    """``S⁻¹ ∫ A(s) C A(s)ᵀ ds S⁻ᵀ``, see :func:`with_bending_flexibility`."""
    along, twice = np.polynomial.legendre.leggauss(6)
    weights = 0.5 * twice
    A = lie.se3_adjoint(lie.se3_exp(0.5 * along[:, np.newaxis, np.newaxis] * relative))
    mean = np.linalg.inv(np.einsum("p,pmij->mij", weights, A))
    total = np.einsum("p,pmij->mij", weights, A @ compliance @ _transposed(A))
    return np.asarray(mean @ total @ _transposed(mean))


def _inverse(matrices: Array) -> Array:
    return np.asarray(np.linalg.inv(matrices), dtype=np.float64)


def _transposed(matrices: Array) -> Array:
    return matrices.swapaxes(-1, -2)
