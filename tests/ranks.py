"""How tests run a script on several ranks."""

import os
import shutil
import signal
import subprocess
import sys
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Lock
from types import ModuleType

from mpi4py import MPI

import pytest

_COMPILING = Lock()
PATIENCE, ENDING = 500.0, 60.0  # seconds for a script, and for its end after a signal


def on_ranks(script: ModuleType, ranks: int, out: Path, *given: str) -> None:
    """``mpirun -n ranks script out given…``; the script has to end well and without warnings."""
    code, text = output_of_ranks(script, ranks, str(out), *given)
    assert code == 0, text


NAP = """
#define _GNU_SOURCE
#include <sys/prctl.h>
#include <time.h>

static long now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * 1000000000L + t.tv_nsec;
}

/* Linux adds 50 microseconds to each sleep otherwise */
__attribute__((constructor)) static void wake_up_in_time(void) { prctl(PR_SET_TIMERSLACK, 1UL); }

/* The answer to a message often comes at once: a wait begins without sleep. */
int sched_yield(void) {
    static _Thread_local long begin, last;
    struct timespec nap = {0, 20000};
    long called = now();
    if (called - last > 10000) begin = called;
    if (called - begin > 50000) nanosleep(&nap, 0);
    last = now();
    return 0;
}
"""


@cache
def naps() -> tuple[TemporaryDirectory[str], str]:
    """Library by which ranks that wait sleep, in a folder that exists as long as the process.

    Open MPI yields instead, and Linux then lets any busy process go first for so long that three
    ranks on two cores get one percent of a core each next to four of them.
    """
    folder = TemporaryDirectory()
    source, library = Path(folder.name, "nap.c"), Path(folder.name, "nap.so")
    source.write_text(NAP)
    # FFCx needs a compiler, too
    compiler = os.environ.get("CC", "cc").split()
    subprocess.run([*compiler, "-shared", "-fPIC", "-o", library, source], check=True)
    return folder, str(library)


def output_of_ranks(
    script: ModuleType, ranks: int, *given: str, patience: float = PATIENCE
) -> tuple[int, str]:
    """How ``mpirun -n ranks script given…`` ends, and all that it writes.

    Ranks that wait for each other for ever are aborted, and each writes where it is.
    """
    command = shutil.which("mpirun")
    if command is None:
        pytest.skip("no mpirun here")
    with _COMPILING:  # tests may start scripts in threads
        library = naps()[1]
    # this process is an MPI process itself, which mpirun must not take for its parent
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("OMPI_", "PMIX_"))}
    environment |= {
        "OMPI_ALLOW_RUN_AS_ROOT": "1",
        "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
        "OMPI_MCA_btl": "^tcp",  # shared memory works without a network
        "OMPI_MCA_btl_sm_free_list_max": "-1",  # with a limit, ranks may wait for ever
        "OMPI_MCA_mpi_yield_when_idle": "1",
        "LD_PRELOAD": library,  # ranks that wait leave the core to others, and get it back
        "OMP_NUM_THREADS": "1",
    }
    many = ["--oversubscribe"] if "Open MPI" in MPI.Get_library_version() else []
    python = [sys.executable, "-W", "error", "-X", "faulthandler"]
    run = subprocess.Popen(
        [command, *many, "-n", str(ranks), *python, str(script.__file__), *given],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    try:
        text, _ = run.communicate(timeout=patience)
    except subprocess.TimeoutExpired:
        run.send_signal(signal.SIGABRT)  # mpirun passes it on to all ranks
        text, _ = run.communicate(timeout=ENDING)
        pytest.fail(f"ranks wait for each other for ever:\n{text}")
    return run.returncode, text
