"""Consistent initial values of generalised-α: accelerations, joint forces, velocities."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from fem_lie._arrays import Array
from fem_lie.lie.node_types import all_cubic_terms, all_from_group, all_from_local, all_to_group
from fem_lie.linear.direct import DirectSolver
from fem_lie.solve.alpha.step.node import Scheme
from fem_lie.solve.alpha.step.nodes import State, extrapolate
from fem_lie.solve.motion.consistent import accelerations, across_joints
from fem_lie.system.equations import Equations

Outputs: TypeAlias = Callable[[float, Array, Array], None]
"""Function of time, frames and twists of all nodes that sets the outputs of controllers."""


def set_start(
    equations: Equations,
    solver: DirectSolver,
    scheme: Scheme,
    s: State,
    twist: Array | None = None,
    time: float = 0.0,
    feedback: Outputs | None = None,
) -> Array:
    """Set velocities and accelerations so that the scheme is second order from the first step.

    ``a₀`` approximates ``v̇`` at ``t₀ + (α_m − α_f) h``, otherwise the start is first order only.
    ``v₀`` is corrected by :func:`velocity_defect`, otherwise the multipliers have a transient. Both
    need the rate of ``v̇``, a difference quotient of accelerations that satisfy the equations of
    motion. (Arnold, Brüls & Cardona, Numer. Math. 129 (2015) 149.)

    Args:
        equations: Equations of the scene; their matrix and loads are overwritten.
        solver: Solver for that matrix.
        scheme: Parameters of the run.
        s: State with the initial frames; its velocities and accelerations are set.
        twist: Admissible velocities, rows as in ``equations.start``, the default.
        time: Initial time.
        feedback: Sets the outputs of controllers at a state; default: there are none.

    Returns:
        The Lagrange multipliers, shape (m,).

    Raises:
        ValueError: The mass matrix is singular.
    """
    h, n = scheme.h, equations.unknowns.moving
    ahead = scheme.ahead
    v = (equations.start.velocities if twist is None else twist).copy()
    before = v.copy()
    vdot, multipliers = accelerations(equations, solver, s.H, v, time, h)
    s.set_start(v[:n], vdot)
    later = s.H.copy()
    extrapolate(ahead, s.H, s.motion, s.kinds, later, v)
    if feedback is not None:
        feedback(time + ahead, later, v)
    rate, _ = accelerations(equations, solver, later, v, time + ahead, h)
    if feedback is not None:
        feedback(time, s.H, before)
    jerk = np.empty_like(rate)
    all_from_local(s.kinds, later, v[:n], rate, np.empty_like(rate), jerk)
    del later, rate
    jerk -= s.vdot
    jerk /= ahead
    s.a[:] -= scheme.shift * jerk
    s.v[:] += velocity_defect(equations, solver, scheme, s, jerk)
    return multipliers


def velocity_defect(
    equations: Equations, solver: DirectSolver, scheme: Scheme, s: State, jerk: Array
) -> Array:
    """Correction O(h²) of ``v₀`` across the joints for multipliers without a transient.

    The increment of an exact motion differs from that of the scheme; with ``J`` the rate of
    ``v̇``::

        l = d(exact) − d(scheme) = h³ ((1/6 − β + ½ (α_f − α_m)) J + [v, v̇]/12)

    Positions satisfy the constraints, so velocities must contain ``B l/h`` once. The bracket is
    ``ad(v) v̇`` on SE(3), and that of the rotations only on R³×SO(3); increments of the Cayley map
    differ by a further ``−v̂³/12``. If the admissible motions are a subgroup, as for one body on a
    joint to the ground on SE(3), ``B l`` is zero. (Arnold, Brüls & Cardona 2015.)

    Returns:
        Velocities of the groups, shape (n, 6).
    """
    n, h = equations.unknowns.moving, scheme.h
    defect, local = np.empty((n, 6)), jerk.copy()
    all_cubic_terms(s.kinds, s.v, s.vdot, defect)
    all_from_group(s.kinds, s.H, local)
    c = 1 / 6 - scheme.beta + 0.5 * (scheme.af - scheme.am)
    left = h**2 * (c * local + defect / 12)
    equations.supports.rotate(s.H, left)
    rates = equations.constraints(s.H).jacobian @ left.ravel()
    # velocity constraints need no correction
    rates[len(rates) - equations.unknowns.of_velocities :] = 0.0
    across = across_joints(equations, solver, s.H, rates, h)
    all_to_group(s.kinds, s.H, across)
    return across
