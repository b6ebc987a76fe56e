"""What it costs to assemble beams: residual and tangent of 20 and of 20 000 cells.

- geodesic, director1, director2: the elements of ``fem_lie.Beam``, as the integrators call
  them, with coefficients packed once
- directors: an energy in positions and directors, in local frames, through ``dolfinx.fem``, which
  packs coefficients anew in every call
- plain: the derivative of the same energy as FFCx makes it, 12 unknowns per node, no local frames;
  its matrix is filled with blocks of 12 through PETSc, the others' with blocks of 6 natively

Best of several runs, on one core.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from time import perf_counter

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem import petsc

import fem_lie as fl
from demos.forms.clamped import line
from fem_lie.bodies.beams.assembly import BeamAssembly

CELLS = (20, 20_000)
FORMULATIONS = {
    "geodesic": fl.elements.GeodesicBeam(),
    "director1": fl.elements.DirectorBeam(1),
    "director2": fl.elements.DirectorBeam(2),
}
STIFFNESS = np.array([1e4, 4e3, 4e3, 1.0, 1.0, 1.0])


def best(function: Callable[[], object], repetitions: int, runs: int = 7) -> float:
    """Shortest time of a call, seconds."""
    function()
    times = []
    for _ in range(runs):
        start = perf_counter()
        for _ in range(repetitions):
            function()
        times.append((perf_counter() - start) / repetitions)
    return min(times)


def beam(cells: int) -> Iterator[tuple[str, Callable[[], object]]]:
    section = fl.Section.from_stiffness(STIFFNESS)
    for name, formulation in FORMULATIONS.items():
        line = fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=cells, formulation=formulation)
        assembly = BeamAssembly([line])
        H, out = np.empty_like(line.frames), np.zeros(6 * len(line.frames))
        H[assembly.order] = line.frames
        yield f"{name}, residual", partial(assembly.add_forces, H, out)
        yield f"{name}, energy", partial(assembly.energy, H)
        yield f"{name}, tangent", partial(assembly.tangent, H, np.zeros((len(H), 6)))
        yield f"{name}, linearised stress", partial(assembly.reset_stress, H)


def directors(cells: int) -> Iterator[tuple[str, Callable[[], object]]]:
    q = fl.NodalFrames(line(cells, comm=MPI.COMM_SELF))
    stretch, kappa = fl.elements.director_strains(q)
    strain = ufl.as_vector([stretch[0] - 1, stretch[1], stretch[2], *kappa])
    D = ufl.as_vector([float(d) for d in STIFFNESS])
    dx = ufl.Measure("dx", metadata={"quadrature_degree": 1})
    energy = sum(0.5 * D[i] * strain[i] ** 2 for i in range(6)) * dx
    forms = fl.local_frame_forms(energy, q)
    b = fem.assemble_vector(forms.residual)
    A = fem.create_matrix(forms.tangent)
    yield "directors, residual", lambda: fem.assemble_vector(b.array, forms.residual)
    yield "directors, tangent", lambda: _filled(A, forms.tangent)

    test, trial = (f(q.function.function_space) for f in (ufl.TestFunction, ufl.TrialFunction))
    gradient = ufl.derivative(energy, q.function, test)
    residual, tangent = fem.form(gradient), fem.form(ufl.derivative(gradient, q.function, trial))
    c, P = fem.assemble_vector(residual), petsc.create_matrix(tangent)
    yield "plain, residual", lambda: fem.assemble_vector(c.array, residual)
    yield "plain, tangent", lambda: _filled_petsc(P, tangent)


def _filled(A: fem.MatrixCSR, form: fem.Form) -> None:
    A.set_value(0.0)
    fem.assemble_matrix(A, form)


def _filled_petsc(A: PETSc.Mat, form: fem.Form) -> None:
    A.zeroEntries()
    petsc.assemble_matrix(A, form)
    A.assemble()


def main() -> None:
    times: dict[str, list[float]] = {}
    for cells in CELLS:
        for family in (beam, directors):
            for name, call in family(cells):
                times.setdefault(name, []).append(best(call, 2000 if cells == 20 else 2))
    print("                           20 cells      20 000 cells")
    print("                           µs per call   µs per cell")
    for name, (few, many) in times.items():
        print(f"{name:26} {1e6 * few:8.1f}      {1e6 * many / CELLS[1]:8.3f}")


if __name__ == "__main__":
    main()
