"""A body of forms on a distributed mesh, for test_form_bodies.py: ``mpirun -n 2 … OUT``."""

import json
import sys
from pathlib import Path

from mpi4py import MPI

import models
import ufl

import fem_lie as fl


def refusal(comm: MPI.Comm) -> str:
    """What all ranks say to a mesh that they share."""
    mesh = models.line(comm, 1)
    q = fl.NodalFrames(mesh)
    energy = ufl.inner(q.directors[0], q.directors[1]) ** 2 * ufl.dx(mesh)
    problem = fl.FrameProblem(fl.local_frame_forms(energy, q), q)
    try:
        fl.extend.FormBody(problem)
    except ValueError as error:
        (message,) = set(comm.allgather(str(error)))
        return message
    return ""


if __name__ == "__main__":
    text = refusal(MPI.COMM_WORLD)
    if MPI.COMM_WORLD.rank == 0:
        Path(sys.argv[1]).write_text(json.dumps(text))
