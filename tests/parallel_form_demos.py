"""Records of demos/forms, for test_form_demos.py: ``mpirun -n 2 parallel_form_demos.py OUT``."""

import importlib
import json
import sys
from pathlib import Path

from mpi4py import MPI

FOLDER = Path(__file__).parents[1] / "demos" / "forms"
DEMOS = sorted(f.stem for f in FOLDER.glob("*.py") if f.stem not in ("__init__", "clamped"))


def results(comm: MPI.Comm) -> dict:
    """Records of all examples, which are equal on all ranks."""
    sys.path.insert(0, str(FOLDER))
    records = {demo: importlib.import_module(demo).main() for demo in DEMOS}
    everywhere = comm.allgather(json.dumps(records))
    if len(set(everywhere)) > 1:
        raise RuntimeError(f"ranks have different records: {everywhere}")
    return records


if __name__ == "__main__":
    record = results(MPI.COMM_WORLD)
    if MPI.COMM_WORLD.rank == 0:
        Path(sys.argv[1]).write_text(json.dumps(record))
