"""Energy that never increases, momenta to round-off: what a step does not resolve is damped."""

from __future__ import annotations

from dataclasses import dataclass

from fem_lie._wanted import number
from fem_lie.solve.conserving_run import Options
from fem_lie.solve.energy_momentum import EnergyMomentum


@dataclass(frozen=True)
class EnergyDecaying(EnergyMomentum):
    """:class:`EnergyMomentum` with dissipation at high frequencies.

    Kinetic and elastic energy, less the work of loads, does not increase in any step, whatever the
    scene and the step. Momenta are conserved as by :class:`EnergyMomentum`. Linear problems are
    integrated by an A-stable two-step method of second order, between the trapezoidal rule
    (``radius`` 1) and BDF2 (``radius`` 0); see :mod:`fem_lie.solve.filtered`. What was dissipated
    is the third column of ``result.balance``.

    Attributes:
        radius: Spectral radius at infinite frequency, in [0, 1]; 1 conserves.
    """

    radius: float = 0.8

    def __post_init__(self) -> None:
        """Check the options."""
        super().__post_init__()
        number(self.radius, "radius")
        if not 0.0 <= self.radius <= 1.0:
            raise ValueError(f"the spectral radius must be in [0, 1], got {self.radius}")

    def _told(self) -> Options:
        loss = (1.0 - self.radius) / (3.0 + self.radius)
        return Options(self.tolerance, self.policy, self.max_iterations, loss, 1.0 - loss)
