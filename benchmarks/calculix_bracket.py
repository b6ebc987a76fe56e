"""The bracket of demos/bracket.py in CalculiX, on the same mesh: bolts, tip, frequencies.

    tools/run python3 -m benchmarks.calculix_bracket --write

writes the input, runs CalculiX, prints both results and, with ``--write``, records those of
CalculiX in ``demos/reference/bracket.json``. ``--draw`` makes the STEP files of the demo first.
CalculiX is the program named by the variable ``CCX``, or ``ccx`` on the path, or Debian's package
with the libraries that it needs, which apt downloads into the cache folder where its lists have it;
nothing is installed.

The input knows nothing of this library but the nodes, the cells and the sets of the mesh:

- bracket: C3D10; arm: C3D20 bricks, ``CELLS`` along its axes;
- rigid bolt to the ground: the nodes of the hole are held, their reactions summed;
- rigid bolt to the arm: a ``*RIGID BODY`` of the nodes of the hole and of the first section;
- clamp at its end: another one, whose reference node carries the force;
- bolt that holds the mean motion: ``sum w u = 0`` and ``sum w (x - x0) x u = 0`` as six equations,
  solved for six displacements as ``*EQUATION`` needs it. Its force is that of equilibrium.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import scipy.linalg

import fem_lie as fl
from fem_lie._arrays import Array, Indices

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "demos"))
import bracket as demo  # noqa: E402

PACKAGES = (
    "calculix-ccx libspooles2.2 libspooles2.2t64 libarpack2 libarpack2t64 libgfortran5 libblas3 "
    "liblapack3"
).split()
"""Debian's packages; libraries have either of two names, by release."""

CELLS, MODES = (30, 4, 2), 6
_C3D10 = [0, 1, 2, 3, 9, 6, 8, 7, 5, 4]
"""CalculiX's nodes of a tetrahedron among those of DOLFINx."""

_HEXAHEDRON = np.array(
    [
        *[(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)],
        *[(1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2)],
        *[(0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1)],
    ]
)
"""Nodes of C3D20, in half edges."""


def environment() -> tuple[str, dict[str, str]]:
    """Program and environment of CalculiX, downloaded if there is none.

    Raises:
        SystemExit: It is neither on the path nor to be had by apt.
    """
    if found := shutil.which(os.environ.get("CCX", "ccx")):
        return found, dict(os.environ)
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    folder = cache / "fem_lie" / "environment" / "calculix"
    program = folder / "usr" / "bin" / "ccx"
    if not program.exists():
        folder.mkdir(parents=True, exist_ok=True)
        for package in PACKAGES:
            subprocess.run(
                ["apt-get", "download", package], cwd=folder, check=False, capture_output=True
            )
        for archive in folder.glob("*.deb"):
            subprocess.run(["dpkg", "-x", archive, folder], check=True)
        if not program.exists():
            raise SystemExit("no ccx on the path, and apt cannot download calculix-ccx")
    libraries = {str(file.parent) for file in folder.rglob("*.so*")}
    known = os.environ.get("LD_LIBRARY_PATH", "")
    return str(program), {**os.environ, "LD_LIBRARY_PATH": ":".join([*sorted(libraries), known])}


class Arm:
    """Bricks of the arm: nodes, cells, nodes of the first section and of the last one."""

    def __init__(self, first: int) -> None:
        """Number the nodes from ``first``."""
        cells = np.array(list(np.ndindex(*CELLS)))
        grid = 2 * cells[:, np.newaxis] + _HEXAHEDRON
        known, numbers = np.unique(grid.reshape(-1, 3), axis=0, return_inverse=True)
        edges = np.array([demo.LENGTH, demo.WIDTH, demo.THICKNESS])
        corner = demo.START - 0.5 * edges * (0.0, 1.0, 1.0)
        self.nodes: Array = corner + 0.5 * edges / CELLS * known
        self.cells: Indices = first + numbers.reshape(-1, 20)
        self.root: Indices = first + np.flatnonzero(known[:, 0] == 0)
        self.tip: Indices = first + np.flatnonzero(known[:, 0] == 2 * CELLS[0])


def mean_motion(x: Array, weights: Array) -> tuple[Array, Indices]:
    """Six equations without mean translation and rotation (6, 3n), and the dependent columns."""
    arms = x - weights @ x / weights.sum()
    rows = np.zeros((6, len(x), 3))
    for k, unit in enumerate(np.eye(3)):
        rows[k, :, k] = weights
        rows[3 + k] = weights[:, np.newaxis] * np.cross(unit, arms)
    matrix = rows.reshape(6, -1) / weights.sum()
    pivots = scipy.linalg.qr(matrix, mode="economic", pivoting=True)[2][:6]
    return np.linalg.solve(matrix[:, pivots], matrix), pivots


def lines(values: Iterable[object], each: int) -> str:
    """Values separated by commas, some on each line."""
    words = [str(value) for value in values]
    return ",\n".join(", ".join(words[k : k + each]) for k in range(0, len(words), each))


def deck(solid: fl.Solid) -> tuple[str, dict[str, Indices], Arm]:
    """Input of CalculiX, its sets of nodes, and the arm. Nodes are numbered from 1."""
    x, model = solid.frames[:, 0], solid.model
    arm = Arm(len(x) + 1)
    reference = len(x) + len(arm.nodes) + 1
    sets = {name: 1 + solid.nodes(name) for name in ("rigid", "mean", "upper")}
    sets |= {"bolt": np.concatenate([sets["upper"], arm.root]), "clamp": arm.tip}
    end = demo.START + demo.LENGTH * np.eye(3)[0]
    nodes = np.vstack([x, arm.nodes, demo.START, demo.START, end, end])
    cells = {"C3D10": 1 + model.connectivity[:, _C3D10], "C3D20": arm.cells}
    rows = [f"{k + 1}, " + ", ".join(f"{value:.12e}" for value in at) for k, at in enumerate(nodes)]
    text = ["*NODE, NSET=ALL", *rows]
    number = 1
    for kind, of in cells.items():
        text.append(f"*ELEMENT, TYPE={kind}, ELSET={kind}")
        for cell in of:
            text.append(lines([number, *cell], 11))
            number += 1
    for name, members in sets.items():
        text += [f"*NSET, NSET={name.upper()}", lines(members, 8)]
    steel = demo.STEEL
    text += [
        f"*MATERIAL, NAME=STEEL\n*ELASTIC\n{steel['E']}, {steel['nu']}",
        f"*DENSITY\n{steel['density']}",
        *(f"*SOLID SECTION, ELSET={kind}, MATERIAL=STEEL" for kind in cells),
        f"*RIGID BODY, NSET=BOLT, REF NODE={reference}, ROT NODE={reference + 1}",
        f"*RIGID BODY, NSET=CLAMP, REF NODE={reference + 2}, ROT NODE={reference + 3}",
        "*BOUNDARY\nRIGID, 1, 3",
    ]
    faces, total = model.facets("mean"), np.zeros(len(x))
    np.add.at(total, faces.nodes, faces.consistent_areas(x))
    held = sets["mean"] - 1
    for row, pivot in zip(*mean_motion(x[held], total[held]), strict=True):
        order = [int(pivot), *(int(k) for k in np.flatnonzero(np.abs(row) > 1e-14) if k != pivot)]
        terms = [f"{held[k // 3] + 1}, {k % 3 + 1}, {row[k]:.12e}" for k in order]
        text += [f"*EQUATION\n{len(terms)}", lines(terms, 4)]
    text += ["*STEP\n*STATIC\n*CLOAD"]
    text += [f"{reference + 2}, {k + 1}, {f:.12e}" for k, f in enumerate(demo.FORCE) if f]
    text += [
        "*NODE PRINT, NSET=RIGID\nRF\n*NODE PRINT, NSET=CLAMP\nU\n*END STEP",
        f"*STEP\n*FREQUENCY\n{MODES}\n*END STEP",
    ]
    return "\n".join(text) + "\n", sets, arm


def run(text: str) -> str:
    """Printed results of CalculiX for an input."""
    program, variables = environment()
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "bracket.inp").write_text(text, encoding="utf-8")
        command, quiet = [program, "bracket"], {"capture_output": True, "text": True}
        done = subprocess.run(command, cwd=folder, env=variables, check=False, **quiet)
        printed = Path(folder, "bracket.dat")
        if done.returncode or not printed.exists():
            raise SystemExit(f"CalculiX failed:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
        return printed.read_text(encoding="utf-8")


def table(printed: str, heading: str) -> Array:
    """Rows of numbers below the first heading that contains some text."""
    rows: list[list[float]] = []
    below = printed[printed.index(heading) :].splitlines()[1:]
    for line in below:
        try:
            rows.append([float(word) for word in line.split()])
        except ValueError:
            break
    return np.array([row for row in rows if row])


def reference(size: float) -> dict[str, Any]:
    """Results of CalculiX as the demo names them."""
    steel = fl.sections.SaintVenantKirchhoff(**demo.STEEL)
    solid = fl.Solid(demo.meshes(size)[0], steel, name="bracket")
    text, sets, arm = deck(solid)
    printed = run(text)
    headings = "forces (fx,fy,fz)", "displacements (vx,vy,vz)", "(RAD/TIME)"
    forces, moved, modes = (table(printed, heading) for heading in headings)
    x = solid.frames[:, 0]
    at = forces[:, 0].astype(int) - 1
    # on the ground, as the joints of the demo report it
    on_ground = -forces[:, 1:]
    rigid = x[sets["rigid"] - 1].mean(axis=0)
    moments = [np.cross(x[at] - centre, on_ground).sum(axis=0) for centre in (rigid, 0.0 * rigid)]
    force, end = np.array(demo.FORCE), demo.START + demo.LENGTH * np.eye(3)[0]
    total, mean = on_ground.sum(axis=0), solid.point("mean").position
    other = np.cross(end, force) - moments[1] - np.cross(mean, force - total)
    # the clamp is rigid: the mean of its nodes moves as its centre
    nodes = arm.nodes[arm.tip - len(x) - 1]
    order = np.searchsorted(arm.tip, moved[:, 0].astype(int))
    central = np.linalg.norm(nodes[order] - end, axis=1).argmin()
    return {
        "tip": moved[central, 1:].tolist(),
        "forces": [total.tolist(), (force - total).tolist()],
        "moments": [moments[0].tolist(), other.tolist()],
        "frequencies": modes[:MODES, 2].tolist(),
    }


def draw() -> None:
    """Write the parts of the demo as STEP: an L of two plates of 8 mm with three holes; the arm."""
    import gmsh

    gmsh.initialize(["gmsh", "-v", "0"])
    occ, (a, b, c) = gmsh.model.occ, 1e3 * demo.START
    plates = [[(3, occ.addBox(0, 0, 0, *edges))] for edges in ((100, 80, 8), (8, 80, 90))]
    *base, (y, z, radius) = (1e3 * np.array(hole) for hole in demo.HOLES.values())
    holes = [occ.addCylinder(u, v, -1, 0, 0, 10, r) for u, v, r in base]
    holes.append(occ.addCylinder(-1, y, z, 10, 0, 0, radius))
    occ.cut(occ.fuse(*plates)[0], [(3, hole) for hole in holes])
    occ.synchronize()
    gmsh.write(str(demo.REFERENCE / "bracket.step"))
    gmsh.clear()
    occ.addRectangle(a, b - 500 * demo.WIDTH, c, 1e3 * demo.LENGTH, 1e3 * demo.WIDTH)
    occ.synchronize()
    gmsh.write(str(demo.REFERENCE / "arm.step"))
    gmsh.finalize()


def main() -> None:
    """Compare, and record what CalculiX finds."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", type=float, default=0.012, help="size of the cells, m")
    parser.add_argument("--write", action="store_true", help="record the results of CalculiX")
    parser.add_argument("--draw", action="store_true", help="make the STEP files")
    given = parser.parse_args()
    if given.draw:
        draw()
    theirs = reference(given.size)
    if given.write:
        text = json.dumps(theirs, indent=1) + "\n"
        (demo.REFERENCE / "bracket.json").write_text(text, encoding="utf-8")
    ours = demo.main(given.size, pictures=False)
    for key, value in theirs.items():
        print(f"{key:12} CalculiX {np.round(value, 8)}\n{'':12} fem_lie  {np.round(ours[key], 8)}")
    print(ours["errors"])


if __name__ == "__main__":
    main()
