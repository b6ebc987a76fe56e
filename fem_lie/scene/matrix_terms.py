"""Terms of the iteration matrix that a scene needs, and those that may be left out."""

from __future__ import annotations

from dataclasses import dataclass

from fem_lie._arrays import flag


@dataclass(frozen=True)
class MatrixTerms:
    """Terms of the iteration matrix of dynamics; the equations always have all terms.

    A term that is left out costs iterations, never accuracy. ``None`` leaves the choice to the
    scene, which logs it.

    Attributes:
        gyroscopic: Derivatives of gyroscopic and centrifugal forces. Default: if anything initially
            rotates by more than :data:`SPIN_PER_STEP` in a step.
        geometric: Geometric stiffness of elements and joints, and that of nodal forces, whose
            components along the nodes' axes change with these. At equilibrium the sum of both is
            symmetric. Default: yes.
    """

    gyroscopic: bool | None = None
    geometric: bool | None = None

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if a choice is not true, false or ``None``."""
        for name in ("gyroscopic", "geometric"):
            if getattr(self, name) is not None:
                flag(getattr(self, name), f"MatrixTerms: {name}")

    def __str__(self) -> str:
        """Text in one line for the log."""
        names = "gyroscopic terms in the matrix", "geometric stiffness"
        chosen = zip(names, (self.gyroscopic, self.geometric), strict=True)
        return "; ".join(f"{name}: {'yes' if value else 'no'}" for name, value in chosen)

    def resolve(self, spin_per_step: float) -> MatrixTerms:
        """Choices without ``None``, for the largest rotation in a step, rad.

        Args:
            spin_per_step: Largest rotation in a step, rad.
        """
        gyroscopic, geometric = self.gyroscopic, self.geometric
        return MatrixTerms(
            spin_per_step > SPIN_PER_STEP if gyroscopic is None else gyroscopic,
            True if geometric is None else geometric,
        )


SPIN_PER_STEP = 0.01
"""Rotation per step, rad, above which gyroscopic terms are in the matrix.

Measured in docs/measured/choices.md.
"""
