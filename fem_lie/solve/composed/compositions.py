r"""Of which parts a step is composed, so that the errors of a symmetric scheme cancel.

A symmetric scheme of second order has, over a step h, an error in odd powers of h alone. Steps of
the sizes ``γₖ h`` one after the other, the same from either end, are of fourth order if::

    Σ γₖ = 1,      Σ γₖ³ = 0.

So at least one of them goes back. (Yoshida, Phys. Lett. A 150 (1990) 262; Suzuki, Phys. Lett. A 146
(1990) 319; Hairer, Lubich & Wanner, Geometric Numerical Integration, chapters II.4 and V.3.)

What a scheme for constraints gives is symmetric, but not near the identity: velocities, and rates
of directors, that break what is constrained, by the order h², change their sign in each of its
steps. Two steps are near the identity. So each part is made in two halves.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

_TRIPLE = 1.0 / (2.0 - 2.0 ** (1.0 / 3.0))
_FIVE = 1.0 / (4.0 - 4.0 ** (1.0 / 3.0))


class Composition(ABC):
    """Parts of a step."""

    @property
    @abstractmethod
    def parts(self) -> tuple[float, ...]:
        """Their sizes, of that of the step, in order; they are the same from either end."""

    @property
    def halves(self) -> tuple[float, ...]:
        """Sizes of the steps that are made."""
        return tuple(0.5 * part for part in self.parts for _ in range(2))


@dataclass(frozen=True)
class TripleJump(Composition):
    """Three parts: 1.35, −1.70 and 1.35 of a step.

    It goes ahead of the end of the step by 0.35 of it, and behind its start by as much: functions
    of time must be defined there.
    """

    @property
    def parts(self) -> tuple[float, ...]:
        """See the base class."""
        return _TRIPLE, 1.0 - 2.0 * _TRIPLE, _TRIPLE


@dataclass(frozen=True)
class FiveStages(Composition):
    """Five parts: 0.41, 0.41, −0.66, 0.41 and 0.41 of a step.

    It stays between the ends of the step, and its error is some hundred times less than that of
    :class:`TripleJump` with the same step.
    """

    @property
    def parts(self) -> tuple[float, ...]:
        """See the base class."""
        return _FIVE, _FIVE, 1.0 - 4.0 * _FIVE, _FIVE, _FIVE


@dataclass(frozen=True)
class NineStages(Composition):
    """Nine parts: four of a sixth of the step, one back by a third, and four of a sixth.

    As :class:`FiveStages` it stays between the ends of the step. Of as many parts in all its error
    is half of that in smooth motions, for it goes back less; steps are to be 1.8 times as large.
    """

    @property
    def parts(self) -> tuple[float, ...]:
        """See the base class."""
        return (*[1.0 / 6.0] * 4, -1.0 / 3.0, *[1.0 / 6.0] * 4)
