"""Results of a long benchmark in a file, one line of JSON each, so that it can be continued."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any


class Progress:
    """Results by key; those in the file are not computed again."""

    def __init__(self, file: Path | None) -> None:
        """Read what is there; without a file nothing is kept."""
        self._file = file
        lines = file.read_text().splitlines() if file is not None and file.exists() else []
        self._known: dict[str, Any] = dict(json.loads(line) for line in lines)

    def result(self, key: str, compute: Callable[[], Any]) -> Any:
        """The result with this key, of types that JSON has."""
        if key not in self._known:
            self._known[key] = json.loads(json.dumps(compute()))
            if self._file is not None:
                with self._file.open("a") as file:
                    file.write(json.dumps([key, self._known[key]]) + "\n")
        return self._known[key]
