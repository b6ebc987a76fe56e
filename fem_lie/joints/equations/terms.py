"""Compiled joint constraints, springs and dampers, in the relative motion of two frames.

The frames A and B of a joint are fixed to their nodes. With ``Δ = R_Aᵀ (x_B − x_A)`` and ``Q = R_Aᵀ
R_B``, joints constrain, drive, couple and load terms ``S z + Σ cₖ fₖ(z)``, ``z = (Δ, Q)``, with a
constant selection ``S`` and the functions ``f`` of :mod:`fem_lie.joints.equations.functions`. The
terms are invariant under rigid motion and, without functions, at most quadratic in positions and
directors. A constraint ``Φ = 0`` is the sum of its terms minus a target; a spring with damper is a
force ``k (q − q₀) + c q̇``, or a force law of ``(t, q, q̇)``, or friction, along its term ``q``.

Nodes from ``count`` on do not move by themselves: ground and prescribed frames.
"""

from __future__ import annotations

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined, uncounted
from fem_lie._jit.stack import stack, vector_at
from fem_lie.joints.equations import friction, functions, laws
from fem_lie.joints.equations.joint_arrays import JointArrays, PackedJoints, joint_arrays
from fem_lie.joints.equations.one_pair import (
    WORKSPACE,
    gradient,
    locate,
    rate_of_term,
    term,
    twists,
    workspace,
)
from fem_lie.joints.equations.relative_motion import force, variation


@inlined
def load(
    v: Array,
    arrays: JointArrays,
    j: int,
    z: Array,
    f: Array,
    multipliers: Array,
    p: Array,
    c: Array,
) -> None:
    """Generalised force ``p`` of pair j, conjugate to ``z``, and its factors ``c`` of gradients."""
    m = len(arrays.targets)
    p[:], c[:] = 0.0, 0.0
    for t in range(arrays.first[j], arrays.first[j + 1]):
        row = arrays.rows[t]
        if row < m:
            multiplier = multipliers[row]
        else:
            k, damping, rest = arrays.springs[row - m]
            q, rate = term(arrays, t, z, f), 0.0
            if damping != 0.0:
                rate = rate_of_term(v, arrays, j, t, z)
            if arrays.laws[row - m, 0] != 0:
                multiplier = laws.force(arrays, row - m, q, rate)
            elif friction.of_spring(arrays, row - m):
                multiplier = friction.force(v, arrays, j, t, z, multipliers)
            else:
                multiplier = k * (q - rest) + damping * rate
        for k in range(12):
            p[k] += multiplier * arrays.selection[t, k]
        for k in range(functions.COUNT):
            c[k] += multiplier * arrays.functions[t, k]
    functions.add_gradients(z, arrays.angle[j], c, p)


@uncounted
def evaluate(
    H: Array, v: Array, arrays: JointArrays, multipliers: Array, scale: Array, count: int, r: Array
) -> None:
    """Add constraint forces ``Bᵀλ`` and spring forces to ``r``; set its next rows to ``scale · Φ``.

    Args:
        H: Frames of all nodes, shape (≥ count, 4, 3).
        v: Twists of the moving nodes, for dampers, shape (n, 6).
        arrays: The joints.
        multipliers: Lagrange multipliers λ, forces and moments, shape (≥ m,).
        scale: Scale factor of each constraint, shape (≥ m,).
        count: Number of moving nodes.
        r: Residual, shape (≥ 6 count + m,), updated.
    """
    work = vector_at(stack(WORKSPACE), WORKSPACE)
    A, B, z, p, f, c, sides, moved = workspace(work)
    m = len(arrays.targets)
    for row in range(m):
        r[6 * count + row] = -scale[row] * arrays.targets[row]
    for j in range(arrays.nodes.shape[0]):
        locate(H, arrays, j, A, B, z, f)
        for t in range(arrays.first[j], arrays.first[j + 1]):
            row = arrays.rows[t]
            if row < m:
                r[6 * count + row] += scale[row] * term(arrays, t, z, f)
        load(v, arrays, j, z, f, multipliers, p, c)
        force(z, p, sides[0], sides[1])
        for side in range(2):
            node = arrays.nodes[j, side]
            if node < count:
                lie.apply_adjoint_inverse_transposed(arrays.frames[j, side], sides[side], moved)
                for k in range(6):
                    r[6 * node + k] += moved[k]


@uncounted
def reactions(H: Array, v: Array, arrays: JointArrays, multipliers: Array, out: Array) -> None:
    """Forces and moments on the frames that do not move by themselves, the last rows of ``H``.

    Args:
        H: Frames of all nodes, ground and prescribed motions.
        v: Twists of the moving nodes, for dampers, shape (n, 6).
        arrays: The joints.
        multipliers: Lagrange multipliers, shape (≥ m,).
        out: Force and moment on each of these frames, shape (p + 1, 6), overwritten.
    """
    work = vector_at(stack(WORKSPACE), WORKSPACE)
    A, B, z, p, f, c, sides, moved = workspace(work)
    out[:] = 0.0
    count = H.shape[0] - out.shape[0]
    for j in range(arrays.nodes.shape[0]):
        if max(arrays.nodes[j, 0], arrays.nodes[j, 1]) < count:
            continue
        locate(H, arrays, j, A, B, z, f)
        load(v, arrays, j, z, f, multipliers, p, c)
        force(z, p, sides[0], sides[1])
        for side in range(2):
            row = arrays.nodes[j, side] - count
            if row >= 0:
                lie.apply_adjoint_inverse_transposed(arrays.frames[j, side], sides[side], moved)
                for k in range(6):
                    out[row, k] += moved[k]


@uncounted
def violations(H: Array, arrays: JointArrays, out: Array) -> None:
    """Constraint violations ``Φ``, shape (m,): sums of terms minus targets."""
    work = vector_at(stack(WORKSPACE), WORKSPACE)
    A, B, z, _, f, _, _, _ = workspace(work)
    m = len(arrays.targets)
    for row in range(m):
        out[row] = -arrays.targets[row]
    for j in range(arrays.nodes.shape[0]):
        locate(H, arrays, j, A, B, z, f)
        for t in range(arrays.first[j], arrays.first[j + 1]):
            if arrays.rows[t] < m:
                out[arrays.rows[t]] += term(arrays, t, z, f)


@compiled
def unwrap(H: Array, arrays: JointArrays) -> None:
    """Store the angles of an accepted state; later angles are within half a turn of them."""
    A, B, z, f = np.empty((4, 3)), np.empty((4, 3)), np.empty(12), np.zeros(3)
    for j in range(arrays.nodes.shape[0]):
        if arrays.functions[arrays.first[j] : arrays.first[j + 1], functions.ANGLE].any():
            locate(H, arrays, j, A, B, z, f)
            arrays.turned[j] = f[functions.ANGLE]


@compiled
def spring_energy(H: Array, arrays: JointArrays) -> float:
    """Energy ``½ k (q − q₀)²``, or the potential of the force law, of all springs."""
    A, B, z, f = np.empty((4, 3)), np.empty((4, 3)), np.empty(12), np.zeros(3)
    m, energy = len(arrays.targets), 0.0
    for j in range(arrays.nodes.shape[0]):
        for t in range(arrays.first[j], arrays.first[j + 1]):
            if arrays.rows[t] >= m:
                locate(H, arrays, j, A, B, z, f)
                spring, q = arrays.rows[t] - m, term(arrays, t, z, f)
                k, _, rest = arrays.springs[spring]
                if arrays.laws[spring, 0] != 0:
                    energy += laws.potential(arrays, spring, q)
                else:
                    energy += 0.5 * k * (q - rest) ** 2
    return energy


@compiled
def damper_loss(H: Array, v: Array, arrays: JointArrays, multipliers: Array) -> float:
    """Power ``c q̇²`` dissipated by all dampers at nodal twists ``v``.

    Force laws without a potential and friction contribute ``F q̇``.
    """
    A, B, z, f = np.empty((4, 3)), np.empty((4, 3)), np.empty(12), np.zeros(3)
    m, loss = len(arrays.targets), 0.0
    for j in range(arrays.nodes.shape[0]):
        for t in range(arrays.first[j], arrays.first[j + 1]):
            if arrays.rows[t] >= m and arrays.springs[arrays.rows[t] - m, 1] != 0.0:
                locate(H, arrays, j, A, B, z, f)
                spring, rate = arrays.rows[t] - m, rate_of_term(v, arrays, j, t, z)
                if arrays.laws[spring, 0] != 0:
                    loss += laws.force(arrays, spring, term(arrays, t, z, f), rate) * rate
                elif friction.of_spring(arrays, spring):
                    loss += friction.force(v, arrays, j, t, z, multipliers) * rate
                else:
                    loss += arrays.springs[spring, 1] * rate**2
    return loss


@uncounted
def wrenches(
    H: Array,
    v: Array,
    arrays: JointArrays,
    multipliers: Array,
    pairs: Indices,
    side: Indices,
    rows: Indices,
    out: Array,
) -> None:
    """Force and moment of chosen pairs on frame A or B (``side`` 0 or 1), in that frame.

    ``rows`` has the row of ``out`` (r, 6) to which each of ``pairs`` adds.
    """
    # a slice here counts references: it corrupted the forces of friction
    for i in range(out.shape[0]):
        for k in range(6):
            out[i, k] = 0.0
    work = vector_at(stack(WORKSPACE), WORKSPACE)
    A, B, z, p, f, c, sides, _ = workspace(work)
    for i in range(pairs.shape[0]):
        j = pairs[i]
        locate(H, arrays, j, A, B, z, f)
        load(v, arrays, j, z, f, multipliers, p, c)
        force(z, p, sides[0], sides[1])
        for k in range(6):
            out[rows[i], k] -= sides[side[i], k]


@compiled
def unwrap_both(H: Array, joints: PackedJoints, probes: PackedJoints) -> None:
    """:func:`unwrap` for two sets of joints."""
    unwrap(H, joint_arrays(joints))
    unwrap(H, joint_arrays(probes))


@compiled
def jacobian(H: Array, arrays: JointArrays, rows: Array) -> None:
    """Add ``∂Φ/∂h`` to the constraint Jacobian, ``rows``, one row of six per incidence."""
    A, B, z, f = np.empty((4, 3)), np.empty((4, 3)), np.empty(12), np.zeros(3)
    p, sides, moved = np.empty(12), np.empty((2, 6)), np.empty(6)
    for j in range(arrays.nodes.shape[0]):
        locate(H, arrays, j, A, B, z, f)
        for t in range(arrays.first[j], arrays.first[j + 1]):
            gradient(arrays, j, t, z, p)
            force(z, p, sides[0], sides[1])
            for side in range(2):
                incidence = arrays.incidences[t, side]
                if incidence >= 0:
                    lie.apply_adjoint_inverse_transposed(arrays.frames[j, side], sides[side], moved)
                    for k in range(6):
                        rows[incidence, k] += moved[k]


@compiled
def geometric(H: Array, arrays: JointArrays, multipliers: Array, index: Indices, K: Array) -> None:
    """Add the geometric stiffness ``∂(Bᵀλ)/∂h`` to blocks ``K`` at ``index`` (j, 2, 2), −1: none.

    Springs contribute with their current force, without their stiffness.
    """
    A, B, z, p = np.empty((4, 3)), np.empty((4, 3)), np.empty(12), np.empty(12)
    f, c, rest = np.zeros(3), np.empty(functions.COUNT), np.zeros((0, 6))
    twist, unit = np.zeros((2, 6)), np.empty(6)
    dz, dp, sides, bent = np.empty(12), np.empty(12), np.empty((2, 6)), np.empty((2, 6))
    moved = np.empty(6)
    for j in range(arrays.nodes.shape[0]):
        locate(H, arrays, j, A, B, z, f)
        load(rest, arrays, j, z, f, multipliers, p, c)
        for column in range(12):
            source = column // 6
            if index[j, 0, source] < 0 and index[j, 1, source] < 0:
                continue
            unit[:], twist[:], dp[:] = 0.0, 0.0, 0.0
            unit[column % 6] = 1.0
            lie.apply_adjoint_inverse(arrays.frames[j, source], unit, twist[source])
            variation(z, twist[0], twist[1], dz)
            force(dz, p, sides[0], sides[1])
            sides[0, :3] = 0.0  # −n: the only part that does not depend on z
            functions.add_gradient_changes(z, dz, arrays.angle[j], c, dp)
            force(z, dp, bent[0], bent[1])
            sides += bent
            for side in range(2):
                if index[j, side, source] >= 0:
                    lie.apply_adjoint_inverse_transposed(arrays.frames[j, side], sides[side], moved)
                    block = K[index[j, side, source]]
                    for k in range(6):
                        block[k, column % 6] += moved[k]


@compiled
def add_springs(
    H: Array,
    v: Array,
    arrays: JointArrays,
    index: Indices,
    stiff: float,
    damp: float,
    K: Array,
) -> None:
    """Add ``(stiff k + damp c) bᵀb`` of springs and dampers, ``b = ∂q/∂h``, to blocks ``K``.

    ``k`` and ``c`` of a force law are its derivatives at the rates that follow from twists ``v``.
    Friction has :func:`~fem_lie.joints.equations.friction.add_tangent`.
    """
    A, B, z, p = np.empty((4, 3)), np.empty((4, 3)), np.empty(12), np.empty(12)
    f, sides, b = np.zeros(3), np.empty((2, 6)), np.empty((2, 6))
    m = len(arrays.targets)
    for j in range(arrays.nodes.shape[0]):
        for t in range(arrays.first[j], arrays.first[j + 1]):
            if arrays.rows[t] < m:
                continue
            spring = arrays.rows[t] - m
            if friction.of_spring(arrays, spring):
                continue
            k, c, _ = arrays.springs[spring]
            locate(H, arrays, j, A, B, z, f)
            if arrays.laws[spring, 0] != 0:
                rate = rate_of_term(v, arrays, j, t, z)
                by = laws.derivatives(arrays, spring, term(arrays, t, z, f), rate)
                k, c = k * by[0], c * by[1]
            gradient(arrays, j, t, z, p)
            force(z, p, sides[0], sides[1])
            for side in range(2):
                lie.apply_adjoint_inverse_transposed(arrays.frames[j, side], sides[side], b[side])
            for side in range(2):
                for source in range(2):
                    if index[j, side, source] >= 0:
                        product = np.outer(b[side], b[source])
                        K[index[j, side, source]] += (stiff * k + damp * c) * product


@compiled
def rates(H: Array, v: Array, arrays: JointArrays, first: Array, second: Array) -> None:
    """``dΦ/dt`` and ``d²Φ/dt²`` (≥ m,) at constant twists ``v`` (n, 6) and constant targets."""
    A, B, z, f = np.empty((4, 3)), np.empty((4, 3)), np.empty(12), np.zeros(3)
    twist, dz, ddz, p, dp = np.empty((2, 6)), np.empty(12), np.empty(12), np.empty(12), np.empty(12)
    m = len(arrays.targets)
    first[:m], second[:m] = 0.0, 0.0
    for j in range(arrays.nodes.shape[0]):
        locate(H, arrays, j, A, B, z, f)
        twists(v, arrays, j, twist)
        variation(z, twist[0], twist[1], dz)
        variation(dz, twist[0], twist[1], ddz)
        for k in range(3):
            ddz[k] += twist[0, k]  # −u_A is the only part that does not depend on z
        for t in range(arrays.first[j], arrays.first[j + 1]):
            row = arrays.rows[t]
            if row >= m:
                continue
            gradient(arrays, j, t, z, p)
            dp[:] = 0.0
            functions.add_gradient_changes(z, dz, arrays.angle[j], arrays.functions[t], dp)
            first[row] += p @ dz
            second[row] += p @ ddz + dp @ dz
