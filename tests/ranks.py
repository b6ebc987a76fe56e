"""How tests run a script on several ranks."""

import os
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType

from mpi4py import MPI

import pytest


def on_ranks(script: ModuleType, ranks: int, out: Path, *given: str) -> None:
    """``mpirun -n ranks script out given…``; the script has to end well and without warnings."""
    code, text = output_of_ranks(script, ranks, str(out), *given)
    assert code == 0, text


def output_of_ranks(script: ModuleType, ranks: int, *given: str) -> tuple[int, str]:
    """How ``mpirun -n ranks script given…`` ends, and all that it writes."""
    command = shutil.which("mpirun")
    if command is None:
        pytest.skip("no mpirun here")
    # this process is an MPI process itself, which mpirun must not take for its parent
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("OMPI_", "PMIX_"))}
    environment |= {
        "OMPI_ALLOW_RUN_AS_ROOT": "1",
        "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
        "OMPI_MCA_btl": "^tcp",  # shared memory works without a network
        "OMPI_MCA_mpi_yield_when_idle": "1",  # ranks that wait leave the core to others
        "OMP_NUM_THREADS": "1",
    }
    many = ["--oversubscribe"] if "Open MPI" in MPI.Get_library_version() else []
    arguments = ["-n", str(ranks), sys.executable, "-W", "error", str(script.__file__), *given]
    run = subprocess.run(
        [command, *many, *arguments], env=environment, capture_output=True, text=True, timeout=600
    )
    return run.returncode, run.stdout + run.stderr
