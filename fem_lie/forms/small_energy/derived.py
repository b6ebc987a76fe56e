"""Derived vectors of a cell, such as unit normals, with derivatives in forward mode; compiled.

A derived vector ``y = Y(z)`` of few linear vectors has few derivatives, so that functions of ``y``
need no jets of many variables. ``Y`` (d, 3, any) holds the derivatives of the derived vectors of a
point: for each component the value, the gradient and, for second order, the upper half of the
Hessian in the components of the inputs.
"""

from __future__ import annotations

from typing import Any

import numba

from fem_lie._arrays import Array
from fem_lie._jit import inlined
from fem_lie._jit.stack import matrix_at
from fem_lie.forms.kernels.addresses import Pointer, shift
from fem_lie.forms.small_energy.element import Cells, CompiledFunction
from fem_lie.forms.small_energy.jets import numbers_at, store_parts
from fem_lie.lie.tuples import Vector, load_row, plus, scaled, store


@inlined
def first_derived(E: Cells) -> int:
    """Index of the first derived vector."""
    return E.vectors + E.constants


@inlined
def find_derived(
    E: Cells,
    derive: CompiledFunction,
    order: CompiledFunction,
    like: Any,
    z: Array,
    x_at: Pointer,
    Y_at: Pointer,
    Y: Array,
) -> None:
    """Set the derived vectors, the last of ``z`` (all, 3), and their derivatives ``Y``.

    Args:
        E: Constants of the element.
        derive: Function of the element.
        order: Order of the derivatives, see :mod:`.laws`.
        like: Tuples of the element.
        z: All vectors; the linear and constant ones are input.
        x_at: Workspace for the components of the inputs.
        Y_at: Address of the derivatives.
        Y: Derivatives as an array, shape (d, 3, any).
    """
    for d in range(E.inputs.shape[0]):
        x = matrix_at(x_at, E.inputs.shape[1], 3)
        for j in range(E.inputs.shape[1]):
            store(x[j], 0, load_row(z, E.inputs[d, j]))
        made = derive(order(numbers_at(x_at, like[3])))
        store_parts(made, shift(Y_at, d * Y.shape[1] * Y.shape[2]))
        for c in range(3):
            z[first_derived(E) + d, c] = Y[d, c, 0]


@inlined
def find_derived_changes(E: Cells, Y: Array, dz: Array) -> None:
    """Set the changes of derived vectors, the last of ``dz`` (all, 3), from those of others."""
    for d in range(E.inputs.shape[0]):
        for c in range(3):
            change = 0.0
            for j in range(E.inputs.shape[1]):
                for i in range(3):
                    change += Y[d, c, 1 + 3 * j + i] * dz[E.inputs[d, j], i]
            dz[first_derived(E) + d, c] = change


@inlined
def _pulled(Y: Array, d: int, j: int, x: Vector) -> Vector:
    """Force ``x`` on a derived vector as a force on its j-th input."""
    first = 1 + 3 * j
    return (
        x[0] * Y[d, 0, first] + x[1] * Y[d, 1, first] + x[2] * Y[d, 2, first],
        x[0] * Y[d, 0, first + 1] + x[1] * Y[d, 1, first + 1] + x[2] * Y[d, 2, first + 1],
        x[0] * Y[d, 0, first + 2] + x[1] * Y[d, 1, first + 2] + x[2] * Y[d, 2, first + 2],
    )


@inlined
def pull_derived(E: Cells, Y: Array, fz: Array) -> None:
    """Add forces on derived vectors to those on their inputs; ``fz`` (all, 3)."""
    for d in range(E.inputs.shape[0]):
        force = load_row(fz, first_derived(E) + d)
        for j in range(E.inputs.shape[1]):
            v = E.inputs[d, j]
            store(fz[v], 0, plus(load_row(fz, v), _pulled(Y, d, j, force)))


@inlined
def _add_linear(T: Array, v: int, x: Vector, B: Array) -> None:
    for r in range(T.shape[1]):
        store(B[r], 0, plus(load_row(B, r), scaled(T[v, r], x)))


@inlined
def add_change(E: Cells, T: Array, Y: Array, v: int, x: Vector, B: Array) -> None:
    """Add the derivative of ``x·z_v`` in the coordinate vectors to ``B`` (r, 3)."""
    if v < E.vectors:
        _add_linear(T, v, x, B)
    elif v >= first_derived(E):
        d = v - first_derived(E)
        for j in range(E.inputs.shape[1]):
            _add_linear(T, E.inputs[d, j], _pulled(Y, d, j, x), B)


@inlined
def _count(E: Cells, v: int) -> int:
    """Number of components of linear vectors on which each component of a vector depends."""
    if v < E.vectors:
        return 1
    return 3 * E.inputs.shape[1] if v >= first_derived(E) else 0


@inlined
def _slope(E: Cells, Y: Array, v: int, c: int, k: int) -> tuple[int, float]:
    """Index of the k-th of these components, and the derivative of component ``c`` in it."""
    if v < E.vectors:
        return 3 * v + c, 1.0
    d = v - first_derived(E)
    return 3 * E.inputs[d, k // 3] + k % 3, Y[d, c, 1 + k]


@inlined
def _add_products(E: Cells, Y: Array, a: int, b: int, s: float, Q: Array) -> None:
    """Add ``s (δz_a·δz_b + δz_b·δz_a)`` to ``Q``."""
    for c in range(3):
        for k in range(_count(E, a)):
            i, first = _slope(E, Y, a, c, k)
            for m in range(_count(E, b)):
                j, second = _slope(E, Y, b, c, m)
                Q[i, j] += s * first * second
                Q[j, i] += s * first * second


@inlined
def find_derived_second(E: Cells, Y: Array, g: Array, fz: Array, Q: Array) -> None:
    """Set second derivatives of products with derived vectors in components of linear ones.

    Args:
        E: Constants of the element.
        Y: Derivatives of second order.
        g: Forces on sums of products.
        fz: Forces on all vectors, shape (all, 3).
        Q: Set, shape (3 curved, 3 curved).
    """
    for i in range(Q.shape[0]):
        for j in range(Q.shape[1]):
            Q[i, j] = 0.0
    for t in range(E.terms.shape[0]):
        a, b, s = E.terms[t, 1], E.terms[t, 2], E.factors[t] * g[E.terms[t, 0]]
        if max(a, b) >= first_derived(E):
            _add_products(E, Y, a, b, s, Q)
    size = 3 * E.inputs.shape[1]
    for d in range(E.inputs.shape[0]):
        force, entry = load_row(fz, first_derived(E) + d), 1 + size
        for k in range(size):
            i = 3 * E.inputs[d, k // 3] + k % 3
            for m in range(k, size):
                j = 3 * E.inputs[d, m // 3] + m % 3
                value = force[0] * Y[d, 0, entry] + force[1] * Y[d, 1, entry]
                value += force[2] * Y[d, 2, entry]
                Q[i, j] += value
                if k != m:
                    Q[j, i] += value
                entry += 1


@inlined
def find_linear_changes(E: Cells, T: Array, D: Array, Z: Array) -> None:
    """Derivatives of the first linear vectors in the unknowns, shape (curved, 3, groups, 3).

    ``D`` (r, 3, 3): derivatives of the coordinate vectors.
    """
    for v in range(Z.shape[0]):
        for c in range(3):
            for u in range(Z.shape[2]):
                store(Z[v, c, u], 0, (0.0, 0.0, 0.0))
        for r in range(T.shape[1]):
            group, t = E.coordinates[r, 2], T[v, r]
            for c in range(3):
                for m in range(3):
                    Z[v, c, group, m] += t * D[r, m, c]


@inlined
def derivatives_at(address: Pointer, E: Cells, size: int) -> Array:
    """Derivatives of all derived vectors of a point as an array, shape (d, 3, size)."""
    return numba.carray(address, (E.inputs.shape[0], 3, size))
