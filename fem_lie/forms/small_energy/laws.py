"""Strains and stress at a point of a cell, with their derivatives in forward mode: compiled.

Jets of strains stand one after the other, each as :func:`.jets.store_parts` has it.
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
def _parameters(E: Cells, like: Any, data: CellData, p: int) -> Any:
    """Tuple of the parameters of a point."""
    return numbers_at(shift(data.parameters, p * E.parameters), like[2])


@inlined
def find_strains(
    E: Cells,
    strain: Function,
    like: Any,
    data: CellData,
    p: int,
    z: Array,
    s_at: Pointer,
    e_at: Pointer,
) -> None:
    """Strains alone at a point with the vectors ``z``; ``s_at``: room for the products."""
    if strain is None:
        find_sums(E, z, numba.carray(e_at, (E.strains,)))
    else:
        find_sums(E, z, numba.carray(s_at, (E.terms.shape[0],)))
        store_parts(strain(numbers_at(s_at, like[0]), _parameters(E, like, data, p)), e_at)


@inlined
def find_first(
    E: Cells,
    strain: Function,
    like: Any,
    data: CellData,
    p: int,
    z: Array,
    s_at: Pointer,
    e_at: Pointer,
    J_at: Pointer,
) -> None:
    """Strains, and their jets of first order where they are a function of products."""
    if strain is None:
        find_sums(E, z, numba.carray(e_at, (E.strains,)))
    else:
        find_sums(E, z, numba.carray(s_at, (E.terms.shape[0],)))
        products = first_order(numbers_at(s_at, like[0]))
        store_parts(strain(products, _parameters(E, like, data, p)), J_at)
        _take_values(E, 1 + E.terms.shape[0], J_at, e_at)


@inlined
def find_second(
    E: Cells,
    strain: Function,
    like: Any,
    data: CellData,
    p: int,
    z: Array,
    s_at: Pointer,
    e_at: Pointer,
    J_at: Pointer,
) -> None:
    """Strains, and their jets of second order where they are a function of products."""
    if strain is None:
        find_sums(E, z, numba.carray(e_at, (E.strains,)))
    else:
        find_sums(E, z, numba.carray(s_at, (E.terms.shape[0],)))
        products = second_order(numbers_at(s_at, like[0]))
        store_parts(strain(products, _parameters(E, like, data, p)), J_at)
        _take_values(E, second_size(E.terms.shape[0]), J_at, e_at)


@inlined
def second_size(n: int) -> int:
    """Numbers of a jet of second order of ``n`` variables."""
    return 1 + n + n * (n + 1) // 2


@inlined
def _take_values(E: Cells, size: int, J_at: Pointer, e_at: Pointer) -> None:
    jets, e = numba.carray(J_at, (E.strains, size)), numba.carray(e_at, (E.strains,))
    for i in range(E.strains):
        e[i] = jets[i, 0]


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
    first = shift(data.parameters, p * E.parameters + E.strains)
    return numba.carray(first, (E.strains, E.strains))


@inlined
def energy_at(
    E: Cells, law: Function, like: Any, data: CellData, p: int, e_at: Pointer, N: Array
) -> float:
    """Energy of the strains at a point; strains and ``N`` (strains,) are overwritten."""
    if law is None:
        e, value = numba.carray(e_at, (E.strains,)), 0.0
        _quadratic(E, data, p, e, N)
        for i in range(E.strains):
            value += 0.5 * N[i] * e[i]
        return value
    else:
        parameters = _parameters(E, like, data, p)
        return float(law(numbers_at(e_at, like[1]), parameters))


@inlined
def find_stress(
    E: Cells, law: Function, like: Any, data: CellData, p: int, e_at: Pointer, L: Pointer, N: Array
) -> None:
    """Stress ``N`` of the strains at a point, which are overwritten; ``L``: room for a jet."""
    if law is None:
        _quadratic(E, data, p, numba.carray(e_at, (E.strains,)), N)
    else:
        parameters = _parameters(E, like, data, p)
        store_parts((law(first_order(numbers_at(e_at, like[1])), parameters),), L)
        jet = numba.carray(L, (1 + E.strains,))
        for i in range(E.strains):
            N[i] = jet[1 + i]


@inlined
def find_moduli(
    E: Cells,
    law: Function,
    like: Any,
    data: CellData,
    p: int,
    e_at: Pointer,
    L: Pointer,
    N: Array,
    C: Array,
) -> None:
    """Stress ``N`` and ``C = ∂N/∂e`` at a point; arguments as of :func:`find_stress`."""
    n = E.strains
    if law is None:
        _quadratic(E, data, p, numba.carray(e_at, (n,)), N)
        moduli = _moduli(E, data, p)
        for i in range(n):
            for j in range(n):
                C[i, j] = moduli[i, j]
    else:
        parameters = _parameters(E, like, data, p)
        store_parts((law(second_order(numbers_at(e_at, like[1])), parameters),), L)
        jet, k = numba.carray(L, (second_size(n),)), 1 + n
        for i in range(n):
            N[i] = jet[1 + i]
            for j in range(i, n):
                C[i, j] = C[j, i] = jet[k]
                k += 1


# --- between strains and products -----------------------------------------------------------------


@inlined
def pull_strains(E: Cells, N: Array, jets: Array, g: Array) -> None:
    """Forces ``g`` on products of stresses, by jets of strains of either order."""
    for k in range(g.shape[0]):
        g[k] = 0.0
        for i in range(E.strains):
            g[k] += N[i] * jets[i, 1 + k]


@inlined
def find_between(E: Cells, jets: Array, C: Array, N: Array, CJ: Array, M: Array) -> None:
    """``M = e′ᵀ C e′ + N·e″`` in the products, shape (products, products).

    ``CJ``: room for ``C e′``, shape (strains, products).
    """
    n, t = CJ.shape
    for i in range(n):
        for k in range(t):
            CJ[i, k] = 0.0
            for j in range(n):
                CJ[i, k] += C[i, j] * jets[j, 1 + k]
    entry = 1 + t
    for k in range(t):
        for q in range(k, t):
            total = 0.0
            for i in range(n):
                total += jets[i, 1 + k] * CJ[i, q] + N[i] * jets[i, entry]
            M[k, q] = M[q, k] = total
            entry += 1
