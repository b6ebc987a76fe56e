"""What contacts by impacts did in all steps of a run."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._state import Stateful, attributes
from fem_lie.contact.impact.observed import WIDTH
from fem_lie.contact.impact.records import (
    CONTACTS,
    FRICTION,
    IMPACT,
    PENETRATION,
    RESIDUAL,
    SWEEPS,
    TOLD,
)
from fem_lie.results.steps import ContactSteps

_LARGEST = [CONTACTS, RESIDUAL, PENETRATION]
"""Columns that are of the worst of all sub-steps of a step; all others are sums."""


class ContactHistory(Stateful):
    """What contacts did in all steps of a run.

    Attributes:
        steps: Of each step, see :data:`~fem_lie.contact.impact.records.TOLD`, shape (S, 13).
        each: See :class:`~fem_lie.results.steps.ContactSteps`, shape (k, 15).
    """

    STATE = attributes("steps", "each")

    def __init__(self) -> None:
        """Of a run without steps."""
        self.begin(0)

    def begin(self, steps: int) -> None:
        """Have memory for so many steps."""
        self.steps: Array = np.zeros((steps, TOLD))
        self.each: Array = np.zeros((0, WIDTH + 2))

    def begin_step(self, step: int) -> None:
        """Nothing has happened yet in the step of this number, the first of which is 1."""
        self.steps[step - 1] = 0.0

    def add(self, first: int, reported: Array) -> None:
        """Add what contacts did in steps or sub-steps.

        Args:
            first: Number of the first step.
            reported: See :data:`~fem_lie.contact.impact.records.TOLD`, shape (k, 13).
        """
        rows = self.steps[first - 1 : first - 1 + len(reported)]
        largest = np.maximum(rows[:, _LARGEST], reported[:, _LARGEST])
        rows += reported
        rows[:, _LARGEST] = largest

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
