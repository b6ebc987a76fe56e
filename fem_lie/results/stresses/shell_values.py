"""Stress resultants of a shell in one state, as arrays.

The components are work-conjugate to the strains of :mod:`fem_lie.elements.shells.strains`: forces
and moments per *unloaded* length along the axes (e₁, e₂) of the section, which the deformation
carries along. With the director as z, ``N = ∫ σ dz``, ``M = ∫ σ z dz`` (positive ``M₁₁`` pulls at
the top, ``M₁₁ = −D (w,₁₁ + ν w,₂₂)``), and ``Q`` is the transverse shear. In equilibrium with the
loads are the forces on cuts, :attr:`ResultantValues.cut_forces`. Mixed elements give their own
stress field, the others the law at their strain.

Values at points of integration are those of the element. Those at nodes are extrapolated in each
cell by a (bi)linear field, and averaged, as tensors, over the cells that meet smoothly there; at
the edges of meshes of first degree see :mod:`fem_lie.results.stresses.nodal_values`. No average is
taken across a kink, or where the section changes abruptly.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

import numpy as np

from fem_lie._arrays import Array
from fem_lie.bodies.shells.shell import Shell
from fem_lie.mesh.surfaces import KINK_ANGLE
from fem_lie.results.stresses.nodal_values import (
    axes_along,
    carried_axes,
    extrapolation,
    nearby,
    planes,
    slopes_along,
    unit,
)
from fem_lie.results.stresses.shell_stress import (
    QUANTITIES,
    Quantity,
    ShellStress,
    StressPlaces,
    in_axes,
    integration,
    quantity,
)

LARGEST_JUMP = 0.5 * KINK_ANGLE  # of axes, from their mean

Kind = TypeVar("Kind", bound="ResultantValues")


@dataclass(frozen=True, eq=False)
class ResultantValues:
    """Values of the resultants of a shell in one state.

    Components are ``(N11, N22, N12, M11, M22, M12, Q1, Q2)``. Cells and nodes are those of
    ``shell.own_mesh``.

    Attributes:
        shell: The shell.
        frames: Frames of its nodes, shape (n, 4, 3).
        places: Where values are, and their unloaded axes.
        at_points: At the points of integration, shape (m, g, 8).
        in_cells: Extrapolated to the nodes of each cell, shape (m, k, 8).
    """

    shell: Shell
    frames: Array
    places: StressPlaces
    at_points: Array
    in_cells: Array

    @classmethod
    def of(
        cls: type[Kind], shell: Shell, places: StressPlaces, frames: Array, stress: ShellStress
    ) -> Kind:
        """Evaluate in given frames of the shell's nodes."""
        raw = stress(frames)
        rule, _ = integration(shell)
        nodal = np.einsum("kg,mgi->mki", extrapolation(shell.own_mesh, rule), raw)
        return cls(
            shell,
            frames,
            places,
            in_axes(raw, places.section, places.asked),
            in_axes(nodal, places.section_at_nodes, places.asked_at_nodes),
        )

    # --- values ---

    @property
    def points(self) -> Array:
        """Places of the points of integration on the unloaded surface, shape (m, g, 3)."""
        mesh = self.shell.own_mesh
        return self.places.points.places(mesh.points[mesh.cells])

    @property
    def areas(self) -> Array:
        """Unloaded area that each of them carries, shape (m, g)."""
        return self.places.areas

    @property
    def nodal(self) -> Array:
        """Averaged values, shape (p, 8): one for each node, more where something jumps.

        Their nodes are ``places.patches.node``.

        Raises:
            ValueError: The axes of neighbouring cells differ, so that components along "the"
                axes at a node mean nothing.
        """
        if self.places.jump > LARGEST_JUMP:
            raise ValueError(
                f"the axes of cells of {self.shell.label} at a common node differ from their mean "
                f"by up to {np.degrees(self.places.jump):.0f}°: give resultants(..., along=...), a "
                "direction or a function of the place, or ask for what does not depend on axes: "
                + ", ".join(name for name, each in QUANTITIES.items() if not each.turns)
            )
        return self.averaged

    @cached_property
    def averaged(self) -> Array:
        """As :attr:`nodal`, along ``places.shared``, whatever axes these are; shape (p, 8)."""
        places, patches = self.places, self.places.patches
        shared = places.shared[patches.number]
        values = patches.mean(in_axes(self.in_cells, places.asked_at_nodes, shared))
        if self.shell.own_mesh.degree == 1:
            values[patches.edge] = self._at_edges()
        return values

    def _at_edges(self) -> Array:
        """Values at edges by :mod:`fem_lie.results.stresses.nodal_values`."""
        places, patches = self.places, self.places.patches
        which, cells = nearby(patches)
        own = in_axes(self.at_points, places.asked, places.section)
        normal, e1 = (unit(self._mean(places.section[:, :, i])) for i in (2, 0))
        section, axes = axes_along(normal, e1)[cells], places.shared[which]
        away = self._mean(self.points)[cells] - self.shell.own_mesh.points[patches.node[which]]
        return planes(
            np.searchsorted(np.flatnonzero(patches.edge), which),
            np.einsum("rj,rij->ri", away, axes[:, :2]),
            in_axes(self._mean(own)[cells], section, axes),
            int(patches.edge.sum()),
        )

    def _mean(self, values: Array) -> Array:
        """Means of the cells, shape (m, b), of values at the points of integration."""
        weights = self.areas / self.areas.sum(axis=1, keepdims=True)
        mean: Array = np.einsum("mg,mgi->mi", weights, values)
        return mean

    @cached_property
    def axes(self) -> Array:
        """e₁, e₂ and the normal at the points of integration, as they are in this state.

        The deformation takes the unloaded axes along; made orthonormal again in the nearest way.
        Shape (m, g, 3, 3).
        """
        unloaded, moved = (
            self._tangents(self.shell.own_mesh.points),
            self._tangents(self.frames[:, 0]),
        )
        return carried_axes(self.places.asked, unloaded, moved)

    @cached_property
    def cut_forces(self) -> Array:
        """Forces on cuts normal to the unloaded e₁ and e₂, at the points of integration.

        Per unloaded length, global components, on the side from which the axis points outward::

            n_i = N_ij x,j + M_ij t,j + Q_i t

        (Simo & Fox, CMAME 72 (1989) 267). These are in equilibrium with the loads; where a shell is
        bent much and stretched little, their components in the surface, ``n₁₁ = N₁₁ + M₁₁ κ₁₁``
        and so on, are not ``N``. Shape (m, g, 2, 3).
        """
        N, M, Q = self._tensors()
        x, t = self._slopes(self.frames[:, 0]), self._slopes(self.frames[:, 3])
        cell = self.shell.own_mesh.cells
        director = self.places.points.places(self.frames[cell, 3])[:, :, np.newaxis]
        return np.asarray(N @ x + M @ t + Q[..., np.newaxis] * director)

    @cached_property
    def cut_moments(self) -> Array:
        """Moments on these cuts, ``m_i = t × M_ij x,j``; shape (m, g, 2, 3)."""
        _, M, _ = self._tensors()
        director = self.places.points.places(self.frames[self.shell.own_mesh.cells, 3])
        across = np.cross(director[:, :, np.newaxis], M @ self._slopes(self.frames[:, 0]))
        return np.asarray(across, dtype=np.float64)

    def _tensors(self) -> tuple[Array, Array, Array]:
        v = self.at_points
        N, M = v[..., [[0, 2], [2, 1]]], v[..., [[3, 5], [5, 4]]]
        return N, M, v[..., 6:]

    def _tangents(self, nodal: Array) -> Array:
        """Derivatives of a nodal vector (n, 3) by the reference coordinates, (m, g, 2, 3)."""
        return self.places.points.tangents(nodal[self.shell.own_mesh.cells])

    def _slopes(self, nodal: Array) -> Array:
        """Its derivatives along e₁ and e₂, shape (m, g, 2, 3)."""
        unloaded = self._tangents(self.shell.own_mesh.points)
        return slopes_along(self.places.asked, unloaded, self._tangents(nodal))

    def raw(self, name: str) -> Array:
        """A quantity at the points of integration, shape (m, g).

        Args:
            name: A component, "N max", "N min", "M max", "M min" (principal values), "Q" (the
                amount of shear), "mises top", "mises bottom" (of a homogeneous layer).

        Raises:
            ValueError: There is no such quantity, or no such stress in this section; likewise in
                the following methods.
        """
        return self._of(name, self.at_points)

    def mean(self, name: str) -> Array:
        """A quantity of the mean values of each cell, shape (m,)."""
        return self._known(name).of(self._mean(self.at_points), self.shell.thickness)

    def smooth(self, name: str) -> Array:
        """A quantity of the averaged values, shape (p,), see :attr:`nodal`."""
        known = self._known(name)
        patches = self.places.patches
        thickness = np.repeat(self.shell.thickness, patches.number.shape[1])
        mean = patches.mean(thickness.reshape(patches.number.shape))
        return known.of(self.nodal if known.turns else self.averaged, mean)

    def _of(self, name: str | None, values: Array) -> Array:
        """A quantity of values (m, q, 8), or all eight."""
        if name is None:
            return values
        thickness = np.broadcast_to(self.shell.thickness[:, np.newaxis], values.shape[:2])
        return self._known(name).of(values, thickness)

    def _known(self, name: str) -> Quantity:
        found = quantity(name)
        if found.layer and not self._homogeneous:
            raise ValueError(
                f"{name!r} is the stress in a homogeneous layer; the section of "
                f"{self.shell.label} is none"
            )
        return found

    @cached_property
    def _homogeneous(self) -> bool:
        """Whether stress is linear over the thickness in all cells."""
        D, t = self.shell.stiffness, self.shell.thickness[:, np.newaxis, np.newaxis]
        A, B, bending = D[:, :3, :3], D[:, :3, 3:6], D[:, 3:6, 3:6]
        error = np.maximum(np.abs(B / t), np.abs(12 * bending / t**2 - A)).max(axis=(1, 2))
        return bool((error <= 1e-9 * np.abs(A).max(axis=(1, 2))).all())
