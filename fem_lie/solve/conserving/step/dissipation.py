"""Velocities over a step: those of the midpoint rule, or with dissipation of what is not resolved.

::

    (q₁ − q)/h = V̄ + g,      V̄ = ½ (V + V₁),      g = ½ χ Π (ΔV − β w),      w ← w + μ (ΔV − w)

With ``χ = 0`` nothing is lost. Otherwise ``w`` is a memory of the changes ``ΔV = V₁ − V``, so that
``ΔV − w`` is of second order in h where the step resolves the motion. With the same done to elastic
forces, linear problems are integrated by a two-step method of second order that is A-stable, with
the eigenvalues −ρ and 0 at infinite frequency for ``χ = (1 − ρ)/(3 + ρ)``, ``μ = 1 − χ``: the
trapezoidal rule for ρ = 1, BDF2 for ρ = 0.

The kinetic energy loses ``ΔV·G g``. ``Π`` takes the best rotation ``Ω × V̄`` out of its argument, in
the metric of inertia: then ``Σ V̄ × G g = 0``, which is what angular momentum needs, and a body that
turns steadily is not damped.

With changes ``Δ`` of velocities and of elastic forces as one vector, in the norm of inertia and
compliance, what is lost is ``½ χ Δ·(Δ − β w)``. ``β w`` is the memory as far as it is not longer
than the change, or, where it points the other way, than up to twice the change::

    β = min(1, (|Δ| + max(−Δ·w, 0)/|w|)/|w|)

By Cauchy and Schwarz nothing is gained, in any single step; and ``β w`` is a Lipschitz continuous
function of the change that is nil where the change is, so it is defined where nothing deforms.
``|Δ − β w| ≤ 2 |Δ − w|``: it costs no order. ``|w|²`` of elastic forces follows from the rule of
``w``. Elements whose forces fall where they are deformed would lose less than nothing; as much as
velocities lose is allowed to them.

(Relaxed variables for second order: Armero & Romero, CMAME 190 (2001) 6783. The energy of two-step
methods: Dahlquist, BIT 18 (1978) 384.)
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled, inlined
from fem_lie.forms.fixed_arrays import put
from fem_lie.lie.tuples import Vector, cross, dot, load_row, minus, plus, scaled
from fem_lie.solve.conserving.step.mean_forces import solve_symmetric
from fem_lie.system.nodes import inertia
from fem_lie.system.nodes.inertia import Inertia

MEMORY, ELASTIC, REMEMBERS, WORKS, LENGTH = 0, 1, 2, 3, 9
"""Places in the array of lagged numbers: β, the share of elastic forces that is filtered, whether
anything is remembered (0 or 1; without it there is no dissipation), works of the changes of elastic
forces and of the memory, and ``|w|²`` of the latter."""
LEAK, SQUARES, LIMIT, REPAID, ENERGY = 5, 6, 7, 8, 10
"""And of energy that round-off has brought in, squares of the deformations of all elements, forces
that are below round-off, energy taken back, and the largest energy so far; shape (11,)."""
_TURNS = 30


@compiled
def end_velocities(
    mass: Inertia,
    V: Array,
    V1: Array,
    delta: Array,
    w: Array,
    lag: Array,
    χ: float,
    h: float,
    q: Array,
) -> None:
    """Velocities ``V₁`` at the end from the increments, with the present β; (n, 4, 3).

    With ``V̄`` given, ``ΔV = a + χ/(1 + χ) Ω × V̄`` with ``a`` from the increments, and Ω, the
    rotation that is nearest to ``ΔV − β w``, is 1 + χ times that nearest to ``a − β w``. ``V̄``
    follows in a few turns from a first guess in ``V₁``. ``q`` (2, n, 4, 3) is work.
    """
    χ, β, n = χ * lag[REMEMBERS], lag[MEMORY], V.shape[0]
    a = np.empty_like(V)
    for i in range(n):
        for k in range(4):
            for j in range(3):
                change = delta[i, k, j] / h - V[i, k, j] + 0.5 * χ * β * w[i, k, j]
                a[i, k, j] = 2.0 / (1.0 + χ) * change
    if χ == 0.0:
        put(V + a, V1)
        return
    A, before = np.zeros((3, 3)), (0.0, 0.0, 0.0)
    for _ in range(_TURNS):
        Ω = scaled(1.0 + χ, _projection(mass, V, V1, a, w, β, q, A))
        for i in range(n):
            for k in range(4):
                turned = scaled(χ / (1.0 + χ), cross(Ω, _mean(V, V1, i, k)))
                for j in range(3):
                    q[0, i, k, j] = V[i, k, j] + a[i, k, j] + turned[j]
        put(q[0], V1)
        gap = minus(Ω, before)
        if dot(gap, gap) <= 1e-30 * dot(Ω, Ω):
            return
        before = Ω


@compiled
def choose_memory(mass: Inertia, V: Array, V1: Array, w: Array, q: Array, lag: Array) -> None:
    """β for velocities ``V₁`` that were found with the one before; ``q`` (2, n, 4, 3) is work."""
    A = np.zeros((3, 3))
    turn_change = _projection(mass, V, V1, V1, V, 1.0, q, A)
    turn_memory = _projection(mass, V, V1, w, w, 0.0, q, A)
    by_change = max(_loss(mass, V, V1, V1, V, 1.0, turn_change, q), 0.0)
    by_memory = _loss(mass, V, V1, w, w, 0.0, turn_memory, q)
    square, elastic = np.sum(q[0] * q[1]), lag[WORKS]
    share = by_change / -elastic if -elastic > by_change else 1.0
    by_change, by_memory = by_change + share * elastic, by_memory + share * lag[WORKS + 1]
    lag[ELASTIC] = share
    lag[MEMORY] = _remembered(max(by_change, 0.0), by_memory, square + share * lag[LENGTH])


@inlined
def _remembered(change: float, common: float, memory: float) -> float:
    """β from ``|Δ|²``, ``Δ·w`` and ``|w|²``."""
    most = sqrt(change * memory)
    if common <= 0.0:
        return min(1.0, (most - common) / memory) if memory > 0.0 else 1.0
    # metrics change between steps: what Cauchy and Schwarz say is made sure of
    return min(1.0, change / max(most, common))


@inlined
def remember(lag: Array, μ: float) -> None:
    """``|w|²`` of elastic forces after the step."""
    keep = 1.0 - μ
    square = keep * keep * lag[LENGTH] + μ * (2.0 * keep * lag[WORKS + 1] + μ * lag[WORKS])
    lag[LENGTH] = max(square, 0.0)


@compiled
def _projection(
    mass: Inertia, V: Array, V1: Array, a: Array, b: Array, sign: float, q: Array, A: Array
) -> Vector:
    """Rotation that makes ``Ω × V̄`` nearest to ``a − sign b`` in the metric of inertia."""
    indptr, indices, blocks = mass
    n = V.shape[0]
    put(a[:n] - sign * b[:n], q[0])
    inertia.multiply(indptr, indices, blocks, q[0], q[1])
    right = (0.0, 0.0, 0.0)
    for i in range(n):
        for k in range(4):
            right = plus(right, cross(_mean(V, V1, i, k), load_row(q[1, i], k)))
    put(0.5 * (V + V1), q[0])
    inertia.multiply(indptr, indices, blocks, q[0], q[1])
    A[:] = 0.0
    for i in range(n):
        for k in range(4):
            v, p = load_row(q[0, i], k), load_row(q[1, i], k)
            square = dot(v, p)
            for j in range(3):
                A[j, j] += square
                for m in range(3):
                    A[j, m] -= 0.5 * (v[j] * p[m] + p[j] * v[m])
    # motion along one line has no rotation about it
    least = 1e-12 * (A[0, 0] + A[1, 1] + A[2, 2])
    if least == 0.0:
        return (0.0, 0.0, 0.0)
    for j in range(3):
        A[j, j] += least
    first = solve_symmetric(A, right)
    # the shift taken back, but for directions without rotation
    rest = minus(right, _times(A, first))
    rest = plus(rest, scaled(least, first))
    return plus(first, solve_symmetric(A, rest))


@inlined
def _times(A: Array, v: Vector) -> Vector:
    return (
        A[0, 0] * v[0] + A[0, 1] * v[1] + A[0, 2] * v[2],
        A[1, 0] * v[0] + A[1, 1] * v[1] + A[1, 2] * v[2],
        A[2, 0] * v[0] + A[2, 1] * v[1] + A[2, 2] * v[2],
    )


@inlined
def _mean(V: Array, V1: Array, i: int, k: int) -> Vector:
    return scaled(0.5, plus(load_row(V[i], k), load_row(V1[i], k)))


@compiled
def _loss(
    mass: Inertia, V: Array, V1: Array, a: Array, b: Array, sign: float, Ω: Vector, q: Array
) -> float:
    """``ΔV·G (a − sign b − Ω × V̄)``."""
    indptr, indices, blocks = mass
    for i in range(V.shape[0]):
        for k in range(4):
            turned = cross(Ω, _mean(V, V1, i, k))
            for j in range(3):
                q[0, i, k, j] = a[i, k, j] - sign * b[i, k, j] - turned[j]
    inertia.multiply(indptr, indices, blocks, q[0], q[1])
    return float(np.sum((V1 - V) * q[1]))


@compiled
def velocity_loss(mass: Inertia, V: Array, V1: Array, delta: Array, h: float, q: Array) -> float:
    """``ΔV·G g`` with ``g = (q₁ − q)/h − V̄``: what the kinetic energy has lost, exactly."""
    indptr, indices, blocks = mass
    n = V.shape[0]
    put(delta[:n] / h - 0.5 * (V + V1), q[0])
    inertia.multiply(indptr, indices, blocks, q[0], q[1])
    return float(np.sum((V1 - V) * q[1]))
