"""Sections of any shape: Saint-Venant torsion and flexure, solved by finite elements.

Axial stress is ``σ = E ε`` with the strain ``ε = Γ₁ + z κ₂ − y κ₃``, shear stress ``τ = G γ``, and
the stress in the plane of the section is zero (Saint-Venant; exact if all regions have the same ν).
With r = (y, z) from the centroid ``∫E r dA = 0``, t = (−z, y), and ∇ in the plane:

*Torsion*: ``γ = κ₁ (∇ω + t)``, ``∫G (∇ω + t)·∇η dA = 0`` for all η, and ``GJ = ∫G (∇ω + t)·t dA``.

*Shear centre* s: the pole for which the warping function is orthogonal to extension and bending,
``∫E ω_s (1, r) dA = 0`` (E. Trefftz, ZAMM 15 (1935) 220). A force through s does no work on a
twist, and a torque none on bending. It does not depend on ν, unlike the centre for which some mean
twist vanishes.

*Flexure*: the axial strain grows along the beam, ``ε' = k·r`` with ``∫E r⊗r dA k = Q``, and

    γ = ∇ψ + a + α (∇ω_s + t_s),    ∫G γ·∇η dA = ∫E ε' η dA  for all η,

    a = −ν [ ½ (y² − z²) k₁ + y z k₂,   y z k₁ − ½ (y² − z²) k₂ ]

(A. E. H. Love, *Theory of Elasticity* (1927), §229). Here a is the gradient along the beam of the
section's transverse contraction, and α makes the resultant pass through s.

*Shear factors*: G. R. Cowper, J. Appl. Mech. 33 (1966) 335, doi:10.1115/1.3625046. The beam's
displacement is the mean of the section's, its rotation the mean rotation ``∫E r u dA`` of the axial
displacement, so that its shear strain is

    Γ = (∫E r⊗r dA)⁻¹ ∫E r ψ dA + ∫E a dA / ∫E dA + α (z_s, −y_s) = F Q.

Three points are not in his paper, which treats forces along axes of symmetry of one material:

* All means are weighted by E. Then ``F`` for ν = 0 is the flexibility by energy,
  ``Q·F Q = ∫G γ·γ dA``, for any materials.
* Kinematics alone does not define the twist in a displacement that depends on ν; here it is the
  twist conjugate to a torque, and a force through s has none. It does not matter for sections with
  two axes of symmetry.
* For ν ≠ 0 and a section without symmetry, F is not quite symmetric, because a mean displacement is
  not conjugate to the shear stress. Its symmetric part is used, as a stiffness must be symmetric.
  The flexibility by energy would be symmetric, but differs from Cowper's (solid circle, ν = 0.3:
  0.851 instead of 0.886), and from the closed forms of :class:`~fem_lie.sections.section.Section`.

The shear factors are ``k = (F ∫G dA)⁻¹``. In a composite with different ν, ``a`` uses the mean of ν
weighted by E; stress in the plane from the coupling of regions is neglected.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
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
from fem_lie.sections.properties import SectionProperties
from fem_lie.sections.section import Section
from fem_lie.sections.section_mesh import SectionMesh

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_DRAWN_PIECES = 4  # of a cell's edge


@dataclass(frozen=True, eq=False)
class Torsion:
    """Torsional stiffness ``GJ``, shear centre from the centroid, ``ω_s``, ``EI_ω``.

    ``EI_ω = ∫E ω_s² dA``.
    """

    stiffness: float
    shear_centre: Array
    function: Array
    warping: float


class WarpingFields:
    """Integrals over the section as products of matrices with nodal values.

    Coordinates and the quadratic ``a`` are in the space of the Lagrange elements, so that four
    bilinear forms suffice for all integrals.
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
        coordinates = np.vstack([one, np.zeros_like(one), self.r])
        self.inertia = coordinates @ mass_rho @ coordinates.T
        self._solver = splu(
            self.stiffness[1:, 1:].tocsc(),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )

    def torsion(self) -> Torsion:
        """Torsion about the centroid, then about the pole that decouples it from bending."""
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
        """Shear factors from the flexibility ``Γ = F Q``, shape (2, 2)."""
        y, z = self.r
        p, q = 0.5 * (y * y - z * z), y * z
        along_y = self.shear_strain(y, -self.nu * np.array([p, q]), torsion)
        along_z = self.shear_strain(z, -self.nu * np.array([q, -p]), torsion)
        F = np.column_stack([along_y, along_z]) @ np.linalg.inv(self.EI)
        return np.asarray(np.linalg.inv(0.5 * (F + F.T) * self.GA))

    def shear_strain(self, strain: Array, a: Array, torsion: Torsion) -> Array:
        """Shear strain Γ for ``ε' = strain`` and a, resultant in the shear centre, (2,)."""
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
        """Linear form ``∫G u·∇η`` for all η."""
        along_y, along_z = self.derivatives
        return np.asarray(along_y @ vector[0] + along_z @ vector[1])

    def _mean_gradient(self, function: Array) -> Array:
        """``(∫E r⊗r)⁻¹ ∫E r u``: gradient of the plane closest to u."""
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


class Warping:
    """Warping function of a section of given materials, and its beam properties.

    Args:
        mesh: Cells of the section.
        material: Material of all regions, or of each region by its name.
        degree: Degree of the Lagrange elements of warping functions.

    Attributes:
        mesh: Cells of the section.
        properties: Area, moments, torsion constant, shear centre and factors, in the coordinates of
            the mesh.
        points: Points (y, z) of the sampled warping function, for drawing, shape (n, 2).
        function: Axial displacement at these points per unit of twist about the shear centre,
            length², shape (n,).
        triangles: Triangles of these points, shape (t, 3).

    Raises:
        ValueError: A region has no material, a material no region, or the degree is less than 2.
    """

    mesh: SectionMesh
    properties: SectionProperties
    points: Array
    function: Array
    triangles: Indices

    def __init__(
        self, mesh: SectionMesh, material: Material | Mapping[str, Material], degree: int = 3
    ) -> None:
        if degree < 2:
            raise ValueError(f"degree must be at least 2, got {degree!r}")
        self.mesh = mesh
        materials = materials_of(mesh, material)
        # dimensionless about the middle of the section, so that units do not matter
        low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
        middle, size = 0.5 * (low + high), 0.5 * float(np.linalg.norm(high - low))
        fields = WarpingFields(mesh, (mesh.points - middle) / size, materials, degree)
        torsion = fields.torsion()
        factors = fields.shear_factors(torsion)
        self.triangles, (y, z, function) = fields.drawn([*fields.r, torsion.function])
        self.points = middle + size * (fields.centroid + np.column_stack([y, z]))
        self.function = size**2 * function
        self.properties = SectionProperties(
            E=fields.EA / fields.area,
            G=fields.GA / fields.area,
            area=size**2 * fields.area,
            centroid=middle + size * fields.centroid,
            second_moments=size**4 * fields.EI * fields.area / fields.EA,
            torsion_constant=size**4 * torsion.stiffness * fields.area / fields.GA,
            shear_centre=middle + size * (fields.centroid + torsion.shear_centre),
            shear_factors=factors,
            warping_constant=size**6 * torsion.warping * fields.area / fields.EA,
        )
        units = np.array([size, size**2, size**2, size**2])
        inertia = fields.inertia * np.outer(units, units)
        self._inertia = inertia if inertia[0, 0] > 0.0 else None

    def section(self, at: npt.ArrayLike | None = None, angle: float = 0.0) -> Section:
        """Section with the beam's axis through a point, in axes rotated by an angle.

        Args:
            at: Point (y, z) in the coordinates of the mesh; default: the centroid. The shear centre
                is ``warping.properties.shear_centre``.
            angle: From the mesh's y axis to the section's e₂, towards z; in the principal axes it
                is ``warping.properties.principal_angle``.
        """
        point = self.properties.centroid if at is None else np.asarray(at, dtype=np.float64)
        if point.shape != (2,) or not np.isfinite(point).all():
            raise ValueError(f"at must be a point (y, z), got {at!r}")
        properties = self.properties.offset(*self.properties.centroid)
        centred = Section(
            properties.stiffness,
            self._inertia,
            self.mesh.outline() - self.properties.centroid,
            properties,
        )
        return centred.offset(*(point - self.properties.centroid)).rotated(-angle)

    def plot(self, axes: Axes) -> None:
        """Draw regions, warping function, centroid, shear centre and principal axes.

        Args:
            axes: Axes of Matplotlib; default: new ones.
        """
        from fem_lie.sections.diagram import draw

        draw(self, axes)

    def picture(self, path: str | os.PathLike[str] | None = None) -> Figure:
        """The same as a figure of its own, written to a file if one is given.

        Args:
            path: Name of the file; default: none is written.
        """
        from fem_lie.sections.diagram import picture

        return picture(self, path)


def materials_of(mesh: SectionMesh, material: Material | Mapping[str, Material]) -> list[Material]:
    """Material of each region of a section.

    Args:
        mesh: Cells of the section.
        material: Material of all regions, or of each region by its name.

    Raises:
        ValueError: A region has no material, or a material no region.
    """
    names = mesh.names
    if isinstance(material, Material):
        return [material] * len(names)
    for name in material:
        if name not in names:
            raise ValueError(f"there is no region {name!r}; there are: {', '.join(names)}")
    for name in names:
        if name not in material:
            raise ValueError(f"region {name!r} has no material; given are: {', '.join(material)}")
    return [material[name] for name in names]
