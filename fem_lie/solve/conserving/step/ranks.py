"""Numbers and forces of all ranks in a step, if the scene is divided among several.

Each rank has a part of the scene, with copies of the nodes that other parts have, too. Forces on
them and sums over cells are partial: compiled steps call back to Python, which adds them up, see
:mod:`fem_lie.solve.conserving.divided`. All ranks decide by the same numbers, so that they do the
same. On one rank there are no callbacks, and the numbers are those of the scene.
"""

from __future__ import annotations

from typing import NamedTuple

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined
from fem_lie._jit.call_back import call_back
from fem_lie.solve.conserving.step.records import (
    LARGEST,
    SOLVE,
    TOTAL,
    Model,
    Step,
)


class Ranks(NamedTuple):
    """What compiled functions need of other ranks.

    Attributes:
        addresses: Addresses of callbacks, see :data:`~.records.FORCES`.
        common: Numbers that they exchange, (c,).
        owned: Whether a node counts as one of this rank, 0 or 1, (n,).
    """

    addresses: Indices
    common: Array
    owned: Indices


@inlined
def ranks_of(model: Model, this: Step) -> Ranks:
    """Ranks of a step."""
    return Ranks(model.addresses, this.common, model.owned)


@inlined
def largest(ranks: Ranks, value: float) -> float:
    """Largest value of all ranks; nan if one is."""
    if ranks.addresses[LARGEST] == 0:
        return value
    ranks.common[0] = value
    call_back(ranks.addresses[LARGEST])
    return ranks.common[0]


@inlined
def add_up(ranks: Ranks, values: Array) -> None:
    """Sums over all ranks of a few numbers, in place."""
    if ranks.addresses[TOTAL] == 0:
        return
    for k in range(ranks.common.shape[0]):
        ranks.common[k] = values[k] if k < values.shape[0] else 0.0
    call_back(ranks.addresses[TOTAL])
    for k in range(values.shape[0]):
        values[k] = ranks.common[k]


@inlined
def solves(ranks: Ranks) -> bool:
    """Whether all ranks solve the equations together, by :data:`~.records.SOLVE`."""
    return ranks.addresses[SOLVE] != 0
