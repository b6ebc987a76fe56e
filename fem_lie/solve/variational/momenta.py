"""Momenta of the nodes at both ends of a step, compiled.

A frame has a momentum and an angular momentum about its position; a node with vector coordinates
has a momentum of each coordinate vector. All are in global components. Formulas in
:mod:`fem_lie.solve.variational.variational`.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled, inlined
from fem_lie._jit.packed_arrays import Numbers2, Numbers3
from fem_lie.forms.fixed_arrays import put
from fem_lie.joints.equations.joint_arrays import PackedJoints
from fem_lie.lie.node_types import inertia
from fem_lie.lie.node_types.floating import Floating
from fem_lie.lie.node_types.node_type import (
    POSITION_GRADIENT,
    axes,
    first_vector,
    vector_count,
)
from fem_lie.lie.tuples import (
    Vector,
    combined,
    cross,
    load,
    load_row,
    plus,
    rotate,
    rotate_back,
    scaled,
    store,
    store_row,
)
from fem_lie.solve.conserving.midpoint.products import add_on_rows
from fem_lie.solve.conserving.midpoint.reduced_bodies import (
    PackedBodies,
    packed_bodies,
    span_products,
)
from fem_lie.solve.conserving.step.joints import add_joints
from fem_lie.solve.variational import kinematics

PlainWithin: TypeAlias = tuple[PackedBodies, Numbers3, Numbers2, Numbers3, Numbers3]
"""Plain tuple of a :class:`Within`, with which compiled functions are called faster."""


class Within(NamedTuple):
    """Reduced-order bodies over a step.

    See :mod:`fem_lie.solve.conserving.midpoint.reduced_bodies`.

    Attributes:
        bodies: Reduced-order bodies of the scene.
        rest: Further digits of nodal coordinates beyond double precision, (n, 4, 3).
        coordinates: Modal coordinates over the step, (3, coordinates).
        means: Means of the products, (p, 4, 3).
        moved: Increments of all coordinates with inertia, (n + p, 4, 3).
    """

    bodies: PackedBodies
    rest: Array
    coordinates: Array
    means: Array
    moved: Array

    @classmethod
    def of(cls, bodies: Floating, rest: Array) -> Within:
        """Allocate the arrays for these bodies."""
        p, z = int(bodies.sizes.sum()), np.zeros
        return cls(packed_bodies(bodies), rest, z((3, p)), z((p, 4, 3)), z((len(rest) + p, 4, 3)))


@compiled
def of_rates(
    kinds: Indices,
    H: Array,
    V: Array,
    mass: inertia.PlainInertia,
    bodies: PackedBodies,
    out: Array,
) -> None:
    """Momenta from rates of nodal coordinates: of frames ``(G V)ₓ`` and ``Σ d_k × (G V)_k``.

    Args:
        kinds: Types of the nodes, (n,).
        H: Nodes, (≥ n, 4, 3).
        V: Rates of nodal coordinates and of products of reduced-order bodies, (n + p, 4, 3).
        mass: Inertia of these coordinates.
        bodies: Reduced-order bodies.
        out: Momenta, (n, 6), overwritten.
    """
    q, n = V.copy(), kinds.shape[0]
    inertia.multiply(mass[0], mass[1], mass[2], V, q)
    add_on_rows(bodies[0], bodies[1], H, q[n:], q[:n])
    for i in range(n):
        for at in (0, 3):
            store(out[i], at, _momentum(kinds[i], H[i], q[i], at))


@inlined
def _momentum(kind: int, H: Array, p: Array, at: int) -> Vector:
    """One half (3 components) of the momentum of a node, from momenta ``p`` (4, 3)."""
    if kind >= POSITION_GRADIENT:
        half = at // 3
        return (
            load_row(p, first_vector(kind) + half) if half < vector_count(kind) else (0.0, 0.0, 0.0)
        )
    return load_row(p, 0) if at == 0 else _moment(H, p)


@inlined
def _moment(H: Array, p: Array) -> Vector:
    """``Σ d_k × p_k``."""
    moment = (0.0, 0.0, 0.0)
    for k in range(1, 4):
        moment = plus(moment, cross(load_row(H, k), load_row(p, k)))
    return moment


@compiled
def keep_axes(kinds: Indices, end: Array, H: Array) -> None:
    """Give position and position-gradient nodes ``H`` the axes of ``end``, (≥ n, 4, 3)."""
    for i in range(kinds.shape[0]):
        if kinds[i] == POSITION_GRADIENT:
            store_row(H[i], 2, load_row(end[i], 2))
            store_row(H[i], 3, load_row(end[i], 3))


@compiled
def turn_with(kinds: Indices, before: Array, after: Array, spatial: Array) -> None:
    """Rotate rotations and spins (n, 6) of frames together with their axes.

    Args:
        kinds: Types of the nodes, (n,); other nodes are left unchanged.
        before: Nodes with their old axes, (≥ n, 4, 3).
        after: The same with their new axes.
        spatial: Vectors in global components, updated.
    """
    for i in range(spatial.shape[0]):
        if kinds[i] < POSITION_GRADIENT:
            d1, d2, d3 = axes(kinds[i], before[i])
            own = rotate_back(d1, d2, d3, load(spatial[i], 3))
            d1, d2, d3 = axes(kinds[i], after[i])
            store(spatial[i], 3, rotate(d1, d2, d3, own))


@compiled
def to_space(kinds: Indices, H: Array, local: Array, out: Array) -> None:
    """Forces (n, 6) along the axes of the nodes, transformed to global components into ``out``."""
    for i in range(out.shape[0]):
        d1, d2, d3 = axes(kinds[i], H[i])
        for at in (0, 3):
            store(out[i], at, rotate(d1, d2, d3, load(local[i], at)))


@compiled
def constrain(
    H: Array,
    coordinates: tuple[Array, Array, Array, Array],
    joints: PackedJoints,
    multipliers: Array,
    driven: Array,
    out: tuple[Array, Array],
) -> None:
    """Increments of the constraints over a step, and their forces at its start.

    Args:
        H: Nodes at the start.
        coordinates: See :func:`~.kinematics.between`.
        joints: Packed arrays of the joints.
        multipliers: Lagrange multipliers, (m,).
        driven: Increments of the constraints' targets, (m,).
        out: The increments, (m,), and forces and moments, (n, 6); overwritten.
    """
    delta, mean, _, _ = coordinates
    change, forces = out
    aside, ground, still = np.zeros_like(forces), np.zeros(6), np.zeros_like(delta)
    none = np.zeros_like(multipliers)
    add_joints(mean, delta, joints, none, driven, 1.0, change, aside, ground)
    # of springs, whose forces are also computed elsewhere
    aside[:], forces[:] = 0.0, 0.0
    unused = np.empty_like(change)
    add_joints(H, still, joints, none, driven, 1.0, unused, aside, ground)
    add_joints(H, still, joints, multipliers, driven, 1.0, unused, forces, ground)
    forces -= aside


@compiled
def balance(
    kinds: Indices,
    H: Array,
    step: Array,
    coordinates: tuple[Array, Array, Array, Array],
    mass: inertia.PlainInertia,
    h: float,
    acting: tuple[Array, Array, Array],
    held: Flags | Indices,
    within: PlainWithin,
    out: tuple[Array, Array],
) -> None:
    """Residual of the momenta at the start, and momenta at the end.

    Args:
        kinds: Types of the nodes, (n,).
        H: Nodes at the start.
        step: See :func:`~.kinematics.between`.
        coordinates: See :func:`~.kinematics.between`.
        mass: Inertia.
        h: Step size.
        acting: Momenta at the start, (n, 6); forces without inertia, as of a residual, in the
            midpoint frames, (n, 6); constraint forces at the start, (n, 6).
        held: Which unknowns are zero, (n, 6).
        within: Reduced-order bodies, see :class:`Within`.
        out: 4/h times the residual, in the equations of the unknowns of :mod:`.kinematics`, (n,
            6), and momenta at the end, (n, 6); overwritten.
    """
    delta, mean, end, middle = coordinates
    before, forces, constraints = acting
    r, after = out
    (bodies, rest, modal, means, moved), n = within, step.shape[0]
    for i in range(n):
        for k in range(4):
            store_row(moved[i], k, load_row(delta[i], k))
    if means.shape[0] > 0:
        span_products(bodies, (H, rest), (mean, delta), modal, means, moved)
    q, p = np.empty(moved.shape), np.empty(moved.shape)
    for i in range(moved.shape[0]):
        for k in range(4):
            for j in range(3):
                q[i, k, j] = moved[i, k, j] / h
    inertia.multiply(mass[0], mass[1], mass[2], q, p)
    put(p, q)
    add_on_rows(bodies[0], bodies[1], H, p[n:], p[:n])
    add_on_rows(bodies[0], bodies[1], end, q[n:], q[:n])
    for i in range(n):
        kind = kinds[i]
        d1, d2, d3 = axes(kind, middle[i])
        f = scaled(0.5 * h, rotate(d1, d2, d3, load(forces[i], 0)))
        m = scaled(0.5 * h, rotate(d1, d2, d3, load(forces[i], 3)))
        early, last = m, m
        if kind < POSITION_GRADIENT:
            early, last = kinematics.shares(load(step[i], 3), m)
            if held[i, 5] and not held[i, 3]:
                early, last = kinematics.shares_of_director(H[i], middle[i], end[i], m)
        for at in (0, 3):
            mine = _momentum(kind, H[i], p[i], at)
            own = f if at == 0 else early
            wrong = combined(1.0, plus(mine, own), -1.0, load(before[i], at))
            wrong = combined(1.0, wrong, h, load(constraints[i], at))
            later = _momentum(kind, end[i], q[i], at)
            own = f if at == 0 else last
            wrong = kinematics.free_part(kind, H[i], held[i], at, wrong)
            row = kinematics.to_midpoint(kind, middle[i], load(step[i], 3), at, wrong)
            store(r[i], at, scaled(4.0 / h, kinematics.free_components(row, held[i], at)))
            # the next step corrects the remainder: momenta are compensated sums
            store(after[i], at, combined(1.0, later, -1.0, plus(own, wrong)))
    kinematics.hold(kinds, end, held, after)


@compiled
def to_local(kinds: Indices, H: Array, p: Array, held: Flags | Indices, out: Array) -> None:
    """Spatial momenta (n, 6) along the axes of the nodes, without held components."""
    for i in range(p.shape[0]):
        d1, d2, d3 = axes(kinds[i], H[i])
        for at in (0, 3):
            store(out[i], at, rotate_back(d1, d2, d3, load(p[i], at)))
        for k in range(6):
            if held[i, k]:
                out[i, k] = 0.0
