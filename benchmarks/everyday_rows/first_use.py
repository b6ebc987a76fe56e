"""Processor time until the first result, import and C compiler included."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.everyday_rows.row import Outcome, Row, in_turns, processor_seconds

ROOT = Path(__file__).parents[2]
SCRIPT = Path(__file__).with_name("first_results.py")
SCENES = "statics of a beam", "statics of a shell", "generalised-α", "energy-momentum"
FROM_A_BARE_CLONE = 15.0  # seconds
OVER_WARM = 1.2


def seconds(scene: str, caches: Path) -> float:
    """Processor time of one process that computes the first result of a scene."""
    environment = {"XDG_CACHE_HOME": str(caches)}
    return processor_seconds([sys.executable, SCRIPT, scene], ROOT, environment)


@cache
def set_up() -> TemporaryDirectory[str]:
    """Caches after what ``tools/setup`` calls at its end."""
    caches = TemporaryDirectory()
    command = [sys.executable, "-m", "fem_lie", "--compile"]
    processor_seconds(command, ROOT, {"XDG_CACHE_HOME": caches.name})
    return caches


def no_sources(folder: str, names: list[str]) -> set[str]:
    """What of a checkout a wheel is not made of; the package has a folder ``results``, too."""
    return {".git", "results"} & set(names) if Path(folder) == ROOT else set()


@cache
def installed() -> TemporaryDirectory[str]:
    """A virtual environment with a wheel of this checkout, and a copy of the script."""
    folder = TemporaryDirectory()
    inside = Path(folder.name)
    shutil.copytree(ROOT, inside / "source", ignore=no_sources)
    shutil.copy(SCRIPT, inside)
    options = ["--quiet", "--no-deps", "--no-build-isolation", "--wheel-dir", "wheels"]
    for command in (
        [sys.executable, "-m", "pip", "wheel", *options, "./source"],
        [sys.executable, "-m", "venv", "--system-site-packages", "environment"],
        ["sh", "-c", "environment/bin/pip install --quiet --no-deps --no-index wheels/*.whl"],
    ):
        processor_seconds(command, inside, {"PYTHONPATH": ""})
    shutil.rmtree(inside / "source")
    return folder


def over_warm(first: Callable[[], float], warm: Callable[[], float]) -> Outcome:
    """A first run over one that finds all that it needs in the caches."""
    a, b = in_turns(first, warm)
    return Outcome(f"{a:.2f} s, {a / b:.2f} times", f"warm run, {b:.2f} s", a <= OVER_WARM * b)


def after_set_up(scene: str) -> Outcome:
    """The first run after the set-up, from a copy of its caches."""
    with TemporaryDirectory() as used:
        warm = Path(used, "warm")
        shutil.copytree(set_up().name, warm)
        seconds(scene, warm)

        def first() -> float:
            with TemporaryDirectory() as copy:
                shutil.copytree(set_up().name, copy, dirs_exist_ok=True)
                return seconds(scene, Path(copy))

        return over_warm(first, lambda: seconds(scene, warm))


def from_a_wheel(scene: str) -> Outcome:
    """The first run of an installed wheel, with empty caches."""
    folder = Path(installed().name)
    command = [folder / "environment" / "bin" / "python", folder / SCRIPT.name, scene]

    def run(caches: str) -> float:
        return processor_seconds(command, folder, {"PYTHONPATH": "", "XDG_CACHE_HOME": caches})

    def first() -> float:
        with TemporaryDirectory() as caches:
            return run(caches)

    with TemporaryDirectory() as warm:
        run(warm)
        return over_warm(first, lambda: run(warm))


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
    *(
        Row(f"first result after the set-up: {scene}", "≤ 1.2 times", partial(after_set_up, scene))
        for scene in SCENES
    ),
    *(
        Row(f"first result from a wheel: {scene}", "≤ 1.2 times", partial(from_a_wheel, scene))
        for scene in SCENES
    ),
    Row("first result of two processes with the same empty caches", "both arrive", both_arrive),
)
