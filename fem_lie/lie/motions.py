r"""Groups on which a frame moves in time integration, and their maps: compiled, for one frame.

Both groups move the same frames ``H = (R, x)``; they differ in the effect of an increment
``d = (u, θ)`` and in the vector that represents the velocity of the origin:

===============  ===================================  ========================================
                 SE(3)                                R³×SO(3)
===============  ===================================  ========================================
new frame        ``(R E, x + R Tᵀ(θ) u)``             ``(R E, x + u)``, ``E = exp θ̂``
velocity         ``(Rᵀẋ, ω)``                         ``(ẋ, ω)``
acceleration     its rate ``(u̇, ω̇)``                  ``(ẍ, ω̇)``, ``ẍ = R (u̇ + ω × u)``
inertia          constant; velocity terms in ``u``    constant; ``ẍ`` independent of rotation
joints           constant in a body's frame           rotate within a step
===============  ===================================  ========================================

Forces, tangents and the unknowns of Newton's method, twists of the moved frame, stay in the node's
own frame for both: the iteration matrix can be frozen for both. In that frame the correction of an
increment on R³×SO(3) is ``x = (R₁ᵀ δu, δθ)``, so that the twist is ``blockdiag(I, T) x``.

The type number of a frame is ``group + 2 · parametrisation``; other node types are in
:mod:`fem_lie.lie.node_types`. (Brüls, Cardona & Arnold, Mech. Mach. Theory 48 (2012) 121,
compare the two groups.)
"""

from __future__ import annotations

from enum import IntEnum

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled, inlined
from fem_lie.lie import se3, so3
from fem_lie.lie.series import cayley, exponential
from fem_lie.lie.tuples import (
    Vector,
    cross,
    load,
    load_row,
    minus,
    plus,
    rotate,
    rotate_back,
    store,
    store_row,
)


class Group(IntEnum):
    """Group on which a body moves in time integration.

    ``SE3`` moves a body along a screw motion in each step: exact for steady rotation about any
    axis, and joint constraints depend on relative motion only. ``R3xSO3`` moves the origin along a
    parabola and rotates about it: exact for the flight of a centre of mass, and more accurate for a
    fast spin about a moving axis. Unknowns are in the bodies' own frames for both.
    """

    SE3 = 0
    R3xSO3 = 1


class Parametrisation(IntEnum):
    """Map from increments to rotations: the exponential, or the rational Cayley map."""

    EXPONENTIAL = 0
    CAYLEY = 1


@inlined
def move(kind: int, H: Array, d: Array, out: Array) -> None:
    """The frame ``H`` after an increment ``d``: translation local on SE(3), global on R³×SO(3)."""
    u, θ = load(d, 0), load(d, 3)
    p, r1, r2, r3 = cayley(u, θ) if kind >= 2 else exponential(u, θ)
    x, d1, d2, d3 = load_row(H, 0), load_row(H, 1), load_row(H, 2), load_row(H, 3)
    store_row(out, 0, plus(x, u if kind & 1 else rotate(d1, d2, d3, p)))
    store_row(out, 1, rotate(d1, d2, d3, r1))
    store_row(out, 2, rotate(d1, d2, d3, r2))
    store_row(out, 3, rotate(d1, d2, d3, r3))


@compiled
def tangent(kind: int, d: Array, out: Array) -> None:
    """``T`` (6, 6): a correction ``x`` of ``d`` moves the frame by the twist ``T x``."""
    if kind & 1:
        out[:] = 0.0
        for k in range(3):
            out[k, k] = 1.0
        if kind & 2:
            so3.cayley_tangent_so3(d[3:], out[3:, 3:])
        else:
            so3.tangent_so3(d[3:], out[3:, 3:])
    elif kind & 2:
        se3.cayley_tangent_se3(d, out)
    else:
        se3.tangent(d, out)


@compiled
def tangent_inverse(kind: int, d: Array, out: Array) -> None:
    """``T⁻¹`` (6, 6): a twist ``h`` of the frame is that of the correction ``T⁻¹ h`` of ``d``."""
    if kind & 1:
        out[:] = 0.0
        for k in range(3):
            out[k, k] = 1.0
        if kind & 2:
            so3.cayley_tangent_inverse_so3(d[3:], out[3:, 3:])
        else:
            so3.tangent_inverse_so3(d[3:], out[3:, 3:])
    elif kind & 2:
        se3.cayley_tangent_inverse_se3(d, out)
    else:
        se3.tangent_inverse(d, out)


@inlined
def to_local(kind: int, H: Array, v: Array, vdot: Array, twist: Array, rate: Array) -> None:
    """Twist and its rate in the frame ``H`` from velocity and acceleration of the group."""
    for k in range(6):
        twist[k], rate[k] = v[k], vdot[k]
    if kind & 1:
        u = local_components(H, load(v, 0))
        store(twist, 0, u)
        store(rate, 0, minus(local_components(H, load(vdot, 0)), cross(load(v, 3), u)))


@inlined
def from_local(kind: int, H: Array, twist: Array, rate: Array, v: Array, vdot: Array) -> None:
    """Inverse of :func:`to_local`."""
    for k in range(6):
        v[k], vdot[k] = twist[k], rate[k]
    if kind & 1:
        u = load(twist, 0)
        store(v, 0, global_components(H, u))
        turning = plus(load(rate, 0), cross(load(twist, 3), u))
        store(vdot, 0, global_components(H, turning))


@inlined
def global_components(H: Array, a: Vector) -> Vector:
    """Global components ``R a`` of a vector with components ``a`` in the frame."""
    return rotate(load_row(H, 1), load_row(H, 2), load_row(H, 3), a)


@inlined
def local_components(H: Array, a: Vector) -> Vector:
    """Components ``Rᵀ a`` in the frame of a vector with global components ``a``."""
    return rotate_back(load_row(H, 1), load_row(H, 2), load_row(H, 3), a)


@compiled
def retract(H: Array, h: Array) -> None:
    """Move frames by ``x ← x + R u``, ``R ← R exp(η₁, η₂, 0) exp(0, 0, η₃)``, in place.

    Args:
        H: Frames, shape (n, 4, 3).
        h: Increments, shape (n, 5) or (n, 6); without η₃ there is no drilling rotation.
    """
    tilt, drill = np.zeros(6), np.zeros(6)
    for i in range(H.shape[0]):
        for j in range(3):
            H[i, 0, j] += H[i, 1, j] * h[i, 0] + H[i, 2, j] * h[i, 1] + H[i, 3, j] * h[i, 2]
        tilt[3], tilt[4] = h[i, 3], h[i, 4]
        se3.retract(H[i], tilt, H[i])
        if h.shape[1] == 6:
            drill[5] = h[i, 5]
            se3.retract(H[i], drill, H[i])
        se3.reorthonormalise(H[i])


@compiled
def add_turning(r: Array, factor: float, block: Array) -> None:
    """Add ``factor`` times the second derivative along :func:`retract` less ``∂r/∂h`` to ``block``.

    With ``r = (n, m)`` of a node it is ``−n̂`` in (translation, rotation); in the rotations the
    skew part ``−½ m̂``, and ``½ (m₁η₂ − m₂η₁) η₃``, because the drilling rotation is applied last.

    Args:
        r: Force and moment in the node's frame, shape (6,).
        factor: 1 to add the terms, −1 to subtract them.
        block: Diagonal block of the node in the matrix, shape (6, 6).
    """
    n0, n1, n2 = factor * r[0], factor * r[1], factor * r[2]
    m0, m1, m2 = factor * r[3], factor * r[4], factor * r[5]
    block[0, 4] += n2
    block[0, 5] -= n1
    block[1, 3] -= n2
    block[1, 5] += n0
    block[2, 3] += n1
    block[2, 4] -= n0
    block[3, 4] += 0.5 * m2
    block[4, 3] -= 0.5 * m2
    block[3, 5] -= m1
    block[4, 5] += m0


@compiled
def add_turnings(r: Array, factor: float, diagonal: Indices, chosen: Flags, blocks: Array) -> None:
    """:func:`add_turning` at the chosen nodes (n,) with forces (n, 6)."""
    for i in range(chosen.shape[0]):
        if chosen[i]:
            add_turning(r[i], factor, blocks[diagonal[i]])
