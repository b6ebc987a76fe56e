"""How much of the restitution a step may have without a gain of energy.

Newton's law is for the normal velocity of one contact. Where several meet in a step, where normals
turn within it or positions are corrected against a force, it may give more energy than impacts had.
"""

from __future__ import annotations

from collections.abc import Callable

_TRIES, _ENOUGH = 8, 1e-3
"""Parts of the restitution that are tried beside all and none; loss of energy, over what all of it
would gain, that is small enough."""


def allowed_part(gain: Callable[[float], float], whole: float, allowed: float) -> float:
    """A part of the restitution, near the largest, with which no energy is gained.

    Args:
        gain: Energy that a step gains with a part of the restitution.
        whole: That with all of it, more than allowed.
        allowed: Gain that is round-off.

    Returns:
        The part; 1 if energy is gained without restitution, too, for it is not what gives it.
    """
    least, below, most = 0.0, gain(0.0), 1.0
    if below > allowed:
        return 1.0
    low, high, side = below, whole, 0  # Illinois method: an end that stays twice weighs half
    for _ in range(_TRIES):
        if -below <= max(allowed, _ENOUGH * whole):
            break
        part = least - low * (most - least) / (high - low)
        here = gain(part)
        if here <= allowed:
            least, below, low = part, here, min(here, -allowed)
            high, side = 0.5 * high if side < 0 else high, -1
        else:
            most, high = part, here
            low, side = 0.5 * low if side > 0 else low, 1
    return least
