"""Loss of stability of an equilibrium under loads without a potential, as a result."""

from __future__ import annotations

import enum
from dataclasses import dataclass

from fem_lie._arrays import Array
from fem_lie._summary import Summarised
from fem_lie.results.files.written import Saved
from fem_lie.results.vibrations.modes import Complex


class Instability(enum.Enum):
    """How an equilibrium becomes unstable.

    Attributes:
        FLUTTER: By an oscillation that grows.
        DIVERGENCE: By a motion away from it, without oscillation.
    """

    FLUTTER = "flutter"
    DIVERGENCE = "divergence"


@dataclass(frozen=True, eq=False, repr=False)
class StabilityLimit(Summarised, Saved):
    """The smallest load factor at which an equilibrium becomes unstable.

    Attributes:
        factor: The load factor.
        kind: How it becomes unstable, :class:`Instability`, by its value.
        frequency: Angular frequency of the motion that grows, rad per time; 0 in divergence.
        factors: Load factors at which eigenvalues were computed, ascending, shape (k,).
        eigenvalues: The slowest eigenvalues there, 1/time, shape (k, c); see
            :class:`~fem_lie.stability.Modes`.
        seconds: Wall time.
    """

    factor: float
    kind: str
    frequency: float
    factors: Array
    eigenvalues: Complex
    seconds: float

    @property
    def instability(self) -> Instability:
        """How it becomes unstable."""
        return Instability(self.kind)

    def __str__(self) -> str:
        """One line."""
        return f"{self.kind} at load factor {self.factor:.6g}, frequency {self.frequency:.6g}"
