"""Scenes of the library on subdomains, one on each rank: iterations of BDDC and of FETI-DP.

    tools/run mpirun --oversubscribe -n 4 python3 -m benchmarks.domains_scenes NAME …

A name is made of a scene, of *step* (two steps in time) or *static* (one load step), a size, and
how it is solved, *bddc* (deluxe scaling, adaptive primal unknowns), *plain* (BDDC as it comes) or
*fetidp*: ``shell-step-16-bddc``. A size as it is is that of all (the side of
a square, in cells or meshes), with *each* before it that of a subdomain. Scenes:

- *shell*, *thick*, *cylinder*: steel, a square of 1 m, thickness 0.01, 0.1 and 0.01 of that,
  flat or bent by 2 rad; clamped along an edge in statics, free in time and thrown.
- *beams*: a net of steel bars, meshes of 0.25 m, six elements in each bar, rigidly joined.
- *cables*: a net of cables, meshes of 0.25 m, eight elements in each, hung up at its corners in
  statics by its edges, and prestressed.
- *antenna*: that of ``demos/hoop_antenna.py``, all 30 bays, size elements in each bar and twice as
  many in each cable; *ring*: the same without nets.

A row of a table in Markdown is printed for each: subdomains, name, unknowns (multipliers
included), those on interfaces,
primal ones, times that the preconditioner was made, iterations per solution and the most of any,
seconds of the processor of making it and of solving, and memory that all ranks have together in
megabytes beyond what they had before. ``fails`` says which solutions had to be left to a direct
solver.
"""

from __future__ import annotations

import argparse
import logging
import re
import sys
from collections.abc import Callable
from pathlib import Path
from time import process_time
from typing import NamedTuple

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

import fem_lie as fl
from benchmarks.domains import coarse, megabytes
from fem_lie.linear.domains.interface import THRESHOLD, Interface

sys.path.insert(0, str(Path(__file__).parents[1] / "demos"))

STEEL = fl.Material(E=2.1e11, nu=0.3, density=7850.0)
BAR, CABLE = fl.Section.circle(0.01, STEEL), fl.Section.circle(1e-3, STEEL)
MESH, STRETCH, STEPS, ELEMENTS, CELLS = 0.25, 1.001, 2, 6, 8
PREFIXES = "fem_lie_statics_", "fem_lie_dynamics_"


class Built(NamedTuple):
    """A scene, and its step in time."""

    scene: fl.Scene
    step: float


def square(n: int, thickness: float, static: bool, radius: float = np.inf) -> Built:
    """A shell of ``n`` by ``n`` cells."""

    def position(a: float, b: float) -> tuple[float, float, float]:
        if np.isinf(radius):
            return (a, b, 0.0)
        return (radius * np.sin(a / radius), b, radius * (1.0 - np.cos(a / radius)))

    shell = fl.Shell(
        fl.mesh.parametric_surface(position, (n, n)), fl.ShellSection.layer(thickness, STEEL)
    )
    scene = fl.Scene()
    if static:
        shell.clamp("a=0")
        scene.add(shell)
        force = STEEL.E * thickness**3 * 1e-2
        scene.add(fl.PointLoad(shell.point("11"), force=(0.0, 0.2 * force, force)))
    else:
        x = shell.frames[:, 0]
        bends = np.stack([0 * x[:, 0], 0 * x[:, 0], np.sin(2 * np.pi * x[:, 1])], axis=1)
        shell.velocities[:, :3] = np.einsum("nij,nj->ni", shell.frames[:, 1:], bends)
        scene.add(shell)
    return Built(scene, 1e-3)


def lattice(meshes: int, parts: int) -> tuple[np.ndarray, list[np.ndarray], np.ndarray]:
    """Points, cables and corners of a square net."""
    count, knots = meshes * parts + 1, np.arange(meshes + 1) * parts
    on_line = np.zeros((count, count), dtype=bool)
    on_line[knots], on_line[:, knots] = True, True
    numbers = np.full((count, count), -1, dtype=np.int64)
    numbers[on_line] = np.arange(on_line.sum())
    i, j = np.nonzero(on_line)
    points = MESH / parts * np.stack([i, j, 0 * i], axis=1).astype(float)
    lines = [numbers[k] for k in knots] + [numbers[:, k] for k in knots]
    return points, lines, numbers[np.ix_(knots, knots)]


def beams(n: int, static: bool) -> Built:
    """A net of ``n`` by ``n`` meshes of bars."""
    points, lines, knots = lattice(n, ELEMENTS)
    cells = np.concatenate([np.stack([line[:-1], line[1:]], axis=1) for line in lines])
    tangents = points[cells[:, 1]] - points[cells[:, 0]]
    tangents /= np.linalg.norm(tangents, axis=1)[:, np.newaxis]
    mesh = fl.mesh.LineMesh(points, cells, np.stack([tangents, tangents], axis=1))
    body = fl.Beam(mesh, BAR, up=(0, 0, 1), name="net")
    scene = fl.Scene()
    scene.add(body)
    if static:
        for knot in knots[0]:
            scene.add(fl.Clamp(body.point(int(knot))))
        scene.add(fl.PointLoad(body.point(int(knots[-1, -1])), force=(0.0, 0.0, 1.0)))
    else:
        thrown(body)
    return Built(scene, 1e-3)


def cables(n: int, static: bool) -> Built:
    """A net of ``n`` by ``n`` meshes of cables, prestressed and held along its edge."""
    points, lines, knots = lattice(n, CELLS)
    body = fl.Net(points, lines, CABLE, stretch=STRETCH)
    edge = np.unique([*knots[[0, -1]].ravel(), *knots[:, [0, -1]].ravel()])
    body.pin(*(body.point(int(k)) for k in edge))
    scene = fl.Scene()
    if static:
        scene.add(body)
        scene.add(fl.PointLoad(body.point(int(knots[n // 2, n // 2])), force=(0.0, 0.0, 1.0)))
    else:
        thrown(body)
        body.velocities[edge] = 0.0
        scene.add(body)
    return Built(scene, 1e-4)


def thrown(body: fl.Beam | fl.Net) -> None:
    """Bent by its velocities."""
    x = body.frames[:, 0]
    length = np.ptp(x[:, 0])
    up = np.sin(np.pi * x[:, 0] / length) * np.sin(np.pi * x[:, 1] / length)
    v = np.stack([0 * up, 0 * up, up], axis=1)
    body.velocities[:, :3] = np.einsum("nij,nj->ni", body.frames[:, 1:], v)


def antenna(elements: int, *, nets: bool) -> Built:
    """All 30 bays, which begin to fold."""
    from antenna_scene import Antenna

    made = Antenna(30, 30, 20.0 if nets else 4.0, elements, 2 * elements * nets, 1e-3)
    return Built(made.scene, 2e-2)


SCENES: dict[str, Callable[[int, bool], Built]] = {
    "shell": lambda n, static: square(n, 0.01, static),
    "thick": lambda n, static: square(n, 0.1, static),
    "thin": lambda n, static: square(n, 0.001, static),
    "cylinder": lambda n, static: square(n, 0.01, static, 0.5),
    "beams": beams,
    "cables": cables,
    "antenna": lambda n, static: antenna(n, nets=True),
    "ring": lambda n, static: antenna(n, nets=False),
}

WAYS = {"bddc": ("bddc", ""), "plain": ("bddc", "interface_"), "fetidp": ("fetidp", "")}


def choose(way: str) -> None:
    """Set PETSc's options."""
    name, plain = WAYS[way]
    for prefix in PREFIXES:
        PETSc.Options(prefix)["domains"] = name
        options = PETSc.Options(f"{prefix}interface_")
        options["pc_bddc_use_deluxe_scaling"] = not plain
        options["pc_bddc_adaptive_threshold"] = 0.0 if plain else ASKED.threshold
        if name == "fetidp":
            inner = PETSc.Options(f"{prefix}interface_fetidp_bddc_")
            inner["pc_bddc_adaptive_threshold"] = ASKED.threshold


class Watched(logging.Handler):
    """Counts of all solutions, from the log."""

    def __init__(self) -> None:
        super().__init__(logging.DEBUG)
        self.counts: list[int] = []
        self.failed = 0
        self.coarse: set[str] = set()
        self.seconds, self.unknowns = [0.0, 0.0], 0

    def emit(self, record: logging.LogRecord) -> None:
        """Note what a message says."""
        text = record.getMessage()
        if found := re.search(r"(\d+) iterations$", text):
            self.counts.append(int(found.group(1)))
        self.failed += "residual" in text or "cannot" in text


def timed(watch: Watched) -> None:
    """Add up the time of set-up and solutions, and note the size of the coarse problem."""
    made, applied = Interface.setUp, Interface.apply

    def set_up(self: Interface, pc: PETSc.PC) -> None:
        start = process_time()
        made(self, pc)
        watch.seconds[0] += process_time() - start
        watch.coarse.add(coarse(self.ksp))
        inside = MPI.COMM_WORLD.allreduce(len(self._part.inside))
        watch.unknowns = inside + self._part.size

    def apply(self: Interface, pc: PETSc.PC, b: PETSc.Vec, x: PETSc.Vec) -> None:
        start = process_time()
        applied(self, pc, b, x)
        watch.seconds[1] += process_time() - start

    Interface.setUp, Interface.apply = set_up, apply


def row(name: str, watch: Watched) -> str:
    """Of one name."""
    kind, load, size, way = name.split("-")
    world = MPI.COMM_WORLD
    n = int(size) if size.isdigit() else round(int(size[4:]) * np.sqrt(world.size))
    choose(way)
    watch.__init__()
    scene, step = SCENES[kind](n, load == "static")
    before = megabytes()
    try:
        if load == "static":
            result = fl.statics(scene)
        else:
            scheme = fl.GeneralisedAlpha(radius=0.0 if kind in ("antenna", "ring") else 0.8)
            result = scheme.run(scene, duration=STEPS * step, step=step, progress=False)
    except (fl.ConvergenceError, ArithmeticError) as error:
        return f"| {world.size} | {name} | fails: {str(error)[:80]} |"
    reported = result.subdomains
    assert reported is not None
    seconds = world.allreduce(np.array([*watch.seconds, megabytes() - before]))
    given = [world.size, name, watch.unknowns, reported.interface, "/".join(sorted(watch.coarse))]
    given += [reported.made, f"{reported.per_solution:.1f}", max(watch.counts, default=0)]
    given += [f"{seconds[0]:.1f}", f"{seconds[1]:.1f}", f"{seconds[2]:.0f}"]
    given.append(f"fails {watch.failed}" if watch.failed else "")
    return "| " + " | ".join(map(str, given)) + " |"


ASKED = argparse.Namespace(threshold=THRESHOLD)


def main() -> None:
    """Print rows."""
    asking = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    asking.add_argument("names", nargs="+")
    asking.add_argument("--threshold", type=float, default=THRESHOLD)
    asking.parse_args(namespace=ASKED)
    watch = Watched()
    timed(watch)
    for module in ("fem_lie.linear.domains.interface", "fem_lie.linear.direct"):
        log = logging.getLogger(module)
        log.addHandler(watch)
        log.setLevel(logging.DEBUG)
        log.propagate = False
    for name in ASKED.names:
        printed = row(name, watch)
        if MPI.COMM_WORLD.rank == 0:
            print(printed, flush=True)


if __name__ == "__main__":
    main()
