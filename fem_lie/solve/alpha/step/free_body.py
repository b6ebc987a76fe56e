"""A step of a free rigid body, compiled.

The equations of a free body in its own frame at the centre of mass, with forces and moments
``f, m`` fixed in space and ``f', m'`` following::

    m (u̇ + ω×u) = Rᵀf + f'           J ω̇ + ω×Jω = Rᵀm + m'                 on SE(3)
    m ẍ = f + R f'                   the same                              on R³×SO(3)

Turning does not depend on the translation, so the 6×6 matrix of Newton's method is block
triangular, and its factorisation is two 3×3 inverses and the block between them. It is constant but
for the gyroscopic and load terms, and is kept.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
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
from fem_lie.solve.alpha.step.free_records import (
    BEYOND,
    FEWEST,
    INCREMENT,
    MOTION,
    RATIO,
    RESIDUAL,
    Body,
    End,
    Options,
    Start,
)
from fem_lie.solve.alpha.step.node import Scheme
from fem_lie.solve.convergence import DIVERGED, ROUND_OFF, UNMEASURED, estimate


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

    Of the rotation by ``d_θ``, of the translation by ``d_θ``, of the translation by ``d_u``.
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
    """Renew the kept matrix."""
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
    """Iterations, 0 if it failed, and factorisations of one step of one body."""
    tolerance, limit, patience, cost, _ = options
    group, m, J, scaling = body
    H, v, vdot, a, memory, kept = state
    d, H1, v1, vdot1, dx = end
    motion = node.predict(p, group, scaling, H, v, vdot, a, d, H1, v1, vdot1)
    memory[MOTION] = max(motion, memory[MOTION])
    wanted = max(tolerance * memory[MOTION], ROUND_OFF)
    previous, ratio, renewed, increment = np.inf, memory[RATIO], 0, np.inf
    translation = turning = (0.0, 0.0, 0.0)
    failed[RESIDUAL] = 0.0
    for iteration in range(1, limit + 1):
        translation, turning = residual(group, m, J, f, H1, v1, vdot1)
        due = memory[BEYOND] >= cost if iteration == 1 else (iteration - 1) % patience == 0
        if due:
            factorise(p, body, f, H1, v1, d, kept)
            memory[FEWEST], memory[BEYOND] = 0.0, 0.0
            renewed += 1
        _solve(kept, translation, turning, dx)
        increment = node.correct(p, group, scaling, dx, H, d, H1, v1, vdot1)
        ratio, remaining = estimate(increment, previous, ratio)
        if remaining <= wanted or increment <= ROUND_OFF:
            memory[RATIO] = ratio if iteration > 1 else ratio**UNMEASURED
            counted = max(iteration, 2)  # as policies.Automatic: one iteration is luck
            if memory[FEWEST] == 0.0 or counted < memory[FEWEST]:
                memory[FEWEST] = counted
            memory[BEYOND] += counted - memory[FEWEST]
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
