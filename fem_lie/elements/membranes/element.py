"""Elements of membranes: stretches of surfaces without bending stiffness, and wrinkling.

The strain is Green's in the surface, ``E_αβ = ½ ((F e_α)·(F e_β) − δ_αβ)`` with the gradient
``F = ∂x/∂X`` along the surface and the section's axes e₁, e₂ in the unloaded surface. Nodes are of
type ``POSITION``.

*Tension field.* A membrane cannot resist compression: it wrinkles, and the energy of fine wrinkles
is the least that any further contraction allows (A. C. Pipkin, IMA J. Appl. Math. 36 (1986) 85; D.
J. Steigmann, Proc. R. Soc. Lond. A 429 (1990) 141). With principal strains ``E₁ ≥ E₂`` of an
isotropic section of stiffness ``C = E t/(1 − ν²)``::

    taut,      E₂ + ν E₁ ≥ 0:          W = ½ C (E₁² + E₂² + 2 ν E₁ E₂)
    wrinkled,  E₂ + ν E₁ < 0 < E₁:     W = ½ C (1 − ν²) E₁²
    slack,     E₁ ≤ 0:                 W = 0
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import dolfinx
import numpy as np
import ufl
from dolfinx import fem
from ufl.core.expr import Expr

from fem_lie._arrays import Array, number
from fem_lie.elements.solids.element import POSITIONS
from fem_lie.forms.energy import StrainEnergy
from fem_lie.forms.frames import NodalFrames
from fem_lie.forms.local_forms import LocalFrameForms

_QUADRATURE = {
    ("triangle", 1): 1,
    ("triangle", 2): 4,
    ("quadrilateral", 1): 3,
    ("quadrilateral", 2): 5,
}
"""Quadrature degree of the energy."""

_ISOTROPIC = 1e-9  # over the stiffness
_EQUAL = 1e-30  # square of a difference of strains below which principal strains are equal


class MembraneFormulation(ABC):
    """Law of a membrane: subclass it in one file, as a frozen dataclass of its options."""

    @abstractmethod
    def check(self, stiffness: Array) -> None:
        """Raise ``ValueError`` if the law does not support such a section.

        Args:
            stiffness: Membrane stiffness of a cell, shape (3, 3).
        """

    @abstractmethod
    def energy(self, strain: Expr, stiffness: Expr) -> Expr:
        """Energy per unloaded area.

        Args:
            strain: (E₁₁, E₂₂, 2 E₁₂).
            stiffness: Shape (3, 3).
        """

    def forms(
        self, nodal: NodalFrames, degree: int, axes: Array, stiffness: Array, prestress: Array
    ) -> LocalFrameForms:
        """Energy, forces and tangent.

        Args:
            nodal: Nodal coordinates in the unloaded configuration.
            degree: Degree of the interpolation.
            axes: Vector of each cell whose projection onto the surface is e₁, shape (m, 3).
            stiffness: Membrane stiffness of each cell, shape (m, 3, 3).
            prestress: Stress resultants of each cell in that configuration, shape (m, 3).
        """
        mesh = nodal.function.function_space.mesh
        x = fem.Function(fem.functionspace(mesh, ("P", degree, (3,))))
        A = _cellwise(mesh, stiffness)
        strain = np.asarray(np.linalg.solve(stiffness, prestress[..., np.newaxis])[..., 0], float)
        natural = _cellwise(mesh, strain)
        points = _QUADRATURE[mesh.topology.cell_name(), degree]
        energy = StrainEnergy(
            strain=green_strain(ufl.grad(x), surface_axes(mesh, _cellwise(mesh, axes))) + natural,
            law=lambda ε: self.energy(ε, A),
            dx=ufl.Measure("dx", mesh, metadata={"quadrature_degree": points}),
        )
        return LocalFrameForms(energy, nodal.function, nodal.increment, POSITIONS, coordinates=x)


@dataclass(frozen=True)
class LinearMembrane(MembraneFormulation):
    """Linear law in Green's strain, which resists compression, too."""

    def check(self, stiffness: Array) -> None:
        """Accept all sections.

        Args:
            stiffness: Membrane stiffness of a cell, shape (3, 3).
        """

    def energy(self, strain: Expr, stiffness: Expr) -> Expr:
        """``½ E·A E``."""
        return 0.5 * ufl.dot(strain, stiffness * strain)


@dataclass(frozen=True)
class TensionField(MembraneFormulation):
    """Isotropic membrane that wrinkles instead of resisting compression.

    Attributes:
        residual: Part of the stiffness that remains where it is wrinkled or slack, so that
            equilibria there are unique.

    Raises:
        ValueError: ``residual`` is not between 0 and 1.
    """

    residual: float = 1e-4

    def __post_init__(self) -> None:
        """Raise ``ValueError`` or ``TypeError`` if ``residual`` is not a number from 0 to 1."""
        if not 0.0 <= number(self.residual, "TensionField: residual") <= 1.0:
            raise ValueError(f"TensionField: residual must be from 0 to 1, got {self.residual!r}")

    def check(self, stiffness: Array) -> None:
        """Raise ``ValueError`` unless the section is isotropic.

        Args:
            stiffness: Membrane stiffness of a cell, shape (3, 3).
        """
        C, coupling = stiffness[0, 0], stiffness[0, 1]
        wanted = np.array(
            [[C, coupling, 0.0], [coupling, C, 0.0], [0.0, 0.0, 0.5 * (C - coupling)]]
        )
        if np.abs(stiffness - wanted).max() > _ISOTROPIC * C:
            raise ValueError(
                f"TensionField is for isotropic sections, got the membrane stiffness\n{stiffness}"
            )

    def energy(self, strain: Expr, stiffness: Expr) -> Expr:
        """Energy of the taut, wrinkled or slack membrane, see the module."""
        C, coupling = stiffness[0, 0], stiffness[0, 1]
        ν = coupling / C
        mean, half = 0.5 * (strain[0] + strain[1]), 0.5 * (strain[0] - strain[1])
        radius = ufl.sqrt(half**2 + 0.25 * strain[2] ** 2 + _EQUAL)
        large, small = mean + radius, mean - radius
        taut = 0.5 * ufl.dot(strain, stiffness * strain)
        wrinkled = ufl.conditional(ufl.gt(large, 0.0), 0.5 * C * (1 - ν**2) * large**2, 0.0)
        relaxed = ufl.conditional(ufl.ge(small + ν * large, 0.0), taut, wrinkled)
        return (1.0 - self.residual) * relaxed + self.residual * taut


def surface_axes(mesh: dolfinx.mesh.Mesh, along: fem.Function) -> tuple[Expr, Expr]:
    """Unit vectors e₁, the projection of ``along``, and e₂ in the unloaded surface."""
    J = ufl.Jacobian(mesh)
    normal = ufl.cross(J[:, 0], J[:, 1])
    normal /= ufl.sqrt(ufl.dot(normal, normal))
    e1 = along - ufl.dot(along, normal) * normal
    e1 /= ufl.sqrt(ufl.dot(e1, e1))
    return e1, ufl.cross(normal, e1)


def green_strain(F: Expr, axes: tuple[Expr, Expr]) -> Expr:
    """Strain (E₁₁, E₂₂, 2 E₁₂) of a surface gradient (3, 3)."""
    a, b = (ufl.dot(F, e) for e in axes)
    return ufl.as_vector([0.5 * (ufl.dot(a, a) - 1), 0.5 * (ufl.dot(b, b) - 1), ufl.dot(a, b)])


def _cellwise(mesh: dolfinx.mesh.Mesh, values: Array) -> fem.Function:
    """DG0 function of a vector or matrix for each cell."""
    f = fem.Function(fem.functionspace(mesh, ("DG", 0, values.shape[1:])))
    f.x.array[:] = values.ravel()
    return f
