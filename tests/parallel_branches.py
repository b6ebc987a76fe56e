"""What test_branches.py asks of several ranks: ``mpirun -n 2 parallel_branches.py OUT``."""

import json
import sys
from pathlib import Path

from mpi4py import MPI

import dolfinx
import numpy as np
from own_meshes import mesh_of, own_mesh

import fem_lie as fl

SECTION = fl.Section.circle(0.1, fl.Material(1e6, 0.3, 1.0))


def lines(comm, arms: int, cells: int = 8) -> tuple[np.ndarray, np.ndarray]:
    """Lines that start at the origin; all of them are given on rank 0."""
    points, pairs = [(0.0, 0.0, 0.0)], []
    for arm in range(arms):
        angle = 2 * np.pi * arm / arms
        for k in range(cells):
            pairs.append((len(points) - 1 if k else 0, len(points)))
            points.append(((k + 1) * np.cos(angle), (k + 1) * np.sin(angle), 0.0))
    here = slice(None if comm.rank == 0 else 0)
    return np.array(points)[here], np.array(pairs, dtype=np.int64)[here]


def outcome(comm, make) -> str:
    """Number of vertices, or the error; the same on all ranks, or it says so."""
    try:
        found = str(make().topology.index_map(0).size_global)
    except ValueError as error:
        found = str(error)
    everywhere = comm.allgather(found)
    return found if len(set(everywhere)) == 1 else f"not the same: {everywhere}"


def of_dolfinx(comm, arms: int) -> dolfinx.mesh.Mesh:
    """A user's mesh, made as users make it."""
    mesh = own_mesh(*lines(comm, arms), "interval", comm)
    fl.NodalFrames(mesh)
    return mesh


def results(comm) -> dict:
    """Meshes of two and of three lines, ours and a user's."""
    return {
        f"{make.__name__} {arms}": outcome(comm, lambda make=make, arms=arms: make(comm, arms))
        for make in (ours, of_dolfinx)
        for arms in (2, 3)
    }


def ours(comm, arms: int) -> dolfinx.mesh.Mesh:
    """The library's mesh, which each rank has for itself."""
    points, cells = lines(MPI.COMM_SELF, arms)
    return mesh_of(fl.Net(points, cells.tolist(), SECTION))


if __name__ == "__main__":
    record = results(MPI.COMM_WORLD)
    if MPI.COMM_WORLD.rank == 0:
        Path(sys.argv[1]).write_text(json.dumps(record))
