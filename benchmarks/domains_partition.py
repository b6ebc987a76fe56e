"""Unknowns on interfaces: our partition of cells and joints against PT-SCOTCH without weights.

    tools/run python3 -m benchmarks.domains_partition [--elements 2]

Ours is what the solver on subdomains has: cells at a joint are one vertex, vertices weigh their
unknowns and edges those that they share, SCOTCH. The other is PT-SCOTCH of DOLFINx: cells are
vertices and share an edge if they share a node or a joint, all weights are one. Joints whose nodes
then lie in several domains count by their multipliers. Prints for each scene of
:mod:`.domains_scenes` and number of domains: unknowns on the interface, of these joints that are
cut, and unknowns of the largest domain over the mean, for both.
"""

from __future__ import annotations

import argparse

from mpi4py import MPI

import dolfinx
import numpy as np
import scipy.sparse as sp

from benchmarks.domains_scenes import SCENES
from fem_lie.linear.domains.division import Links
from fem_lie.system.domains import all_cells, sums_of
from fem_lie.system.equations import Equations

SIZES = {"shell": 32, "beams": 16, "cables": 16}


def plain(cells: sp.csr_matrix, joints: sp.csr_matrix, count: int) -> np.ndarray:
    """Domain of each cell, by PT-SCOTCH."""
    linked = joints @ cells.T
    graph = (cells @ cells.T + linked.T @ linked).tocsr()
    graph.setdiag(0)
    graph.eliminate_zeros()
    columns, pointers = graph.indices.astype(np.int64), graph.indptr.astype(np.int32)
    given = dolfinx.graph.adjacencylist(columns, pointers)
    divide = dolfinx.cpp.graph.partitioner_scotch()
    found = divide(MPI.COMM_SELF, count, getattr(given, "_cpp_object", given), False)
    return np.asarray(found.array).astype(np.int64)


def counted(
    part: np.ndarray, cells: sp.csr_matrix, joints: sp.csr_matrix, free: np.ndarray
) -> tuple[int, int, float]:
    """Unknowns on the interface, those of joints that are cut, the largest domain over the mean."""
    count = part.max() + 1
    of_cells = sp.csr_matrix((np.ones(len(part)), (np.arange(len(part)), part)))
    nodes = (cells.T @ of_cells).toarray() > 0
    within = (joints @ nodes.astype(int)) == np.asarray(joints.sum(axis=1))
    cut = int((~within.any(axis=1)).sum())
    sizes = free @ nodes
    shared = int(free[nodes.sum(axis=1) > 1].sum())
    return shared + cut, cut, float(sizes.max() / sizes.sum() * count)


def rows(name: str, size: int) -> None:
    """Print those of a scene."""
    equations = Equations(SCENES[name](size, False).scene, dynamics=True)
    kkt, tangent = equations.matrix, equations.system.tangent
    n, free = len(kkt.held), (~kkt.held).sum(axis=1)
    incidences = kkt.incidences
    joints = Links(incidences.rows, incidences.nodes, len(incidences.ptr) - 1).matrix(n)
    cells = all_cells(sums_of(equations.system.terms), n).matrix(n)
    for count in (4, 8, 16, 32):
        ours = counted(tangent.division(count).cells, cells, joints, free)
        other = counted(plain(cells, joints, count), cells, joints, free)
        counts = [f"{a} | {b} | {c:.2f}" for a, b, c in (ours, other)]
        print(f"| {name} | {int(free.sum())} | {count} | {counts[0]} | {counts[1]} |", flush=True)


def main() -> None:
    """Print all."""
    asking = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    asking.add_argument("--elements", type=int, default=2, help="of the antenna's bars")
    asked = asking.parse_args()
    for name, size in (SIZES | {"ring": asked.elements, "antenna": asked.elements}).items():
        rows(name, size)


if __name__ == "__main__":
    main()
