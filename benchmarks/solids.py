"""Cost of solids, and savings by co-rotated nodal axes: the tables of docs/measured/solids.md.

    python3 -m benchmarks.solids tumbling [--steps 10000]
    python3 -m benchmarks.solids residual
    python3 -m benchmarks.solids tetrahedra

tumbling: a brick of neo-Hooke tumbles at 6 rad/s and falls, in axes that follow it and in fixed
ones: matrices, iterations, energy, and how far apart both end. residual: forces of one cell.
tetrahedra: Cook's membrane with small strains by tetrahedra of degree 1, over degree 2.
Seconds are those of the processor, of several runs the least.
"""

from __future__ import annotations

import argparse
import logging
from time import process_time

import numpy as np

import fem_lie as fl
from demos.cooks_membrane import position

STEP, LAW = 1e-3, fl.sections.NeoHooke(1e4, 0.3, 1.0)
BRICKS = {1: (4, 3, 2), 2: (2, 2, 1)}
"""Cells for each degree."""
SIZE, TURNS, CELLS = (1.0, 0.4, 0.2), 5, 16
SMALL = 1e-5


# --- tumbling -------------------------------------------------------------------------------------


def tumble(degree: int, steps: int, components: fl.schemes.MatrixFrame) -> tuple[fl.Result, float]:
    """A run and its seconds, without compilation."""
    body = fl.Solid.brick(SIZE, LAW, cells=BRICKS[degree], degree=degree, name="brick")
    body.add_velocity(omega=(1.0, 6.0, 0.3), about=(0.5, 0.2, 0.1))
    body.add_velocity((1.0, 0.0, 0.0))
    scene = fl.Scene(gravity=(0.0, 0.0, -9.81))
    scene.add(body)
    scheme = fl.GeneralisedAlpha(radius=0.9, matrix_frame=components)
    scheme.run(scene, duration=2 * STEP, step=STEP)
    start = process_time()
    found = scheme.run(scene, duration=STEP * steps, step=STEP, save_every=max(1, steps // 1000))
    return found, process_time() - start


def tumbling(steps: int) -> None:
    """Both degrees, both sorts of axes."""
    print("| | axes | matrices | iterations | seconds | energy error | apart at the end |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for degree, cells in BRICKS.items():
        count = steps if degree == 1 else steps // 5
        runs = {
            "follow": tumble(degree, count, fl.schemes.MatrixFrame.LOCAL),
            "fixed": tumble(degree, count, fl.schemes.MatrixFrame.INERTIAL),
        }
        ends = [found.frames[-1, :, 0] for found, _ in runs.values()]
        apart = float(np.abs(ends[0] - ends[1]).max())
        for name, (found, seconds) in runs.items():
            print(
                f"| {cells}, degree {degree}, {count} steps | {name} | {found.factorisations} | "
                f"{int(found.iterations[-1])} | {seconds:.2f} | {found.energy_error:.1e} | "
                f"{apart:.1e} |",
                flush=True,
            )


# --- residual -------------------------------------------------------------------------------------


def residual(_: int) -> None:
    """Of each element, per cell and per node."""
    print("| | forces, µs per cell | µs per node |")
    print("| --- | --- | --- |")
    for cell in ("hexahedron", "tetrahedron"):
        for degree in (1, 2):
            count = 12 // degree
            body = fl.Solid.brick(
                (1.0, 1.0, 1.0), LAW, cells=(count,) * 3, cell=cell, degree=degree, name="block"
            )
            assembly = body.model.assemble([body.model])
            H, out = body.frames.copy(), np.zeros(6 * len(body.frames))
            H[:, 0] += 0.01 * np.sin(3.0 * H[:, 0, [2, 0, 1]])
            H[assembly.order] = H.copy()
            assembly.add_forces(H, out)
            times = []
            for _ in range(TURNS):
                start = process_time()
                for _ in range(10):
                    assembly.add_forces(H, out)
                times.append((process_time() - start) / 10)
            each = 1e6 * min(times)
            cells, nodes = len(body.model.connectivity), len(body.frames)
            what = f"{cell}, degree {degree}, {type(body.model.formulation).__name__}"
            print(f"| {what} | {each / cells:.2f} | {each / nodes:.2f} |", flush=True)


# --- tetrahedra -----------------------------------------------------------------------------------


def tetrahedra(_: int) -> None:
    """Rise of the corner for small loads, over that of degree 2."""
    logging.getLogger("fem_lie").setLevel(logging.ERROR)
    print("| Poisson's ratio | degree 1, 8 × 8 | 16 × 16 |")
    print("| --- | --- | --- |")
    for nu in (0.3, 0.4, 0.45, 0.475, 0.49, 0.499):
        wanted = rise(nu, 8, 2)
        shares = [f"{rise(nu, mesh, 1) / wanted:.2f}" for mesh in (8, 16)]
        print(f"| {nu} | {' | '.join(shares)} |", flush=True)


def rise(nu: float, mesh: int, degree: int) -> float:
    """In plane strain."""
    panel = fl.Solid(
        fl.mesh.parametric_volume(position, (mesh, mesh, 1), cell="tetrahedron"),
        fl.sections.SaintVenantKirchhoff(1.0, nu),
        degree=degree,
        formulation=fl.elements.Isoparametric(),
        name="panel",
    )
    panel.clamp("a=0")
    panel.model.held[:, 2] = True
    scene = fl.Scene()
    scene.add(panel)
    scene.add(fl.loads.FaceLoad(panel, "a=1", (0.0, SMALL / 16, 0.0)))
    return float(fl.statics(scene).displacement(panel.point("110"))[-1, 1])


TABLES = {"tumbling": tumbling, "residual": residual, "tetrahedra": tetrahedra}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("tables", nargs="*", default=list(TABLES), choices=[*TABLES, []])
    parser.add_argument("--steps", type=int, default=10_000)
    options = parser.parse_args()
    for table in options.tables:
        TABLES[table](options.steps)
        print()


if __name__ == "__main__":
    main()
