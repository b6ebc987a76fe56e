"""Saint-Venant's torsion and flexure of a section of any shape, solved by finite elements.

Axial stress is ``σ = E ε`` with the strain ``ε = Γ₁ + z κ₂ − y κ₃``, shear stress ``τ = G γ``, and
no stress acts in the plane of the section (Saint-Venant; exact if all regions have the same ν).
With r = (y, z) from the centroid ``∫E r dA = 0``, t = (−z, y), and ∇ in the plane:

*Torsion*: ``γ = κ₁ (∇ω + t)``, ``∫G (∇ω + t)·∇η dA = 0`` for all η, and ``GJ = ∫G (∇ω + t)·t dA``.

*Shear centre* s: the pole from which the warping function is orthogonal to extension and bending,
``∫E ω_s (1, r) dA = 0`` (E. Trefftz, ZAMM 15 (1935) 220). A force through s does no work on a twist
and a torque none on bending. It does not depend on ν, unlike the centre at which some mean twist
vanishes.

*Flexure*: the axial strain grows along the beam, ``ε' = k·r`` with ``∫E r⊗r dA k = Q``, and

    γ = ∇ψ + a + α (∇ω_s + t_s),    ∫G γ·∇η dA = ∫E ε' η dA  for all η,

    a = −ν [ ½ (y² − z²) k₁ + y z k₂,   y z k₁ − ½ (y² − z²) k₂ ]

(A. E. H. Love, *Theory of Elasticity* (1927), §229). Here a is the gradient along the beam of what
Poisson's ratio does to the section, and α makes the resultant pass through s.

*Shear factors*: G. R. Cowper, J. Appl. Mech. 33 (1966) 335, doi:10.1115/1.3625046. The beam's
displacement is the mean of the section's, its rotation the mean rotation ``∫E r u dA`` of the axial
displacement, so that its shear strain is

    Γ = (∫E r⊗r dA)⁻¹ ∫E r ψ dA + ∫E a dA / ∫E dA + α (z_s, −y_s) = F Q.

Three things are not in his paper, as he treats forces along axes of symmetry of one material:

* All means are weighted by E. Then ``F`` for ν = 0 is the flexibility by energy, ``Q·F Q =
  ∫G γ·γ dA``, whatever the section is made of.
* Kinematics alone does not say what the twist is that a displacement depending on ν contains; here
  it is the one on which a torque does work, and a force through s has none. It changes nothing for
  sections with two axes of symmetry.
* For ν ≠ 0 and a section without symmetry, F is not quite symmetric, because a mean displacement is
  not what the shear stress does work on. Its symmetric part is taken, as a stiffness must be
  symmetric. Flexibility by energy would be symmetric, but has other values than Cowper's (solid
  circle, ν = 0.3: 0.851 instead of 0.886), and would not agree with the closed forms of
  :class:`~fem_lie.sections.section.Section`.

The shear factors are ``k = (F ∫G dA)⁻¹``. In a composite of different ν, ``a`` takes the mean of ν
weighted by E; stress in the plane that keeps the regions together is neglected.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import ufl
from basix import CellType, LatticeType, create_lattice
from basix.ufl import element
from dolfinx import fem
from scipy.sparse.linalg import splu
from scipy.spatial import Delaunay

from fem_lie._arrays import Array, Indices
from fem_lie._compat import create_surface_mesh
from fem_lie._form_cache import compile_form
from fem_lie.sections.material import Material
from fem_lie.sections.outlines.mesh import SectionMesh

_DRAWN_PIECES = 4  # of a cell's edge


@dataclass(frozen=True, eq=False)
class Torsion:
    """``GJ``, the shear centre from the centroid, ``ω_s`` and ``EI_ω = ∫E ω_s² dA``."""

    stiffness: float
    shear_centre: Array
    function: Array
    warping: float


class WarpingFields:
    """Integrals over the section as products of matrices with nodal values.

    Coordinates and the quadratic ``a`` are in the space of Lagrange elements themselves, so that
    four bilinear forms serve for all integrals.
    """

    def __init__(
        self, mesh: SectionMesh, points: Array, materials: list[Material], degree: int
    ) -> None:
        domain = create_surface_mesh(points, mesh.cells, mesh.cell, mesh.degree)
        self._cell, self._element = mesh.cell, element("Lagrange", mesh.cell, degree)
        V = fem.functionspace(domain, self._element)
        weight = fem.Function(fem.functionspace(domain, ("DG", 0)))
        forms = _forms(V, weight)
        region = mesh.regions[domain.topology.original_cell_index]
        E, G, nu, rho = np.array([(m.E, m.G, m.nu, m.density) for m in materials])[region].T

        def matrix(name: str, value: Array) -> Any:
            weight.x.array[:] = value
            return fem.assemble_matrix(forms[name]).to_scipy()

        self._dofs = V.dofmap.list
        ones = np.ones(len(region))
        x = np.ascontiguousarray(V.tabulate_dof_coordinates()[:, :2].T)
        self.stiffness = matrix("stiffness", G)
        self.derivatives = matrix("derivative_y", G), matrix("derivative_z", G)
        self.mass_E, self.mass_G, mass_rho = (matrix("mass", w) for w in (E, G, rho))
        one = np.ones(len(x.T))
        self.area = float(one @ matrix("mass", ones) @ one)
        self.EA, self.GA = float(one @ self.mass_E @ one), float(one @ self.mass_G @ one)
        self.nu = float(one @ matrix("mass", E * nu) @ one) / self.EA
        self.centroid = x @ self.mass_E @ one / self.EA
        self.r = x - self.centroid[:, np.newaxis]
        self.EI = self.r @ self.mass_E @ self.r.T
        gram = np.vstack([one, np.zeros_like(one), self.r])
        self.inertia = gram @ mass_rho @ gram.T
        self._solver = splu(
            self.stiffness[1:, 1:].tocsc(),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )

    def torsion(self) -> Torsion:
        """Torsion about the centroid, then the pole that makes it free of bending."""
        y, z = self.r
        t = np.array([-z, y])
        load = self._divergence(t)
        about_centroid = -self._solve(load)
        stiffness = float((t * (t @ self.mass_G)).sum() + load @ about_centroid)
        zs, minus_ys = self._mean_gradient(about_centroid)
        function = about_centroid - zs * y - minus_ys * z
        function -= (self.mass_E @ function).sum() / self.EA
        warping = float(function @ self.mass_E @ function)
        return Torsion(stiffness, np.array([-minus_ys, zs]), function, warping)

    def shear_factors(self, torsion: Torsion) -> Array:
        """From the flexibility ``Γ = F Q``, shape (2, 2)."""
        y, z = self.r
        p, q = 0.5 * (y * y - z * z), y * z
        along_y = self.shear_strain(y, -self.nu * np.array([p, q]), torsion)
        along_z = self.shear_strain(z, -self.nu * np.array([q, -p]), torsion)
        F = np.column_stack([along_y, along_z]) @ np.linalg.inv(self.EI)
        return np.asarray(np.linalg.inv(0.5 * (F + F.T) * self.GA))

    def shear_strain(self, strain: Array, a: Array, torsion: Torsion) -> Array:
        """Γ for ``ε' = strain`` and a, with a resultant through the shear centre, shape (2,)."""
        y, z = self.r
        ys, zs = torsion.shear_centre
        t = np.array([zs - z, y - ys])
        psi = self._solve(self.mass_E @ strain - self._divergence(a))
        torque = self._divergence(t) @ psi + (t * (a @ self.mass_G)).sum()
        untwist = -torque / torsion.stiffness * np.array([zs, -ys])
        return self._mean_gradient(psi) + (a @ self.mass_E).sum(axis=1) / self.EA + untwist

    def drawn(self, functions: list[Array]) -> tuple[Indices, list[Array]]:
        """Triangles of a lattice in each cell, shape (t, 3), and functions at its points."""
        kind = getattr(CellType, self._cell)
        lattice: Any = create_lattice(kind, _DRAWN_PIECES, LatticeType.equispaced, True)
        tables: Any = self._element.tabulate(0, lattice)
        cells = np.arange(len(self._dofs))[:, np.newaxis, np.newaxis]
        triangles = Delaunay(lattice).simplices + cells * len(lattice)
        values = [(f[self._dofs] @ tables[0].T).ravel() for f in functions]
        return triangles.reshape(-1, 3).astype(np.int64), values

    def _divergence(self, vector: Array) -> Array:
        """``∫G u·∇η`` for all η."""
        along_y, along_z = self.derivatives
        return np.asarray(along_y @ vector[0] + along_z @ vector[1])

    def _mean_gradient(self, function: Array) -> Array:
        """``(∫E r⊗r)⁻¹ ∫E r u``: gradient of the plane nearest to u."""
        return np.asarray(np.linalg.solve(self.EI, self.r @ (self.mass_E @ function)))

    def _solve(self, load: Array) -> Array:
        """Solution of ``∫G ∇u·∇η = load`` that is zero at the first node."""
        return np.concatenate([[0.0], self._solver.solve(load[1:])])


def _forms(V: fem.FunctionSpace, weight: fem.Function) -> dict[str, fem.Form]:
    u, v = ufl.TrialFunction(V), ufl.TestFunction(V)
    return {
        "stiffness": compile_form(weight * ufl.inner(ufl.grad(u), ufl.grad(v)) * ufl.dx),
        "mass": compile_form(weight * u * v * ufl.dx),
        "derivative_y": compile_form(weight * u * v.dx(0) * ufl.dx),
        "derivative_z": compile_form(weight * u * v.dx(1) * ufl.dx),
    }
