"""What a run is to do: to which time, by which steps, and what is kept of it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fem_lie._arrays import Array
from fem_lie.results.record import Record
from fem_lie.solve.recording.saving import Saving
from fem_lie.solve.step_control import StepChoice, described, step_choice

STEP_TIMES = "steps.times"
"""Ends of the steps in a checkpoint of steps whose size changes."""


@dataclass(frozen=True, eq=False)
class Plan(ABC):
    """What a run is to do.

    Attributes:
        saving: What is kept.
    """

    saving: Saving

    @abstractmethod
    def checkpoint_interval(self, given: int | None) -> int:
        """Steps between two checkpoints; 0: they are written at every hundredth of the duration."""

    @abstractmethod
    def packed(self) -> dict[str, Any]:
        """All of it, for a checkpoint."""

    @abstractmethod
    def ends(self, index: int, memory: Mapping[str, Array]) -> Array:
        """Times at the start and after each step up to ``index``, of a run with this memory."""


@dataclass(frozen=True, eq=False)
class EqualSteps(Plan):
    """Steps of one size.

    Attributes:
        steps: How many.
        step: Their size.
    """

    steps: int
    step: float

    def checkpoint_interval(self, given: int | None) -> int:
        """A hundredth of all by default."""
        return max(1, self.steps // 100) if given is None else given

    def packed(self) -> dict[str, Any]:
        """See the base class."""
        own = {"plan.steps": np.array(self.steps), "plan.step": np.array(self.step)}
        return own | _packed_saving(self.saving)

    def ends(self, index: int, memory: Mapping[str, Array]) -> Array:
        """See the base class."""
        return self.step * np.arange(index + 1, dtype=np.float64)


@dataclass(frozen=True, eq=False)
class ChosenSteps(Plan):
    """Steps whose sizes are chosen on the way.

    Attributes:
        duration: End time.
        choice: How large they are.
    """

    duration: float
    choice: StepChoice

    def checkpoint_interval(self, given: int | None) -> int:
        """By time by default: it is not known how many steps there will be."""
        return 0 if given is None else given

    def packed(self) -> dict[str, Any]:
        """See the base class."""
        own = {"plan.duration": np.array(self.duration)}
        return own | {"plan.choice": np.array(described(self.choice))} | _packed_saving(self.saving)

    def ends(self, index: int, memory: Mapping[str, Array]) -> Array:
        """See the base class."""
        return np.concatenate([[0.0], memory[STEP_TIMES]])


def unpacked(kept: Mapping[str, Any]) -> Plan:
    """The plan that is in a checkpoint.

    Raises:
        KeyError: There is none.
    """
    record = Record(int(kept["plan.record"]))
    saving = Saving(int(kept["plan.every_row"]), kept.get("plan.save_at"), record)
    if "plan.choice" in kept:
        choice = step_choice(str(kept["plan.choice"]))
        return ChosenSteps(saving, float(kept["plan.duration"]), choice)
    return EqualSteps(saving, int(kept["plan.steps"]), float(kept["plan.step"]))


def _packed_saving(saving: Saving) -> dict[str, Any]:
    own: dict[str, Any] = {
        "plan.every_row": np.array(saving.every),
        "plan.record": np.array(saving.record.value),
    }
    return own if saving.times is None else own | {"plan.save_at": saving.times}
