"""Consistent initial values: velocities that joints allow, accelerations and joint forces."""

from __future__ import annotations

import numpy as np

from fem_lie import lie
from fem_lie._jit import Array
from fem_lie.solve.equilibrated import InaccurateSolutionError, SingularMatrixError
from fem_lie.solve.linear import DirectSolver
from fem_lie.solve.scheme import Scheme
from fem_lie.solve.steps import State, extrapolate
from fem_lie.system import System

_LARGEST = 1e150  # the square of more is no number


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
    velocities, first = _rates_at_start(system, step)
    _, finer = _rates_at_start(system, 0.5 * step)
    speed = max(np.abs(velocities[:, :3]).max() / system.length, np.abs(velocities[:, 3:]).max())
    # below the second bound the error of a whole step is less than 1e-9 of the size
    bound = max(1e-6 * speed, 1e-9 / step)
    _check_held(system, bound)
    # rates of drives and motions are differences, which are wrong by about what half a step changes
    left = np.maximum(np.abs(finer) - np.abs(first - finer), 0.0)
    rates = left / np.where(system.connections.angular, 1.0, system.length)
    if (rates > bound).any():
        c = int(rates.argmax())
        joint = system.connections.items[int(system.connections.owner[c])]
        raise ValueError(
            f"the initial velocities break {joint.label}: its constraint changes at the rate "
            f"{first[c]:g}; give both bodies velocities that the joint allows"
        )


def _rates_at_start(system: System, step: float) -> tuple[Array, Array]:
    """Velocities with those of motions, and rates of all constraints less those of their drives."""
    velocities, _ = with_driven(system, system.velocities, 0.0, step)
    first, _ = system.connections.rates(system.frames, velocities)
    return velocities, np.asarray(first - system.connections.target_rates(0.0, step)[0])


def _check_held(system: System, bound: float) -> None:
    """Check the velocities of what bodies hold; shells of five parameters may be said to drill."""
    v = system.velocities[: system.count].copy()
    system.supports.turn(system.frames, v)
    wrong = system.held & (np.abs(v) > bound * np.repeat([system.length, 1.0], 3))
    wrong[:, 5] = False
    if wrong.any():
        node = int(np.flatnonzero(wrong.any(axis=1))[0])
        which = int(system.numbering.attachment.leaders[node])
        nodes = system.numbering.nodes.items()
        body, own = next((b, np.flatnonzero(n == which)) for b, n in nodes if which in n)
        raise ValueError(
            f"node {own[0]} of {body.label} is held, but has the initial velocity {v[node]} "
            "(translation, rotation) along what is held; it must be zero"
        )


def with_driven(system: System, velocities: Array, time: float, step: float) -> tuple[Array, Array]:
    """Velocities with those of the prescribed motions at ``time``, and their accelerations (p, 6).

    Differences over three later times: the motion need not be defined before the start.
    """
    v, first = velocities.copy(), system.count + 1
    if len(v) == first:
        return v, np.zeros((0, 6))
    step = min(step, system.until_break(time) / 3.0)
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
        ValueError: The mass matrix is singular, or forces are beyond the range of numbers.
        InaccurateSolutionError: No solver could solve the equations.
    """
    n, m = system.count, system.m
    v, driven = with_driven(system, v, time, step)
    system.set_time(time)
    if len(driven):
        H = np.concatenate([H[: n + 1], system.prescribed_frames(time)])
    r = solver.right_hand_side
    rate = np.zeros_like(v)
    rate[n + 1 :] = driven
    # ẍ = R (u̇ + ω × u) = 0, of which supports hold a part
    guided = system.supports.nodes
    rate[guided, :3] = -np.cross(v[guided, 3:], v[guided, :3])
    system.residual(H, v, rate[:n], np.zeros(m), np.ones(m), r)
    _, second = system.connections.rates(H, v)
    drive, _ = system.connections.rates(H, rate)
    r[6 * n :] = second + drive - system.connections.target_rates(time, step)[1]
    scale = _fill(system, H, step)
    r[6 * n :] *= scale
    largest = float(np.abs(r).max(initial=0.0))
    if not largest < _LARGEST:
        raise ValueError(f"forces at the start are {largest:.1e}: they cannot be computed with")
    try:
        solver.factorise()
        solver.solve()
    except InaccurateSolutionError:
        raise
    except SingularMatrixError as error:
        raise ValueError(
            "the mass matrix is singular: a body or section lacks (rotary) inertia"
        ) from error
    system.supports.turn_back(H, solver.solution[: 6 * n].reshape(n, 6))
    return rate[:n] - solver.solution[: 6 * n].reshape(n, 6), -scale * solver.solution[6 * n :]


def _fill(system: System, H: Array, step: float) -> Array:
    """``M + h² K/4`` bordered by the constraints, into the KKT; returns their scale, (m,).

    Modes that the step does not resolve would start with accelerations that mean nothing to it.
    """
    tangent = system.tangent
    tangent.clear()
    system.elastic.reset_stress(H)
    tangent.add_elastic(H)
    tangent.add_springs(H)
    tangent.add_dampers(H, 0.5 * step)
    tangent.add_mass(H, system.kinds)
    tangent.A += 0.25 * step**2 * tangent.K
    scale = tangent.constraint_scale(H)
    tangent.fill(tangent.A, H, scale)
    return scale


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


def constraint_rates(system: System, H: Array, v: Array) -> Array:
    """``dΦ/dt`` at the twists ``v`` of all rows, shape (m,)."""
    first, _ = system.connections.rates(H, v)
    return first


def allowed_velocities(
    system: System, solver: DirectSolver, H: Array, twist: Array, time: float, step: float
) -> Array:
    """Velocities ``twist`` (≥ n, 6) without what joints and motions forbid, by an impulse in them.

    Args:
        system: The equations; its matrix is overwritten.
        solver: For that matrix.
        H: Frames of all rows.
        twist: Local velocities.
        time: The time.
        step: As in :func:`accelerations`.
    """
    n = system.count
    v, _ = with_driven(system, twist, time, step)
    if system.m == 0:
        return v
    solver.right_hand_side[: 6 * n] = 0.0
    solver.right_hand_side[6 * n :] = constraint_rates(system, H, v)
    solver.right_hand_side[6 * n :] -= system.connections.target_rates(time, step)[0]
    solver.right_hand_side[6 * n :] *= _fill(system, H, step)
    solver.factorise()
    solver.solve()
    v[:n] -= solver.solution[: 6 * n].reshape(n, 6)
    return v


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
    solver.right_hand_side[6 * n :] *= _fill(system, s.H, h)
    solver.factorise()
    solver.solve()
    across = solver.solution[: 6 * n].reshape(n, 6).copy()
    system.supports.turn_back(s.H, across)
    across[flat, :3] = np.einsum("nij,nj->ni", R, across[flat, :3])
    return across
