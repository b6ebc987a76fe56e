"""Options of the iteration of load steps."""

from __future__ import annotations

from dataclasses import dataclass

from fem_lie._arrays import flag, number, whole


@dataclass(frozen=True)
class Newton:
    """Newton's method from one load factor to the next.

    Attributes:
        tolerance: Predicted error of a step's end, in rotations and in translations over the size
            of the model.
        max_iterations: More in one step are its failure.
        smallest_step: Smallest load step before giving up.
        carried_stress: Carry the stress as an iterate (Magisano, Leonetti & Garcea 2017), which
            converges in a few iterations at any slenderness; otherwise plain Newton.

    Raises:
        ValueError: A tolerance that is not positive, a step outside of (0, 1].
    """

    tolerance: float = 1e-10
    max_iterations: int = 25
    smallest_step: float = 1e-3
    carried_stress: bool = True

    def __post_init__(self) -> None:
        """Refuse what is no option."""
        number(self.tolerance, "Newton: tolerance")
        number(self.smallest_step, "Newton: smallest_step")
        whole(self.max_iterations, "Newton: max_iterations")
        flag(self.carried_stress, "Newton: carried_stress")
        if not self.tolerance > 0 or not 0 < self.smallest_step <= 1:
            raise ValueError(
                "Newton: wanted tolerance > 0 and 0 < smallest_step ≤ 1, got "
                f"{self.tolerance} and {self.smallest_step}"
            )
