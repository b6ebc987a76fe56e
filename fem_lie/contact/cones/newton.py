"""Newton's method on the function of Alart & Curnier, for few contacts, with dense matrices."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import inlined_uncounted, uncounted
from fem_lie.contact.cones.jacobian import add_response, along_all
from fem_lie.contact.cones.sweeps import Cones, change, residual

_ITERATIONS, _HALVES = 10, 12
"""Largest number of iterations, and of halvings of the step in one of them."""

_REDUNDANT = 1e-8
"""Regularisation of the diagonal, relative to its size, for linearly dependent contacts."""

_YIELDS, _LESS, _MORE, _MOST_YIELDS, _PROXIMAL = 1e-4, 0.3, 10.0, 1e-2, 16
"""Compliance of contacts in the first proximal step, relative to their own response; factors for
the next step after convergence and after failure; largest compliance; number of steps."""

_FOUND = 1e-8
"""Tolerance of the function at the end of a proximal step, relative to the largest impulse."""


@uncounted
def _set_matrix(problem: Cones, k: int) -> None:
    """``B M⁻¹ B̄ᵀ`` of the first k contacts, column by column; ``W`` is overwritten."""
    responses, W, A = problem.responses, problem.W, problem.dense.A
    W[:] = 0.0
    for d in range(k):
        for j in range(3):
            add_response(responses, d, j, 1.0, W)
            for c in range(k):
                u = along_all(problem.rows, c, W)
                A[3 * c, 3 * d + j], A[3 * c + 1, 3 * d + j], A[3 * c + 2, 3 * d + j] = u
            A[3 * d + j, 3 * d + j] += problem.soft[d]
            for s in range(responses.first[d], responses.first[d + 1]):
                for at in range(6):
                    W[responses.nodes[s], at] = 0.0


@uncounted
def _set_function(problem: Cones, k: int, r: Array) -> float:
    """Set the function ``F``, whose zeros are solutions, and velocities ``u``; return ``F·F``."""
    A, u, F, q = problem.dense.A, problem.dense.u, problem.dense.F, problem.q
    square = 0.0
    for c in range(k):
        a = 3 * c
        for i in range(a, a + 3):
            u[i] = q[c, i - a]
            for j in range(3 * k):
                u[i] += A[i, j] * r[j]
        rn, rt = 1.0 / A[a, a], 2.0 / (A[a + 1, a + 1] + A[a + 2, a + 2])
        z = r[a] - rn * u[a]
        z1, z2 = r[a + 1] - rt * u[a + 1], r[a + 2] - rt * u[a + 2]
        radius, t = problem.friction[c] * z, np.sqrt(z1 * z1 + z2 * z2)
        if z <= 0.0:
            F[a], F[a + 1], F[a + 2] = r[a], r[a + 1], r[a + 2]
        elif t <= radius:
            F[a], F[a + 1], F[a + 2] = rn * u[a], rt * u[a + 1], rt * u[a + 2]
        else:
            part = radius / t
            F[a], F[a + 1], F[a + 2] = rn * u[a], r[a + 1] - part * z1, r[a + 2] - part * z2
        square += F[a] * F[a] + F[a + 1] * F[a + 1] + F[a + 2] * F[a + 2]
    return square


@uncounted
def _set_derivative(problem: Cones, k: int, r: Array) -> None:
    """Set the derivative ``J`` of the function at impulses ``r`` with velocities ``u``."""
    A, J, u = problem.dense.A, problem.dense.J, problem.dense.u
    for c in range(k):
        a = 3 * c
        rn, rt = 1.0 / A[a, a], 2.0 / (A[a + 1, a + 1] + A[a + 2, a + 2])
        z = r[a] - rn * u[a]
        z1, z2 = r[a + 1] - rt * u[a + 1], r[a + 2] - rt * u[a + 2]
        radius, t = problem.friction[c] * z, np.sqrt(z1 * z1 + z2 * z2)
        separation, slips = z <= 0.0, t > radius
        x, y, part = 0.0, 0.0, 0.0
        if slips and not separation:
            x, y, part = z1 / t, z2 / t, radius / t
        m11, m12, m22 = part * (1 - x * x), -part * x * y, part * (1 - y * y)
        for j in range(3 * k):
            n0, n1 = 1.0 if j == a else 0.0, 1.0 if j == a + 1 else 0.0
            n2 = 1.0 if j == a + 2 else 0.0
            if separation:
                J[a, j], J[a + 1, j], J[a + 2, j] = n0, n1, n2
                continue
            J[a, j] = rn * A[a, j]
            if not slips:
                J[a + 1, j], J[a + 2, j] = rt * A[a + 1, j], rt * A[a + 2, j]
                continue
            # δ(radius e) = μ e δz + part (I − e eᵀ) δz_t
            dz, d1, d2 = n0 - rn * A[a, j], n1 - rt * A[a + 1, j], n2 - rt * A[a + 2, j]
            J[a + 1, j] = n1 - (problem.friction[c] * x * dz + m11 * d1 + m12 * d2)
            J[a + 2, j] = n2 - (problem.friction[c] * y * dz + m12 * d1 + m22 * d2)
    for i in range(3 * k):
        J[i, i] += _REDUNDANT


@uncounted
def eliminate(J: Array, d: Array, n: int) -> None:
    """``d ← J⁻¹ d`` by Gaussian elimination with row exchanges."""
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(J[i, k]) > abs(J[best, k]):
                best = i
        if best != k:
            d[k], d[best] = d[best], d[k]
            for j in range(k, n):
                J[k, j], J[best, j] = J[best, j], J[k, j]
        for i in range(k + 1, n):
            factor = J[i, k] / J[k, k]
            if factor != 0.0:
                d[i] -= factor * d[k]
                for j in range(k + 1, n):
                    J[i, j] -= factor * J[k, j]
    for k in range(n - 1, -1, -1):
        for j in range(k + 1, n):
            d[k] -= J[k, j] * d[j]
        d[k] /= J[k, k]


@uncounted
def _begin(problem: Cones, k: int) -> None:
    """Copy the initial impulses to the workspace, and to ``kept`` in it."""
    workspace = problem.dense
    for i in range(3 * k):
        workspace.r[i] = workspace.kept[i] = problem.r[i // 3, i % 3]


@uncounted
def _step(problem: Cones, k: int) -> float:
    """Make one step of all impulses, halved until the function decreases; return ``F·F``."""
    n, workspace = 3 * k, problem.dense
    r, tried, F, d = workspace.r, workspace.tried, workspace.F, workspace.d
    square = _set_function(problem, k, r)
    _set_derivative(problem, k, r)
    for i in range(n):
        d[i] = F[i]
    eliminate(workspace.J, d, n)
    size, best, least = 1.0, 1.0, np.inf
    for _ in range(_HALVES):
        for i in range(n):
            tried[i] = r[i] - size * d[i]
        now = _set_function(problem, k, tried)
        if now < least:
            least, best = now, size
        if now < (1.0 - 1e-4 * size) * square:
            break
        size *= 0.5
    for i in range(n):
        r[i] -= best * d[i]
        problem.r[i // 3, i % 3] = r[i]
    return least


@uncounted
def newton(problem: Cones, k: int, tolerance: float) -> int:
    """Newton's method with step halving; return the number of iterations.

    Args:
        problem: Impulses and velocities are updated; the initial impulses are ``kept`` in the
            workspace.
        k: Number of contacts, at most :data:`~fem_lie.contact.cones.sweeps.MOST_NEWTON`.
        tolerance: Tolerance of the residual.
    """
    _begin(problem, k)
    _set_matrix(problem, k)
    for iteration in range(1, _ITERATIONS + 1):
        _step(problem, k)
        change(problem, k)
        if residual(problem, k) <= tolerance:
            return iteration
    return _ITERATIONS


@uncounted
def _yield_more(problem: Cones, k: int, part: float) -> None:
    """Add a compliance of ``part`` of the contacts' own response to impulses beyond ``start``.

    A call with ``part`` and one with ``−part`` cancel.
    """
    A, start = problem.dense.A, problem.dense.start
    for c in range(k):
        a, own = 3 * c, problem.own[c]
        soft = part * (own[0, 0] + own[1, 1] + own[2, 2]) / 3.0
        for i in range(3):
            A[a + i, a + i] += soft
            problem.q[c, i] -= soft * start[a + i]


@inlined_uncounted
def _largest(r: Array, n: int) -> float:
    """The largest of the first ``n`` numbers in size; nan if any is."""
    largest = 0.0
    for i in range(n):
        size = abs(r[i])
        if size > largest or size != size:
            largest = size
    return largest


@uncounted
def proximal(problem: Cones, k: int, tolerance: float, most: float) -> tuple[int, float]:
    """Newton's method with proximal steps, for contacts that are dependent or nearly so.

    In each step contacts are compliant to the difference from the impulses of the step before, so
    that the solution is unique. Where impulses no longer change, they solve the original problem
    (R. T. Rockafellar, SIAM J. Control Optim. 14 (1976) 877).

    Args:
        problem: Impulses and velocities are updated to those of the least residual.
        k: Number of contacts, at most :data:`~fem_lie.contact.cones.sweeps.MOST_NEWTON`.
        tolerance: Tolerance of the residual.
        most: Largest ratio of the impulses to those at the start; impulses that exceed it are not
            taken.

    Returns:
        Number of iterations, and the residual.
    """
    _begin(problem, k)
    _set_matrix(problem, k)
    workspace, n = problem.dense, 3 * k
    change(problem, k)
    part, iterations, reached = _YIELDS, 0, residual(problem, k)
    most *= _largest(workspace.kept, n)
    for _ in range(_PROXIMAL):
        largest = 0.0
        for i in range(n):
            workspace.r[i] = workspace.start[i] = workspace.kept[i]
        _yield_more(problem, k, part)
        found = False
        for _ in range(_ITERATIONS):
            square = _step(problem, k)
            iterations += 1
            largest = max(largest, _largest(workspace.r, n))
            found = square <= (_FOUND * largest) ** 2
            if found:
                break
        _yield_more(problem, k, -part)
        change(problem, k)
        now = residual(problem, k)
        if not _largest(workspace.r, n) <= most:
            break
        if found or now < reached:
            reached = now
            for i in range(n):
                workspace.kept[i] = workspace.r[i]
        if reached <= tolerance:
            break
        part = _LESS * part if found else min(_MORE * part, _MOST_YIELDS)
    for i in range(n):
        problem.r[i // 3, i % 3] = workspace.kept[i]
    change(problem, k)
    return iterations, residual(problem, k)
