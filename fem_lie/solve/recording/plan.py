"""Plan of a run: end time, steps, recorded states and quantities."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import MOST, Array, Indices, instance, whole
from fem_lie.results.record import WITH_BALANCE, Record
from fem_lie.solve.step_control import StepChoice, described, step_choice

NEAR = 1e-9
"""Times closer than this fraction of a step are equal."""


@dataclass(frozen=True, eq=False)
class Saving:
    """Which states and quantities are recorded.

    Attributes:
        every: Record every n-th state, and the last one.
        times: Increasing times at which states are recorded instead, or ``None``.
        record: Quantities of each recorded state.
        also: Quantities that are computed but not recorded.
    """

    every: int = 1
    times: Array | None = None
    record: Record = Record.ALL
    also: Record = Record.FRAMES

    @property
    def filled(self) -> Record:
        """Quantities that are computed: interpolation in time needs velocities, too."""
        between = Record.FRAMES if self.times is None else Record.VELOCITIES
        return self.record | self.also | between

    @property
    def with_balance(self) -> bool:
        """Whether the energy balance or the impulses are recorded."""
        return bool(self.record & WITH_BALANCE)

    @classmethod
    def chosen(
        cls,
        save_every: int,
        save_at: float | npt.ArrayLike | None,
        duration: float,
        record: Record,
    ) -> Saving:
        """Recording as requested by the arguments of a run.

        Args:
            save_every: Record every n-th state.
            save_at: An interval, or times, instead.
            duration: Duration of the run.
            record: Quantities of each recorded state.

        Raises:
            ValueError: An argument is invalid, or both are given.
            TypeError: ``record`` is not a ``Record``, or ``save_every`` not an integer.
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
        """Constant steps, of ``count``, needed for the requested times: at them, or on either side.

        ``None``: no times were requested.
        """
        if self.times is None:
            return None
        at = self.times / step
        both = np.concatenate([np.floor(at + NEAR), np.ceil(at - NEAR)])
        return np.unique(np.clip(both, 0, count).astype(np.int64))


def _multiples(interval: float, duration: float) -> Array:
    """Multiples of an interval up to the end, and the end."""
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
"""Key of the times of all steps in a checkpoint of a run with variable steps."""


@dataclass(frozen=True, eq=False)
class Plan(ABC):
    """Plan of a run.

    Attributes:
        saving: Which states and quantities are recorded.
    """

    saving: Saving

    @property
    @abstractmethod
    def last(self) -> float:
        """Time at which the run ends, since its start."""

    @abstractmethod
    def checkpoint_interval(self, given: int | None) -> int:
        """Steps between two checkpoints; 0: they are written at every hundredth of the duration."""

    @abstractmethod
    def packed(self) -> dict[str, Any]:
        """The plan as arrays, for a checkpoint."""

    @abstractmethod
    def ends(self, index: int, state: Mapping[str, Array]) -> Array:
        """Times at the start and after each step up to ``index``, of a run with this state."""


@dataclass(frozen=True, eq=False)
class EqualSteps(Plan):
    """Plan with steps of one size.

    Attributes:
        steps: Number of steps.
        step: Step size.
    """

    steps: int
    step: float

    @property
    def last(self) -> float:
        """See the base class."""
        return self.steps * self.step

    def checkpoint_interval(self, given: int | None) -> int:
        """The given interval, or a hundredth of all steps."""
        return max(1, self.steps // 100) if given is None else given

    def packed(self) -> dict[str, Any]:
        """The plan as arrays, for a checkpoint."""
        own = {"plan.steps": np.array(self.steps), "plan.step": np.array(self.step)}
        return own | _packed_saving(self.saving)

    def ends(self, index: int, state: Mapping[str, Array]) -> Array:
        """Times at the start and after each step up to ``index``."""
        return self.step * np.arange(index + 1, dtype=np.float64)


@dataclass(frozen=True, eq=False)
class ChosenSteps(Plan):
    """Plan with step sizes chosen during the run.

    Attributes:
        duration: End time.
        choice: Choice of the step sizes.
    """

    duration: float
    choice: StepChoice

    @property
    def last(self) -> float:
        """See the base class."""
        return self.duration

    def checkpoint_interval(self, given: int | None) -> int:
        """The given interval, or 0: by time, because the number of steps is unknown."""
        return 0 if given is None else given

    def packed(self) -> dict[str, Any]:
        """The plan as arrays, for a checkpoint."""
        own = {"plan.duration": np.array(self.duration)}
        return own | {"plan.choice": np.array(described(self.choice))} | _packed_saving(self.saving)

    def ends(self, index: int, state: Mapping[str, Array]) -> Array:
        """Times at the start and after each step up to ``index``."""
        return np.concatenate([[0.0], state[STEP_TIMES]])


def unpacked(kept: Mapping[str, Any]) -> Plan:
    """Plan from a checkpoint.

    Raises:
        KeyError: The checkpoint has none.
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
