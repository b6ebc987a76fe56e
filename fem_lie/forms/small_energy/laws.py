"""Strains and stress at a point of a cell, with their derivatives in forward mode: compiled.

Functions of an element are called with plain numbers or jets, which :func:`plain`, :func:`first`
and :func:`second` make: the ``order`` of what follows. Jets of strains stand one after the other,
each as :func:`.jets.store_parts` has it.
"""

from __future__ import annotations

from typing import Any

import numba

from fem_lie._arrays import Array
from fem_lie._jit import inlined
from fem_lie.forms.kernels.addresses import Pointer, shift
from fem_lie.forms.small_energy.element import Cells, CompiledFunction
from fem_lie.forms.small_energy.jets import first_order, numbers_at, second_order, store_parts
from fem_lie.forms.small_energy.vectors import CellData, find_sums

Function = CompiledFunction | None
"""Of an element, or ``None``."""


@inlined
def plain(numbers: Any) -> Any:
    """The numbers themselves, without derivatives."""
    return numbers


@inlined
def first(numbers: Any) -> Any:
    """Jets of first order."""
    return first_order(numbers)


@inlined
def second(numbers: Any) -> Any:
    """Jets of second order."""
    return second_order(numbers)


@inlined
def second_size(n: int) -> int:
    """Numbers of a jet of second order of ``n`` variables."""
    return 1 + n + n * (n + 1) // 2


@inlined
def _parameters(E: Cells, like: Any, data: CellData, p: int) -> Any:
    """Tuple of the parameters of a point."""
    return numbers_at(shift(data.parameters, p * E.parameters), like[2])


@inlined
def find_strains(
    E: Cells,
    strain: Function,
    order: CompiledFunction,
    like: Any,
    data: CellData,
    p: int,
    z: Array,
    s_at: Pointer,
    J_at: Pointer,
    J: Array,
    e: Array,
) -> None:
    """Strains ``e`` at a point with the vectors ``z``, and where they are a function their jets.

    Args:
        E: Constants of the element.
        strain: Function of the element.
        order: Of the jets.
        like: Tuples of the element.
        data: Of the cell.
        p: The point.
        z: All vectors.
        s_at: Workspace for the products.
        J_at: Where the jets are.
        J: The same as an array, shape (strains, any).
        e: Is set.
    """
    if strain is None:
        find_sums(E, z, e)
    else:
        find_sums(E, z, numba.carray(s_at, (E.terms.shape[0],)))
        store_parts(strain(order(numbers_at(s_at, like[0])), _parameters(E, like, data, p)), J_at)
        for i in range(E.strains):
            e[i] = J[i, 0]


# --- law ------------------------------------------------------------------------------------------


@inlined
def _quadratic(E: Cells, data: CellData, p: int, e: Array, N: Array) -> None:
    """Stress of a quadratic law; strains become those less ``e₀``."""
    n, C = E.strains, _moduli(E, data, p)
    natural = numba.carray(shift(data.parameters, p * E.parameters), (n,))
    for i in range(n):
        e[i] -= natural[i]
        N[i] = 0.0
    # along rows of the symmetric C
    for k in range(n):
        for i in range(n):
            N[i] += C[k, i] * e[k]


@inlined
def _moduli(E: Cells, data: CellData, p: int) -> Array:
    """``C`` of a quadratic law."""
    at = shift(data.parameters, p * E.parameters + E.strains)
    return numba.carray(at, (E.strains, E.strains))


@inlined
def energy_at(
    E: Cells, law: Function, like: Any, data: CellData, p: int, e_at: Pointer, e: Array, N: Array
) -> float:
    """Energy of the strains at a point; strains and ``N`` (strains,) are overwritten."""
    if law is None:
        value = 0.0
        _quadratic(E, data, p, e, N)
        for i in range(E.strains):
            value += 0.5 * N[i] * e[i]
        return value
    else:
        return float(law(numbers_at(e_at, like[1]), _parameters(E, like, data, p)))


@inlined
def find_stress(
    E: Cells,
    law: Function,
    order: CompiledFunction,
    like: Any,
    data: CellData,
    p: int,
    e_at: Pointer,
    e: Array,
    L: Pointer,
    N: Array,
    C: Array | None,
) -> None:
    """Stress ``N`` of the strains at a point, and ``C = ∂N/∂e`` unless it is ``None``.

    Strains of a quadratic law become those less ``e₀``; ``L``: workspace for a jet of this order.
    """
    n = E.strains
    if law is None:
        _quadratic(E, data, p, e, N)
        if C is not None:
            moduli = _moduli(E, data, p)
            for i in range(n):
                for j in range(n):
                    C[i, j] = moduli[i, j]
    else:
        jets = (law(order(numbers_at(e_at, like[1])), _parameters(E, like, data, p)),)
        store_parts(jets, L)
        for i in range(n):
            N[i] = L[1 + i]
        if C is not None:
            k = 1 + n
            for i in range(n):
                for j in range(i, n):
                    C[i, j] = C[j, i] = L[k]
                    k += 1


# --- between strains and products -----------------------------------------------------------------


@inlined
def pull_strains(E: Cells, strain: Function, N: Array, J: Array, g: Array) -> None:
    """Forces ``g`` on sums of products of stresses, by jets of strains of either order."""
    if strain is None:
        for i in range(E.strains):
            g[i] = N[i]
    else:
        for k in range(g.shape[0]):
            g[k] = 0.0
            for i in range(E.strains):
                g[k] += N[i] * J[i, 1 + k]


@inlined
def find_between(E: Cells, J: Array, C: Array, CJ: Array, M: Array) -> None:
    """``M = e′ᵀ C e′`` in the products, shape (products, products).

    ``CJ``: workspace for ``C e′``, shape (strains, products).
    """
    n, t = CJ.shape
    for i in range(n):
        for k in range(t):
            CJ[i, k] = 0.0
            for j in range(n):
                CJ[i, k] += C[i, j] * J[j, 1 + k]
    for k in range(t):
        for q in range(k, t):
            total = 0.0
            for i in range(n):
                total += J[i, 1 + k] * CJ[i, q]
            M[k, q] = M[q, k] = total


@inlined
def add_second_of_strains(E: Cells, J: Array, N: Array, M: Array) -> None:
    """Add ``N·e″`` to ``M``, by jets of second order."""
    t = M.shape[0]
    entry = 1 + t
    for k in range(t):
        for q in range(k, t):
            total = 0.0
            for i in range(E.strains):
                total += N[i] * J[i, entry]
            M[k, q] += total
            if q != k:
                M[q, k] += total
            entry += 1
