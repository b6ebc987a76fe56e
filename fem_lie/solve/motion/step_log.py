"""Collects the steps of a run whose steps change."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from fem_lie._arrays import Array
from fem_lie.results.steps import StepHistory
from fem_lie.solve.motion.step_error import StepError
from fem_lie.solve.step_control import Control
from fem_lie.system.equations import Equations


@dataclass
class StepLog:
    """Collects :class:`~fem_lie.results.steps.StepHistory`."""

    equations: Equations
    times: list[float] = field(default_factory=list)
    sizes: list[float] = field(default_factory=list)
    errors: list[StepError] = field(default_factory=list)
    measured: list[tuple[float, float]] = field(default_factory=list)
    rejected: list[float] = field(default_factory=list)

    def add(
        self, time: float, size: float, error: StepError, measured: tuple[float, float]
    ) -> None:
        """A step that was accepted."""
        self.times.append(time)
        self.sizes.append(size)
        self.errors.append(error)
        self.measured.append(measured)

    def memory(self) -> dict[str, Array]:
        """All of it, by name."""
        return {
            "times": np.array(self.times),
            "sizes": np.array(self.sizes),
            "errors": np.array(self.errors, dtype=np.float64).reshape(-1, 4),
            "measured": np.array(self.measured, dtype=np.float64).reshape(-1, 2),
            "rejected": np.array(self.rejected),
        }

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Be as when :meth:`memory` was called."""
        for name in ("times", "sizes", "rejected"):
            getattr(self, name)[:] = map(float, kept[name])
        self.errors[:] = (
            StepError(float(t), float(r), int(i), int(k)) for t, r, i, k in kept["errors"]
        )
        self.measured[:] = ((float(t), float(r)) for t, r in kept["measured"])

    def history(self) -> StepHistory:
        """All of them."""
        known = self.memory()
        errors, measured = known["errors"], known["measured"]
        leaders = self.equations.unknowns.leaders
        return StepHistory(
            times=known["times"],
            sizes=known["sizes"],
            translation=errors[:, 0],
            rotation=errors[:, 1],
            nodes=leaders[errors[:, 2:].astype(np.int64)],
            measured_translation=measured[:, 0],
            measured_rotation=measured[:, 1],
            rejected=known["rejected"],
        )

    def body(self, node: int) -> str:
        """Label of the body of a moving node."""
        leader = self.equations.tables.leader
        for body, nodes in self.equations.unknowns.bodies.items():
            if node in leader[nodes]:
                return body.label
        raise AssertionError("a node without a body")

    def underflow(
        self, control: Control, time: float, h: float, error: StepError | None, increment: float
    ) -> str:
        """What to say when the step becomes too small.

        Args:
            control: Of the steps.
            time: Where the run stands.
            h: Size of the last step that was tried.
            error: Its error, ``None`` if it did not converge.
            increment: Its last increment.
        """
        text = f"at time {time:.9g} a step of {h:.3g} "
        if error is None:
            return (
                f"{text}did not converge, and smaller ones than {control.smallest:.3g} are not "
                f"allowed: last increment {increment:.2e}"
            )
        moved = error.translation / control.tolerance >= error.rotation / control.rotation_tolerance
        size, tolerance, unit, node = (
            (error.translation, control.tolerance, "length", error.translation_node)
            if moved
            else (error.rotation, control.rotation_tolerance, "rad", error.rotation_node)
        )
        return (
            f"{text}has an estimated error of {size / h:.3e} {unit} per time, wanted at most "
            f"{tolerance:.3e}, and steps below {control.smallest:.3g} are not allowed; "
            f"{self.body(node)} limits it. Name the times of jumps as events, or give a larger "
            "tolerance or a smaller `smallest`"
        )
