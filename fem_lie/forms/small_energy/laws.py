"""Strains and stress at a point of a cell, with derivatives in forward mode; compiled.

Functions of an element are called with plain numbers or jets, which :func:`plain`, :func:`first`
and :func:`second` create: the argument ``order`` of the functions here. Jets of strains are stored
one after the other, as by :func:`.jets.store_parts`.
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
"""Compiled function of an element, or ``None``."""


@inlined
def plain(numbers: Any) -> Any:
    """Plain numbers, without derivatives."""
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
    """Size of a jet of second order of ``n`` variables."""
    return 1 + n + n * (n + 1) // 2


@inlined
def _parameters(E: Cells, like: Any, data: CellData, p: int) -> Any:
    """Tuple of the parameters of the law at a point."""
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
    """Set the strains ``e`` at a point, and their jets if they are a function of products.

    Args:
        E: Constants of the element.
        strain: Function of the element.
        order: Order of the jets.
        like: Tuples of the element.
        data: Data of the cell.
        p: Index of the point.
        z: All vectors.
        s_at: Workspace for the products.
        J_at: Address of the jets.
        J: Jets as an array, shape (strains, any).
        e: Set, shape (strains,).
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
    """Set the stress of a quadratic law, and subtract ``e₀`` from the strains."""
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
def _factors(E: Cells, data: CellData, p: int) -> Array:
    """Factors of the stress conjugate to products of strains, shape (c, strains)."""
    at = shift(data.parameters, p * E.parameters + E.strains + E.strains * E.strains)
    return numba.carray(at, (E.pairs.shape[0], E.strains))


@inlined
def find_pair_stress(E: Cells, data: CellData, p: int, e: Array, S: Array) -> None:
    """Set the stress ``S`` (c,) conjugate to products of strains; ``e₀`` has been subtracted."""
    g = _factors(E, data, p)
    for c in range(E.pairs.shape[0]):
        S[c] = 0.0
        for i in range(E.strains):
            S[c] += g[c, i] * e[i]


@inlined
def _add_pairs(E: Cells, data: CellData, p: int, e: Array, N: Array, C: Array | None) -> float:
    """Add the stress of products of strains to ``N``, and return their energy.

    The derivative of ``N`` without that of :func:`add_pair_stiffness` is added to ``C``.
    """
    g, value = _factors(E, data, p), 0.0
    for c in range(E.pairs.shape[0]):
        j, k, stress = E.pairs[c, 0], E.pairs[c, 1], 0.0
        for i in range(E.strains):
            stress += g[c, i] * e[i]
        product = e[j] * e[k]
        value += stress * product
        N[j] += stress * e[k]
        N[k] += stress * e[j]
        for i in range(E.strains):
            N[i] += g[c, i] * product
            if C is not None:
                C[i, j] += g[c, i] * e[k]
                C[j, i] += g[c, i] * e[k]
                C[i, k] += g[c, i] * e[j]
                C[k, i] += g[c, i] * e[j]
    return value


@inlined
def add_pair_stiffness(E: Cells, S: Array, C: Array) -> None:
    """Add the second derivative of products of strains at their stress ``S`` (c,) to ``C``."""
    for c in range(E.pairs.shape[0]):
        j, k = E.pairs[c, 0], E.pairs[c, 1]
        C[j, k] += S[c]
        C[k, j] += S[c]


@inlined
def _moduli(E: Cells, data: CellData, p: int) -> Array:
    """Moduli ``C`` of a quadratic law."""
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
        return value + _add_pairs(E, data, p, e, N, None)
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
    """Set the stress ``N`` at a point, and ``C = ∂N/∂e`` unless it is ``None``.

    ``C`` is without :func:`add_pair_stiffness`.

    ``e₀`` of a quadratic law is subtracted from the strains; ``L`` is a workspace for a jet of this
    order.
    """
    n = E.strains
    if law is None:
        _quadratic(E, data, p, e, N)
        if C is not None:
            moduli = _moduli(E, data, p)
            for i in range(n):
                for j in range(n):
                    C[i, j] = moduli[i, j]
        _add_pairs(E, data, p, e, N, C)
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
    """Set forces ``g`` on sums of products from stresses, by jets of strains."""
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
    """Set ``M = e′ᵀ C e′`` in the products, shape (products, products).

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
    """Add ``N·e″`` to ``M``, from jets of second order."""
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
