"""Files on several ranks: the first one writes those that were asked for."""

from __future__ import annotations

import atexit
import os
import shutil
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from zlib import crc32

from fem_lie.ranks.together import end_together, first, from_first, meet, several


@cache
def _folder() -> Path:
    """Of a rank that is not the first, until it ends."""
    made = Path(tempfile.mkdtemp(prefix="fem_lie_rank_"))
    atexit.register(shutil.rmtree, made, ignore_errors=True)
    return made


def place(path: str | os.PathLike[str]) -> Path:
    """Where this rank writes what goes to ``path`` row by row: others than the first, aside."""
    if first() or _folder() in Path(path).parents:
        return Path(path)
    aside = _folder() / f"{crc32(os.fsencode(Path(path).absolute().parent)):x}"
    aside.mkdir(exist_ok=True)
    return aside / Path(path).name


def place_to_go_on(path: Path, beside: Path) -> Path:
    """As :func:`place`, with a copy of a file and of what stands beside it.

    All ranks wait until all have theirs.
    """
    if not several():
        return path
    own = place(path)
    end_together()
    if not first():
        for source in (path, beside):
            shutil.copyfile(source, own.with_name(source.name))
    meet(f"a copy of {path}")
    return own


def write_once(path: str | os.PathLike[str], write: Callable[[], None]) -> None:
    """Write on the first rank; its error is that of all.

    Raises:
        OSError: As ``write``, on all ranks.
    """
    if not several():
        write()
        return
    end_together()
    error: OSError | None = None
    if first():
        try:
            write()
        except OSError as found:
            error = found
    from_first(f"writing {path}", error)


def before_reading(path: str | os.PathLike[str]) -> None:
    """Wait until all ranks have done what comes before, such as the first one writing the file."""
    if several():
        end_together()
        meet(f"reading {path}")
