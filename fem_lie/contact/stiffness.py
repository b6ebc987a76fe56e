"""Default stiffness of a penalty, from the stiffness of the bodies in contact."""

from __future__ import annotations

from collections.abc import Iterable

from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.body import Body
from fem_lie.bodies.shells.shell import Shell

_FRACTION = 0.2
"""Penalty stiffness over the stiffness of an element. Impacts of bars are least oscillatory with
this value (benchmarks/elastic_bar)."""


def chosen_stiffness(bodies: Iterable[Body], power: int, what: str) -> float:
    """Penalty stiffness: a fifth of the stiffness of the softest element of the bodies.

    The stiffness of an element is EA/ℓ of a beam and the membrane stiffness of a shell. It is
    divided by ℓ where contact forces are per length, and by ℓ² where they are per area.

    Args:
        bodies: Bodies that both surfaces belong to.
        power: Exponent of length in the unit of contact forces: 0 for points, 1 along lines, 2 over
            areas.
        what: Label of the contact for the message.

    Raises:
        ValueError: There is neither a beam nor a shell among the bodies.
    """
    known = [k for body in bodies if (k := _softest(body, power)) is not None]
    if not known:
        raise ValueError(
            f"{what}: Penalty needs a stiffness, for neither surface belongs to a beam or a shell; "
            "give m v²/δ², for a mass m that comes with a speed v and is to go in by δ"
        )
    return _FRACTION * min(known)


def _softest(body: Body, power: int) -> float | None:
    """Least stiffness of the elements of a body; ``None`` for a rigid body."""
    if isinstance(body, Beam):
        return float((body.model.stiffness[:, 0, 0] / body.model.lengths ** (1 + power)).min())
    if isinstance(body, Shell):
        areas = body.model.areas().sum(axis=1)
        return float((body.model.stiffness[:, 0, 0] / areas ** (0.5 * power)).min())
    return None
