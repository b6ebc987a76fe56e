"""The antenna on subdomains over many steps: how often the preconditioner is made.

    tools/run mpirun --oversubscribe -n 4 python3 -m benchmarks.domains_antenna --axes local

with ``--axes fixed``, too, and with ``--cells 4``.

The ring of ``demos/hoop_antenna.py``, with nets if there are ``--cells`` in each cable, folds in
200 steps; one subdomain on each rank, BDDC with deluxe scaling and adaptive primal unknowns. Prints
a row: subdomains, axes, cells of cables, steps, unknowns of interfaces, matrices of mass and
stiffness, preconditioners made (for a new border alone, too), solutions, iterations of each,
iterations of Newton per step.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from mpi4py import MPI
from petsc4py import PETSc

import fem_lie as fl

sys.path.insert(0, str(Path(__file__).parents[1] / "demos"))


def main() -> None:
    """Print the row."""
    from antenna_scene import Antenna

    asking = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    asking.add_argument("--axes", choices=("local", "fixed"), required=True)
    asking.add_argument("--cells", type=int, default=0)
    asking.add_argument("--elements", type=int, default=2)
    asking.add_argument("--steps", type=int, default=200)
    asked = asking.parse_args()
    nets = asked.cells > 0
    duration, h = (20.0, 2e-2) if nets else (4.0, 2e-2)
    made = Antenna(30, 30, duration, asked.elements, asked.cells, 1e-3)
    PETSc.Options("fem_lie_dynamics_")["domains"] = "bddc"
    axes = fl.schemes.MatrixFrame(int(asked.axes == "fixed"))
    scheme = fl.GeneralisedAlpha(radius=0.0 if nets else 0.8, matrix_frame=axes)
    found = scheme.run(
        made.scene, duration=asked.steps * h, step=h, save_every=asked.steps, progress=False
    )
    used = found.subdomains
    assert used is not None
    row = [used.number, asked.axes, asked.cells, asked.steps, used.interface, found.k_updates]
    row += [used.made, used.solutions, f"{used.per_solution:.1f}"]
    row.append(f"{found.iterations[-1] / asked.steps:.1f}")
    if MPI.COMM_WORLD.rank == 0:
        print("| " + " | ".join(map(str, row)) + " |", flush=True)


if __name__ == "__main__":
    main()
