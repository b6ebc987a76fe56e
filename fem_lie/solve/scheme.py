"""Generalised-α at one node: parameters, prediction, correction and acceptance of a step.

Formulas in :mod:`fem_lie.solve.generalised_alpha`. Velocities, accelerations and increments are
those of the node's group, see :mod:`fem_lie.groups`: translations are in the node's frame on SE(3)
and in global components on R³×SO(3).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie import lie
from fem_lie._jit import Array, inlined
from fem_lie.groups import move

ROTATION = 0.1
"""A rotation counts in the size of an increment as a displacement of this part of the model."""

ROUND_OFF = 1e-15
"""Increments below are round-off, whatever their ratio."""

DIVERGED = 1e3
"""Increments above, in lengths of the model, are not those of an iteration that converges."""

AHEAD = 0.1
"""Part of a step over which initial accelerations are differentiated, if not over α_f − α_m."""

UNMEASURED = 0.8
"""Power of the ratio of increments from a step that has none: trust it less and less."""


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

    @property
    def shift(self) -> float:
        """Time from that for which ``a`` stands for ``v̇`` to the step's start."""
        return (self.af - self.am) * self.h

    @property
    def ahead(self) -> float:
        """Time over which initial accelerations are differentiated."""
        return max(self.shift, AHEAD * self.h)


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
    rescued: bool,
) -> str:
    """What to say of a step that failed; ``rescued``: in spite of full iteration."""
    looser = "a larger tolerance" if tolerance > 0.0 else "a tolerance such as 1e-10 for round-off"
    remedies = ["Try a smaller step", looser]
    if not rescued:
        remedies.append("a policy that may make new matrices (Automatic())")
    return (
        f"step {index} of {steps} (time {index * step:g}) did not converge in {limit} iterations: "
        f"last increment {increment:.2e}, residual {residual:.2e}, tolerance {tolerance:g}. "
        f"{', or '.join(remedies)}"
    )


# Compiled functions take the parameters as a plain tuple: numba is three times as fast to call so.


@inlined
def size_of(d: Array, length: float) -> float:
    """Of a translation or of a rotation, whichever is larger, however the axes lie; nan stays."""
    moved = np.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) / length
    turned = ROTATION * np.sqrt(d[3] * d[3] + d[4] * d[4] + d[5] * d[5])
    return turned if turned > moved or turned != turned else moved


@inlined
def predict(
    scheme: tuple[float, ...],
    kind: int,
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
    for k in range(6):
        vdot1[k] = vdot[k]
        a1 = (vdot[k] - am * a[k]) / (1.0 - am)
        d[k] = h * v[k] + h * h * ((0.5 - beta) * a[k] + beta * a1)
        v1[k] = v[k] + h * ((1.0 - gamma) * a[k] + gamma * a1)
    move(kind, H, d, H1)
    return size_of(d, length)


@inlined
def correct(
    scheme: tuple[float, ...],
    kind: int,
    x: Array,
    H: Array,
    d: Array,
    H1: Array,
    v1: Array,
    vdot1: Array,
) -> float:
    """Subtract a Newton correction ``x`` of ``d``; returns its size, see :data:`ROTATION`."""
    _, _, _, _, _, mass, damping, length = scheme
    for k in range(6):
        d[k] -= x[k]
        v1[k] -= damping * x[k]
        vdot1[k] -= mass * x[k]
    move(kind, H, d, H1)
    return size_of(x, length)


@inlined
def accept(
    scheme: tuple[float, ...], v: Array, vdot: Array, a: Array, H1: Array, v1: Array, vdot1: Array
) -> None:
    """Make the end of the step the start of the next, but for the frame, which is set right."""
    _, am, af, _, _, _, _, _ = scheme
    for k in range(6):
        rate = (1.0 - af) * vdot1[k] + af * vdot[k]
        a[k] = (rate - am * a[k]) / (1.0 - am)
        v[k] = v1[k]
        vdot[k] = vdot1[k]
    lie.reorthonormalise(H1)


@inlined
def estimate(increment: float, previous: float, ratio: float) -> tuple[float, float]:
    """Ratio of successive increments, and the sum of all that would follow.

    ``previous`` is inf in the first iteration, and ``ratio`` that of the iterations before.
    """
    if previous < np.inf:
        # one lucky ratio must not end the next steps too early: forget slowly
        ratio = max(increment / previous, 0.7 * ratio)
    # of a linearly converging iteration
    remaining = increment * ratio / (1.0 - ratio) if ratio < 1.0 else np.inf
    return ratio, remaining
