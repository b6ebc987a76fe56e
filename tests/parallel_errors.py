"""What test_ranks.py lets go wrong on one rank: ``mpirun -n 2 parallel_errors.py FAULT``."""

import faulthandler
import sys

from mpi4py import MPI

import numpy as np

from fem_lie.ranks.together import end_together, meet

MESSAGES = {
    "numbers": "at a solution their numbers differ",
    "raise": "ZeroDivisionError: on the second rank alone",
    "end": "rank 0 at a solution, rank 1 at the end of the script",
}
FAULTS = list(MESSAGES)
SECOND = MPI.COMM_WORLD.rank == 1


def go_wrong(fault):
    """While the other rank waits in vain."""
    if fault == "raise" and SECOND:
        raise ZeroDivisionError("on the second rank alone")
    if fault == "end" and SECOND:
        return
    meet("a solution", np.ones(1) + (fault == "numbers" and SECOND))


if __name__ == "__main__":
    faulthandler.dump_traceback_later(500, exit=True)
    end_together()
    go_wrong(sys.argv[1])
