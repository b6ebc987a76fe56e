"""Generalised-α at one node: parameters, prediction, correction and acceptance of a step.

Formulas are in :mod:`fem_lie.solve.alpha.generalised_alpha`. Velocities, accelerations and
increments are those of the node's group, see :mod:`fem_lie.lie.node_types`: translations of a frame
are along its axes on SE(3) and in global components on R³×SO(3).
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

from fem_lie._arrays import Array
from fem_lie._jit import inlined
from fem_lie.lie.node_types import move, reorthonormalise
from fem_lie.solve.convergence import size_of

AHEAD = 0.1
"""Fraction of a step for difference quotients of initial accelerations, if α_f − α_m is too
small."""


class Scheme(NamedTuple):
    """Parameters of a run.

    Attributes:
        h: Step size.
        am: α_m.
        af: α_f.
        gamma: γ.
        beta: β.
        mass: ∂v̇₁/∂d.
        damping: ∂v₁/∂d.
    """

    h: float
    am: float
    af: float
    gamma: float
    beta: float
    mass: float
    damping: float

    @property
    def plain(self) -> PlainScheme:
        """The parameters as a plain tuple, with which compiled functions are called faster."""
        return (*self,)

    @property
    def shift(self) -> float:
        """Time from which ``a`` approximates ``v̇`` to the start of the step."""
        return (self.af - self.am) * self.h

    @property
    def ahead(self) -> float:
        """Time of the difference quotients of initial accelerations."""
        return max(self.shift, AHEAD * self.h)


def parameters(radius: float, step: float) -> Scheme:
    """Parameters of a second-order scheme with spectral radius ``radius`` at infinite frequency."""
    step = float(step)
    am, af = (2 * radius - 1) / (radius + 1), radius / (radius + 1)
    gamma = 0.5 + af - am
    beta = 0.25 * (gamma + 0.5) ** 2
    mass, damping = (1 - am) / (step**2 * beta * (1 - af)), gamma / (step * beta)
    return Scheme(step, am, af, gamma, beta, mass, damping)


PlainScheme: TypeAlias = tuple[float, float, float, float, float, float, float]
"""Plain tuple of a :class:`Scheme`, with which numba functions are called three times as fast."""


@inlined
def predict(
    scheme: Scheme,
    kind: int,
    scaling: Array,
    H: Array,
    v: Array,
    vdot: Array,
    a: Array,
    d: Array,
    H1: Array,
    v1: Array,
    vdot1: Array,
) -> float:
    """Start a step with the old ``v̇``; returns the size of the motion, see :func:`size_of`."""
    h, am, gamma, beta = scheme.h, scheme.am, scheme.gamma, scheme.beta
    for k in range(6):
        vdot1[k] = vdot[k]
        a1 = (vdot[k] - am * a[k]) / (1.0 - am)
        d[k] = h * v[k] + h * h * ((0.5 - beta) * a[k] + beta * a1)
        v1[k] = v[k] + h * ((1.0 - gamma) * a[k] + gamma * a1)
    move(kind, H, d, H1)
    return size_of(d, scaling)


@inlined
def correct(
    scheme: Scheme,
    kind: int,
    scaling: Array,
    x: Array,
    H: Array,
    d: Array,
    H1: Array,
    v1: Array,
    vdot1: Array,
) -> float:
    """Subtract a Newton correction ``x`` of ``d``; returns its size, see :func:`size_of`."""
    for k in range(6):
        d[k] -= x[k]
        v1[k] -= scheme.damping * x[k]
        vdot1[k] -= scheme.mass * x[k]
    move(kind, H, d, H1)
    return size_of(x, scaling)


@inlined
def accept(
    scheme: Scheme,
    kind: int,
    v: Array,
    vdot: Array,
    a: Array,
    H1: Array,
    v1: Array,
    vdot1: Array,
) -> None:
    """Make the end of the step the start of the next, without orthonormalising the directors."""
    am, af = scheme.am, scheme.af
    for k in range(6):
        rate = (1.0 - af) * vdot1[k] + af * vdot[k]
        a[k] = (rate - am * a[k]) / (1.0 - am)
        v[k] = v1[k]
        vdot[k] = vdot1[k]
    reorthonormalise(kind, H1)
