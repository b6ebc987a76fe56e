"""Consistent initial values of generalised-α: accelerations, joint forces, velocities."""

from __future__ import annotations

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie.linear.direct import DirectSolver
from fem_lie.solve.alpha.step.node import Scheme
from fem_lie.solve.alpha.step.nodes import State, extrapolate
from fem_lie.solve.motion.start import accelerations, fill_matrix
from fem_lie.system import System


def set_start(
    system: System,
    solver: DirectSolver,
    scheme: Scheme,
    s: State,
    twist: Array | None = None,
    time: float = 0.0,
) -> Array:
    """Set velocities and accelerations so that everything is of second order from the first step.

    ``a₀`` stands for ``v̇`` at ``t₀ + (α_m − α_f) h``, or the start is only first order, and ``v₀``
    gets what :func:`velocity_defect` says, or multipliers are, in a transient. Both need the rate
    of ``v̇``, a difference of accelerations that satisfy the equations of motion. (Arnold, Brüls &
    Cardona, Numer. Math. 129 (2015) 149.)

    Args:
        system: The equations; its matrix and loads are overwritten.
        solver: For that matrix.
        scheme: Parameters of the run.
        s: At the frames of the start; its velocities and accelerations are set.
        twist: Velocities that the joints allow, rows as of ``system.velocities``, the default.
        time: Of the start.

    Returns:
        The multipliers, shape (m,).

    Raises:
        ValueError: The mass matrix is singular.
    """
    h, n = scheme.h, system.count
    ahead = scheme.ahead
    v = (system.velocities if twist is None else twist).copy()
    vdot, weights = accelerations(system, solver, s.H, v, time, h)
    s.set_start(v[:n], vdot)
    later = State.start(s.H, s.kinds)
    extrapolate(ahead, s.H, s.motion, s.kinds, later.H, v)
    later.set_start(v[:n], accelerations(system, solver, later.H, v, time + ahead, h)[0])
    jerk = np.asarray((later.vdot - s.vdot) / ahead, dtype=np.float64)
    s.a[:] -= scheme.shift * jerk
    s.v[:] += velocity_defect(system, solver, scheme, s, jerk)
    return weights


def velocity_defect(
    system: System, solver: DirectSolver, scheme: Scheme, s: State, jerk: Array
) -> Array:
    """What ``v₀`` must have across the joints, O(h²), for multipliers without a transient.

    The increment of an exact motion is not that of the scheme; with ``J`` the rate of ``v̇``::

        l = d(exact) − d(scheme) = h³ ((1/6 − β + ½ (α_f − α_m)) J + [v, v̇]/12)

    Positions satisfy the constraints, so velocities must carry ``B l/h``, once for all. The bracket
    is ``ad(v) v̇`` on SE(3), that of the rotations alone on R³×SO(3); increments of the Cayley map
    differ by ``−v̂³/12`` more. Where the allowed motions are a subgroup, as of one body on a joint
    to the ground on SE(3), ``B l`` is zero. (Arnold, Brüls & Cardona 2015.)

    Returns:
        In the velocities of the groups, shape (n, 6).
    """
    n, h, twist = system.count, scheme.h, s.twist1
    flat, cayley = (s.kinds & 1) == 1, s.kinds >= 2
    R = lie.rotation(s.H[:n])[flat]
    defect = np.einsum("nij,nj->ni", lie.se3_ad(twist), s.rate1)
    hat = lie.hat(twist[cayley])
    defect[cayley] -= lie.vee(hat @ hat @ hat)
    defect[flat, :3] = 0.0
    local = jerk.copy()
    local[flat, :3] = np.einsum("nij,ni->nj", R, jerk[flat, :3])
    c = 1 / 6 - scheme.beta + 0.5 * (scheme.af - scheme.am)
    left = h**2 * (c * local + defect / 12)
    system.supports.turn(s.H, left)
    solver.right_hand_side[: 6 * n] = 0.0
    solver.right_hand_side[6 * n :] = system.tangent.jacobian(s.H) @ left.ravel()
    # what binds velocities asks for nothing
    solver.right_hand_side[solver.right_hand_side.size - system.connections.of_velocities :] = 0.0
    solver.right_hand_side[6 * n :] *= fill_matrix(system, s.H, h)
    solver.factorise()
    solver.solve()
    across = solver.solution[: 6 * n].reshape(n, 6).copy()
    system.supports.turn_back(s.H, across)
    across[flat, :3] = np.einsum("nij,nj->ni", R, across[flat, :3])
    return across
