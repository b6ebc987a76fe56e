"""Stress resultants of a shell in one state, as arrays.

The components are work-conjugate to the strains of :mod:`fem_lie.elements.shells.strains`: forces
and moments per *undeformed* length along the axes (e₁, e₂) of the section, which are convected by
the deformation. With the director as z, ``N = ∫ σ dz``, ``M = ∫ σ z dz`` (a positive ``M₁₁`` gives
tension at the top, ``M₁₁ = −D (w,₁₁ + ν w,₂₂)``), and ``Q`` is the transverse shear. The forces on
cuts, :attr:`ResultantValues.cut_forces`, are in equilibrium with the loads. Mixed elements have an
independent stress field; for other elements stress follows from strain by the constitutive law.

Values at integration points are those of the element. Nodal values are extrapolated in each cell by
a (bi)linear field, and averaged, as tensors, over the cells that meet smoothly at the node; for the
edges of meshes of first degree see :mod:`fem_lie.results.stresses.nodal_values`. Values are not
averaged across a kink, or where the section changes abruptly.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.shells.shell import Shell
from fem_lie.mesh.surfaces import KINK_ANGLE
from fem_lie.results.stresses.fields import Fields
from fem_lie.results.stresses.nodal_values import (
    axes_along,
    convected_axes,
    extrapolation,
    nearby,
    planes,
    slopes_along,
    unit,
)
from fem_lie.results.stresses.shell_stress import (
    QUANTITIES,
    Quantity,
    StressPoints,
    in_axes,
    integration,
    names_of,
    quantity,
)

LARGEST_JUMP = 0.5 * KINK_ANGLE  # largest angle between axes and their mean

Kind = TypeVar("Kind", bound="ResultantValues")


@dataclass(frozen=True, eq=False, repr=False)
class ResultantValues(Fields):
    """Values of the stress resultants of a shell in one state.

    Components are ``(N11, N22, N12, M11, M22, M12, Q1, Q2)``. Cells and nodes are those of
    ``shell.own_mesh``.

    Attributes:
        shell: The shell.
        frames: Frames of its nodes, shape (n, 4, 3).
        stress_points: Evaluation points and their undeformed axes.
        at_points: Components at the integration points, shape (m, g, 8).
        in_cells: Components extrapolated to the nodes of each cell, shape (m, k, 8).
    """

    shell: Shell
    frames: Array
    stress_points: StressPoints
    at_points: Array
    in_cells: Array

    @classmethod
    def of(
        cls: type[Kind],
        shell: Shell,
        stress_points: StressPoints,
        frames: Array,
        raw: Array,
    ) -> Kind:
        """Values at given frames of the shell's nodes.

        Args:
            shell: The shell.
            stress_points: Points at which the stress is evaluated.
            frames: Nodal frames, shape (n, 4, 3).
            raw: Components at the integration points in the axes of the sections, (m, g, 8).
        """
        rule, _ = integration(shell)
        nodal = np.einsum("kg,mgi->mki", extrapolation(shell.model.cut_mesh, rule), raw)
        return cls(
            shell,
            frames,
            stress_points,
            in_axes(raw, stress_points.section, stress_points.asked),
            in_axes(nodal, stress_points.section_at_nodes, stress_points.asked_at_nodes),
        )

    # --- values ---

    @property
    def points(self) -> Array:
        """Positions of the integration points on the undeformed surface, shape (m, g, 3)."""
        mesh = self.shell.model.cut_mesh
        return self.stress_points.points.positions(mesh.points[mesh.cells])

    @property
    def areas(self) -> Array:
        """Integration weights (undeformed areas) of the integration points, shape (m, g)."""
        return self.stress_points.areas

    @property
    def nodal(self) -> Array:
        """Averaged values, shape (p, 8): one for each node, several where values jump.

        Their nodes are ``stress_points.patches.node``.

        Raises:
            ValueError: The axes of neighbouring cells differ, so that components along "the" axes
                at a node are undefined.
        """
        if self.stress_points.jump > LARGEST_JUMP:
            raise ValueError(
                f"the axes of cells of {self.shell.label} at a common node differ from their mean "
                f"by up to {np.degrees(self.stress_points.jump):.0f}°: give resultants(..., "
                "along=...), a direction or a function of the position, or ask for what does not "
                "depend on axes: "
                + ", ".join(name for name, each in QUANTITIES.items() if not each.directional)
            )
        return self.averaged

    @cached_property
    def averaged(self) -> Array:
        """As :attr:`nodal`, along ``stress_points.shared``, even if axes differ; shape (p, 8)."""
        stress_points, patches = self.stress_points, self.stress_points.patches
        shared = stress_points.shared[patches.number]
        values = patches.mean(in_axes(self.in_cells, stress_points.asked_at_nodes, shared))
        if self.shell.model.cut_mesh.degree == 1:
            values[patches.edge] = self._at_edges()
        return values

    def _at_edges(self) -> Array:
        """Values at edges, by :mod:`fem_lie.results.stresses.nodal_values`."""
        stress_points, patches = self.stress_points, self.stress_points.patches
        which, cells = nearby(patches)
        own = in_axes(self.at_points, stress_points.asked, stress_points.section)
        normal, e1 = (unit(self._mean(stress_points.section[:, :, i])) for i in (2, 0))
        section, axes = axes_along(normal, e1)[cells], stress_points.shared[which]
        away = (
            self._mean(self.points)[cells] - self.shell.model.cut_mesh.points[patches.node[which]]
        )
        return planes(
            np.searchsorted(np.flatnonzero(patches.edge), which),
            np.einsum("rj,rij->ri", away, axes[:, :2]),
            in_axes(self._mean(own)[cells], section, axes),
            int(patches.edge.sum()),
        )

    def _mean(self, values: Array) -> Array:
        """Means in the cells, shape (m, b), of values at the integration points."""
        weights = self.areas / self.areas.sum(axis=1, keepdims=True)
        mean: Array = np.einsum("mg,mgi->mi", weights, values)
        return mean

    @cached_property
    def axes(self) -> Array:
        """Convected axes e₁, e₂ and the normal at the integration points in this state.

        The undeformed axes are convected by the deformation and orthonormalised. Shape (m, g, 3,
        3).
        """
        unloaded, moved = (
            self._tangents(self.shell.model.cut_mesh.points),
            self._tangents(self.frames[:, 0]),
        )
        return convected_axes(self.stress_points.asked, unloaded, moved)

    @cached_property
    def cut_forces(self) -> Array:
        """Forces on cuts normal to the undeformed e₁ and e₂, at the integration points.

        Per undeformed length, global components, on the side from which the axis points outward::

            n_i = N_ij x,j + M_ij t,j + Q_i t

        (Simo & Fox, CMAME 72 (1989) 267). They are in equilibrium with the loads. Where bending is
        large and stretching small, their components in the surface, ``n₁₁ = N₁₁ + M₁₁ κ₁₁`` and so
        on, differ from ``N``. Shape (m, g, 2, 3).
        """
        N, M, Q = self._tensors()
        x, t = self._slopes(self.frames[:, 0]), self._slopes(self.frames[:, 3])
        cell = self.shell.model.cut_mesh.cells
        director = self.stress_points.points.positions(self.frames[cell, 3])[:, :, np.newaxis]
        return np.asarray(N @ x + M @ t + Q[..., np.newaxis] * director)

    @cached_property
    def cut_moments(self) -> Array:
        """Moments on these cuts, ``m_i = t × M_ij x,j``; shape (m, g, 2, 3)."""
        _, M, _ = self._tensors()
        director = self.stress_points.points.positions(
            self.frames[self.shell.model.cut_mesh.cells, 3]
        )
        across = np.cross(director[:, :, np.newaxis], M @ self._slopes(self.frames[:, 0]))
        return np.asarray(across, dtype=np.float64)

    def _tensors(self) -> tuple[Array, Array, Array]:
        v = self.at_points
        N, M = v[..., [[0, 2], [2, 1]]], v[..., [[3, 5], [5, 4]]]
        return N, M, v[..., 6:]

    def _tangents(self, nodal: Array) -> Array:
        """Derivatives of a nodal vector (n, 3) in the reference coordinates, (m, g, 2, 3)."""
        return self.stress_points.points.tangents(nodal[self.shell.model.cut_mesh.cells])

    def _slopes(self, nodal: Array) -> Array:
        """Derivatives of a nodal vector along e₁ and e₂, shape (m, g, 2, 3)."""
        unloaded = self._tangents(self.shell.model.cut_mesh.points)
        return slopes_along(self.stress_points.asked, unloaded, self._tangents(nodal))

    @property
    def _body(self) -> Shell:
        return self.shell

    def _values_at(self, nodes: Indices) -> Indices:
        return np.flatnonzero(np.isin(self.stress_points.patches.node, nodes))

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of all quantities that the sections have."""
        return names_of(self.shell)

    def raw(self, name: str) -> Array:
        """A quantity at the integration points, shape (m, g).

        Args:
            name: A component, "N max", "N min", "M max", "M min" (principal values), "Q" (magnitude
                of the shear), "von Mises top", "von Mises bottom" (for a homogeneous layer; the top
                is the side to which the directors d₃ point).

        Raises:
            ValueError: There is no such quantity, or this section has no such stress; likewise in
                the following methods.
        """
        return self._of(name, self.at_points)

    def mean(self, name: str) -> Array:
        """A quantity of the mean components of each cell, shape (m,).

        Args:
            name: Name of the quantity, such as "N11".
        """
        return self._known(name).of(self._mean(self.at_points), self.shell.model.thickness)

    def smooth(self, name: str) -> Array:
        """A quantity of the averaged components, shape (p,), see :attr:`nodal`.

        Args:
            name: Name of the quantity, such as "N11".
        """
        known = self._known(name)
        patches = self.stress_points.patches
        thickness = np.repeat(self.shell.model.thickness, patches.number.shape[1])
        mean = patches.mean(thickness.reshape(patches.number.shape))
        return known.of(self.nodal if known.directional else self.averaged, mean)

    def _of(self, name: str | None, values: Array) -> Array:
        """A quantity of components (m, q, 8), or all eight."""
        if name is None:
            return values
        thickness = np.broadcast_to(self.shell.model.thickness[:, np.newaxis], values.shape[:2])
        return self._known(name).of(values, thickness)

    def _known(self, name: str) -> Quantity:
        return quantity(name, self.names, self.shell)
