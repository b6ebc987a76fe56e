"""Elements of solids: strains of hexahedra and tetrahedra of degree 1 and 2, in UFL.

The strain is Green's, ``E = ½ (C − 1)``, in fixed axes of the unloaded body; stress is carried from
iterate to iterate. Cells of degree 1 that follow their nodes' interpolation lock: hexahedra of
nearly incompressible material do not with a mean dilatation, see :class:`MeanDilatation`. In
bending degree 2 is what helps. (Simo, Taylor & Pister, CMAME 51 (1985) 177: the mean dilatation;
Moran, Ortiz & Shih, IJNME 29 (1990) 483: of large deformations.)
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import basix.ufl
import dolfinx
import numpy as np
import ufl
from dolfinx import fem
from ufl.core.expr import Expr

from fem_lie._arrays import Array
from fem_lie.elements.solids.maps import PLACES, PLACES_AND_VOLUME, volume
from fem_lie.elements.solids.materials import SolidMaterial
from fem_lie.forms.energy import StrainEnergy
from fem_lie.forms.frames import NodalFrames
from fem_lie.forms.kernels.frame_map import FrameMap
from fem_lie.forms.local_forms import LocalFrameForms

QUADRATURE = {
    ("tetrahedron", 1): 1,
    ("tetrahedron", 2): 2,
    ("hexahedron", 1): 3,
    ("hexahedron", 2): 5,
}
"""Degree of integration of the energy: 1, 4, 8 and 27 points."""

_MOST_INCOMPRESSIBLE = 20.0  # Poisson's ratio of 0.475: a third of a deflection is missing

_PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


@dataclass(frozen=True, eq=False)
class Strains:
    """Strain measures of the cells of a mesh.

    Attributes:
        coordinates: Flat coordinates of a cell, what its nodes are for UFL.
        frame_map: How they follow from the nodes' rows.
        gradient: Deformation gradient ``F``, as far as the element knows it; ``C = FᵀF``.
    """

    coordinates: fem.Function
    frame_map: FrameMap
    gradient: Expr

    @property
    def voigt(self) -> Expr:
        """``E`` as (11, 22, 33, 2·12, 2·13, 2·23)."""
        E = 0.5 * (self.gradient.T * self.gradient - ufl.Identity(3))
        return ufl.as_vector([E[i, j] * (1 if i == j else 2) for i, j in _PAIRS])

    def cauchy(self, material: SolidMaterial, parameters: Sequence[Expr]) -> Expr:
        """``σ = F S Fᵀ/J`` with ``S = 2 ∂W/∂C``, global components, a matrix (3, 3)."""
        F = self.gradient
        C = ufl.variable(F.T * F)
        S = 2 * ufl.diff(material.energy(C, *parameters), C)
        return F * (0.5 * (S + S.T)) * F.T / ufl.det(F)

    def place(self, rows: Array) -> None:
        """Set the coordinates to those of the cells' nodes, rows (m, k, 4, 3)."""
        dofmap = self.coordinates.function_space.dofmap
        at = dofmap.list[:, :, np.newaxis] * dofmap.bs + np.arange(dofmap.bs)
        at = at.reshape(len(rows), -1)
        flat: Array = rows[:, :, 0].reshape(len(rows), -1)
        if at.shape[1] > flat.shape[1]:
            flat = np.column_stack([flat, [volume(row) for row in rows]])
        self.coordinates.x.array[at] = flat


class SolidFormulation(ABC):
    """An element of solids: subclass it in one file, as a frozen dataclass of its options."""

    @abstractmethod
    def check(self, cell: str, degree: int) -> None:
        """Raise ``ValueError`` if it is not for such cells."""

    @abstractmethod
    def strains(self, nodal: NodalFrames, degree: int) -> Strains:
        """Its strain measures.

        Args:
            nodal: Rows of the nodes, in the unloaded configuration.
            degree: Of the interpolation.
        """

    def forms(
        self, nodal: NodalFrames, degree: int, material: SolidMaterial, parameters: Array
    ) -> LocalFrameForms:
        """Energy, forces and tangent.

        Args:
            nodal: Rows of the nodes, in the unloaded configuration.
            degree: Of the interpolation.
            material: Its law.
            parameters: That the law takes in each cell, shape (m, p).
        """
        mesh, strains = nodal.function.function_space.mesh, self.strains(nodal, degree)
        given = [cellwise(mesh, column) for column in parameters.T]
        energy = StrainEnergy(
            strain=strains.voigt,
            law=lambda ε: material.energy(from_voigt(ε), *given),
            dx=measure(mesh, degree),
        )
        return LocalFrameForms(
            energy,
            nodal.function,
            nodal.increment,
            strains.frame_map,
            coordinates=strains.coordinates,
        )


@dataclass(frozen=True)
class Isoparametric(SolidFormulation):
    """Strain of the interpolation as it is, for all cells and both degrees.

    Degree 2 is good in bending. Degree 1 locks in bending, and with nearly incompressible material.
    """

    def check(self, cell: str, degree: int) -> None:
        """All cells will do."""

    def strains(self, nodal: NodalFrames, degree: int) -> Strains:
        """See the base class."""
        x = fem.Function(fem.functionspace(nodal.function.function_space.mesh, ("P", degree, (3,))))
        return Strains(x, PLACES, ufl.grad(x))


@dataclass(frozen=True)
class MeanDilatation(SolidFormulation):
    """Hexahedra of degree 1 whose change of volume is that of the whole cell.

    ``F̄ = (θ/J)^⅓ F`` with ``θ = v/v₀`` of the volume of the cell; it does not lock with nearly
    incompressible material.
    """

    def check(self, cell: str, degree: int) -> None:
        """Hexahedra of degree 1 alone."""
        if (cell, degree) != ("hexahedron", 1):
            raise ValueError(
                f"MeanDilatation is for hexahedra of degree 1, got {cell} of degree {degree}: "
                "take Isoparametric()"
            )

    def strains(self, nodal: NodalFrames, degree: int) -> Strains:
        """See the base class."""
        mesh = nodal.function.function_space.mesh
        cell = mesh.basix_cell()
        places = basix.ufl.element("Lagrange", cell, 1, shape=(3,))
        whole = basix.ufl.element("DG", cell, 0)
        y = fem.Function(fem.functionspace(mesh, basix.ufl.mixed_element([places, whole])))
        x, v = ufl.split(y)
        rows = nodal.frames[nodal.function.function_space.dofmap.list]
        first = cellwise(mesh, np.array([volume(row) for row in rows]))
        F = ufl.grad(x)
        return Strains(y, PLACES_AND_VOLUME, (v / (first * ufl.det(F))) ** (1 / 3) * F)


def from_voigt(ε: Expr) -> Expr:
    """``C = 1 + 2 E`` from :attr:`Strains.voigt`."""
    a, b, c, d, e, f = (ε[k] for k in range(6))
    return ufl.as_matrix([[1 + 2 * a, d, e], [d, 1 + 2 * b, f], [e, f, 1 + 2 * c]])


def default_formulation(
    cell: str, degree: int, materials: Iterable[SolidMaterial]
) -> SolidFormulation:
    """What suits a cell of any of these materials.

    Raises:
        ValueError: None does: tetrahedra of degree 1 lock where volumes hardly change.
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
    """With the points of integration of the energy."""
    points = QUADRATURE[mesh.topology.cell_name(), degree]
    return ufl.Measure("dx", mesh, metadata={"quadrature_degree": points})


def cellwise(mesh: dolfinx.mesh.Mesh, values: Array) -> fem.Function:
    """Numbers, one for each cell, as a function."""
    f = fem.Function(fem.functionspace(mesh, ("DG", 0)))
    f.x.array[:] = values
    return f
