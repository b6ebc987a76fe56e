"""Elements of solids: strains of hexahedra and tetrahedra of degree 1 and 2.

The strain is Green's, ``E = ½ (C − 1)``, in fixed axes of the unloaded body; the stress in the
tangent is independent and updated linearly between iterates. Isoparametric cells of degree 1 lock.
Hexahedra of nearly incompressible material do not with a mean dilatation, see
:class:`MeanDilatation`; bending needs degree 2. (Simo, Taylor & Pister, CMAME 51 (1985) 177: the
mean dilatation; Moran, Ortiz & Shih, IJNME 29 (1990) 483: large deformations.)

The nodes are of type ``POSITION``: their coordinates are the position and axes ``R``; unknowns are
displacements along these, ``δx = R h``. Flat coordinates are the positions and, for
:data:`PLACES_AND_VOLUME`, the volume of a cell with eight nodes::

    v = Σ_g w_g g₁·(g₂ × g₃),    g_b = Σ_i x_i ∂N_i/∂ξ_b

which two points per direction integrate exactly.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import basix.ufl
import dolfinx
import numba
import numpy as np
import ufl
from dolfinx import fem
from ufl.core.expr import Expr

from fem_lie._arrays import Array
from fem_lie._jit import compiled
from fem_lie.forms.energy import StrainEnergy
from fem_lie.forms.frames import NodalFrames
from fem_lie.forms.kernels.addresses import FrameMap, Pointer, frame_function
from fem_lie.forms.local_forms import LocalFrameForms
from fem_lie.lie.tuples import (
    Vector,
    cross,
    dot,
    load,
    load_row,
    plus,
    rotate,
    rotate_back,
    scaled,
    store,
    store_row,
)
from fem_lie.mesh.shapes import rule, tabulated
from fem_lie.sections.solid_materials import SolidMaterial

_NODES = 8


def _slopes() -> tuple[Array, Array]:
    """Derivatives of the shape functions at the quadrature points, (g, 8, 3), and weights (g,)."""
    points, weights = rule("hexahedron", 3)
    slopes = tabulated("hexahedron", 1, points)[1:]
    return np.ascontiguousarray(slopes.transpose(1, 2, 0)), weights


_SLOPES, _WEIGHTS = _slopes()


@compiled
def _tangents(x: Array, g: int) -> tuple[Vector, Vector, Vector]:
    """Tangents ``g_b`` at a quadrature point for positions ``x[:, 0]`` (8, 3)."""
    a = b = c = (0.0, 0.0, 0.0)
    for i in range(_NODES):
        position, d = load_row(x[i], 0), load_row(_SLOPES[g], i)
        a, b, c = (
            plus(a, scaled(d[0], position)),
            plus(b, scaled(d[1], position)),
            plus(c, scaled(d[2], position)),
        )
    return a, b, c


@compiled
def volume(x: Array) -> float:
    """Volume of a cell with eight nodes, negative if its first three edges are left-handed.

    Args:
        x: Coordinates of its nodes, with positions in row 0, shape (8, any, 3).
    """
    total = 0.0
    for g in range(_WEIGHTS.shape[0]):
        a, b, c = _tangents(x, g)
        total += _WEIGHTS[g] * dot(a, cross(b, c))
    return total


@compiled
def _volume_slopes(x: Array, out: Array) -> None:
    """Derivatives ``∂v/∂x_i`` of the volume, shape (8, 3)."""
    out[:] = 0.0
    for g in range(_WEIGHTS.shape[0]):
        a, b, c = _tangents(x, g)
        bc, ca, ab = cross(b, c), cross(c, a), cross(a, b)
        for i in range(_NODES):
            d = scaled(_WEIGHTS[g], load_row(_SLOPES[g], i))
            rise = plus(plus(scaled(d[0], bc), scaled(d[1], ca)), scaled(d[2], ab))
            store_row(out, i, plus(load_row(out, i), rise))


@compiled
def _add_volume_bend(H: Array, force: float, A: Array) -> None:
    """Add ``force · R_iᵀ (∂²v/∂x_i∂x_j) R_j`` to ``A`` (8, 6, 8, 6)."""
    for i in range(_NODES):
        for j in range(_NODES):
            lever = (0.0, 0.0, 0.0)
            for g in range(_WEIGHTS.shape[0]):
                a, b, c = _tangents(H, g)
                n = scaled(_WEIGHTS[g], cross(load_row(_SLOPES[g], i), load_row(_SLOPES[g], j)))
                part = plus(plus(scaled(n[0], a), scaled(n[1], b)), scaled(n[2], c))
                lever = plus(lever, part)
            axes = load_row(H[i], 1), load_row(H[i], 2), load_row(H[i], 3)
            for k in range(3):
                change = cross(load_row(H[j], 1 + k), scaled(force, lever))
                for m in range(3):
                    A[i, m, j, k] += dot(axes[m], change)


@compiled
def _add_pulled(H: Array, f: Array, r: Array) -> None:
    """Add ``R_iᵀ f_i`` of each node to ``r``, shapes (n, 4, 3), (n, 3) and (n, 6)."""
    for i in range(f.shape[0]):
        own = rotate_back(load_row(H[i], 1), load_row(H[i], 2), load_row(H[i], 3), load_row(f, i))
        store(r[i], 0, plus(load(r[i], 0), own))


@compiled
def _push_positions(H: Array, h: Array, out: Array) -> None:
    """Displacements ``δx_i = R_i h_i``."""
    for i in range(h.shape[0]):
        moved = rotate(load_row(H[i], 1), load_row(H[i], 2), load_row(H[i], 3), load(h[i], 0))
        store_row(out, i, moved)


@frame_function
def _positions(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    H, x = numba.carray(state, (nodes, 4, 3)), numba.carray(y, (nodes, 3))
    for i in range(nodes):
        store_row(x, i, load_row(H[i], 0))


@frame_function
def _pull(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    H, f = numba.carray(state, (nodes, 4, 3)), numba.carray(given, (nodes, 3))
    _add_pulled(H, f, numba.carray(out, (nodes, 6)))


@frame_function
def _push(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    H, h = numba.carray(state, (nodes, 4, 3)), numba.carray(given, (nodes, 6))
    _push_positions(H, h, numba.carray(out, (nodes, 3)))


@frame_function
def _with_volume(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    H = numba.carray(state, (nodes, 4, 3))
    x, whole = numba.carray(y, (nodes, 3)), numba.carray(y, (3 * nodes + 1,))
    for i in range(nodes):
        store_row(x, i, load_row(H[i], 0))
    whole[3 * nodes] = volume(H)


@frame_function
def _pull_volume(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    H, whole = numba.carray(state, (nodes, 4, 3)), numba.carray(given, (3 * nodes + 1,))
    f, slopes = numba.carray(given, (nodes, 3)), np.empty((_NODES, 3))
    r = numba.carray(out, (nodes, 6))
    _add_pulled(H, f, r)
    if whole[3 * nodes] != 0.0:
        _volume_slopes(H, slopes)
        slopes *= whole[3 * nodes]
        _add_pulled(H, slopes, r)


@frame_function
def _push_volume(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    H, h = numba.carray(state, (nodes, 4, 3)), numba.carray(given, (nodes, 6))
    dx, whole = numba.carray(out, (nodes, 3)), numba.carray(out, (3 * nodes + 1,))
    slopes = np.empty((_NODES, 3))
    _push_positions(H, h, dx)
    _volume_slopes(H, slopes)
    total = 0.0
    for i in range(nodes):
        total += dot(load_row(slopes, i), load_row(dx, i))
    whole[3 * nodes] = total


@frame_function
def _bend_volume(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    H, whole = numba.carray(state, (nodes, 4, 3)), numba.carray(given, (3 * nodes + 1,))
    _add_volume_bend(H, whole[3 * nodes], numba.carray(out, (nodes, 6, nodes, 6)))


POSITIONS = FrameMap(_positions, _pull, _push, None, values=12, unknowns=6)
"""Map with the positions of the nodes, for any cell and degree."""

PLACES_AND_VOLUME = FrameMap(
    _with_volume, _pull_volume, _push_volume, _bend_volume, values=12, unknowns=6
)
"""Map with the positions of the eight nodes of a cell, then its volume."""

QUADRATURE = {
    ("tetrahedron", 1): 1,
    ("tetrahedron", 2): 2,
    ("hexahedron", 1): 3,
    ("hexahedron", 2): 5,
}
"""Quadrature degree of the energy: 1, 4, 8 and 27 points."""

_MOST_INCOMPRESSIBLE = 20.0  # Poisson's ratio of 0.475, where deflections are a third too small

PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
"""Indices of the components of a strain; those of shears are doubled."""


@dataclass(frozen=True, eq=False)
class Strains:
    """Strain measures of the cells of a mesh.

    Attributes:
        coordinates: Flat coordinates of a cell, in UFL.
        frame_map: Map from nodal coordinates to them.
        gradient: Deformation gradient ``F`` of the element; ``C = FᵀF``.
        weight: Volume in which the energy is measured per unloaded volume.
    """

    coordinates: fem.Function
    frame_map: FrameMap
    gradient: Expr
    weight: Expr | float = 1.0

    def from_stretched(self, inverse: fem.Function) -> Strains:
        """Strains from the stress-free state of each cell.

        The gradient is ``F U₀⁻¹``, the energy is per volume of that state. A body that has
        expanded freely is as a larger one of the same material, of any law.

        Args:
            inverse: Inverse ``U₀⁻¹`` of the stress-free stretch, see
                :class:`~fem_lie.elements.solids.stretch.StressFreeStretch`, cellwise, shape (3, 3).
        """
        weight = 1.0 / ufl.det(inverse)
        return replace(self, gradient=self.gradient * inverse, weight=weight)

    @property
    def voigt(self) -> Expr:
        """Strain ``E`` as (11, 22, 33, 2·12, 2·13, 2·23)."""
        E = 0.5 * (self.gradient.T * self.gradient - ufl.Identity(3))
        return ufl.as_vector([E[i, j] * (1 if i == j else 2) for i, j in PAIRS])

    def cauchy(self, material: SolidMaterial, parameters: Sequence[Expr]) -> Expr:
        """Cauchy stress ``σ = F S Fᵀ/J`` with ``S = 2 ∂W/∂C``, global components, (3, 3)."""
        F = self.gradient
        C = ufl.variable(F.T * F)
        S = 2 * ufl.diff(material.energy(C, *parameters), C)
        return F * (0.5 * (S + S.T)) * F.T / ufl.det(F)

    def piola(self, material: SolidMaterial, parameters: Sequence[Expr]) -> tuple[Expr, Expr]:
        """Piola-Kirchhoff stress ``S = ∂W/∂E``, (6,), and its derivative in the strain, (6, 6)."""
        ε = ufl.variable(self.voigt)
        S = ufl.diff(material.energy(from_voigt(ε), *parameters), ε)
        return S, ufl.diff(S, ε)

    def set_nodes(self, coordinates: Array) -> None:
        """Set the coordinates to those of the cells' nodes, ``coordinates`` (m, k, 4, 3)."""
        dofmap = self.coordinates.function_space.dofmap
        at = dofmap.list[:, :, np.newaxis] * dofmap.bs + np.arange(dofmap.bs)
        at = at.reshape(len(coordinates), -1)
        flat: Array = coordinates[:, :, 0].reshape(len(coordinates), -1)
        if at.shape[1] > flat.shape[1]:
            flat = np.column_stack([flat, [volume(row) for row in coordinates]])
        self.coordinates.x.array[at] = flat


class SolidFormulation(ABC):
    """Element of solids: subclass it in one file, as a frozen dataclass of its options."""

    def require_eigenstrain(self, what: str) -> None:
        """Raise ``ValueError`` if the energy is not that of :meth:`strains`.

        Args:
            what: What the user asked for, for the message.
        """
        if type(self).forms is not SolidFormulation.forms:
            raise ValueError(
                f"{what} is not available for {type(self).__name__}, which has forms of its own: "
                "use Isoparametric or MeanDilatation"
            )

    @abstractmethod
    def check(self, cell: str, degree: int) -> None:
        """Raise ``ValueError`` if the element does not support such cells.

        Args:
            cell: Name of the cell, such as "quadrilateral".
            degree: Degree of the cell.
        """

    @abstractmethod
    def strains(self, nodal: NodalFrames, degree: int) -> Strains:
        """Strain measures of the element.

        Args:
            nodal: Nodal coordinates in the unloaded configuration.
            degree: Degree of the interpolation.
        """

    def forms(
        self,
        nodal: NodalFrames,
        degree: int,
        material: SolidMaterial,
        parameters: Array,
        relaxation: float = 0.0,
        inverse: fem.Function | None = None,
    ) -> LocalFrameForms:
        """Energy, forces and tangent.

        Args:
            nodal: Nodal coordinates in the unloaded configuration.
            degree: Degree of the interpolation.
            material: Constitutive law.
            parameters: Parameters of the law in each cell, shape (m, p).
            relaxation: Relaxation time of Kelvin-Voigt damping; 0: none.
            inverse: Inverse stress-free stretch, see :meth:`Strains.from_stretched`; default: the
                unloaded body is free of stress.
        """
        mesh, strains = nodal.function.function_space.mesh, self.strains(nodal, degree)
        if inverse is not None:
            strains = strains.from_stretched(inverse)
        given = [cellwise(mesh, column) for column in parameters.T]
        energy = StrainEnergy(
            strain=strains.voigt,
            law=lambda ε: material.energy(from_voigt(ε), *given),
            dx=measure(mesh, degree),
            weight=strains.weight,
        )
        return LocalFrameForms(
            energy,
            nodal.function,
            nodal.increment,
            strains.frame_map,
            coordinates=strains.coordinates,
            relaxation=relaxation,
        )


@dataclass(frozen=True)
class Isoparametric(SolidFormulation):
    """Isoparametric element, for all cells and both degrees.

    Degree 2 is accurate in bending. Degree 1 locks in bending, and with nearly incompressible
    material.
    """

    def check(self, cell: str, degree: int) -> None:
        """Accept all cells.

        Args:
            cell: Name of the cell, such as "quadrilateral".
            degree: Degree of the cell.
        """

    def strains(self, nodal: NodalFrames, degree: int) -> Strains:
        """Strains of the isoparametric interpolation."""
        x = fem.Function(fem.functionspace(nodal.function.function_space.mesh, ("P", degree, (3,))))
        return Strains(x, POSITIONS, ufl.grad(x))


@dataclass(frozen=True)
class MeanDilatation(SolidFormulation):
    """Hexahedra of degree 1 with the mean dilatation of the cell.

    ``F̄ = (θ/J)^⅓ F`` with ``θ = v/v₀`` from the volume of the cell; it does not lock with nearly
    incompressible material.
    """

    def check(self, cell: str, degree: int) -> None:
        """Raise ``ValueError`` unless the cells are hexahedra of degree 1.

        Args:
            cell: Name of the cell, such as "quadrilateral".
            degree: Degree of the cell.
        """
        if (cell, degree) != ("hexahedron", 1):
            raise ValueError(
                f"MeanDilatation is for hexahedra of degree 1, got {cell} of degree {degree}: "
                "take Isoparametric()"
            )

    def strains(self, nodal: NodalFrames, degree: int) -> Strains:
        """Strains with the mean dilatation."""
        mesh = nodal.function.function_space.mesh
        cell = mesh.basix_cell()
        positions = basix.ufl.element("Lagrange", cell, 1, shape=(3,))
        whole = basix.ufl.element("DG", cell, 0)
        y = fem.Function(fem.functionspace(mesh, basix.ufl.mixed_element([positions, whole])))
        x, v = ufl.split(y)
        coordinates = nodal.frames[nodal.function.function_space.dofmap.list]
        first = cellwise(mesh, np.array([volume(row) for row in coordinates]))
        F = ufl.grad(x)
        return Strains(y, PLACES_AND_VOLUME, (v / (first * ufl.det(F))) ** (1 / 3) * F)


def from_voigt(ε: Expr) -> Expr:
    """``C = 1 + 2 E`` from :attr:`Strains.voigt`."""
    a, b, c, d, e, f = (ε[k] for k in range(6))
    return ufl.as_matrix([[1 + 2 * a, d, e], [d, 1 + 2 * b, f], [e, f, 1 + 2 * c]])


def default_formulation(
    cell: str, degree: int, materials: Iterable[SolidMaterial]
) -> SolidFormulation:
    """Default element for a cell and materials.

    Raises:
        ValueError: There is none: tetrahedra of degree 1 lock with nearly incompressible material.
    """
    if (cell, degree) == ("tetrahedron", 1):
        for material in materials:
            ratio = material.incompressibility()
            if ratio > _MOST_INCOMPRESSIBLE:
                raise ValueError(
                    f"tetrahedra of degree 1 lock with {material}, whose bulk modulus is "
                    f"{ratio:.0f} times the shear modulus: take degree=2, or hexahedra, which have "
                    "MeanDilatation(); formulation=Isoparametric() takes them as they are"
                )
    return MeanDilatation() if (cell, degree) == ("hexahedron", 1) else Isoparametric()


def measure(mesh: dolfinx.mesh.Mesh, degree: int) -> ufl.Measure:
    """Cell measure with the quadrature degree of the energy."""
    points = QUADRATURE[mesh.topology.cell_name(), degree]
    return ufl.Measure("dx", mesh, metadata={"quadrature_degree": points})


def cellwise(mesh: dolfinx.mesh.Mesh, values: Array) -> fem.Function:
    """DG0 function of one number for each cell."""
    f = fem.Function(fem.functionspace(mesh, ("DG", 0)))
    f.x.array[:] = values
    return f
