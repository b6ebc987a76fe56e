"""Units on the axes of diagrams and pictures."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Units:
    """What the user's numbers are measured in, for labels."""

    length: str = "m"
    time: str = "s"
    energy: str = "J"
    momentum: str = "kg m/s"
    angular_momentum: str = "kg m²/s"
    force: str = "N"


SI = Units()
