"""Discrete elasticity of a section: displacements (u_x, u_y, u_z) of its points, and strains.

A displacement that is constant along the beam has the strains ``(γ_xy, γ_xz)`` by its axial
component and ``(ε_yy, ε_zz, γ_yz)`` by the others. Its rate along the beam has
``(ε_xx, γ_xy, γ_xz)``. Elements are Lagrange elements of degree two; matrices are sums over
quadrature points of products of sparse operators, without compiled forms.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from basix.ufl import element
from dolfinx import fem
from scipy.sparse.linalg import splu

from fem_lie._arrays import Array, Indices
from fem_lie._compat import create_surface_mesh, geometry_dofmap
from fem_lie.mesh.shapes import rule, tabulated
from fem_lie.sections.material import Material
from fem_lie.sections.section_mesh import SectionMesh

STRAINS = 6
"""Strains ``(ε_xx, γ_xy, γ_xz, ε_yy, ε_zz, γ_yz)``."""

_DEGREE = 2
_QUADRATURE = 5


@dataclass(frozen=True, eq=False)
class SectionFields:
    """Nodes, quadrature points and operators of a section.

    Attributes:
        points: Nodes (y, z), shape (n, 2).
        cells: Nodes of each cell, shape (m, k).
        at: Quadrature points (y, z), shape (q, 2).
        weights: Their weights, shape (q,).
        elasticity: Moduli of the strains, shape (q, 6, 6).
        young: Young's modulus, shape (q,).
        density: Mass per volume, or 1 in a section without mass, shape (q,).
        values: Interpolation of scalars to the quadrature points, shape (q, n).
        gradient: Derivatives in y and z there, shape (q, n) each.
    """

    points: Array
    cells: Indices
    at: Array
    weights: Array
    elasticity: Array
    young: Array
    density: Array
    values: Any
    gradient: tuple[Any, Any]

    @classmethod
    def of(cls, mesh: SectionMesh, points: Array, materials: Sequence[Material]) -> SectionFields:
        """Fields on the cells of a mesh, with other coordinates of its points.

        Args:
            mesh: Cells.
            points: Coordinates of the points of the mesh, shape (p, 2).
            materials: Material of each region.
        """
        domain = create_surface_mesh(points, mesh.cells, mesh.cell, mesh.degree)
        V = fem.functionspace(domain, element("Lagrange", mesh.cell, _DEGREE))
        corners = domain.geometry.x[geometry_dofmap(domain), :2]
        region = mesh.regions[domain.topology.original_cell_index]
        reference, weights = rule(mesh.cell, _QUADRATURE)
        shape, basis = tabulated(mesh.cell, mesh.degree, reference), _basis(mesh.cell, reference)
        J = np.einsum("dpk,mkj->mpjd", shape[1:], corners)
        slopes = np.einsum("dpk,mpdj->jmpk", basis[1:], np.linalg.inv(J))
        dofs, nodes = V.dofmap.list.astype(np.int64), V.tabulate_dof_coordinates()[:, :2]
        m, p = J.shape[:2]

        def operator(table: Array) -> Any:
            rows = np.repeat(np.arange(m * p), dofs.shape[1])
            columns = np.repeat(dofs, p, axis=0).ravel()
            return sp.csr_matrix((table.ravel(), (rows, columns)), (m * p, len(nodes)))

        def at_points(values: Sequence[Any]) -> Array:
            return np.repeat(np.array(values)[region], p, axis=0)

        heavy = any(each.density for each in materials)
        return cls(
            points=np.ascontiguousarray(nodes),
            cells=dofs,
            at=np.einsum("pk,mkj->mpj", shape[0], corners).reshape(-1, 2),
            weights=(weights * np.abs(np.linalg.det(J))).ravel(),
            elasticity=at_points([_elasticity(each) for each in materials]),
            young=at_points([each.E for each in materials]),
            density=at_points([each.density if heavy else 1.0 for each in materials]),
            values=operator(np.broadcast_to(basis[0], (m, *basis[0].shape))),
            gradient=(operator(slopes[0]), operator(slopes[1])),
        )

    @property
    def rigid(self) -> Array:
        """Displacements without strain in the section, and axial ones linear in it, (6, n, 3).

        They are ``u_x = 1``, ``u_y = 1``, ``u_z = 1``, the rotation, ``u_x = y`` and ``u_x = z``.
        """
        y, z = self.points.T
        one, none = np.ones(len(y)), np.zeros(len(y))
        columns = [
            (one, none, none),
            (none, one, none),
            (none, none, one),
            (none, -z, y),
            (y, none, none),
            (z, none, none),
        ]
        return np.stack([np.stack(each, axis=1) for each in columns])

    def interpolated(self, u: Array) -> Array:
        """Displacements (k, n, 3) at the quadrature points, shape (k, q, 3)."""
        return np.stack([self.values @ each for each in u])

    def strains(self, u: Array) -> Array:
        """Strains (k, q, 6) of displacements (k, n, 3) that are constant along the beam."""
        y, z = (np.stack([D @ each for each in u]) for D in self.gradient)
        none = np.zeros(y.shape[:2])
        parts = none, y[..., 0], z[..., 0], y[..., 1], z[..., 2], z[..., 1] + y[..., 2]
        return np.stack(parts, axis=-1)

    def strains_of_rates(self, u: Array) -> Array:
        """Strains (k, q, 6) of rates (k, n, 3) of displacements along the beam."""
        found = np.zeros((len(u), len(self.at), STRAINS))
        found[..., :3] = self.interpolated(u)
        return found

    def strains_of_axis(self) -> Array:
        """Strains of the section for unit strains (Γ, κ) of the axis, shape (6, q, 6)."""
        y, z = self.at.T
        found = np.zeros((6, len(y), STRAINS))
        found[[0, 1, 2], :, [0, 1, 2]] = 1.0
        found[3, :, 1], found[3, :, 2] = -z, y
        found[4, :, 0], found[5, :, 0] = z, -y
        return found

    def stress(self, strains: Array) -> Array:
        """Stress times weights of strains, both (k, q, 6)."""
        moved = np.einsum("qij,kqj->kqi", self.elasticity, strains, optimize=True)
        return self.weights[:, np.newaxis] * moved

    def products(self, a: Array, b: Array) -> Array:
        """``∫ρ a·b`` of displacements (k, n, 3) and (l, n, 3), shape (k, l)."""
        weight = self.weights * self.density
        of_a, of_b = self.interpolated(a), self.interpolated(b)
        return np.asarray(np.einsum("kqi,q,lqi->kl", of_a, weight, of_b, optimize=True))


class Relaxation:
    """Displacements in equilibrium with given forces, orthogonal in mass to the rigid ones.

    Attributes:
        stiffness: Stiffness of displacements that are constant along the beam, (3 n, 3 n).
    """

    def __init__(self, fields: SectionFields) -> None:
        """Factorise the stiffness, with four components held that are released afterwards.

        Args:
            fields: The section.
        """
        self.fields, n = fields, len(fields.points)
        none, (y, z) = sp.csr_matrix(fields.values.shape), fields.gradient
        rows = [y, none, none], [z, none, none], [none, y, none], [none, none, z], [none, z, y]
        self._operators = [sp.hstack(row, format="csr") for row in rows]
        D = fields.weights[:, np.newaxis, np.newaxis] * fields.elasticity[:, 1:, 1:]
        pairs = [(i, j) for i in range(5) for j in range(5) if D[:, i, j].any()]
        B = self._operators
        self.stiffness = sum(B[i].T @ sp.diags(D[:, i, j]) @ B[j] for i, j in pairs).tocsc()
        low = int(fields.points[:, 0].argmin())
        high = int(np.linalg.norm(fields.points - fields.points[low], axis=1).argmax())
        along = np.abs(fields.points[high] - fields.points[low])
        # the component of the far point that is most across the line to it
        held = [low, n + low, 2 * n + low, (2 if along[0] > along[1] else 1) * n + high]
        self._free = np.setdiff1d(np.arange(3 * n), held)
        self._solver = splu(
            self.stiffness[self._free][:, self._free].tocsc(),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
        weight = sp.diags(fields.weights * fields.density)
        self._mass = fields.values.T @ weight @ fields.values
        self._rigid = fields.rigid[:4]
        self._weighted = self.weighted(self._rigid)
        self._products = np.linalg.inv(self._weighted @ flat(self._rigid).T)

    def weighted(self, u: Array) -> Array:
        """Displacements (k, n, 3) times the mass matrix, flat, shape (k, 3 n)."""
        return flat(np.stack([self._mass @ each for each in u]))

    def forces(self, stress: Array) -> Array:
        """Nodal forces (k, 3 n) of stress times weights (k, q, 6)."""
        parts = [B.T @ stress[..., 1 + i].T for i, B in enumerate(self._operators)]
        return np.asarray(sum(parts)).T

    def forces_of_rates(self, stress: Array) -> Array:
        """Nodal forces (k, 3 n) conjugate to rates along the beam of stress times weights."""
        parts = [self.fields.values.T @ stress[..., i].T for i in range(3)]
        return np.concatenate(parts).T

    def solve(self, forces: Array) -> Array:
        """Displacements (k, n, 3) by nodal forces (k, 3 n); forces on rigid motions are ignored."""
        rigid = flat(self._rigid)
        rest = forces - forces @ rigid.T @ self._products @ self._weighted
        found = np.zeros_like(rest)
        right = np.ascontiguousarray(rest[:, self._free].T)
        found[:, self._free] = self._solver.solve(right).T
        found -= found @ self._weighted.T @ self._products @ rigid
        return unflat(found)

    def constrained(self, forces: Array, constraints: Array) -> Array:
        """As :meth:`solve`, with ``constraints`` (c, 3 n) times the displacement zero."""
        if not len(constraints):
            return self.solve(forces)
        responses = flat(self.solve(constraints))
        found = flat(self.solve(forces))
        multipliers = np.linalg.solve(constraints @ responses.T, constraints @ found.T)
        return unflat(found - multipliers.T @ responses)


def flat(u: Array) -> Array:
    """Displacements (k, n, 3) with one component after the other, shape (k, 3 n)."""
    return u.transpose(0, 2, 1).reshape(len(u), -1)


def unflat(u: Array) -> Array:
    """Inverse of :func:`flat`."""
    return u.reshape(len(u), 3, -1).transpose(0, 2, 1)


def _basis(cell: str, at: Array) -> Array:
    """Shape functions and their derivatives at points of the reference cell, shape (3, p, k)."""
    known: Any = element("Lagrange", cell, _DEGREE)
    return np.asarray(known.tabulate(1, at), dtype=np.float64).reshape(3, len(at), -1)


def _elasticity(material: Material) -> Array:
    """Moduli of an isotropic solid on the six strains."""
    lame = material.E * material.nu / ((1.0 + material.nu) * (1.0 - 2.0 * material.nu))
    D = material.G * np.diag([2.0, 1.0, 1.0, 2.0, 2.0, 1.0])
    D[np.ix_([0, 3, 4], [0, 3, 4])] += lame
    return D
