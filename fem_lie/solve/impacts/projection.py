"""Velocities that satisfy the constraints, too: stabilised index 2.

Index 3 keeps the constraints of positions; the velocities of the scheme satisfy ``B v = Φ_t`` to
second order only. Gear, Gupta & Leimkuhler add both, with one more multiplier that moves the
positions (C. Lunk & B. Simeon, Z. angew. Math. Mech. 86 (2006) 772, for generalised-α). Here that
multiplier moves the velocities at the end of each step, the nearest that satisfy them in the norm
of the iteration matrix ``S``::

    S δv + Bᵀ μ = 0,    B (v + δv) = Φ_t

so that momenta stay (``S`` is mass on rigid motions, and ``Bᵀμ`` is an internal impulse) and stiff
vibrations are not stirred. It is one solution more per step with the kept factorisation, or two.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fem_lie._arrays import Array
from fem_lie.linear.direct import DirectSolver
from fem_lie.solve.impacts.step_end import StepEnd
from fem_lie.system.equations import Equations

_ITERATIONS = 20
_CONTRACTION = 1e-12  # of the violation, or what the round-off of velocities leaves


def project(
    equations: Equations,
    solver: DirectSolver,
    end: StepEnd,
    scale: Array,
    step: float,
    subtract: Callable[[Array], object],
) -> None:
    """Change the velocities at the end of a step.

    Args:
        equations: Of the scene, at the time of the end of the step.
        solver: With the kept factorisation.
        end: Of the converged step; its twists are changed.
        scale: Of the constraints in the matrix, shape (m,).
        step: Over which drives and prescribed motions are differentiated.
        subtract: Subtracts a change in the nodes' axes, shape (6 n + m,), from the twists, and from
            all else that the scheme has of velocities.
    """
    n, velocities = equations.unknowns.moving, np.zeros((len(end.frames), 6))
    drive: Array = np.zeros(1)
    if equations.unknowns.time_dependent:
        driven = equations.prescribed(end.time, step)
        velocities[n + 1 :], drive = driven.velocities, driven.target_rates[0]
    constraints = equations.constraints(end.frames)
    B = constraints.jacobian
    impulse = np.zeros(equations.unknowns.m)
    change, largest = np.zeros(equations.unknowns.size), np.inf
    for _ in range(_ITERATIONS):
        velocities[:n] = end.twists
        first = constraints.rates(velocities)[0] - drive
        violation = float(np.abs(first).max(initial=0.0))
        speed = float(np.abs(velocities).max(initial=0.0))
        # it falls by the turn since the matrix was made each time, until round-off
        if violation <= _CONTRACTION * max(speed, 1e-300) or violation > 0.9 * largest:
            return
        largest = violation
        solver.right_hand_side[: 6 * n] = solver.times(change)[: 6 * n]
        solver.right_hand_side[: 6 * n] += B.T @ (scale * impulse)
        solver.right_hand_side[6 * n :] = scale * first
        solver.solve()
        change[: 6 * n] -= solver.solution[: 6 * n]
        impulse -= solver.solution[6 * n :]
        subtract(solver.solution)
