"""Friction in joints, compiled: the multipliers of a joint press its surfaces together.

The constraint forces of a joint are a force ``F`` and a moment ``M`` on its bearing, about the
bearing's centre and along its axes, with the sliding direction or axis ``e₃``. A bearing of length
``L`` takes their transverse parts at its two ends, and the normal force is the sum ::

    N = N₀ + |F⊥/2 + M × e₃/L| + |F⊥/2 − M × e₃/L| + c |F₃| + d |M₃|

of preload, both ends, and what collars or threads (``c``) and keys (``d``) take; in a ball joint
both ends are one sphere, which takes ``|F|``. Friction opposes the slip
``s``, whose components are rates of displacement and radius times rate of rotation, with the
coefficient ::

    μ(s) = (μ + (μ₀ − μ) exp(−(s/s₁)²)) tanh(s/s₀)

of kinetic friction ``μ``, static friction ``μ₀``, Stribeck speed ``s₁`` and stiction speed ``s₀``
(E. Pennestrì, V. Rossi, P. Salvini, P. P. Valentini, Nonlinear Dynamics 83, 2016, 1785-1801, list
such laws).
"""

from __future__ import annotations

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined, uncounted
from fem_lie._jit.stack import stack, vector_at
from fem_lie.joints.equations.joint_arrays import JointArrays
from fem_lie.joints.equations.one_pair import gradient, locate, rate_of_term
from fem_lie.joints.equations.relative_motion import force as forces_on_sides

KINETIC, DROP, BY_STRIBECK, BY_STICTION, PRELOAD, BY_LENGTH, COLLAR, KEY, RADIUS, BALL = range(10)
"""Data of friction: μ, μ₀ − μ, 1/s₁, 1/s₀, N₀, 1/L, c, d, the radius, and 1 for a ball, else 0."""

SIZE = 10
"""Number of data."""

_STILL = 1e-4
"""Slip over the stiction speed below which ``tanh`` is its series."""

_WORK = 24


@uncounted
def ratio(data: Array, s: float) -> tuple[float, float]:
    """``μ(s)/s`` and its derivative in the slip ``s`` ≥ 0, which are finite without slip."""
    x, y = s * data[BY_STICTION], s * data[BY_STRIBECK]
    drop = data[DROP] * np.exp(-y * y)
    μ, slope = data[KINETIC] + drop, -2.0 * y * data[BY_STRIBECK] * drop
    if x < _STILL:
        unit = data[BY_STICTION]
        t, dt = unit * (1.0 - x * x / 3.0), -2.0 / 3.0 * x * unit * unit
    else:
        h = np.tanh(x)
        t = h / s
        dt = (data[BY_STICTION] * (1.0 - h * h) - t) / s
    return μ * t, slope * t + μ * dt


@inlined
def of_spring(arrays: JointArrays, k: int) -> bool:
    """Whether spring ``k`` is friction in a joint."""
    return bool(arrays.laws[k, 3] >= 0)


@inlined
def data_of(arrays: JointArrays, k: int) -> Array:
    """Data of the friction of spring ``k``, shape (10,)."""
    return arrays.data[arrays.laws[k, 1] : arrays.laws[k, 2]]


@inlined
def _ends(data: Array, w: Array) -> tuple[float, float, float, float]:
    """Forces on both ends of a bearing, two components each, of its force and moment (6,)."""
    f, g = (0.5 * w[0], 0.5 * w[1]), (data[BY_LENGTH] * w[4], -data[BY_LENGTH] * w[3])
    return f[0] + g[0], f[1] + g[1], f[0] - g[0], f[1] - g[1]


@uncounted
def set_load(arrays: JointArrays, k: int, z: Array, multipliers: Array, w: Array) -> None:
    """Set the force and moment ``w`` (6,) on the bearing of the friction that spring ``k`` is.

    Args:
        arrays: The joints.
        k: The spring.
        z: Relative motion of the joint's frames, which are those of its friction, shape (12,).
        multipliers: Lagrange multipliers, shape (≥ m,).
        w: Overwritten.
    """
    work = vector_at(stack(_WORK), _WORK)
    work[:] = 0.0
    p, sides, joint = work[:12], work[12:24].reshape(2, 6), arrays.laws[k, 3]
    for t in range(arrays.first[joint], arrays.first[joint + 1]):
        for i in range(12):
            p[i] += multipliers[arrays.rows[t]] * arrays.selection[t, i]
    forces_on_sides(z, p, sides[0], sides[1])
    for i in range(6):
        w[i] = sides[arrays.laws[k, 4], i]


@uncounted
def normal_force(data: Array, w: Array) -> float:
    """Normal force of a bearing under force and moment ``w`` (6,)."""
    a, b, c, d = _ends(data, w)
    e = 0.5 * data[BALL] * w[2]
    along = data[COLLAR] * abs(w[2]) + data[KEY] * abs(w[5])
    one, other = np.sqrt(a * a + b * b + e * e), np.sqrt(c * c + d * d + e * e)
    return float(data[PRELOAD] + one + other + along)


@uncounted
def normal_change(data: Array, w: Array, dw: Array) -> float:
    """Derivative of the normal force along ``dw`` (6,); none where a part of it is zero."""
    a, b, c, d = _ends(data, w)
    da, db, dc, dd = _ends(data, dw)
    change = data[COLLAR] * np.sign(w[2]) * dw[2] + data[KEY] * np.sign(w[5]) * dw[5]
    e, de = 0.5 * data[BALL] * w[2], 0.5 * data[BALL] * dw[2]
    one, other = np.sqrt(a * a + b * b + e * e), np.sqrt(c * c + d * d + e * e)
    if one > 0.0:
        change += (a * da + b * db + e * de) / one
    if other > 0.0:
        change += (c * dc + d * dd + e * de) / other
    return float(change)


@inlined
def arm(arrays: JointArrays, t: int, data: Array) -> float:
    """Slip per unit of term ``t``: the radius for a rotation, 1 for a displacement."""
    return float(data[RADIUS]) if arrays.functions[t].any() else 1.0


@uncounted
def slip(v: Array, arrays: JointArrays, j: int, z: Array, data: Array) -> float:
    """Norm of the slip in pair ``j`` of friction at nodal twists ``v``."""
    square = 0.0
    for t in range(arrays.first[j], arrays.first[j + 1]):
        square += (arm(arrays, t, data) * rate_of_term(v, arrays, j, t, z)) ** 2
    return float(np.sqrt(square))


@uncounted
def force(v: Array, arrays: JointArrays, j: int, t: int, z: Array, multipliers: Array) -> float:
    """Force or moment of friction along term ``t`` of pair ``j``, positive against its increase."""
    k = arrays.rows[t] - len(arrays.targets)
    data, w = data_of(arrays, k), vector_at(stack(6), 6)
    per_slip, _ = ratio(data, slip(v, arrays, j, z, data))
    set_load(arrays, k, z, multipliers, w)
    N = arrays.springs[k, 1] * normal_force(data, w)
    rate = rate_of_term(v, arrays, j, t, z)
    return N * per_slip * arm(arrays, t, data) ** 2 * rate


@compiled
def add_tangent(
    H: Array,
    v: Array,
    arrays: JointArrays,
    multipliers: Array,
    index: Indices,
    factor: float,
    K: Array,
) -> None:
    """Add derivatives of friction in twists, at constant normal force, to blocks ``K``.

    Args:
        H: Frames of all nodes.
        v: Twists of the moving nodes, shape (n, 6).
        arrays: The joints.
        multipliers: Lagrange multipliers, shape (≥ m,).
        index: Block of each pair and its sides, −1: none, shape (j, 2, 2).
        factor: Factor of the derivatives.
        K: Blocks, shape (any, 6, 6).
    """
    A, B, z, f = np.empty((4, 3)), np.empty((4, 3)), np.empty(12), np.zeros(3)
    p, sides, b, along = np.empty(12), np.empty((2, 6)), np.empty((3, 2, 6)), np.empty((2, 6))
    w, m = np.empty(6), len(arrays.targets)
    for j in range(arrays.nodes.shape[0]):
        first, end = arrays.first[j], arrays.first[j + 1]
        k = arrays.rows[first] - m
        if k < 0 or not of_spring(arrays, k):
            continue
        locate(H, arrays, j, A, B, z, f)
        data = data_of(arrays, k)
        s = slip(v, arrays, j, z, data)
        per_slip, change = ratio(data, s)
        set_load(arrays, k, z, multipliers, w)
        N = factor * arrays.springs[k, 1] * normal_force(data, w)
        along[:] = 0.0
        for t in range(first, end):
            gradient(arrays, j, t, z, p)
            forces_on_sides(z, p, sides[0], sides[1])
            for side in range(2):
                own = b[t - first, side]
                lie.apply_adjoint_inverse_transposed(arrays.frames[j, side], sides[side], own)
            if s > 0.0:
                rate = rate_of_term(v, arrays, j, t, z)
                along += arm(arrays, t, data) ** 2 * rate / s * b[t - first]
        for t in range(first, end):
            by_slip = change * rate_of_term(v, arrays, j, t, z)
            of_force = N * arm(arrays, t, data) ** 2 * (per_slip * b[t - first] + by_slip * along)
            for side in range(2):
                for source in range(2):
                    if index[j, side, source] >= 0:
                        product = np.outer(b[t - first, side], of_force[source])
                        K[index[j, side, source]] += product


@compiled
def add_columns(H: Array, v: Array, arrays: JointArrays, multipliers: Array, rows: Array) -> None:
    """Add derivatives of friction in multipliers to the columns of these, as ``Bᵀ``.

    Args:
        H: Frames of all nodes.
        v: Twists of the moving nodes, shape (n, 6).
        arrays: The joints.
        multipliers: Lagrange multipliers, shape (≥ m,).
        rows: One row of six per incidence, updated.
    """
    A, B, z, f = np.empty((4, 3)), np.empty((4, 3)), np.empty(12), np.zeros(3)
    p, sides, moved, w = np.empty(12), np.empty((2, 6)), np.empty(6), np.empty(6)
    m = len(arrays.targets)
    for j in range(arrays.nodes.shape[0]):
        k = arrays.rows[arrays.first[j]] - m
        if k < 0 or not of_spring(arrays, k):
            continue
        locate(H, arrays, j, A, B, z, f)
        data, joint, bearing = data_of(arrays, k), arrays.laws[k, 3], arrays.laws[k, 4]
        per_slip, _ = ratio(data, slip(v, arrays, j, z, data))
        set_load(arrays, k, z, multipliers, w)
        for t in range(arrays.first[j], arrays.first[j + 1]):
            rate = rate_of_term(v, arrays, j, t, z)
            per_normal = arrays.springs[k, 1] * per_slip * arm(arrays, t, data) ** 2 * rate
            for c in range(arrays.first[joint], arrays.first[joint + 1]):
                p[:] = arrays.selection[c]
                forces_on_sides(z, p, sides[0], sides[1])
                change = per_normal * normal_change(data, w, sides[bearing])
                gradient(arrays, j, t, z, p)
                forces_on_sides(z, p, sides[0], sides[1])
                for side in range(2):
                    if arrays.incidences[c, side] >= 0:
                        lie.apply_adjoint_inverse_transposed(
                            arrays.frames[j, side], sides[side], moved
                        )
                        rows[arrays.incidences[c, side]] += change * moved
