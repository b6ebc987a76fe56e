"""The stiffness of a penalty for which none was given: that of what is behind it."""

from __future__ import annotations

from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.body import Body
from fem_lie.bodies.shells.shell import Shell
from fem_lie.contact.sides.surfaces import Surface
from fem_lie.contact.skins import Skin

_PART = 0.2
"""Of an element's own stiffness: impacts of bars are least noisy by it (benchmarks/elastic_bar)."""


def chosen_stiffness(a: Surface, b: Surface, what: str) -> float:
    """A fifth of the stiffness of the softest element behind two surfaces.

    That is EA/ℓ of beams and the membrane stiffness of shells; over ℓ where forces are per length,
    and over ℓ² where they are per area.

    Args:
        a: One of them.
        b: The other.
        what: For the message.

    Raises:
        ValueError: There are neither beams nor shells behind them.
    """
    power = _power(a, b)
    bodies = dict.fromkeys(p.body for p in (*a.points, *b.points) if p.body is not None)
    known = [k for body in bodies if (k := _softest(body, power)) is not None]
    if not known:
        raise ValueError(
            f"{what}: Penalty needs a stiffness, for there is neither beam nor shell behind it; "
            "give m v²/δ², for a mass m that comes with a speed v and is to go in by δ"
        )
    return _PART * min(known)


def _power(a: Surface, b: Surface) -> int:
    """Of which power of a length forces are."""
    if a.pieces() or b.pieces():
        return 1
    skins = [isinstance(each, Skin) for each in (a, b)]
    balls = any(each.balls() for each in (a, b))
    return 2 if any(skins) and not balls else 0


def _softest(body: Body, power: int) -> float | None:
    """Of the elements of a body; of what is rigid none."""
    if isinstance(body, Beam):
        return float((body.stiffness[:, 0, 0] / body.lengths ** (1 + power)).min())
    if isinstance(body, Shell):
        areas = body.areas().sum(axis=1)
        return float((body.stiffness[:, 0, 0] / areas ** (0.5 * power)).min())
    return None
