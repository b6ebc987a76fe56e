"""Keeps what an integrator computes, in memory or in a file, and shows how far it is."""

from __future__ import annotations

import sys
from types import TracebackType
from typing import Any

import numpy as np
from tqdm import tqdm

from fem_lie import balances
from fem_lie._jit import Array, Indices
from fem_lie.info import SceneInfo
from fem_lie.results import Result
from fem_lie.solve.checkpoints import Checkpoints
from fem_lie.system import System


class History:
    """Arrays of results, and a progress bar.

    With a file the arrays are its pages: they cost no memory, and what was written is there when
    the process is killed.

    Attributes:
        steps: Number of steps to come.
        every: Every so many steps are kept, and the last one.
        row: Where the next step to be kept goes.
        refresh: Steps between two states of the bar, ``steps`` if it is not shown.
        balance: Work, damping, numerical loss, see :mod:`fem_lie.balances`, shape (T, 3); zero
            where a row is not yet written, as ``impulses`` are.
        impulses: Of loads and reactions, shape (T, 2, 6).
        seconds: Wall time before a checkpoint from which the run was resumed.
    """

    def __init__(
        self,
        info: SceneInfo,
        steps: int,
        step: float,
        save_every: int,
        progress: bool | None,
        store: Checkpoints | None = None,
    ) -> None:
        """Allocate everything.

        Args:
            info: Bodies and joints.
            steps: Number of steps.
            step: Step size.
            save_every: Keep every so many steps, the last one in any case.
            progress: Show a bar; ``None``: if standard error is a terminal.
            store: Where results and checkpoints go, if not into memory.
        """
        self.steps, self.every, self._h, self._info = steps, save_every, step, info
        self._store, self.seconds = store, 0.0
        n = sum(len(body.nodes) for body in info.bodies)
        rows = steps // save_every + 1 + (steps % save_every > 0)
        shapes = {
            "times": (rows,),
            "frames": (rows, n, 4, 3),
            "velocities": (rows, n, 6),
            "joint_forces": (rows, len(info.joints), 6),
            "reactions": (rows, len(info.supports.at), 6),
            "joint_violations": (rows, len(info.joints)),
            "joint_coordinates": (rows, sum(len(joint.coordinates) for joint in info.joints)),
            "invariants": (rows, 7),
            "elastic": (rows,),
            "potential": (rows,),
            "balance": (rows, 3),
            "impulses": (rows, 2, 6),
            "iterations": (rows,),
        }
        arrays: dict[str, Any] = {name: np.empty(shape) for name, shape in shapes.items()}
        arrays["iterations"] = np.zeros(rows, dtype=np.int64)
        if store is not None:
            arrays = store.open(info, arrays)
        else:
            for name in ("elastic", "balance", "impulses"):
                arrays[name][:] = 0.0
        self.times, self.frames, self.velocities = (
            arrays[name] for name in ("times", "frames", "velocities")
        )
        self.joint_forces, self.invariants = arrays["joint_forces"], arrays["invariants"]
        self.joint_violations = arrays["joint_violations"]
        self.reactions = arrays["reactions"]
        self.joint_coordinates = arrays["joint_coordinates"]
        self.elastic, self.potential = arrays["elastic"], arrays["potential"]
        self.balance, self.impulses = arrays["balance"], arrays["impulses"]
        self.iterations = arrays["iterations"]
        self.row = 0 if store is None else store.row
        if store is not None:
            self.seconds = store.seconds
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
        """Leave the bar as it is."""
        self._bar.close()
        if self._store is not None:
            self._store.close(self.row)

    def keep(self, indices: Indices, iterations: Indices) -> None:
        """Count the steps ``indices``, whose values are in the next rows, as kept."""
        rows = slice(self.row, self.row + len(indices))
        self.times[rows], self.iterations[rows] = indices * self._h, iterations
        self.row += len(indices)

    def book(self, row: int, total: Array) -> None:
        """Keep balance and impulses up to the time of a row, shape (15,)."""
        self.balance[row] = total[: balances.COLUMNS]
        self.impulses[row] = total[balances.COLUMNS :].reshape(2, 6)

    def update_bar(self, index: int, iterations: int) -> None:
        """Show that step ``index`` is reached after so many iterations in all."""
        text = f"t={index * self._h:.3g} energy {self._gap():.1e} it/step {iterations / index:.2f}"
        self._bar.set_postfix_str(text, refresh=False)
        self._bar.update(index - self._bar.n)

    def _gap(self) -> float:
        """Present gap in the balance of energy, see :mod:`fem_lie.balances`."""
        if not self.row:
            return 0.0
        ends = [0, self.row - 1]
        stored, potential = self.invariants[ends, 0] + self.elastic[ends], self.potential[ends]
        gaps = balances.energy_gaps(stored + potential, self.balance[ends])
        scale = balances.energy_scale(stored, potential, self.balance[ends])
        return balances.relative(float(abs(gaps[-1])), scale)

    def update_if_due(self, index: int, iterations: int) -> None:
        """Show step ``index`` if the bar is shown and old."""
        if self.show and index - self._bar.n >= self.refresh:
            self.update_bar(index, iterations)

    def next_stop(self, index: int) -> int:
        """The next step after ``index`` at which there is something to do."""
        stops = [(index // self.every + 1) * self.every, self.steps]
        if self.show:
            stops.append(index + self.refresh)
        if self._store is not None:
            stops.append((index // self._store.every + 1) * self._store.every)
        return min(stops)

    def checkpoint_due(self, index: int) -> bool:
        """Whether the state after step ``index`` is to be written."""
        return self._store is not None and index % self._store.every == 0

    def write_checkpoint(self, index: int, memory: dict[str, Array]) -> None:
        """Write all that the next steps depend on."""
        assert self._store is not None
        self._store.write(index, self.row, self.seconds, memory)

    def result(self, factorisations: int, seconds: float, refreshes: int = 0) -> Result:
        """What was kept so far, with the numbers of whole matrices and of borders alone."""
        keep = slice(self.row)
        if self._store is not None:
            numbers = {"factorisations": factorisations + refreshes, "seconds": seconds}
            numbers |= {"k_updates": factorisations, "phi_updates": factorisations + refreshes}
            self._store.finish(numbers)
        return Result(
            times=self.times[keep],
            frames=self.frames[keep],
            velocities=self.velocities[keep],
            joint_forces=self.joint_forces[keep],
            reactions=self.reactions[keep],
            joint_coordinates=self.joint_coordinates[keep],
            joint_violations=self.joint_violations[keep],
            kinetic=self.invariants[keep, 0],
            elastic=self.elastic[keep],
            potential=self.potential[keep],
            momentum=self.invariants[keep, 1:4],
            angular_momentum=self.invariants[keep, 4:],
            balance=self.balance[keep],
            impulses=self.impulses[keep],
            iterations=self.iterations[keep],
            factorisations=factorisations + refreshes,
            k_updates=factorisations,
            phi_updates=factorisations + refreshes,
            seconds=seconds,
            info=self._info,
        )


class Recorder(History):
    """Takes what it keeps from the equations of a scene."""

    def __init__(
        self,
        system: System,
        steps: int,
        step: float,
        save_every: int,
        progress: bool | None,
        store: Checkpoints | None = None,
    ) -> None:
        """As :class:`History`, for the equations ``system``."""
        super().__init__(system.info(), steps, step, save_every, progress, store)
        self._system = system
        self._count = 0 if store is None or not store.memory else int(store.memory["count"])

    def record(
        self,
        index: int,
        H: Array,
        v: Array,
        a: Array,
        multipliers: Array,
        iterations: int,
        booked: Array,
    ) -> None:
        """Keep step ``index`` if it is one to be kept; ``booked``: see :meth:`book`."""
        self._count += iterations
        if self.show and index and index % self.refresh == 0:
            self.update_bar(index, self._count)
        if index % self.every and index != self.steps:
            return
        system, row = self._system, self.row
        attachment = system.numbering.attachment
        self.frames[row] = attachment.frames(H)
        self.velocities[row] = attachment.twists(v)
        forces, coordinates, violations = system.report_joints(H, v, multipliers)
        self.joint_forces[row], self.joint_coordinates[row] = forces, coordinates
        self.joint_violations[row] = violations
        self.reactions[row] = system.reactions(H, v, a, multipliers)
        self.potential[row] = system.report(H, v, self.invariants[row])
        self.elastic[row] = system.stored_energy(H)
        self.book(row, booked)
        self.times[row], self.iterations[row] = index * self._h, self._count
        self.row += 1

    def write_checkpoint(self, index: int, memory: dict[str, Array]) -> None:
        """See the base class."""
        super().write_checkpoint(index, memory | {"count": np.array(self._count)})
