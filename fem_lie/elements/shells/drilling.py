"""Drilling rotation of six-parameter shells: strain, penalty stiffness, and term of a system.

The energy ``∫ ½ γ c²`` with ``c = a₁·x,₂ − a₂·x,₁`` is added to the forms of five-parameter shells;
``a = Σ Nᵢ Rᵢ Aᵢ`` are tangents that rotate with the nodes. Positions and directors enter it as
products of vectors, so that it needs no UFL form for any cell type and degree.

In orthonormal reference coordinates with nodal tangents ``a_i = R A_i``, ``R`` is the rotation of
the mid-surface in the sense of the polar decomposition exactly if ``c = a₁·x,₂ − a₂·x,₁ = 0``. (Fox
& Simo, CMAME 98 (1992) 329.) A stress τ with as many parameters in a cell as it has nodes imposes
this weakly (perturbed Lagrangian ``τ c − τ²/2γ``; Hughes & Brezzi, CMAME 72 (1989) 105). With fewer
parameters, drilling rotations that alternate from node to node have no energy. Elements without
independent fields use ``½ γ c²`` at the quadrature points.

The drilling rotation is continuous and the rotation of the mid-surface is not; the energy of the
difference is γ times its square. So γ has to be of the order of the bending stiffness ``G t³/h²``
for cells of size h, or smaller: with the often recommended ``G t``, thin shells lock.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import basix
import numpy as np
import ufl
from ufl.core.expr import Expr

from fem_lie._arrays import Array, Indices
from fem_lie._jit import callback, inlined
from fem_lie.elements.shells.strains import Point, Surface
from fem_lie.forms.cell_forms import FormArrays
from fem_lie.forms.cell_sums import Pattern
from fem_lie.forms.kernels.addresses import Pointer
from fem_lie.forms.small_energy.assembly import CellFunctions, ElementCells
from fem_lie.forms.small_energy.cell import (
    add_energy,
    add_forces,
    add_hessian_at_stress,
    update_stress,
)
from fem_lie.forms.small_energy.element import (
    PACKED_SIGNATURE,
    Element,
    data_at_rest,
    element,
    packed,
    unpacked,
)
from fem_lie.forms.term import add_at
from fem_lie.lie.motions import add_turnings
from fem_lie.lie.node_types.node_type import NodeType
from fem_lie.mesh.shapes import rule, tabulated


def stress_modes(cell: basix.CellType, p: Point) -> list[Expr]:
    """Shape functions of τ: linear on triangles, bilinear on quadrilaterals.

    Args:
        cell: Cell of degree one.
        p: Point.
    """
    centre = 1 / 3 if cell == basix.CellType.triangle else 1 / 2
    ξ, η = p[0] - centre, p[1] - centre
    linear = [ufl.as_ufl(1.0), ξ, η]
    return linear if cell == basix.CellType.triangle else [*linear, ξ * η]


def drilling(
    s: Surface, p: Point, inverse: Expr, first: Sequence[Expr], second: Sequence[Expr]
) -> Expr:
    """Drilling strain ``c = a₁·x,₂ − a₂·x,₁``.

    Args:
        s: Surface of the cell.
        p: Point.
        inverse: ``J⁻¹`` at the point, see :func:`fem_lie.elements.shells.strains.local_jacobian`.
        first: Tangents ``a₁`` that rotate with the nodes.
        second: Tangents ``a₂``.
    """
    g = s.dx(0, p), s.dx(1, p)
    x1, x2 = (inverse[i, 0] * g[0] + inverse[i, 1] * g[1] for i in (0, 1))
    a1, a2 = s.shapes.combine(first, p), s.shapes.combine(second, p)
    return ufl.dot(a1, x2) - ufl.dot(a2, x1)


def perturbed_lagrangian(tau: Expr, modes: Sequence[Expr], c: Expr, stiffness: Expr) -> Expr:
    """Density ``τ c − τ²/2γ``.

    Args:
        tau: Parameters of τ of a cell.
        modes: See :func:`stress_modes`.
        c: Drilling strain at the point.
        stiffness: γ.
    """
    τ = sum(tau[i] * mode for i, mode in enumerate(modes))
    return τ * c - τ**2 / (2 * stiffness)


FRACTION = 0.01
"""γ over ``G t³/h²``; results do not change from 1 to 1e-8 (docs/measured/six_parameters.md)."""

MEMBRANE_SHEAR, TWIST = 2, 5
"""Membrane shear and twist among the eight strains."""


def drilling_stiffness(
    stiffness: Array, areas: Array, cells: Indices, bound: Iterable[int]
) -> Array:
    """Drilling stiffness γ of each cell, force per length, shape (m,).

    Args:
        stiffness: Section stiffness of each cell, shape (m, 8, 8).
        areas: Areas of the cells, shape (m,).
        cells: Nodes of each cell, shape (m, k).
        bound: Nodes with moments about their normals only.
    """
    membrane = stiffness[:, MEMBRANE_SHEAR, MEMBRANE_SHEAR]
    soft = FRACTION * 12.0 * stiffness[:, TWIST, TWIST] / areas
    around = np.isin(cells, list(bound)).any(axis=1)
    return np.where(around, membrane, np.minimum(soft, membrane))


def drilling_inertia(density: Array, drilling: Array, twist: Array, areas: Array) -> Array:
    """Rotary inertia of the drilling rotation per area of each cell, kg, shape (m,).

    A director has none about itself. Momenta do not determine the rate of its rotation, and without
    mass no explicit step is stable. ``J = J_d min(1, γ A/3D)``, with the rotary inertia ``J_d`` of
    directors and the twist stiffness ``D = G t³/12``, is 4 % of ``J_d`` at the default γ. The
    frequency of the drilling, ``√(4γ/J)``, is then at most ``√(48 G/ρ)`` over the larger of the
    size of the cell and the thickness, as those of membrane and shear.

    Args:
        density: Mass matrix per area in (position, director) of each cell, shape (m, 2, 2).
        drilling: Drilling stiffness γ of each cell, shape (m,), N/m.
        twist: Twist stiffness ``D`` of each cell, shape (m,), N m.
        areas: Areas of the cells, shape (m,).
    """
    return density[:, 1, 1] * np.minimum(1.0, drilling * areas / (3.0 * twist))


_A1, _A2, _X1, _X2 = range(4)
"""Vectors at each point: tangents that rotate with the nodes, and those of the surface."""


def _element(nodes: int, points: int) -> Element:
    """Element of cells with given numbers of nodes and quadrature points."""
    products = [(0, _A1, _X2, 1.0), (0, _A2, _X1, -1.0)]
    return element([NodeType.FRAME] * nodes, products, vectors=4, points=points)


@inlined
def _packed_element(c: Pointer) -> Element:
    """Element whose constants are at the address ``c``."""
    return Element(unpacked(c), None, None, None, ((), (), (), ()), 1)


@callback(PACKED_SIGNATURE)
def energy_of_cell(A: Pointer, w: Pointer, c: Pointer, h: Pointer) -> None:
    """Energy of a cell."""
    add_energy(_packed_element(c), A, w)


@callback(PACKED_SIGNATURE)
def forces_of_cell(A: Pointer, w: Pointer, c: Pointer, h: Pointer) -> None:
    """Forces of a cell."""
    add_forces(_packed_element(c), A, w)


@callback(PACKED_SIGNATURE)
def tangent_of_cell(A: Pointer, w: Pointer, c: Pointer, h: Pointer) -> None:
    """Second derivative of the energy of a cell, with the linearised stress."""
    add_hessian_at_stress(_packed_element(c), A, w)


@callback(PACKED_SIGNATURE)
def stress_of_cell(A: Pointer, w: Pointer, c: Pointer, h: Pointer) -> None:
    """Linearised stress of a cell."""
    update_stress(_packed_element(c), A, w, h)


class DrillingAssembly(ElementCells):
    """Forces, tangent and energy of drilling on the nodes of an assembly of shells."""

    label, of_bodies, conserved = "drilling of shells with drilling rotations", True, True

    def __init__(
        self,
        frames: Array,
        cells: Indices,
        kind: basix.CellType,
        degree: int,
        quadrature_degree: int,
        directions: Array,
        stiffness: Array,
    ) -> None:
        """Evaluate the unloaded surface.

        Args:
            frames: Unloaded frames of the nodes, shape (n, 4, 3).
            cells: Nodes of each cell, shape (m, k).
            kind: Cell type.
            degree: Degree of the interpolation.
            quadrature_degree: Quadrature degree of the element.
            directions: Vector of each cell whose projection onto the surface is the first axis.
            stiffness: γ of each cell, shape (m,).
        """
        points, w = rule(kind.name, quadrature_degree)
        middle = np.asarray(basix.geometry(kind)).mean(axis=0, keepdims=True)
        table = tabulated(kind.name, degree, np.vstack([points, middle]))
        N = table[0, :-1]
        tangents = np.einsum("agk,mkj->mgaj", table[1:], frames[cells, 0])
        normal = np.cross(tangents[:, :, 0], tangents[:, :, 1])
        e2 = np.cross(normal, directions[:, np.newaxis])
        axes = np.stack([np.cross(e2, normal), e2], axis=2)
        axes /= np.linalg.norm(axes, axis=-1, keepdims=True)
        inverse = np.linalg.inv(np.einsum("mgaj,mgbj->mgab", tangents, axes)[:, :-1])
        # coordinate vectors of a node are its position and three directors
        m, (g, k) = len(cells), N.shape
        T = np.zeros((m, g, 4, k, 4))
        T[:, :, _X1 : _X2 + 1, :, 0] = np.einsum("mgba,agk->mgbk", inverse, table[1:, :-1])
        # nodes have the axes of the centre
        A = np.einsum("mbj,mkdj->mkbd", axes[:, -1], frames[cells, 1:])
        T[:, :, _A1 : _A2 + 1, :, 1:] = np.einsum("gk,mkbd->mgbkd", N, A)
        weight = w * np.linalg.norm(normal[:, :-1], axis=-1) * stiffness[:, np.newaxis]
        vectors, of = np.einsum("mgvkc,mkcj->mgvj", T, frames[cells]), _element(k, g)
        C = weight[..., np.newaxis, np.newaxis]
        data = data_at_rest(of, T.reshape(m, g, 4, 4 * k), vectors, C)
        nodes = cells.astype(np.int64)
        functions = CellFunctions(energy_of_cell, forces_of_cell, tangent_of_cell, stress_of_cell)
        self._pattern = Pattern.of(nodes, len(frames))
        self._bind(of, functions, nodes, data, packed(of.cells))
        rows = np.repeat(np.arange(len(frames)), np.diff(self._pattern.indptr))
        self._diagonal = np.flatnonzero(self._pattern.indices == rows)
        self._all = np.ones(len(frames), dtype=bool)

    @property
    def tables(self) -> None:
        """``None``: the tangent needs the stored forces, see :meth:`tangent`."""

    @property
    def over_cells(self) -> tuple[FormArrays, FormArrays]:
        """Tables of forces and of energy."""
        return self._forces.table, self._energy.table

    def workspace(self) -> Array:
        """Zero array for the forces of all nodes, shape (n, 6)."""
        return np.zeros((len(self._all), 6))

    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """Add the forces at frames ``H`` to ``out``, shape (n, 6)."""
        forces = self.workspace() if kept is None else kept
        forces[:] = 0.0
        super().add_forces(H, forces)
        out += forces.reshape(out.shape)

    def tangent(self, H: Array, kept: Array) -> Array:
        """Tangent stiffness in twists with the linearised stress, shape (pairs, 6, 6).

        For the stored forces, which are those of linear theory in :meth:`linear_forces`, the system
        adds the terms from rotation of frames.
        """
        blocks = super().tangent(H, kept)
        forces = kept * self._matrix.share(len(self._all))
        add_turnings(forces, -1.0, self._diagonal, self._all, blocks)
        return blocks

    def add_tangent(self, H: Array, kept: Array, index: Indices, K: Array) -> None:
        """Add the tangent stiffness to blocks ``K`` at ``index``."""
        add_at(K, index, self.tangent(H, kept))
