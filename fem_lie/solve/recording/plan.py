"""What a run is to do and to keep: end time, steps, states and quantities."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import MOST, Array, Indices, instance, whole
from fem_lie.results.record import BOOKED, Record
from fem_lie.solve.step_control import StepChoice, described, step_choice

NEAR = 1e-9
"""Part of a step within which two times are the same."""


@dataclass(frozen=True, eq=False)
class Saving:
    """What is kept.

    Attributes:
        every: States after every so many steps, and the last one.
        times: Times between steps at which it is kept instead, increasing, or ``None``.
        record: What of each state.
        also: What is filled in besides, and not kept.
    """

    every: int = 1
    times: Array | None = None
    record: Record = Record.ALL
    also: Record = Record.FRAMES

    @property
    def filled(self) -> Record:
        """What is filled in: states between others follow from velocities, too."""
        between = Record.FRAMES if self.times is None else Record.VELOCITIES
        return self.record | self.also | between

    @property
    def booked(self) -> bool:
        """Whether anybody asks for what has acted from outside."""
        return bool(self.record & BOOKED)

    @classmethod
    def chosen(
        cls,
        save_every: int,
        save_at: float | npt.ArrayLike | None,
        duration: float,
        record: Record,
    ) -> Saving:
        """From the arguments of a run.

        Args:
            save_every: States after every so many steps.
            save_at: An interval, or times, instead.
            duration: Of the run.
            record: What of each state.

        Raises:
            ValueError: They are bad, or both are given.
            TypeError: ``record`` is none, or ``save_every`` no whole number.
        """
        instance(record, Record, "record", "a Record such as Record.VELOCITIES | Record.ENERGIES")
        whole(save_every, "save_every")
        if save_at is None:
            return cls(int(save_every), record=record)
        if save_every != 1:
            raise ValueError(
                f"give save_every or save_at, got save_every={save_every} and save_at={save_at}"
            )
        given: Array = np.asarray(save_at, dtype=np.float64)
        times = _multiples(float(given), duration) if given.ndim == 0 else given
        slack = NEAR * duration
        if (
            times.ndim != 1
            or not len(times)
            or not (times[0] >= -slack and times[-1] <= duration + slack)
            or not (np.diff(times) > 0.0).all()
        ):
            raise ValueError(
                f"save_at must be an interval, or increasing times within [0, {duration:g}], "
                f"got {save_at}"
            )
        return cls(1, np.clip(times, 0.0, duration), record)

    def steps(self, step: float, count: int) -> Indices | None:
        """Those of ``count`` constant steps on whose ends the times lie or between which they do.

        ``None``: there are no times.
        """
        if self.times is None:
            return None
        at = self.times / step
        both = np.concatenate([np.floor(at + NEAR), np.ceil(at - NEAR)])
        return np.unique(np.clip(both, 0, count).astype(np.int64))


def _multiples(interval: float, duration: float) -> Array:
    """Of an interval up to the end, and the end."""
    if not (np.isfinite(interval) and 0.0 < interval <= (1.0 + NEAR) * duration):
        raise ValueError(
            f"save_at must be an interval within (0, {duration:g}] or times, got {interval}"
        )
    if duration / interval > MOST:
        raise ValueError(
            f"save_at must give at most {MOST} times, got {duration / interval:g} of them: "
            f"{duration:g} by steps of {interval:g}"
        )
    times = interval * np.arange(int(duration / interval + NEAR) + 1)
    ends = abs(times[-1] - duration) <= NEAR * interval
    return np.append(times[:-1] if ends else times, duration)


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
