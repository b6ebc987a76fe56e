"""Quadrilaterals cut by patterns, meshed anew by gmsh, and equal ones: error over unknowns.

``tools/run python3 -m benchmarks.refined_quadrilaterals [--tolerance 0.05]``

The L-plate of :mod:`benchmarks.effectivity`, in the energy norm, by jumps of stress. Meshing anew
takes the size of each cell times (wanted error per cell / its error)^½, as a field for gmsh, whose
triangles it makes quadrilaterals of.
"""

from __future__ import annotations

import argparse
from time import perf_counter

import gmsh
import numpy as np
from scipy.spatial import cKDTree

import fem_lie as fl
from benchmarks import effectivity

ESTIMATE = fl.adaptivity.ResidualEstimate()
CORNERS = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]


def plate(mesh: fl.mesh.SurfaceMesh) -> fl.Scene:
    """An L clamped all around, under pressure."""
    scene = fl.Scene()
    section = fl.ShellSection.layer(0.1, fl.Material(1e6, 0.3, 1.0))
    shell = scene.add(fl.Shell(mesh, section, name="plate"))
    shell.clamp("rim")
    scene.add(fl.loads.SurfacePressure(shell, 0.01))
    return scene


def largest_corner(mesh: fl.mesh.SurfaceMesh) -> float:
    """Largest angle of a cell, degrees."""
    p = mesh.points[mesh.cells][:, [0, 1, 3, 2]]
    a, b = np.roll(p, -1, 1) - p, np.roll(p, 1, 1) - p
    cosine = (a * b).sum(2) / np.linalg.norm(a, axis=2) / np.linalg.norm(b, axis=2)
    return float(np.degrees(np.arccos(cosine.min())))


def report(way: str, mesh: fl.mesh.SurfaceMesh, relative: float, since: float) -> None:
    """A line of the table."""
    print(
        f"| {way} | {len(mesh.cells)} | {6 * len(mesh.points)} | {100 * relative:.2f} % | "
        f"{largest_corner(mesh):.0f}° | {perf_counter() - since:.1f} s |",
        flush=True,
    )


def by_patterns(tolerance: float) -> None:
    """By ``fl.adaptivity.adapt``, for several parts of the error that are cut."""
    for part in (0.3, 0.5, 0.7):
        since, mesh = perf_counter(), effectivity.l_plate(4).bodies[0].model.mesh
        found = fl.adaptivity.adapt(
            plate, mesh, tolerance=tolerance, solve=fl.statics, estimate=ESTIMATE, part=part
        )
        report(f"patterns, part {part}", found.mesh, found.relative[-1], since)


def by_sizes(tolerance: float) -> None:
    """Cut from the first mesh on for each mesh, with equal errors of all cells."""
    for fall in (0.5, 0.75):
        since, mesh = perf_counter(), effectivity.l_plate(4).bodies[0].model.mesh
        found = fl.adaptivity.adapt(
            plate, mesh, tolerance=tolerance, solve=fl.statics, estimate=ESTIMATE, fall=fall
        )
        report(f"from the first mesh, fall {fall}", found.mesh, found.relative[-1], since)


def by_equal(tolerance: float) -> None:
    """Twice as many cells each time."""
    since, relative, count = perf_counter(), 1.0, 4
    while relative > tolerance:
        count *= 2
        scene = effectivity.l_plate(count)
        found = fl.adaptivity.space_error(
            fl.statics(scene), scene.bodies[0], scene, estimate=ESTIMATE
        )
        relative = found.relative
    report("equal", scene.bodies[0].model.mesh, relative, since)


def by_gmsh(tolerance: float) -> None:
    """Meshed anew with sizes from the estimate, until it is met."""
    since, mesh = perf_counter(), effectivity.l_plate(4).bodies[0].model.mesh
    for _ in range(8):
        scene = plate(mesh)
        found = fl.adaptivity.space_error(
            fl.statics(scene), scene.bodies[0], scene, estimate=ESTIMATE
        )
        if found.relative <= tolerance:
            break
        size = np.linalg.norm(
            mesh.points[mesh.cells[:, 3]] - mesh.points[mesh.cells[:, 0]], axis=1
        ) / np.sqrt(2)
        # as many cells as there are now have this error each; of first order in the energy norm
        wanted = 0.95 * tolerance * np.sqrt(found.energy / len(mesh.cells))
        # squares of errors go with the fourth power of the size, where the mesh is even
        factor = np.clip(np.sqrt(wanted / found.elements), 0.25, 2.0)
        mesh = meshed_anew(mesh.points[mesh.cells].mean(axis=1), size * factor)
    report("gmsh", mesh, found.relative, since)


def meshed_anew(centres: np.ndarray, size: np.ndarray) -> fl.mesh.SurfaceMesh:
    """Quadrilaterals of the L, of the sizes of those that were at the nearest positions."""
    tree = cKDTree(centres[:, :2])
    gmsh.initialize()
    try:
        gmsh.option.setNumber("General.Verbosity", 1)
        for name in ("FromPoints", "ExtendFromBoundary", "FromCurvature"):
            gmsh.option.setNumber(f"Mesh.MeshSize{name}", 0)
        points = [gmsh.model.geo.addPoint(x, y, 0.0) for x, y in CORNERS]
        around = zip(points, points[1:] + points[:1], strict=True)
        lines = [gmsh.model.geo.addLine(a, b) for a, b in around]
        area = gmsh.model.geo.addPlaneSurface([gmsh.model.geo.addCurveLoop(lines)])
        gmsh.model.geo.synchronize()
        gmsh.model.mesh.setSizeCallback(
            lambda dim, tag, x, y, z, old: float(size[tree.query((x, y))[1]])
        )
        gmsh.option.setNumber("Mesh.Algorithm", 8)
        gmsh.option.setNumber("Mesh.RecombinationAlgorithm", 3)
        gmsh.model.mesh.setRecombine(2, area)
        gmsh.model.mesh.generate(2)
        tags, x, _ = gmsh.model.mesh.getNodes()
        kinds, _, nodes = gmsh.model.mesh.getElements(2)
        assert list(kinds) == [3], "quadrilaterals alone"
        number = np.zeros(int(tags.max()) + 1, dtype=np.int64)
        number[tags.astype(int)] = np.arange(len(tags))
        cells = number[nodes[0].astype(int)].reshape(-1, 4)[:, [0, 1, 3, 2]]
        positions = x.reshape(-1, 3)
    finally:
        gmsh.finalize()
    used = np.unique(cells)
    cells, positions = np.searchsorted(used, cells), positions[used]
    sides = np.sort(cells[:, [[0, 1], [0, 2], [1, 3], [2, 3]]].reshape(-1, 2), axis=1)
    edges, met = np.unique(sides, axis=0, return_counts=True)
    rim = edges[met == 1]
    return fl.mesh.SurfaceMesh.from_cells(positions, cells, "quadrilateral", curves={"rim": rim})


def main() -> None:
    """Print a table in Markdown."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tolerance", type=float, default=0.05)
    tolerance = parser.parse_args().tolerance
    print("| mesh | cells | unknowns | estimate | largest corner | time |")
    print("| --- | --- | --- | --- | --- | --- |")
    by_equal(tolerance)
    by_patterns(tolerance)
    by_sizes(tolerance)
    by_gmsh(tolerance)


if __name__ == "__main__":
    main()
