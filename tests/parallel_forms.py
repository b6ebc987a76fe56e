"""What test_kernel.py compares between numbers of ranks: ``mpirun -n 2 parallel_forms.py OUT``."""

import json
import sys
from pathlib import Path

from mpi4py import MPI

import models
import numpy as np
from dolfinx import fem, la
from models import Model

CASES = [
    models.director_beam_2_carried,
    models.geodesic_beam_nonlinear,
    models.hellinger_reissner,
    models.shell_quadrilaterals_2,
    models.shell_triangles,
]


def smooth(x: np.ndarray, phase: float) -> np.ndarray:
    """Increments that depend on where a node is, not on its number."""
    arguments = x @ np.array([[1.1, 0.7, 0.3, 0.9, 1.3, 0.2], [0.4] * 6, [0.8] * 6])
    return 0.5 * np.sin(arguments + phase + np.arange(6))


def evaluate(model: Model) -> dict:
    """Deform all nodes, carry the stress, deform again; gather on rank 0, sorted by position."""
    frames, forms = model.frames, model.forms
    space = frames.increment.function_space
    comm, x = space.mesh.comm, space.tabulate_dof_coordinates()
    frames.update(smooth(x, 0.0))
    # ghosts are not communicated: they move by the same formula
    owned = space.dofmap.index_map.size_local
    forms.increment.x.array[:] = 0.0
    forms.update_stress()
    h = smooth(x, 2.0)
    forms.increment.x.array[:] = h.ravel()
    forms.update_stress()
    frames.update(h)

    residual, action = fem.assemble_vector(forms.residual), fem.Function(space).x
    # columns that only other ranks write to come last
    matrix = fem.assemble_matrix(forms.tangent).to_scipy(ghosted=True).tocsr()[:, : 6 * len(x)]
    action.array[:] = matrix @ smooth(x, 4.0).ravel()
    for vector in (residual, action):
        vector.scatter_reverse(la.InsertMode.add)
    rows = [x[:owned], frames.frames.reshape(-1, 12)[:owned]]
    rows += [residual.array.reshape(-1, 6)[:owned], action.array.reshape(-1, 6)[:owned]]
    table = np.concatenate(comm.allgather(np.hstack(rows)))
    table = table[np.lexsort(np.round(table[:, :3], 8).T)]
    cells = space.mesh.topology.index_map(space.mesh.topology.dim)
    return {
        "energy": comm.allreduce(fem.assemble_scalar(forms.energy)),
        "ghost_cells": comm.allreduce(cells.num_ghosts),
        "position": table[:, :15].tolist(),
        "residual": table[:, 15:21].tolist(),
        "action": table[:, 21:].tolist(),
    }


def results(comm: MPI.Comm) -> dict:
    """Results of all cases by name."""
    return {make.__name__: evaluate(make(comm)) for make in CASES}


if __name__ == "__main__":
    record = results(MPI.COMM_WORLD)
    if MPI.COMM_WORLD.rank == 0:
        Path(sys.argv[1]).write_text(json.dumps(record))
