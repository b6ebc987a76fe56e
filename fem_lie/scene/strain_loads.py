"""Strain loads on beams: eigenstrain, temperature, prestress."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, vector
from fem_lie.bodies.beams.beam import Beam
from fem_lie.scene.load import StrainLoad

if TYPE_CHECKING:
    from fem_lie.scene.load import History


@dataclass(frozen=True, eq=False)
class Eigenstrain(StrainLoad):
    """A stress-free strain of a beam, such as growth or an actuator.

    Attributes:
        beam: The loaded beam.
        strain: (Γ₁, Γ₂, Γ₃, κ₁, κ₂, κ₃), curvatures in rad per length.
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

    components = MappingProxyType({"strain": 6})

    beam: Beam
    strain: npt.ArrayLike
    cells: str | None = None
    history: History | None = None

    def strains(self) -> Array:
        """Stress-free strain of each cell, shape (m, 6)."""
        return self._in_cells(self.strain)


@dataclass(frozen=True, eq=False)
class Temperature(StrainLoad):
    """Temperature change of a beam, linear over the section.

    A point (y, z) of the section is warmer by ``rise + gradient · (y, z)``.

    Attributes:
        beam: The loaded beam.
        rise: Temperature change at the axis.
        expansion: Coefficient of thermal expansion, per temperature.
        gradient: Temperature gradient along e₂ and e₃, shape (2,), temperature per length.
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

    components = MappingProxyType({"gradient": 2})

    beam: Beam
    rise: float
    expansion: float
    gradient: npt.ArrayLike = (0.0, 0.0)
    cells: str | None = None
    history: History | None = None

    def check(self) -> None:
        """Raise ``ValueError`` if an argument is not finite or there is no such group of cells."""
        super().check()
        vector([self.rise, self.expansion], 2, f"rise and expansion of {self.beam.label}")

    def strains(self) -> Array:
        """Stress-free strain of each cell, shape (m, 6): ε = α ΔT(y, z) = Γ₁ + z κ₂ − y κ₃."""
        y, z = np.asarray(self.gradient, dtype=np.float64)
        strain = self.expansion * np.array([self.rise, 0, 0, 0, z, -y])
        return self._in_cells(strain)


@dataclass(frozen=True, eq=False)
class PreStress(StrainLoad):
    """Initial stress resultants of a beam: force and moment of the section in the unloaded state.

    Attributes:
        beam: The loaded beam.
        resultant: (N₁, N₂, N₃, M₁, M₂, M₃) in the section's frame.
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

    components = MappingProxyType({"resultant": 6})

    beam: Beam
    resultant: npt.ArrayLike
    cells: str | None = None
    history: History | None = None

    def strains(self) -> Array:
        """Stress-free strain of each cell that causes the resultants, −D⁻¹ (N, M), shape (m, 6)."""
        resultant = np.asarray(self.resultant, dtype=np.float64)
        strain = np.linalg.solve(self.beam.model.element_stiffness, -resultant[:, np.newaxis])
        return self._in_cells(strain[..., 0])
