"""Motion of nodes within a step, and the joints between them; compiled.

``z = (Δ, Q)``, the relative motion of the joint's frames, is bilinear in positions and directors
``q`` of its nodes, so ``z₁ − z₀ = z'(q̄)(q₁ − q₀)`` with the mean ``q̄``, exactly. Forces
``z'(q̄)ᵀ p`` therefore do the work ``p·(z₁ − z₀)``, which is zero for ``p = Sᵀλ`` and ``S z = 0``
at both ends. They have no resultant or moment except those on the ground, because rigid motions do
not change ``z``. The constraints are integrated by their increments, with all digits. (Gonzalez, J.
Nonlinear Sci. 6 (1996) 449, section 4; Betsch & Steinmann, Multibody Syst. Dyn. 8 (2002) 367.)

For functions of ``z`` the gradient is replaced by a secant ``g`` in its direction at the mean,
``g·Δz = f(z₁) − f(z)``; springs take the mean of their force at both ends.
"""

from __future__ import annotations

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined, linked, uncounted
from fem_lie._jit.stack import blocks_at, stack, vector_at
from fem_lie.forms.fixed_arrays import put
from fem_lie.joints.equations import functions, laws
from fem_lie.joints.equations.joint_arrays import PackedJoints, joint_arrays
from fem_lie.joints.equations.one_pair import term
from fem_lie.joints.equations.relative_motion import relative_motion
from fem_lie.joints.equations.terms import jacobian
from fem_lie.lie.node_types.node_type import POSITION_GRADIENT, axes
from fem_lie.lie.tuples import (
    Vector,
    add_wrench,
    combined,
    cross,
    dot,
    load,
    load_row,
    minus,
    plus,
    rotate,
    rotate_back,
    scaled,
    store,
)
from fem_lie.solve.conserving.midpoint.any_node import rates_of
from fem_lie.solve.conserving.step.dissipation import set_turnings
from fem_lie.solve.conserving.step.packing import model_of, state_of, step_of
from fem_lie.solve.conserving.step.products import begin_products
from fem_lie.solve.conserving.step.ranks import ranks_of
from fem_lie.solve.conserving.step.records import Incidences, products_of, solution_of, span_of


@inlined
def _joint_frame(A: Array, C: Array, out: Array) -> None:
    """Position and directors of a joint's frame from those of its node."""
    for k in range(4):
        for j in range(3):
            value = C[k, 0] * A[1, j] + C[k, 1] * A[2, j] + C[k, 2] * A[3, j]
            out[k, j] = value + A[0, j] if k == 0 else value


@inlined
def _increment(a: Array, b: Array, da: Array, db: Array, dz: Array) -> None:
    """``z'(q̄) Δq`` of two frames with means ``a``, ``b`` and increments ``da``, ``db``."""
    gap = minus(load_row(b, 0), load_row(a, 0))
    widening = minus(load_row(db, 0), load_row(da, 0))
    for k in range(3):
        axis, turn = load_row(a, 1 + k), load_row(da, 1 + k)
        dz[k] = dot(turn, gap) + dot(axis, widening)
        for n in range(3):
            other, its = load_row(b, 1 + n), load_row(db, 1 + n)
            dz[3 + 3 * k + n] = dot(turn, other) + dot(axis, its)


@inlined
def _forces(a: Array, b: Array, p: Array) -> tuple[Vector, Vector, Vector]:
    """Force on B's origin, and moments on A and B about their origins, of ``p`` on z."""
    gap = minus(load_row(b, 0), load_row(a, 0))
    force, on_a, on_b = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for k in range(3):
        axis = load_row(a, 1 + k)
        force = plus(force, scaled(p[k], axis))
        on_a = plus(on_a, scaled(p[k], cross(axis, gap)))
        for n in range(3):
            moment = scaled(p[3 + 3 * k + n], cross(axis, load_row(b, 1 + n)))
            on_a = plus(on_a, moment)
            on_b = minus(on_b, moment)
    return force, on_a, on_b


@uncounted
def add_joints(
    mean: Array,
    delta: Array,
    packed: PackedJoints,
    multipliers: Array,
    driven: Array,
    h: float,
    change: Array,
    out: Array,
    ground: Array,
) -> tuple[float, float]:
    """Add the forces of all joints to ``out`` and set ``change``, the increments of constraints.

    Args:
        mean: Means of (x, d₁, d₂, d₃) of all nodes, then of ground and prescribed frames.
        delta: Increments.
        packed: See :class:`~fem_lie.joints.equations.joint_arrays.JointArrays`.
        multipliers: Lagrange multipliers, shape (m,).
        driven: Increments of the constraints' targets, shape (m,).
        h: Step size.
        change: Increments ``Σ g·z'(q̄) Δq`` without those of the targets, shape (m,), overwritten.
        out: Forces and moments on the moving nodes, global components, shape (n, 6), updated.
        ground: Force and moment about the origin of ground and prescribed frames, shape (≥ 6,),
            updated.

    Returns:
        The work of prescribed frames and drives on the nodes, and the loss in dampers.
    """
    arrays = joint_arrays(packed)
    work, loss, m = 0.0, 0.0, multipliers.shape[0]
    workspace, frames = vector_at(stack(51), 51), blocks_at(stack(72), 6, 4, 3)
    p, z, dz, g, f = (
        workspace[:12],
        workspace[12:24],
        workspace[24:36],
        workspace[36:48],
        workspace[48:],
    )
    both, moved, start = frames[:2], frames[2:4], frames[4:]
    for k in range(3):
        f[k] = 0.0
    for c in range(m):
        change[c] = -driven[c]
        work -= multipliers[c] * driven[c]
    for j in range(arrays.nodes.shape[0]):
        for side in range(2):
            _joint_frame(mean[arrays.nodes[j, side]], arrays.frames[j, side], both[side])
            _joint_frame(delta[arrays.nodes[j, side]], arrays.frames[j, side], moved[side])
        _increment(both[0], both[1], moved[0], moved[1], dz)
        if arrays.curved[j] or arrays.rows[arrays.first[j]] >= m:
            for side in range(2):
                for k in range(4):
                    for n in range(3):
                        start[side, k, n] = both[side, k, n] - 0.5 * moved[side, k, n]
            relative_motion(start[0], start[1], z)
            functions.values(z, arrays.angle[j], arrays.turned[j], f)
        for k in range(12):
            p[k] = 0.0
        for t in range(arrays.first[j], arrays.first[j + 1]):
            for k in range(12):
                g[k] = arrays.selection[t, k]
            if arrays.curved[j]:
                functions.add_secants(z, dz, arrays.angle[j], arrays.functions[t], g)
            gain, row = 0.0, arrays.rows[t]
            for k in range(12):
                gain += g[k] * dz[k]
            if row < m:
                change[row] += gain
                weight = multipliers[row]
            else:
                stiffness, damping, rest = arrays.springs[row - m]
                before = term(arrays, t, z, f)
                if arrays.laws[row - m, 0] != 0:
                    weight = laws.mean_force(arrays, row - m, before, gain)
                else:
                    weight = stiffness * (before + 0.5 * gain - rest) + damping * gain / h
                loss += damping * gain * gain / h
            for k in range(12):
                p[k] += weight * g[k]
        force, on_a, on_b = _forces(both[0], both[1], p)
        for side in range(2):
            f_side, moment = (force, on_b) if side == 1 else (scaled(-1.0, force), on_a)
            node = arrays.nodes[j, side]
            if node < out.shape[0]:
                arm = minus(load_row(both[side], 0), load_row(mean[node], 0))
                store(out[node], 0, plus(load(out[node], 0), f_side))
                moment = plus(moment, cross(arm, f_side))
                store(out[node], 3, plus(load(out[node], 3), moment))
            else:
                add_wrench(ground, 0, load_row(both[side], 0), f_side, moment)
            if node > out.shape[0]:
                for k in range(4):
                    for n in range(3):
                        moved[1 - side, k, n] = 0.0
                _increment(both[0], both[1], moved[0], moved[1], dz)
                for k in range(12):
                    work += p[k] * dz[k]
    return work, loss


@compiled
def border_at(
    joints: PackedJoints,
    incidences: Incidences,
    kinds: Indices,
    held: Indices,
    frames: tuple[Array, Array, Array],
    out: Array,
) -> None:
    """Constraint rows and columns of the matrix of a step.

    Args:
        joints: Packed arrays of all joints.
        incidences: Constraint-node incidences; rows of nodes other than frames stay zero.
        kinds: Types of the nodes, (n,).
        held: Which unknowns are zero, 0 or 1, (n, 6).
        frames: Frames at the end of the step, midpoint frames with the axes of the unknowns, and
            frames at which forces act.
        out: Rows and columns, (2, incidences, 6), overwritten.
    """
    end, axes, middle = frames
    arrays = joint_arrays(joints)
    out[:] = 0.0
    jacobian(end, arrays, out[0])
    jacobian(middle, arrays, out[1])
    for incidence in range(incidences.nodes.shape[0]):
        i, row = incidences.nodes[incidence], out[0, incidence]
        e, a = end[i], axes[i]
        spatial = rotate(load_row(e, 1), load_row(e, 2), load_row(e, 3), load(row, 0))
        store(row, 0, rotate_back(load_row(a, 1), load_row(a, 2), load_row(a, 3), spatial))
        for k in range(6):
            if held[i, k] or kinds[i] >= POSITION_GRADIENT:
                out[0, incidence, k] = out[1, incidence, k] = 0.0


@uncounted
def begin(packed: Indices, starts: Indices, steps: Indices) -> float:
    """Predict the step; returns the size of its largest motion.

    Records are :class:`~fem_lie.solve.conserving.step.packing.Packed`, here and below: only the
    fields that are read are passed.
    """
    model, state, this = model_of(packed), state_of(starts), step_of(steps)
    H, V, trend, step, scheme = state.H, state.V, state.trend, this.step, model.scheme
    put(V, this.V1)
    put(state.multipliers, this.multipliers)
    if scheme.dissipation * state.filter_state[0].active > 0.0:
        ranks = ranks_of(model, this)
        begin_products(model.inertia, V, state.w, products_of(this), ranks)
    h = scheme.h
    ahead, largest, rates = h * h, 0.0, vector_at(stack(6), 6)
    for i in range(step.shape[0]):
        rates_of(model.kinds[i], H[i], V[i], rates)
        u = combined(h, load(rates, 0), ahead, load(trend[i], 0))
        ψ = combined(h, load(rates, 3), ahead, load(trend[i], 3))
        hold(model.kinds[i], H[i], model.held[i], u, ψ, step[i])
        for k in range(6):
            largest = max(largest, abs(step[i, k]) * model.measure[6 * i + k])
    return largest


@inlined
def hold(kind: int, H: Array, held: Indices, u: Vector, ψ: Vector, step: Array) -> None:
    """``step = (u, ψ)`` without its components along the fixed axes of the node."""
    any_held = False
    for k in range(6):
        any_held = any_held or held[k] != 0
    if any_held:
        d1, d2, d3 = axes(kind, H)
        a, b = rotate_back(d1, d2, d3, u), rotate_back(d1, d2, d3, ψ)
        a = (0.0 if held[0] else a[0], 0.0 if held[1] else a[1], 0.0 if held[2] else a[2])
        b = (0.0 if held[3] else b[0], 0.0 if held[4] else b[1], 0.0 if held[5] else b[2])
        u, ψ = rotate(d1, d2, d3, a), rotate(d1, d2, d3, b)
    store(step, 0, u)
    store(step, 3, ψ)


@uncounted
def compare(packed: Indices, starts: Indices, steps: Indices) -> None:
    """Differences of the current step from the matrix: constraint Jacobian, and rotations of Π."""
    model, state, this = model_of(packed), state_of(starts), step_of(steps)
    along, change, incidences, scheme = (
        span_of(this.coordinates),
        this.border,
        model.incidences,
        model.scheme,
    )
    if this.turnings.shape[1] > 0:
        χ, frames = (
            scheme.dissipation * state.filter_state[0].active,
            (model.kinds, along.mean, along.middle),
        )
        ranks = ranks_of(model, this)
        set_turnings(products_of(this), frames, model.held, χ, scheme.h, this.turnings, ranks)
    if incidences.nodes.shape[0] == 0:
        return
    frames_at = along.end, along.middle, along.middle
    border_at(model.joints, incidences, model.kinds, model.held, frames_at, change)
    for side in range(2):
        for incidence in range(change.shape[1]):
            for k in range(6):
                change[side, incidence, k] -= state.border[side, incidence, k]


@linked
def packed_correct(model: Indices, state: Indices, step: Indices) -> None:
    """:func:`correct`, from Python."""
    correct(model, state, step)


@uncounted
def correct(packed: Indices, starts: Indices, steps: Indices) -> None:
    """Apply the correction."""
    model, state, this = model_of(packed), state_of(starts), step_of(steps)
    χ = model.scheme.dissipation * state.filter_state[0].active
    H, multipliers, held, scale = state.H, state.multipliers, model.held, model.scale
    kinds = model.kinds
    step, middle, x = this.step, span_of(this.coordinates).middle, solution_of(this.r).x
    n = step.shape[0]
    for i in range(n):
        (d1, d2, d3), dx = axes(kinds[i], middle[i]), x[6 * i : 6 * i + 6]
        u = minus(load(step[i], 0), rotate(d1, d2, d3, load(dx, 0)))
        ψ = minus(load(step[i], 3), rotate(d1, d2, d3, load(dx, 3)))
        hold(kinds[i], H[i], held[i], u, ψ, step[i])
    for c in range(multipliers.shape[0]):
        # the residual contains 2/(1 + χ) times the forces, the matrix their derivatives
        multipliers[c] -= 0.5 * (1.0 + χ) * scale[c] * x[6 * n + c]
