"""Default stiffness of a penalty, from the stiffness of the bodies in contact."""

from __future__ import annotations

from collections.abc import Iterable
from functools import singledispatch

import numpy as np

from fem_lie._arrays import Array
from fem_lie.bodies.beams.line_body import LineBody
from fem_lie.bodies.body import Body
from fem_lie.bodies.shells.shell import Shell
from fem_lie.bodies.thin_shells.smooth_surface import SmoothSurface

_FRACTION = 0.2
"""Penalty stiffness of a beam over EA/ℓ. Impacts of bars are least oscillatory with this value
(benchmarks/elastic_bar)."""


def chosen_stiffness(bodies: Iterable[Body], power: int, what: str) -> float:
    """Penalty stiffness by the softest element of the bodies.

    For a beam or a cable it is a fifth of EA/ℓ. A shell is touched across its thickness, and is
    soft against that load: its stiffness is E ℓ, with the membrane stiffness E t and the size ℓ of
    an element.
    A force that strains it by ε in bending is about 0.4 ε E t², so that it overlaps by a part
    0.8 ε t/ℓ of half the thickness. Where contact forces are per length both are divided by ℓ, and
    where they are per area by ℓ².

    Args:
        bodies: Bodies that both surfaces belong to.
        power: Exponent of length in the unit of contact forces: 0 for points, 1 along lines, 2 over
            areas.
        what: Label of the contact for the message.

    Raises:
        ValueError: There is neither a body along a line nor a shell among the bodies.
    """
    known = [k for body in bodies if (k := _softest(body, power)) is not None]
    if not known:
        raise ValueError(
            f"{what}: Penalty needs a stiffness, for neither surface belongs to a line or a shell; "
            "give m v²/δ², for a mass m that comes with a speed v and is to go in by δ"
        )
    return min(known)


@singledispatch
def _softest(body: Body, power: int) -> float | None:
    """Least stiffness of the elements of a body; ``None`` for other bodies."""
    return None


@_softest.register
def _(body: LineBody, power: int) -> float:
    of = body.model
    return float(_FRACTION * (of.stiffness[:, 0, 0] / of.lengths ** (1 + power)).min())


@_softest.register
def _(body: Shell, power: int) -> float:
    of = body.model
    return _of_sheet(of.stiffness, of.thickness, of.areas().sum(axis=1), power)


@_softest.register
def _(body: SmoothSurface, power: int) -> float:
    of = body.model
    return _of_sheet(of.stiffness, of.thickness, of.sizes[:, :2].prod(axis=1), power)


def _of_sheet(stiffness: Array, thickness: Array, areas: Array, power: int) -> float:
    return float((stiffness[:, 0, 0] / thickness * np.sqrt(areas) ** (1 - power)).min())
