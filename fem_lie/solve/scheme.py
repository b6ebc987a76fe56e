"""Generalised-α at one node: parameters, prediction, correction and acceptance of a step.

Formulas in :mod:`fem_lie.solve.generalised_alpha`. What a node's six-vectors ``v, v̇, a, d`` mean
depends on its group. On SE(3) they are local, and ``H₁ = H exp(d)``. On R³×SO(3) the translation
parts are vectors in space, in components of the frame at the start of the step: ``x₁ = x + R d_u``,
``R₁ = R exp(d_θ)``; when the step is accepted they are turned into the new frame. At the start of
a step ``v = (Rᵀẋ, ω)`` on both, while ``v̇_u = Rᵀẍ − ω×v_u`` on SE(3) and ``Rᵀẍ`` on R³×SO(3).
"""

from __future__ import annotations

from typing import NamedTuple

from fem_lie import lie
from fem_lie._jit import Array, inlined
from fem_lie._lie_tuples import load, load_row, plus, rotate, rotate_back, store, store_row

ROTATION = 0.1
"""A rotation counts in the size of an increment as a displacement of this part of the model."""

ROUND_OFF = 1e-15
"""Increments below are round-off, whatever their ratio."""

DIVERGED = 1e3
"""Increments above, in lengths of the model, are not those of an iteration that converges."""

AHEAD = 0.1
"""Part of a step over which initial accelerations are differentiated, if not over α_f − α_m."""

SE3, R3XSO3 = 0, 1
"""Groups."""


class Scheme(NamedTuple):
    """Parameters of a run; ``mass`` and ``damping`` are ∂v̇₁/∂d and ∂v₁/∂d."""

    h: float
    am: float
    af: float
    gamma: float
    beta: float
    mass: float
    damping: float
    length: float


def parameters(radius: float, step: float, length: float) -> Scheme:
    """Parameters of second order with the spectral radius ``radius`` at infinite frequency."""
    step = float(step)
    am, af = (2 * radius - 1) / (radius + 1), radius / (radius + 1)
    gamma = 0.5 + af - am
    beta = 0.25 * (gamma + 0.5) ** 2
    mass, damping = (1 - am) / (step**2 * beta * (1 - af)), gamma / (step * beta)
    return Scheme(step, am, af, gamma, beta, mass, damping, length)


def failure(
    index: int,
    steps: int,
    step: float,
    limit: int,
    increment: float,
    residual: float,
    tolerance: float,
) -> str:
    """What to say of a step that failed."""
    return (
        f"step {index} of {steps} (time {index * step:g}) did not converge in {limit} iterations: "
        f"last increment {increment:.2e}, residual {residual:.2e}, tolerance {tolerance:g}. Try a "
        "smaller step, a larger tolerance, or policy=EveryIteration()"
    )


# Compiled functions take the parameters as a plain tuple: numba is three times as fast to call so.


@inlined
def move(group: int, H: Array, d: Array, H1: Array) -> None:
    """The end ``H1`` of a step from ``H``."""
    lie.retract(H, d, H1)
    if group == R3XSO3:
        along = rotate(load_row(H, 1), load_row(H, 2), load_row(H, 3), load(d, 0))
        store_row(H1, 0, plus(load_row(H, 0), along))


@inlined
def predict(
    scheme: tuple[float, ...],
    group: int,
    H: Array,
    v: Array,
    vdot: Array,
    a: Array,
    d: Array,
    H1: Array,
    v1: Array,
    vdot1: Array,
) -> float:
    """Start a step with the old ``v̇``; returns the size of the motion, see :data:`ROTATION`."""
    h, am, _, gamma, beta, _, _, length = scheme
    largest = 0.0
    for k in range(6):
        vdot1[k] = vdot[k]
        a1 = (vdot[k] - am * a[k]) / (1.0 - am)
        d[k] = h * v[k] + h * h * ((0.5 - beta) * a[k] + beta * a1)
        v1[k] = v[k] + h * ((1.0 - gamma) * a[k] + gamma * a1)
        size = abs(d[k])
        largest = max(largest, size / length if k < 3 else ROTATION * size)
    move(group, H, d, H1)
    return largest


@inlined
def correct(
    scheme: tuple[float, ...],
    group: int,
    dx: Array,
    H: Array,
    d: Array,
    H1: Array,
    v1: Array,
    vdot1: Array,
) -> float:
    """Apply a Newton correction; returns its size, see :data:`ROTATION`; nan stays."""
    _, _, _, _, _, mass, damping, length = scheme
    largest = 0.0
    for k in range(6):
        x = dx[k]
        d[k] -= x
        v1[k] -= damping * x
        vdot1[k] -= mass * x
        size = abs(x) / length if k < 3 else ROTATION * abs(x)
        if size > largest or size != size:
            largest = size
    move(group, H, d, H1)
    return largest


@inlined
def accept(
    scheme: tuple[float, ...],
    group: int,
    H: Array,
    v: Array,
    vdot: Array,
    a: Array,
    H1: Array,
    v1: Array,
    vdot1: Array,
) -> None:
    """Make the end of the step the start of the next, but for the frame, which is set right."""
    _, am, af, _, _, _, _, _ = scheme
    for k in range(6):
        rate = (1.0 - af) * vdot1[k] + af * vdot[k]
        a[k] = (rate - am * a[k]) / (1.0 - am)
        v[k] = v1[k]
        vdot[k] = vdot1[k]
    lie.reorthonormalise(H1)
    if group == R3XSO3:
        _turn(H, H1, v)
        _turn(H, H1, vdot)
        _turn(H, H1, a)


@inlined
def _turn(H: Array, H1: Array, w: Array) -> None:
    """``w_u ← R₁ᵀ R w_u``."""
    fixed = rotate(load_row(H, 1), load_row(H, 2), load_row(H, 3), load(w, 0))
    store(w, 0, rotate_back(load_row(H1, 1), load_row(H1, 2), load_row(H1, 3), fixed))
