"""What `import fem_lie` costs beyond DOLFINx, and what the first names of a script cost.

    python3 benchmarks/importing.py [--runs 5] [--without-bytecode]

Each row is a script that runs in processes of its own, after one that fills an empty cache of
bytecode, as an installed package has. `--without-bytecode` compiles all sources of the package in
each process, as Python does where `PYTHONDONTWRITEBYTECODE` is set and a checkout has no bytecode.
Seconds are the least ones of all runs, less those of the first row; the rows take turns, so that a
busy machine slows all of them. Modules are those that the row imports on top of the first row.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

DOLFINX = "import ufl, basix.ufl, ffcx, dolfinx, dolfinx.fem.petsc"
SCRIPTS = {
    DOLFINX: "",
    "import fem_lie as fl": "",
    "fl.Section": "fl.Section",
    "a scene with beams": "fl.Scene, fl.Beam, fl.Section, fl.Material, fl.Clamp",
    "… and statics": "fl.Scene, fl.Beam, fl.Section, fl.Material, fl.Clamp, fl.statics",
    "… and generalised-α": "fl.Scene, fl.Beam, fl.Section, fl.Material, fl.Clamp, "
    "fl.GeneralisedAlpha",
    "all names at the top": "[getattr(fl, name) for name in fl.__all__]",
}
"""What each script does after the imports, by the labels of the rows."""

REPORT = "import os, sys; t = os.times(); print(t.user + t.system, t.elapsed, len(sys.modules))"


class Cost(NamedTuple):
    """Cost of a script.

    Attributes:
        processor: Processor time in seconds.
        wall: Elapsed time in seconds.
        modules: Number of imported modules.
    """

    processor: float
    wall: float
    modules: int

    def __sub__(self, other: Cost) -> Cost:
        return Cost(*(a - b for a, b in zip(self, other, strict=True)))


def run(script: str, environment: dict[str, str]) -> Cost:
    """Run a script in a process of its own."""
    started = os.times().elapsed
    command = [sys.executable, "-c", f"{script}\n{REPORT}"]
    done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, text=True, check=True)
    processor, ended, modules = done.stdout.split()
    return Cost(float(processor), float(ended) - started, int(modules))


def least(costs: list[Cost]) -> Cost:
    """The least of each number."""
    return Cost(*(min(numbers) for numbers in zip(*costs, strict=True)))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=5, help="processes of each row")
    parser.add_argument("--without-bytecode", action="store_true", help="compile in each process")
    given = parser.parse_args()
    root = Path(__file__).parents[1]
    paths = os.pathsep.join([str(root), *filter(None, [os.environ.get("PYTHONPATH")])])
    environment = os.environ | {"PYTHONPATH": paths}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    scripts = {
        label: DOLFINX if label == DOLFINX else f"{DOLFINX}\nimport fem_lie as fl\n{code}"
        for label, code in SCRIPTS.items()
    }
    costs: dict[str, list[Cost]] = {label: [] for label in scripts}
    with tempfile.TemporaryDirectory() as folder:
        if given.without_bytecode:
            environment["PYTHONDONTWRITEBYTECODE"] = "1"
        else:
            environment["PYTHONPYCACHEPREFIX"] = folder
            run("\n".join(scripts.values()), environment)
        for _ in range(given.runs):
            for label, script in scripts.items():
                costs[label].append(run(script, environment))
    base = least(costs[DOLFINX])
    print(f"{'':28} {'processor':>9} {'wall':>9} {'modules':>9}")
    for label in scripts:
        cost = least(costs[label])
        name = "DOLFINx" if label == DOLFINX else f"+ {label}"
        processor, wall, modules = cost if label == DOLFINX else cost - base
        print(f"{name:28} {processor:7.2f} s {wall:7.2f} s {modules:9}", flush=True)


if __name__ == "__main__":
    main()
