"""Programs that answer lines of JSON, one question at a time."""

from __future__ import annotations

import json
import os
import queue
import subprocess
import threading
from contextlib import suppress
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
PROGRAMS = {
    "ours": "ours.py",
    "exudyn": "exudyn_peer.py",
    "kratos": "kratos_peer.py",
    "mujoco": "rigid_peers.py",
    "pinocchio": "rigid_peers.py",
}
ONE_CORE = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
START = 120.0  # seconds that a program may take to be ready


class Asked:
    """A program in a process of its own, on one core; started when it is asked first."""

    def __init__(self, code: str, python: Path, limit: float) -> None:
        self.code = code
        self._command = [str(python), str(HERE / PROGRAMS[code])]
        self._limit = limit
        self._process: subprocess.Popen[str] | None = None
        self._lines: queue.Queue[str | None] = queue.Queue()
        self._reader: threading.Thread | None = None

    def ask(self, request: dict[str, Any]) -> dict[str, Any]:
        """Its answer; ``failed`` says why there is none."""
        if self._process is None:
            started = self._start()
            if "failed" in started:
                return started
        assert self._process is not None and self._process.stdin is not None
        try:
            self._process.stdin.write(json.dumps(request) + "\n")
            self._process.stdin.flush()
        except OSError:
            self.stop()
            return {"failed": f"{self.code} has ended"}
        return self._answer(self._limit)

    def stop(self) -> None:
        """End the process, if there is one."""
        if self._process is None:
            return
        self._process.kill()
        if self._reader is not None:
            self._reader.join()
        with suppress(OSError):  # a question that was not read
            self._process.communicate()
        self._process = None

    def _start(self) -> dict[str, Any]:
        self._lines = queue.Queue()
        self._process = subprocess.Popen(
            self._command,
            env={**os.environ, **ONE_CORE},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        self._reader = threading.Thread(
            target=_read, args=(self._process, self._lines), daemon=True
        )
        self._reader.start()
        return self._answer(START)

    def _answer(self, limit: float) -> dict[str, Any]:
        """The next line that is a record: programs may say other things."""
        while True:
            try:
                line = self._lines.get(timeout=limit)
            except queue.Empty:
                self.stop()
                return {"failed": f"no answer within {limit:g} s"}
            if line is None:
                self.stop()
                return {"failed": f"{self.code} has ended"}
            if line.startswith("{"):
                answer: dict[str, Any] = json.loads(line)
                return answer


def _read(process: subprocess.Popen[str], lines: queue.Queue[str | None]) -> None:
    """Hand lines on until the process ends."""
    assert process.stdout is not None
    for line in process.stdout:
        lines.put(line)
    lines.put(None)
