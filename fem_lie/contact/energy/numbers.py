"""The law of a contact by penalty as numbers, for compiled code."""

from __future__ import annotations

from typing import NamedTuple

from fem_lie._jit import inlined_uncounted


class Numbers(NamedTuple):
    """Of a law, for a weight of one.

    Attributes:
        k: Stiffness.
        c: Damping.
        ramp: Overlap over which that grows.
    """

    k: float
    c: float
    ramp: float


@inlined_uncounted
def damping(law: Numbers, g: float, speed: float) -> tuple[float, float, float]:
    """What damping adds to ``k g``, and how that changes with ``g`` and ``ġ``: nothing pulls."""
    part, by_gap = 1.0, 0.0
    if -g < law.ramp:
        part, by_gap = -g / law.ramp, -1.0 / law.ramp
    if law.k * g + part * law.c * speed >= 0.0:
        return -law.k * g, -law.k, 0.0
    return part * law.c * speed, by_gap * law.c * speed, part * law.c
