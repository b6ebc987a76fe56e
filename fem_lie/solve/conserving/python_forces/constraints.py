"""Constraints between more than two nodes, over a step: sliding, rolling, joints within elements.

Any constraint ``Φ`` has a discrete gradient. With its Jacobian ``J`` at the midpoint of the step,
the increments ``Δ`` of the nodes, ``(Δx, ψ)`` of frames and those of the coordinate vectors of
others, and the increment ``s`` without its rigid part, in the metric ``M`` (1 on lengths, the
square of the model's length on vectors without dimension and on rotations that ``J`` acts on)::

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

from collections.abc import Mapping
from math import sqrt
from typing import NamedTuple

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined
from fem_lie._state import Stateful
from fem_lie.bodies.balances import BY_REACTIONS, DAMPING, WORK
from fem_lie.joints.equations.joint_arrays import PackedJoints, joint_arrays, views
from fem_lie.joints.equations.terms import spring_energy
from fem_lie.lie.node_types import MIXED_DERIVATIVE, MODAL, POSITION, POSITION_GRADIENT
from fem_lie.lie.node_types.forces import wrench
from fem_lie.lie.node_types.node_type import axes, first_vector
from fem_lie.lie.tuples import (
    Vector,
    add_wrench,
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
from fem_lie.solve.conserving.midpoint.any_node import twists
from fem_lie.solve.conserving.midpoint.discrete_gradient import KNOWN, ROUND_OFF, beyond, factor_of
from fem_lie.solve.conserving.midpoint.mean_forces import add_resistance, solve_symmetric
from fem_lie.solve.conserving.python_forces.joints import Joints
from fem_lie.solve.conserving.step.joints import add_joints
from fem_lie.solve.conserving.step.records import Model, Span, State, Step
from fem_lie.system.equations import Equations

_BALANCED = 1e-9
"""Resultant and moment of a constraint row, over the size of its parts, that are round-off."""
_FREE = 1e-9
"""Factor on the metric of rotations that a constraint does not act on. So a bead gets no moment,
however small its inertia, and the rigid part of points on a line is still defined."""


class _Nodal(NamedTuple):
    """Nodes over a step.

    Attributes:
        kinds: Their types, (n,).
        weights: Metric of the first and last three unknowns, (n, 2).
        middle: Nodes at the midpoint of the step, (≥ n, 4, 3).
        step: Increments along global axes, (n, 6).
    """

    kinds: Indices
    weights: Array
    middle: Array
    step: Array


class _Sparse(NamedTuple):
    """Rows of the Jacobian along the axes of the nodes, in the format of ``csr_matrix``."""

    indptr: Indices
    indices: Indices
    data: Array


_PLACE, _ROTATION, _VECTOR, _AMPLITUDES = range(4)
"""What three unknowns of a node are: a position, the rotation of a frame, a coordinate vector that
rotates with the body, or amplitudes, which a rigid motion does not change."""


@inlined
def _unknowns_of(kind: int, half: int) -> int:
    """What the first or last three unknowns of a node are."""
    if kind < POSITION_GRADIENT:
        return half
    if kind == MODAL or (kind == POSITION and half == 1):
        return _AMPLITUDES
    return _PLACE if half == 0 and kind < MIXED_DERIVATIVE else _VECTOR


@compiled
def _row_of(B: _Sparse, c: int, nodal: _Nodal, f: Array, nodes: Indices) -> int:
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
        d1, d2, d3 = axes(nodal.kinds[nodes[a]], nodal.middle[nodes[a]])
        for at in (0, 3):
            store(f[a], at, rotate(d1, d2, d3, load(f[a], at)))
    return count


@inlined
def _arm(nodal: _Nodal, i: int, half: int, centre: Vector) -> Vector:
    """Position from the centre, or coordinate vector, of a node at the midpoint of the step."""
    kind, middle = nodal.kinds[i], nodal.middle[i]
    if kind < POSITION_GRADIENT or _unknowns_of(kind, half) == _PLACE:
        return minus(load_row(middle, 0), centre)
    return load_row(middle, first_vector(kind) + half)


@compiled
def _deformation(nodes: Indices, nodal: _Nodal, metric: Array, whole: bool, s: Array) -> float:
    """Increments of some nodes (k, 6), without their rigid part in ``metric`` unless ``whole``.

    Returns ``|s|²``.
    """
    count, square, places = nodes.shape[0], 0.0, 0
    centre, shift = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for a in range(count):
        s[a] = nodal.step[nodes[a]]
        if _unknowns_of(nodal.kinds[nodes[a]], 0) == _PLACE:
            places += 1
            centre = plus(centre, load_row(nodal.middle[nodes[a]], 0))
            shift = plus(shift, load(s[a], 0))
    if not whole:
        share = 1.0 / max(places, 1)
        centre, shift = scaled(share, centre), scaled(share, shift)
        A, b = np.zeros((3, 3)), (0.0, 0.0, 0.0)
        for a in range(count):
            i = nodes[a]
            for half in range(2):
                what, weight = _unknowns_of(nodal.kinds[i], half), metric[a, half]
                moved = load(s[a], 3 * half)
                if what == _PLACE:
                    moved = minus(moved, shift)
                    store(s[a], 0, moved)
                if what == _ROTATION:
                    b = plus(b, scaled(weight, moved))
                    for k in range(3):
                        A[k, k] += weight
                elif what != _AMPLITUDES:
                    r = _arm(nodal, i, half, centre)
                    add_resistance(A, weight, r)
                    b = plus(b, scaled(weight, cross(r, moved)))
        ω = solve_symmetric(A, b)
        for a in range(count):
            i = nodes[a]
            for half in range(2):
                what = _unknowns_of(nodal.kinds[i], half)
                if what == _ROTATION:
                    store(s[a], 3, minus(load(s[a], 3), ω))
                elif what != _AMPLITUDES:
                    turned = cross(ω, _arm(nodal, i, half, centre))
                    store(s[a], 3 * half, minus(load(s[a], 3 * half), turned))
    for a in range(count):
        for half in range(2):
            part = load(s[a], 3 * half)
            square += metric[a, half] * dot(part, part)
    return square


@compiled
def _add(
    B: _Sparse,
    first: int,
    gains: Array,
    multipliers: Array,
    nodal: _Nodal,
    length: float,
    sums: tuple[Array, Array],
) -> None:
    """Add forces ``λ D`` of the constraints from the ``first`` on.

    Args:
        B: Jacobian at the midpoint of the step.
        first: Index of the first of these constraints.
        gains: ``D Δ`` of all constraints, (m,).
        multipliers: Lagrange multipliers, (m,).
        nodal: The nodes over the step.
        length: Length of the model.
        sums: Forces along increments, (n, 6), and losses, see
            :class:`~fem_lie.solve.conserving.step.records.Step`; updated.
    """
    middle, (out, losses) = nodal.middle, sums
    most = 1
    for c in range(first, multipliers.shape[0]):
        most = max(most, B.indptr[c + 1] - B.indptr[c])
    f, s, on = np.empty((most, 6)), np.empty((most, 6)), np.empty(most, dtype=np.int64)
    own, metric = np.empty(6), np.empty((most, 2))
    for c in range(first, multipliers.shape[0]):
        count = _row_of(B, c, nodal, f, on)
        nodes = on[:count]
        force, moment, size, far = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0, 0.0
        made, centre = 0.0, load_row(middle[nodes[0]], 0) if count > 0 else (0.0, 0.0, 0.0)
        for a in range(count):
            i = nodes[a]
            for half in range(2):
                what, part = _unknowns_of(nodal.kinds[i], half), load(f[a], 3 * half)
                made += dot(part, load(nodal.step[i], 3 * half))
                pulled, reach = sqrt(dot(part, part)), sqrt(nodal.weights[i, half])
                if what == _PLACE:
                    x = load_row(middle[i], 0)
                    force = plus(force, part)
                    size += pulled * length
                    far += pulled * (length + sqrt(dot(x, x)))
                else:
                    size += pulled * length / reach
                    far += pulled * length / reach
                if what == _ROTATION:
                    moment = plus(moment, part)
                elif what != _AMPLITUDES:
                    moment = plus(moment, cross(_arm(nodal, i, half, centre), part))
        left = sqrt(dot(force, force)) * length + sqrt(dot(moment, moment))
        grounded = left > _BALANCED * size
        for a in range(count):
            for half in range(2):
                what, part = _unknowns_of(nodal.kinds[nodes[a]], half), load(f[a], 3 * half)
                free = what == _ROTATION and sqrt(dot(part, part)) <= _BALANCED * size
                metric[a, half] = (_FREE if free else 1.0) * nodal.weights[nodes[a], half]
        square = _deformation(nodes, nodal, metric, grounded, s)
        round_off_level = ROUND_OFF * far
        missing = beyond(gains[c] - made, round_off_level)
        factor = factor_of(missing, KNOWN * round_off_level, square, ROUND_OFF * length**2)
        for a in range(count):
            i = nodes[a]
            for half in range(2):
                gradient = factor * metric[a, half]
                for k in range(3 * half, 3 * half + 3):
                    own[k] = multipliers[c] * (f[a, k] + gradient * s[a, k])
                    out[i, k] += own[k]
            if grounded:
                d1, d2, d3 = axes(nodal.kinds[i], middle[i])
                for at in (0, 3):
                    store(own, at, rotate_back(d1, d2, d3, load(own, at)))
                pull, turn = wrench(nodal.kinds[i], middle[i], own)
                at_node = load_row(middle[i], 0)
                add_wrench(losses, BY_REACTIONS, at_node, scaled(-1.0, pull), scaled(-1.0, turn))


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


class _FramePairs(Stateful):
    """Joints between two frames, as compiled steps evaluate them."""

    def __init__(self, equations: Equations) -> None:
        self._packed = equations.arrays.joints
        self.count = len(views(self._packed).targets)

    def begin(self, H: Array) -> None:
        """Begin a step, which needs nothing."""

    def add_forces(self, model: Model, state: State, this: Step, h: float) -> None:
        """Add forces to ``this.outer``; compute increments of constraints, and balances."""
        along, own = Span(*this.coordinates), slice(self.count)
        coordinates, change = (along.mean, along.delta), this.change[own]
        given = self._packed, state.multipliers[own], model.driven[own], h
        _add_pairs(coordinates, *given, change, this.outer, this.losses)

    def accept(self, H: Array, driven: Array, gap: Array) -> None:
        """Accept a step, which changes nothing: compiled steps sum violations."""

    def restart(self, H: Array, gap: Array) -> None:
        """Restart, which needs nothing: compiled steps have full turns in their arrays."""

    def energy(self, H: Array) -> float:
        """Energy of springs at nodes ``H``."""
        return _spring_energy(self._packed, H)


class OtherConstraints:
    """All joints of a scene, some of which are between more than two nodes."""

    def __init__(self, equations: Equations, pairs: Joints | None) -> None:
        """Set up before the first step.

        Args:
            equations: Equations of the scene.
            pairs: Joints between two nodes or attachments; ``None`` if all nodes are frames.
        """
        unknowns, m = equations.unknowns, equations.unknowns.m
        self._equations, self._n = equations, unknowns.moving
        self._pairs = _FramePairs(equations) if pairs is None else pairs
        self._own = slice(self._pairs.count, m)
        self._rolling = slice(m - unknowns.of_velocities, m)
        self._start: Array = np.zeros(m)
        self._length = unknowns.length
        self._weights = np.where(unknowns.lengths, 1.0, unknowns.length**2)

    def begin(self, H: Array) -> None:
        """Begin a step from nodes ``H``."""
        self._pairs.begin(H)
        self._start[:] = self._equations.constraints(H).values

    def add_forces(self, model: Model, state: State, this: Step, h: float) -> None:
        """Add forces to ``this.outer``; compute increments of constraints, and balances."""
        along, own, change = Span(*this.coordinates), self._own, this.change
        self._pairs.add_forces(model, state, this, h)
        change[own] = -model.driven[own]
        this.losses[WORK] -= state.multipliers[own] @ model.driven[own]
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
        kinds, sums = self._equations.arrays.kinds, (this.outer, this.losses)
        nodal = _Nodal(kinds, self._weights, along.middle, this.step)
        _add(sparse, own.start, gains, state.multipliers, nodal, self._length, sums)

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
        self._pairs.accept(H, driven, gap)
        if not self._equations.unknowns.driven:
            gap[self._own] = self._equations.constraints(H).values[self._own]

    def restart(self, H: Array, gap: Array) -> None:
        """Restart at nodes ``H`` with these constraint violations (m,)."""
        self._pairs.restart(H, gap)

    def energy(self, H: Array) -> float:
        """Energy of springs at nodes ``H``."""
        return self._pairs.energy(H)

    def saved_state(self) -> dict[str, Array]:
        """State for the next steps, that of the pairs."""
        return self._pairs.saved_state()

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Restore the state that :meth:`saved_state` returned."""
        self._pairs.restore(kept)
