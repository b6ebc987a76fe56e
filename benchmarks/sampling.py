"""Hyper-reduction: errors over modes and time of reduced-order equilibria.

A cantilever of 200 elements and a twisted plate of 20 x 20 cells, bent by a tenth of their length
in eight load steps, in linear modes, these with modal derivatives (the beam), POD by the same
load at 12 ... 120 % of its size, and POD with few cells that have weights (ECSW). LowRankCorrection
it cells that interpolate forces (DEIM). Seconds are those of the iterations; what is done once is
apart.

Writes docs/measured/sampling.csv and, with ``--plot``, docs/measured/sampling.png.
"""

from __future__ import annotations

import argparse
import csv
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np

import fem_lie as fl
from fem_lie.reduction.energy_sampling import ReducedCells
from fem_lie.reduction.sampled_equilibria import ReducedLoads, equilibria, loads_of

RUBBER = fl.Material(E=5e6, nu=0.3, density=1100.0)
LEVELS = np.linspace(0.125, 1.0, 8)
FIXED = fl.reduction.FixedAxes()
DOCS = Path(__file__).parents[1] / "docs" / "measured"


def cantilever(factor: float) -> tuple[fl.Scene, fl.Beam]:
    """With a force askew at its end."""
    scene = fl.Scene()
    section = fl.Section.rectangle(0.01, 0.015, RUBBER)
    beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=200, name="beam"))
    scene.add(fl.Clamp(beam.point("start")))
    if factor:
        scene.add(
            fl.PointLoad(beam.point("end"), force=factor * 1.6e-3 * np.array([0.0, 1.0, 1.5]))
        )
    return scene, beam


def plate(factor: float) -> tuple[fl.Scene, fl.Shell]:
    """A strip, turned by its length, with a force at a corner."""
    scene = fl.Scene()
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, 0.5 * b, 0.1 * a * b), (20, 20))
    shell = scene.add(fl.Shell(mesh, fl.ShellSection.layer(0.01, RUBBER), name="plate"))
    shell.clamp("a=0")
    if factor:
        scene.add(fl.PointLoad(shell.point("11"), force=(0.0, 0.0, factor * 0.06)))
    return scene, shell


class Row(NamedTuple):
    """Of the table.

    Attributes:
        scene: Beam or plate.
        shapes: By which rule they are made.
        modes: How many there are.
        cells: Which have forces.
        error: Largest of a position, over the deflection.
        milliseconds: For all load steps.
        asymmetry: Of the matrix at the end.
    """

    scene: str
    shapes: str
    modes: int
    cells: int
    error: float
    milliseconds: float
    asymmetry: float


class Interpolated:
    """DEIM of the forces of each cell in the shapes: those of few cells, times a matrix."""

    def __init__(self, states: fl.reduction.ReducedStates, rank: int) -> None:
        """S. Chaturantabut & D. C. Sorensen, SIAM J. Sci. Comput. 32 (2010) 2737."""
        basis = states.basis
        count, self.m = len(basis.body.model.elastic_cells), len(basis)
        every = ReducedCells(basis, np.arange(count), np.ones(count))
        snapshots = np.array([every.of_each(η).ravel() for η in states.coordinates])
        U = np.linalg.svd(snapshots, full_matrices=False)[2][:rank].T
        chosen = [int(np.abs(U[:, 0]).argmax())]
        for k in range(1, rank):
            left = U[:, k] - U[:, :k] @ np.linalg.solve(U[chosen, :k], U[chosen, k])
            chosen.append(int(np.abs(left).argmax()))
        cells, self.which = np.divmod(chosen, self.m)
        self.cells, self.position = np.unique(cells, return_inverse=True)
        self.matrix = U.reshape(count, self.m, rank).sum(axis=0) @ np.linalg.inv(U[chosen])
        self.some = ReducedCells(basis, self.cells, np.ones(len(self.cells)))

    def forces(self, η: np.ndarray) -> np.ndarray:
        """Of all cells, as they are interpolated."""
        return self.matrix @ self.some.of_each(η)[self.position, self.which]

    def forces_and_matrix(self, η: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """And their derivative, by differences."""
        steps = 1e-6 * np.eye(self.m)
        slopes = [(self.forces(η + d) - self.forces(η - d)) / 2e-6 for d in steps]
        return self.forces(η), np.array(slopes).T


class Case:
    """A scene with its full equilibrium."""

    def __init__(self, name: str) -> None:
        """Solve for it, and for the states of training."""
        self.name, self.make = name, {"beam": cantilever, "plate": plate}[name]
        self.scene, self.body = self.make(1.0)
        began = time.perf_counter()
        full = fl.statics(self.scene, levels=LEVELS)
        self.milliseconds = 1e3 * (time.perf_counter() - began)
        self.position = full.frames[-1, full.info.body(name).nodes, 0]
        self.away = float(np.linalg.norm(self.position - self.body.frames[:, 0], axis=1).max())
        training, self.trained_body = self.make(1.2)
        self.trained = fl.statics(training, levels=np.linspace(0.1, 1.0, 10))

    def here(self, basis: fl.reduction.Basis) -> fl.reduction.Basis:
        """The same shapes of the body of the scene."""
        return basis.transferred(self.body)

    def pod(self, modes: int) -> tuple[fl.reduction.Basis, fl.reduction.ReducedStates]:
        """Shapes of the training, and its states in them."""
        basis = self.here(fl.reduction.pod(self.trained, self.trained_body, modes, axes=FIXED))
        return basis, basis.project(self.trained, axes=FIXED)

    def row(
        self, shapes: str, basis: fl.reduction.Basis, cells, count: int, loads: ReducedLoads
    ) -> Row:
        """Best of three."""
        best = np.inf
        for _ in range(3):
            began = time.perf_counter()
            found = equilibria(cells, loads, basis, LEVELS)
            best = min(best, time.perf_counter() - began)
        K = cells.forces_and_matrix(found.coordinates[-1])[1]
        error = np.linalg.norm(found.frames[-1, :, 0] - self.position, axis=1).max() / self.away
        asymmetry = float(np.abs(K - K.T).max() / np.abs(K).max())
        return Row(self.name, shapes, len(basis), count, float(error), 1e3 * best, asymmetry)

    def with_all(self, shapes: str, basis: fl.reduction.Basis) -> Row:
        """Forces of all cells."""
        count = len(self.body.model.elastic_cells)
        every = ReducedCells(basis, np.arange(count), np.ones(count))
        return self.row(shapes, basis, every, count, loads_of(self.scene, basis))

    def rows(self, most: int) -> list[Row]:
        """All of the table."""
        found, still = [], self.make(0.0)[0]
        for modes in (2, 4, 6, 8):
            linear = fl.reduction.craig_bampton(still, [], modes)
            found.append(self.with_all("linear", self.here(linear)))
            if self.name == "beam":
                both = fl.reduction.with_derivatives(still, linear)
                found.append(self.with_all("derivatives", self.here(both)))
        for modes in range(2, most + 1):
            basis, states = self.pod(modes)
            loads = loads_of(self.scene, basis)
            found.append(self.with_all("pod", basis))
            for tolerance in (1e-2, 1e-3, 1e-4, 1e-6):
                began = time.perf_counter()
                sample = fl.reduction.ecsw(states, tolerance)
                took = time.perf_counter() - began
                row = self.row(
                    f"ecsw {tolerance:g}", basis, sample.reduced_cells(), len(sample.cells), loads
                )
                print(f"{self.name} {row.shapes}: sampling took {took:.2f} s")
                found.append(row)
            for rank in (modes, 2 * modes):
                deim = Interpolated(states, rank)
                found.append(self.row(f"deim {rank}", basis, deim, len(deim.cells), loads))
        return found


def plot(rows: list[Row], full: dict[str, float], path: Path) -> None:
    """Error over time."""
    import matplotlib.pyplot as plt

    figure, both = plt.subplots(1, 2, figsize=(10, 4.2), layout="constrained", sharey=True)
    for axes, name in zip(both, full, strict=True):
        groups = ("linear", "derivatives", "pod", "ecsw 0.001", "ecsw 1e-06")
        for k, (group, mark) in enumerate(zip(groups, "xd^os", strict=True)):
            some = [r for r in rows if r.scene == name and r.shapes == group]
            if some:
                axes.loglog([r.milliseconds for r in some], [r.error for r in some], mark + "-",
                            color=f"C{k}", label=group)  # fmt: skip
                for r in some:
                    axes.annotate(str(r.modes), (r.milliseconds, r.error), xytext=(4, 3),
                                  textcoords="offset points", fontsize=7)  # fmt: skip
        axes.axvline(full[name], color="k", lw=0.8, ls="--", label="all unknowns")
        axes.axhline(0.01, color="grey", lw=0.6)
        axes.set(title=name, xlabel="ms for eight equilibria")
        axes.legend(fontsize=8)
    both[0].set_ylabel("error of a position over the deflection")
    figure.savefig(path, dpi=110)


def main(draw: bool = False) -> list[Row]:
    """Rows, printed and written."""
    rows: list[Row] = []
    full = {}
    for name, most in (("beam", 3), ("plate", 4)):
        case = Case(name)
        full[name] = case.milliseconds
        print(f"{name}: deflection {case.away:.3g}, all unknowns {case.milliseconds:.0f} ms")
        rows += case.rows(most)
    print("scene   shapes        modes  cells     error       ms  asymmetry")
    for r in rows:
        print(f"{r.scene:8}{r.shapes:14}{r.modes:5}{r.cells:7}{r.error:10.2g}{r.milliseconds:9.1f}"
              f"{r.asymmetry:11.1g}")  # fmt: skip
    if draw:
        plot(rows, full, DOCS / "sampling.png")
        with (DOCS / "sampling.csv").open("w", newline="") as file:
            csv.writer(file).writerows([Row._fields, *rows])
    return rows


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--plot", action="store_true")
    main(parser.parse_args().plot)
