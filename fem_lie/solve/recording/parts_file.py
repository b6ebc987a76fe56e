"""Results and checkpoints of a divided scene: the first rank writes one file for all.

The file is that of the whole scene. Rows are gathered when the buffers of all ranks are passed on,
and every rank reads the results from there at the end: none of them has all in memory. Checkpoints
have the state of the whole scene, see :mod:`fem_lie.solve.recording.whole_state`.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from functools import partial
from math import prod
from pathlib import Path
from typing import Any

from mpi4py import MPI

import numpy as np

from fem_lie._arrays import Array
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.parts.part_scene import undivided
from fem_lie.ranks.files import read_together, write_once
from fem_lie.ranks.together import all_arrive
from fem_lie.results.files.storage import ResultRows
from fem_lie.results.gathering import Gathering
from fem_lie.results.record import ContactSteps, FrictionForces, StepHistory, row_shapes
from fem_lie.solve.recording.checkpoints import FRICTION, WINDOW, Checkpoints, Restartable
from fem_lie.solve.recording.fingerprint import Fingerprint
from fem_lie.solve.recording.plan import Plan
from fem_lie.solve.recording.whole_state import MovingState, own, whole
from fem_lie.system.equations import Equations

_BYTES = 2**26
"""Size of the rows of the whole scene that are gathered at a time."""


def _rows_in(state: Mapping[str, Array]) -> list[str]:
    """Names of the quantities of rows in a checkpoint."""
    return [name for name in state if name.startswith(WINDOW)]


class PartsFile(Checkpoints):
    """File of the results of all parts; all methods are collective."""

    def __init__(
        self,
        path: str | os.PathLike[str],
        every: int,
        plan: Plan,
        fingerprint: Fingerprint,
        equations: Equations,
    ) -> None:
        """Start a new run, of all parts or of a scene that was divided before.

        Args:
            path: Result file, in a folder that all ranks see.
            every: Steps between two checkpoints.
            plan: Plan of the run.
            fingerprint: Fingerprint of scene and scheme.
            equations: Equations of the part of this rank, or of the whole scene.
        """
        super().__init__(Path(path), every, plan, fingerprint)
        self._equations = equations

    def open(self, info: SceneInfo, shapes: Mapping[str, tuple[int, ...]], rows: int) -> None:
        """Create the file of the whole scene, if it is a new run.

        Args:
            info: Bodies and joints of the part.
            shapes: Shapes of a row of the part, by names of results.
            rows: Number of rows.

        Raises:
            OSError: The file cannot be created, or not all ranks see it.
        """
        equations = self._equations
        part = equations.part or undivided(equations.scene)
        self._gathering = Gathering(info, part)
        whole_info, known = self._gathering.info, row_shapes(self._gathering.info, part.total)
        shapes = {name: known[name] for name in shapes}
        write_once(self._path, partial(super().open, whole_info, shapes, rows))
        blind = [k for k, sees in enumerate(part.comm.allgather(self._path.is_file())) if not sees]
        if blind:
            raise OSError(
                f"ranks {blind} do not see {str(self._path)!r}: expected a folder that all have"
            )
        self.info = whole_info
        size = 8 * sum(prod(shape) for shape in shapes.values())
        self._at_once = max(1, _BYTES // size)
        for name in _rows_in(self.state):
            row = self._gathering.own(name.removeprefix(WINDOW), self.state[name][np.newaxis])
            self.state[name] = row[0]
        if FRICTION in self.state:
            self.state[FRICTION] = self._gathering.own_friction(self.state[FRICTION])

    def reachable(self) -> bool:
        """Whether all ranks have the error, and write their rows together."""
        return all_arrive(self._gathering.part.comm)

    def rows_at_once(self, rows: int) -> int:
        """The smallest number of rows that any rank has memory for."""
        return int(self._gathering.part.comm.allreduce(rows, op=MPI.MIN))

    def append(self, first: int, rows: Mapping[str, Array], reached: float) -> None:
        """Gather and write rows of all parts, from row ``first`` on; see the base class."""
        for begin in range(0, len(rows["times"]), self._at_once):
            some = slice(begin, begin + self._at_once)
            found = self._gathering.rows({name: values[some] for name, values in rows.items()})
            write_once(self._path, partial(super().append, first + begin, found, reached))

    def friction(self, own: FrictionForces | None) -> FrictionForces | None:
        """Friction forces of all parts."""
        return self._gathering.friction(own)

    def state_of(self, run: Restartable) -> dict[str, Array]:
        """What moves in the part, and what all ranks have in common."""
        return run.divided_state()

    def restore(self, run: Restartable) -> None:
        """Restart a run from the state of the whole scene."""
        known = self._gathering, self._equations, self.state
        run.restart(own(*known, run.cell_pairs), self.state)

    def rows(self, count: int) -> dict[str, Array]:
        """The first rows of all results of the whole scene, mapped into memory."""
        return read_together(self._path, lambda: ResultRows(self._path).read(count))

    def write(self, index: int, row: int, seconds: float, state: dict[str, Array]) -> None:
        """Replace the checkpoint by one of the whole scene.

        Args:
            index: Number of steps made.
            row: Number of rows of results so far.
            seconds: Wall time so far.
            state: What all ranks have in common, and the fields of the part's
                :class:`~fem_lie.solve.recording.whole_state.MovingState`.
        """
        fields: Any = [state[name] for name in MovingState._fields]
        moving = MovingState(*fields)
        kept = {name: each for name, each in state.items() if name not in MovingState._fields}
        kept |= whole(self._gathering, self._equations, moving)
        friction = self.friction(FrictionForces(kept.pop(FRICTION)) if FRICTION in kept else None)
        if friction is not None:
            kept[FRICTION] = friction.each
        rows = {name.removeprefix(WINDOW): np.asarray([kept.pop(name)]) for name in _rows_in(kept)}
        found = self._gathering.rows(rows)
        if self._gathering.part.comm.rank == 0:
            kept |= {f"{WINDOW}{name}": row[0] for name, row in found.items()}
        write_once(self._path, partial(super().write, index, row, seconds, kept))

    def finish(self, numbers: dict[str, float]) -> None:
        """Write the totals of the run to the file."""
        write_once(self._path, partial(super().finish, numbers))

    def add(self, record: StepHistory | ContactSteps | FrictionForces) -> None:
        """Write the log of the steps to the file."""
        write_once(self._path, partial(super().add, record))
