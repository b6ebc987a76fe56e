"""A run amid which a rank fails: ``mpirun -n N parallel_faults.py FAULT,RANK,SHARED FILE``.

With the fault ``resumed`` it goes on with the run of the file, without a fault.
"""

import logging
import os
import resource
import signal
import sys
from pathlib import Path

from mpi4py import MPI

import divided_scenes
import parallel_scenes

import fem_lie as fl

FAILS_AT, END, STEP, EVERY = 0.013, 0.02, 1e-3, 2


def error():
    """As in a function of the user's, on this rank alone."""
    raise ArithmeticError("no push is known here")


def killed():
    """As by a system that is short of memory."""
    os.kill(os.getpid(), signal.SIGKILL)


def left():
    """As by a library that ends the process."""
    os._exit(3)


def content():
    """As by a script that goes another way on this rank."""
    sys.exit(0)


def full():
    """From now on nothing longer than this can be written."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, resource.RLIM_INFINITY))


IN_TIME = {
    "error": (error, "ArithmeticError: no push is known here"),
    "killed": (killed, "signal 9 (Killed)"),
    "left": (left, "exited with non-zero status"),
    "content": (content, "at the end of the script"),
    "content in statics": (content, "at the end of the script, which it left in statics"),
    "full": (full, "File too large: the run has reached time 0.014"),
}
"""What happens on one rank amid a run, and what the message says."""

AT_ONCE = {
    "content at once": (content, "rank 1 at the end of the script"),
    "error at once": (error, "ArithmeticError: no push is known here"),
    "full at once": (full, "File too large"),
}
"""Likewise, once there is a scene, before it is run."""

WITHOUT_RESULTS = {*AT_ONCE, "content in statics"}
"""Faults before which nothing is written."""

MESSAGES = {name: message for name, (_, message) in (IN_TIME | AT_ONCE).items()}


ALL = -1
"""Instead of the number of a rank: all of them."""


def scene(fault="", rank=ALL):
    """The pendulum, pushed everywhere; the fault comes when all have passed ``FAILS_AT``."""
    built, met = parallel_scenes.pendulum(), []

    def push(t):
        if t > FAILS_AT and fault in IN_TIME and not met:
            # ranks that solve alone do not wait for each other: without this the first one, which
            # writes, may be at its first step when another one fails, and has written nothing yet
            met.append(MPI.COMM_WORLD.Barrier())
            if rank in (ALL, MPI.COMM_WORLD.rank):
                IN_TIME[fault][0]()
        return t

    for beam in built.bodies:
        # if the scene is divided, each part has some of it
        built.add(fl.LineLoad(beam, force=(0, 0, 1.0), history=push))
    return built


class Leaving(logging.Handler):
    """Handler that ends the script of a rank at the first message after one on a division."""

    divided = False

    def emit(self, record):
        """Wait for the message of a division; leave at the next one."""
        if self.divided:
            content()
        self.divided = "of them are shared" in record.getMessage()


def leave_soon(rank):
    """From the next division on, a rank has no more to do."""
    log = logging.getLogger("fem_lie")
    log.setLevel(logging.INFO)
    if MPI.COMM_WORLD.rank == rank:
        log.addHandler(Leaving())


def branch(rank):
    """A change to the branch of a path that all have followed."""
    strut, _ = divided_scenes.strut()
    found = fl.follow_path(strut, until=divided_scenes.PATHS["strut"][1])
    leave_soon(rank)
    fl.stability.switch_branch(strut, found.bifurcations[0])


def analysis(study, build):
    """A study of a scene, which a rank leaves."""

    def started(rank):
        leave_soon(rank)
        study(build()[0])

    return started


LEFT = {
    "vibrations": analysis(lambda scene: fl.vibrations(scene, 2), divided_scenes.cantilever),
    "buckling": analysis(fl.buckling, divided_scenes.strut),
    "an equilibrium path": analysis(fl.follow_path, divided_scenes.strut),
    "a change to a branch": branch,
}
"""Analyses that a rank leaves once their scene is divided, as messages call them."""


def run(file, fault="", rank=ALL):
    """A run with results and checkpoints in a file, or statics."""
    if fault.endswith("in statics"):
        return fl.statics(scene(fault, rank), load_steps=2)
    options = {"step": STEP, "file": file, "checkpoint_every": EVERY, "progress": False}
    return fl.GeneralisedAlpha().run(scene(fault, rank), duration=END, **options)


if __name__ == "__main__":
    name, where, shares = sys.argv[1].split(",")
    fl.Scene()  # from here on the ranks end together
    if name in AT_ONCE and MPI.COMM_WORLD.rank == int(where):
        AT_ONCE[name][0]()
    if shares == "shared":
        parallel_scenes.share_factors()
    if shares == "divided":
        divided_scenes.divide()
    if name in LEFT:
        LEFT[name](int(where))
    elif name == "resumed":
        logging.basicConfig(level=logging.INFO)  # with what each rank has
        fl.GeneralisedAlpha().resume(scene(), Path(sys.argv[2]), progress=False)
    else:
        run(Path(sys.argv[2]), name, int(where))
