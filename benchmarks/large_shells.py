"""A large shell on a mesh of DOLFINx that is distributed: memory and seconds of its equilibrium.

A square plate, clamped along one side, under a uniform load so small that it is linear. The mesh is
DOLFINx's, distributed among all ranks before the shell takes it. The most memory that all ranks
have together is printed, beyond interpreters that have solved a small plate, and that of the rank
that has the most.

    tools/run mpirun --oversubscribe -n 8 python3 -m benchmarks.large_shells --cells 500
"""

from __future__ import annotations

import argparse
import logging
import time

from mpi4py import MPI

import basix.ufl
import dolfinx
import numpy as np

import fem_lie as fl
from benchmarks.large_nets import peak

THICKNESS, LOAD = 0.01, 1e-3


def plate(cells: int) -> dolfinx.mesh.Mesh:
    """Quadrilaterals of the unit square in space, distributed among all ranks."""
    comm = MPI.COMM_WORLD
    side = np.linspace(0.0, 1.0, cells + 1)
    points, corners = np.empty((0, 3)), np.empty((0, 4), dtype=np.int64)
    if comm.rank == 0:
        x, y = np.meshgrid(side, side, indexing="ij")
        points = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
        first = np.add.outer((cells + 1) * np.arange(cells), np.arange(cells)).ravel()
        corners = first[:, np.newaxis] + [0, 1, cells + 1, cells + 2]
    element = basix.ufl.element("Lagrange", "quadrilateral", 1, shape=(3,))
    return dolfinx.mesh.create_mesh(comm, cells=corners, x=points, e=element)


def solve(cells: int) -> tuple[float, int, float]:
    """Deflection of a corner over that of a cantilever strip, unknowns, and seconds."""
    mesh = plate(cells)
    root = dolfinx.mesh.locate_entities_boundary(mesh, 1, lambda x: x[0] < 1e-9)
    tags = dolfinx.mesh.meshtags(mesh, 1, np.sort(root), np.ones(len(root), dtype=np.int32))
    began = time.perf_counter()
    surface = fl.mesh.surface_from_dolfinx(mesh, facet_tags=tags, curves={"root": 1})
    steel = fl.Material(E=2.1e11, nu=0.0, density=7800.0)
    shell = fl.Shell(surface, fl.ShellSection.layer(THICKNESS, steel))
    shell.clamp("root")
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.AreaLoad(shell, (0, 0, LOAD)))
    found = fl.statics(scene)
    tip = found.displacement(shell.point((1.0, 0.5, 0.0)))[-1, 2]
    expected = LOAD / (8.0 * steel.E * THICKNESS**3 / 12.0)
    return float(tip / expected), 6 * len(shell.frames), time.perf_counter() - began


def main() -> None:
    """Measure one plate."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cells", type=int, default=100)
    parser.add_argument("--log", action="store_true", help="what each rank has")
    given = parser.parse_args()
    if given.log:
        logging.basicConfig(format="%(message)s")
        logging.getLogger("fem_lie").setLevel(logging.INFO)
    solve(10)
    world, begin = MPI.COMM_WORLD, peak()
    ratio, unknowns, seconds = solve(given.cells)
    grown = world.gather(peak() - begin)
    if world.rank == 0:
        print(f"{unknowns} unknowns on {world.size} ranks: {seconds:.1f} s")
        print(f"{sum(grown) / 2**30:.2f} GB of all ranks, {max(grown) / 2**30:.2f} GB of one")
        print(f"deflection over that of a strip: {ratio:.6f}")


if __name__ == "__main__":
    main()
