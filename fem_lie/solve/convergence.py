"""Convergence test for the iteration of a step, and the error message if it fails."""

from __future__ import annotations

from enum import IntEnum
from typing import Protocol

import numpy as np

from fem_lie._arrays import Array, Flags
from fem_lie._jit import inlined


class Dimensions(Protocol):
    """Physical dimensions of the unknowns and constraints of the equations."""

    @property
    def lengths(self) -> Flags:
        """Which halves of the unknowns of the moving nodes are lengths, (n, 2)."""

    @property
    def angular(self) -> Flags:
        """Which constraints are on rotations only, shape (m,)."""

    @property
    def length(self) -> float:
        """Characteristic length of the model."""


class Verdict(IntEnum):
    """Verdict on an iteration, from one correction.

    ``STAGNANT``: the correction is small and no longer decreases: round-off. ``SINGULAR`` and
    ``REFUSED``: the system could not be solved, or the converged iterate is no solution.
    """

    GOES_ON = 0
    CONVERGED = 1
    STAGNANT = 2
    DIVERGED = 3
    SINGULAR = 4
    REFUSED = 5


GOES_ON, CONVERGED, STAGNANT, DIVERGES = (int(verdict) for verdict in list(Verdict)[:4])
"""The verdicts as integers, for compiled code."""

ROTATION = 0.1
"""Weight of rotations in the size of an increment: one radian counts as this fraction of the length
of the model."""

ROUND_OFF = 1e-15
"""Smaller increments are round-off, whatever their ratio."""

DIVERGED = 1.0
"""Larger increments, over the length of the model, have diverged: they do not lead to the motion
that starts at the beginning of the step. A rotation reaches this value at one and a half turns."""

FALLS = 0.5
"""Small increments whose ratio is above this value do not decrease."""

UNMEASURED = 0.8
"""Exponent applied to the ratio of increments after a step that gave no new ratio: it is trusted
less with each such step."""


FAR = 1e3
"""A constraint violation is due to unfinished iteration if it is below this factor times the last
increment and the tolerance."""

CLOSED = 1e-9
"""Over the length of the model, or rad: smaller gaps of closed loops are input round-off, not a
contradiction."""


def node_scaling(unknowns: Dimensions) -> Array:
    """Norm weights of both halves of the increment of each node, (n, 2).

    Displacements are divided by the length of the model; dimensionless unknowns, rotations and
    position gradients are multiplied by :data:`ROTATION`.
    """
    return np.where(unknowns.lengths, 1.0 / unknowns.length, ROTATION)


def constraint_scaling(unknowns: Dimensions) -> Array:
    """Norm weights of the values of the constraints, (m,), as in :func:`node_scaling`."""
    return np.where(unknowns.angular, ROTATION, 1.0 / unknowns.length)


def unknown_scaling(unknowns: Dimensions) -> Array:
    """Norm weights of all unknowns, (6 n + m,).

    Args:
        unknowns: The unknowns of a scene.
    """
    return np.append(np.repeat(node_scaling(unknowns), 3), constraint_scaling(unknowns))


def failure(
    index: int,
    steps: int,
    step: float,
    limit: int,
    increment: float,
    residual: float,
    tolerance: float,
    after_fallback: bool,
    *others: str,
) -> str:
    """Error message for a step that did not converge.

    Args:
        index: Number of the step.
        steps: Number of all steps.
        step: Step size.
        limit: Largest number of iterations.
        increment: Size of the last increment.
        residual: Size of the last residual.
        tolerance: Requested tolerance.
        after_fallback: Whether the full-Newton fallback failed, too.
        others: Further remedies of the scheme.
    """
    looser = "a larger tolerance" if tolerance > 0.0 else "a tolerance such as 1e-10 for round-off"
    remedies = ["Try a smaller step", *others, looser]
    if not after_fallback:
        remedies.append("a policy that may refactorise (Automatic())")
    return (
        f"step {index} of {steps} (time {index * step:g}) did not converge in {limit} iterations: "
        f"last increment {increment:.2e}, residual {residual:.2e}, tolerance {tolerance:g}. "
        f"{', or '.join(remedies)}"
    )


@inlined
def contraction(increment: float, previous: float, ratio: float) -> float:
    """Updated contraction ratio; ``ratio`` is the estimate from the iterations before."""
    # one lucky ratio must not end the next steps too early: forget slowly
    return max(increment / previous, 0.7 * ratio)


@inlined
def to_come(increment: float, ratio: float) -> float:
    """Sum of all further increments of a linearly converging iteration."""
    return increment * ratio / (1.0 - ratio) if ratio < 1.0 else np.inf


@inlined
def estimate(increment: float, previous: float, ratio: float) -> tuple[float, float]:
    """Contraction ratio, and estimated sum of all further increments.

    ``previous`` is inf in the first iteration; ``ratio`` is the estimate from the iterations
    before.

    Args:
        increment: Size of the last increment.
        previous: Size of the increment before.
        ratio: Ratio of the increments before.
    """
    if previous < np.inf:
        ratio = contraction(increment, previous, ratio)
    return ratio, to_come(increment, ratio)


@inlined
def judged(
    increment: float, previous: float, remaining: float, allowed: float, round_off_level: float
) -> int:
    """Verdict on an increment of a linearly converging iteration.

    Args:
        increment: Size of the increment.
        previous: Size of the previous increment; inf in the first iteration.
        remaining: Estimated sum of all further increments, see :func:`estimate`.
        allowed: Largest allowed sum.
        round_off_level: Increments below this level that no longer decrease are round-off.
    """
    if increment <= round_off_level and increment > FALLS * previous:
        return STAGNANT
    if remaining <= allowed or increment <= ROUND_OFF:
        return CONVERGED
    return GOES_ON if increment < DIVERGED else DIVERGES


def explained(allowed: float) -> float:
    """Constraint violation that unfinished iteration explains, over the model length, or rad.

    Args:
        allowed: The larger of the last increment and the tolerance.
    """
    return max(FAR * allowed, CLOSED)


@inlined
def size_of(d: Array, scaling: Array) -> float:
    """Size of the increment (6,) of a node: the larger half, in any axes; nan is passed on.

    ``scaling`` (2,) is the node's row of :func:`node_scaling`.
    """
    first = scaling[0] * np.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
    second = scaling[1] * np.sqrt(d[3] * d[3] + d[4] * d[4] + d[5] * d[5])
    return second if second > first or second != second else first
