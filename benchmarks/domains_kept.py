"""BDDC kept over steps: a shell that tumbles, in nodal local frames and along fixed axes.

    tools/run mpirun --oversubscribe -n 4 python3 -m benchmarks.domains_kept --axes local

The free shell of :mod:`.domains` is thrown, bent by its inertia, and turns; steps of 1 ms by
generalised-α (radius 0.8). Matrix and preconditioner are frozen, and made again in an iteration
that has not converged in :data:`PATIENCE`. Along fixed axes it is the same matrix, times the
rotations of all nodes when it was made. Prints a row: subdomains, unknowns, axes, steps, angle that
the shell turns by, how often they were made, iterations of Newton per step and of conjugate
gradients per solution, seconds of the whole, energy at the end over that at the start.
"""

from __future__ import annotations

import argparse
from time import perf_counter

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np
from dolfinx import fem, la

from benchmarks.domains import STEP, Case, energy, inertia, parts_summed, solver, square, tilt
from fem_lie import lie
from fem_lie.forms.frames import NodalFrames, local_frame_forms

ALPHA_M, ALPHA_F = 1 / 3, 4 / 9
GAMMA = 0.5 + ALPHA_F - ALPHA_M
BETA = (GAMMA + 0.5) ** 2 / 4
MASS = (1 - ALPHA_M) / (STEP**2 * BETA * (1 - ALPHA_F))
PATIENCE, GIVES_UP, SMALL, TOLERANCE = 8, 30, 1e-8, 1e-4
BENDS = 0.2


class Tumbling:
    """A free shell, its forces, and a kept preconditioner.

    Attributes:
        made: How often that was made.
        newton: Solutions, ``krylov``: iterations in them.
    """

    def __init__(self, cells: tuple[int, int], asked: Case, *, local: bool) -> None:
        """At rest in its place."""
        self._asked, self._local = asked, local
        self.q = NodalFrames(square(cells, asked.curved), 2)
        if asked.curved:
            tilt(self.q, self.q.increment.function_space.tabulate_dof_coordinates())
        self._forms = local_frame_forms(energy(self.q, asked.thickness, 5), self.q)
        self._inertia = inertia(self.q, asked.thickness)
        space = self.q.increment.function_space
        self.owned = space.dofmap.index_map.size_local
        self.unknowns = 6 * space.dofmap.index_map.size_global
        self._sum = fem.Function(space)
        self.mass = self._summed(self._inertia / MASS)
        self.made = self.newton = self.krylov = 0
        self._ksp: PETSc.KSP | None = None

    def _summed(self, values: np.ndarray) -> np.ndarray:
        """Of all subdomains, at all nodes."""
        self._sum.x.array[:] = values.ravel()
        self._sum.x.scatter_reverse(la.InsertMode.add)
        self._sum.x.scatter_forward()
        return self._sum.x.array.reshape(-1, 6).copy()

    def forces(self) -> np.ndarray:
        """Internal ones of all nodes."""
        return self._summed(fem.assemble_vector(self._forms.residual).array)

    def make(self) -> None:
        """Matrix and preconditioner of the present position."""
        n = self._inertia.size
        part = fem.assemble_matrix(self._forms.tangent).to_scipy(ghosted=True).tocsr()[:, :n]
        # what is not symmetric are forces at nodes
        self._A = parts_summed(self.q, (0.5 * (part + part.T)).tocsr(), self._inertia)
        self._ksp = solver(self._A, self._asked)
        self._ksp.setTolerances(rtol=TOLERANCE)
        self._ksp.setUp()
        self._b, self._x = self._A.createVecs()
        self._axes = self.q.frames[:, 1:].copy()
        self.made += 1

    def solve(self, r: np.ndarray) -> np.ndarray:
        """An increment of all nodes, by what is kept."""
        assert self._ksp is not None
        turn = np.broadcast_to(np.eye(3), self._axes.shape)
        if not self._local:  # into global axes of now, and back into those of then
            turn = np.einsum("nik,njk->nij", self._axes, self.q.frames[:, 1:])
        there = np.einsum("nij,nkj->nki", turn, r.reshape(-1, 2, 3))
        self._b.array[:] = there[: self.owned].ravel()
        self._ksp.solve(self._b, self._x)
        self.newton += 1
        self.krylov += self._ksp.getIterationNumber()
        self._sum.x.array[: 6 * self.owned] = self._x.array
        self._sum.x.scatter_forward()
        found = self._sum.x.array.reshape(-1, 2, 3)
        return np.einsum("nij,nki->nkj", turn, found).reshape(-1, 6)

    def energies(self, v: np.ndarray) -> float:
        """Kinetic and elastic."""
        kinetic = 0.5 * float((self.mass * v * v)[: self.owned].sum())
        own = kinetic + fem.assemble_scalar(self._forms.energy)
        return float(MPI.COMM_WORLD.allreduce(own))


def balance(scene: Tumbling, v: np.ndarray, dv: np.ndarray) -> np.ndarray:
    """Of inertia and internal forces."""
    p = scene.mass * v
    r = scene.mass * dv + scene.forces()
    r[:, :3] += np.cross(v[:, 3:], p[:, :3])
    r[:, 3:] += np.cross(v[:, 3:], p[:, 3:])
    return r


def step(scene: Tumbling, v: np.ndarray, dv: np.ndarray, a: np.ndarray) -> list[np.ndarray]:
    """To the next velocities and accelerations."""
    H = scene.q.frames.copy()
    dv1 = dv.copy()
    a1 = ((1 - ALPHA_F) * dv1 + ALPHA_F * dv - ALPHA_M * a) / (1 - ALPHA_M)
    d = STEP * v + STEP**2 * ((0.5 - BETA) * a + BETA * a1)
    v1 = v + STEP * ((1 - GAMMA) * a + GAMMA * a1)
    for k in range(GIVES_UP):
        for i in range(len(H)):
            lie.retract(H[i], d[i], scene.q.frames[i])
        if scene._ksp is None or k == PATIENCE:
            scene.make()
        change = -scene.solve(balance(scene, v1, dv1))
        d, dv1, v1 = d + change, dv1 + MASS * change, v1 + GAMMA / BETA / STEP * change
        size = MPI.COMM_WORLD.allreduce(float(np.abs(change).max()), op=MPI.MAX)
        if size < SMALL:
            break
    else:
        raise ArithmeticError(f"a step has not converged: {size:.1e}")
    for i in range(len(H)):
        lie.retract(H[i], d[i], scene.q.frames[i])
        lie.reorthonormalise(scene.q.frames[i])
    return [v1, dv1, ((1 - ALPHA_F) * dv1 + ALPHA_F * dv - ALPHA_M * a) / (1 - ALPHA_M)]


def run(scene: Tumbling, steps: int, spin: np.ndarray) -> str:
    """Throw it; a row."""
    x, R = scene.q.frames[:, 0], scene.q.frames[:, 1:]
    wave, across = 2 * np.pi * x[:, :1], np.eye(3)[[2, 1]]
    bends = BENDS * np.sin(wave) * across[0], -2 * np.pi * BENDS * np.cos(wave) * across[1]
    both = np.cross(spin, x) + bends[0], spin + bends[1]
    local = [np.einsum("nij,nj->ni", R, given) for given in both]
    v = np.hstack(local)
    dv, begin, start = np.zeros_like(v), perf_counter(), scene.energies(v)
    dv = -balance(scene, v, dv) / scene.mass
    a = dv.copy()
    for _ in range(steps):
        v, dv, a = step(scene, v, dv, a)
    seconds, world = perf_counter() - begin, MPI.COMM_WORLD
    row = [world.size, scene.unknowns, "local" if scene._local else "fixed", steps]
    row += [f"{np.linalg.norm(spin) * steps * STEP:.1f}", scene.made]
    row += [f"{scene.newton / steps:.1f}", f"{scene.krylov / scene.newton:.1f}"]
    row += [f"{seconds:.0f}", f"{scene.energies(v) / start:.4f}"]
    return "| " + " | ".join(map(str, row)) + " |"


def main() -> None:
    """Print rows."""
    asking = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    asking.add_argument("--cells", type=int, nargs=2, default=(12, 12))
    asking.add_argument("--steps", type=int, default=200)
    asking.add_argument("--spin", type=float, nargs=3, default=(12.0, 8.0, 6.0))
    asking.add_argument("--axes", choices=("local", "fixed"), required=True)
    asking.add_argument("--cylinder", action="store_true")
    asked = asking.parse_args()
    case = Case(asked.cylinder, False, 0.01, "adaptive")
    scene = Tumbling(tuple(asked.cells), case, local=asked.axes == "local")
    row = run(scene, asked.steps, np.array(asked.spin))
    if MPI.COMM_WORLD.rank == 0:
        print(row, flush=True)


if __name__ == "__main__":
    main()
