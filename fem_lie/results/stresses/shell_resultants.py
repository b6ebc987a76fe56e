"""Stress resultants of shells: at integration points, at nodes, as functions, in files.

:mod:`fem_lie.results.stresses.shell_values` defines them::

    found = fl.post.resultants(result, shell, along=(1, 0, 0))
    found.raw("M11"), found.mean("M11"), found.smooth("M11")    # points, cells, nodes
    found.function("M11")                                       # DOLFINx
    found.write_vtk("shell.vtu")
    found.picture("shell.png", "M11")
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import dolfinx
import numpy as np
import numpy.typing as npt
from dolfinx import fem

from fem_lie._arrays import Array, instance
from fem_lie.bodies.shells.shell import Shell, numbers_in_whole, require_one_type, whole_of
from fem_lie.mesh.surfaces import KINK_ANGLE
from fem_lie.pictures.page.colours import NodalColours, at_nodes
from fem_lie.pictures.stage import SI, Canvas, Units
from fem_lie.results.states import States, nodes_in, require_states, state_number
from fem_lie.results.stresses.nodal_values import (
    DISCONTINUOUS,
    LAGRANGE,
    ElementMaker,
    cells_function,
    dolfinx_surface,
    quadrature,
    unit,
)
from fem_lie.results.stresses.shell_stress import (
    COMPONENTS,
    QUANTITIES,
    Along,
    ShellStress,
    StressPoints,
)
from fem_lie.results.stresses.shell_values import LARGEST_JUMP, ResultantValues
from fem_lie.results.stresses.stress_free import strains_in
from fem_lie.scene import Scene


def resultants(
    result: States,
    shell: Shell,
    state: int = -1,
    *,
    along: Along | None = None,
    kink_angle: float = KINK_ANGLE,
    scene: Scene | None = None,
) -> Resultants:
    """Stress resultants of a shell in one state of a result.

    Args:
        result: A result of statics, of a path or of dynamics, of a scene with the shell.
        shell: The shell.
        state: Index of the state; default: the last.
        along: e₁ before projection onto the undeformed surface: one vector, or a function of the
            position; default: the axes of the sections (``Shell.axes``).
        kink_angle: Largest angle, rad, between neighbouring cells across which nodal values are
            averaged.
        scene: The scene that was solved; needed if the shell has stress-free strains there, such
            as a :class:`~fem_lie.loads.Temperature`.

    Raises:
        ValueError: The shell is not in that result, there is no such state, ``along`` is normal to
            the surface somewhere, or stress-free strains of the shell are not known.
    """
    require_states(result)
    chosen = [state_number(state, len(result.frames))]
    (found,) = _of_states(result, shell, chosen, along, kink_angle, scene)
    return found


def resultant_series(
    result: States,
    shell: Shell,
    *,
    states: Sequence[int] | None = None,
    along: Along | None = None,
    kink_angle: float = KINK_ANGLE,
    scene: Scene | None = None,
) -> list[Resultants]:
    """Stress resultants of a shell in several states of a result.

    Args:
        result: A result with states: of a motion, of load steps or of a path.
        shell: A shell of the scene.
        states: Numbers of the states; default: all.
        along: Direction of the first axis, see :func:`resultants`.
        kink_angle: Angle between normals, rad, above which resultants are not averaged.
        scene: The scene that was solved, see :func:`resultants`.
    """
    require_states(result)
    count = len(result.frames)
    chosen = range(count) if states is None else [state_number(state, count) for state in states]
    return _of_states(result, shell, chosen, along, kink_angle, scene)


def resultant_colours(
    series: Sequence[Resultants], name: str, *, units: Units = SI
) -> NodalColours:
    """A quantity of a shell for the colours of a page, from :func:`resultant_series`.

    Args:
        series: Resultants of all states of the result that the page shows.
        name: A quantity, see :meth:`Resultants.raw`; averaged, at kinks over all sides.
        units: Units of the label.

    Raises:
        ValueError: There is no state, or no such quantity.
    """
    if not series:
        raise ValueError("colours need the resultants of at least one state, got none")
    shell, nodes = series[0].shell, series[0].stress_points.patches.node
    whole, smooth = whole_of(shell), np.array([state.smooth(name) for state in series])
    count = len(whole.frames)
    values = at_nodes(smooth, np.arange(count)[numbers_in_whole(shell)][nodes], count)
    return NodalColours(whole.name, values, f"{name} [{QUANTITIES[name].unit(units)}]")


def _of_states(
    result: States,
    shell: Shell,
    states: range | list[int],
    along: Along | None,
    kink_angle: float,
    scene: Scene | None,
) -> list[Resultants]:
    instance(shell, Shell, "shell", "a Shell")
    require_one_type(shell, "resultants()")
    nodes = nodes_in(result.info, whole_of(shell))[numbers_in_whole(shell)]
    if along is None:
        stress_points = StressPoints.in_sections(shell, kink_angle)
    else:
        stress_points = StressPoints.of(shell, along, kink_angle)
    stress, strains = ShellStress.of(shell), strains_in(result, shell, states, scene)
    moved = [result.frames[state][nodes] for state in states]
    return [
        Resultants.of(shell, stress_points, frames, stress(frames, own))
        for frames, own in zip(moved, strains, strict=True)
    ]


@dataclass(frozen=True, eq=False, repr=False)
class Resultants(ResultantValues):
    """Stress resultants of a shell in one state, per length of the undeformed surface.

    :func:`resultants` makes it. Forces are per length, moments are moments per length.
    """

    @cached_property
    def mesh(self) -> dolfinx.mesh.Mesh:
        """The undeformed surface as a DOLFINx mesh, the domain of the functions."""
        return dolfinx_surface(self.shell.model.cut_mesh, self.shell.model.cut_mesh.points)

    @cached_property
    def deformed_mesh(self) -> dolfinx.mesh.Mesh:
        """The surface in this state as a DOLFINx mesh."""
        return dolfinx_surface(self.shell.model.cut_mesh, self.frames[:, 0])

    def function(self, name: str | None = None, *, deformed: bool = False) -> fem.Function:
        """Averaged values as a continuous function of the mesh's degree.

        Args:
            name: A quantity, see :meth:`raw`; default: all eight components as a vector.
            deformed: Whether its domain is :attr:`deformed_mesh`.

        Raises:
            ValueError: As for :meth:`smooth`, or values jump (use :meth:`cell_function`).
        """
        patches, count = self.stress_points.patches, len(self.frames)
        if len(patches.node) > count:
            raise ValueError(
                f"resultants of {self.shell.label} jump at {len(patches.node) - count} nodes, at "
                "kinks or between sections: use cell_function"
            )
        values = self.nodal if name is None else self.smooth(name)
        return self._function(name, values[patches.number], LAGRANGE, deformed)

    def cell_function(self, name: str | None = None, *, deformed: bool = False) -> fem.Function:
        """Values extrapolated in each cell as a discontinuous function of the mesh's degree.

        Args:
            name: As for :meth:`function`.
            deformed: Whether its domain is :attr:`deformed_mesh`.
        """
        return self._function(name, self._of(name, self.in_cells), DISCONTINUOUS, deformed)

    def point_function(self, name: str | None = None, *, deformed: bool = False) -> fem.Function:
        """Values at the integration points, as a function of a quadrature element.

        Args:
            name: As for :meth:`function`.
            deformed: Whether its domain is :attr:`deformed_mesh`.
        """
        degree = self.shell.model.formulation.measures_for(
            self.shell.model.cut_mesh.cell, self.shell.model.cut_mesh.degree
        ).quadrature_degree
        return self._function(name, self._of(name, self.at_points), quadrature(degree), deformed)

    def _function(
        self, name: str | None, values: Array, element: ElementMaker, deformed: bool
    ) -> fem.Function:
        mesh = self.deformed_mesh if deformed else self.mesh
        return cells_function(mesh, self.shell.model.cut_mesh, values, element, name or "N, M, Q")

    # --- files and pictures ---

    def write_vtk(self, path: str | os.PathLike[str]) -> None:
        """Write the deformed surface for ParaView, pyvista or meshio.

        Point data: ``displacement``, ``director`` and the averaged values; cell data: means of the
        cells, ``e1`` and ``e2`` of the axes, ``thickness``. A point at which values jump is written
        once for each value. Components are not written as point data where axes jump, see
        :attr:`nodal`.

        Args:
            path: Name of the ``.vtu`` file.

        Raises:
            ValueError: The name does not end in ``.vtu``.
        """
        from fem_lie.pictures.vtk import write_surface

        node = self.stress_points.patches.node
        comparable = self.stress_points.jump <= LARGEST_JUMP
        names = self.names
        x = self.frames[node, 0]
        points = {n: self.smooth(n) for n in names if comparable or not QUANTITIES[n].directional}
        points |= {
            "displacement": x - self.shell.model.cut_mesh.points[node],
            "director": self.frames[node, 3],
        }
        cells = {name: self.mean(name) for name in names}
        cells |= {f"e{i + 1}": unit(self.axes[:, :, i].mean(axis=1)) for i in (0, 1)}
        cells["thickness"] = self.shell.model.thickness
        write_surface(
            path, x, self.stress_points.patches.number, self.shell.model.cut_mesh, points, cells
        )

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write all values to an HDF5 file; an existing file is replaced.

        Data sets: ``positions`` (p, 3) of the averaged values, ``cells`` (m, k) of them,
        ``averaged`` (p, 8) along ``axes`` (p, 3, 3); ``in_cells`` (m, k, 8), ``at_points`` (m, g,
        8), ``points`` (m, g, 3), ``areas`` (m, g), ``cut_forces`` and ``cut_moments`` (m, g, 2, 3);
        all positions and axes are those of the undeformed shell. The attribute ``components`` names
        the eight components.

        Args:
            path: Name of the file.
        """
        import h5py

        patches = self.stress_points.patches
        with h5py.File(path, "w") as file:
            file.attrs.update({"format": "fem_lie resultants", "version": 1})
            file.attrs["components"] = list(COMPONENTS)
            file["positions"] = self.shell.model.cut_mesh.points[patches.node]
            file["cells"], file["axes"] = patches.number, self.stress_points.shared
            file["averaged"] = self.averaged
            for name in ("in_cells", "at_points", "points", "areas", "cut_forces", "cut_moments"):
                file[name] = getattr(self, name)

    def picture(
        self,
        path: str | os.PathLike[str],
        name: str,
        *,
        magnified: float = 1.0,
        title: str = "",
        units: Units = SI,
        view: npt.ArrayLike | None = None,
    ) -> None:
        """Draw the deformed shell, coloured by a quantity, and the outline of the undeformed one.

        Args:
            path: Name of the ``.png`` file.
            name: A quantity, see :meth:`raw`.
            magnified: Factor of the displacements in the picture.
            title: Title of the picture; default: what is drawn.
            units: Units of the axes and the colour scale.
            view: Direction from the scene to the viewer: (0, 0, 1) from above. Default: at right
                angles to a plane scene, else (1, 1, 1).

        Raises:
            ValueError: The name does not end in ``.png``; or see :meth:`smooth`.
        """
        from fem_lie.pictures.bodies import DrawnSurface, draw_values

        node, X = self.stress_points.patches.node, self.shell.model.cut_mesh.points
        draw_values(
            path,
            DrawnSurface(self.shell.model.cut_mesh, self.stress_points.patches.number, X[node]),
            X[node] + magnified * (self.frames[node, 0] - X[node]),
            self.smooth(name),
            f"{name} [{QUANTITIES[name].unit(units)}]",
            Canvas(title or f"{name} of {self.shell.label}", units, view=view),
        )
