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
from typing import Any, NamedTuple, Protocol
from zipfile import BadZipFile

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._state import HasState
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.bodies.initial_state import InitialState
from fem_lie.results import file as results_file
from fem_lie.results.files.storage import ResultRows, write_all
from fem_lie.results.record import ContactSteps, FrictionForces, StepHistory
from fem_lie.scene import Scene
from fem_lie.scene.scene import started
from fem_lie.solve.recording.fingerprint import Fingerprint
from fem_lie.solve.recording.plan import Plan, unpacked
from fem_lie.solve.recording.whole_state import MovingState

_log = logging.getLogger(__name__)

WINDOW = "window.kept."
"""Prefix of the last row, from which states at requested times are interpolated, and of energies of
the first one."""

FRICTION = "friction"
"""Name of the friction forces of all states so far."""


_START = "start."
"""Prefix of the state of the bodies from which the run started, if it is not their own."""


class Last(NamedTuple):
    """The last checkpoint of a run with a result file.

    Attributes:
        path: File of the checkpoint.
        every: Steps between two checkpoints.
        made: Number of steps made.
        plan: Plan of the run.
        kept: Its other contents.
    """

    path: Path
    every: int
    made: int
    plan: Plan
    kept: dict[str, Any]

    @classmethod
    def of(cls, file: Path) -> Last:
        """Read it.

        Raises:
            FileNotFoundError: There is no result file or no checkpoint.
            ValueError: The file or the checkpoint is of another version, or all checkpoints are
                damaged.
        """
        require_files(file)
        results_file.require_version(file)
        used, kept = _last_undamaged(file)
        if "fingerprint" not in kept or "plan.record" not in kept:
            raise ValueError(f"{str(used)!r} is not a checkpoint of this version")
        every, made = (int(number) for number in kept.pop("progress"))
        return cls(used, every, made, unpacked(kept), kept)

    def starting(self, scene: Scene) -> Scene:
        """The scene that starts as the run did.

        Args:
            scene: The scene as it was given to the run.

        Raises:
            ValueError: It has another number of nodes.
        """
        if _START + "frames" not in self.kept:
            return scene
        frames, velocities = (self.kept[_START + name] for name in ("frames", "velocities"))
        return started(scene, InitialState.of(frames, velocities, scene.bodies))


def start_of(scene: Scene) -> dict[str, Array]:
    """State of the bodies from which runs of a scene start, if it is not their own.

    It is what :meth:`Last.starting` reads.
    """
    state = scene.began.state
    if state is None:
        return {}
    frames, velocities = state.arrays(scene.bodies)
    return {_START + "frames": frames, _START + "velocities": velocities}


class Restartable(HasState, Protocol):
    """A run whose state can be written, as a whole or that of a part of a divided scene."""

    @property
    def cell_pairs(self) -> Indices:
        """Pairs of cells and nodes of which the state of a part has something."""

    def divided_state(self) -> dict[str, Array]:
        """What moves in a part of a scene, and what all ranks have in common."""

    def restart(self, state: MovingState, common: Mapping[str, Array]) -> None:
        """Restart from the state of a scene that was divided."""


class Checkpoints:
    """Result file and checkpoints of a run.

    Attributes:
        info: Bodies and joints of the results, once the file is open.
        every: Steps between two checkpoints; 0: at every hundredth of the duration.
        row: Number of rows of results at the checkpoint from which the run restarts.
        state: State at that checkpoint, or empty.
        plan: Plan of the run.
    """

    info: SceneInfo

    def __init__(self, path: Path, every: int, plan: Plan, fingerprint: Fingerprint) -> None:
        """Start a new run.

        Args:
            path: Result file.
            every: Steps between two checkpoints; 0: at every hundredth of the duration.
            plan: Plan of the run.
            fingerprint: Fingerprint of scene and scheme.

        Raises:
            ValueError: The plan cannot be written.
        """
        self._constant = plan.packed() | start_of(fingerprint.scene)
        self._path, self.every, self.plan, self._fingerprint = path, every, plan, fingerprint
        self.row, self.state, self.seconds = 0, dict[str, Array](), 0.0
        self._until, self._at = 0.0, 0.0

    def resume(self, last: Last) -> None:
        """Restart from a checkpoint.

        Raises:
            ValueError: It belongs to another scene or other options, which are named.
        """
        kept, ends = last.kept, last.plan.ends(last.made, last.kept)
        found = self._fingerprint.differences(kept["fingerprint"], ends)
        if found:
            raise ValueError(
                f"cannot resume from {str(last.path)!r}: it belongs to another scene or to "
                f"other options of the scheme; what differs: {_listed(found)}"
            )
        self.row, self.seconds = int(kept["row"]), float(kept["seconds"])
        self.state, self._at = kept, float(ends[-1])

    def reachable(self) -> bool:
        """Whether rows can be written after an error."""
        return True

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
        self.info, self._shapes = info, shapes
        self._file = ResultRows(self._path)

    def rows_at_once(self, rows: int) -> int:
        """Number of rows that are passed on together, if there is memory for so many."""
        return rows

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
            known = self.info, self._shapes
            results_file.enlarge(self._path, *known, filled, max(rows, 2 * self._file.capacity))
            self._file = ResultRows(self._path)

    def friction(self, own: FrictionForces | None) -> FrictionForces | None:
        """Friction forces as this file has them, from those of the equations of this rank.

        Args:
            own: These; ``None``: no contact has any.
        """
        return own

    def state_of(self, run: Restartable) -> dict[str, Array]:
        """State of a run as this file keeps it."""
        return run.saved_state()

    def restore(self, run: Restartable) -> None:
        """Restore the state of a run from the checkpoint."""
        run.restore(self.state)

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
        own |= self._constant
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

    def add(self, record: StepHistory | ContactSteps | FrictionForces) -> None:
        """Write the log of the steps to the file."""
        with self._writing("the log of the steps cannot be written"):
            results_file.add(self._path, record)


_NAMED = 6
"""Largest number of differences that an error lists."""


def _listed(names: list[str]) -> str:
    others = len(names) - _NAMED
    return ", ".join(names[:_NAMED]) + (f" and {others} others" if others > 0 else "")


def checkpoints_of(path: Path) -> list[Path]:
    """Files of the last and of the previous checkpoint."""
    return [_checkpoint_of(path), _before(path)]


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
