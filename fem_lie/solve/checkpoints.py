"""Results that go to a file as they are made, and the state from which a run can go on.

The file of results is created whole, with room for all rows, and written through mapped memory; a
killed process loses nothing that it has written. Beside it stands the last checkpoint, replaced in
one piece: all numbers on which the following steps depend. What a resumed run computes is therefore
the same to the last bit as if it had never been interrupted.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fem_lie import _results_file
from fem_lie.info import SceneInfo
from fem_lie.results import Array
from fem_lie.solve.fingerprint import Fingerprint


class Plan(NamedTuple):
    """What a run is to do.

    Attributes:
        steps: Number of steps.
        step: Step size.
        save_every: Every so many steps are kept.
    """

    steps: int
    step: float
    save_every: int


class Checkpoints:
    """Where a run writes its results and checkpoints.

    Attributes:
        every: Steps between two checkpoints.
        row: Rows of results that belong to the last checkpoint.
        memory: State at the last checkpoint, or empty.
        plan: What is to be done.
    """

    def __init__(
        self, path: str | os.PathLike[str], every: int, plan: Plan, fingerprint: Fingerprint
    ) -> None:
        """Start anew.

        Args:
            path: File of results.
            every: Steps between two checkpoints.
            plan: What is to be done.
            fingerprint: Of scene and scheme.

        Raises:
            ValueError: ``every`` is not positive.
        """
        if every < 1:
            raise ValueError(f"checkpoint_every must be at least 1, got {every}")
        self._path, self.every, self.plan, self._fingerprint = Path(path), every, plan, fingerprint
        self.row, self.memory, self.seconds = 0, dict[str, Array](), 0.0
        self._rows = np.zeros(1, dtype=np.int64)

    @classmethod
    def resume(cls, path: str | os.PathLike[str], fingerprint: Fingerprint) -> Checkpoints:
        """Go on from the last checkpoint beside a file of results.

        Raises:
            FileNotFoundError: There is no file of results or no checkpoint.
            ValueError: The checkpoint belongs to another scene or other options, which are named,
                or is of another version.
        """
        file = Path(path)
        require_files(file)
        with np.load(_beside(file), allow_pickle=False) as stored:
            kept = {name: stored[name] for name in stored.files}
        if "fingerprint" not in kept:
            raise ValueError(f"{str(_beside(file))!r} is not a checkpoint of this version")
        steps, every_row, every, index = (int(number) for number in kept.pop("plan"))
        plan = Plan(steps, float(kept.pop("step")), every_row)
        found = fingerprint.differences(kept.pop("fingerprint"), plan.step, index)
        if found:
            raise ValueError(
                f"cannot resume from {str(_beside(file))!r}: it belongs to another scene or to "
                f"other options of the scheme; what differs: {_listed(found)}"
            )
        store = cls(file, every, plan, fingerprint)
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

    def write(self, index: int, row: int, seconds: float, memory: dict[str, Array]) -> None:
        """Replace the checkpoint.

        Args:
            index: Steps made.
            row: Rows of results up to here.
            seconds: Wall time up to here.
            memory: All that the next steps depend on.
        """
        self._rows[0] = row
        plan = self.plan
        target = _beside(self._path)
        unfinished = target.with_name(f".{target.name}.{os.getpid()}.part")
        own: dict[str, Any] = {
            "plan": np.array([plan.steps, plan.save_every, self.every, index]),
            "step": np.array(plan.step),
            "fingerprint": self._fingerprint.packed(plan.step, index),
        }
        own |= {"row": np.array(row), "seconds": np.array(seconds)}
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


_NAMED = 6
"""Most differences that an error lists."""


def _listed(names: list[str]) -> str:
    others = len(names) - _NAMED
    return ", ".join(names[:_NAMED]) + (f" and {others} others" if others > 0 else "")


def require_files(path: Path) -> None:
    """Raise ``FileNotFoundError`` if there is no file of results, or no checkpoint beside it."""
    for wanted in (path, _beside(path)):
        if not wanted.is_file():
            raise FileNotFoundError(f"cannot resume: there is no file {str(wanted)!r}")


def _beside(path: Path) -> Path:
    return path.with_name(path.name + ".checkpoint")
