"""A scheme in one file: Newmark's on SE(3), with joints, loads, damped steps and all of a run.

With ``d`` the increment of a step in the frames of its start, ``v`` the twists and ``a`` their
rates::

    H₁ = H exp(d)      d = h v + h² ((½ − β) a + β a₁)      v₁ = v + h ((1 − γ) a + γ a₁)

and the equations of motion at its end (Krysl & Endres, IJNME 62 (2005) 2154). γ = ½ is of second
order; more damps what steps do not resolve. The driver has the rest: a step that fails is made in
parts, runs go to files and resume, and results have all that those of other schemes have.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

import fem_lie as fl
from fem_lie.extend import (
    DIVERGED,
    ROUND_OFF,
    Array,
    DirectSolver,
    DividedIntegration,
    Equations,
    Integrator,
    NodeType,
    Plan,
    Recorder,
    TimeState,
    accelerations,
    attributes,
    check_kinds,
    check_velocities,
    estimate,
    failure,
    move_all,
    refuse,
    unknown_scaling,
)


@dataclass(frozen=True)
class Newmark(Integrator):
    """The options; ``run`` and ``resume`` are those of all schemes.

    Attributes:
        gamma: ½ damps nothing; β = ¼ (γ + ½)².
        tolerance: Error of the iteration of a step, over the largest motion in it.
        policy: When to factorise.
        max_iterations: More in one step are its failure.
    """

    gamma: float = 0.5
    tolerance: float = 1e-8
    policy: fl.schemes.RefactorisationPolicy = field(default_factory=fl.schemes.Automatic)
    max_iterations: int = 30

    def __post_init__(self) -> None:
        """Check the options."""
        check_kinds(self.tolerance, self.max_iterations, self.policy)

    def _equations(self, scene: fl.Scene) -> Equations:
        equations = Equations(scene, dynamics=True, group=fl.lie.Group.SE3)
        vectors = equations.unknowns.kinds >= NodeType.POSITION_GRADIENT
        refuse("Newmark", {"nodes with vector coordinates": bool(vectors.any())})
        return equations

    def _integration(self, equations: Equations, step: float) -> NewmarkRun:
        return NewmarkRun(self, equations, step)


class NewmarkRun(DividedIntegration[Recorder]):
    """One run. What the next steps depend on has its names here, and is saved by the driver."""

    STATE = attributes(
        *(
            "H",
            "v",
            "a",
            "forces",
            "scale",
            "size",
            "_made",
            "_count",
            "_stale",
            "balance",
            "solver",
        )
    )

    def __init__(self, options: Newmark, equations: Equations, step: float) -> None:
        super().__init__(options.policy, equations, step)
        n, m = equations.unknowns.moving, equations.unknowns.m
        self.options, self.size = options, step
        self.H = equations.start.frames.copy()
        self.v, self.a = equations.start.velocities[:n].copy(), np.zeros((n, 6))
        self.forces, self.scale = np.zeros(m), np.ones(m)
        self.solver, self.balance = (
            DirectSolver(equations.matrix, "newmark_"),
            equations.energy_balance(),
        )
        self.measure = unknown_scaling(equations.unknowns)
        self._made, self._count, self._stale, self._left = 0, 0, True, np.inf

    def history(self, plan: Any, progress: bool | None, store: Any) -> Recorder:
        """Where results go: rows are made of frames, twists, their rates and joint forces."""
        return Recorder(self.equations, plan, progress, store)

    def start(self) -> None:
        """Check velocities; find accelerations and joint forces."""
        check_velocities(self.equations, self.h)
        self.resize(0.0, self.h)
        self.balance.open(0.0, *self.now)

    @property
    def now(self) -> TimeState:
        """The state, as equations take it."""
        return TimeState(self.H, self.v, self.a, self.forces)

    @property
    def frames(self) -> Array:
        """Of all rows: moving nodes, ground, prescribed motions."""
        return self.H

    @property
    def index(self) -> int:
        """Steps made."""
        return self._made

    # --- a step ---

    def resize(self, time: float, size: float) -> None:
        """Steps of another size begin at ``time``: with accelerations of the equations."""
        self.size, self._stale = size, True
        v = np.concatenate([self.v, self.equations.start.velocities[len(self.v) :]])
        self.a, self.forces = accelerations(self.equations, self.solver, self.H, v, time, size)
        self.equations.prescribed(time).act()

    def attempt(self, start: float, end: float) -> bool:
        """Make a step, or leave the state at its start; with a new matrix each time if need be."""
        self._made = self.begun
        before = self.H.copy(), self.v.copy(), self.a.copy(), self.forces.copy()
        prescribed = self.equations.prescribed(end)
        prescribed.act()
        for decisions in (self.decisions, fl.schemes.EveryIteration().begin(bound=False)):
            self.H[len(self.v) + 1 :] = prescribed.frames
            if self._converges(decisions, before[0]):
                self._made += 1
                self.balance.add(self.size, end, *self.now)
                return self._accept_history(before[0])
            self.H[:], self.v, self.a, self.forces = (array.copy() for array in before)
        return False

    def _converges(self, decisions: fl.extend.PolicyState, start: Array) -> bool:
        h, gamma, n = self.size, self.options.gamma, len(self.v)
        beta = 0.25 * (gamma + 0.5) ** 2
        d = h * self.v + 0.5 * h * h * self.a  # of the same acceleration
        self.v = self.v + h * self.a
        motion, previous, ratio = (
            np.abs(d * self.measure[: d.size].reshape(n, 6)).max(),
            np.inf,
            1.0,
        )
        for iteration in range(1, self.options.max_iterations + 1):
            self._count += 1
            move_all(self.equations.unknowns.kinds, start, d, self.H)
            r, x = self.solver.right_hand_side, self.solver.solution
            found = self.equations.residual(self.now, self.scale, r)
            if decisions.before_iteration(iteration) or self._stale:
                mass, damping = 1.0 / (beta * h * h), gamma / (beta * h)
                plan = Plan(d, None, mass, damping, stressed=self.H, matrix_terms=self.matrix_terms)
                before, self.scale = self.scale, self.equations.fill(self.now, found, plan)
                r[6 * n :] *= self.scale / before
                self.solver.factorise()
                self._stale = False
            self.solver.solve()
            step = x[: 6 * n].reshape(n, 6)
            d -= step
            self.v, self.a = self.v - gamma / (beta * h) * step, self.a - step / (beta * h * h)
            self.forces = self.forces - self.scale * x[6 * n :]
            increment = float(np.abs(step.ravel() * self.measure[: 6 * n]).max())
            ratio, remaining = estimate(increment, previous, ratio)
            self._left, previous = increment, increment
            if remaining <= self.options.tolerance * motion or increment <= ROUND_OFF:
                move_all(self.equations.unknowns.kinds, start, d, self.H)
                decisions.after_step(iteration)
                return True
            if not increment < DIVERGED:
                return False
        return False

    # --- what the driver asks for ---

    def _advance(self, history: Recorder) -> bool:
        before, made = self._count, self._cover()
        history.count += self._count - before
        return made

    def _record(self, history: Recorder) -> bool:
        return history.record(self._made, *self.now, self.balance.total)

    def _result(self, history: Recorder) -> fl.Result:
        made = self.solver.factorisations
        return history.result(made, history.seconds, divided=self.division.divided)

    def _failure(self, steps: int) -> str:
        options, left = self.options, float(np.abs(self.solver.right_hand_side).max())
        numbers = options.max_iterations, self._left, left, options.tolerance, self._rescues
        return failure(self._made + 1, steps, self.h, *numbers)


def pendulum() -> fl.Scene:
    """A soft beam on a hinge, from the horizontal, with a rigid body at its end."""
    section = fl.Section.rectangle(0.02, 0.02, fl.Material(5e6, 0.3, 1000.0))
    beam = fl.Beam.straight((0, 0, 0), (0.5, 0, 0), section, cells=4)
    weight = fl.RigidBody(0.2, (1e-4, 1e-4, 1e-4), (0.5, 0, 0))
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(beam)
    scene.add(weight)
    scene.add(fl.joints.Revolute(fl.ground(), beam.point("start"), axis=(0, 1, 0)))
    scene.add(fl.joints.Fixed(beam.point("end"), weight.point("centre")))
    return scene


def end(steps: int) -> Array:
    """Where the weight is after 0.2 s."""
    result = Newmark(gamma=0.5).run(pendulum(), duration=0.2, step=0.2 / steps, progress=False)
    return np.asarray(result.frames[-1, -1, 0])


coarse, middle, fine = (end(steps) for steps in (80, 160, 320))
order = np.log2(np.linalg.norm(coarse - middle) / np.linalg.norm(middle - fine))
if __name__ == "__main__":
    print(f"order {order:.2f}")
