"""What impulses need of a scheme: the end of a step, and how the end answers to forces.

Nothing here knows a scheme. An implicit scheme gives the factors of its iteration matrix, how
velocities and accelerations follow the increment of a step, and the end of each step it has made.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from fem_lie._arrays import Array


class Factors(NamedTuple):
    """Factors of an iteration matrix ``S = ∂(residual)/∂d`` with constraints.

    Attributes:
        solve: Solves with ``right_hand_side`` and leaves ``solution``.
        right_hand_side: Shape (6 n + m,).
        solution: Likewise.
        scale: Of the constraints in the matrix, shape (m,).
    """

    solve: Callable[[], None]
    right_hand_side: Array
    solution: Array
    scale: Array


class Rule(NamedTuple):
    """How the end of a step follows its increment ``d``.

    Attributes:
        h: Size of the step, s.
        mass: ∂v̇/∂d, 1/s².
        damping: ∂v/∂d, 1/s.
    """

    h: float
    mass: float
    damping: float


class StepEnd(NamedTuple):
    """State at the end of a step.

    Attributes:
        frames: Of all rows, shape (rows, 4, 3).
        twists: Of the moving nodes in their axes, shape (n, 6).
        time: s.
    """

    frames: Array
    twists: Array
    time: float


class Changed(NamedTuple):
    """What impulses make of the end of a step.

    Attributes:
        frames: Of all rows, shape (rows, 4, 3).
        twists: Of the moving nodes in their axes, shape (n, 6).
        rates: Rates of the twists by the equations of motion without impulses, at the end that was
            given and at the changed one, each of shape (n, 6).
        multipliers: By how much those of the constraints change with these, shape (m,).
    """

    frames: Array
    twists: Array
    rates: tuple[Array, Array]
    multipliers: Array
