"""Seconds of each package for factors and solutions of the matrices of many scenes, and the choice.

    python3 -m benchmarks.packages [largest number of unknowns]

Matrices are those of a step in time. The table of ``fem_lie/linear/choice.py`` rests on this one.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

import numpy as np

import fem_lie as fl
from benchmarks.everyday_rows.solvers import cube, mount, pantograph
from benchmarks.scale import chain, weave
from fem_lie.linear.choice import DISSECTION, MINIMUM_DEGREE, Graph, Solutions, choose
from fem_lie.linear.direct import DirectSolver
from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.linear.packages import Method
from fem_lie.system.equations import Equations, Plan, TimeState

WAYS = [("cholesky", "cholmod"), ("cholesky", "mumps")]
WAYS += [("lu", name) for name in ("mumps", "umfpack", "klu")]
MASS, DAMPING = 1e6, 1e3  # of a step of a millisecond
SLOW = 3e9  # operations from which on KLU is left out


def plate(cells: int) -> fl.Scene:
    """A clamped square."""
    scene = fl.Scene()
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (cells, cells))
    material = fl.Material(2.1e11, 0.3, 7850.0)
    shell = scene.add(fl.Shell(mesh, fl.ShellSection.layer(0.01, material)))
    for node in shell.points("a=0"):
        scene.add(fl.Clamp(node))
    return scene


SCENES: list[tuple[str, Callable[[], fl.Scene]]] = [
    *((f"chain of {n} rods", lambda n=n: chain(n)) for n in (2, 20, 200)),
    *((f"weave of {n} rods", lambda n=n: weave(n)) for n in (20, 200)),
    *((f"pantograph {n}×{n // 2}", lambda n=n: pantograph(n, n // 2)) for n in (16, 48)),
    *((f"plate {n}²", lambda n=n: plate(n)) for n in (4, 10, 20, 50)),
    *((f"cube {n}³", lambda n=n: cube(n)) for n in (2, 4, 8, 12)),
    ("rubber mount", lambda: mount(attached=False)),
    ("rubber mount, attached", lambda: mount(attached=True)),
]


def timed(solver: DirectSolver) -> tuple[float, float]:
    """Least processor seconds of a factorisation and of a solution."""
    factors, solutions = [], []
    for _ in range(3):
        began = time.process_time()
        solver.factorise()
        factors.append(time.process_time() - began)
        solver.right_hand_side[:] = 1.0
        solver.solve()
        began = time.process_time()
        solver.solve()
        solutions.append(time.process_time() - began)
    return min(factors), min(solutions)


def row(name: str, scene: fl.Scene, largest: float) -> str | None:
    """Of the table; ``None`` where there are more unknowns."""
    equations = Equations(scene, dynamics=True)
    unknowns, matrix = equations.unknowns, equations.matrix
    still = np.zeros((unknowns.moving, 6))
    frames, v = equations.start[:2]
    now = TimeState(frames.copy(), v.copy(), np.zeros_like(v), np.zeros(unknowns.m))
    equations.fill(now, None, Plan(still, np.ones(unknowns.m), mass=MASS, damping=DAMPING))
    graph = Graph.of(matrix.indptr, matrix.indices, matrix.incidences, matrix.held)
    if graph.unknowns > largest:
        return None
    costs = [graph.cost(ordering) for ordering in (MINIMUM_DEGREE, DISSECTION)]
    cells = []
    for kind, package in WAYS:
        if package == "klu" and costs[0].operations > SLOW:
            cells.append("")
            continue
        solver = DirectSolver(matrix, "packages_", [Method(kind, package)])
        try:
            factor, solution = timed(solver)
        except SingularMatrixError:
            cells.append("")
            continue
        taken = solver._methods[0] == Method(kind, package)
        cells.append(f"{1e3 * factor:.3g}, {1e3 * solution:.3g}" if taken else "")
    chosen = [choose(matrix, "packages_", s).methods[0].package for s in Solutions]
    operations = ", ".join(f"{cost.operations:.1e}" for cost in costs)
    head = f"{name} | {graph.unknowns} | {graph.constraints} | {operations}"
    return f"| {head} | {' | '.join(cells)} | {', '.join(chosen)} |"


def main() -> None:
    """Print the table."""
    largest = float(sys.argv[1]) if len(sys.argv) > 1 else np.inf
    print("| scene | unknowns | constraints | operations: degree, dissection | ", end="")
    print(" | ".join(f"{package} {kind}" for kind, package in WAYS), end="")
    print(" | chosen for few, for many |\n|---|---|---|---|---|---|---|---|---|---|", flush=True)
    for name, scene in SCENES:
        found = row(name, scene(), largest)
        if found:
            print(found, flush=True)


if __name__ == "__main__":
    main()
