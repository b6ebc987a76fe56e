"""The exact solution of one contact by Coulomb's law: it takes off, sticks or slips."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import inlined_uncounted, uncounted
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
