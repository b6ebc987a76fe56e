"""Pressure loads on beams and shells, normal to the deformed configuration."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, direction, number, vector, vectors_at
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.membranes.membrane import Membrane
from fem_lie.bodies.shells.shell import Shell
from fem_lie.bodies.thin_shells.smooth_surface import SmoothSurface
from fem_lie.elements.beams.pressure import Pressure
from fem_lie.elements.shells.pressure import SurfacePushes
from fem_lie.elements.thin_shells.pressure import ThinPushes
from fem_lie.mesh.shapes import FaceRule
from fem_lie.scene.load import Carrier, History, Load, Sum
from fem_lie.scene.surface_loads import SHELL, nodes_of, on_parts, sides_of


@dataclass(frozen=True, eq=False)
class PressureLoad(Load):
    """Pressure on one face of a beam: normal to the deformed axis, per *current* length.

    The force per length is ``p x' × w``; ``w``, the axis across the face, rotates with the
    section; its load stiffness is in the matrix. It has no potential.

    Attributes:
        beam: The loaded beam.
        pressure: Force per current length (pressure times the width of the face).
        direction: Direction of the force in the unloaded section frame, across the axis.
        cells: Name of a group of cells; default: all.
        history: Factor as a function of time.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> tube = fl.Section.circle(0.01, steel)
        >>> beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), tube, cells=4)
        >>> scene = fl.Scene()
        >>> _ = scene.add(beam)
        >>> load = scene.add(fl.loads.PressureLoad(beam, 50.0))
        >>> len(scene.loads)
        1
    """

    divisible = True
    carrier = Carrier("beam", Beam, "a Beam").elsewhere(
        "on shells: SurfacePressure, on solids: FacePressure"
    )

    beam: Beam
    pressure: float
    direction: npt.ArrayLike = (0.0, 0.0, 1.0)
    cells: str | None = None
    history: History | None = None

    def check(self) -> None:
        """Raise ``ValueError`` if it is not finite, or its direction is zero or along the axis."""
        super().check()
        push = direction(self.direction, f"direction of the pressure on {self.beam.label}")
        number(self.pressure, f"pressure on {self.beam.label}")
        if abs(push[0]) > 1e-9:
            raise ValueError(
                f"the direction of the pressure on {self.beam.label} must be across the axis "
                f"(0, y, z), got {self.direction}"
            )

    def contribute(self, to: Sum) -> None:
        """Add the pressure term on the segments between successive nodes of the loaded elements.

        Args:
            to: Sum of all loads, to which this one is added.
        """
        elements = self.beam.model.elements[self.beam.model.cells_of(self.cells)]
        along = elements[:, [0, *range(2, elements.shape[1]), 1]]
        pairs = np.stack([along[:, :-1], along[:, 1:]], axis=2).reshape(-1, 2)
        to.add_term(Pressure(to.nodes(self.beam)[pairs], self.across()))

    def across(self) -> Array:
        """Axis ``w = m × e₁`` across the loaded face times the pressure, shape (3,)."""
        push = direction(self.direction, f"direction of the pressure on {self.beam.label}")
        return self.pressure * np.cross(push, [1.0, 0.0, 0.0])


@dataclass(frozen=True, eq=False)
class SurfacePressure(Load):
    """Pressure on a shell: normal to the deformed surface, per *current* area.

    A positive pressure acts towards the side of the directors. The load stiffness is in the
    matrix, which is symmetric where the surface is closed or ends on fixed edges and planes of
    symmetry, the pressure does not jump between cells, and so there is a potential ``−∫ p dV``.

    Attributes:
        shell: The loaded shell.
        pressure: Force per area, or a function of the unloaded centre of a cell, shape (3,).
        gradient: Gradient of the pressure in space, at current positions, global components; with
            it the pressure is ``pressure + gradient · x``: hydrostatic pressure.
        cells: Name of a group of cells; default: all.
        history: Factor as a function of time.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> mesh = fl.mesh.parametric_surface(lambda a, b: np.array([a, b, 0.0]), (2, 2))
        >>> plate = fl.Shell(mesh, fl.ShellSection.layer(0.01, steel))
        >>> scene = fl.Scene()
        >>> _ = scene.add(plate)
        >>> load = scene.add(fl.loads.SurfacePressure(plate, 1e3))
        >>> len(scene.loads)
        1
    """

    divisible = True
    carrier = SHELL.elsewhere("on beams: PressureLoad, on solids: FacePressure")
    components = MappingProxyType({"gradient": 3})

    shell: Shell | Membrane | SmoothSurface
    pressure: float | Callable[[Array], float]
    gradient: npt.ArrayLike = (0.0, 0.0, 0.0)
    cells: str | None = None
    history: History | None = None

    def check(self) -> None:
        """Raise ``ValueError`` if it is not finite or the shell has no such group of cells."""
        super().check()
        if isinstance(self.shell, SmoothSurface):
            self.on_cells()
        else:
            for load, *_ in on_parts(self, self.shell):
                load.on_cells()

    def contribute(self, to: Sum) -> None:
        """Add the pressure term on the loaded cells.

        Args:
            to: Sum of all loads, to which this one is added.
        """
        shell = self.shell
        if isinstance(shell, SmoothSurface):
            chosen = shell.model.cells_of(self.cells)
            cells, rule = shell.model.connectivity[chosen], shell.model.surface_rule()
            given = shell.model.sizes[chosen], self.on_cells(), rule
            to.add_term(ThinPushes(to.nodes(shell)[cells], *given))
        else:
            for load, part, nodes in on_parts(self, shell):
                cells = to.nodes(shell)[nodes[nodes_of(part)[part.model.cells_of(self.cells)]]]
                if len(cells):
                    to.add_term(SurfacePushes(cells, load.rule(part), load.on_cells()))

    def rule(self, shell: Shell | Membrane) -> FaceRule:
        """Quadrature rule of the cells.

        Args:
            shell: The shell.
        """
        return FaceRule.of(shell.model.mesh.cell, shell.model.mesh.degree)

    def on_cells(self) -> Array:
        """Pressure and gradient of the loaded cells, towards the side of x,₁ × x,₂, (c, 4)."""
        shell, chosen = self.shell, self.shell.model.cells_of(self.cells)
        values = np.empty((len(chosen), 4))
        values[:, 1:] = self.gradient
        if isinstance(shell, SmoothSurface):
            centres = shell.model.cell_centres()
        else:
            centres = shell.model.mesh.points[shell.model.mesh.corners].mean(axis=1)
        given = self.pressure
        if callable(given):
            what = f"pressure on {shell.label}"
            values[:, :1] = vectors_at(lambda x: [given(x)], centres[chosen], 1, what)
        else:
            values[:, :1] = vector([given], 1, f"pressure on {shell.label}")
        if isinstance(shell, SmoothSurface):
            return values
        return sides_of(shell)[chosen, np.newaxis] * values
