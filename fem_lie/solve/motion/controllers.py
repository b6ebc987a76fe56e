"""Controllers in a run: samples, outputs, memories."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array, numbers
from fem_lie._state import Stateful, attributes
from fem_lie.events.controller import Controller
from fem_lie.solve.motion.events import EventError, RunningState
from fem_lie.system.equations import Equations

_SAME = 1e-6
"""Difference of times, over the period, below which a sample is due."""


def sample_times(controllers: Sequence[Controller], duration: float) -> list[float]:
    """Times after the start and before the end at which any controller has a sample."""
    times: list[float] = []
    for each in controllers:
        count = int(np.ceil(duration / each.period * (1.0 - 1e-12)))
        times += [k * each.period for k in range(1, count)]
    return times


class Controllers(Stateful):
    """All controllers of one run.

    Attributes:
        samples: Number of samples that each has taken, shape (c,).
        memories: Memory of each.
    """

    STATE = attributes("samples", "memories")

    def __init__(self, equations: Equations) -> None:
        """Start before the first sample.

        Args:
            equations: Equations of the scene.
        """
        self._equations, self._items = equations, tuple(equations.scene.controllers)
        self.samples = np.zeros(len(self._items), dtype=np.int64)
        self.memories = [each.start for each in self._items]

    def sample(self, state: RunningState) -> None:
        """Take the samples that are due, and set the factors of actuators.

        Args:
            state: The state.

        Raises:
            EventError: An update failed, or returned something else than expected.
        """
        for k, each in enumerate(self._items):
            if state.time < (self.samples[k] - _SAME) * each.period:
                continue
            self.samples[k] += 1
            try:
                factors, memory = self._updated(each, state, self.memories[k])
            except Exception as error:
                raise EventError(
                    f"the update of {each.label} failed at time {state.time:.9g}: "
                    f"{type(error).__name__}: {error}"
                ) from error
            self.memories[k][:] = memory
            for item, factor in zip(each.actuators, factors, strict=True):
                self._equations.history_variables.scale(item, float(factor))

    @staticmethod
    def _updated(each: Controller, state: RunningState, memory: Array) -> tuple[Array, Array]:
        given = each.update(state, memory.copy())
        if not isinstance(given, tuple) or len(given) != 2:
            raise TypeError(f"expected factors of the actuators and the memory, got {given!r}")
        found = [np.atleast_1d(numbers(part, "value")).ravel() for part in given]
        expected = len(each.actuators), len(memory)
        for values, count, what in zip(found, expected, ("factors", "memory"), strict=True):
            if len(values) != count or not np.isfinite(values).all():
                raise ValueError(f"expected {count} finite numbers as {what}, got {values}")
        return found[0], found[1]
