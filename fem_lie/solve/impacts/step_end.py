"""Interface between schemes and impacts, scenes that cannot have them, and their history in a run.

An implicit scheme provides the factors of its iteration matrix, the relation of velocities and
accelerations to the increment of a step, and the end of each step.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit.records import Records
from fem_lie._state import Stateful, attributes
from fem_lie.contact.impact.records import STEP_REPORT
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
from fem_lie.lie.node_types.node_type import NodeType
from fem_lie.results.record import ContactSteps
from fem_lie.system.equations import Equations


class Factors(NamedTuple):
    """Factors of an iteration matrix ``S = ∂(residual)/∂d`` with constraints.

    Attributes:
        renew: Factorises the matrix of the current state.
        solve: Solves for ``right_hand_side`` and writes ``solution``.
        right_hand_side: Shape (6 n + m,).
        solution: Shape (6 n + m,).
        scale: Scale of the constraints in the matrix, shape (m,).
    """

    renew: Callable[[], None]
    solve: Callable[[], None]
    right_hand_side: Array
    solution: Array
    scale: Array


class Rule(NamedTuple):
    """Relation of the end of a step to its increment ``d``.

    Attributes:
        h: Step size, s.
        mass: ∂v̇/∂d, 1/s².
        damping: ∂v/∂d, 1/s.
    """

    h: float
    mass: float
    damping: float


class StepEnd(NamedTuple):
    """State at the end of a step.

    Attributes:
        frames: Frames of all nodes, ground and prescribed motions, shape (rows, 4, 3).
        twists: Twists of the moving nodes in their axes, shape (n, 6).
        time: Time, s.
    """

    frames: Array
    twists: Array
    time: float


class Changed(NamedTuple):
    """End of a step changed by impulses.

    Attributes:
        frames: Frames of all nodes, ground and prescribed motions, shape (rows, 4, 3).
        twists: Twists of the moving nodes in their axes, shape (n, 6).
        rates: Rates of the twists by the equations of motion without impulses, at the given end and
            at the changed one, each of shape (n, 6).
        multipliers: Changes of the constraint multipliers with these, shape (m,).
    """

    frames: Array
    twists: Array
    rates: tuple[Array, Array]
    multipliers: Array


def refuse_impacts(equations: Equations) -> None:
    """Raise an error for scenes that do not support contacts by impacts.

    Raises:
        ValueError: There are modal amplitudes, supports along fixed axes, or velocity constraints.
    """
    unknowns = equations.unknowns
    wanted = "Impact is for scenes"
    if (unknowns.kinds == NodeType.MODAL).any():
        raise ValueError(f"{wanted} without reduced-order bodies; give Penalty")
    if equations.supports:
        raise ValueError(f"{wanted} without supports along fixed axes (Shell.roller); give Penalty")
    if unknowns.of_velocities:
        raise ValueError(f"{wanted} without joints that roll; give Penalty")


_LARGEST = "contacts", "residual", "penetration"
"""Fields with the worst value of all sub-steps of a step; all others are sums."""


class ContactHistory(Stateful):
    """Contact statistics of all steps of a run.

    Attributes:
        steps: The numbers of :data:`~fem_lie.contact.impact.records.STEP_REPORT` of each step,
            shape (S, 12).
        each: See :class:`~fem_lie.results.record.ContactSteps`, shape (k, 15).
    """

    STATE = attributes("steps", "each")

    def __init__(self) -> None:
        """Start without steps."""
        self.begin(0)

    def begin(self, steps: int) -> None:
        """Allocate the arrays for ``steps`` steps."""
        self.steps: Array = np.zeros((steps, STEP_REPORT.layout.itemsize // 8))
        self.each: Array = np.zeros((0, WIDTH + 2))

    def begin_step(self, step: int) -> None:
        """Reset the statistics of the step with this number, counted from 1."""
        self.steps[step - 1] = 0.0

    @property
    def _reports(self) -> Records:
        """The numbers by name, shape (S,)."""
        return self.steps.view(STEP_REPORT.layout)[:, 0]

    def add(self, first: int, reported: Records) -> None:
        """Add the statistics of steps or sub-steps.

        Args:
            first: Number of the first step.
            reported: Of type :data:`~fem_lie.contact.impact.records.STEP_REPORT`, shape (k,).
        """
        rows = self._reports[first - 1 : first - 1 + len(reported)]
        for name in STEP_REPORT.layout.names or ():
            joined = np.maximum if name in _LARGEST else np.add
            rows[name] = joined(rows[name], reported[name])

    def append(self, rows: Array) -> None:
        """Append rows of single contacts, shape (·, 15)."""
        self.each = np.concatenate([self.each, rows])

    def result(self, h: float) -> ContactSteps:
        """The statistics as part of results.

        Args:
            h: Step size.
        """
        steps = self._reports
        return ContactSteps(
            times=h * np.arange(1, len(steps) + 1, dtype=np.float64),
            contacts=steps["contacts"].copy(),
            sweeps=steps["sweeps"].copy(),
            cone_residual=steps["residual"].copy(),
            penetration=steps["penetration"].copy(),
            impact_loss=-steps["impact"],
            friction_loss=-steps["friction"],
            each=self.each,
        )


class Last(NamedTuple):
    """Active contacts of the last step.

    Attributes:
        pairs: Indices of the pairs, shape (k,).
        axis: Axes that define the tangents.
        gaps: Gaps at the end.
        impulses: Impulses along the normal and tangents, shape (k, 3).
        speeds: Velocities along tangents at the end, shape (k, 2).
        sticks: Whether they are zero.
    """

    pairs: Indices
    axis: Indices
    gaps: Array
    impulses: Array
    speeds: Array
    sticks: Flags

    @classmethod
    def nothing(cls) -> Last:
        """No active contacts."""
        none = np.zeros(0, dtype=np.int64)
        rows = np.zeros((0, 3)), np.zeros((0, 2))
        return cls(none, none, np.zeros(0), *rows, np.zeros(0, dtype=np.bool_))

    def shown(self, near: Touching, H: Array, time: float) -> Array:
        """Contact data for results, as :meth:`.Touching.named`.

        Args:
            near: Contact pairs of the run.
            H: Frames of all nodes, ground and prescribed motions.
            time: Time at the end of the step.
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
