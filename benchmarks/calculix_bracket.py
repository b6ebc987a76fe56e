"""The bracket of demos/bracket.py in CalculiX, on the same mesh: bolts, tip, frequencies.

    tools/run python3 -m benchmarks.calculix_bracket --write

writes the input, runs CalculiX, prints both results and, with ``--write``, records those of
CalculiX in ``demos/reference/bracket.json``. CalculiX is the program named by the variable ``CCX``,
or ``ccx`` on the path, or Debian's package with the libraries that it needs, which apt downloads
into the cache folder where its lists have it; nothing is installed.

The input knows nothing of this library but the nodes, the cells and the sets of the mesh:

- bracket: C3D10; arm: C3D20 bricks, ``SECTIONS`` of 2 x 2 along its length;
- rigid bolt to the ground: the nodes of the hole are held, their reactions summed;
- rigid bolt to the arm: a ``*RIGID BODY`` of the nodes of the hole and of the first section;
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

SECTIONS, MODES = 30, 6
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
    """Bricks of the arm: nodes, cells, first section, fractions of the force on the last one."""

    def __init__(self, first: int) -> None:
        """Number the nodes from ``first``."""
        cells = np.array([(i, j, k) for i in range(SECTIONS) for j in (0, 1) for k in (0, 1)])
        grid = 2 * cells[:, np.newaxis] + _HEXAHEDRON
        known, numbers = np.unique(grid.reshape(-1, 3), axis=0, return_inverse=True)
        edges = np.array([demo.LENGTH / SECTIONS, demo.SIDE / 2, demo.SIDE / 2])
        corner = demo.START - (0.0, demo.SIDE / 2, demo.SIDE / 2)
        self.nodes: Array = corner + 0.5 * edges * known
        self.cells: Indices = first + numbers.reshape(-1, 20)
        self.root: Indices = first + np.flatnonzero(known[:, 0] == 0)
        self.tip: Indices = first + np.flatnonzero(known[:, 0] == 2 * SECTIONS)
        # consistent loads of a uniform traction on four faces of eight nodes
        j, k = known[known[:, 0] == 2 * SECTIONS][:, 1:].T
        faces = np.where(j % 4 == 2, 2, 1) * np.where(k % 4 == 2, 2, 1)
        corners = (j % 2 == 0) & (k % 2 == 0)
        self.fractions: Array = faces * np.where(corners, -1 / 12, 1 / 3) / 4.0


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
    sets |= {"rigidbody": np.concatenate([sets["upper"], arm.root]), "tip": arm.tip}
    nodes = np.vstack([x, arm.nodes, demo.START, demo.START])
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
        f"*RIGID BODY, NSET=RIGIDBODY, REF NODE={reference}, ROT NODE={reference + 1}",
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
    for node, part in zip(arm.tip, arm.fractions, strict=True):
        text += [f"{node}, {k + 1}, {part * f:.12e}" for k, f in enumerate(demo.FORCE) if f]
    text += [
        "*NODE PRINT, NSET=RIGID\nRF\n*NODE PRINT, NSET=TIP\nU\n*END STEP",
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
    solid = fl.Solid(
        demo.bracket_mesh(size), fl.sections.SaintVenantKirchhoff(**demo.STEEL), name="bracket"
    )
    text, sets, arm = deck(solid)
    printed = run(text)
    headings = "forces (fx,fy,fz)", "displacements (vx,vy,vz)", "(RAD/TIME)"
    forces, moved, modes = (table(printed, heading) for heading in headings)
    x = solid.frames[:, 0]
    at = forces[:, 0].astype(int) - 1
    # on the ground, as the joints of the demo report it
    on_ground = -forces[:, 1:]
    arms = x[at] - x[sets["rigid"] - 1].mean(axis=0)
    rigid = np.concatenate([on_ground.sum(axis=0), np.cross(arms, on_ground).sum(axis=0)])
    frame = solid.point("mean").position
    force, end = np.array(demo.FORCE), demo.START + demo.LENGTH * np.eye(3)[0]
    mean_force = force - rigid[:3]
    about = np.cross(end - frame, force) - np.cross(x[at] - frame, on_ground).sum(axis=0)
    order = np.searchsorted(arm.tip, moved[:, 0].astype(int))
    return {
        "nodes": len(x),
        "rigid_bolt": rigid.tolist(),
        "mean_bolt": [*mean_force, *about],
        "tip": (arm.fractions[order] @ moved[:, 1:]).tolist(),
        "frequencies": modes[:MODES, 2].tolist(),
    }


def main() -> None:
    """Compare, and record what CalculiX finds."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", type=float, default=0.012, help="size of the cells, m")
    parser.add_argument("--write", action="store_true", help="record the results of CalculiX")
    given = parser.parse_args()
    theirs = reference(given.size)
    ours = demo.main(given.size, pictures=False)
    for key, value in theirs.items():
        print(f"{key:12} CalculiX {np.round(value, 8)}\n{'':12} fem_lie  {np.round(ours[key], 8)}")
    if given.write:
        demo.REFERENCE.write_text(json.dumps(theirs, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
