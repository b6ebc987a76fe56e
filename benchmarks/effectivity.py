"""Estimated over true error in space, mesh by mesh, of beams and shells: 1 is exact.

``tools/run python3 -m benchmarks.effectivity [--case NAME ...] [--meshes 8 16 32] [--cost]``

Meshes are nested. The true stress is the one recovered on the finest, whose cells at edges resolve
boundary layers; the true error of another mesh is the norm of the difference, integrated over the
cells of the finest. The force of the pulled cylinder is spread over a pad: under a point force a
shell that shears has infinite energy, so that there is no true error.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from dataclasses import replace
from time import perf_counter
from typing import NamedTuple

import numpy as np

import fem_lie as fl
from demos import hemisphere, pulled_cylinder
from fem_lie.adaptivity.estimates.recovery import StressFields, fields_of
from fem_lie.results.stresses.nodal_values import CellPoints
from fem_lie.results.stresses.shell_stress import integration
from studies import linear_shells

Row = tuple[str, int, float, float]
"""Mesh, unknowns, true relative error, effectivity."""

ESTIMATES: tuple[fl.adaptivity.ErrorEstimate, ...] = (
    fl.adaptivity.RecoveryEstimate(),
    fl.adaptivity.ResidualEstimate(),
    fl.adaptivity.HierarchicalEstimate(),
)


# --- shells ---------------------------------------------------------------------------------------


class ShellCase(NamedTuple):
    """A shell on quadrilaterals that are nested.

    Attributes:
        build: From the number of cells along a side to its scene.
        solve: From that to its equilibrium.
        meshes: Numbers of cells, each a divisor of the last.
        positions: From its mesh and that number, nodes in units of cells, shape (n, 2).
    """

    build: Callable[[int], fl.Scene]
    solve: Callable[[fl.Scene], fl.StaticResult]
    meshes: tuple[int, ...]
    positions: Callable[[fl.mesh.SurfaceMesh, int], np.ndarray]


class Solved(NamedTuple):
    """Stress on a mesh; corners of cells in units of the mesh, shape (m, 4, 2)."""

    scene: fl.Scene
    result: fl.StaticResult
    shell: fl.Shell
    fields: StressFields
    corners: np.ndarray

    @classmethod
    def of(cls, case: ShellCase, count: int) -> Solved:
        """Solve a case on a mesh."""
        scene = case.build(count)
        (shell,) = scene.bodies
        result = case.solve(scene)
        (fields,) = fields_of(result, shell, scene)
        corners = case.positions(shell.model.mesh, count)[shell.model.mesh.cells]
        return cls(scene, result, shell, fields, corners)


def _grid(mesh: fl.mesh.SurfaceMesh, count: int) -> np.ndarray:
    along = len(mesh.points) // (count + 1)
    return np.stack(np.divmod(np.arange(len(mesh.points)), along), axis=1)


def _plane(mesh: fl.mesh.SurfaceMesh, count: int) -> np.ndarray:
    return np.rint(mesh.points[:, :2] * count).astype(int)


def shell_rows(case: ShellCase, estimate: fl.adaptivity.ErrorEstimate = ESTIMATES[0]) -> list[Row]:
    """Errors on all meshes but the finest, of one estimate."""
    return all_shell_rows(case, [estimate])[0]


def all_shell_rows(
    case: ShellCase, estimates: Sequence[fl.adaptivity.ErrorEstimate]
) -> list[list[Row]]:
    """Errors on all meshes but the finest, of each estimate."""
    *meshes, finest = case.meshes
    fine = Solved.of(case, finest)
    norm = fine.fields.energy(fine.fields.recovered).sum()
    rows: list[list[Row]] = [[] for _ in estimates]
    for count in meshes:
        coarse = Solved.of(case, count)
        true = fine.fields.recovered - _own(coarse, fine, finest // count)
        error = fine.fields.energy(true).sum()
        unknowns = 6 * len(coarse.shell.frames)
        for row, estimate in zip(rows, estimates, strict=True):
            found = fl.adaptivity.space_error(
                coarse.result, coarse.shell, coarse.scene, estimate=estimate
            )
            ratio = found.effectivity(np.sqrt(error))
            row.append((f"{count}", unknowns, np.sqrt(error / norm), ratio))
    return rows


def _own(coarse: Solved, fine: Solved, ratio: int) -> np.ndarray:
    """Stress of the coarse cells at the points of the fine ones, shape (m, q, 8)."""
    rule, _ = integration(fine.shell)
    points = CellPoints.of(fine.shell.model.cut_mesh, rule)
    low = np.rint(coarse.corners.min(axis=1)).astype(int)
    number = {tuple(corner): i for i, corner in enumerate(low.tolist())}
    inside = np.floor(fine.corners.min(axis=1) / ratio + 1e-9).astype(int)
    cells = np.array([number[tuple(corner)] for corner in inside.tolist()])
    at = np.einsum("qk,mkj->mqj", points.shapes, fine.corners) / ratio
    p = coarse.corners[cells].astype(float)
    axes = np.stack([p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]], axis=1)
    x, y = np.moveaxis(np.einsum("mqj,mij->mqi", at - p[:, np.newaxis, 0], axes), 2, 0)
    shapes = np.stack([(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y], axis=2)
    inverse = np.linalg.pinv(points.shapes)
    corners = np.einsum("kq,mqb->mkb", inverse, coarse.fields.own)
    return np.einsum("mqk,mkb->mqb", shapes, corners[cells])


ROOF = 192
"""Cells along a side of the finest roof."""
DENSE = 96
"""Cells along a side of the finest meshes of the hemisphere and the cylinder, without layers."""
PAD = 1 / 16
"""Part of either side of the cylinder that is loaded."""

# --- scenes ---------------------------------------------------------------------------------------


def hole(count: int) -> fl.Scene:
    """A quarter of a square sheet of 2 x 2 with a hole of radius 0.5, pulled along x."""

    def position(a: float, b: float) -> np.ndarray:
        angle = a * np.pi / 2
        along = np.array([np.cos(angle), np.sin(angle), 0.0])
        return 0.5 * (1 - b) * along + b * along / np.abs(along).max()

    mesh = fl.mesh.parametric_surface(position, (count, count))
    rim = mesh.curve("b=1")
    right = rim[(mesh.points[rim, 0] > 1 - 1e-9).all(axis=1)]
    mesh = replace(mesh, curves={**mesh.curves, "right": right})
    shell = fl.Shell(mesh, fl.ShellSection.layer(0.05, fl.Material(1e6, 0.3, 1.0)), name="sheet")
    shell.symmetry("a=0", (0, 1, 0))
    shell.symmetry("a=1", (1, 0, 0))
    for name in ("a=0", "a=1", "b=0", "b=1"):
        shell.roller(name, (0, 0, 1))
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.loads.EdgeLoad(shell, "right", force=(1.0, 0, 0)))
    return scene


def l_plate(count: int) -> fl.Scene:
    """An L of three unit squares, of thickness 0.1, clamped all around, under pressure."""
    number: dict[tuple[int, int], int] = {}
    cells = []
    for i in range(2 * count):
        for j in range(2 * count):
            if i < count or j < count:
                corners = [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)]
                cells.append([number.setdefault(c, len(number)) for c in corners])
    points = np.column_stack([np.array(list(number)) / count, np.zeros(len(number))])
    sides = np.array(cells)[:, [[0, 1], [0, 2], [1, 3], [2, 3]]].reshape(-1, 2)
    edges, met = np.unique(np.sort(sides, axis=1), axis=0, return_counts=True)
    mesh = fl.mesh.SurfaceMesh.from_cells(
        points, cells, "quadrilateral", curves={"rim": edges[met == 1]}
    )
    shell = fl.Shell(mesh, fl.ShellSection.layer(0.1, fl.Material(1e6, 0.3, 1.0)), name="plate")
    shell.clamp("rim")
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.loads.SurfacePressure(shell, 0.01))
    return scene


def towards_edges(along: np.ndarray, count: int) -> np.ndarray:
    """Places 0 … 1 of nodes; those of the finest roof are dense in the last of 32 cells."""
    last = 32.0 * (1.0 - along)
    return np.where((count == ROOF) & (last < 1.0), 1.0 - last**2.2 / 32.0, along)


def roof(count: int) -> fl.Scene:
    """A quarter of the roof; the finest mesh has cells in the layer along its edges."""

    def position(a: float, b: float) -> np.ndarray:
        a, b = (float(towards_edges(np.array(s), count)) for s in (a, b))
        angle = np.radians(40.0 * a)
        return np.array([25.0 * b, -25.0 * np.sin(angle), 25.0 * np.cos(angle)])

    section = fl.ShellSection.layer(0.25, fl.Material(4.32e8, 0.0, 1.0))
    mesh = fl.mesh.parametric_surface(position, (count, count))
    shell = fl.Shell(mesh, section, director=linear_shells.about_x, name="roof")
    shell.symmetry("b=0", (1, 0, 0))
    shell.symmetry("a=0", (0, 1, 0))
    for direction in ((0, 1, 0), (0, 0, 1)):
        shell.roller("b=1", direction)
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.AreaLoad(shell, force=(0, 0, -90.0)))
    return scene


def lines(count: int, layer: float, *ends: int) -> np.ndarray:
    """Lines of equal cells from 0 to 1; of the finest mesh cells at these ends are in a layer."""
    equal = np.arange(count + 1) / count
    if count < DENSE:
        return equal
    inside = np.cumsum(0.5 * layer * 1.5 ** np.arange(20))
    inside = inside[inside < 0.8 / count]
    return np.unique(np.concatenate([equal, *(np.abs(end - inside) for end in ends)]))


Position = Callable[[float, float], np.ndarray]


def on_lines(position: Position, count: int, along: np.ndarray) -> fl.mesh.SurfaceMesh:
    """Surface with equal cells around and lines along."""
    cells = len(along) - 1

    def at(a: float, b: float) -> np.ndarray:
        return position(a, float(along[round(b * cells)]))

    return fl.mesh.parametric_surface(at, (count, cells))


def hemisphere_case(thickness: float) -> ShellCase:
    """The pinched hemisphere, whose layers are along the equator and the hole."""
    length = hemisphere.RADIUS * (np.pi / 2 - hemisphere.HOLE)

    def along(count: int) -> np.ndarray:
        return lines(count, thickness / np.sqrt(10) / length, 0, 1)

    return ShellCase(
        lambda n: hemisphere.pinched(thickness, on_lines(hemisphere.position, n, along(n))),
        fl.follow_loads,
        (16, 32, 48, DENSE),
        lambda mesh, n: _on_lines(mesh, n, along(n)),
    )


def _on_lines(mesh: fl.mesh.SurfaceMesh, count: int, along: np.ndarray) -> np.ndarray:
    around, line = np.divmod(np.arange(len(mesh.points)), len(along))
    return np.stack([around, count * along[line]], axis=1)


def cylinder_lines(count: int) -> np.ndarray:
    """Lines along the cylinder, whose layer is at the free end."""
    width = pulled_cylinder.THICKNESS / np.sqrt(10)
    return lines(count, width / (0.5 * pulled_cylinder.LENGTH), 1)


def cylinder(count: int) -> fl.Scene:
    """An eighth of the pulled cylinder; a quarter of the force is spread over a pad."""
    mesh = on_lines(pulled_cylinder.position, count, cylinder_lines(count))
    section = fl.ShellSection.layer(pulled_cylinder.THICKNESS, fl.Material(10.5e6, 0.3125, 1.0))
    shell = fl.Shell(mesh, section, director=pulled_cylinder.outward, name="cylinder")
    shell.symmetry("a=0", (0, 1, 0))
    shell.symmetry("a=1", (1, 0, 0))
    shell.symmetry("b=0", (0, 0, 1))
    around, along = PAD * np.pi / 2, PAD * pulled_cylinder.LENGTH / 2
    pressure = pulled_cylinder.FORCE / 4 / (pulled_cylinder.RADIUS * around * along)

    def force(x: np.ndarray) -> tuple[float, float, float]:
        inside = np.arctan2(x[1], x[0]) < around and x[2] < along
        return (pressure if inside else 0.0, 0.0, 0.0)

    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.AreaLoad(shell, force=force))
    return scene


def _half(scene: fl.Scene) -> fl.StaticResult:
    return fl.follow_loads(scene, [0.5])


SHELLS = {
    "Scordelis-Lo roof": ShellCase(
        roof,
        lambda scene: fl.follow_loads(scene, [linear_shells.SMALL]),
        (8, 16, 32, ROOF),
        lambda mesh, n: n * towards_edges(_grid(mesh, n) / n, n),
    ),
    "hemisphere, t = 0.04": hemisphere_case(0.04),
    "hemisphere, t = 0.01": hemisphere_case(0.01),
    "pulled cylinder, pad, half load": ShellCase(
        cylinder,
        _half,
        (16, 32, 48, DENSE),
        lambda mesh, n: _on_lines(mesh, n, cylinder_lines(n)),
    ),
    "plate with a hole": ShellCase(hole, fl.statics, (8, 16, 32, 128), _grid),
    "L-plate": ShellCase(l_plate, fl.statics, (8, 16, 32, 96), _plane),
}


# --- beams ----------------------------------------------------------------------------------------

FORMULATIONS = {
    "geodesic": fl.elements.GeodesicBeam(),
    "director 1": fl.elements.DirectorBeam(1),
    "director 2": fl.elements.DirectorBeam(2),
}
CELLS, FINEST = (8, 16, 32, 64), 1024


Arc = tuple[fl.StaticResult, fl.Beam, fl.Scene]


def arc(cells: int, formulation: fl.elements.BeamFormulation, force: Sequence[float]) -> Arc:
    """An eighth of a circle of radius 100, clamped, under a force at its tip."""
    section = fl.Section.from_stiffness([1e7, 5e6, 5e6, 1e7 / 12, 1e7 / 12, 1e7 / 12])
    scene = fl.Scene()

    def position(s: float) -> np.ndarray:
        angle = s * np.pi / 4
        return 100 * np.array([np.sin(angle), 1 - np.cos(angle), 0.0])

    beam = scene.add(
        fl.Beam.curve(position, section, cells=cells, formulation=formulation, name="arc")
    )
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), force=force))
    return fl.statics(scene, load_steps=3), beam, scene


BEAMS = {"curved cantilever": (0.0, 20.0, 0.0), "45 degree bend": (0.0, 0.0, 600.0)}


def beam_rows(
    formulation: fl.elements.BeamFormulation,
    force: Sequence[float],
    estimate: fl.adaptivity.ErrorEstimate = ESTIMATES[0],
) -> list[Row]:
    """Errors on all meshes but the finest, of one estimate."""
    (fine,) = fields_of(*arc(FINEST, formulation, force))
    norm = fine.energy(fine.recovered).sum()
    rows = []
    for cells in CELLS:
        solved, ratio = arc(cells, formulation, force), FINEST // cells
        (coarse,) = fields_of(*solved)
        q = fine.own.shape[1]
        x, _ = np.polynomial.legendre.leggauss(q)
        at = (0.5 * (1 + x) + np.arange(ratio)[:, np.newaxis]).ravel() / ratio
        own = np.vander(at, q) @ np.linalg.inv(np.vander(0.5 * (1 + x), q))
        true = fine.recovered - np.einsum("aq,mqb->mab", own, coarse.own).reshape(fine.own.shape)
        error = fine.energy(true).sum()
        found = fl.adaptivity.space_error(*solved, estimate=estimate).effectivity(np.sqrt(error))
        unknowns = 6 * cells * (1 if q == 2 else 2)
        rows.append((f"{cells}", unknowns, np.sqrt(error / norm), found))
    return rows


def cost(estimate: fl.adaptivity.ErrorEstimate, repeats: int = 100) -> float:
    """Time of an estimate over that of the elastic forces, 32 x 32 cells, in turns; the median."""
    scene = hemisphere.pinched(0.04, hemisphere.quarter(32))
    result = fl.follow_loads(scene, [0.1])
    (shell,) = scene.bodies
    assembly = shell.model.assemble([shell.model])
    frames = np.empty_like(result.frames[-1])
    frames[assembly.order] = result.frames[-1]
    out, seconds = np.zeros((assembly.count, 6)), np.empty((repeats, 3))
    for row in seconds:
        row[0] = perf_counter()
        assembly.add_forces(frames, out)
        row[1] = perf_counter()
        fl.adaptivity.space_error(result, shell, scene, estimate=estimate)
        row[2] = perf_counter()
    forces, seconds_of_it = np.median(np.diff(seconds, axis=1), axis=0)
    return float(seconds_of_it / forces)


def tables(name: str, meshes: Sequence[int] = ()) -> dict[str, list[list[Row]]]:
    """Rows of each estimate, for each element of a scene, of shells on other meshes if given."""
    if name not in BEAMS:
        case = SHELLS[name]
        case = case._replace(meshes=tuple(meshes)) if meshes else case
        return {"HR": all_shell_rows(case, ESTIMATES)}
    force = BEAMS[name]
    found = {}
    for k, f in FORMULATIONS.items():
        # elements of three nodes are not cut in two
        estimates = ESTIMATES if f.degree == 1 else ESTIMATES[:2]
        found[k] = [beam_rows(f, force, e) for e in estimates]
    return found


def main() -> None:
    """Print tables in Markdown."""
    parser = argparse.ArgumentParser(description=__doc__)
    names = [*BEAMS, *SHELLS]
    parser.add_argument("--case", nargs="+", choices=names, default=names, metavar="NAME")
    parser.add_argument("--cost", action="store_true", help="of an estimate, in forces of a shell")
    parser.add_argument(
        "--meshes", nargs="+", type=int, default=[], help="of shells, the last true"
    )
    given = parser.parse_args()
    if given.cost:
        for estimate in ESTIMATES[:2]:
            print(
                f"{estimate} costs {cost(estimate):.2f} times the elastic forces of 32 x 32 cells"
            )
        return
    heads = " | ".join(type(estimate).__name__ for estimate in ESTIMATES)
    print(f"| scene | element | cells | unknowns | true error | {heads} |")
    print("| --- | --- | --- | --- | --- |" + " --- |" * len(ESTIMATES))
    for name in given.case:
        for element, each in tables(name, given.meshes).items():
            for rows in zip(*each, strict=True):
                cells, unknowns, error, _ = rows[0]
                ratios = " | ".join(
                    [f"{ratio:.3f}" for *_, ratio in rows] + ["–"] * (3 - len(rows))
                )
                size = f"{cells} | {unknowns} | {100 * error:.3g} %"
                print(f"| {name} | {element} | {size} | {ratios} |", flush=True)


if __name__ == "__main__":
    main()
