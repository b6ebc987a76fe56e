"""Keeps what an integrator computes, and shows how far it is."""

from __future__ import annotations

import sys
from types import TracebackType

import numpy as np
from tqdm import tqdm

from fem_lie import inertia
from fem_lie._jit import Array
from fem_lie.results import Result
from fem_lie.system import System


class Recorder:
    """Arrays of results, and a progress bar.

    Attributes:
        steps: Number of steps to come.
    """

    def __init__(
        self, system: System, steps: int, step: float, save_every: int, progress: bool | None
    ) -> None:
        """Allocate everything.

        Args:
            system: The equations.
            steps: Number of steps.
            step: Step size.
            save_every: Keep every so many steps, the last one in any case.
            progress: Show a bar; ``None``: if standard error is a terminal.
        """
        self.steps, self._h, self._every, self._system = steps, step, save_every, system
        rows = steps // save_every + 1 + (steps % save_every > 0)
        n, total = system.count, system.numbering.total
        self.frames, self.velocities = np.empty((rows, total, 4, 3)), np.empty((rows, total, 6))
        self.joint_forces = np.empty((rows, len(system.joints), 6))
        self.times = np.empty(rows)
        self.invariants, self.elastic = np.empty((rows, 7)), np.empty(rows)
        self.potential, self.iterations = np.empty(rows), np.zeros(rows, dtype=np.int64)
        self._work = np.empty((2, n, 4, 3))
        self._row = self._count = 0
        show = sys.stderr.isatty() if progress is None else progress
        self._bar = tqdm(total=steps, unit="step", disable=not show, mininterval=0.5)
        self._show, self._refresh = show, max(1, steps // 200)

    def __enter__(self) -> Recorder:
        """Show the bar."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        value: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Leave the bar as it is."""
        self._bar.close()

    def record(self, index: int, H: Array, v: Array, multipliers: Array, iterations: int) -> None:
        """Keep step ``index`` if it is one to be kept."""
        self._count += iterations
        if self._show and index and index % self._refresh == 0:
            self._update_bar(index)
        if index % self._every and index != self.steps:
            return
        system, row, n = self._system, self._row, self._system.count
        self.times[row] = index * self._h
        attachment = system.numbering.attachment
        self.frames[row] = attachment.frames(H)
        self.velocities[row] = attachment.twists(v)
        self.joint_forces[row] = system.joint_forces(H, multipliers)
        self.invariants[row] = inertia.invariants(
            H,
            v[:n],
            *system.inertia,
            self._work[0],
            self._work[1],
        )
        self.elastic[row] = system.elastic.energy(H)
        self.potential[row] = system.potential_energy(H)
        self.iterations[row] = self._count
        self._row += 1

    def _update_bar(self, index: int) -> None:
        total = self.invariants[: self._row, 0] + self.elastic[: self._row]
        total = total + self.potential[: self._row]
        error = abs(total[-1] - total[0]) / max(abs(total[0]), 1e-300) if self._row else 0.0
        text = f"t={index * self._h:.3g} energy {error:.1e} it/step {self._count / index:.2f}"
        self._bar.set_postfix_str(text, refresh=False)
        self._bar.update(index - self._bar.n)

    def result(self, factorisations: int, seconds: float) -> Result:
        """What was kept so far."""
        keep = slice(self._row)
        return Result(
            times=self.times[keep],
            frames=self.frames[keep],
            velocities=self.velocities[keep],
            joint_forces=self.joint_forces[keep],
            kinetic=self.invariants[keep, 0],
            elastic=self.elastic[keep],
            potential=self.potential[keep],
            momentum=self.invariants[keep, 1:4],
            angular_momentum=self.invariants[keep, 4:],
            iterations=self.iterations[keep],
            factorisations=factorisations,
            seconds=seconds,
            info=self._system.info(),
        )
