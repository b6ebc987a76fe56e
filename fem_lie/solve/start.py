"""Consistent initial values: velocities that joints allow, accelerations and joint forces."""

from __future__ import annotations

import numpy as np

from fem_lie import constraints, lie
from fem_lie._jit import Array
from fem_lie.solve.linear import DirectSolver, SingularMatrixError
from fem_lie.system import System


def check_velocities(system: System, step: float) -> None:
    """Check the initial velocities of the bodies against clamps and joints.

    Args:
        system: The equations.
        step: Step size; velocities may be wrong by what is not felt in one.

    Raises:
        ValueError: They break a clamp or a joint; the message names it.
    """
    for clamp in system.scene.clamps:
        v = system.velocities[system.numbering.node(clamp.point)]
        if v.any():
            raise ValueError(
                f"{clamp.point.label} is clamped, but has the initial velocity {v} (translation, "
                "rotation, in its frame); it must be zero"
            )
    velocities, _ = with_driven(system, system.velocities, 0.0, step)
    first, second = np.zeros(system.m), np.zeros(system.m)
    constraints.rates(system.frames, velocities, system.table, first, second)
    speed = max(np.abs(velocities[:, :3]).max() / system.length, np.abs(velocities[:, 3:]).max())
    # below the second bound the error of a whole step is less than 1e-9 of the size
    bound = max(1e-6 * speed, 1e-9 / step) * max(1.0, system.length)
    if (np.abs(first) > bound).any():
        c = int(np.abs(first).argmax())
        joint = system.joints[int(np.searchsorted(system.table.first, c, side="right")) - 1]
        raise ValueError(
            f"the initial velocities break {joint.label}: its constraint changes at the rate "
            f"{first[c]:g}; give both bodies velocities that the joint allows"
        )


def with_driven(system: System, velocities: Array, time: float, step: float) -> tuple[Array, Array]:
    """Velocities with those of the prescribed motions at ``time``, and their accelerations (p, 6).

    Differences over three later times: the motion need not be defined before the start.
    """
    v, first = velocities.copy(), system.count + 1
    if len(v) == first:
        return v, np.zeros((0, 6))
    here = system.prescribed_frames(time)
    later = [system.prescribed_frames(time + k * step) for k in (1, 2, 3)]
    d1, d2, d3 = (lie.se3_relative(here, frames) for frames in later)
    # d(t) = v t + v̇ t²/2 + j t³/6 through the three
    v[first:] = (18 * d1 - 9 * d2 + 2 * d3) / (6 * step)
    return v, np.asarray((-5 * d1 + 4 * d2 - d3) / step**2)


def accelerations(
    system: System, solver: DirectSolver, H: Array, v: Array, time: float, step: float
) -> tuple[Array, Array]:
    """``v̇`` and multipliers from the equations of motion and twice differentiated constraints.

    ::

        M v̇ + Bᵀ λ = f(H, v, t)          B v̇ = −Ḃ v

    Args:
        system: The equations; its matrix and loads are overwritten.
        solver: For that matrix.
        H: Frames of all rows.
        v: Local velocities of all rows; those of prescribed motions are found here.
        time: The time.
        step: Over which prescribed motions are differentiated.

    Returns:
        Shapes (n, 6) and (m,).

    Raises:
        ValueError: The mass matrix is singular.
    """
    n, m = system.count, system.m
    v, driven = with_driven(system, v, time, step)
    system.set_time(time)
    if len(driven):
        H = np.concatenate([H[: n + 1], system.prescribed_frames(time)])
    r = solver.right_hand_side
    system.residual(H, v, np.zeros((n, 6)), np.zeros(m), np.ones(m), r)
    first, second, drive = np.zeros(m), np.zeros(m), np.zeros(m)
    constraints.rates(H, v, system.table, first, second)
    rate = np.zeros_like(v)
    rate[n + 1 :] = driven
    constraints.rates(H, rate, system.table, drive, first)
    r[6 * n :] = second + drive
    # modes that the step does not resolve would start with accelerations that mean nothing to it
    system.fill_start_matrix(H, 0.25 * step**2)
    try:
        solver.factorise()
    except SingularMatrixError as error:
        raise ValueError(
            "the mass matrix is singular: a body or section lacks (rotary) inertia"
        ) from error
    solver.solve()
    return -solver.solution[: 6 * n].reshape(n, 6), -solver.solution[6 * n :]
