"""Stress resultants of thin shells: at integration points, in cells, at nodes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fem_lie._arrays import Array, instance
from fem_lie.bodies.thin_shells.assembly import ThinShellAssembly
from fem_lie.bodies.thin_shells.thin_shell import ThinShell
from fem_lie.mesh.bicubic import hermite
from fem_lie.results.states import States, nodes_in, require_states, state_number
from fem_lie.results.stresses.fields import Fields
from fem_lie.results.stresses.nodal_values import SharedValues, axes_along
from fem_lie.results.stresses.shell_stress import (
    QUANTITIES,
    Quantity,
    in_axes,
    mean_direction,
    names_of,
    quantity,
)

_IN_SURFACE = tuple(name for name in QUANTITIES if not name.startswith("Q"))
_CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])


@dataclass(frozen=True, eq=False, repr=False)
class ThinResultants(Fields):
    """Stress resultants of a thin shell in one state, along the axes of its sections.

    Attributes:
        shell: The thin shell, with m cells and p points.
        positions: Current positions of the integration points, shape (m, g, 3).
        strains: ``(E₁₁, E₂₂, 2E₁₂, K₁₁, K₂₂, 2K₁₂)``, shape (m, g, 6).
        at_points: ``(N₁₁, N₂₂, N₁₂, M₁₁, M₂₂, M₁₂)`` per undeformed length at the integration
            points, shape (m, g, 6).
    """

    shell: ThinShell
    positions: Array
    strains: Array
    at_points: Array

    @property
    def _body(self) -> ThinShell:
        return self.shell

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of all quantities that the sections have; transverse shear is none of them."""
        return names_of(self.shell, _IN_SURFACE)

    def raw(self, name: str) -> Array:
        """A quantity at the integration points, shape (m, g).

        Args:
            name: As for :meth:`fem_lie.post.Resultants.raw`, without transverse shear.

        Raises:
            ValueError: There is no such quantity, or this section has no such stress; likewise in
                the following methods.
        """
        thickness = np.broadcast_to(
            self.shell.model.thickness[:, np.newaxis], self.strains.shape[:2]
        )
        return self._known(name).of(self.at_points, thickness)

    def mean(self, name: str) -> Array:
        """A quantity of the mean components of each cell, shape (m,).

        Args:
            name: Name of the quantity, such as "N11".
        """
        weights = self.shell.model.formulation.weights()
        return self._known(name).of(
            np.einsum("g,mgi->mi", weights / weights.sum(), self.at_points),
            self.shell.model.thickness,
        )

    def smooth(self, name: str) -> Array:
        """A quantity of the averaged components, shape (p,).

        Components are extrapolated in each cell by a bilinear field, and averaged at each point
        over its cells, in the mean of their axes.

        Args:
            name: Name of the quantity, such as "N11".

        Raises:
            ValueError: Cells of several sizes meet at points that not all of them have.
        """
        known = self._known(name)
        thickness = np.repeat(self.shell.model.thickness[:, np.newaxis], 4, axis=1)
        return known.of(self._averaged, self._shared.mean(thickness))

    def _known(self, name: str) -> Quantity:
        return quantity(name, self.names, self.shell)

    @cached_property
    def _shared(self) -> SharedValues:
        """The value of each point, shared by all cells there."""
        shell = self.shell
        if shell.model.sizes[:, 3].any():
            raise ValueError(
                f"cells of several sizes meet in {shell.label}, so values have no mean at points: "
                "expected raw or mean"
            )
        points = np.arange(shell.model.points_count)
        return SharedValues(
            shell.model.connectivity[:, :4], points, np.zeros(len(points), dtype=bool)
        )

    @cached_property
    def _averaged(self) -> Array:
        """Averaged components in the mean axes of each point, shape (p, 8); no shear."""
        shell, shared = self.shell, self._shared
        x, _ = hermite.gauss(shell.model.formulation.points)
        fit = _bilinear(_CORNERS) @ np.linalg.pinv(_bilinear(hermite.products(x, x)))
        in_cells = np.zeros((*shared.number.shape, 8))
        in_cells[..., :6] = fit @ self.at_points
        normals = shell.frames[: shell.model.points_count, 3]
        own = axes_along(normals[shared.number], shell.model.axes[:, np.newaxis])
        axes = axes_along(normals, mean_direction(shared, normals, own[:, :, 0]))
        return shared.mean(in_axes(in_cells, own, axes[shared.number]))


def thin_resultants(result: States, shell: ThinShell, state: int = -1) -> ThinResultants:
    """Stress resultants of a thin shell in one state, from its assumed strains.

    Args:
        result: A result of a scene with the shell.
        shell: The thin shell.
        state: Index of the state; default: the last.

    Raises:
        ValueError: The scene of the result does not have this body, or there is no such state.
        TypeError: The body is not a thin shell.
    """
    instance(shell, ThinShell, "thin_resultants: shell", "a ThinShell (of a Shell: resultants)")
    require_states(result)
    frames = result.frames[state_number(state, len(result.frames))]
    H = np.ascontiguousarray(frames[nodes_in(result.info, shell)])
    term = ThinShellAssembly([shell.model])
    strains = term.strains(H)
    stress = np.einsum("mij,mgj->mgi", term.stiffness, strains)
    values, _, _ = shell.model.formulation.surface_rule()
    positions = np.einsum("ga,maj->mgj", values, shell.model.hermite_vectors(H))
    return ThinResultants(shell, positions, strains, stress)


def _bilinear(points: Array) -> Array:
    """The four bilinear functions at points (g, 2), shape (g, 4)."""
    one, a, b = np.ones(len(points)), points[:, 0], points[:, 1]
    return np.column_stack([one, a, b, a * b])
