"""Histories of results with constant steps, in memory or in a file, with a progress bar."""

from __future__ import annotations

import sys
from types import TracebackType
from typing import Any

import numpy as np
from tqdm import tqdm

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.parts.part_scene import ScenePart
from fem_lie.results import Result
from fem_lie.results.gathering import gathered
from fem_lie.results.record import (
    ContactSteps,
    FrictionForces,
    Record,
    StepHistory,
    with_state,
)
from fem_lie.solve.recording.checkpoints import FRICTION, Checkpoints, Restartable
from fem_lie.solve.recording.plan import EqualSteps
from fem_lie.solve.recording.result_row import ResultRow
from fem_lie.solve.recording.window import Window
from fem_lie.system.equations import Equations


class History(Window):
    """Arrays of results for constant steps, and a progress bar.

    Attributes:
        steps: Number of steps of the run.
        every: Every n-th state is recorded, and the last one, if no times were requested.
        refresh: Steps between two updates of the bar; ``steps`` if it is not shown.
        seconds: Wall time before the checkpoint from which the run was restarted.
        part: What this rank has of the scene, if it is divided: rows are those of the part.
    """

    def __init__(
        self,
        info: SceneInfo,
        plan: EqualSteps,
        progress: bool | None,
        store: Checkpoints | None = None,
        part: ScenePart | None = None,
    ) -> None:
        """Allocate all arrays.

        Args:
            info: Bodies and joints.
            plan: Steps, and recorded quantities.
            progress: Show a bar; ``None``: if standard error is a terminal.
            store: File of results and checkpoints; ``None``: keep results in memory.
            part: What this rank has of the scene; ``None``: all.
        """
        self.part = part
        saving, steps, step = plan.saving, plan.steps, plan.step
        every = saving.every
        super().__init__(info, steps // every + 1 + (steps % every > 0), saving, store)
        self.steps, self.every, self._h, self._info = steps, every, step, info
        self._chosen = saving.steps(step, steps)
        self.seconds = 0.0 if store is None else store.seconds
        show = sys.stderr.isatty() if progress is None else progress
        self._bar = tqdm(total=steps, unit="step", disable=not show, mininterval=0.5)
        self.show, self.refresh = show, max(1, steps // 200) if show else steps

    def __enter__(self) -> History:
        """Show the bar."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        value: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Close the bar and leave it visible."""
        self._bar.close()
        self.close(kind is not None)

    def wants(self, index: int) -> bool:
        """Whether the state after step ``index`` is to be recorded; if so, a row is reserved.

        Args:
            index: Number of the step.
        """
        if self._chosen is None:
            wanted = index % self.every == 0 or index == self.steps
        else:
            at = int(np.searchsorted(self._chosen, index))
            wanted = at < len(self._chosen) and int(self._chosen[at]) == index
        if wanted:
            self.ensure_rows()
        return wanted

    def keep(self, indices: Indices, iterations: Indices) -> None:
        """Count the steps ``indices``, whose values are in the next rows, as recorded.

        Args:
            indices: Numbers of the steps.
            iterations: Number of iterations of the step.
        """
        rows = slice(self.row, self.row + len(indices))
        self.times[rows], self.iterations[rows] = indices * self._h, iterations
        self.row += len(indices)

    def update_bar(self, index: int, iterations: int) -> None:
        """Show that step ``index`` is reached after ``iterations`` iterations in total.

        Args:
            index: Number of the step.
            iterations: Number of iterations of the step.
        """
        known = Record.ENERGIES in self.filled and self.part is None
        energy = f"energy {self.gap:.1e} " if known else ""
        text = f"t={index * self._h:.3g} {energy}it/step {iterations / index:.2f}"
        self._bar.set_postfix_str(text, refresh=False)
        self._bar.update(index - self._bar.n)

    def update_if_due(self, index: int, iterations: int) -> None:
        """Show step ``index`` if the bar is shown and due for an update.

        Args:
            index: Number of the step.
            iterations: Number of iterations of the step.
        """
        if self.show and index - self._bar.n >= self.refresh:
            self.update_bar(index, iterations)

    def next_stop(self, index: int) -> int:
        """The next step after ``index`` at which a row, a checkpoint or the bar is due.

        Args:
            index: Number of the step.
        """
        stop = self.next_halt(index, self.steps)
        return int(min([stop, *self._wanted_until(stop, index)[:1]]))

    def steps_in_loop(self, index: int, most: int) -> tuple[int, Indices]:
        """Steps after ``index`` that the compiled loop can make, filling in rows by itself.

        Args:
            index: Number of steps made.
            most: Largest number of steps.

        Returns:
            The last of these steps, and those whose rows are to be filled in, for which space is
            reserved.
        """
        last = self.next_halt(index, most)
        wanted = self._wanted_until(last, index)
        if len(wanted):
            self.ensure_rows()
            free = len(self.times) - self.row
            if free < len(wanted):
                wanted = wanted[:free]
                last = int(wanted[-1])
        return last, wanted

    def next_halt(self, index: int, most: int) -> int:
        """The next step, at most ``most`` later, at which more is due than a row.

        Args:
            index: Number of the step.
            most: Largest number of steps.
        """
        halts = [self.steps, index + most]
        if self.show:
            halts.append((index // self.refresh + 1) * self.refresh)
        if self._store is not None:
            halts.append((index // self._store.every + 1) * self._store.every)
        return min(halts)

    def _wanted_until(self, last: int, index: int) -> Indices:
        """Steps after ``index``, up to ``last``, whose rows are to be filled in."""
        if self._chosen is not None:
            first, end = np.searchsorted(self._chosen, [index, last], side="right")
            return self._chosen[first:end]
        every = self.every
        wanted = np.arange((index // every + 1) * every, last + 1, every, dtype=np.int64)
        ends = last == self.steps and last % every > 0
        return np.append(wanted, last) if ends else wanted

    def checkpoint_due(self, index: int) -> bool:
        """Whether the state after step ``index`` is to be written.

        Args:
            index: Number of the step.
        """
        return self._store is not None and index % self._store.every == 0

    def save(self, index: int, run: Restartable) -> None:
        """Write a checkpoint of a run.

        Args:
            index: Number of steps made.
            run: The run.
        """
        assert self._store is not None
        self.write_checkpoint(index, self._store.state_of(run))

    def write_checkpoint(self, index: int, state: dict[str, Array]) -> None:
        """Write the state on which the next steps depend."""
        assert self._store is not None
        kept = state | self._saved_state()
        self._store.write(index, self._gone, self.seconds, kept)

    def add(self, record: StepHistory | ContactSteps | FrictionForces) -> None:
        """Write the log of the steps, if results go to a file.

        Args:
            record: Record of a step.
        """
        if self._store is not None:
            self._store.add(record)

    @property
    def friction(self) -> FrictionForces | None:
        """Friction forces of the states recorded so far; default: none are recorded."""
        return None

    def result(
        self, factorisations: int, seconds: float, refreshes: int = 0, divided: int = 0
    ) -> Result:
        """Result of the states recorded so far, of all parts of a divided scene.

        Args:
            factorisations: Number of factorisations of the whole matrix.
            seconds: Wall time.
            refreshes: Number of updates of the constraint Jacobian only.
            divided: Number of divided steps.
        """
        arrays: dict[str, Any] = dict(self.collected())
        end = float(arrays["times"][-1]) if len(arrays["times"]) else np.nan
        if self._store is not None:
            numbers = {"factorisations": factorisations + refreshes, "seconds": seconds}
            numbers |= {"k_updates": factorisations, "phi_updates": factorisations + refreshes}
            numbers["divided"] = divided
            self._store.finish(numbers)
        friction = self.friction
        if self._store is not None:
            friction = self._store.friction(friction)
        if friction is not None:
            self.add(friction)
        found = Result(
            **arrays,
            friction=friction,
            gradient_velocities=self.end_gradient_velocities(end) if self.part is None else None,
            factorisations=factorisations + refreshes,
            k_updates=factorisations,
            phi_updates=factorisations + refreshes,
            divided=divided,
            seconds=seconds,
            info=self._info if self._store is None else self._store.info,
        )
        # a file has the results of all parts
        return gathered(found, self.part if self._store is None else None)


class Recorder(History):
    """History that takes its rows from the equations of a scene.

    Attributes:
        count: Number of iterations so far.
        scene: Packed arrays for :func:`~fem_lie.solve.recording.result_row.fill_whole`.
        whole: Whether that function fills in all quantities except energy outside of cells.
    """

    def __init__(
        self,
        equations: Equations,
        plan: EqualSteps,
        progress: bool | None,
        store: Checkpoints | None = None,
    ) -> None:
        """Take the bodies and joints of the results from equations.

        Args:
            equations: The equations of a scene.
            plan: Plan of the run.
            progress: Whether a progress bar is shown; default: on terminals.
            store: File of results and checkpoints, or ``None``.
        """
        super().__init__(equations.info, plan, progress, store, equations.part)
        self._equations, self._filled = equations, ResultRow(equations)
        self._held = Record.FORCES in self.filled and len(equations.unknowns.supported) > 0
        self.count = 0 if store is None or not store.state else int(store.state["count"])
        self.scene = self._filled.scene
        self.whole = not self._held and equations.arrays.complete
        known = {} if store is None else store.state
        self._friction = [known[FRICTION]] if FRICTION in known else []

    def record(
        self,
        index: int,
        H: Array,
        v: Array,
        a: Array,
        multipliers: Array,
        balance: Array,
    ) -> bool:
        """Record the state after step ``index`` if it is due.

        ``balance``: energy balance and impulses.

        Args:
            index: Number of the step.
            H: Frames of all nodes, shape (n, 4, 3).
            v: Twists of all nodes, shape (n, 6).
            a: Rates of the twists, shape (n, 6).
            multipliers: Lagrange multipliers of all constraints.
            balance: Energy balance and impulses.

        Returns:
            Whether it was due.
        """
        self.show_progress(index)
        wanted = self.wants(index)
        if wanted:
            self.fill(index * self._h, H, v, a, multipliers, balance)
        return wanted

    @property
    def friction(self) -> FrictionForces | None:
        """Friction forces of the states recorded so far, in the part of this rank."""
        return FrictionForces(np.concatenate(self._friction)) if self._friction else None

    def show_progress(self, index: int) -> None:
        """Show that step ``index`` is reached, if an update is due.

        Args:
            index: Number of the step.
        """
        if self.show and index and index % self.refresh == 0:
            self.update_bar(index, self.count)

    def fill(
        self, time: float, H: Array, v: Array, a: Array, multipliers: Array, balance: Array
    ) -> None:
        """Fill in the next row, for which space is reserved.

        Args:
            time: Time.
            H: Frames of all nodes, shape (n, 4, 3).
            v: Twists of all nodes, shape (n, 6).
            a: Rates of the twists, shape (n, 6).
            multipliers: Lagrange multipliers of all constraints.
            balance: Energy balance and impulses.
        """
        equations, row = self._equations, self.row
        self._filled.by_twists(self, H, v, multipliers, balance)
        report = equations.report(H, v, a, multipliers)
        if self._held:
            self.reactions[row] = report.reactions
        if Record.ENERGIES in self.filled:
            self.elastic[row] += report.elastic
        # rows of states between steps would be interpolated
        if Record.FORCES in self.filled and self._wanted is None:
            friction = equations.history_variables.friction_forces(H, v)
            if friction is not None:
                self._friction.append(with_state(self._gone + row, friction))
        self.times[row], self.iterations[row] = time, self.count
        self.row += 1

    def write_checkpoint(self, index: int, state: dict[str, Array]) -> None:
        """Write the state on which the next steps depend, and the number of iterations.

        Args:
            index: Number of the step.
            state: State of the run.
        """
        kept = state | {"count": np.array(self.count)}
        if self._friction:
            kept[FRICTION] = np.concatenate(self._friction)
        super().write_checkpoint(index, kept)
