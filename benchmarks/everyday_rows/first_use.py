"""Processor time until the first result, import and C compiler included."""

from __future__ import annotations

import os
import subprocess
import sys
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.everyday_rows.row import Outcome, Row, in_turns, processor_seconds

ROOT = Path(__file__).parents[2]
SCRIPT = Path(__file__).with_name("first_results.py")
SCENES = "statics of a beam", "statics of a shell", "generalised-α", "energy-momentum"
FROM_A_BARE_CLONE = 15.0  # seconds


def seconds(scene: str, caches: Path, folder: Path = ROOT) -> float:
    """Processor time of one process that computes the first result of a scene."""
    environment = {"XDG_CACHE_HOME": str(caches)}
    return processor_seconds([sys.executable, SCRIPT, scene], folder, environment)


def bare_clone(scene: str) -> Outcome:
    """Caches are empty; least of three, each with caches of its own."""

    def cold() -> float:
        with TemporaryDirectory() as caches:
            return seconds(scene, Path(caches))

    (least,) = in_turns(cold)
    return Outcome(f"{least:.1f} s", "", least <= FROM_A_BARE_CLONE)


def both_arrive() -> Outcome:
    """Two processes with the same empty caches, at the same time."""
    with TemporaryDirectory() as caches:
        command = [sys.executable, str(SCRIPT), SCENES[0]]
        environment = {**os.environ, "XDG_CACHE_HOME": caches}
        both = [subprocess.Popen(command, cwd=ROOT, env=environment) for _ in range(2)]
        statuses = [process.wait() for process in both]
    arrived = statuses.count(0)
    return Outcome(f"{arrived} of 2", "", arrived == 2)


ROWS = (
    *(
        Row(
            f"first result from a bare clone with empty caches: {scene}",
            f"≤ {FROM_A_BARE_CLONE:.0f} s",
            partial(bare_clone, scene),
        )
        for scene in SCENES
    ),
    Row("first result of two processes with the same empty caches", "both arrive", both_arrive),
)
