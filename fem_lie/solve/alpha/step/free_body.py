"""A step of a free rigid body, compiled, and its records.

The equations of a free body in its own frame at the centre of mass, with forces and moments
``f, m`` fixed in space and follower loads ``f', m'``::

    m (u̇ + ω×u) = Rᵀf + f'           J ω̇ + ω×Jω = Rᵀm + m'                 on SE(3)
    m ẍ = f + R f'                   the same                              on R³×SO(3)

The rotation does not depend on the translation, so that the 6×6 Newton matrix is block triangular.
Its factorisation is two inverse 3×3 blocks and the coupling block. It is constant except for
gyroscopic and load terms, and is frozen.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined
from fem_lie.lie.motions import Group
from fem_lie.lie.series import blend, tangent_coefficients
from fem_lie.lie.tuples import (
    Vector,
    combined,
    cross,
    dot,
    load,
    load_row,
    minus,
    negative,
    plus,
    rotate,
    rotate_back,
    scaled,
    store,
    store_row,
)
from fem_lie.solve.alpha.step import node
from fem_lie.solve.alpha.step.node import Scheme
from fem_lie.solve.convergence import DIVERGED, ROUND_OFF, UNMEASURED, estimate


class Bodies(NamedTuple):
    """Properties of all bodies.

    Attributes:
        mass: Masses, shape (n,).
        J: Inertia tensors about the centre of mass, shape (n, 3, 3).
        scaling: Norm weights of translation and rotation in the size of increments, shape (n, 2).
        group: Group of each body, see :class:`fem_lie.lie.motions.Group`, shape (n,).
    """

    mass: Array
    J: Array
    scaling: Array
    group: Indices


class Loads(NamedTuple):
    """Forces and moments, 12 numbers: those fixed in space, then follower loads.

    Attributes:
        constant: Loads without history, shape (n, 12).
        first: Index of the first load with history of each body, shape (n + 1,).
        vary: Loads with history, shape (k, 12).
        column: Their columns in the amplitudes, shape (k,).
    """

    constant: Array
    first: Indices
    vary: Array
    column: Indices


RATIO, MOTION, FEWEST, BEYOND = 0, 1, 2, 3
"""Indices into the iteration history of a body."""


class State(NamedTuple):
    """Start of a step and state between steps.

    Attributes:
        H: Frames, shape (n, 4, 3).
        v: Velocities of the group, shape (n, 6).
        vdot: Accelerations, shape (n, 6).
        a: Algorithmic accelerations, shape (n, 6).
        convergence: Last ratio of increments, largest motion, fewest iterations with the frozen
            matrix, excess iterations; shape (n, 4).
        kept: Frozen factors: rows of the inverse rotation block, columns of the coupling block,
            rows of the inverse translation block; shape (n, 9, 3).
        rates: Power of the loads on each body, force and moment about the origin, shape (n, 7).
        balance: Their work and impulses so far, shape (n, 7).
    """

    H: Array
    v: Array
    vdot: Array
    a: Array
    convergence: Array
    kept: Array
    rates: Array
    balance: Array


class Options(NamedTuple):
    """Options of the iteration.

    Attributes:
        tolerance: Allowed error, as a fraction of the largest motion.
        limit: Largest number of iterations of a step.
        patience: As in :class:`~fem_lie.solve.motion.policies.Automatic`.
        cost: As in :class:`~fem_lie.solve.motion.policies.Automatic`.
        full_newton_fallback: Whether a failed step is repeated with a new matrix in each iteration.
    """

    tolerance: float
    limit: int
    patience: int
    cost: float
    full_newton_fallback: bool


class Plan(NamedTuple):
    """Steps to make and to record.

    Attributes:
        first: First step.
        last: Last step.
        row: Row of the first recorded step.
        total: Number of steps of the run.
        every: Every n-th step is recorded.
    """

    first: int
    last: int
    row: int
    total: int
    every: int


class ResultRows(NamedTuple):
    """Arrays of results.

    Attributes:
        frames: Frames, shape (rows, n, 4, 3).
        velocities: Twists, shape (rows, n, 6).
        done: Work and impulses of loads at the recorded steps, shape (kept, 7); each body adds its
            own.
        iterations: Largest number of iterations of any body in each step, shape (last − first +
            1,).
        failed: Earliest failure: body, last increment and residual; shape (3,).
    """

    frames: Array
    velocities: Array
    done: Array
    iterations: Indices
    failed: Array


class Body(NamedTuple):
    """Properties of one body.

    Attributes:
        group: Group of its motion.
        m: Mass.
        J: Inertia tensor about the centre of mass, shape (3, 3).
        scaling: Norm weights as in :class:`Bodies`, shape (2,).
    """

    group: int
    m: float
    J: Array
    scaling: Array


class Start(NamedTuple):
    """Start of a step of one body, see :class:`State`.

    Attributes:
        H: Frame, shape (4, 3).
        v: Velocity, shape (6,).
        vdot: Acceleration, shape (6,).
        a: Algorithmic acceleration, shape (6,).
        convergence: Iteration history, shape (4,).
        kept: Frozen factors, shape (9, 3).
    """

    H: Array
    v: Array
    vdot: Array
    a: Array
    convergence: Array
    kept: Array


class End(NamedTuple):
    """End of a step of one body, overwritten.

    Attributes:
        d: Increment, shape (6,).
        H1: Frame, shape (4, 3).
        v1: Velocity, shape (6,).
        vdot1: Acceleration, shape (6,).
        dx: Correction, shape (6,).
    """

    d: Array
    H1: Array
    v1: Array
    vdot1: Array
    dx: Array


BODY, INCREMENT, RESIDUAL = 0, 1, 2
"""Indices into the record of a failure."""


@inlined
def residual(
    group: int, m: float, J: Array, f: Array, H1: Array, v1: Array, vdot1: Array
) -> tuple[Vector, Vector]:
    """Inertia minus load at the end of a step: translation and rotation."""
    d1, d2, d3 = load_row(H1, 1), load_row(H1, 2), load_row(H1, 3)
    J1, J2, J3 = load_row(J, 0), load_row(J, 1), load_row(J, 2)
    ω = load(v1, 3)
    rate = rotate_back(J1, J2, J3, load(vdot1, 3))
    gyroscopic = cross(ω, rotate_back(J1, J2, J3, ω))
    moment = plus(rotate_back(d1, d2, d3, load(f, 3)), load(f, 9))
    turning = minus(plus(rate, gyroscopic), moment)
    acceleration = load(vdot1, 0)
    if group == Group.SE3:
        acceleration = plus(acceleration, cross(ω, load(v1, 0)))
        force = plus(rotate_back(d1, d2, d3, load(f, 0)), load(f, 6))
    else:
        force = plus(load(f, 0), rotate(d1, d2, d3, load(f, 6)))
    return minus(scaled(m, acceleration), force), turning


@inlined
def inverse(a: Vector, b: Vector, c: Vector) -> tuple[Vector, Vector, Vector]:
    """Rows of the inverse of the matrix with columns ``a, b, c``."""
    bc = cross(b, c)
    s = 1.0 / dot(a, bc)
    return scaled(s, bc), scaled(s, cross(c, a)), scaled(s, cross(a, b))


@inlined
def _columns(
    p: Scheme,
    body: Body,
    f: Array,
    H1: Array,
    v1: Array,
    d: Array,
    e: Vector,
) -> tuple[Vector, Vector, Vector]:
    """Derivatives of the residual along the unit vector ``e``.

    Rotation by ``d_θ``, translation by ``d_θ``, translation by ``d_u``.
    """
    mass, damping = p.mass, p.damping
    group, m, J, _ = body
    d1, d2, d3 = load_row(H1, 1), load_row(H1, 2), load_row(H1, 3)
    J1, J2, J3 = load_row(J, 0), load_row(J, 1), load_row(J, 2)
    ω, θ = load(v1, 3), load(d, 3)
    Je, Jω = rotate_back(J1, J2, J3, e), rotate_back(J1, J2, J3, ω)
    k, _ = tangent_coefficients(dot(θ, θ))
    h = blend(k, θ, e)
    turning = combined(mass, Je, damping, plus(cross(ω, Je), cross(e, Jω)))
    turning = minus(turning, cross(rotate_back(d1, d2, d3, load(f, 3)), h))
    if group == Group.SE3:
        coupling = scaled(m * damping, cross(e, load(v1, 0)))
        coupling = minus(coupling, cross(rotate_back(d1, d2, d3, load(f, 0)), h))
        return turning, coupling, combined(m * mass, e, m * damping, cross(ω, e))
    coupling = negative(rotate(d1, d2, d3, cross(h, load(f, 6))))
    return turning, coupling, scaled(m * mass, e)


@compiled
def factorise(
    p: Scheme,
    body: Body,
    f: Array,
    H1: Array,
    v1: Array,
    d: Array,
    kept: Array,
) -> None:
    """Refactorise the frozen matrix."""
    a = _columns(p, body, f, H1, v1, d, (1.0, 0.0, 0.0))
    b = _columns(p, body, f, H1, v1, d, (0.0, 1.0, 0.0))
    c = _columns(p, body, f, H1, v1, d, (0.0, 0.0, 1.0))
    for block in range(3):
        rows = (a[block], b[block], c[block])
        if block != 1:
            rows = inverse(a[block], b[block], c[block])
        for k in range(3):
            store_row(kept, 3 * block + k, rows[k])


@inlined
def _solve(kept: Array, translation: Vector, turning: Vector, dx: Array) -> None:
    θ = rotate_back(load_row(kept, 0), load_row(kept, 1), load_row(kept, 2), turning)
    coupled = rotate(load_row(kept, 3), load_row(kept, 4), load_row(kept, 5), θ)
    right = minus(translation, coupled)
    store(dx, 0, rotate_back(load_row(kept, 6), load_row(kept, 7), load_row(kept, 8), right))
    store(dx, 3, θ)


@compiled
def make_step(
    p: Scheme,
    options: Options,
    body: Body,
    f: Array,
    state: Start,
    end: End,
    failed: Array,
) -> tuple[int, int]:
    """Make one step of one body; return iterations (0 if it failed) and factorisations."""
    tolerance, limit, patience, cost, _ = options
    group, m, J, scaling = body
    H, v, vdot, a, convergence, kept = state
    d, H1, v1, vdot1, dx = end
    motion = node.predict(p, group, scaling, H, v, vdot, a, d, H1, v1, vdot1)
    convergence[MOTION] = max(motion, convergence[MOTION])
    wanted = max(tolerance * convergence[MOTION], ROUND_OFF)
    previous, ratio, renewed, increment = np.inf, convergence[RATIO], 0, np.inf
    translation = turning = (0.0, 0.0, 0.0)
    failed[RESIDUAL] = 0.0
    for iteration in range(1, limit + 1):
        translation, turning = residual(group, m, J, f, H1, v1, vdot1)
        due = convergence[BEYOND] >= cost if iteration == 1 else (iteration - 1) % patience == 0
        if due:
            factorise(p, body, f, H1, v1, d, kept)
            convergence[FEWEST], convergence[BEYOND] = 0.0, 0.0
            renewed += 1
        _solve(kept, translation, turning, dx)
        increment = node.correct(p, group, scaling, dx, H, d, H1, v1, vdot1)
        ratio, remaining = estimate(increment, previous, ratio)
        if remaining <= wanted or increment <= ROUND_OFF:
            convergence[RATIO] = ratio if iteration > 1 else ratio**UNMEASURED
            counted = max(iteration, 2)  # as in policies.Automatic
            if convergence[FEWEST] == 0.0 or counted < convergence[FEWEST]:
                convergence[FEWEST] = counted
            convergence[BEYOND] += counted - convergence[FEWEST]
            node.accept(p, group, v, vdot, a, H1, v1, vdot1)
            H[:] = H1
            return iteration, renewed
        if not increment < DIVERGED:
            break
        previous = increment
    for k in range(3):
        failed[RESIDUAL] = max(failed[RESIDUAL], abs(translation[k]), abs(turning[k]))
    failed[INCREMENT] = increment
    return 0, renewed
