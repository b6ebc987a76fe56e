"""Says of equilibrium that was found that it is not what a structure under growing loads does."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from fem_lie.results.equilibrium import StaticResult


class UnstableEquilibriumWarning(UserWarning):
    """An equilibrium is unstable, or was reached past a limit load: the structure snaps before."""


def warn_if_unstable(result: StaticResult) -> None:
    """One warning for all states of a result.

    In a frame that turns, where an equilibrium with negative pivots may be stable all the same, and
    of states that could not be tested, nothing is said.
    """
    if result.steady_rotation:
        return
    unstable = result.negative_pivots > 0
    told = []
    if unstable.any():
        factors = ", ".join(f"{factor:g}" for factor in result.factors[unstable][:4])
        more = ", …" if unstable.sum() > 4 else ""
        told.append(
            f"the equilibrium is unstable at load factor {factors}{more} (negative pivots "
            f"{', '.join(map(str, result.negative_pivots[unstable][:4]))}{more})"
        )
    if result.turned_back:
        factors = ", ".join(f"{factor:.3g}" for factor in result.turned_back)
        told.append(f"the load had a maximum near {factors} on the way, where the structure snaps")
    if told:
        text = "; ".join(told)
        warnings.warn(
            f"{text}. fl.follow_path shows the whole path and its critical points",
            UnstableEquilibriumWarning,
            stacklevel=3,
        )


def maxima(factors: list[float]) -> tuple[float, ...]:
    """Load factors from which those of successive states go down."""
    rise = np.diff([0.0, *factors]) > 0
    return tuple(factors[k] for k in np.flatnonzero(rise[:-1] & ~rise[1:]))
