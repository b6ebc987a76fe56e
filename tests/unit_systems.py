"""The same scene in several systems of units: what is true in one is true in all.

A scene is built by a function of a :class:`UnitSystem` from data in metres, kilograms and seconds::

    def pendulum(u: UnitSystem) -> fl.Scene:
        steel = fl.Material(u.stress(2e11), 0.3, u.density(7800.0))
        section = fl.Section.circle(u.length(0.01), steel)
        ...

    @pytest.mark.parametrize("u", UNIT_SYSTEMS, ids=str)
    def test_period(u):
        scheme = fl.GeneralisedAlpha(radius=0.8)
        result = scheme.run(pendulum(u), duration=u.time(1.0), step=u.time(1e-3))
        x = u.inverse.length(result.position(tip))  # back in metres
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Numbers = npt.NDArray[np.float64]


@dataclass(frozen=True)
class UnitSystem:
    """How many of its units are a metre, a kilogram and a second.

    Each method takes numbers in metres, kilograms and seconds, and returns those of this system.

    Attributes:
        name: Of the system.
        metre: Its units of length in a metre.
        kilogram: Its units of mass in a kilogram.
        second: Its units of time in a second.
    """

    name: str
    metre: float
    kilogram: float
    second: float

    def __str__(self) -> str:
        """The name, for the identifiers of tests."""
        return self.name

    @property
    def inverse(self) -> UnitSystem:
        """Its methods lead from this system back to metres, kilograms and seconds."""
        return UnitSystem(f"from {self.name}", 1 / self.metre, 1 / self.kilogram, 1 / self.second)

    def of(
        self, value: npt.ArrayLike, length: float = 0, mass: float = 0, time: float = 0
    ) -> Numbers:
        """What has the dimension ``lengthᵃ massᵇ timeᶜ``; a 0-d result is a ``numpy.float64``."""
        factor = self.metre**length * self.kilogram**mass * self.second**time
        return np.asarray(value, dtype=np.float64)[()] * factor

    # --- kinematics ---

    def length(self, value: npt.ArrayLike) -> Numbers:
        """Positions, displacements, thicknesses."""
        return self.of(value, length=1)

    def area(self, value: npt.ArrayLike) -> Numbers:
        """Areas."""
        return self.of(value, length=2)

    def time(self, value: npt.ArrayLike) -> Numbers:
        """Times, steps, durations."""
        return self.of(value, time=1)

    def rate(self, value: npt.ArrayLike) -> Numbers:
        """Angular velocities, frequencies, eigenvalues, mass damping."""
        return self.of(value, time=-1)

    def velocity(self, value: npt.ArrayLike) -> Numbers:
        """Velocities of positions."""
        return self.of(value, length=1, time=-1)

    def acceleration(self, value: npt.ArrayLike) -> Numbers:
        """Accelerations of positions, gravity."""
        return self.of(value, length=1, time=-2)

    def twist(self, value: npt.ArrayLike) -> Numbers:
        """(velocity, angular velocity), shape (…, 6)."""
        return self._halves(value, self.velocity(1.0), self.rate(1.0))

    def increment(self, value: npt.ArrayLike) -> Numbers:
        """(translation, rotation), shape (…, 6)."""
        return self._halves(value, self.length(1.0), 1.0)

    def frame(self, value: npt.ArrayLike) -> Numbers:
        """Position over three directors, shape (…, 4, 3)."""
        frames = np.array(value, dtype=np.float64)
        frames[..., 0, :] *= self.metre
        return frames

    # --- masses ---

    def mass(self, value: npt.ArrayLike) -> Numbers:
        """Masses."""
        return self.of(value, mass=1)

    def density(self, value: npt.ArrayLike) -> Numbers:
        """Mass per volume."""
        return self.of(value, length=-3, mass=1)

    def line_density(self, value: npt.ArrayLike) -> Numbers:
        """Mass per length."""
        return self.of(value, length=-1, mass=1)

    def inertia(self, value: npt.ArrayLike) -> Numbers:
        """Moments of inertia of a body."""
        return self.of(value, length=2, mass=1)

    def line_inertia(self, value: npt.ArrayLike) -> Numbers:
        """Moments of inertia per length of a beam."""
        return self.of(value, length=1, mass=1)

    # --- loads ---

    def force(self, value: npt.ArrayLike) -> Numbers:
        """Forces, also axial and shear stiffness of a beam."""
        return self.of(value, length=1, mass=1, time=-2)

    def moment(self, value: npt.ArrayLike) -> Numbers:
        """Moments, energies, stiffness of rotary springs."""
        return self.of(value, length=2, mass=1, time=-2)

    energy = moment

    def wrench(self, value: npt.ArrayLike) -> Numbers:
        """(force, moment), shape (…, 6)."""
        return self._halves(value, self.force(1.0), self.moment(1.0))

    def line_load(self, value: npt.ArrayLike) -> Numbers:
        """Forces per length; also stiffness of springs between positions, membrane forces."""
        return self.of(value, mass=1, time=-2)

    stiffness = line_load

    def stress(self, value: npt.ArrayLike) -> Numbers:
        """Stresses, pressures, moduli of elasticity."""
        return self.of(value, length=-1, mass=1, time=-2)

    def momentum(self, value: npt.ArrayLike) -> Numbers:
        """Momenta of translation."""
        return self.of(value, length=1, mass=1, time=-1)

    def angular_momentum(self, value: npt.ArrayLike) -> Numbers:
        """Momenta of rotation; damping of rotary springs."""
        return self.of(value, length=2, mass=1, time=-1)

    def damping(self, value: npt.ArrayLike) -> Numbers:
        """Force per velocity."""
        return self.of(value, mass=1, time=-1)

    # --- beams ---

    def bending(self, value: npt.ArrayLike) -> Numbers:
        """``E I`` and ``G J``: moment per curvature."""
        return self.of(value, length=3, mass=1, time=-2)

    def section_stiffness(self, value: npt.ArrayLike) -> Numbers:
        """(N, M) per (Γ, κ) of a beam, shape (6, 6)."""
        lengths = np.repeat([0.0, 1.0], 3)
        powers = self.metre ** np.add.outer(lengths, lengths)
        return self.force(1.0) * powers * np.asarray(value, dtype=np.float64)

    def _halves(self, value: npt.ArrayLike, first: float, last: float) -> Numbers:
        return np.asarray(value, dtype=np.float64) * np.repeat([first, last], 3)


METRES = UnitSystem("metres", 1.0, 1.0, 1.0)

MICROMETRES = UnitSystem("micrometres", 1e-6, 1e-18, 1e-6)
"""The numbers in metres, kilograms and seconds of a scene a millionth as large, of the same
materials: positions of 1e-6, masses of 1e-18, periods of 1e-6."""

KILOMETRES = UnitSystem("kilometres", 1e-3, 1.0, 1.0)

MILLIMETRES = UnitSystem("mm-N-t", 1e3, 1e-3, 1.0)
"""Millimetres, newtons, tonnes and seconds."""

TINY_MASSES = UnitSystem("masses of 1e-15", 1.0, 1e-15, 1.0)

UNIT_SYSTEMS = (METRES, MICROMETRES, KILOMETRES, MILLIMETRES, TINY_MASSES)
"""All; the first is that of the data."""

OTHER_SYSTEMS = UNIT_SYSTEMS[1:]
