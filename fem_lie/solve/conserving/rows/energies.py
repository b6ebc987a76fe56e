"""Energies of cells over a step, and what their forces lack to do the work of it; compiled."""

from __future__ import annotations

from typing import NamedTuple

from fem_lie._arrays import Array
from fem_lie._jit import inlined_uncounted
from fem_lie.solve.conserving.between.discrete_gradient import KNOWN, ROUND_OFF, beyond, factor_of


class Energies(NamedTuple):
    """Of all cells, each of shape (M,).

    Attributes:
        start: Stored at the start of the step.
        account: Work done on them up to there.
        end: Stored at the end, overwritten.
        work: Done in the step, overwritten.
    """

    start: Array
    account: Array
    end: Array
    work: Array


@inlined_uncounted
def factor_beside(
    energies: Energies,
    e: int,
    factors: tuple[float, float, float],
    known: tuple[float, float, float, float, float],
) -> float:
    """Factor of ``M s`` by which a cell's work is the change of its energy; notes the work.

    Args:
        energies: Of all cells, with that at the end of this one.
        e: The cell.
        factors: As of :func:`add_elastic`.
        known: Work of the mean forces, ``|s|²``, what round-off of forces goes by, the cell's size
            squared, and the error of its energy where that is a difference of larger numbers.
    """
    (_, typical, unknown), (made, square, noise, ρ2, cancels) = factors, known
    noise = ROUND_OFF * noise + unknown + cancels
    debt = energies.start[e] - energies.account[e]
    missing = beyond(energies.end[e] - energies.start[e] - made, KNOWN * noise)
    missing += debt if abs(debt) > noise else 0.0
    factor = factor_of(missing, KNOWN * noise, square, max(0.01 * typical, ROUND_OFF * ρ2))
    energies.work[e] = made + factor * square
    return factor
