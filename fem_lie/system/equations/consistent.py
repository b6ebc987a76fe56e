"""Consistent initial values: velocities that joints allow, accelerations and joint forces."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie.linear.direct import DirectSolver
from fem_lie.linear.equilibrated import InaccurateSolutionError, SingularMatrixError
from fem_lie.system.instant import Instant
from fem_lie.system.system import System

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


class Driven(NamedTuple):
    """Rates of what is driven.

    Attributes:
        velocities: Twists of the prescribed motions, (p, 6).
        targets: Rates of the targets of constraints, (m,).
    """

    velocities: Array
    targets: Array


def driven(system: System, time: float, step: float) -> Driven:
    """What motions and drives do at ``time``.

    Differences over later times: they need not be defined before the start.
    """
    v, _ = with_driven(system, np.zeros_like(system.velocities), time, step)
    return Driven(v[system.count + 1 :], system.connections.target_rates(time, step)[0])


def with_driven(system: System, velocities: Array, time: float, step: float) -> tuple[Array, Array]:
    """Velocities with those of the prescribed motions at ``time``, and their accelerations (p, 6).

    Differences over three later times: the motion need not be defined before the start.
    """
    v, first = velocities.copy(), system.count + 1
    if len(v) == first:
        return v, np.zeros((0, 6))
    step = min(step, system.rows.until_break(time) / 3.0)
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
        ValueError: The mass matrix is singular, forces are beyond the range of numbers, or no
            solver could solve the equations.
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
    system.residual(Instant(H, v, rate[:n], np.zeros(m)), np.ones(m), r)
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
    except InaccurateSolutionError as error:
        raise ValueError(f"initial accelerations cannot be computed: {error}") from error
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
    terms, still = system.terms, np.zeros((system.count, 6))
    kept = terms.room()
    tangent.clear()
    terms.reset_stress(H)
    terms.add_forces(H, np.zeros(system.size), kept)
    tangent.add_terms(H, kept)
    tangent.add_viscosity(H, still, 0.5 * step, lambda term: not (term.of_bodies or term.in_space))
    tangent.add_mass(H, system.kinds)
    tangent.A += 0.25 * step**2 * tangent.K
    scale = tangent.constraint_scale(H)
    tangent.fill(tangent.A, H, scale)
    return scale


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
    v, _ = with_driven(system, twist, time, step)
    if system.m == 0:
        return v
    rates, _ = system.connections.rates(H, v)
    rates -= system.connections.target_rates(time, step)[0]
    v[: system.count] -= across_joints(system, solver, H, rates, step)
    return v


def across_joints(
    system: System, solver: DirectSolver, H: Array, rates: Array, step: float
) -> Array:
    """Velocities that change constraints at given rates, the nearest to rest in them.

    Args:
        system: The equations; its matrix is overwritten.
        solver: For that matrix.
        H: Frames of all rows.
        rates: Of the constraints, shape (m,).
        step: As in :func:`accelerations`.

    Returns:
        Twists of the moving nodes, shape (n, 6).
    """
    n = system.count
    solver.right_hand_side[: 6 * n] = 0.0
    solver.right_hand_side[6 * n :] = rates * _fill(system, H, step)
    solver.factorise()
    solver.solve()
    v = solver.solution[: 6 * n].reshape(n, 6).copy()
    system.supports.turn_back(H, v)
    return v
