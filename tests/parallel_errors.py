"""What test_ranks.py lets go wrong on one rank: ``mpirun -n 2 parallel_errors.py FAULT``."""

import sys

from mpi4py import MPI

import parallel_scenes

import fem_lie as fl

MESSAGES = {
    "numbers": "at a solution their numbers differ",
    "raise": "ZeroDivisionError: on the second rank alone",
    "end": "rank 0 at a new matrix, rank 1 at the end of the script",
}
FAULTS = list(MESSAGES)
SECOND = MPI.COMM_WORLD.rank == 1


def go_wrong(fault):
    """While the other rank waits in vain."""
    scene, corner = parallel_scenes.sheet()
    if fault == "raise" and SECOND:
        raise ZeroDivisionError("on the second rank alone")
    if fault == "end" and SECOND:
        return
    if fault == "numbers" and SECOND:
        scene.add(fl.PointLoad(corner, force=(0.0, 0.0, 1.0)))
    fl.statics(scene)


if __name__ == "__main__":
    parallel_scenes.share_factors()
    go_wrong(sys.argv[1])
