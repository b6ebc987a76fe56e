"""The stiffness of a penalty for which none was given: that of the bodies behind the surfaces."""

from __future__ import annotations

from collections.abc import Iterable

from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.body import Body
from fem_lie.bodies.shells.shell import Shell

_FRACTION = 0.2
"""Of an element's own stiffness: impacts of bars are least noisy by it (benchmarks/elastic_bar)."""


def chosen_stiffness(bodies: Iterable[Body], power: int, what: str) -> float:
    """A fifth of the stiffness of the softest element of bodies.

    That is EA/ℓ of beams and the membrane stiffness of shells; over ℓ where forces are per length,
    and over ℓ² where they are per area.

    Args:
        bodies: Behind both surfaces.
        power: Forces are per length to this power.
        what: For the message.

    Raises:
        ValueError: There are neither beams nor shells among them.
    """
    known = [k for body in bodies if (k := _softest(body, power)) is not None]
    if not known:
        raise ValueError(
            f"{what}: Penalty needs a stiffness, for there is neither beam nor shell behind it; "
            "give m v²/δ², for a mass m that comes with a speed v and is to go in by δ"
        )
    return _FRACTION * min(known)


def _softest(body: Body, power: int) -> float | None:
    """Of the elements of a body; of a rigid one none."""
    if isinstance(body, Beam):
        return float((body.stiffness[:, 0, 0] / body.lengths ** (1 + power)).min())
    if isinstance(body, Shell):
        areas = body.areas().sum(axis=1)
        return float((body.stiffness[:, 0, 0] / areas ** (0.5 * power)).min())
    return None
