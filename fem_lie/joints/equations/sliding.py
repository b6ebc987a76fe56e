"""Compiled constraints of points that slide along flexible beams, across element boundaries.

Between the nodal frames of an element the interpolation is the geodesic ``A(ξ) = H_a exp(ξ d)``,
``d = log(H_a⁻¹ H_b)``: frame and position are continuous along the beam. The coordinate ξ of the
sliding frame B follows from ``Δ₁(ξ) = 0``, that is, B lies in the cross-section. It is a function
of the frames, as is the element, so there is no additional unknown. Constraints are terms ``S z + c
s`` of the relative motion ``z = (Δ, Q)`` of A(ξ) and B and of the arc length ``s``. With ``g =
dΔ₁/dξ``::

    δξ = −δΔ₁/g,    δA = N_a h_a + N_b h_b + d δξ
    N_a = Ad(exp(−ξ d)) − ξ T(ξ d) T⁻¹(−d),    N_b = ξ T(ξ d) T⁻¹(d)

so the force along e₁ follows from the others: the force on the beam is perpendicular to its axis.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie.joints.equations.relative_motion import force, relative_motion, variation

_ITERATIONS = 60
_STEP = 1e-6  # of differences, rad or element lengths; an error of 1e-9 does not matter in a matrix


class SlidingArrays(NamedTuple):
    """Packed arrays of all sliding frames, ``j`` with ``k`` constraints, and of the beam elements.

    Attributes:
        nodes: Node of each sliding frame, shape (j,).
        frames: Sliding frame in the frame of its node, shape (j, 4, 3).
        elements: First beam element of each sliding frame, and the total at the end, shape (j +
            1,).
        ends: Nodes of each element, shape (e, 2).
        offsets: End frames of the element in the frames of these nodes, shape (e, 2, 4, 3).
        starts: Arc length at the start of each element, shape (e,).
        lengths: Lengths of the elements, shape (e,).
        first: First constraint of each sliding frame, and ``k`` at the end, shape (j + 1,).
        selection: ``S``, shape (k, 12).
        advance: ``c``, shape (k,).
        targets: Prescribed values of the constraints, shape (k,).
        incidences: First incidence of each constraint, shape (k,).
        slider_incidence: Incidence with the node of the sliding frame, counted from the first, −1:
            it does not move, shape (j,).
        element_incidences: Incidences with the ends of the elements, counted likewise, shape (e,
            2).
        arclength: Arc length at the last accepted state, shape (j,).
        start: Number of the first of these constraints among all, shape (1,).
    """

    nodes: Indices
    frames: Array
    elements: Indices
    ends: Indices
    offsets: Array
    starts: Array
    lengths: Array
    first: Indices
    selection: Array
    advance: Array
    targets: Array
    incidences: Indices
    slider_incidence: Indices
    element_incidences: Indices
    arclength: Array
    start: Indices


@compiled
def _frame(H: Array, arrays: SlidingArrays, e: int, ξ: float, d: Array, X: Array, A: Array) -> None:
    """``d``, ``X = exp(ξ d)`` and ``A(ξ)`` of an element."""
    a, b = np.empty((4, 3)), np.empty((4, 3))
    lie.compose(H[arrays.ends[e, 0]], arrays.offsets[e, 0], a)
    lie.compose(H[arrays.ends[e, 1]], arrays.offsets[e, 1], b)
    lie.relative(a, b, d)
    lie.exp_se3(ξ * d, X)
    lie.compose(a, X, A)


@compiled
def _element_at(arrays: SlidingArrays, j: int, s: float) -> int:
    e = arrays.elements[j]
    while e < arrays.elements[j + 1] - 1 and s > arrays.starts[e] + arrays.lengths[e]:
        e += 1
    return e


@compiled
def _locate(
    H: Array, arrays: SlidingArrays, j: int, stay: int, d: Array, X: Array, z: Array
) -> tuple[int, float]:
    """Element and ξ of sliding frame j, ``d`` and ``X`` there, and the relative motion ``z``.

    The search starts at the last accepted arc length; with ``stay ≥ 0`` it stays on that element.
    """
    A, B = np.empty((4, 3)), np.empty((4, 3))
    lie.compose(H[arrays.nodes[j]], arrays.frames[j], B)
    s = arrays.arclength[j]
    e = stay if stay >= 0 else _element_at(arrays, j, s)
    ξ = (s - arrays.starts[e]) / arrays.lengths[e]
    for _ in range(_ITERATIONS):
        _frame(H, arrays, e, ξ, d, X, A)
        relative_motion(A, B, z)
        step = -z[0] / (-d[0] + z[1] * d[5] - z[2] * d[4])
        ξ += step
        if stay < 0 and ξ > 1.0 and e < arrays.elements[j + 1] - 1:
            e, ξ = e + 1, 0.0
        elif stay < 0 and ξ < 0.0 and e > arrays.elements[j]:
            e, ξ = e - 1, 1.0
        elif abs(step) < 1e-14 * (1.0 + abs(ξ)):
            break
    _frame(H, arrays, e, ξ, d, X, A)
    relative_motion(A, B, z)
    return e, ξ


@compiled
def _gradient(arrays: SlidingArrays, e: int, c: int, d: Array, z: Array, p: Array) -> None:
    """``p``: derivative of constraint c in ``z`` at fixed ξ, plus the contribution of ``δξ``."""
    along, still, rate = np.zeros(12), np.zeros(6), 0.0
    variation(z, d, still, along)
    for k in range(12):
        rate += arrays.selection[c, k] * along[k]
        p[k] = arrays.selection[c, k]
    p[0] -= (rate + arrays.advance[c] * arrays.lengths[e]) / along[0]


@compiled
def _nodal(
    arrays: SlidingArrays,
    j: int,
    e: int,
    point: tuple[float, Array, Array],
    z: Array,
    p: Array,
    f: Array,
) -> None:
    """Nodal forces (3, 6), on the sliding frame and both ends, that do the work ``p · δz``.

    ``point`` is ξ, ``d`` and ``X``.
    """
    ξ, d, X = point
    sides, whole, part = np.empty((2, 6)), np.empty(6), np.empty(6)
    force(z, p, sides[0], sides[1])
    lie.apply_adjoint_inverse_transposed(arrays.frames[j], sides[1], f[0])
    lie.apply_tangent_transposed(ξ * d, sides[0], whole)
    lie.apply_tangent_inverse_transposed_minus(d, whole, part)
    lie.apply_adjoint_inverse_transposed(X, sides[0], f[1])
    for k in range(6):
        f[1, k] -= ξ * part[k]
    lie.apply_tangent_inverse_transposed(d, whole, part)
    for k in range(6):
        f[2, k] = ξ * part[k]
    for end in range(2):
        lie.apply_adjoint_inverse_transposed(arrays.offsets[e, end], f[1 + end], f[1 + end])


@compiled
def _forces(
    H: Array, arrays: SlidingArrays, j: int, stay: int, multipliers: Array, f: Array
) -> tuple[int, float]:
    """Nodal forces (3, 6) of sliding frame j for the multipliers; returns the element and ξ."""
    d, X, z, p, q = np.empty(6), np.empty((4, 3)), np.empty(12), np.empty(12), np.zeros(12)
    e, ξ = _locate(H, arrays, j, stay, d, X, z)
    for c in range(arrays.first[j], arrays.first[j + 1]):
        _gradient(arrays, e, c, d, z, p)
        q += multipliers[arrays.start[0] + c] * p
    _nodal(arrays, j, e, (ξ, d, X), z, q, f)
    return e, ξ


@compiled
def evaluate(
    H: Array, arrays: SlidingArrays, multipliers: Array, scale: Array, count: int, r: Array
) -> None:
    """Add forces and set violations as :func:`fem_lie.joints.equations.terms.evaluate` does."""
    d, X, z, f = np.empty(6), np.empty((4, 3)), np.empty(12), np.empty((3, 6))
    for j in range(arrays.nodes.shape[0]):
        e, ξ = _forces(H, arrays, j, -1, multipliers, f)
        _locate(H, arrays, j, -1, d, X, z)
        s = arrays.starts[e] + ξ * arrays.lengths[e]
        for c in range(arrays.first[j], arrays.first[j + 1]):
            row = arrays.start[0] + c
            value = arrays.selection[c] @ z + arrays.advance[c] * s - arrays.targets[c]
            r[6 * count + row] = scale[row] * value
        if arrays.nodes[j] < count:
            r[6 * arrays.nodes[j] : 6 * arrays.nodes[j] + 6] += f[0]
        for end in range(2):
            node = arrays.ends[e, end]
            r[6 * node : 6 * node + 6] += f[1 + end]


@compiled
def jacobian(H: Array, arrays: SlidingArrays, rows: Array) -> None:
    """Add ``∂Φ/∂h`` to the constraint Jacobian, one row of six per incidence."""
    d, X, z, p, f = np.empty(6), np.empty((4, 3)), np.empty(12), np.empty(12), np.empty((3, 6))
    for j in range(arrays.nodes.shape[0]):
        e, ξ = _locate(H, arrays, j, -1, d, X, z)
        for c in range(arrays.first[j], arrays.first[j + 1]):
            _gradient(arrays, e, c, d, z, p)
            _nodal(arrays, j, e, (ξ, d, X), z, p, f)
            if arrays.slider_incidence[j] >= 0:
                rows[arrays.incidences[c] + arrays.slider_incidence[j]] += f[0]
            for end in range(2):
                rows[arrays.incidences[c] + arrays.element_incidences[e, end]] += f[1 + end]


@compiled
def state(H: Array, arrays: SlidingArrays, arclength: Array, values: Array) -> None:
    """Arc lengths (j,) and violations of the constraints, from the first of them on."""
    d, X, z = np.empty(6), np.empty((4, 3)), np.empty(12)
    for j in range(arrays.nodes.shape[0]):
        e, ξ = _locate(H, arrays, j, -1, d, X, z)
        arclength[j] = arrays.starts[e] + ξ * arrays.lengths[e]
        for c in range(arrays.first[j], arrays.first[j + 1]):
            value = arrays.selection[c] @ z + arrays.advance[c] * arclength[j]
            values[arrays.start[0] + c] = value - arrays.targets[c]


@compiled
def geometric(
    H: Array, arrays: SlidingArrays, multipliers: Array, index: Indices, K: Array
) -> None:
    """Add ``∂(Bᵀλ)/∂h``, by differences, to blocks ``K`` at ``index`` (e, 3, 3), −1: none."""
    f, ahead, behind = np.empty((3, 6)), np.empty((3, 6)), np.empty((3, 6))
    nodes, h, kept = np.empty(3, dtype=np.int64), np.zeros(6), np.empty((4, 3))
    for j in range(arrays.nodes.shape[0]):
        e, _ = _forces(H, arrays, j, -1, multipliers, f)
        nodes[0], nodes[1], nodes[2] = arrays.nodes[j], arrays.ends[e, 0], arrays.ends[e, 1]
        for column in range(18):
            source, k = column // 6, column % 6
            if index[e, source, source] < 0:
                continue
            kept[:] = H[nodes[source]]
            h[:] = 0.0
            step = _STEP * arrays.lengths[e] if k < 3 else _STEP
            h[k] = step
            lie.retract(kept, h, H[nodes[source]])
            _forces(H, arrays, j, e, multipliers, ahead)
            lie.retract(kept, -h, H[nodes[source]])
            _forces(H, arrays, j, e, multipliers, behind)
            H[nodes[source]] = kept
            for side in range(3):
                at = index[e, side, source]
                if at >= 0:
                    K[at, :, k] += (ahead[side] - behind[side]) / (2.0 * step)


@compiled
def wrenches(
    H: Array, arrays: SlidingArrays, multipliers: Array, items: Indices, out: Array
) -> None:
    """Add force and moment on the beam at the sliding frames, in the section axes, to ``out``."""
    d, X, z, p, q = np.empty(6), np.empty((4, 3)), np.empty(12), np.empty(12), np.empty(12)
    sides = np.empty((2, 6))
    for j in range(arrays.nodes.shape[0]):
        e, _ = _locate(H, arrays, j, -1, d, X, z)
        q[:] = 0.0
        for c in range(arrays.first[j], arrays.first[j + 1]):
            _gradient(arrays, e, c, d, z, p)
            q += multipliers[arrays.start[0] + c] * p
        force(z, q, sides[0], sides[1])
        out[items[j]] = -sides[0]
