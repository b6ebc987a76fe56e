"""What several ranks gain: the same scene on one and on two.

    python3 -m benchmarks.two_ranks --scene shell
    tools/run mpirun -n 2 python3 -m benchmarks.two_ranks --scene shell

Seconds of the search for equilibrium (shell: the pinched hemisphere of 128×128 cells; solid: a
block of 24³ bricks), of a step (net of 5e5 unknowns, truss of 32 cells), or of an analysis of
stability with set-up (vibrations, buckling, path of a plate), by the clock, on the first rank;
--size for others. Then processor seconds of that rank, with set-up, and what they went into:
factors, solutions that Python asks for, matrices, forces that it asks for, updates of the stress,
and steps, which are forces, corrections and the other solutions in compiled loops. What is left is
set-up, most of it.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from mpi4py import MPI

import fem_lie as fl
from fem_lie.linear.condensed.preconditioner import Condensed
from fem_lie.linear.direct import DirectSolver
from fem_lie.solve.alpha.step import loop
from fem_lie.system.equations import Equations
from fem_lie.system.equations.history_variables import HistoryVariables

sys.path.insert(0, str(Path(__file__).parents[1] / "demos"))


def shell(size: int) -> float:
    """Of ``size`` by ``size`` cells."""
    from demos.hemisphere import pinched, quarter

    fl.follow_loads(pinched(0.04, quarter(4)))
    return fl.follow_loads(pinched(0.04, quarter(size))).seconds


def solid(size: int) -> float:
    """A block of that many bricks along each edge, sheared by a load on its top."""
    fl.statics(_block(2))
    return fl.statics(_block(size)).seconds


def _block(size: int) -> fl.Scene:
    rubber = fl.sections.NeoHooke(E=1e6, nu=0.3, density=1000.0)
    block = fl.Solid.brick((1, 1, 1), rubber, cells=(size, size, size))
    block.clamp("c=0")
    scene = fl.Scene()
    scene.add(block)
    scene.add(fl.loads.FaceLoad(block, "c=1", (1e5, 0, 0)))
    return scene


def vibrations(size: int) -> float:
    """Ten modes of a clamped plate of ``size`` by ``size`` cells."""
    return _modes(lambda scene: fl.vibrations(scene, 10), size)


def buckling(size: int) -> float:
    """Four load factors of that plate, pressed in its plane."""
    return _modes(lambda scene: fl.buckling(scene, 4), size)


def path(size: int) -> float:
    """Ten steps of its path, pressed and pushed aside."""
    ends = fl.stability.PathEnds(steps=10)
    return _modes(lambda scene: fl.follow_path(scene, ends), size)


def _modes(solve: Callable[[fl.Scene], object], size: int) -> float:
    solve(_plate(4))
    began = time.perf_counter()
    solve(_plate(size))
    return time.perf_counter() - began


def _plate(size: int) -> fl.Scene:
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (size, size))
    steel = fl.Material(E=2.1e11, nu=0.3, density=7850.0)
    shell = fl.Shell(mesh, fl.ShellSection.layer(0.01, steel))
    shell.clamp("a=0")
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.loads.EdgeLoad(shell, "a=1", force=(-1e5, 0, 1e3)))
    return scene


def net(size: int) -> float:
    """Of ``size`` by ``size`` meshes; a step."""
    from demos.space_net import STEP, square_net

    return _step(square_net, size, STEP, 1)


def truss(size: int) -> float:
    """Of ``size`` cells of 28 bars with ten elements each; a step."""
    from demos.truss_scene import Truss

    steel = fl.Material(E=2.1e11, nu=0.3, density=7850.0)
    tube = fl.Section.tube(0.0275, 0.04, steel)
    return _step(
        lambda cells: Truss(cells, tube, 10, 4, fl.schemes.MatrixTerms()).scene, size, 2e-3, 1
    )


def _step(make: Callable[[int], fl.Scene], size: int, step: float, small: int) -> float:
    scheme, steps = fl.GeneralisedAlpha(radius=0.8), 5
    options = {"step": step, "save_every": steps, "progress": False}
    scheme.run(make(small), duration=step, step=step, save_every=1, progress=False)
    return scheme.run(make(size), duration=steps * step, **options).seconds / steps


class Clock:
    """Processor seconds of functions, without those of others among them that they call.

    Attributes:
        spent: By names.
    """

    def __init__(self) -> None:
        """None yet."""
        self.spent: dict[str, float] = {}
        self._open, self._since = ["rest"], time.process_time()

    def turn(self) -> None:
        """Book what has gone by since the last time."""
        now, name = time.process_time(), self._open[-1]
        self.spent[name] = self.spent.get(name, 0.0) + now - self._since
        self._since = now

    def watch(self, name: str, owner: Any, function: str) -> None:
        """Count a function under a name."""
        given = getattr(owner, function)

        def timed(*args: Any, **options: Any) -> Any:
            self.turn()
            self._open.append(name)
            try:
                return given(*args, **options)
            finally:
                self.turn()
                self._open.pop()

        setattr(owner, function, timed)


WATCHED = (
    ("factors", DirectSolver, "factorise"),
    ("solutions", DirectSolver, "solve"),
    ("solutions", Condensed, "apply"),
    ("matrices", Equations, "fill"),
    ("forces", Equations, "residual"),
    ("stress", HistoryVariables, "update_stress"),
)


SCENES: dict[str, tuple[Callable[[int], float], int]] = {
    "shell": (shell, 128),
    "solid": (solid, 24),
    "net": (net, 32),
    "truss": (truss, 32),
    "vibrations": (vibrations, 128),
    "buckling": (buckling, 128),
    "path": (path, 64),
}


def main() -> None:
    """Measure one scene."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scene", choices=SCENES, required=True)
    parser.add_argument("--size", type=int)
    given = parser.parse_args()
    run, usual = SCENES[given.scene]
    clock = Clock()
    for watched in WATCHED:
        clock.watch(*watched)
    clock.watch("steps", loop, "run")
    seconds = run(given.size or usual)
    clock.turn()
    world = MPI.COMM_WORLD
    if world.rank == 0:
        spent = {"all": sum(clock.spent.values())} | clock.spent
        cpu = ", ".join(f"{name} {value:.2f}" for name, value in spent.items())
        print(
            f"{given.scene} {given.size or usual}, ranks {world.size}: {seconds:.3f} s; cpu {cpu}"
        )


if __name__ == "__main__":
    main()
