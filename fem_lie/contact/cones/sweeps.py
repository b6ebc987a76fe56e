"""Nonlinear Gauss-Seidel sweeps: Coulomb's law is solved exactly at one contact after the other."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import inlined_uncounted, uncounted
from fem_lie.contact.cones.jacobian import BlockRows, add_responses, along_all, rates
from fem_lie.lie.tuples import Vector


@inlined_uncounted
def projected(r: Vector, mu: float) -> Vector:
    """Projection on the cone ``|r_t| ≤ μ r_n``."""
    t = np.sqrt(r[1] * r[1] + r[2] * r[2])
    if t <= mu * r[0]:
        return r
    if mu * t <= -r[0]:
        return 0.0, 0.0, 0.0
    n = (r[0] + mu * t) / (1.0 + mu * mu)
    return n, mu * n / t * r[1], mu * n / t * r[2]


@inlined_uncounted
def _slip(A: Array, b: Vector, mu: float, angle: float) -> tuple[float, float, float]:
    """Velocity across and along a direction of sliding, and the normal impulse."""
    c, s = np.cos(angle), np.sin(angle)
    slope = A[0, 0] - mu * (A[0, 1] * c + A[0, 2] * s)
    normal = -b[0] / slope if slope > 0.0 else -1.0
    first = b[1] + normal * (A[1, 0] - mu * (A[1, 1] * c + A[1, 2] * s))
    second = b[2] + normal * (A[2, 0] - mu * (A[2, 1] * c + A[2, 2] * s))
    return c * second - s * first, c * first + s * second, normal


@inlined_uncounted
def _stick(A: Array, b: Vector) -> Vector:
    """Impulse ``−A⁻¹ b`` of a sticking contact."""
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
    """Direction of sliding, without a force across it, by the secant method from a guess."""
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
    """The best of 32 directions of sliding."""
    best, found = np.inf, 0.0
    for k in range(32):
        angle = 2.0 * np.pi * k / 32
        across, ahead, normal = _slip(A, b, mu, angle)
        if normal > 0.0 and ahead > 0.0 and abs(across) < best:
            best, found = abs(across), angle
    return found


@uncounted
def single(A: Array, b: Vector, mu: float, before: Vector) -> Vector:
    """Solution at one contact: it opens, sticks or slips.

    Args:
        A: Response matrix, shape (3, 3).
        b: Velocity without the impulse of this contact.
        mu: Coefficient of friction.
        before: Initial guess of the impulse.
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
    """Impulse by projections, where the search for a direction of sliding fails."""
    rho = 1.0 / (A[0, 0] + A[1, 1] + A[2, 2])
    for _ in range(200):
        u0 = A[0, 0] * r[0] + A[0, 1] * r[1] + A[0, 2] * r[2] + b[0]
        u1 = A[1, 0] * r[0] + A[1, 1] * r[1] + A[1, 2] * r[2] + b[1]
        u2 = A[2, 0] * r[0] + A[2, 1] * r[1] + A[2, 2] * r[2] + b[2]
        lifted = u0 + mu * np.sqrt(u1 * u1 + u2 * u2)
        r = projected((r[0] - rho * lifted, r[1] - rho * u1, r[2] - rho * u2), mu)
    return r


MOST_NEWTON = 60
"""Largest number of contacts for which a dense matrix is allocated."""


class Dense(NamedTuple):
    """Workspace of Newton's method, with N ≤ 3 MOST_NEWTON.

    Attributes:
        A: ``B M⁻¹ B̄ᵀ``, shape (N, N).
        J: Derivative of the function, shape (N, N).
        r: Impulses, shape (N,).
        kept: Initial impulses, shape (N,).
        start: Reference impulses of a proximal step, shape (N,).
        tried: Impulses of a reduced step, shape (N,).
        u: Velocities, shape (N,).
        F: Function whose zeros are solutions, shape (N,).
        d: Newton step, shape (N,).
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
    """Workspace for at most ``m`` contacts."""
    n = 3 * min(m, MOST_NEWTON)
    return Dense(np.zeros((n, n)), np.zeros((n, n)), *(np.zeros(n) for _ in range(7)))


PAST = 10
"""Number of sweeps that are stored for extrapolation, for many contacts."""


class Past(NamedTuple):
    """History of the last sweeps, for problems with many contacts.

    Attributes:
        start: Impulses before the last sweep, shape (m, 3).
        end: Impulses after it, shape (m, 3).
        did: Change of the impulses in it, shape (m, 3).
        turned: Change of nodal velocities after it, shape (n, 6).
        steps: Differences of the results of sweeps, shape (:data:`PAST`, m, 3).
        changes: Differences of the changes in sweeps, shape (:data:`PAST`, m, 3).
        turns: Differences of nodal velocities, shape (:data:`PAST`, n, 6).
        products: Scalar products of ``changes``, shape (:data:`PAST`, :data:`PAST`).
        workspace: Workspace of the same shape.
        parts: Coefficients of the extrapolation, shape (:data:`PAST`,).
    """

    start: Array
    end: Array
    did: Array
    turned: Array
    steps: Array
    changes: Array
    turns: Array
    products: Array
    workspace: Array
    parts: Array


def past_of(m: int, n: int) -> Past:
    """History for at most ``m`` contacts of ``n`` nodes."""
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
        workspace=z((PAST, PAST)),
        parts=z(PAST),
    )


class Cones(NamedTuple):
    """The problem of the first k contacts.

    Attributes:
        rows: ``B``.
        responses: Rows of ``M⁻¹ B̄ᵀ``: velocities per unit impulse.
        own: Products of both at the same contact, including ``soft``, shape (·, 3, 3).
        soft: Compliance: velocity per unit impulse of a contact, shape (·,).
        q: Velocities without impulses, minus the least allowed ones, shape (·, 3).
        friction: μ, shape (·,).
        r: Impulses; initial guess and solution, shape (·, 3).
        W: Change of nodal velocities, shape (n, 6).
        dense: Workspace of Newton's method.
        past: History of sweeps over many contacts.
        least: Round-off level of velocities in this problem, shape (1,).
    """

    rows: BlockRows
    responses: BlockRows
    own: Array
    soft: Array
    q: Array
    friction: Array
    r: Array
    W: Array
    dense: Dense
    past: Past
    least: Array


Workspaces: TypeAlias = tuple[Dense, Past]
"""Workspaces of both methods, which problems of one size share if they are solved in turn."""


def workspaces_of(m: int, n: int) -> Workspaces:
    """Workspaces of a problem of at most ``m`` contacts of ``n`` nodes."""
    return dense_of(m), past_of(m, n)


def cones_of(
    rows: BlockRows, responses: BlockRows, n: int, workspaces: Workspaces | None = None
) -> Cones:
    """A problem of at most as many contacts as ``rows`` has, with ``n`` nodes; all else is zero.

    Args:
        rows: ``B``.
        responses: Rows of ``M⁻¹ B̄ᵀ``.
        n: Number of nodes.
        workspaces: Workspaces of a problem of this size; default: new ones.
    """
    m, z = len(rows.first) - 1, np.zeros
    dense, past = workspaces_of(m, n) if workspaces is None else workspaces
    return Cones(
        rows,
        responses,
        own=z((m, 3, 3)),
        soft=z(m),
        q=z((m, 3)),
        friction=z(m),
        r=z((m, 3)),
        W=z((n, 6)),
        dense=dense,
        past=past,
        least=z(1),
    )


@uncounted
def begin(problem: Cones, k: int) -> None:
    """Set the products at single contacts, and the velocities due to the initial impulses."""
    rows, responses, own = problem.rows, problem.responses, problem.own
    for c in range(k):
        for i in range(3):
            for j in range(3):
                total = 0.0
                for s in range(rows.first[c], rows.first[c + 1]):
                    for t in range(responses.first[c], responses.first[c + 1]):
                        if rows.nodes[s] == responses.nodes[t]:
                            for at in range(6):
                                total += rows.values[s, i, at] * responses.values[t, j, at]
                own[c, i, j] = total
            own[c, i, i] += problem.soft[c]
    change(problem, k)


@uncounted
def change(problem: Cones, k: int) -> None:
    """Set the change of nodal velocities due to the impulses."""
    problem.W[:] = 0.0
    for c in range(k):
        r = problem.r[c, 0], problem.r[c, 1], problem.r[c, 2]
        add_responses(problem.responses, c, r, problem.W)


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
    """Relative velocity ``u`` at contact ``c``, with all impulses."""
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
            add_responses(problem.responses, c, (x[0] - r0, x[1] - r1, x[2] - r2), problem.W)
            r[c, 0], r[c, 1], r[c, 2] = x


@inlined_uncounted
def off_cone(u: Vector, own: Array, mu: float, r: Array) -> tuple[float, float]:
    """Largest component of ``|r − P_K(r − ρ û)|`` of one contact, and its ``ρ``, from the trace.

    Args:
        u: Velocity with all impulses.
        own: Product of its rows, shape (3, 3).
        mu: Coefficient of friction.
        r: Impulse of the contact, shape (3,).
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
    """Largest :func:`off_cone` relative to the largest impulse.

    Velocities below :attr:`Cones.least` count as round-off.
    """
    worst, size, least = 0.0, np.finfo(np.float64).tiny, problem.least[0]
    for c in range(k):
        off, rho = off_cone(velocity(problem, c), problem.own[c], problem.friction[c], problem.r[c])
        worst = max(worst, off)
        size = max(size, abs(problem.r[c, 0]), rho * max(abs(problem.q[c, 0]), least))
    return float(worst / size)
