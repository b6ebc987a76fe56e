"""Steps with the symmetric part of the iteration matrix, compared with those with all of it.

    RUN -m benchmarks.symmetric_matrix [--cells 64] [--meshes 48] [--steps 40] [--rounds 3]

A plate of rubber falls from a clamp, another one tumbles freely, and a net of beams, connected
rigidly where they cross, falls from two corners: 48 meshes along a side, four cells each, have 10⁵
unknowns. Generalised-α, radius 0.8, ``Automatic``; both runs of a scene take turns. Processor
milliseconds of a factorisation, the least, and of a step, both without the start; memory of the
factors as that which the C library has in use after the first factorisation by the package of the
steps and not before;
iterations per step; ``apart`` is the largest distance of nodes at the end, over the size of the
scene. Ratios are those of ``DROPPED_IF_SMALL`` to ``KEPT``.
"""

from __future__ import annotations

import ctypes
from argparse import ArgumentParser
from collections.abc import Callable
from time import process_time
from typing import NamedTuple

import numpy as np

import fem_lie as fl
from fem_lie.linear.direct import DirectSolver
from fem_lie.linear.packages import Method
from fem_lie.schemes import SkewPart

RUBBER = fl.Material(E=1e7, nu=0.3, density=1000.0)
CORD = fl.Section.circle(0.005, fl.Material(E=1e9, nu=0.3, density=1000.0))


class InUse(ctypes.Structure):
    """Result of ``mallinfo2`` of the C library."""

    _fields_ = tuple(
        (name, ctypes.c_size_t)
        for name in "arena ordblks smblks hblks hblkhd usmblks fsmblks uordblks fordblks "
        "keepcost".split()
    )


def memory() -> float:
    """Memory that is allocated, MB."""
    read = ctypes.CDLL(None).mallinfo2
    read.restype = InUse
    found = read()
    return float(found.uordblks + found.hblkhd) / 2**20


class Row(NamedTuple):
    """Figures of one run.

    Attributes:
        package: Package of the last factorisation.
        factor: Least seconds of a factorisation.
        memory: Memory of the factors, MB.
        step: Seconds of a step.
        iterations: Iterations of a step.
        matrices: Factorisations.
        end: Positions of the nodes at the end, shape (n, 3).
    """

    package: str
    factor: float
    memory: float
    step: float
    iterations: float
    matrices: int
    end: np.ndarray


class Watch:
    """Times factorisations of all solvers, and finds the memory of the first."""

    def __init__(self) -> None:
        """Observe the method that factorises by one package."""
        self._plain = DirectSolver._failure
        self.clear()

        def observed(solver: DirectSolver, method: Method) -> Exception | None:
            name = f"{method.package} {method.kind}"
            if name != self.package:  # at rest the matrix is symmetric
                self.clear()
                self.package = name
            before, began = memory(), process_time()
            failure = self._plain(solver, method)
            self.seconds.append(process_time() - began)
            self.memory = max(self.memory, memory() - before)
            return failure

        DirectSolver._failure = observed  # type: ignore[method-assign]

    def clear(self) -> None:
        """Begin another run."""
        self.seconds: list[float] = []
        self.memory, self.package = 0.0, ""


def plate(cells: int) -> tuple[fl.Scene, fl.Shell]:
    """A square of rubber of 1 m by 1 cm."""
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (cells, cells))
    scene = fl.Scene(gravity=(0, 0, -9.81))
    return scene, scene.add(fl.Shell(mesh, fl.ShellSection.layer(0.01, RUBBER)))


def clamped(cells: int) -> fl.Scene:
    """A plate that falls from a clamped edge."""
    scene, shell = plate(cells)
    shell.clamp("a=0")
    return scene


def tumbling(cells: int) -> fl.Scene:
    """A plate in free flight."""
    scene, shell = plate(cells)
    shell.add_velocity(omega=(2, 1, 3), about=(0.5, 0.5, 0))
    return scene


def net(meshes: int) -> fl.Scene:
    """A net of beams with a side of 1 m, held at two corners; it sags by 2 cm from its plane."""
    side = 4 * meshes
    i, j = np.meshgrid(np.arange(side + 1), np.arange(side + 1), indexing="ij")
    on_line = (i % 4 == 0) | (j % 4 == 0)
    number = np.where(on_line, np.cumsum(on_line).reshape(on_line.shape) - 1, -1)
    a, b = i[on_line] / side, j[on_line] / side
    points = np.stack([a, b, 0.02 * np.sin(9 * a) * np.cos(7 * b)], axis=1)
    pairs = [
        np.stack([first, second], axis=-1).reshape(-1, 2)
        for first, second in (
            (number[:-1, ::4], number[1:, ::4]),
            (number[::4, :-1], number[::4, 1:]),
        )
    ]
    mesh = fl.mesh.LineMesh.from_cells(points, np.concatenate(pairs))
    scene = fl.Scene(gravity=(0, 0, -9.81))
    body = scene.add(fl.Beam(mesh, CORD))
    for corner in (number[0, 0], number[0, -1]):
        scene.add(fl.Clamp(body.point(int(corner))))
    return scene


def run(scene: fl.Scene, skew_part: SkewPart, steps: int, step: float, watch: Watch) -> Row:
    """Steps after the first one, which compiles, factorises and starts."""
    scheme = fl.GeneralisedAlpha(radius=0.8, skew_part=skew_part)
    watch.clear()
    result = scheme.run(scene, duration=steps * step, step=step, save_every=steps, progress=False)
    return Row(
        watch.package,
        min(watch.seconds),
        watch.memory,
        result.seconds / steps,
        float(result.iterations[-1]) / steps,
        result.k_updates,
        result.frames[-1, :, 0].copy(),
    )


def compared(
    name: str, make: Callable[[], fl.Scene], steps: int, step: float, rounds: int, watch: Watch
) -> str:
    """Lines of the table of a scene."""
    found: dict[SkewPart, list[Row]] = {choice: [] for choice in SkewPart}
    for _ in range(rounds):
        for choice, rows in found.items():
            rows.append(run(make(), choice, steps, step, watch))
    best = {
        choice: rows[-1]._replace(
            factor=min(row.factor for row in rows), step=min(row.step for row in rows)
        )
        for choice, rows in found.items()
    }
    lines = [
        f"| {name} | {choice.name} | {row.package} | {1e3 * row.factor:.3g} | {row.memory:.3g} | "
        f"{row.iterations:.2f} | {row.matrices} | {1e3 * row.step:.3g} | |"
        for choice, row in best.items()
    ]
    kept, dropped = best[SkewPart.KEPT], best[SkewPart.DROPPED_IF_SMALL]
    size = float(np.ptp(kept.end, axis=0).max())
    apart = float(np.abs(kept.end - dropped.end).max()) / size
    ratios = [
        getattr(dropped, each) / getattr(kept, each)
        for each in ("factor", "memory", "iterations", "step")
    ]
    factor, stored, iterations, whole = (f"{ratio:.2f}" for ratio in ratios)
    lines.append(f"| | ratio | | {factor} | {stored} | {iterations} | | {whole} | {apart:.0e} |")
    return "\n".join(lines)


def main() -> None:
    """Print the table."""
    parser = ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cells", type=int, default=64)
    parser.add_argument("--meshes", type=int, default=48)
    parser.add_argument("--steps", type=int, default=40)
    parser.add_argument("--rounds", type=int, default=3)
    given = parser.parse_args()
    watch = Watch()
    head = "scene", "skew part", "package", "factor, ms", "memory, MB", "iterations per step"
    print(f"| {' | '.join((*head, 'matrices', 'step, ms', 'apart'))} |\n|{'---|' * 9}")
    cells, meshes, how = given.cells, given.meshes, (given.steps, 2e-3, given.rounds, watch)
    print(compared(f"clamped plate, {cells}²", lambda: clamped(cells), *how), flush=True)
    print(compared(f"tumbling plate, {cells}²", lambda: tumbling(cells), *how), flush=True)
    print(compared(f"net of beams, {meshes}²", lambda: net(meshes), *how), flush=True)


if __name__ == "__main__":
    main()
