"""What test_domains.py compares: ``mpirun -n 2 parallel_domains.py OUT WAY``."""

import sys
from pathlib import Path

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np
from parallel_scenes import pendulum, sheet

import fem_lie as fl


def results():
    """Of statics and motion, and what each took on subdomains."""
    scene, corner = sheet()
    rest = fl.statics(scene, load_steps=2)
    moved = fl.GeneralisedAlpha().run(pendulum(), duration=0.02, step=2e-3)
    found = {"place": rest.position(corner), "frames": moved.frames, "joints": moved.joint_forces}
    found["asked"] = np.array(rest.total_iterations)
    return found, (rest.subdomains, moved.subdomains)


if __name__ == "__main__":
    for kind in ("statics", "dynamics"):
        PETSc.Options(f"fem_lie_{kind}_")["domains"] = sys.argv[2]
    arrays, statistics = results()
    if MPI.COMM_WORLD.rank == 0:
        np.savez(Path(sys.argv[1]), statistics=np.array(statistics), **arrays)
