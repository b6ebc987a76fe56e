"""What impacts need of a scheme, which scenes cannot have them, and what they did in a run.

Nothing here knows a scheme. An implicit scheme gives the factors of its iteration matrix, how
velocities and accelerations follow the increment of a step, and the end of each step it has made.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._state import Stateful, attributes
from fem_lie.contact.impact.records import (
    CONTACTS,
    FRICTION,
    IMPACT,
    PENETRATION,
    REPORT_SIZE,
    RESIDUAL,
    SWEEPS,
)
from fem_lie.contact.impact.rows import show_positions
from fem_lie.contact.impact.touching import (
    GAP,
    IMPULSE,
    PAIR,
    POSITION,
    SLIP,
    STICKS,
    TIME,
    WIDTH,
    Touching,
)
from fem_lie.lie.node_types.node_type import POSITION_GRADIENT
from fem_lie.results.record import ContactSteps
from fem_lie.system.equations import Equations


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


def refuse_impacts(equations: Equations) -> None:
    """Refuse what contacts by impacts cannot be with.

    Raises:
        ValueError: Nodes are no frames, or held along fixed axes, or constraints are of velocities.
    """
    unknowns = equations.unknowns
    wanted = "Impact is for rigid bodies, beams and shells whose nodes are frames"
    if (unknowns.kinds >= POSITION_GRADIENT).any():
        raise ValueError(
            f"{wanted}, not for cables, nets, solids, thin shells and bodies in few shapes; give "
            "Penalty"
        )
    if equations.supports:
        raise ValueError(f"{wanted} and are not held along fixed axes (Shell.guide); give Penalty")
    if unknowns.of_velocities:
        raise ValueError(f"{wanted}, without joints that roll; give Penalty")


_LARGEST = CONTACTS, RESIDUAL, PENETRATION
"""Columns that are of the worst of all sub-steps of a step; all others are sums."""


class ContactHistory(Stateful):
    """What contacts did in all steps of a run.

    Attributes:
        steps: Of each step, see :data:`~fem_lie.contact.impact.records.REPORT_SIZE`, shape (S, 13).
        each: See :class:`~fem_lie.results.record.ContactSteps`, shape (k, 15).
    """

    STATE = attributes("steps", "each")

    def __init__(self) -> None:
        """Of a run without steps."""
        self.begin(0)

    def begin(self, steps: int) -> None:
        """Have memory for so many steps."""
        self.steps: Array = np.zeros((steps, REPORT_SIZE))
        self.each: Array = np.zeros((0, WIDTH + 2))

    def begin_step(self, step: int) -> None:
        """Nothing has happened yet in the step of this number, the first of which is 1."""
        self.steps[step - 1] = 0.0

    def add(self, first: int, reported: Array) -> None:
        """Add what contacts did in steps or sub-steps.

        Args:
            first: Number of the first step.
            reported: See :data:`~fem_lie.contact.impact.records.REPORT_SIZE`, shape (k, 13).
        """
        rows = self.steps[first - 1 : first - 1 + len(reported)]
        largest = [np.maximum(rows[:, k], reported[:, k]) for k in _LARGEST]
        rows += reported
        for k, column in zip(_LARGEST, largest, strict=True):
            rows[:, k] = column

    def append(self, rows: Array) -> None:
        """Keep rows of single contacts, shape (·, 15)."""
        self.each = np.concatenate([self.each, rows])

    def result(self, h: float) -> ContactSteps:
        """What results have of it.

        Args:
            h: Size of the steps.
        """
        steps = self.steps
        return ContactSteps(
            times=h * np.arange(1, len(steps) + 1, dtype=np.float64),
            contacts=steps[:, CONTACTS].copy(),
            sweeps=steps[:, SWEEPS].copy(),
            cone_residual=steps[:, RESIDUAL].copy(),
            penetration=steps[:, PENETRATION].copy(),
            impact_loss=-steps[:, IMPACT],
            friction_loss=-steps[:, FRICTION],
            each=self.each,
        )


class Last(NamedTuple):
    """What contacts did in the last step.

    Attributes:
        pairs: Which took part, shape (k,).
        axis: By which tangents were chosen.
        gaps: At the end.
        impulses: Along the normal and tangents, shape (k, 3).
        speeds: Along tangents at the end, shape (k, 2).
        sticks: Whether that is none.
    """

    pairs: Indices
    axis: Indices
    gaps: Array
    impulses: Array
    speeds: Array
    sticks: Flags

    @classmethod
    def nothing(cls) -> Last:
        """No contact took part."""
        none = np.zeros(0, dtype=np.int64)
        rows = np.zeros((0, 3)), np.zeros((0, 2))
        return cls(none, none, np.zeros(0), *rows, np.zeros(0, dtype=np.bool_))

    def shown(self, near: Touching, H: Array, time: float) -> Array:
        """What results have of them, as :meth:`.Touching.named`.

        Args:
            near: Of the run.
            H: Frames of all rows.
            time: End of the step.
        """
        pairs, axis, gaps, impulses, speeds, sticks = self
        at = np.empty((len(pairs), 4, 3))
        show_positions(H, near.touch, pairs, axis, at)
        rows = np.empty((len(pairs), WIDTH))
        rows[:, TIME], rows[:, PAIR], rows[:, GAP], rows[:, STICKS] = time, pairs, gaps, sticks
        rows[:, POSITION:IMPULSE] = at[:, 0]
        rows[:, IMPULSE:SLIP] = np.einsum("km,kmx->kx", impulses, at[:, 1:])
        rows[:, SLIP:STICKS] = np.einsum("km,kmx->kx", speeds, at[:, 2:])
        return near.named(rows[impulses[:, 0] > 0.0])
