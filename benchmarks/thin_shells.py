"""What thin shells cost, and what they leave out, as the tables of docs/measured/thin_shells.md.

    python3 -m benchmarks.thin_shells cost    residual, energy and matrix per cell
    python3 -m benchmarks.thin_shells shear   semi-cylinder: what shear is of the first deflection

Each prints a table in Markdown. Seconds are those of the processor, the least of several runs.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from time import process_time

import numpy as np

import fem_lie as fl
from demos import semi_cylinder
from fem_lie.bodies.thin_shells.assembly import ThinShellAssembly

CELLS, TURNS = 40, 5
LOADS = [0.1, 0.2]
E, NU = 2.0685e7, 0.3


# --- cost -----------------------------------------------------------------------------------------


def cost() -> None:
    """Of a quarter of a cylinder with 40 × 40 cells, bent a little, and with 300 of these cut."""
    patch = fl.mesh.smooth_patch(lambda a, b: (np.sin(a), np.cos(a), 2.0 * b), (CELLS, CELLS))
    some = np.random.default_rng(0).choice(CELLS**2, 300, replace=False)
    section = fl.ShellSection.layer(0.02, fl.Material(1e7, 0.3, 1e3))
    columns = [per_cell(fl.ThinShell(patch, section))]
    columns.append(
        per_cell(fl.ThinShell(fl.adaptivity.refine(fl.mesh.spline_mesh(patch), some), section))
    )
    print("| | µs per cell | where corners of cells hang |")
    print("| --- | --- | --- |")
    for name in columns[0]:
        print(f"| {name} | {columns[0][name]:.2f} | {columns[1][name]:.2f} |")


def per_cell(shell: fl.ThinShell) -> dict[str, float]:
    """Microseconds."""
    assembly, count = ThinShellAssembly([shell]), len(shell.model.connectivity)
    H, out = shell.frames.copy(), np.zeros(6 * len(shell.frames))
    H[:, 0] += 0.01 * np.sin(3.0 * H[:, 0, [2, 0, 1]])
    assembly.reset_stress(H)
    todo = {
        "forces": lambda: assembly.add_forces(H, out),
        "energy": lambda: assembly.energy(H),
        "matrix": lambda: assembly.tangent(H, H),
    }
    return {name: 1e6 * seconds(what) / count for name, what in todo.items()}


def seconds(what: Callable[[], object]) -> float:
    """Of one call."""
    what()
    found = []
    for _ in range(TURNS):
        start = process_time()
        for _ in range(10):
            what()
        found.append((process_time() - start) / 10)
    return min(found)


# --- shear ----------------------------------------------------------------------------------------


def shear() -> None:
    """Shells whose stiffness in shear across the thickness grows, and thin ones, on finer meshes.

    All but that stiffness is as in the isotropic shell of demos/semi_cylinder.py.
    """
    wanted = [semi_cylinder.REFERENCE["isotropic"][load] for load in LOADS]
    print("| shear | mesh | deflection at 0.1, 0.2 of the load | over the reference |")
    print("| --- | --- | --- | --- |")
    rows: list[tuple[str, float, str, tuple[int, ...]]] = [
        (f"{factor:g} times as stiff", factor, "HR", (16, 32, 48)) for factor in (1.0, 10.0, 100.0)
    ]
    rows.append(("thin shell", 1.0, "thin", (8, 16, 32)))
    for name, factor, formulation, meshes in rows:
        for mesh in meshes:
            found = deflections(mesh, factor, formulation)
            errors = ", ".join(f"{x:+.2%}" for x in found / wanted - 1.0)
            positions = ", ".join(f"{x:.5f}" for x in found)
            print(f"| {name} | {mesh} | {positions} | {errors} |", flush=True)


def deflections(mesh: int, factor: float, formulation: str) -> np.ndarray:
    """Of the crown at the loads."""
    G = E / (2 * (1 + NU))
    ply = fl.sections.Orthotropic(E, E, NU, G, factor * G, factor * G, 1.0)
    section = fl.ShellSection.laminate([fl.sections.Ply(semi_cylinder.THICKNESS, ply, 0.0)])
    result = fl.follow_loads(semi_cylinder.pinched(mesh, section, formulation), LOADS)
    return np.asarray(semi_cylinder.RADIUS - result.position("shell.11")[:, 2])


TABLES = {"cost": cost, "shear": shear}


if __name__ == "__main__":
    wanted = sys.argv[1:] or list(TABLES)
    unknown = set(wanted) - set(TABLES)
    if unknown:
        sys.exit(f"tables are {', '.join(TABLES)}, got {', '.join(sorted(unknown))}")
    for table in wanted:
        TABLES[table]()
        print()
