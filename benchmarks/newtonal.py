"""PETSc's arc length (SNES type newtonal) on the paths of the demos, against `fl.follow_path`.

    python -m benchmarks.newtonal [arch|roof|cylinder ...]

PETSc's solver adds increments to a vector. Here the vector holds the accumulated local increments
of the nodes: each evaluation moves the nodes by what was added, so that the iteration is that of
local frames. PETSc takes the load for a constant vector: the arch, whose loaded node turns, is
written in fixed axes for it. It begins at the unloaded state and is asked for load factor 1; the
table says how far it came with several lengths of the step, how many linear solutions it took, and
whether it ended in the same state.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

from petsc4py import PETSc

import numpy as np

import fem_lie as fl
from demos import deep_arch, hinged_roof, pulled_cylinder
from fem_lie.solve.stability.equilibrium import StableEquilibrium
from fem_lie.system.time_state import Plan

PROBLEMS: dict[str, Callable[[], fl.Scene]] = {
    "arch": lambda: deep_arch.arch(40, "stretchable")[0],
    "roof": lambda: hinged_roof.roof(6.35, 8)[0],
    "cylinder": lambda: pulled_cylinder.cylinder(16, 12),
}
STEPS = (0.3, 1.0, 3.0, 10.0)  # over the norm of the first increment of a load step of 0.05
MOST = 400


class Additive:
    """A model whose state is a vector of accumulated increments, in fixed axes for beams."""

    def __init__(self, scene: fl.Scene, carried: bool) -> None:
        """Begin unloaded."""
        self.fixed = not any(isinstance(body, fl.Shell) for body in scene.bodies)
        self.model = StableEquilibrium(scene, "newtonal_model_", linearised_stress=carried)
        self.x = np.zeros(self.model.equations.system.size)
        self.factor, self.solutions, self.largest = 0.0, 0, 0.0
        self.load = self.turned(self.model.forces()[1])
        self.matrix = self.model.equations.system.kkt.matrix

    def residual(self, snes: PETSc.SNES, x: PETSc.Vec, f: PETSc.Vec) -> None:
        """Internal forces; PETSc subtracts the load."""
        self.move(x.array_r)
        f.array[:] = self.turned(self.model.forces()[0])

    def jacobian(self, snes: PETSc.SNES, x: PETSc.Vec, J: PETSc.Mat, P: PETSc.Mat) -> None:
        """The tangent of the present state."""
        self.move(x.array_r)
        self.fill()
        self.solutions += 1

    def fill(self) -> None:
        """The matrix, for the load factor that the present state is nearest to."""
        model, system = self.model, self.model.equations.system
        model.factorise(self.present())
        if self.fixed:
            plan = Plan(np.zeros((system.count, 6)), model._scale, inertial=True)
            system.fill_matrix(model._now, model._found, plan)

    def turned(self, r: np.ndarray, inverse: bool = False) -> np.ndarray:
        """From local components to those along fixed axes, or the other way round."""
        n = 6 * self.model.equations.system.count
        if not self.fixed:
            return r
        R = self.model._H[: n // 6, 1:]
        pattern = "nij,nki->nkj" if not inverse else "nij,nkj->nki"
        nodes = np.einsum(pattern, R, r[:n].reshape(-1, 2, 3))
        return np.concatenate([nodes.ravel(), r[n:]])

    def present(self) -> float:
        """Load factor that balances the present state best."""
        internal = self.turned(self.model.forces()[0])
        return float(internal @ self.load / (self.load @ self.load))

    def move(self, x: np.ndarray) -> None:
        """Go to a vector of increments."""
        if (x != self.x).any():
            self.model.move(self.turned(x - self.x, inverse=True))
            self.x = x.copy()


def run(
    scene: fl.Scene, step: float, correction: str, carried: bool
) -> tuple[str, float, int, np.ndarray]:
    """How it ended, the load factor reached, the number of linear solutions, and positions."""
    additive = Additive(scene, carried)
    model = additive.model
    model.factorise(0.0)
    first = 0.05 * np.linalg.norm(model.solve(model.forces()[1]))
    options = PETSc.Options("newtonal_")
    for name, value in {
        "snes_type": "newtonal",
        "snes_newtonal_step_size": step * first,
        "snes_newtonal_max_continuation_steps": MOST,
        "snes_newtonal_correction_type": correction,
        "snes_newtonal_lambda_max": 1.0,
        "snes_newtonal_lambda_min": -1.0,
        "snes_newtonal_psisq": 0.0,
        "snes_rtol": 1e-8,
        "snes_stol": 0.0,  # x holds multipliers, beside which increments look small
        "snes_max_it": 10000,
        "ksp_type": "preonly",
        "pc_type": "lu",
        "pc_factor_mat_solver_type": "mumps",
    }.items():
        options[name] = value
    snes = PETSc.SNES().create(PETSc.COMM_SELF)
    snes.setOptionsPrefix("newtonal_")
    b = PETSc.Vec().createWithArray(additive.load.copy(), comm=PETSc.COMM_SELF)
    x, f = b.duplicate(), b.duplicate()
    x.set(0.0)
    snes.setFunction(additive.residual, f)
    snes.setJacobian(additive.jacobian, additive.matrix, additive.matrix)
    snes.setFromOptions()
    try:
        snes.solve(b, x)
        reason = snes.getConvergedReason()
    except PETSc.Error as error:
        reason = f"error {error.ierr}"
    return f"reason {reason}", additive.present(), additive.solutions, model.positions()


def main(names: list[str]) -> None:
    print(
        "problem   correction  stress   step  ended        load factor  linear solutions  s    same"
    )
    for name in names or list(PROBLEMS):
        make = PROBLEMS[name]
        begin = time.perf_counter()
        path = fl.follow_path(make(), options=fl.stability.PathOptions(locate=None))
        print(
            f"{name:9} fl.follow_path                {path.reason[:12]:12} "
            f"{path.factors[-1]:11.4f} {path.total_iterations:17} "
            f"{time.perf_counter() - begin:6.1f}",
            flush=True,
        )
        for carried in (True, False):
            for correction in ("exact", "normal"):
                for step in STEPS:
                    begin = time.perf_counter()
                    ended, factor, count, positions = run(make(), step, correction, carried)
                    gap = np.abs(positions - path.stations[-1].positions).max()
                    size = np.ptp(path.stations[-1].positions, axis=0).max()
                    same = "yes" if gap < 1e-4 * size else "no"
                    stress = "carried" if carried else "plain"
                    print(
                        f"{name:9} {correction:10}  {stress:7}  {step:4g}  {ended:12} "
                        f"{factor:11.4f} {count:17} {time.perf_counter() - begin:6.1f}  {same}",
                        flush=True,
                    )


if __name__ == "__main__":
    main(sys.argv[1:])
