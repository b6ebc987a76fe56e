"""Results written to a file during the run, and the state from which a run can be restarted.

The result file is created at full size and written row by row; whenever the process ends, the rows
written so far can be read. Next to it is the last checkpoint, which is replaced atomically, and the
previous one: all data on which the following steps depend. A restarted run therefore computes the
same results, bit for bit, as an uninterrupted one, also from the previous checkpoint, which is used
if the last one is damaged.
"""

from __future__ import annotations

import errno
import logging
import os
import struct
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from io import BytesIO
from math import prod
from pathlib import Path
from shutil import disk_usage
from tokenize import TokenError
from typing import Any
from zipfile import BadZipFile

import numpy as np

from fem_lie._arrays import Array
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.ranks.files import place, restart_file
from fem_lie.results import file as results_file
from fem_lie.results.files.storage import ResultRows, write_all
from fem_lie.results.record import ContactSteps, StepHistory
from fem_lie.solve.recording.fingerprint import Fingerprint
from fem_lie.solve.recording.plan import Plan, unpacked

_log = logging.getLogger(__name__)


class Checkpoints:
    """Result file and checkpoints of a run.

    Attributes:
        every: Steps between two checkpoints; 0: at every hundredth of the duration.
        row: Number of rows of results at the checkpoint from which the run restarts.
        state: State at that checkpoint, or empty.
        plan: Plan of the run.
    """

    def __init__(
        self, path: str | os.PathLike[str], every: int, plan: Plan, fingerprint: Fingerprint
    ) -> None:
        """Start a new run.

        Args:
            path: Result file.
            every: Steps between two checkpoints; 0: at every hundredth of the duration.
            plan: Plan of the run.
            fingerprint: Fingerprint of scene and scheme.

        Raises:
            ValueError: The plan cannot be written.
        """
        self._packed_plan = plan.packed()
        self._path, self.every, self.plan, self._fingerprint = place(path), every, plan, fingerprint
        self.row, self.state, self.seconds = 0, dict[str, Array](), 0.0
        self._until, self._at = 0.0, 0.0

    @classmethod
    def resume(cls, path: str | os.PathLike[str], fingerprint: Fingerprint) -> Checkpoints:
        """Restart from the last checkpoint beside a result file.

        Raises:
            FileNotFoundError: There is no result file or no checkpoint.
            ValueError: The checkpoint belongs to another scene or other options, which are named;
                it or the file is of another version; or all checkpoints are damaged.
        """
        file = Path(path)
        require_files(file)
        results_file.require_version(file)
        file = restart_file(file, [_checkpoint_of(file), _before(file)])
        used, kept = _last_undamaged(file)
        if "fingerprint" not in kept or "plan.record" not in kept:
            raise ValueError(f"{str(used)!r} is not a checkpoint of this version")
        every, index = (int(number) for number in kept.pop("progress"))
        plan = unpacked(kept)
        ends = plan.ends(index, kept)
        found = fingerprint.differences(kept.pop("fingerprint"), ends)
        if found:
            raise ValueError(
                f"cannot resume from {str(used)!r}: it belongs to another scene or to "
                f"other options of the scheme; what differs: {_listed(found)}"
            )
        store = cls(file, every, plan, fingerprint)
        store.row, store.seconds = int(kept.pop("row")), float(kept.pop("seconds"))
        store.state, store._at = kept, float(ends[-1])
        return store

    def open(self, info: SceneInfo, shapes: Mapping[str, tuple[int, ...]], rows: int) -> None:
        """Create the file, with space for rows of these shapes, if it is a new run.

        Raises:
            OSError: The file cannot be created; the message names it.
        """
        if not self.state:
            size = 8 * rows * sum(prod(shape) for shape in shapes.values())
            with self._writing("the file of results cannot be made"):
                free = disk_usage(self._path.parent).free
                if size > free:
                    _log.warning("%s will have %d bytes, and %d are free", self._path, size, free)
                results_file.create(self._path, info, shapes, rows)
            for checkpoint in (_checkpoint_of(self._path), _before(self._path)):
                checkpoint.unlink(missing_ok=True)
        self._info, self._shapes = info, shapes
        self._file = ResultRows(self._path)

    def append(self, first: int, rows: Mapping[str, Array], reached: float) -> None:
        """Write rows of results from row ``first`` on.

        Args:
            first: Number of rows before.
            rows: The same number of rows of each array.
            reached: Current time of the run.

        Raises:
            OSError: The rows cannot be written, for example because the disk is full; the message
                names the file and the times.
        """
        with self._writing(self._lost(reached)):
            self._enlarge(first, first + len(rows["times"]))
            self._file.write(first, rows)
        self._until = float(rows["times"][-1])

    def _enlarge(self, filled: int, rows: int) -> None:
        """Enlarge the file if it has no space for this number of rows."""
        if rows > self._file.capacity:
            known = self._info, self._shapes
            results_file.enlarge(self._path, *known, filled, max(rows, 2 * self._file.capacity))
            self._file = ResultRows(self._path)

    def rows(self, count: int) -> dict[str, Array]:
        """The first rows of all results, mapped into memory."""
        return self._file.read(count)

    def write(self, index: int, row: int, seconds: float, state: dict[str, Array]) -> None:
        """Replace the checkpoint.

        Args:
            index: Number of steps made.
            row: Number of rows of results so far.
            seconds: Wall time so far.
            state: State on which the next steps depend.

        Raises:
            OSError: As in :meth:`append`; the last checkpoint stays.
        """
        ends = self.plan.ends(index, state)
        own: dict[str, Any] = {
            "progress": np.array([self.every, index]),
            "fingerprint": self._fingerprint.packed(ends),
            "row": np.array(row),
            "seconds": np.array(seconds),
        }
        own |= self._packed_plan
        packed, kept = BytesIO(), own | state
        # the directory of an archive has no checksum: lost entries would not be noticed
        kept[_NAMES] = np.array(sorted(kept))
        np.savez(packed, **kept)
        # released in any case: an interruption keeps references to the frames that it passed
        # through
        with self._writing(self._lost(float(ends[-1]))), packed.getbuffer() as data:
            self._file.sync()
            self._replace(data)
        self._at = float(ends[-1])

    def _replace(self, data: memoryview) -> None:
        """Write the checkpoint under another name first, so that one is intact at any time.

        The last checkpoint becomes the previous one.
        """
        target = _checkpoint_of(self._path)
        unfinished = target.with_name(f".{target.name}.{os.getpid()}.part")
        try:
            with unfinished.open("wb", buffering=0) as file:
                write_all(file.fileno(), data, 0)
                os.fsync(file.fileno())
            if target.is_file():
                os.replace(target, _before(self._path))
            os.replace(unfinished, target)
        finally:
            unfinished.unlink(missing_ok=True)

    def _lost(self, reached: float) -> str:
        text = (
            f"the run has reached time {reached:g}, and results up to time {self._until:g} can be "
            "read from the file"
        )
        more = f"; resume restarts from time {self._at:g}" if self._at else ""
        return text + more

    @contextmanager
    def _writing(self, what: str) -> Iterator[None]:
        """Add to an error the name of the file, and ``what`` is lost."""
        try:
            yield
        except OSError as error:
            number = error.errno or errno.EIO
            text = f"{os.strerror(number)}: {what}"
            raise OSError(number, text, str(self._path)) from None

    def finish(self, numbers: dict[str, float]) -> None:
        """Write the totals of the run to the file."""
        with self._writing("counts and seconds of the run cannot be written"):
            results_file.finish(self._path, numbers)

    def add(self, record: StepHistory | ContactSteps) -> None:
        """Write the log of the steps to the file."""
        with self._writing("the log of the steps cannot be written"):
            results_file.add(self._path, record)


_NAMED = 6
"""Largest number of differences that an error lists."""


def _listed(names: list[str]) -> str:
    others = len(names) - _NAMED
    return ", ".join(names[:_NAMED]) + (f" and {others} others" if others > 0 else "")


def require_files(path: Path) -> None:
    """Raise ``FileNotFoundError`` if there is no file of results, or no checkpoint beside it."""
    for wanted, instead in ((path, path), (_checkpoint_of(path), _before(path))):
        if not (wanted.is_file() or instead.is_file()):
            raise FileNotFoundError(f"cannot resume: there is no file {str(wanted)!r}")


_NAMES = "names"
"""Key of the names of all other arrays of a checkpoint."""

_DAMAGES = (
    # what reading a damaged archive raises
    *(BadZipFile, zlib.error, OSError, EOFError, KeyError, ValueError, struct.error),
    *(NotImplementedError, RuntimeError, MemoryError, OverflowError),
    # NumPy reads array headers with Python's tokenizer, which fails on a damaged one
    *(TokenError, SyntaxError),
)


def _last_undamaged(path: Path) -> tuple[Path, dict[str, Any]]:
    """File and contents of the last checkpoint, or of the previous one if it is damaged.

    Raises:
        ValueError: Both are damaged.
    """
    damages: list[str] = []
    for checkpoint in (_checkpoint_of(path), _before(path)):
        if not checkpoint.is_file():
            continue
        try:
            with checkpoint.open("rb") as file, np.load(file, allow_pickle=False) as stored:
                kept = {name: stored[name] for name in stored.files}
            if sorted(kept) != sorted([_NAMES, *kept.get(_NAMES, ())]):
                raise KeyError("arrays are missing")
            del kept[_NAMES]
        except _DAMAGES as error:
            damages.append(f"{str(checkpoint)!r} is damaged ({type(error).__name__}: {error})")
            continue
        if damages:
            _log.warning("%s; the run resumes from %s", damages[0], checkpoint)
        return checkpoint, kept
    raise ValueError(f"cannot resume: {' and '.join(damages)}")


def _checkpoint_of(path: Path) -> Path:
    """File of the last checkpoint."""
    return path.with_name(path.name + ".checkpoint")


def _before(path: Path) -> Path:
    """File of the previous checkpoint."""
    return path.with_name(path.name + ".checkpoint.before")
