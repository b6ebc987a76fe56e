"""Files of the cache with a checksum: truncated, empty or altered files are never executed."""

from __future__ import annotations

import hashlib
import logging
import os
import pickle
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import Any

from numba.core.caching import IndexDataCacheFile

_log = logging.getLogger(__name__)
_SIZE = 16  # bytes of a checksum


def _checksum(data: bytes) -> bytes:
    return hashlib.blake2b(data, digest_size=_SIZE).digest()


def write_checked(path: Path, data: bytes) -> None:
    """Write a file that appears under its name only when it is complete.

    Raises:
        OSError: The disk is full, or there is another reason.
    """
    descriptor, unfinished = tempfile.mkstemp(dir=path.parent)
    try:
        with open(descriptor, "wb") as file:
            file.write(_checksum(data) + data)
        os.replace(unfinished, path)
    except OSError:
        with suppress(OSError):
            os.unlink(unfinished)
        raise


def read_checked(path: Path) -> bytes | None:
    """Contents of a file of :func:`write_checked`; ``None`` if it is missing or damaged."""
    try:
        content = path.read_bytes()
    except FileNotFoundError:
        return None
    checksum, data = content[:_SIZE], content[_SIZE:]
    if checksum != _checksum(data):
        _log.warning("%s is damaged; it is replaced", path)
        return None
    return data


def unpickled(data: bytes | None) -> Any:
    """Unpickled object; ``None`` for nothing, and for records of modules that do not exist.

    Versions of the package share a cache, and a function that is the same in two of them may have
    been compiled for records that one of them does not have.
    """
    try:
        return None if data is None else pickle.loads(data)
    except (ImportError, AttributeError):
        return None


def _last(overloads: dict[Any, str]) -> dict[Any, str]:
    """The signature that was added last."""
    return dict([list(overloads.items())[-1]])


class CheckedFiles(IndexDataCacheFile):
    """Index and data of one function in numba's cache, each with a checksum.

    Processes that write simultaneously can leave an index with the name of the data of another
    signature: the data therefore contain their signature.
    """

    def save(self, key: Any, data: Any) -> None:
        """Write the compiled code of a signature."""
        super().save(key, (key, data))

    def load(self, key: Any) -> Any:
        """Compiled code of a signature, or ``None``."""
        saved_for, data = super().load(key) or (None, None)
        return data if saved_for == key else None

    def _load_index(self) -> dict[Any, str]:
        data = read_checked(Path(self._index_path))
        stamp, overloads = unpickled(data) or (None, {})
        return overloads if stamp == self._source_stamp else {}

    def _save_index(self, overloads: dict[Any, str]) -> None:
        for kept in (self._alive, self._alive, _last):
            try:
                data = self._dump((self._source_stamp, overloads))
            except ReferenceError:
                # functions in signatures that were read from the file: numba keeps 128 alive
                overloads = kept(overloads)
            else:
                write_checked(Path(self._index_path), data)
                return
        write_checked(Path(self._index_path), self._dump((self._source_stamp, overloads)))

    def _alive(self, overloads: dict[Any, str]) -> dict[Any, str]:
        """Signatures of which all functions still exist."""
        return {key: name for key, name in overloads.items() if self._is_alive(key)}

    def _is_alive(self, key: Any) -> bool:
        try:
            self._dump(key)
        except ReferenceError:
            return False
        return True

    def _load_data(self, name: str) -> Any:
        data = read_checked(Path(self._data_path(name)))
        return unpickled(data)

    def _save_data(self, name: str, data: Any) -> None:
        write_checked(Path(self._data_path(name)), self._dump(data))
