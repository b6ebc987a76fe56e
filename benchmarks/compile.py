"""What the first run of each scheme compiles: processor time, and the largest functions.

    python3 benchmarks/compile.py [scheme ...]

A scheme is generalised-alpha, energy-momentum or energy-decaying. Each runs ten steps of a rod on a
hinge with a rigid body at its end, in a process of its own that sees an empty folder of machine
code. The import of the package comes first; the forms of FFCx, which all share, in the first run
after it. Nothing below `XDG_CACHE_HOME` is touched.

Times are those of the processor, C compiler included. Of a function they are without what it calls,
for all of its types, entrances from Python included. What other scenes need on top (shells,
contacts, loads that follow, steps that change) is not here.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path
from time import process_time
from typing import TYPE_CHECKING, Any

from numba.core import event

if TYPE_CHECKING:
    import fem_lie as fl

LARGEST = 10
IMPORT = "import"
SCHEMES = {
    "generalised-alpha": "GeneralisedAlpha",
    "energy-momentum": "EnergyMomentum",
    "energy-decaying": "EnergyDecaying",
}


class Compilations(event.Listener):
    """Processor time of each function that numba compiles.

    Attributes:
        own: Seconds of each function without those that it calls.
        types: For how many argument types each was compiled.
    """

    def __init__(self) -> None:
        """Nothing was compiled yet."""
        self.own: Counter[str] = Counter()
        self.types: Counter[str] = Counter()
        self._open: list[tuple[str, float, float]] = []

    def on_start(self, event: Any) -> None:
        """A function begins, for itself or for another one."""
        function = event.data["dispatcher"].py_func
        name = f"{function.__module__}.{function.__qualname__}"
        self._open.append((name, process_time(), sum(self.own.values())))

    def on_end(self, event: Any) -> None:
        """It is done; what it called has been added meanwhile."""
        name, begin, before = self._open.pop()
        self.own[name] += process_time() - begin - (sum(self.own.values()) - before)
        self.types[name] += 1


class Compiler(event.Listener):
    """Processor time of the compiler at all that it does, callbacks for C included.

    Attributes:
        seconds: So far.
    """

    def __init__(self) -> None:
        """It has done nothing yet."""
        self.seconds, self._depth, self._begin = 0.0, 0, 0.0

    def on_start(self, event: Any) -> None:
        """It begins, or goes deeper."""
        if self._depth == 0:
            self._begin = process_time()
        self._depth += 1

    def on_end(self, event: Any) -> None:
        """It comes back."""
        self._depth -= 1
        if self._depth == 0:
            self.seconds += process_time() - self._begin


def scene() -> fl.Scene:
    """A rod that swings on a hinge, with a rigid body at its end."""
    import fem_lie as fl

    scene = fl.Scene(gravity=(0, 0, -9.81))
    steel = fl.Material(E=2e11, nu=0.3, density=7800.0)
    section = fl.Section.rectangle(0.01, 0.01, steel)
    rod = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=4))
    body = scene.add(fl.RigidBody(1.0, (0.01, 0.02, 0.02), (1, 0, 0)))
    scene.add(fl.joints.Revolute(fl.ground(), rod.point("start"), axis=(0, 1, 0)))
    scene.add(fl.joints.Fixed(rod.point("end"), body.point("centre")))
    return scene


def measure(name: str) -> None:
    """Import the package or run a scheme, and print what was compiled for it."""
    functions, compiler = Compilations(), Compiler()
    event.register("numba:compile", functions)
    event.register("numba:compiler_lock", compiler)
    import fem_lie as fl

    if name != IMPORT:
        getattr(fl, SCHEMES[name])().run(scene(), duration=0.01, step=1e-3)
    rest = sum(os.times()[:4]) - compiler.seconds
    print(
        f"{name}: machine code {compiler.seconds:.1f} s, {len(functions.own)} functions, "
        f"{sum(functions.types.values())} sets of types; all else {rest:.1f} s",
        flush=True,
    )
    for function, seconds in functions.own.most_common(LARGEST if name != IMPORT else 0):
        print(f"  {seconds:6.2f} s  {functions.types[function]:2} types  {function}")


def main(*wanted: str) -> None:
    """Measure the import, then each scheme, each in a fresh process without machine code."""
    if unknown := set(wanted) - set(SCHEMES):
        raise SystemExit(f"scheme must be {', '.join(SCHEMES)}, got {', '.join(sorted(unknown))}")
    with tempfile.TemporaryDirectory() as folder:
        forms = Path(folder) / "fenics"
        forms.mkdir()
        for name in (IMPORT, *(wanted or SCHEMES)):
            caches = Path(folder) / name
            caches.mkdir()
            (caches / forms.name).symlink_to(forms)
            environment = os.environ | {"XDG_CACHE_HOME": str(caches)}
            subprocess.run(
                [sys.executable, __file__, "--measure", name], env=environment, check=True
            )


if __name__ == "__main__":
    if sys.argv[1:2] == ["--measure"]:
        measure(sys.argv[2])
    else:
        main(*sys.argv[1:])
