"""Speed against error of shells: what accuracy costs, for each element and both iterations.

The pinched hemisphere of hemisphere.py, thickness 0.04, on finer and finer meshes. Six elements:
``displacement`` without any cure against locking, ``MITC4``, Hellinger-Reissner (``HR``),
Hu-Washizu (``HW``, with this law the same states as HR), triangles (``MITC3+``, two per square,
with Hellinger-Reissner), and ``thin``, bicubic patches without shear. Each by plain Newton's
method, in ten load steps, and with the stress carried as an iterate, in three; a step that fails is
halved, and its time counts. Error: the larger one of both deflections, relative to those of
elements of degree 4 and 6, which are known to 1e-4.

Unknowns are five per node, of thin shells twelve. Seconds are those of the processor for the whole
of ``statics``, without compilation, the best of several runs. Coarse triangles do not arrive in all
of them.
"""

from __future__ import annotations

import csv
from pathlib import Path
from time import process_time
from typing import Any, NamedTuple

import numpy as np
import ufl
from matplotlib.figure import Figure

import fem_lie as fl
from fem_lie.extend import COLOURS

try:  # as a script, or as a part of the package of demos
    from hemisphere import CASES, RADIUS, pinched, position
except ModuleNotFoundError:
    from demos.hemisphere import CASES, RADIUS, pinched, position

RESULTS = Path(__file__).parents[1] / "results"
THICKNESS = 0.04
MESHES = (4, 6, 8, 12, 16, 24, 32)
STEPS = {"plain Newton": 10, "linearised stress": 3}


def shear(surface: Any, point: Any) -> Any:
    """Transverse shear strain ``x,α·t`` at the point itself, with nothing assumed."""
    t = surface.t(point)
    return ufl.as_vector([ufl.dot(surface.dx(along, point), t) for along in (0, 1)])


ELEMENTS: dict[str, tuple[fl.elements.ShellFormulation | None, str]] = {
    "displacement": (
        fl.elements.DisplacementBased(fl.elements.StrainMeasures(shear=shear)),
        "quadrilateral",
    ),
    "MITC4": (fl.elements.DisplacementBased(), "quadrilateral"),
    "HR": (fl.elements.HellingerReissner(), "quadrilateral"),
    "HW": (fl.elements.HuWashizu(), "quadrilateral"),
    "MITC3+": (fl.elements.HellingerReissner(), "triangle"),
    "thin": (None, "patch"),
}


class Row(NamedTuple):
    """One run."""

    element: str
    method: str
    mesh: int
    unknowns: int
    error: float
    iterations: int
    seconds: float


def measure(element: str, method: str, mesh: int, repeats: int) -> Row | None:
    """Run it several times; the best time counts. ``None`` if it does not arrive."""
    formulation, cell = ELEMENTS[element]
    cells: fl.mesh.SurfaceMesh | fl.mesh.SmoothPatch
    if formulation is None:
        cells, per_node = fl.mesh.smooth_patch(position, (mesh, mesh)), 12
    else:
        cells, per_node = fl.mesh.parametric_surface(position, (mesh, mesh), cell=cell), 5
    times = []
    for _ in range(repeats):
        scene = pinched(THICKNESS, cells, formulation)
        start = process_time()
        carried = method == "linearised stress"
        try:
            result = fl.statics(
                scene, load_steps=STEPS[method], newton=fl.schemes.Newton(linearised_stress=carried)
            )
        except fl.ConvergenceError:
            return None
        times.append(process_time() - start)
    a = result.position("hemisphere.00")[-1, 0] - RADIUS
    b = RADIUS - result.position("hemisphere.10")[-1, 1]
    error = float(np.abs(np.array([a, b]) / CASES[THICKNESS][1:] - 1.0).max())
    iterations = result.total_iterations
    return Row(element, method, mesh, per_node * (mesh + 1) ** 2, error, iterations, min(times))


def main(
    coarsest: int = 4,
    finest: int = 32,
    repeats: int = 3,
    output: str = "results",
    pictures: bool = True,
) -> dict[str, Any]:
    meshes = [n for n in MESHES if coarsest <= n <= finest]
    rows = []
    print("element       method            mesh  unknowns    error  iter.   CPU s")
    for element in ELEMENTS:
        for method in STEPS:
            measure(element, method, meshes[0], 1)  # compiles
            for mesh in meshes:
                row = measure(element, method, mesh, repeats)
                if row is None:
                    print(f"{element:14}{method:16}{mesh:6} does not arrive", flush=True)
                    continue
                rows.append(row)
                print("{:14}{:16}{:6}{:10}{:9.2%}{:7}{:8.2f}".format(*row), flush=True)
    record: dict[str, Any] = {}
    for row in rows:
        if row.mesh == meshes[-1]:
            key = f"{row.element}_{row.method}".replace(" ", "_")
            record |= {f"error_{key}": row.error, f"iterations_{key}": row.iterations}
    folder = RESULTS.parent / output
    folder.mkdir(exist_ok=True)
    with (folder / "speed_against_error_shells.csv").open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(Row._fields)
        writer.writerows(rows)
    if pictures:
        draw(rows, folder / "speed_against_error_shells.png")
    return record


def draw(rows: list[Row], path: Path) -> None:
    """Error over unknowns and over seconds."""
    figure = Figure(figsize=(9.0, 4.2), dpi=150, layout="constrained")
    axes = figure.subplots(1, 2, sharey=True)
    for k, element in enumerate(ELEMENTS):
        for method, style in zip(STEPS, ("s--", "o-"), strict=True):
            of = [row for row in rows if (row.element, row.method) == (element, method)]
            errors = [row.error for row in of]
            options: dict[str, Any] = {"color": COLOURS[k], "markersize": 4}
            label = method if element == "HR" else None
            axes[1].loglog([row.seconds for row in of], errors, style, label=label, **options)
            if method == "linearised stress":  # the same states
                unknowns = [row.unknowns for row in of]
                axes[0].loglog(unknowns, errors, style, label=element, **options)
    axes[0].set(xlabel="unknowns", ylabel="error of the deflections, relative")
    axes[1].set(xlabel="CPU seconds")
    for each in axes:
        each.grid(color="#DDDDDD", linewidth=0.6)
        each.legend(frameon=False, fontsize=8, loc="lower left")
    figure.suptitle("Pinched hemisphere, thickness 0.04")
    figure.savefig(path)
    print(f"picture: {path}")


if __name__ == "__main__":
    from demos.command_line import run

    run(main)
