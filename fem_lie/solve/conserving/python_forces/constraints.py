"""Constraints between more than two frames, over a step: sliding, rolling, joints within elements.

Any constraint ``Φ`` of frames has a discrete gradient. With its Jacobian ``J`` at the midpoint of
the step, the increments ``Δ = (Δx, ψ)`` of the nodes, and the increment ``s`` without its rigid
part, in the metric ``M`` (1 on translations, the square of the model's length on rotations)::

    D = J + (ΔΦ − J Δ)/|s|² M s,        λ D Δ = λ ΔΦ

So its forces ``λ D`` do no work if the constraint holds at both ends, and, as neither ``J`` nor
``M s`` has a resultant or a moment about the means, momenta are conserved. On the ground or with
fixed unknowns there are no momenta to conserve, and ``s`` is the whole increment. The factor is of
third order in the step.

Velocity constraints hold at the end of the step, ``W(H₁) v₁ = 0``. Their forces are along ``D``
with ``D Δ = 0``, and do no work either. (Gonzalez, J. Nonlinear Sci. 6 (1996) 449, in the quotient
by rigid motions, as in :mod:`..midpoint.discrete_gradient` for elements.)
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie._state import Stateful
from fem_lie.bodies.balances import BY_REACTIONS, DAMPING, WORK
from fem_lie.joints.equations.joint_arrays import PackedJoints, joint_arrays, views
from fem_lie.joints.equations.terms import spring_energy
from fem_lie.lie.tuples import (
    add_wrench,
    combined,
    cross,
    dot,
    load,
    load_row,
    minus,
    plus,
    rotate,
    scaled,
    store,
)
from fem_lie.solve.conserving.midpoint.any_node import twists
from fem_lie.solve.conserving.midpoint.discrete_gradient import KNOWN, ROUND_OFF, beyond, factor_of
from fem_lie.solve.conserving.midpoint.mean_forces import add_resistance, solve_symmetric
from fem_lie.solve.conserving.step.joints import add_joints
from fem_lie.solve.conserving.step.records import Model, Span, State, Step
from fem_lie.system.equations import Equations

_BALANCED = 1e-9
"""Resultant and moment of a constraint row, over the size of its parts, that are round-off."""


class _Sparse(NamedTuple):
    """Rows of the Jacobian along the axes of the nodes, in the format of ``csr_matrix``."""

    indptr: Indices
    indices: Indices
    data: Array


@compiled
def _row_of(B: _Sparse, c: int, middle: Array, f: Array, nodes: Indices) -> int:
    """Nodes of row ``c``, and forces on them in global components; returns their number."""
    count, begin, end = 0, B.indptr[c], B.indptr[c + 1]
    f[:] = 0.0
    last = -1
    for e in range(begin, end):
        if B.data[e] == 0.0:
            continue
        node = B.indices[e] // 6
        if node != last:
            nodes[count], last = node, node
            count += 1
        f[count - 1, B.indices[e] % 6] += B.data[e]
    for a in range(count):
        m = middle[nodes[a]]
        for at in (0, 3):
            own = load(f[a], at)
            store(f[a], at, rotate(load_row(m, 1), load_row(m, 2), load_row(m, 3), own))
    return count


@compiled
def _deformation(
    nodes: Indices, middle: Array, step: Array, length: float, whole: bool, s: Array
) -> float:
    """Increments of some nodes (k, 6), without their rigid part unless ``whole``.

    Returns ``|s|²``.
    """
    count, square = nodes.shape[0], 0.0
    for a in range(count):
        s[a] = step[nodes[a]]
    if not whole:
        share, A = 1.0 / count, np.zeros((3, 3))
        centre, shift, b = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        for i in nodes:
            centre = plus(centre, scaled(share, load_row(middle[i], 0)))
            shift = plus(shift, scaled(share, load(step[i], 0)))
        for a in range(count):
            r = minus(load_row(middle[nodes[a]], 0), centre)
            add_resistance(A, 1.0, r)
            b = plus(b, cross(r, minus(load(s[a], 0), shift)))
            b = plus(b, scaled(length**2, load(s[a], 3)))
            for k in range(3):
                A[k, k] += length**2
        ω = solve_symmetric(A, b)
        for a in range(count):
            r = minus(load_row(middle[nodes[a]], 0), centre)
            store(s[a], 0, minus(minus(load(s[a], 0), shift), cross(ω, r)))
            store(s[a], 3, minus(load(s[a], 3), ω))
    for a in range(count):
        u, w = load(s[a], 0), load(s[a], 3)
        square += dot(u, u) + length**2 * dot(w, w)
    return square


@compiled
def _add(
    B: _Sparse,
    first: int,
    gains: Array,
    multipliers: Array,
    motion: tuple[Array, Array],
    length: float,
    sums: tuple[Array, Array],
) -> None:
    """Add forces ``λ D`` of the constraints from the ``first`` on.

    Args:
        B: Jacobian at the midpoint of the step.
        first: Index of the first of these constraints.
        gains: ``D Δ`` of all constraints, (m,).
        multipliers: Lagrange multipliers, (m,).
        motion: Nodes at the midpoint of the step, and increments, (n, 6).
        length: Length of the model.
        sums: Forces along increments, (n, 6), and losses, see
            :class:`~fem_lie.solve.conserving.step.records.Step`; updated.
    """
    (middle, step), (out, losses) = motion, sums
    most = 1
    for c in range(first, multipliers.shape[0]):
        most = max(most, B.indptr[c + 1] - B.indptr[c])
    f, s, on = np.empty((most, 6)), np.empty((most, 6)), np.empty(most, dtype=np.int64)
    for c in range(first, multipliers.shape[0]):
        count = _row_of(B, c, middle, f, on)
        nodes = on[:count]
        force, moment, size, far = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0, 0.0
        made, centre = 0.0, load_row(middle[nodes[0]], 0) if count > 0 else (0.0, 0.0, 0.0)
        for a in range(count):
            x, u, m = load_row(middle[nodes[a]], 0), load(f[a], 0), load(f[a], 3)
            force = plus(force, u)
            moment = plus(moment, plus(m, cross(minus(x, centre), u)))
            pulled, twisted = sqrt(dot(u, u)), sqrt(dot(m, m))
            size += pulled * length + twisted
            far += pulled * (length + sqrt(dot(x, x))) + twisted
            made += dot(u, load(step[nodes[a]], 0)) + dot(m, load(step[nodes[a]], 3))
        left = sqrt(dot(force, force)) * length + sqrt(dot(moment, moment))
        grounded = left > _BALANCED * size
        square = _deformation(nodes, middle, step, length, grounded, s)
        round_off_level = ROUND_OFF * far
        missing = beyond(gains[c] - made, round_off_level)
        factor = factor_of(missing, KNOWN * round_off_level, square, ROUND_OFF * length**2)
        for a in range(count):
            pull = combined(1.0, load(f[a], 0), factor, load(s[a], 0))
            turn = combined(1.0, load(f[a], 3), factor * length**2, load(s[a], 3))
            pull, turn = scaled(multipliers[c], pull), scaled(multipliers[c], turn)
            i = nodes[a]
            store(out[i], 0, plus(load(out[i], 0), pull))
            store(out[i], 3, plus(load(out[i], 3), turn))
            if grounded:
                back = scaled(-1.0, pull), scaled(-1.0, turn)
                add_wrench(losses, BY_REACTIONS, load_row(middle[i], 0), back[0], back[1])


@compiled
def _add_pairs(
    along: tuple[Array, Array],
    joints: PackedJoints,
    multipliers: Array,
    driven: Array,
    h: float,
    change: Array,
    out: Array,
    losses: Array,
) -> None:
    """Add forces of joints between two frames, and increments of all targets."""
    (mean, delta), ground = along, losses[BY_REACTIONS:]
    work, loss = add_joints(mean, delta, joints, multipliers, driven, h, change, out, ground)
    losses[WORK] += work
    losses[DAMPING] += loss


@compiled
def _spring_energy(joints: PackedJoints, H: Array) -> float:
    arrays = joint_arrays(joints)
    return spring_energy(H, arrays) if len(arrays.springs) > 0 else 0.0


class OtherConstraints(Stateful):
    """All joints of a scene of frames, some of which are between more than two of them."""

    def __init__(self, equations: Equations) -> None:
        """Set up before the first step."""
        unknowns, joints, m = equations.unknowns, equations.arrays.joints, equations.unknowns.m
        self._equations, self._joints, self._n = equations, joints, unknowns.moving
        rows = views(joints).rows
        self._own = slice(int(rows[rows < m].max(initial=-1)) + 1, m)
        self._rolling = slice(m - unknowns.of_velocities, m)
        self._start: Array = np.zeros(m)
        self._length = unknowns.length

    def begin(self, H: Array) -> None:
        """Begin a step from nodes ``H``."""
        self._start[:] = self._equations.constraints(H).values

    def add_forces(self, model: Model, state: State, this: Step, h: float) -> None:
        """Add forces to ``this.outer``; compute increments of constraints, and balances."""
        along, own, change = Span(*this.coordinates), self._own, this.change
        coordinates = along.mean, along.delta
        driven = model.driven
        _add_pairs(
            coordinates, self._joints, state.multipliers, driven, h, change, this.outer, this.losses
        )
        middle, end = (self._equations.constraints(H) for H in (along.middle, along.end))
        gains = end.values - self._start
        change[own] += gains[own]
        if len(along.end) > self._n + 1:
            by_motions = self._by_motions(state.H, along.end)
            gains -= by_motions
            this.losses[WORK] += state.multipliers[own] @ by_motions[own]
        rolling = self._rolling
        gains[rolling] = 0.0
        if rolling.start < rolling.stop:
            size = 0.5 * (1.0 + model.scheme.dissipation * state.filter_state.active) * h
            change[rolling] = size * self._rates(along.end, this.V1)[rolling] - state.gap[rolling]
        B = middle.jacobian
        B.sort_indices()
        sparse = _Sparse(B.indptr, B.indices, B.data)
        motion, sums = (along.middle, this.step), (this.outer, this.losses)
        _add(sparse, own.start, gains, state.multipliers, motion, self._length, sums)

    def _by_motions(self, start: Array, end: Array) -> Array:
        """Changes of the constraints by prescribed motions only, (m,)."""
        v = np.zeros((len(end), 6))
        v[self._n + 1 :] = lie.se3_relative(start[self._n + 1 :], end[self._n + 1 :])
        middle = end.copy()
        middle[self._n + 1 :] = lie.se3_retract(start[self._n + 1 :], 0.5 * v[self._n + 1 :])
        return self._equations.constraints(middle).rates(v)[0]

    def _rates(self, H: Array, V: Array) -> Array:
        """First rates of all constraints at nodes ``H`` with the coordinate rates ``V``, (m,)."""
        v, unused, still = np.zeros((3, len(H), 6))
        n, known = self._n, self._equations.arrays
        twists(known.kinds, known.turning, H, V[:n], still[:n], v[:n], unused[:n])
        return self._equations.constraints(H).rates(v)[0]

    def accept(self, H: Array, driven: Array, gap: Array) -> None:
        """Set ``gap`` (m,) to the constraint violations at nodes ``H``; it is not accumulated.

        Args:
            H: Nodes at the end of a step.
            driven: Increments of the targets in it, (m,).
            gap: Constraint violations, updated.
        """
        if not self._equations.unknowns.driven:
            gap[self._own] = self._equations.constraints(H).values[self._own]

    def energy(self, H: Array) -> float:
        """Energy of springs at nodes ``H``."""
        return _spring_energy(self._joints, H)
