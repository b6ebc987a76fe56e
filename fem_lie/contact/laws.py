"""What surfaces do that touch."""

from __future__ import annotations

from dataclasses import dataclass

from fem_lie._arrays import number, positive


@dataclass(frozen=True)
class Penalty:
    """Surfaces push each other apart where they overlap: ``½ k g²`` at a gap ``g < 0``.

    The force is ``p = max(0, −k g − c ġ)``: it never pulls. It is for statics and for
    :class:`~fem_lie.GeneralisedAlpha`. A body of mass m that meets a fixed one at a speed v goes in
    by ``v √(m/k)``, and is in contact for ``π √(m/k)``, which steps have to resolve.

    Attributes:
        stiffness: k, force per length.
        damping: c, force per speed; ``2 √(k m)`` is critical for a mass m.
    """

    stiffness: float
    damping: float = 0.0

    def __post_init__(self) -> None:
        """Raise ``TypeError`` or ``ValueError`` for numbers that are none, or out of range."""
        positive(self.stiffness, "Penalty: stiffness")
        if number(self.damping, "Penalty: damping") < 0.0:
            raise ValueError(f"Penalty: damping must not be negative, got {self.damping}")
