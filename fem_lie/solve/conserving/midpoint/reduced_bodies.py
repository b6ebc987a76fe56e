r"""Reduced-order bodies over a step with exact kinetic and stored energy and momenta; compiled.

Such a body has the frame ``(x, d_k)`` of its first node and modal coordinates ``z`` in it
(:mod:`fem_lie.lie.node_types.floating_coordinates`). Its inertia is a constant matrix ``G`` of
``Q = (x, d_k, z_a d_k)``, so the *products* ``z_a d_k`` are further coordinates with a velocity
``U`` of their own, which the trapezoidal rule changes like any other: ``U₁ = 2 ΔQ/h − U``. Forces
``F = G (U₁ − U)/h`` do the work ``F·ΔQ = ½ U₁·G U₁ − ½ U·G U``. With means, increments, and the
vector ψ of the frame's Cayley rotation these are exact::

    Δz = d̄_k·Δr + r̄·Δd_k  (and likewise of directors),     r = x_i − x
    Δ(z_a d_k) = z̄_a Δd_k + Δz_a d̄_k = ψ × m_ak + Δz_a c_k
    m_ak = ½ (z_a d_k + (z_a d_k)₁) = z̄_a d̄_k + ¼ Δz_a Δd_k,      c_k = d̄_k − ¼ ψ × Δd_k

The last form of the increment is a rotation of the *mean of the product*, and the remainder. Its
transpose gives the frame the moment ``Σ m_ak × F_ak``, so that the angular momentum ``Σ Q × G U``
changes by moments of other forces only, and the coordinates the forces ``Σ_k c_k·F_ak``, with exact
work. The energy ``½ eᵀ K e`` of strains ``e_a = z_a + ½ Q_abc z_b z_c`` changes by
``½ (e + e₁)ᵀ K J(z̄) Δz``, because e is quadratic; and Δz does not depend on rigid motions of the
means.

Products of all bodies follow the nodal coordinates, ``(0, z_a d_1, z_a d_2, z_a d_3)`` for one
modal coordinate after the other, and have their rows in the mass matrix (:mod:`.products`). The
functions of this module are called by address, so that scenes without such bodies do not compile
them.
"""

from __future__ import annotations

from typing import Any, TypeAlias

import numba
import numpy as np
from numba import types

from fem_lie._arrays import Array, Indices
from fem_lie._jit import callback, inlined, uncounted
from fem_lie._jit.by_address import call_with_arrays
from fem_lie._jit.packed_arrays import Integers1, Numbers1
from fem_lie._jit.stack import blocks_at, matrix_at, stack, vector_at
from fem_lie.lie.node_types.floating import Floating, elastic_of, nodes_of, parts_of
from fem_lie.lie.node_types.floating_coordinates import (
    add_amplitudes,
    add_products,
    add_times,
    coordinates,
    spread,
    strains,
)
from fem_lie.lie.node_types.forces import add_along_increments
from fem_lie.lie.tuples import Vector, combined, cross, dot, load, load_row, plus, store

PackedBodies: TypeAlias = tuple[Integers1, Numbers1]
"""Integers and numbers of :class:`~fem_lie.lie.node_types.floating.Floating`; the last integers are
the addresses of the functions of this module."""

_SPAN, _ELASTIC, _INERTIA = -3, -2, -1
START, CHANGE, STRESS = 0, 1, 2
"""Modal coordinates of all bodies over a step: values at its start, increments, and increments of
stresses ``K e``; shape (3, m)."""


def packed_bodies(bodies: Floating) -> PackedBodies:
    """Pack the bodies of a scene."""
    functions = (_span, _add_elastic, _add_inertia) if bodies.integers[0] else ()
    addresses = np.array([function.address for function in functions], dtype=np.int64)
    return np.concatenate([bodies.integers, addresses]), bodies.numbers


@inlined
def dot_of(x: Array, y: Array) -> float:
    """``x·y``."""
    total = 0.0
    for a in range(x.shape[0]):
        total += x[a] * y[a]
    return total


@uncounted
def _gather(nodes: Indices, H: Array, rest: Array, mean: Array, delta: Array, q: Array) -> None:
    """Coordinates of a body's nodes at the start, at the mean, and increments, (3, k, 4, 3).

    Positions are relative to the first node: differences of large numbers are exact, and those of
    the digits beyond double precision have all digits.
    """
    first = nodes[0]
    for i in range(nodes.shape[0]):
        node = nodes[i]
        for j in range(3):
            start = (H[node, 0, j] - H[first, 0, j]) + (rest[node, 0, j] - rest[first, 0, j])
            moved = delta[node, 0, j] - delta[first, 0, j]
            q[0, i, 0, j], q[1, i, 0, j], q[2, i, 0, j] = start, start + 0.5 * moved, moved
            for k in range(1, 4):
                q[0, i, k, j] = H[node, k, j] + rest[node, k, j]
                q[1, i, k, j], q[2, i, k, j] = mean[node, k, j], delta[node, k, j]


@inlined
def span_products(
    bodies: PackedBodies,
    nodes: tuple[Array, Array],
    along: tuple[Array, Array],
    within: Array,
    means: Array,
    moved: Array,
) -> None:
    """Set modal coordinates and products over a step.

    Args:
        bodies: Reduced-order bodies of the scene.
        nodes: Nodal coordinates at the start, and their digits beyond double precision, (≥ n, 4,
            3).
        along: Means and increments of nodal coordinates, (≥ n, 4, 3).
        within: Values and increments of modal coordinates, see :data:`START`, updated.
        means: Means of the products, (p, 4, 3), overwritten.
        moved: Increments of nodal coordinates and products; the products, which come last, are
            overwritten, (≥ p, 4, 3).
    """
    (integers, numbers), (H, rest), (mean, delta) = bodies, nodes, along
    arrays = integers, numbers, H, rest, mean, delta, within, means, moved
    sizes = integers.shape[0], numbers.shape[0], H.shape[0], rest.shape[0], moved.shape[0]
    call_with_arrays(integers[_SPAN], arrays, sizes)


_Integers, _Doubles = types.CPointer(types.int64), types.CPointer(types.float64)


@callback(types.void(_Integers, *[_Doubles] * 8, *[types.int64] * 5))
def _span(
    integers_at: Any,
    numbers_at: Any,
    H_at: Any,
    rest_at: Any,
    mean_at: Any,
    delta_at: Any,
    within_at: Any,
    means_at: Any,
    moved_at: Any,
    size: int,
    length: int,
    rows: int,
    count: int,
    every: int,
) -> None:
    """:func:`span_products`, called by address with the sizes of all arrays."""
    p = every - count
    _span_all(
        numba.carray(integers_at, (size,)),
        numba.carray(numbers_at, (length,)),
        numba.carray(H_at, (rows, 4, 3)),
        numba.carray(rest_at, (count, 4, 3)),
        numba.carray(mean_at, (rows, 4, 3)),
        numba.carray(delta_at, (rows, 4, 3)),
        numba.carray(within_at, (3, p)),
        numba.carray(means_at, (p, 4, 3)),
        numba.carray(moved_at, (every, 4, 3))[count:],
    )


@uncounted
def _span_all(
    integers: Indices,
    numbers: Array,
    H: Array,
    rest: Array,
    mean: Array,
    delta: Array,
    within: Array,
    means: Array,
    moved: Array,
) -> None:
    first = 0
    for body in range(integers[0]):
        nodes, (interfaces, G) = nodes_of(integers, body), parts_of(integers, numbers, body)
        m, k = (G.shape[0] - 4) // 3, nodes.shape[0]
        at = stack(36 * k)
        q, flat = blocks_at(at, 3 * k, 4, 3), vector_at(at, 36 * k)
        _gather(nodes, H, rest, mean, delta, flat.reshape((3, k, 4, 3)))
        start, middle, change = q[:k], q[k : 2 * k], q[2 * k :]
        z, dz = within[START, first : first + m], within[CHANGE, first : first + m]
        coordinates(start, interfaces, z)
        for a in range(m):
            dz[a] = 0.0
        add_products(change[0], middle, interfaces, 1.0, dz)
        add_products(middle[0], change, interfaces, 1.0, dz)
        add_amplitudes(change, interfaces.shape[0], dz)
        for a in range(m):
            z̄ = z[a] + 0.5 * dz[a]
            for j in range(3):
                means[first + a, 0, j] = moved[first + a, 0, j] = 0.0
                for r in range(1, 4):
                    d, turned = middle[0, r, j], change[0, r, j]
                    means[first + a, r, j] = z̄ * d + 0.25 * dz[a] * turned
                    moved[first + a, r, j] = z̄ * turned + dz[a] * d
        first += m


@uncounted
def _add_within(
    kinds: Indices, nodes: Indices, g: Array, middle: Array, interfaces: Array, out: Array
) -> None:
    """Add forces ``g`` (m,) on modal coordinates to forces along increments, (n, 6)."""
    k = nodes.shape[0]
    f = blocks_at(stack(12 * k), k, 4, 3)
    f[:] = 0.0
    spread(g, middle, interfaces, f)
    for i in range(k):
        # positions in ``middle`` are differences, and cause no moment
        add_along_increments(kinds[nodes[i]], middle[i], f[i], out[nodes[i]])


@inlined
def add_elastic(
    bodies: PackedBodies,
    kinds: Indices,
    nodes: tuple[Array, Array],
    along: tuple[Array, Array],
    within: Array,
    filter_state: Array,
    energies: tuple[Array, Array],
    out: tuple[Array, Array],
    works: Array,
) -> None:
    """Add elastic forces over a step, whose work is the change of the stored energy.

    Args:
        bodies: Reduced-order bodies of the scene.
        kinds: Types of the nodes, (n,).
        nodes: As in :func:`span_products`.
        along: As in :func:`span_products`.
        within: Modal coordinates over the step; increments of stresses are set, (3, m).
        filter_state: Filter state of such increments, (m,), or (0,) without dissipation.
        energies: Stored energy at the end, and the work of the step, (bodies,), overwritten.
        out: Forces along increments, (n, 6), and those of increments of stresses and of their
            filter state, (2, n, 6) or (2, 0, 6), updated.
        works: Works of the last two, (2,), updated.
    """
    (integers, numbers), (H, rest), (mean, delta) = bodies, nodes, along
    (end, work), (forces, changes) = energies, out
    given = integers, kinds, numbers, H, rest, mean, delta, within, filter_state
    arrays = *given, end, work, forces, changes, works
    sizes = integers.shape[0], numbers.shape[0], H.shape[0], rest.shape[0]
    call_with_arrays(
        integers[_ELASTIC],
        arrays,
        (*sizes, within.shape[1], filter_state.shape[0], changes.shape[1]),
    )


@callback(types.void(_Integers, _Integers, *[_Doubles] * 12, *[types.int64] * 7))
def _add_elastic(
    integers_at: Any,
    kinds_at: Any,
    numbers_at: Any,
    H_at: Any,
    rest_at: Any,
    mean_at: Any,
    delta_at: Any,
    within_at: Any,
    filter_at: Any,
    end_at: Any,
    work_at: Any,
    forces_at: Any,
    changes_at: Any,
    works_at: Any,
    size: int,
    length: int,
    rows: int,
    count: int,
    p: int,
    kept: int,
    changed: int,
) -> None:
    """:func:`add_elastic`, called by address with the sizes of all arrays."""
    integers = numba.carray(integers_at, (size,))
    _add_all_elastic(
        integers,
        numba.carray(numbers_at, (length,)),
        numba.carray(kinds_at, (count,)),
        (numba.carray(H_at, (rows, 4, 3)), numba.carray(rest_at, (count, 4, 3))),
        (numba.carray(mean_at, (rows, 4, 3)), numba.carray(delta_at, (rows, 4, 3))),
        numba.carray(within_at, (3, p)),
        numba.carray(filter_at, (kept,)),
        (numba.carray(end_at, (integers[0],)), numba.carray(work_at, (integers[0],))),
        (numba.carray(forces_at, (count, 6)), numba.carray(changes_at, (2, changed, 6))),
        numba.carray(works_at, (2,)),
    )


@uncounted
def _add_all_elastic(
    integers: Indices,
    numbers: Array,
    kinds: Indices,
    nodes: tuple[Array, Array],
    along: tuple[Array, Array],
    within: Array,
    filter_state: Array,
    energies: tuple[Array, Array],
    out: tuple[Array, Array],
    works: Array,
) -> None:
    (end, done), (forces, changes), first = energies, out, 0
    for body in range(integers[0]):
        own, (interfaces, _) = nodes_of(integers, body), parts_of(integers, numbers, body)
        K, Q = elastic_of(integers, numbers, body)
        m, k = K.shape[0], own.shape[0]
        at = stack(36 * k)
        q, flat = blocks_at(at, 3 * k, 4, 3), vector_at(at, 36 * k)
        _gather(own, nodes[0], nodes[1], along[0], along[1], flat.reshape((3, k, 4, 3)))
        middle = q[k : 2 * k]
        J, some = matrix_at(stack(m * m), m, m), matrix_at(stack(6 * m), 6, m)
        z, e, change, stress, further, g = some[0], some[1], some[2], some[3], some[4], some[5]
        values, dz = within[START, first : first + m], within[CHANGE, first : first + m]
        strains(Q, values, J, e)
        for a in range(m):
            z[a], stress[a], further[a] = values[a] + 0.5 * dz[a], 0.0, 0.0
        add_times(K, e, stress)
        # only the derivative of the strains at the mean is needed
        strains(Q, z, J, g)
        for a in range(m):
            change[a] = dot_of(J[a], dz)
        add_times(K, change, further)
        work = 0.0
        for a in range(m):
            within[STRESS, first + a] = further[a]
            stress[a] += 0.5 * further[a]
            work += stress[a] * change[a]
            g[a] = 0.0
        add_times(J, stress, g)
        _add_within(kinds, own, g, middle, interfaces, forces)
        done[body] = work
        for a in range(m):
            z[a] = e[a] + change[a]
            stress[a] += 0.5 * further[a]
        end[body] = 0.5 * dot_of(z, stress)
        if filter_state.shape[0] > 0:
            kept = filter_state[first : first + m]
            works[0] += dot_of(further, change)
            works[1] += dot_of(kept, change)
            for part in range(2):
                for a in range(m):
                    g[a] = 0.0
                add_times(J, further if part == 0 else kept, g)
                _add_within(kinds, own, g, middle, interfaces, changes[part])
        first += m


@inlined
def add_inertia(
    bodies: PackedBodies,
    kinds: Indices,
    nodes: tuple[Array, Array],
    along: tuple[Array, Array],
    step: Array,
    within: Array,
    means: Array,
    F: Array,
    out: Array,
) -> None:
    """Add forces ``F`` on products as forces along increments.

    Args:
        bodies: Reduced-order bodies of the scene.
        kinds: Types of the nodes, (n,).
        nodes: As in :func:`span_products`.
        along: As in :func:`span_products`.
        step: Increments, (n, 6).
        within: Modal coordinates over the step, (3, m).
        means: Means of the products, (p, 4, 3).
        F: Forces on nodal coordinates and products, products last, (n + p, 4, 3).
        out: Forces along increments, updated, (n, 6).
    """
    (integers, numbers), (H, rest), (mean, delta) = bodies, nodes, along
    arrays = integers, kinds, numbers, H, rest, mean, delta, step, within, means, F, out
    sizes = integers.shape[0], numbers.shape[0], H.shape[0], rest.shape[0], means.shape[0]
    call_with_arrays(integers[_INERTIA], arrays, sizes)


@callback(types.void(_Integers, _Integers, *[_Doubles] * 10, *[types.int64] * 5))
def _add_inertia(
    integers_at: Any,
    kinds_at: Any,
    numbers_at: Any,
    H_at: Any,
    rest_at: Any,
    mean_at: Any,
    delta_at: Any,
    step_at: Any,
    within_at: Any,
    means_at: Any,
    F_at: Any,
    out_at: Any,
    size: int,
    length: int,
    rows: int,
    count: int,
    p: int,
) -> None:
    """:func:`add_inertia`, called by address with the sizes of all arrays."""
    _add_all_inertia(
        numba.carray(integers_at, (size,)),
        numba.carray(numbers_at, (length,)),
        numba.carray(kinds_at, (count,)),
        (numba.carray(H_at, (rows, 4, 3)), numba.carray(rest_at, (count, 4, 3))),
        (numba.carray(mean_at, (rows, 4, 3)), numba.carray(delta_at, (rows, 4, 3))),
        numba.carray(step_at, (count, 6)),
        numba.carray(means_at, (p, 4, 3)),
        numba.carray(F_at, (count + p, 4, 3))[count:],
        numba.carray(out_at, (count, 6)),
    )


@uncounted
def _add_all_inertia(
    integers: Indices,
    numbers: Array,
    kinds: Indices,
    nodes: tuple[Array, Array],
    along: tuple[Array, Array],
    step: Array,
    means: Array,
    F: Array,
    out: Array,
) -> None:
    first = 0
    for body in range(integers[0]):
        own, (interfaces, G) = nodes_of(integers, body), parts_of(integers, numbers, body)
        m, k, frame = (G.shape[0] - 4) // 3, own.shape[0], own[0]
        at = stack(36 * k)
        q, flat = blocks_at(at, 3 * k, 4, 3), vector_at(at, 36 * k)
        _gather(own, nodes[0], nodes[1], along[0], along[1], flat.reshape((3, k, 4, 3)))
        middle, change, g = q[k : 2 * k], q[2 * k :], vector_at(stack(m), m)
        moment: Vector = load(out[frame], 3)
        for a in range(m):
            g[a] = 0.0
        for r in range(1, 4):
            turned = cross(load(step[frame], 3), load_row(change[0], r))
            c = combined(1.0, load_row(middle[0], r), -0.25, turned)
            for a in range(m):
                force = load_row(F[first + a], r)
                g[a] += dot(c, force)
                moment = plus(moment, cross(load_row(means[first + a], r), force))
        store(out[frame], 3, moment)
        _add_within(kinds, own, g, middle, interfaces, out)
        first += m
