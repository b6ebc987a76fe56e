"""Joints over a step: constraints by their increments, forces at the mean configuration.

``z = (Δ, Q)``, the relative motion of the joint's frames, is bilinear in positions and directors
``q`` of its nodes, so ``z₁ − z₀ = z'(q̄)(q₁ − q₀)`` with the mean ``q̄``, exactly. Forces
``z'(q̄)ᵀ p`` therefore do the work ``p·(z₁ − z₀)``, which is zero for ``p = Sᵀλ`` and ``S z = 0`` at
both ends, and no net force or moment but that on the ground: ``z`` does not feel rigid motion. The
constraints are followed by their increments, with all digits. (Gonzalez, J. Nonlinear Sci. 6 (1996)
449, section 4; Betsch & Steinmann, Multibody Syst. Dyn. 8 (2002) 367.)
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fem_lie._jit import Array, compiled, inlined
from fem_lie._lie_tuples import (
    Vector,
    cross,
    dot,
    load,
    load_row,
    minus,
    plus,
    scaled,
    store,
)


@inlined
def _joint_frame(A: Array, C: Array, out: Array) -> None:
    """Rows (x, d₁, d₂, d₃) of a joint's frame from those of its node."""
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


@compiled
def add_joints(
    mean: Array,
    delta: Array,
    table: tuple[Any, ...],
    weights: Array,
    change: Array,
    out: Array,
) -> float:
    """Add the forces of all joints to ``out`` and set ``change``, the increments of constraints.

    Args:
        mean: Means of (x, d₁, d₂, d₃) of all rows, ground and prescribed frames last.
        delta: Increments.
        table: See :class:`~fem_lie.constraints.JointTable`.
        weights: Multipliers, shape (m,).
        change: Increments ``S z'(q̄) Δq``, shape (m,), overwritten.
        out: Forces and moments on the moving nodes, global components, shape (n, 6), updated.

    Returns:
        The work of prescribed frames on the nodes.
    """
    nodes, frames, first, selection = table
    work, p, dz = 0.0, np.empty(12), np.empty(12)
    both, moved = np.empty((2, 4, 3)), np.empty((2, 4, 3))
    for j in range(nodes.shape[0]):
        for side in range(2):
            _joint_frame(mean[nodes[j, side]], frames[j, side], both[side])
            _joint_frame(delta[nodes[j, side]], frames[j, side], moved[side])
        _increment(both[0], both[1], moved[0], moved[1], dz)
        p[:] = 0.0
        for c in range(first[j], first[j + 1]):
            change[c] = 0.0
            for k in range(12):
                change[c] += selection[c, k] * dz[k]
                p[k] += weights[c] * selection[c, k]
        force, on_a, on_b = _forces(both[0], both[1], p)
        for side in range(2):
            f = force if side == 1 else scaled(-1.0, force)
            m = on_b if side == 1 else on_a
            node = nodes[j, side]
            if node < out.shape[0]:
                arm = minus(load_row(both[side], 0), load_row(mean[node], 0))
                store(out[node], 0, plus(load(out[node], 0), f))
                store(out[node], 3, plus(load(out[node], 3), plus(m, cross(arm, f))))
            elif node > out.shape[0]:
                moved[1 - side] = 0.0
                _increment(both[0], both[1], moved[0], moved[1], dz)
                for k in range(12):
                    work += p[k] * dz[k]
    return work
