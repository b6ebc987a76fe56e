r"""Joints between bodies with steps of their own: over a whole step, as over one of each.

Constraints are bilinear in ``q = (x, d₁, d₂, d₃)`` of their nodes, so that with the means ``q̄`` and
increments ``Δq`` of a whole step ``Φ(q₁) − Φ(q₀) = Φ'(q̄) Δq``, however many steps a body has made
meanwhile. Multipliers ``λ`` act over the whole step by forces on ``q`` that do not change in it,
with the force and the moment of ``Φ'(q̄)ᵀ λ``::

    P = (f, a × d̄₁, a × d̄₂, a × d̄₃),            Σ d̄ₖ × (a × d̄ₖ) = m

The work of ``P`` in all steps of a body is ``P·Δq``, and that on all bodies ``λ·(Φ(q₁) − Φ(q₀))``,
which is zero.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie.joints.equations.table import PackedJoints
from fem_lie.lie.kinds import SLOPE
from fem_lie.lie.tuples import Vector, combined, cross, dot, load, load_row, plus, scaled, store_row
from fem_lie.solve.conserving.step.joints import add_joints


@compiled
def joined(
    kinds: Indices,
    H: Array,
    moved: Array,
    joints: PackedJoints,
    weights: Array,
    out: tuple[Array, Array],
) -> None:
    """Changes of the constraints over a whole step, and forces that stay the same in it.

    Args:
        kinds: Types of the moving nodes, (n,); of those that are no frames positions are joined.
        H: Rows at its start, (≥ n + 1, 4, 3); ground is not touched.
        moved: Their increments of the moving nodes, (n, 4, 3).
        joints: Table of the joints.
        weights: Multipliers, (m,).
        out: The changes, (m,), and forces on the rows, (n, 4, 3); overwritten.
    """
    change, forces = out
    n = moved.shape[0]
    delta, mean = np.zeros_like(H), H.copy()
    for i in range(n):
        for k in range(4 if kinds[i] < SLOPE else 1):
            for j in range(3):
                delta[i, k, j] = moved[i, k, j]
                mean[i, k, j] += 0.5 * moved[i, k, j]
    acting, ground = np.zeros((n, 6)), np.zeros(6)
    add_joints(mean, delta, joints, weights, np.zeros_like(weights), 1.0, change, acting, ground)
    for i in range(n):
        # of a residual
        store_row(forces[i], 0, scaled(-1.0, load(acting[i], 0)))
        for k in range(1, 4):
            store_row(forces[i], k, (0.0, 0.0, 0.0))
        if kinds[i] >= SLOPE:
            continue
        a = _turning(mean[i], scaled(-1.0, load(acting[i], 3)))
        for k in range(1, 4):
            store_row(forces[i], k, cross(a, load_row(mean[i], k)))


@compiled
def _turning(d: Array, m: Vector) -> Vector:
    """``a`` with ``Σ d_k × (a × d_k) = m``."""
    K = np.zeros((3, 3))
    for k in range(1, 4):
        row = load_row(d, k)
        for i in range(3):
            K[i, i] += dot(row, row)
            for j in range(3):
                K[i, j] -= row[i] * row[j]
    x, y, z = load_row(K, 0), load_row(K, 1), load_row(K, 2)
    whole = 1.0 / dot(x, cross(y, z))
    # K is symmetric: its rows are its columns
    first = combined(m[0], cross(y, z), m[1], cross(z, x))
    return scaled(whole, plus(first, scaled(m[2], cross(x, y))))
