"""Whether a stiffly accurate scheme of fourth order is worth it where energy is lost.

Composed steps go back in time and refuse what dissipates. What goes ahead alone is a diagonally
implicit Runge-Kutta scheme with one coefficient, here the L-stable one of Hairer & Wanner (Solving
Ordinary Differential Equations II, table IV.6.5): five stages, order four, one frozen matrix as of
generalised-alpha. On the group (Munthe-Kaas 1999), with constraints of velocities (index 2)::

    H_i = H exp(θ_i),    θ_i = h Σ a_ij T⁻¹(θ_j) v_j,    v_i = v + h Σ a_ij v̇_j

and the equations of motion with ``B v_i = 0`` for ``v̇_i`` and ``λ_i``. The last stage is the end.

The scene is the soft double pendulum of order_four.py with bars that damp strains. Both schemes
find the same residual and make one solution per iteration, so iterations are what is compared, and
matrices beside them; this one is not compiled, and seconds say what that costs. Errors are those of
all positions at the end, over the length, against steps of half the smallest size.

    python -m studies.stiffly_accurate [--damping 1e-3]
"""

from __future__ import annotations

from time import process_time
from typing import Any, NamedTuple

import numpy as np

import fem_lie as fl
from demos.soft_bars import soft_pendulum
from fem_lie import lie

GAMMA = 0.25
A = np.zeros((5, 5))
A[0, :1] = GAMMA
A[1, :2] = 1 / 2, GAMMA
A[2, :3] = 17 / 50, -1 / 25, GAMMA
A[3, :4] = 371 / 1360, -137 / 2720, 15 / 544, GAMMA
A[4] = 25 / 24, -49 / 48, 125 / 16, -85 / 12, GAMMA
C = A.sum(axis=1)
LENGTH, WANTED = 1.0, 1e-7
SLOW, MOST = 6, 30
"""Iterations of a stage after which a new matrix is made; those at which it is given up."""
STEPS, STEPS_OF_ALPHA = (25, 50, 100, 200, 400), tuple(200 * 2**k for k in range(8))


class Row(NamedTuple):
    """A run: its error, and what it took."""

    steps: int
    error: float
    iterations: int
    matrices: int
    seconds: float


class Stages:
    """A run of the scheme."""

    def __init__(self, scene: fl.Scene, step: float, tolerance: float) -> None:
        self.equations = fl.extend.Equations(scene, dynamics=True, group=fl.lie.Group.SE3)
        start, known = self.equations.start, self.equations.unknowns
        self.n, self.h, self.tolerance = known.moving, step, tolerance
        self.H, self.v = start.frames.copy(), start.velocities[: known.moving].copy()
        self.weights, self.scale = np.zeros(known.m), np.ones(known.m)
        self.solver = fl.extend.DirectSolver(self.equations.matrix, "stages_")
        self.known: list[tuple[float, fl.extend.Array, fl.extend.Array]] = []
        self.iterations = self.matrices = 0
        self.time = 0.0

    def step(self) -> None:
        """Five stages; the last is the end."""
        rates, speeds = np.zeros((5, self.n, 6)), np.zeros((5, self.n, 6))
        for i in range(5):
            before = self.h * np.tensordot(A[i, :i], speeds[:i], axes=1)
            v = self.v + self.h * np.tensordot(A[i, :i], rates[:i], axes=1)
            end = self._stage(self.time + C[i] * self.h, before, v)
            rates[i], speeds[i], H, v_end = end
        self.H, self.v = H, v_end
        self.time += self.h

    def _stage(
        self, time: float, before: fl.extend.Array, v: fl.extend.Array
    ) -> tuple[fl.extend.Array, fl.extend.Array, fl.extend.Array, fl.extend.Array]:
        """Rates of velocities and of increments, frames and velocities of a stage."""
        part, (rate, self.weights) = GAMMA * self.h, self._predicted(time)
        theta = before + part * v
        for iteration in range(1, MOST):
            v_end = v + part * rate
            for _ in range(4):
                speed = np.einsum("nij,nj->ni", lie.se3_tangent_inverse(theta), v_end)
                theta = before + part * speed
            H = self.H.copy()
            H[: self.n] = lie.se3_retract(self.H[: self.n], theta)
            change = self._correct(fl.extend.TimeState(H, v_end, rate, self.weights), iteration)
            rate = rate - change / part**2
            if np.abs(change).max() <= self.tolerance * max(np.abs(self.h * v_end).max(), 1e-12):
                self.known = [*self.known[-2:], (time, rate, self.weights)]
                return rate, speed, H, v_end
        raise fl.ConvergenceError(f"a stage at {time:g} did not converge")

    def _predicted(self, time: float) -> tuple[fl.extend.Array, fl.extend.Array]:
        """Rates and multipliers, from a polynomial through those of the last stages."""
        rate, weights = np.zeros((self.n, 6)), np.zeros_like(self.weights)
        for t, known, pulls in self.known:
            others = [s for s, _, _ in self.known if s != t]
            share = float(np.prod([(time - s) / (t - s) for s in others]))
            rate, weights = rate + share * known, weights + share * pulls
        return rate, weights

    def _correct(self, at: fl.extend.TimeState, iteration: int) -> fl.extend.Array:
        """Increments that are too large, and the multipliers."""
        equations, r, part = self.equations, self.solver.right_hand_side, GAMMA * self.h
        forces = equations.residual(at, np.ones_like(self.scale), r)
        twists = equations.start.velocities.copy()
        twists[: self.n] = at.v
        if not self.matrices or iteration == SLOW:
            plan = fl.extend.Plan(np.zeros((self.n, 6)), None, 1.0 / part**2, 1.0 / part)
            self.scale = equations.fill(at, forces, plan).copy()
            self.solver.factorise()
            self.matrices += 1
        r[6 * self.n :] = self.scale * part * equations.constraints(at.H).rates(twists)[0]
        self.solver.solve()
        self.iterations += 1
        found = self.solver.solution
        self.weights = self.weights - self.scale * found[6 * self.n :]
        return found[: 6 * self.n].reshape(-1, 6).copy()


def scene(damping: float) -> fl.Scene:
    """The pendulum, whose bars damp strains."""
    found = soft_pendulum()
    for bar in found.bodies:
        bar.model.damping = fl.sections.Damping(stiffness=damping)
    return found


def staged(
    damping: float, duration: float, steps: int, tolerance: float
) -> tuple[fl.extend.Array, Stages]:
    """Positions at the end, and the run."""
    run = Stages(scene(damping), duration / steps, tolerance)
    for _ in range(steps):
        run.step()
    return run.H[: run.n, 0], run


def iterations_at(rows: list[Row]) -> float:
    """What the error that is wanted takes, between runs; logarithms of both."""
    errors, counts = np.log([(row.error, row.iterations) for row in rows]).T
    return float(np.exp(np.interp(-np.log(WANTED), -errors, counts)))


def measure(damping: float, duration: float, tolerance: float) -> dict[str, list[Row]]:
    """Runs of both schemes."""
    exact, last = staged(damping, duration, 2 * STEPS[-1], 1e-11)
    tables: dict[str, list[Row]] = {"stages": [], "generalised-alpha": []}
    for steps in STEPS:
        start = process_time()
        found, run = staged(damping, duration, steps, tolerance)
        seconds, error = process_time() - start, float(np.abs(found - exact).max() / LENGTH)
        tables["stages"].append(Row(steps, error, run.iterations, run.matrices, seconds))
    alpha, masters = (
        fl.GeneralisedAlpha(radius=0.8, tolerance=1e-9),
        last.equations.unknowns.masters,
    )
    for steps in STEPS_OF_ALPHA:
        start = process_time()
        made = alpha.run(scene(damping), duration=duration, step=duration / steps, save_every=steps)
        seconds = process_time() - start
        error = float(np.abs(made.frames[-1, masters, 0] - exact).max() / LENGTH)
        counts = int(made.iterations[-1]), made.factorisations
        tables["generalised-alpha"].append(Row(steps, error, *counts, seconds))
    return tables


def main(damping: float = 1e-3, duration: float = 0.4, tolerance: float = 1e-8) -> dict[str, Any]:
    tables = measure(damping, duration, tolerance)
    for name, rows in tables.items():
        print(f"{name}: steps, error, iterations, matrices, seconds")
        for row in rows:
            print(f"{row[0]:8d}{row[1]:10.1e}{row[2]:10d}{row[3]:6d}{row[4]:8.2f}")
    errors = [row.error for row in tables["stages"]]
    counts = {name: iterations_at(rows) for name, rows in tables.items()}
    record = {
        "order": float(np.log2(errors[0] / errors[3]) / 3.0),
        "iterations_at_1e7": counts["stages"],
        "iterations_of_alpha_at_1e7": counts["generalised-alpha"],
        "fewer_iterations_at_1e7": counts["generalised-alpha"] / counts["stages"],
    }
    for key, value in record.items():
        print(f"{key:30}{value:.4g}")
    return record


if __name__ == "__main__":
    from demos.command_line import run

    run(main)
