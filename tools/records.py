"""The numbers of all demos and studies, and whether two versions of the code give the same.

Each runs with its defaults, or ``--short`` where that takes long, without pictures, and writes
its record (``--json``) into a folder; two folders are compared number by number, but for times:
relative to their size, or to 1 where they are smaller. It runs the demos of the folder it is called
in, with the environment it is called with; ``tools/run`` is that of its own checkout.

    cd CHECKOUT && tools/run python3 tools/records.py make before
    python3 tools/records.py compare before after
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

DEMOS, STUDIES = Path("demos"), Path("studies")
HELPERS = (
    "__init__",
    "adaptive_problems",
    "antenna_cables",
    "antenna_numbers",
    "antenna_pictures",
    "antenna_scene",
    "any_shell",
    "command_line",
    "diagrams",
    "extrapolation",
    "goal_problems",
    "moving_meshes",
    "net_contacts",
    "net_passages",
    "net_scene",
    "records",
    "rigid",
    "shell_errors",
    "soft_bars",
    "truss_scene",
)
SHORT = {
    "bricard": "--duration 2",
    "compressed_cylinder": "--mesh 6 --ratios 100,200",
    "conservation_against_time": "--repeats 1 --steps 3",
    "cylinder_knock_down": "--ratios 100",
    "double_four_bar": "--duration 2",
    "flapping_plate": "--mesh 8 --periods 0.5",
    "governor": "--duration 2",
    "hoop_antenna": "--elements 2 --cells 4 --step 2e-2",
    "laminate": "--cells 16",
    "semi_cylinder": "--mesh 20",
    "slider_crank": "--duration 1",
    "speed_against_error": "--repeats 1 --finest 64 --smallest-step 5e-4",
    "speed_against_error_shells": "--repeats 1 --finest 16",
    "thin_cylinder": "--mesh 6 --ratios 100,200",
    "truss_deployment": "--duration 2",
    "truss_policies": "--duration 1",
    "tumbling_plate": "--steps 2000",
}
"""Options of demos that take over a minute by default."""

TIMES = ("seconds", "ms_per_step", "_ms")
TOLERANCE = 1e-10


def demos() -> list[str]:
    """Names of all demos and studies."""
    files = (*DEMOS.glob("*.py"), *STUDIES.glob("*.py"))
    return sorted(file.stem for file in files if file.stem not in HELPERS)


def how(name: str) -> list[str]:
    """What Python is given to run a demo or study."""
    study = (STUDIES / f"{name}.py").exists()
    return ["-m", f"studies.{name}"] if study else [f"demos/{name}.py"]


def make(folder: Path, names: list[str], limit: float, *, short: bool) -> None:
    """Run demos one after the other; what fails or takes too long has no record."""
    folder.mkdir(parents=True, exist_ok=True)
    for name in names:
        record, start = folder.absolute() / f"{name}.json", time.perf_counter()
        options = SHORT.get(name, "").split() if short else []
        command = [sys.executable, *how(name), "--no-pictures", "--json", str(record)]
        command += options
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=limit)
            said = "" if done.returncode == 0 else done.stderr.strip().splitlines()[-1:]
        except subprocess.TimeoutExpired:
            said = f"not done in {limit:g} s"
        print(f"{name:28} {time.perf_counter() - start:7.1f} s  {said}", flush=True)


def numbers(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """All that is no mapping and no list, with its place."""
    items: Any = ()
    if isinstance(value, dict):
        items = value.items()
    elif isinstance(value, list):
        items = enumerate(value)
    else:
        yield path, value
    for key, inner in items:
        yield from numbers(inner, f"{path}/{key}")


def compare(before: Path, after: Path) -> None:
    """Print what differs by more than the tolerance, and what is in one folder only."""
    names = sorted({file.name for folder in (before, after) for file in folder.glob("*.json")})
    compared = differ = 0
    for name in names:
        if not all((folder / name).exists() for folder in (before, after)):
            print(f"{name}: in one folder only")
            continue
        old, new = (dict(numbers(json.loads((f / name).read_text()))) for f in (before, after))
        for path in sorted(set(old) | set(new)):
            if any(word in path for word in TIMES):
                continue
            compared += 1
            one, other = old.get(path), new.get(path)
            if not _same(one, other):
                differ += 1
                print(f"{name}{path}: {one!r} -> {other!r}")
    print(f"{compared} numbers of {len(names)} demos compared, {differ} differ by over {TOLERANCE}")


def _same(one: Any, other: Any) -> bool:
    """Whether two numbers agree, relative to the larger or, below 1, to 1."""
    if isinstance(one, float | int) and isinstance(other, float | int):
        same = one == other or (one != one and other != other)  # or none in both
        return same or abs(one - other) <= TOLERANCE * max(abs(one), abs(other), 1.0)
    return bool(one == other)


def main() -> None:
    """Make or compare."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    tasks = parser.add_subparsers(dest="task", required=True)
    task = tasks.add_parser("make")
    task.add_argument("folder", type=Path)
    task.add_argument("--demo", action="append", choices=demos(), help="default: all")
    task.add_argument("--limit", type=float, default=600.0, help="seconds for each")
    task.add_argument("--short", action="store_true", help="less of demos that take long")
    task = tasks.add_parser("compare")
    task.add_argument("before", type=Path)
    task.add_argument("after", type=Path)
    given = parser.parse_args()
    if given.task == "make":
        make(given.folder, given.demo or demos(), given.limit, short=given.short)
    else:
        compare(given.before, given.after)


if __name__ == "__main__":
    main()
