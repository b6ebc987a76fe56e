"""Results that go to a file as they are made, and the state from which a run can go on.

The file of results is created whole, with room for all rows, and written through mapped memory; a
killed process loses nothing that it has written. Beside it stands the last checkpoint, replaced in
one piece: all numbers on which the following steps depend. What a resumed run computes is therefore
the same to the last bit as if it had never been interrupted.
"""

from __future__ import annotations

import hashlib
import os
from pathlib import Path
from typing import Any

import numpy as np

from fem_lie import _results_file
from fem_lie.info import SceneInfo
from fem_lie.results import Array
from fem_lie.system import System


def fingerprint(system: System, scheme: Any) -> str:
    """Of what a run is about: scene and options. A checkpoint is of no use to any other."""
    parts = [system.frames, system.velocities, *system.inertia, *system.table, system.held]
    options = vars(scheme) | {"policy": (type(scheme.policy), vars(scheme.policy))}
    digest = hashlib.sha256(f"{type(scheme)} {options}".encode())
    for part in (*parts, system.conservative):
        digest.update(np.ascontiguousarray(part).tobytes())
    return digest.hexdigest()


class Checkpoints:
    """Where a run writes its results and checkpoints.

    Attributes:
        every: Steps between two checkpoints.
        row: Rows of results that belong to the last checkpoint.
        memory: State at the last checkpoint, or empty.
        plan: Steps, step size and interval of saving.
    """

    def __init__(
        self, path: str | os.PathLike[str], every: int, plan: tuple[int, float, int], mark: str
    ) -> None:
        """Start anew.

        Args:
            path: File of results.
            every: Steps between two checkpoints.
            plan: Steps, step size and interval of saving.
            mark: See :func:`fingerprint`.

        Raises:
            ValueError: ``every`` is not positive.
        """
        if every < 1:
            raise ValueError(f"checkpoint_every must be at least 1, got {every}")
        self._path, self.every, self.plan, self._mark = Path(path), every, plan, mark
        self.row, self.memory, self.seconds = 0, dict[str, Array](), 0.0
        self._rows = np.zeros(1, dtype=np.int64)

    @classmethod
    def resume(cls, path: str | os.PathLike[str], mark: str) -> Checkpoints:
        """Go on from the last checkpoint beside a file of results.

        Raises:
            FileNotFoundError: There is no file of results or no checkpoint.
            ValueError: The checkpoint belongs to another scene or other options.
        """
        file = Path(path)
        beside = _beside(file)
        for wanted in (file, beside):
            if not wanted.is_file():
                raise FileNotFoundError(f"cannot resume: there is no file {str(wanted)!r}")
        with np.load(beside, allow_pickle=False) as stored:
            kept = {name: stored[name] for name in stored.files}
        if str(kept.pop("mark")) != mark:
            raise ValueError(
                f"cannot resume from {str(beside)!r}: it belongs to another scene, or to other "
                "options of the scheme"
            )
        steps, every_row, every = (int(number) for number in kept.pop("plan"))
        plan = (steps, float(kept.pop("step")), every_row)
        store = cls(file, every, plan, mark)
        store.row, store.seconds = int(kept.pop("row")), float(kept.pop("seconds"))
        store.memory = kept
        return store

    def open(self, info: SceneInfo, arrays: dict[str, Any]) -> dict[str, Any]:
        """The arrays of the file, with the shapes of ``arrays``; made if it is a new run."""
        if not self.memory:
            _results_file.create(self._path, info, arrays)
            _beside(self._path).unlink(missing_ok=True)
        found = _results_file.pages(self._path)
        self._rows = found.pop("rows")
        if not self.memory:
            found["elastic"][:] = 0.0
        return found

    def write(self, row: int, seconds: float, memory: dict[str, Array]) -> None:
        """Replace the checkpoint.

        Args:
            row: Rows of results up to here.
            seconds: Wall time up to here.
            memory: All that the next steps depend on.
        """
        self._rows[0] = row
        steps, step, every_row = self.plan
        target = _beside(self._path)
        unfinished = target.with_name(f".{target.name}.{os.getpid()}.part")
        own: dict[str, Any] = {
            "plan": np.array([steps, every_row, self.every]),
            "step": np.array(step),
        }
        own |= {"row": np.array(row), "seconds": np.array(seconds), "mark": np.array(self._mark)}
        try:
            with unfinished.open("wb") as file:
                np.savez(file, **(own | memory))
                file.flush()
                os.fsync(file.fileno())
            os.replace(unfinished, target)
        finally:
            unfinished.unlink(missing_ok=True)

    def close(self, row: int) -> None:
        """All rows up to here count."""
        self._rows[0] = row

    def finish(self, numbers: dict[str, float]) -> None:
        """Say in the file what the run took."""
        _results_file.finish(self._path, numbers)


def _beside(path: Path) -> Path:
    return path.with_name(path.name + ".checkpoint")
