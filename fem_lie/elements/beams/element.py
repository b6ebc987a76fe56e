"""Interface of beam elements: nodes per cell, and the forms of the energy."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import pi
from typing import Any, ClassVar, NamedTuple

import basix.ufl
import dolfinx
import numpy as np
import ufl
from dolfinx import fem
from ufl.core.expr import Expr

from fem_lie import _compat, lie
from fem_lie._arrays import Array
from fem_lie._form_cache import compile_expression
from fem_lie._summary import Summarised
from fem_lie.attachments.attachment import AttachmentFrame
from fem_lie.attachments.between_frames import interpolated
from fem_lie.forms.frames import NodalFrames
from fem_lie.forms.local_forms import LocalFrameForms
from fem_lie.lie.node_types import TRAITS, NodeType


@dataclass(frozen=True, eq=False, repr=False)
class CellData(Summarised):
    """Data of the cells of one line mesh, in the order of the mesh.

    Attributes:
        lengths: Unloaded arc length of each cell, shape (m,).
        stiffness: Section stiffness on (Γ, κ), shape (m, 6, 6).
        density: Mass matrix of (x, d₁, d₂, d₃) per length, shape (m, 4, 4), zero without mass.
        eigenstrain: Eigenstrain, a DG0 function of shape (6,) that may change with time.
        viscosity: Viscosity on (Γ̇, κ̇), shape (m, 6, 6), or ``None``.
        slopes: ``|dr/dξ|`` of cubics at both ends, zero for other lines, shape (m, 2).
    """

    lengths: Array
    stiffness: Array
    density: Array
    eigenstrain: fem.Function
    viscosity: Array | None
    slopes: Array


_TWICE, _DOUBLED = np.polynomial.legendre.leggauss(6)
POINTS, WEIGHTS = 0.5 + 0.5 * _TWICE, 0.5 * _DOUBLED
"""Integration points on a cell of unit length and their weights, both of shape (g,)."""


class LineShapes(NamedTuple):
    """Shape functions of the axis at :data:`POINTS` of m cells.

    Attributes:
        weights: Unloaded lengths, shape (m, g).
        positions: Factors of the positions of the nodes, shape (m, g, k).
        directors: Factors of the directors, or position gradients, of both ends, (m, g, 2, 3).
    """

    weights: Array
    positions: Array
    directors: Array


class BeamFormulation(ABC):
    """Finite element along a line: subclass it in one file, as a frozen dataclass of its options.

    Attributes:
        node_type: Type of its nodes.
        degree: Degree of the nodal interpolation; a cell has ``degree + 1`` nodes.
        bows: Whether the axis of a two-node cell is the parabola with its end tangents, for inertia
            and line loads; otherwise it is the interpolated line.
        viscous: Whether it has viscous forces.
        bends: Whether it has bending and torsional stiffness within the element; otherwise springs
            between elements provide it.
    """

    node_type: ClassVar[NodeType] = NodeType.FRAME
    degree: int
    bows: ClassVar[bool] = False
    viscous: ClassVar[bool] = True
    bends: ClassVar[bool] = True

    def require_bends(self, what: str) -> None:
        """Raise ``ValueError`` if ``what`` needs bending within elements that have none.

        Args:
            what: What the user asked for, for the message.
        """
        if not self.bends:
            raise ValueError(
                f"{what} is not available for {self}, whose elements have no bending stiffness: "
                "use KirchhoffRod() or an element of beams"
            )

    @property
    def largest_turn(self) -> float:
        """Largest rotation along an element, rad.

        See :mod:`fem_lie.system.nodes.element_rotations`. It is π, where a rotation has two
        logarithms, unless the element folds before.
        """
        return pi

    def effective_stiffness(self, stiffness: Array, relative: Array) -> Array:
        """Effective section stiffness of each cell, shape (m, 6, 6).

        Args:
            stiffness: Section stiffness, shape (m, 6, 6).
            relative: Unloaded relative motion of the cells' ends, shape (m, 6).
        """
        return stiffness

    @property
    def tension_only(self) -> bool:
        """Whether it is tension-only, with an energy that is still convex."""
        return False

    def check(self, stiffness: Array) -> None:
        """Raise ``ValueError`` if it does not support a section stiffness (6, 6).

        Args:
            stiffness: Section stiffness, shape (6, 6).
        """
        return

    def placed(self, frames: Array, stretch: float) -> Array:
        """Coordinates of the nodes along a line, shape (n, 4, 3).

        Args:
            frames: Positions, and axes with e₁ along the tangent, shape (n, 4, 3).
            stretch: Length of the line over the unstretched length of the body.
        """
        return frames

    def attachment(self, node: int) -> AttachmentFrame | None:
        """Attachment frame by which joints hold a node; ``None`` for its own frame.

        Args:
            node: Number of the node.
        """
        return None

    def line_shapes(self, ends: Array, lengths: Array) -> LineShapes:
        """Shape functions at integration points of cells, for loads and inertia.

        The default is the interpolation of the positions, with the parabola
        ``½ (ξ − ξ²) ℓ (t_A − t_B)`` across it where the element :attr:`bows`; ℓt has the components
        of the chord in the axes of A.

        Args:
            ends: Coordinates of both ends, shape (m, 2, 4, 3).
            lengths: Lengths of the cells, shape (m,).
        """
        m, g, k = len(lengths), len(POINTS), self.degree + 1
        positions = np.stack(np.broadcast_arrays(*_SHAPES[self.degree](POINTS)), axis=1)
        on_directors = np.zeros((m, g, 2, 3))
        if self.bows:
            chord = lie.se3_relative(ends[:, 0], ends[:, 1])[:, np.newaxis, :3]
            bow = 0.5 * (POINTS - POINTS**2)[:, np.newaxis] * chord
            on_directors[:, :, 0], on_directors[:, :, 1] = bow, -bow
        return LineShapes(
            lengths[:, np.newaxis] * WEIGHTS, np.broadcast_to(positions, (m, g, k)), on_directors
        )

    def attachment_frame(self, nodes: Sequence[int], ξ: float) -> AttachmentFrame:
        """Attachment frame at ``0 ≤ ξ ≤ 1`` along an element, as the element interpolates it.

        The default interpolates positions and directors.

        Args:
            nodes: Nodes of the element, its two ends first.
            ξ: Unloaded arc length from its first end over its length.
        """
        return interpolated(nodes, _SHAPES[self.degree](ξ))

    @abstractmethod
    def forms(self, nodal: NodalFrames, cells: CellData) -> LocalFrameForms:
        """DOLFINx forms of energy, nodal forces and tangent stiffness along nodal axes.

        Args:
            nodal: Frames of ``degree`` on a line mesh, in the unloaded configuration.
            cells: Data of the cells.
        """

    def mean_stress(self, stress: Array, frames: Array, ends: Array) -> Array:
        """Elastic force and moment along the section axes at the quadrature points.

        The default is the stress itself, for elements whose strains are those of the section.

        Args:
            stress: Stress conjugate to the element's own strains, shape (m, g, 6).
            frames: Coordinates of the element's nodes, ends first, shape (m, k, 4, 3).
            ends: Elastic force and moment at both ends, in the frames there, shape (m, 2, 6).
        """
        return stress

    def inertia(self, nodal: NodalFrames, cells: CellData) -> Array:
        """Mass matrix in (x, d₁, d₂, d₃) of each cell's nodes, shape (m, k, r, k, r).

        It may contain the first ``r`` of these vectors only, if others have no inertia. The default
        is consistent with Lagrange interpolation of degree 1 or 2 of all vectors.

        Args:
            nodal: As for :meth:`forms`.
            cells: Data of the cells.
        """
        rows = TRAITS[self.node_type].rows.stop
        weighted = cells.lengths[:, np.newaxis, np.newaxis] * cells.density[:, :rows, :rows]
        return np.einsum("ij,eab->eiajb", _LAGRANGE[self.degree], weighted)


_SHAPES: dict[int, Callable[[Any], Sequence[Any]]] = {
    1: lambda ξ: (1.0 - ξ, ξ),
    2: lambda ξ: ((1.0 - ξ) * (1.0 - 2.0 * ξ), ξ * (2.0 * ξ - 1.0), 4.0 * ξ * (1.0 - ξ)),
}
"""Shape functions on a cell of unit length, ends first."""

_LAGRANGE = {
    1: np.array([[2.0, 1], [1, 2]]) / 6,
    2: np.array([[4.0, -1, 2], [-1, 4, 2], [2, 2, 16]]) / 30,
}
"""Integrals of products of the shape functions on a cell of unit length, ends first."""


def cellwise(mesh: dolfinx.mesh.Mesh, values: Array) -> fem.Function:
    """DG0 function of values of any shape, one for each cell.

    Args:
        mesh: The mesh.
        values: Values.
    """
    element = basix.ufl.element("DG", mesh.basix_cell(), 0, shape=values.shape[1:])
    f = fem.Function(fem.functionspace(mesh, element))
    f.x.array[:] = values.ravel()
    return f


def present_values(expression: Expr, mesh: dolfinx.mesh.Mesh, degree: int) -> fem.Function:
    """Current values of an expression at the quadrature points of a degree.

    Args:
        expression: UFL expression.
        mesh: The mesh.
        degree: Degree of the cell.
    """
    element = basix.ufl.quadrature_element(
        _compat.cell_name(mesh.ufl_domain()), value_shape=expression.ufl_shape, degree=degree
    )
    f = fem.Function(fem.functionspace(mesh, element))
    f.interpolate(compile_expression(expression, element.custom_quadrature()[0]))
    return f


def with_bending_flexibility(stiffness: Array, relative: Array) -> Array:
    """Section stiffness with which elements of any shape are exact for small deflections.

    In equilibrium without loads, a force and moment σ̄ at the midpoint is ``Ad(exp(s d₀))ᵀ σ̄`` at
    ``−½ ≤ s ≤ ½``, so that the complementary energy of the mean stress has the compliance::

        S⁻¹ ∫ A(s) C A(s)ᵀ ds S⁻ᵀ,    A(s) = Ad(exp(s d₀)),    S = ∫ A(s) ds.

    For a straight element with a diagonal section stiffness this is ``1/GA* = 1/GA + ℓ²/(12 EI)``,
    the residual bending flexibility of MacNeal, Comput. Struct. 8 (1978) 175; otherwise it is the
    generalisation to arcs and helices.

    Args:
        stiffness: Section stiffness of each cell, shape (m, 6, 6).
        relative: Unloaded relative motion ``d₀`` of its ends, shape (m, 6).
    """
    effective = _inverse(_of_the_mean(_inverse(stiffness), relative))
    return np.asarray(0.5 * (effective + _transposed(effective)))


def bending_share(section: Array, effective: Array) -> Array:
    """Fraction of the mean shear strain that is bending between the ends, shape (m, 2, 2).

    With :func:`with_bending_flexibility` the mean shear ``Γ_t = (Γ₂, Γ₃)`` of an element is shear
    of its sections and, by ``β = F Γ_t``, a deflection of its ends from its mean frame::

        F = (C* − C) C*⁻¹,    C, C* the shear parts of both compliances.

    Args:
        section: Section stiffness of each cell, shape (m, 6, 6).
        effective: Section stiffness with the bending flexibility, shape (m, 6, 6).
    """
    C, total = (_inverse(D)[:, 1:3, 1:3] for D in (section, effective))
    return np.asarray((total - C) @ np.linalg.inv(total))


S_SHAPE = 1 / 10
"""Excess length of an axis that bends between its ends over its chord, per squared slope.

The cubic that is parallel to the mean frame at both ends and deflects by ``β`` per length has the
slope ``β (3/2 − 6 s²)`` at ``−½ ≤ s ≤ ½``. Half of the mean square is ``3/5 β²``, of which the
chord has ``1/2 β²``.
"""


def with_elongation(strain: Expr, shear: Expr, share: Expr) -> Expr:
    """Strain (6,) with the length of an axis that bends between the ends of its element.

    With ``X = 1 + Γ₁`` along the mean frame and ``β = F Γ_t`` across it the chord is
    ``C = √(X² + β²)``, and the axial strain ``C (1 + β²/10 C²) − 1``; for small slopes this is
    ``Γ₁ + 3/5 β²``. With ``Γ₁`` only, the projection of the axis would count as its length. A
    tension ``N`` would then soften the mean shear by ``N``, as it does with true shear, and an
    element of length ``h`` would buckle in tension at ``N = 12 EI/h²``, though the mean shear
    represents bending.

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
    """Cells with the stiffness of :func:`with_bending_flexibility`, and a similar viscosity.

    For parts in series the compliances ``C`` add and, for slow motion, so do the products ``C η C``
    with their viscosities; a viscosity ``τ D`` of the section becomes τ times the new stiffness.

    Args:
        cells: Cells with the stiffness and viscosity of the section.
        relative: Unloaded relative motion of the cells' ends, shape (m, 6).
    """
    stiffness, viscosity = with_bending_flexibility(cells.stiffness, relative), cells.viscosity
    if viscosity is not None:
        C = _inverse(cells.stiffness)
        viscosity = stiffness @ _of_the_mean(C @ viscosity @ C, relative) @ stiffness
    return replace(cells, stiffness=stiffness, viscosity=viscosity)


def _of_the_mean(compliance: Array, relative: Array) -> Array:
    """``S⁻¹ ∫ A(s) C A(s)ᵀ ds S⁻ᵀ``, see :func:`with_bending_flexibility`."""
    along = (POINTS - 0.5)[:, np.newaxis, np.newaxis]
    A = lie.se3_adjoint(lie.se3_exp(along * relative))
    mean = np.linalg.inv(np.einsum("p,pmij->mij", WEIGHTS, A))
    total = np.einsum("p,pmij->mij", WEIGHTS, A @ compliance @ _transposed(A))
    return np.asarray(mean @ total @ _transposed(mean))


def _inverse(matrices: Array) -> Array:
    return np.asarray(np.linalg.inv(matrices), dtype=np.float64)


def _transposed(matrices: Array) -> Array:
    return matrices.swapaxes(-1, -2)
