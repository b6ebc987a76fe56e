r"""Step sizes that follow the speed of the motion and do not distinguish past from future.

A symmetric scheme keeps the energy of a reversible motion without drift, with constant steps; also
with variable ones if the rule of the sizes is symmetric: the same sequence of steps, run backwards,
obeys it. A choice by the error of the last step is not (E. Hairer & G. Söderlind, SIAM J. Sci.
Comput. 26 (2005) 1838). The size is the inverse of a density ``ρ``, wanted as::

    ρ² = 1/L² + v²/d²          v² = 2 T/m

with the largest step L, the distance d, the kinetic energy T and the mass m of the scene: a point
that moves at the root mean square speed v goes a distance d in a step, unless that takes longer
than L. Along the motion ``ρ dρ = dT/(m d²)``, and Hairer & Söderlind integrate this rate instead of
evaluating ρ. Here all terms are those of whole steps, around the midpoint of the last one::

    log ρ(n + ½) − log ρ(n − 3/2) = ΔT/(T̄ + ½ m d²/L²)

``ΔT = Δq·Δp/h`` and ``T̄ = ½ q̇·p̄`` need the step and the momenta at its ends only: no factorisation
and no force is evaluated for the size, and reversed motion reverses the sign of the right side.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, inf, log

from fem_lie._arrays import positive
from fem_lie._state import attributes
from fem_lie.solve.division import HALVINGS
from fem_lie.solve.step_control import Control, StepChoice, check_events, readable, sorted_events

SMALLEST = 1e-3
"""Default of the smallest step, over the largest."""


@readable
@dataclass(frozen=True)
class SymmetricStep(StepChoice):
    """Step sizes for :class:`~fem_lie.schemes.Variational` by the speed: no drift of the energy.

    The size is about ``1/√(1/L² + v²/d²)`` with the root mean square speed v of the mass: short
    steps where the scene moves fast, and about the same distance d in each of them. The rule is
    symmetric in time (:mod:`fem_lie.solve.symmetric_steps`). Steps before the end of the run and
    before discontinuities are fitted to end there; a step that does not converge is halved. Both
    are exceptions from the symmetry, and ``Result.steps`` shows them. Motions that cannot be
    reversed, as with dampers or loads that depend on time, have no such energy with any steps.

    Attributes:
        distance: Distance d that a point with the root mean square speed moves in a step, length.
        largest: Step size L at rest, the largest.
        smallest: Smallest step size; default: a thousandth of the largest.
        events: Times of discontinuities of loads or motions, in addition to those known to the
            scene. Steps end there.
        refinement: If above 1, the true local errors are measured: each step is repeated with this
            number of sub-steps.
    """

    distance: float
    largest: float
    smallest: float | None = None
    events: Sequence[float] = ()
    refinement: int = 1

    def check(self, duration: float) -> None:
        """Raise ``ValueError`` if a size, an event or the refinement is invalid.

        Args:
            duration: Duration of the run.
        """
        positive(self.distance, "distance")
        positive(self.largest, "largest")
        if self.smallest is not None:
            positive(self.smallest, "smallest")
        if self._smallest > self.largest:
            raise ValueError(
                f"expected smallest ≤ largest step, got {self.smallest:g}, {self.largest:g}"
            )
        check_events(self.events, duration, self.refinement)

    def control(
        self, duration: float, length: float, order: int, jumps: Sequence[float] = ()
    ) -> SymmetricControl:
        """Control that follows the kinetic energy.

        Args:
            duration: Duration of the run.
            length: Characteristic size of the scene.
            order: Order of the scheme.
            jumps: Times at which loads or drives jump.
        """
        times = sorted_events(self.events, jumps, duration)
        return SymmetricControl(self, times, self._smallest, order)

    @property
    def _smallest(self) -> float:
        return self.smallest or SMALLEST * self.largest


class SymmetricControl(Control):
    """Step size control of one run by its kinetic energy.

    Attributes:
        choice: Options.
        density: Logarithm of the inverse of the next size.
        coming: That of the size after it, from :meth:`observe`.
    """

    STATE = attributes("density", "_before", "coming", "_change", "_halvings")

    def __init__(
        self, choice: SymmetricStep, events: Sequence[float], smallest: float, order: int
    ) -> None:
        """Start with the largest size; :meth:`begin` sets that of the motion.

        Args:
            choice: Options.
            events: Times at which a step must end, the end of the run last.
            smallest: Smallest size of steps that converge.
            order: Order of the scheme.
        """
        least = smallest / 2**HALVINGS
        super().__init__(choice.largest, inf, inf, events, choice.largest, least, order)
        self.choice, self._least, self._halvings = choice, smallest, 0
        self.density = self._before = self.coming = -log(choice.largest)
        self._change = 0.0

    def begin(self, square: float, growth: float) -> None:
        """Set the first size.

        Args:
            square: Mean square of the speed at the start, v².
            growth: Its rate, d(v²)/dt.
        """
        choice = self.choice
        now = 0.5 * log(choice.largest**-2 + square / choice.distance**2)
        self._change = self._relative(square, growth * exp(-now))
        self.density = self._before = now + 0.5 * self._change
        self._since = 0

    def _relative(self, square: float, change: float) -> float:
        """Increment of the logarithm of the density with that of v²."""
        choice = self.choice
        return 0.5 * change / ((choice.distance / choice.largest) ** 2 + square)

    @property
    def size(self) -> float:
        """Size of the next step."""
        wanted = min(max(exp(-self.density), self._least), self._largest)
        return float(wanted / 2**self._halvings)

    def observe(self, square: float, change: float) -> None:
        """Compute the size that follows the next step from the step just made.

        Args:
            square: Mean square of the speed at its midpoint, v².
            change: Increment of v² over it.
        """
        here = self._relative(square, change)
        # the first step has none before it: the change around its end is extrapolated, or else the
        # sizes of even and odd steps would differ from now on
        first = self.density + 2.0 * here - self._change
        self.coming = self._before + 2.0 * here if self._since else first

    def ratio(self, translation: float, rotation: float, h: float) -> float:
        """No step is rejected for its error.

        Args:
            translation: Estimated error of translations, a length.
            rotation: Estimated error of rotations, rad.
            h: Step size.
        """
        return 0.0

    def accept(self, e: float) -> None:
        """Proceed to the next size.

        Args:
            e: Not used.
        """
        self._before, self.density = self.density, self.coming
        self._since, self._halvings = self._since + 1, 0

    def reject(self, e: float) -> None:
        """Halve a step that did not converge.

        Args:
            e: Not used.
        """
        self._halvings += 1
