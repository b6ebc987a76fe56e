"""An X server for VTK where there is no display."""

from __future__ import annotations

import os
import select
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager

_START_SECONDS = 20.0
# If we are killed the server goes by itself, ten seconds after its last window.
_OPTIONS = ("-screen", "0", "64x64x24", "-nolisten", "tcp", "-terminate", "10")


@contextmanager
def display() -> Iterator[None]:
    """Run a virtual X server (Xvfb) for as long as this lasts, if ``DISPLAY`` is not set.

    Every window must be closed before the end.

    Raises:
        RuntimeError: There is no display, and Xvfb is not installed or does not start.
    """
    if os.environ.get("DISPLAY"):
        yield
        return
    server, number = _start()
    os.environ["DISPLAY"] = f":{number}"
    try:
        yield
    finally:
        os.environ.pop("DISPLAY", None)
        server.terminate()
        server.wait()


def _start() -> tuple[subprocess.Popen[bytes], str]:
    """The server, and the number of the display that it chose."""
    program = shutil.which("Xvfb")
    if program is None:
        raise RuntimeError(
            "pictures need a display: DISPLAY is not set, and Xvfb, which would stand in, is not "
            "installed (package xvfb)"
        )
    read, write = os.pipe()
    try:
        server = subprocess.Popen(
            [program, "-displayfd", str(write), *_OPTIONS],
            pass_fds=(write,),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            # Ctrl-C is for us alone: the server has to outlive our windows
            start_new_session=True,
        )
    finally:
        os.close(write)
    with os.fdopen(read, "rb") as answer:
        ready = select.select([answer], [], [], _START_SECONDS)[0]
        number = answer.readline().decode().strip() if ready else ""
    if not number:
        server.kill()
        server.wait()
        raise RuntimeError(f"pictures need a display, and {program} does not start; try it by hand")
    return server, number
