"""Strain loads on beams, shells and solids: eigenstrain, temperature, prestress."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, number, numbers
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.shells.shell import Shell
from fem_lie.bodies.solids.solid import Solid
from fem_lie.scene.load import Carrier, StrainLoad

if TYPE_CHECKING:
    from fem_lie.scene.load import History


@dataclass(frozen=True, eq=False)
class Eigenstrain(StrainLoad):
    """A stress-free strain of a beam, a shell or a solid, such as growth or an actuator.

    Attributes:
        loaded: The beam, shell or solid.
        strain: Of a beam (Γ₁, Γ₂, Γ₃, κ₁, κ₂, κ₃), curvatures in rad per length; of a shell
            (E₁₁, E₂₂, 2E₁₂, K₁₁, K₂₂, 2K₁₂, γ₁, γ₂) in the axes of its section, where E is Green's
            strain and a positive K extends the side of the director; of a solid Green's strain
            (E₁₁, E₂₂, E₃₃, 2E₁₂, 2E₁₃, 2E₂₃) along the global axes of the unloaded body. The
            energy of a solid, of any law, is that of ``F U₀⁻¹`` with ``U₀² = 1 + 2E``, per volume
            of the stress-free state.
        cells: Name of a group of cells; default: all.
        history: Factor as a function of time.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> tube = fl.Section.circle(0.01, steel)
        >>> beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), tube, cells=4)
        >>> scene = fl.Scene()
        >>> _ = scene.add(beam)
        >>> load = scene.add(fl.loads.Eigenstrain(beam, (0, 0, 0, 0, 0.1, 0)))
        >>> len(scene.loads)
        1
    """

    loaded: Beam | Shell | Solid
    strain: npt.ArrayLike
    cells: str | None = None
    history: History | None = None

    def check(self) -> None:
        """Raise ``ValueError`` if a component is not finite or there is no such group of cells.

        Raises:
            ValueError: Likewise if the strain of a solid is not that of a stretch.
        """
        super().check()
        self.loaded.model.check_strain(self._components("strain"))

    def strains(self) -> Array:
        """Stress-free strain of each cell, shape (m, s)."""
        return self._in_cells(self.strain)


@dataclass(frozen=True, eq=False)
class Temperature(StrainLoad):
    """Temperature change of a beam or a shell, linear over the section, or of a solid.

    A point (y, z) of the section of a beam is warmer by ``rise + gradient · (y, z)``, a point of a
    shell at the distance z from its mid-surface, towards the director, by ``rise + gradient z``.
    A solid without load is longer by ``expansion · rise`` in all directions; groups of its cells
    may have one temperature each.

    Attributes:
        loaded: The beam, shell or solid.
        rise: Temperature change, at the axis of a beam or the mid-surface of a shell.
        expansion: Coefficient of thermal expansion in all directions, per temperature.
        gradient: Temperature gradient, temperature per length: of a beam along e₂ and e₃, shape
            (2,), of a shell along the director, one number; a solid has none.
        cells: Name of a group of cells; default: all.
        history: Factor as a function of time.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> tube = fl.Section.circle(0.01, steel)
        >>> beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), tube, cells=4)
        >>> scene = fl.Scene()
        >>> _ = scene.add(beam)
        >>> load = scene.add(fl.loads.Temperature(beam, rise=50.0, expansion=1.2e-5))
        >>> len(scene.loads)
        1
    """

    loaded: Beam | Shell | Solid
    rise: float
    expansion: float
    gradient: npt.ArrayLike | None = None
    cells: str | None = None
    history: History | None = None

    def check(self) -> None:
        """Raise ``ValueError`` if an argument is not finite or there is no such group of cells."""
        super().check()
        self.loaded.model.check_strain(self._strain())

    def strains(self) -> Array:
        """Stress-free strain of each cell, shape (m, s)."""
        return self._in_cells(self._strain())

    def _strain(self) -> Array:
        """Strain of a section, shape (s,)."""
        where = f"of the Temperature on {self.where}"
        expansion = number(self.expansion, f"expansion {where}")
        rise = number(self.rise, f"rise {where}")
        what = f"gradient {where}"
        gradient = 0.0 if self.gradient is None else numbers(self.gradient, what)
        return self.loaded.model.thermal_strain(expansion, rise, gradient, what)


@dataclass(frozen=True, eq=False)
class PreStress(StrainLoad):
    """Initial stress resultants of a beam or a shell in the unloaded state.

    A solid has no resultants: give it a stress-free strain, :class:`Eigenstrain`.

    Attributes:
        loaded: The beam or shell.
        resultant: Of a beam force and moment (N₁, N₂, N₃, M₁, M₂, M₃) in the section's frame; of a
            shell (N₁₁, N₂₂, N₁₂, M₁₁, M₂₂, M₁₂, Q₁, Q₂) per length in the axes of its section.
        cells: Name of a group of cells; default: all.
        history: Factor as a function of time.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> tube = fl.Section.circle(0.01, steel)
        >>> beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), tube, cells=4)
        >>> scene = fl.Scene()
        >>> _ = scene.add(beam)
        >>> load = scene.add(fl.loads.PreStress(beam, (1e3, 0, 0, 0, 0, 0)))
        >>> len(scene.loads)
        1
    """

    carrier = Carrier("loaded", Beam | Shell, "a Beam or a Shell")
    loaded: Beam | Shell
    resultant: npt.ArrayLike
    cells: str | None = None
    history: History | None = None

    def check(self) -> None:
        """Raise ``ValueError`` if a component is not finite or there is no such group of cells."""
        super().check()
        self._components("resultant")

    def strains(self) -> Array:
        """Stress-free strain of each cell that causes the resultants, −D⁻¹ S, shape (m, s)."""
        resultant = np.asarray(self.resultant, dtype=np.float64)
        strain = np.linalg.solve(self.loaded.model.element_stiffness, -resultant[:, np.newaxis])
        return self._in_cells(strain[..., 0])
