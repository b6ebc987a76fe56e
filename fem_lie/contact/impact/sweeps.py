"""Sweeps over the contacts of a problem, each solved exactly by Coulomb's law."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import inlined_uncounted, uncounted
from fem_lie.contact.impact.jacobian import BlockRows, along_all, push_all, rates
from fem_lie.lie.tuples import Vector


@inlined_uncounted
def projected(r: Vector, mu: float) -> Vector:
    """On the cone ``|r_t| ≤ μ r_n``."""
    t = np.sqrt(r[1] * r[1] + r[2] * r[2])
    if t <= mu * r[0]:
        return r
    if mu * t <= -r[0]:
        return 0.0, 0.0, 0.0
    n = (r[0] + mu * t) / (1.0 + mu * mu)
    return n, mu * n / t * r[1], mu * n / t * r[2]


@inlined_uncounted
def _slip(A: Array, b: Vector, mu: float, angle: float) -> tuple[float, float, float]:
    """Velocity across and along a direction of sliding, and the normal impulse there."""
    c, s = np.cos(angle), np.sin(angle)
    slope = A[0, 0] - mu * (A[0, 1] * c + A[0, 2] * s)
    normal = -b[0] / slope if slope > 0.0 else -1.0
    first = b[1] + normal * (A[1, 0] - mu * (A[1, 1] * c + A[1, 2] * s))
    second = b[2] + normal * (A[2, 0] - mu * (A[2, 1] * c + A[2, 2] * s))
    return c * second - s * first, c * first + s * second, normal


@inlined_uncounted
def _stick(A: Array, b: Vector) -> Vector:
    """``−A⁻¹ b``."""
    c00 = A[1, 1] * A[2, 2] - A[1, 2] * A[2, 1]
    c01 = A[1, 2] * A[2, 0] - A[1, 0] * A[2, 2]
    c02 = A[1, 0] * A[2, 1] - A[1, 1] * A[2, 0]
    s = -1.0 / (A[0, 0] * c00 + A[0, 1] * c01 + A[0, 2] * c02)
    c10 = A[0, 2] * A[2, 1] - A[0, 1] * A[2, 2]
    c11 = A[0, 0] * A[2, 2] - A[0, 2] * A[2, 0]
    c12 = A[0, 1] * A[2, 0] - A[0, 0] * A[2, 1]
    c20 = A[0, 1] * A[1, 2] - A[0, 2] * A[1, 1]
    c21 = A[0, 2] * A[1, 0] - A[0, 0] * A[1, 2]
    c22 = A[0, 0] * A[1, 1] - A[0, 1] * A[1, 0]
    return (
        s * (c00 * b[0] + c10 * b[1] + c20 * b[2]),
        s * (c01 * b[0] + c11 * b[1] + c21 * b[2]),
        s * (c02 * b[0] + c12 * b[1] + c22 * b[2]),
    )


@uncounted
def _angle_by_secant(A: Array, b: Vector, mu: float, angle: float) -> float:
    """Direction in which a contact slides without a force across it, from one that is near."""
    x0, x1 = angle, angle + 1e-3
    f0, f1 = _slip(A, b, mu, x0)[0], _slip(A, b, mu, x1)[0]
    for _ in range(30):
        if f1 == f0:
            break
        x2 = x1 - f1 * (x1 - x0) / (f1 - f0)
        if abs(x2 - x1) > 0.5:
            x2 = x1 + (0.5 if x2 > x1 else -0.5)
        x0, f0, x1 = x1, f1, x2
        f1 = _slip(A, b, mu, x1)[0]
        if abs(x1 - x0) < 1e-14:
            break
    return x1


@uncounted
def _scanned(A: Array, b: Vector, mu: float) -> float:
    """The best of 32 directions."""
    best, found = np.inf, 0.0
    for k in range(32):
        angle = 2.0 * np.pi * k / 32
        across, ahead, normal = _slip(A, b, mu, angle)
        if normal > 0.0 and ahead > 0.0 and abs(across) < best:
            best, found = abs(across), angle
    return found


@uncounted
def single(A: Array, b: Vector, mu: float, before: Vector) -> Vector:
    """The solution at one contact: it takes off, sticks or slips.

    Args:
        A: Shape (3, 3).
        b: Velocity without its impulse.
        mu: Coefficient of friction.
        before: An impulse that may be near.
    """
    if b[0] >= 0.0:
        return 0.0, 0.0, 0.0
    if mu == 0.0:
        return -b[0] / A[0, 0], 0.0, 0.0
    held = _stick(A, b)
    if held[0] >= 0.0 and np.sqrt(held[1] ** 2 + held[2] ** 2) <= mu * held[0]:
        return held
    near = before if before[1] != 0.0 or before[2] != 0.0 else held
    angle, size = np.arctan2(-near[2], -near[1]), abs(b[0]) + abs(b[1]) + abs(b[2])
    for attempt in range(2):
        angle = _angle_by_secant(A, b, mu, angle)
        across, ahead, normal = _slip(A, b, mu, angle)
        if normal > 0.0 and ahead >= -1e-12 * size and abs(across) < 1e-9 * size:
            return normal, -mu * normal * np.cos(angle), -mu * normal * np.sin(angle)
        if attempt == 0:
            angle = _scanned(A, b, mu)
    return _relaxed(A, b, mu, before)


@uncounted
def _relaxed(A: Array, b: Vector, mu: float, r: Vector) -> Vector:
    """By projections, where there is no solution that slips."""
    rho = 1.0 / (A[0, 0] + A[1, 1] + A[2, 2])
    for _ in range(200):
        u0 = A[0, 0] * r[0] + A[0, 1] * r[1] + A[0, 2] * r[2] + b[0]
        u1 = A[1, 0] * r[0] + A[1, 1] * r[1] + A[1, 2] * r[2] + b[1]
        u2 = A[2, 0] * r[0] + A[2, 1] * r[1] + A[2, 2] * r[2] + b[2]
        lifted = u0 + mu * np.sqrt(u1 * u1 + u2 * u2)
        r = projected((r[0] - rho * lifted, r[1] - rho * u1, r[2] - rho * u2), mu)
    return r


MOST_NEWTON = 60
"""Contacts for which there is room for a dense matrix."""


class Dense(NamedTuple):
    """Room of Newton's method, N = 3 MOST_NEWTON or less.

    Attributes:
        A: ``B M⁻¹ B̄ᵀ``, shape (N, N).
        J: Of the derivative, likewise.
        r: Impulses, shape (N,).
        kept: Those before, likewise.
        start: Those from which they differ in a proximal step, likewise.
        tried: Those of a part of a step, likewise.
        u: Velocities, likewise.
        F: Of which zeros are wanted, likewise.
        d: A step, likewise.
    """

    A: Array
    J: Array
    r: Array
    kept: Array
    start: Array
    tried: Array
    u: Array
    F: Array
    d: Array


def dense_of(m: int) -> Dense:
    """For at most ``m`` contacts."""
    n = 3 * min(m, MOST_NEWTON)
    return Dense(np.zeros((n, n)), np.zeros((n, n)), *(np.zeros(n) for _ in range(7)))


PAST = 10
"""Sweeps that are known of many contacts."""


class Past(NamedTuple):
    """The last sweeps of a method for many contacts.

    Attributes:
        start: Impulses before the last one, shape (m, 3).
        end: And after it, likewise.
        did: What it did, likewise.
        turned: Changes of velocities after it, shape (n, 6).
        steps: By what the ends of sweeps differ, shape (:data:`PAST`, m, 3).
        changes: By what differs what they did, likewise.
        turns: By what velocities differ, shape (:data:`PAST`, n, 6).
        products: Of ``changes``, shape (:data:`PAST`, :data:`PAST`).
        room: Likewise.
        parts: Shape (:data:`PAST`,).
    """

    start: Array
    end: Array
    did: Array
    turned: Array
    steps: Array
    changes: Array
    turns: Array
    products: Array
    room: Array
    parts: Array


def past_of(m: int, n: int) -> Past:
    """For at most ``m`` contacts of ``n`` nodes."""
    z = np.zeros
    return Past(
        start=z((m, 3)),
        end=z((m, 3)),
        did=z((m, 3)),
        turned=z((n, 6)),
        steps=z((PAST, m, 3)),
        changes=z((PAST, m, 3)),
        turns=z((PAST, n, 6)),
        products=z((PAST, PAST)),
        room=z((PAST, PAST)),
        parts=z(PAST),
    )


class Cones(NamedTuple):
    """The first k contacts of these are a problem.

    Attributes:
        rows: ``B``.
        pushes: Rows of ``M⁻¹ B̄ᵀ``: velocities by unit impulses.
        own: Products of both at one contact, with ``soft``, shape (·, 3, 3).
        soft: Velocity by which a contact yields to a unit impulse, shape (·,).
        q: Velocities without impulses, less the least ones, shape (·, 3).
        friction: μ, shape (·,).
        r: Impulses; start and solution, shape (·, 3).
        W: Change of the nodes' velocities, shape (n, 6).
        dense: Memory of Newton's method.
        past: Memory of sweeps over many contacts.
        least: Velocity that is round-off in this problem, shape (1,).
    """

    rows: BlockRows
    pushes: BlockRows
    own: Array
    soft: Array
    q: Array
    friction: Array
    r: Array
    W: Array
    dense: Dense
    past: Past
    least: Array


def cones_of(rows: BlockRows, pushes: BlockRows, n: int) -> Cones:
    """A problem of at most as many contacts as ``rows`` has, of ``n`` nodes; all else is zero."""
    m, z = len(rows.first) - 1, np.zeros
    return Cones(
        rows,
        pushes,
        own=z((m, 3, 3)),
        soft=z(m),
        q=z((m, 3)),
        friction=z(m),
        r=z((m, 3)),
        W=z((n, 6)),
        dense=dense_of(m),
        past=past_of(m, n),
        least=z(1),
    )


@uncounted
def begin(problem: Cones, k: int) -> None:
    """Find the products at single contacts, and what the impulses do that it starts with."""
    rows, pushes, own = problem.rows, problem.pushes, problem.own
    for c in range(k):
        for i in range(3):
            for j in range(3):
                total = 0.0
                for s in range(rows.first[c], rows.first[c + 1]):
                    for t in range(pushes.first[c], pushes.first[c + 1]):
                        if rows.nodes[s] == pushes.nodes[t]:
                            for at in range(6):
                                total += rows.values[s, i, at] * pushes.values[t, j, at]
                own[c, i, j] = total
            own[c, i, i] += problem.soft[c]
    change(problem, k)


@uncounted
def change(problem: Cones, k: int) -> None:
    """Find what the impulses do to the velocities."""
    problem.W[:] = 0.0
    for c in range(k):
        r = problem.r[c, 0], problem.r[c, 1], problem.r[c, 2]
        push_all(problem.pushes, c, r, problem.W)


@uncounted
def products(problem: Cones, r: Array, u: Array) -> None:
    """``u = B M⁻¹ B̄ᵀ r`` of all contacts, shapes (k, 3); the problem's impulses become ``r``."""
    k = r.shape[0]
    for c in range(k):
        for i in range(3):
            problem.r[c, i] = r[c, i]
    change(problem, k)
    rates(problem.rows, problem.W, u)


@inlined_uncounted
def velocity(problem: Cones, c: int) -> Vector:
    """``u`` at contact ``c``, with all impulses."""
    q, r, soft = problem.q, problem.r, problem.soft[c]
    u0, u1, u2 = along_all(problem.rows, c, problem.W)
    return (
        q[c, 0] + u0 + soft * r[c, 0],
        q[c, 1] + u1 + soft * r[c, 1],
        q[c, 2] + u2 + soft * r[c, 2],
    )


@uncounted
def sweep(problem: Cones, k: int) -> None:
    """Solve one contact after the other."""
    r, own = problem.r, problem.own
    for c in range(k):
        r0, r1, r2, A = r[c, 0], r[c, 1], r[c, 2], own[c]
        u0, u1, u2 = velocity(problem, c)
        b = (
            u0 - A[0, 0] * r0 - A[0, 1] * r1 - A[0, 2] * r2,
            u1 - A[1, 0] * r0 - A[1, 1] * r1 - A[1, 2] * r2,
            u2 - A[2, 0] * r0 - A[2, 1] * r1 - A[2, 2] * r2,
        )
        x = single(A, b, problem.friction[c], (r0, r1, r2))
        if x[0] != r0 or x[1] != r1 or x[2] != r2:
            push_all(problem.pushes, c, (x[0] - r0, x[1] - r1, x[2] - r2), problem.W)
            r[c, 0], r[c, 1], r[c, 2] = x


@inlined_uncounted
def off_cone(u: Vector, own: Array, mu: float, r: Array) -> tuple[float, float]:
    """The largest part of ``|r − P_K(r − ρ û)|`` of one contact, and its ``ρ`` by the trace.

    Args:
        u: Velocity with all impulses.
        own: Product of its rows, shape (3, 3).
        mu: Coefficient of friction.
        r: Its impulse, shape (3,).
    """
    rho = 3.0 / (own[0, 0] + own[1, 1] + own[2, 2])
    lifted = u[0] + mu * np.sqrt(u[1] * u[1] + u[2] * u[2])
    p = projected((r[0] - rho * lifted, r[1] - rho * u[1], r[2] - rho * u[2]), mu)
    worst = 0.0
    for i in range(3):
        off = abs(r[i] - p[i])
        if not off <= worst:
            worst = off if off == off else np.inf
    return worst, rho


@uncounted
def residual(problem: Cones, k: int) -> float:
    """Largest :func:`off_cone` over the largest impulse.

    Velocities of :attr:`Cones.least` are known no better than to round-off.
    """
    worst, size, least = 0.0, np.finfo(np.float64).tiny, problem.least[0]
    for c in range(k):
        off, rho = off_cone(velocity(problem, c), problem.own[c], problem.friction[c], problem.r[c])
        worst = max(worst, off)
        size = max(size, abs(problem.r[c, 0]), rho * max(abs(problem.q[c, 0]), least))
    return float(worst / size)
