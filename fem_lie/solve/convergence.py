"""When an iteration of a step has converged, and what to say where it does not."""

from __future__ import annotations

from enum import IntEnum
from typing import Protocol

import numpy as np

from fem_lie._arrays import Array, Flags
from fem_lie._jit import inlined


class Dimensions(Protocol):
    """What of the unknowns of equations says in which unit they are."""

    @property
    def lengths(self) -> Flags:
        """Which halves of the unknowns of the moving nodes are lengths, (n, 2)."""

    @property
    def angular(self) -> Flags:
        """Which constraints are of rotations alone, shape (m,)."""

    @property
    def length(self) -> float:
        """Of the model."""


class Verdict(IntEnum):
    """What a correction says of an iteration.

    ``STAGNANT``: It is small and no smaller than those before: round-off. ``SINGULAR`` and
    ``REFUSED``: there was no correction, or what was found is no solution.
    """

    GOES_ON = 0
    CONVERGED = 1
    STAGNANT = 2
    DIVERGED = 3
    SINGULAR = 4
    REFUSED = 5


GOES_ON, CONVERGED, STAGNANT, DIVERGES = (int(verdict) for verdict in list(Verdict)[:4])
"""Verdicts in compiled code."""

ROTATION = 0.1
"""A rotation counts in the size of an increment as a displacement of this part of the model."""

ROUND_OFF = 1e-15
"""Increments below are round-off, whatever their ratio."""

DIVERGED = 1.0
"""Increments above, in lengths of the model, do not lead to the motion that follows from the start
of the step: a rotation counts as much by one and a half turns."""

FALLS = 0.5
"""Ratio of increments above which small ones are said not to fall."""

UNMEASURED = 0.8
"""Power of the ratio of increments from a step that has none: trust it less and less."""


FAR = 1e3
"""A violation is one of the iteration below this times its last increment and its tolerance."""

CLOSED = 1e-9
"""Of the model, or rad: gaps that loops are given with are no contradiction."""


def node_scaling(unknowns: Dimensions) -> Array:
    """Weights of both halves of the increment of each node in its size, (n, 2).

    Displacements count over the length of the model, what has no dimension, rotations and position
    gradients, by :data:`ROTATION`.
    """
    return np.where(unknowns.lengths, 1.0 / unknowns.length, ROTATION)


def constraint_scaling(unknowns: Dimensions) -> Array:
    """Weights of the values of constraints, likewise, (m,)."""
    return np.where(unknowns.angular, ROTATION, 1.0 / unknowns.length)


def unknown_scaling(unknowns: Dimensions) -> Array:
    """Weights of all unknowns, (6 n + m,)."""
    return np.append(np.repeat(node_scaling(unknowns), 3), constraint_scaling(unknowns))


def failure(
    index: int,
    steps: int,
    step: float,
    limit: int,
    increment: float,
    residual: float,
    tolerance: float,
    rescued: bool,
    *others: str,
) -> str:
    """What to say of a step that failed.

    Args:
        index: Of the step, of so many ``steps``.
        steps: See there.
        step: Its size.
        limit: Iterations.
        increment: The last one.
        residual: That is left.
        tolerance: That was wanted.
        rescued: Whether it failed in spite of full iteration.
        others: What of the scheme's own might help.
    """
    looser = "a larger tolerance" if tolerance > 0.0 else "a tolerance such as 1e-10 for round-off"
    remedies = ["Try a smaller step", *others, looser]
    if not rescued:
        remedies.append("a policy that may make new matrices (Automatic())")
    return (
        f"step {index} of {steps} (time {index * step:g}) did not converge in {limit} iterations: "
        f"last increment {increment:.2e}, residual {residual:.2e}, tolerance {tolerance:g}. "
        f"{', or '.join(remedies)}"
    )


@inlined
def contraction(increment: float, previous: float, ratio: float) -> float:
    """Ratio of an increment to the previous one, with ``ratio`` that of the iterations before."""
    # one lucky ratio must not end the next steps too early: forget slowly
    return max(increment / previous, 0.7 * ratio)


@inlined
def to_come(increment: float, ratio: float) -> float:
    """Sum of all increments that would follow in a linearly converging iteration."""
    return increment * ratio / (1.0 - ratio) if ratio < 1.0 else np.inf


@inlined
def estimate(increment: float, previous: float, ratio: float) -> tuple[float, float]:
    """Ratio of successive increments, and the sum of all that would follow.

    ``previous`` is inf in the first iteration, and ``ratio`` that of the iterations before.
    """
    if previous < np.inf:
        ratio = contraction(increment, previous, ratio)
    return ratio, to_come(increment, ratio)


@inlined
def judged(
    increment: float, previous: float, remaining: float, allowed: float, noise: float
) -> int:
    """Verdict on an increment of an iteration that converges linearly.

    Args:
        increment: Its size.
        previous: That of the one before; inf in the first iteration.
        remaining: What would follow, see :func:`estimate`.
        allowed: How large that may be.
        noise: Increments below that do not fall are round-off.
    """
    if increment <= noise and increment > FALLS * previous:
        return STAGNANT
    if remaining <= allowed or increment <= ROUND_OFF:
        return CONVERGED
    return GOES_ON if increment < DIVERGED else DIVERGES


def explained(allowed: float) -> float:
    """Violation of constraints that an iteration explains, over the model, or rad.

    Args:
        allowed: The larger of the last increment and the tolerance.
    """
    return max(FAR * allowed, CLOSED)


@inlined
def size_of(d: Array, scaling: Array) -> float:
    """Size of the increment (6,) of a node, whichever half is larger, whatever its axes; nan stays.

    ``scaling`` (2,) is its row of :func:`node_scaling`.
    """
    first = scaling[0] * np.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
    second = scaling[1] * np.sqrt(d[3] * d[3] + d[4] * d[4] + d[5] * d[5])
    return second if second > first or second != second else first
