"""External actions on a scene at one time, compiled: power, dissipation, forces from outside.

Each is the sum over all nodes, with moments about the origin, in one row ``(power, dissipation,
loads (6), reactions (6))``, in the order of :mod:`fem_lie.bodies.balances`. Forces between the
bodies of the scene have no resultant and are not evaluated.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined, linked, uncounted
from fem_lie._jit.copies import copy_blocks, copy_matrix, copy_vector
from fem_lie._jit.packed_arrays import Integers1, Numbers1, Numbers2, Numbers3, unpacking
from fem_lie.bodies.balances import BY_LOADS, LOADS, LOSS, POWER, REACTIONS, SIZE
from fem_lie.joints.equations import terms
from fem_lie.joints.equations.joint_arrays import PackedJoints, joint_arrays
from fem_lie.lie.node_types import floating, inertia, push_all_forward, wrench
from fem_lie.lie.node_types.floating import PlainFloating
from fem_lie.lie.node_types.inertia import PlainInertia
from fem_lie.lie.tuples import (
    Vector,
    add_dead,
    add_wrench,
    dot,
    load,
    load_row,
    plus,
    rotate,
    scaled,
)
from fem_lie.system.nodes.masses import PlainLoads

PlainScene: TypeAlias = tuple[
    Indices, PlainLoads, Array, PlainInertia, PackedJoints, PlainFloating, bool, bool
]
"""Types of the nodes, nodal loads, dead loads with a potential, mass-proportional damping, table of
joints, bodies that deform within their frames, whether to evaluate loads, and joints.
"""

PlainSeen: TypeAlias = tuple[Numbers1, Numbers2, Numbers3, Numbers2, Numbers1, Numbers1]
""":class:`LastState` as a plain tuple, which makes calls of compiled functions faster."""


class LastState(NamedTuple):
    """External actions at the start of a step.

    Attributes:
        row: Power, dissipation and resultants, see :func:`look`, shape (14,).
        wrenches: Forces of ground and prescribed frames, see :func:`look`, shape (p + 1, 6).
        H: Frames of all nodes, ground and prescribed motions.
        v: Twists, shape (n, 6).
        multipliers: Lagrange multipliers, shape (m,).
        targets: Targets of the constraints, shape (m,); zero if none is driven.
    """

    row: Array
    wrenches: Array
    H: Array
    v: Array
    multipliers: Array
    targets: Array

    @property
    def plain(self) -> PlainSeen:
        """Plain tuple of the fields, which makes calls of compiled functions faster."""
        return (*self,)


@inlined
def _turned(H: Array, local: Vector) -> Vector:
    return rotate(load_row(H, 1), load_row(H, 2), load_row(H, 3), local)


@uncounted
def add_local(kinds: Indices, H: Array, forces: Array, at: int, sign: float, out: Array) -> None:
    """Add nodal forces (n, 6), in the nodal axes, times ``sign``, to ``out`` at ``at``."""
    for i in range(forces.shape[0]):
        f, m = wrench(kinds[i], H[i], forces[i])
        add_wrench(out, at, load_row(H[i], 0), scaled(sign, f), scaled(sign, m))


@uncounted
def add_loads(
    kinds: Indices,
    H: Array,
    v: Array,
    loads: PlainLoads,
    conservative: Array,
    work: Array,
    out: Array,
) -> None:
    """Add nodal loads; those in ``conservative`` (n, 4, 3) have a potential and add no power.

    Args:
        kinds: Types of the nodes, (n,).
        H: Frames, shape (≥ n, 4, 3).
        v: Twists, shape (≥ n, 6).
        loads: See :class:`~fem_lie.system.nodes.masses.Loads`.
        conservative: Part of the dead loads.
        work: Workspace, shape (≥ 1, n, 4, 3).
        out: Shape (14,), updated.
    """
    dead, moment, following = loads
    n = dead.shape[0]
    push_all_forward(kinds, H, v, work[0])
    for i in range(n):
        for k in range(4):
            for j in range(3):
                out[POWER] += (dead[i, k, j] - conservative[i, k, j]) * work[0, i, k, j]
        add_dead(out, LOADS, 1.0, H[i], dead[i])
        spin, m = _turned(H[i], load(v[i], 3)), load(moment[i], 0)
        out[POWER] += dot(spin, m)
        for j in range(6):
            out[POWER] += following[i, j] * v[i, j]
        f = _turned(H[i], load(following[i], 0))
        m = plus(m, _turned(H[i], load(following[i], 3)))
        add_wrench(out, LOADS, load_row(H[i], 0), f, m)


@compiled
def add_mass_damping(
    kinds: Indices, H: Array, v: Array, D: PlainInertia, work: Array, out: Array
) -> None:
    """Add mass-proportional damping ``D q̇``; ``work`` (2, n, 4, 3)."""
    n = work.shape[1]
    push_all_forward(kinds, H, v, work[0])
    indptr, indices, blocks = D
    inertia.multiply(indptr, indices, blocks, work[0], work[1])
    for i in range(n):
        for k in range(4):
            out[LOSS] += dot(load_row(work[0, i], k), load_row(work[1, i], k))
        add_dead(out, LOADS, -1.0, H[i], work[1, i])


@compiled
def look(
    H: Array, v: Array, multipliers: Array, scene: PlainScene, row: Array, wrenches: Array
) -> None:
    """Evaluate nodal loads, mass-proportional damping, and joints.

    Args:
        H: Frames of all nodes, ground and prescribed motions.
        v: Twists, shape (n, 6).
        multipliers: Lagrange multipliers, shape (m,).
        scene: Arrays of the scene.
        row: Shape (14,), overwritten.
        wrenches: Forces and moments of ground and prescribed frames, in these frames, shape (p + 1,
            6), overwritten.
    """
    kinds, loads, conservative, damping, joints, bodies, loaded, joined = scene
    n, rows = conservative.shape[0], H.shape[0]
    work = np.empty((2, n, 4, 3))
    row[:], wrenches[:] = 0.0, 0.0
    if loaded:
        add_loads(kinds, H, v, loads, conservative, work, row)
        if bodies[0][0] > 0:
            floating.add_weights(H, bodies[0], bodies[1], row, LOADS + 3)
    indptr, _, _ = damping
    if indptr.shape[0] > 0:
        add_mass_damping(kinds, H, v, damping, work, row)
    if joined:
        table = joint_arrays(joints)
        terms.reactions(H, v, table, multipliers, wrenches)
        row[LOSS] += terms.damper_loss(H, v, table, multipliers) if len(table.springs) > 0 else 0.0
        add_local(np.zeros(rows - n, dtype=np.int64), H[n:], wrenches, REACTIONS, 1.0, row)


@compiled
def sum_up(
    h: float,
    end: tuple[Array, Array, Array, Array],
    row: Array,
    wrenches: Array,
    start: PlainSeen,
    total: Array,
) -> None:
    """Add a step to the balance, and make its end the start of the next step.

    Args:
        h: Step size.
        end: Frames, twists, multipliers and targets of the constraints at its end.
        row: Actions there, see :func:`look`.
        wrenches: Forces of ground and prescribed frames there, see :func:`look`.
        start: See :class:`LastState`, overwritten.
        total: See :class:`~fem_lie.system.balance.EnergyBalance`, updated.
    """
    H, v, multipliers, targets = end
    old_row, old_wrenches, old_H, old_v, old_multipliers, old_targets = start
    for k in range(SIZE):
        total[k if k < LOADS else k + BY_LOADS - LOADS] += 0.5 * h * (old_row[k] + row[k])
    for c in range(targets.shape[0]):
        total[POWER] -= 0.5 * (old_multipliers[c] + multipliers[c]) * (targets[c] - old_targets[c])
    moved, first = np.empty(6), H.shape[0] - wrenches.shape[0]
    for p in range(1, wrenches.shape[0]):
        lie.relative(old_H[first + p], H[first + p], moved)
        for k in range(6):
            total[POWER] += 0.5 * (old_wrenches[p, k] + wrenches[p, k]) * moved[k]
    copy_vector(row, old_row)
    copy_matrix(wrenches, old_wrenches)
    copy_blocks(H, old_H)
    copy_matrix(v, old_v)
    copy_vector(multipliers, old_multipliers)
    copy_vector(targets, old_targets)


class _Actions(NamedTuple):
    """Constant arrays of :func:`look_and_sum_up`.

    Attributes:
        kinds: Types of the nodes, (n,).
        loads: Nodal loads.
        conservative: Dead loads with a potential, (n, 4, 3).
        damping: Mass-proportional damping matrix.
        joints: Packed arrays of the joints.
        bodies: Bodies that deform within their frames.
        start: See :func:`sum_up`, as the next one.
        total: Energy balance and impulses.
    """

    kinds: Integers1
    loads: PlainLoads
    conservative: Numbers3
    damping: PlainInertia
    joints: PackedJoints
    bodies: PlainFloating
    start: PlainSeen
    total: Numbers1


_actions = unpacking(_Actions)


@linked
def look_and_sum_up(
    h: float,
    end: tuple[Array, Array, Array, Array],
    loaded: bool,
    joined: bool,
    table: Indices,
) -> None:
    """:func:`look` at the end of a step, then :func:`sum_up`.

    Args:
        h: Step size.
        end: As for :func:`sum_up`.
        loaded: Whether to evaluate loads.
        joined: Whether to evaluate joints.
        table: Constant arrays, see :class:`_Actions`.
    """
    this = _actions(table)
    constant = this.conservative, this.damping, this.joints, this.bodies
    scene = this.kinds, this.loads, *constant, loaded, joined
    row, wrenches = np.empty(SIZE), np.empty_like(this.start[1])
    H, v, multipliers, _ = end
    look(H, v, multipliers, scene, row, wrenches)
    sum_up(h, end, row, wrenches, this.start, this.total)


@linked
def look_at(
    H: Array,
    v: Array,
    multipliers: Array,
    looks: tuple[bool, bool],
    row: Array,
    wrenches: Array,
    table: Indices,
) -> None:
    """:func:`look` at a state within a step.

    Args:
        H: Frames of all nodes, ground and prescribed motions.
        v: Twists, shape (n, 6).
        multipliers: Lagrange multipliers, shape (m,).
        looks: Whether to evaluate loads, and joints.
        row: Shape (14,), overwritten.
        wrenches: Forces and moments of ground and prescribed frames, shape (p + 1, 6), overwritten.
        table: Constant arrays, see :class:`_Actions`.
    """
    this = _actions(table)
    constant = this.conservative, this.damping, this.joints, this.bodies
    look(H, v, multipliers, (this.kinds, this.loads, *constant, *looks), row, wrenches)
