r"""Energy, forces, tangent, stress and viscous forces of a cell, from vectors, strains and a law.

An element says what its cells are, and nothing about derivatives in the unknowns:

- vectors ``z = T q + z₀`` at each of its points, linear in the nodal coordinate vectors ``q``;
- strains ``e(s)``, sums of scalar products ``s = z_a·z_b`` or a function of these;
- a law ``W(e)``: ``½ (e − e₀)·C (e − e₀)``, or a function, with the weight of the point.

With ``N = ∂W/∂e``, ``C = ∂²W/∂e²`` and ``g = N·∂e/∂s``, forces and tangent stiffness are::

    f = Σ g_k s_k′,    K = s′ᵀ (e′ᵀ C e′ + N·e″) s′ + Σ g_k s_k″ + ∂(Lᵀ f)/∂h

with ``s′`` and ``s″`` of products, derivatives in ``s`` and ``e`` in forward mode (:mod:`.jets`),
and the last part of nodal axes that turn with the node. Strains do not change in a rigid motion,
for scalar products do not. Nodes are of any types, each of its own. The linearised stress is that
of ``e + e′ h``; where it is used, the tangent has it in place of ``N``.

Every function here is of one cell, and is merged into a function of an element that passes its
constants. The data of a cell are the rows of its nodes, then those of :func:`.element.cell_data`.
"""

from __future__ import annotations

from typing import Any

import numba

from fem_lie._arrays import Array
from fem_lie._jit import inlined
from fem_lie._jit.stack import stack
from fem_lie.forms.kernels.addresses import Pointer
from fem_lie.forms.small_energy.element import Cells, Element
from fem_lie.forms.small_energy.laws import (
    Function,
    energy_at,
    find_between,
    find_first,
    find_moduli,
    find_second,
    find_strains,
    find_stress,
    pull_strains,
    second_size,
)
from fem_lie.forms.small_energy.vectors import (
    add_congruent,
    add_local,
    add_local_matrix,
    add_pulled,
    add_second,
    add_turning,
    find_changes,
    find_directions,
    find_rates,
    find_vectors,
    multiply,
    push_local,
    read,
)


@inlined
def add_energy(of: Element, A: Pointer, w: Pointer) -> None:
    """Energy of a cell.

    Args:
        of: The element.
        A: A number, added to.
        w: Data of the cell.
    """
    _energy(of.cells, of.strain, of.law, of.like, A, w)


@inlined
def add_forces(of: Element, A: Pointer, w: Pointer) -> None:
    """Forces along the axes of the nodes, added to ``A`` (k, 6); see :func:`add_energy`."""
    _forces(of.cells, of.strain, of.law, of.like, A, w)


@inlined
def add_tangent(of: Element, A: Pointer, w: Pointer) -> None:
    """Tangent stiffness, added to ``A`` (k, 6, k, 6), at the stress of the strains."""
    _tangent(of.cells, of.strain, of.law, of.like, of.turning, None, A, w)


@inlined
def add_tangent_at_stress(of: Element, A: Pointer, w: Pointer) -> None:
    """Tangent stiffness, added to ``A`` (k, 6, k, 6), at the linearised stress."""
    _tangent(of.cells, of.strain, of.law, of.like, of.turning, 1, A, w)


@inlined
def update_stress(of: Element, A: Pointer, w: Pointer, h: Pointer) -> None:
    """Set the linearised stress in the data to that at the end of increments ``h`` (k, 6).

    The strains ``e + e′ h``, shape (points, strains), less ``e₀`` of a quadratic law, are written
    to ``A``.
    """
    _stress(of.cells, of.strain, of.law, of.like, A, w, h)


@inlined
def add_viscous_forces(of: Element, A: Pointer, w: Pointer, v: Pointer) -> None:
    """Forces of the stress ``η ė`` at twists ``v`` (k, 6) of the nodes, added to ``A`` (k, 6)."""
    _viscous_forces(of.cells, of.strain, of.like, A, w, v)


@inlined
def add_viscous_tangent(of: Element, A: Pointer, w: Pointer) -> None:
    """Their derivative in the twists, added to ``A`` (k, 6, k, 6)."""
    _viscous_tangent(of.cells, of.strain, of.like, A, w)


@inlined
def _energy(E: Cells, strain: Function, law: Function, like: Any, A: Pointer, w: Pointer) -> None:
    data, value = read(E, w), numba.carray(A, (1,))
    z = numba.carray(stack(3 * E.vectors), (E.vectors, 3))
    s_at, e_at = stack(E.terms.shape[0]), stack(E.strains)
    N = numba.carray(stack(E.strains), (E.strains,))
    for p in range(E.points):
        find_vectors(E, data, p, z)
        find_strains(E, strain, like, data, p, z, s_at, e_at)
        value[0] += energy_at(E, law, like, data, p, e_at, N)


@inlined
def _forces(E: Cells, strain: Function, law: Function, like: Any, A: Pointer, w: Pointer) -> None:
    data, t, n, r = read(E, w), E.terms.shape[0], E.strains, E.rows.shape[0]
    f = numba.carray(stack(3 * r), (r, 3))
    z = numba.carray(stack(3 * E.vectors), (E.vectors, 3))
    fz = numba.carray(stack(3 * E.vectors), (E.vectors, 3))
    s_at, e_at, J_at, L = stack(t), stack(n), stack(n * (1 + t)), stack(1 + n)
    N, g = numba.carray(stack(n), (n,)), numba.carray(stack(t), (t,))
    _clear(f)
    for p in range(E.points):
        find_vectors(E, data, p, z)
        find_first(E, strain, like, data, p, z, s_at, e_at, J_at)
        find_stress(E, law, like, data, p, e_at, L, N)
        if strain is None:
            add_pulled(E, data.tables[p], z, N, fz, f)
        else:
            pull_strains(E, N, numba.carray(J_at, (n, 1 + t)), g)
            add_pulled(E, data.tables[p], z, g, fz, f)
    add_local(E, data.H, f, numba.carray(A, (6 * E.types.shape[0],)))


@inlined
def _clear(a: Array) -> None:
    for i in range(a.shape[0]):
        for k in range(a.shape[1]):
            a[i, k] = 0.0


@inlined
def _tangent(
    E: Cells,
    strain: Function,
    law: Function,
    like: Any,
    turning: int | None,
    linearised: int | None,
    A: Pointer,
    w: Pointer,
) -> None:
    data, t, n = read(E, w), E.terms.shape[0], E.strains
    r, u, size = E.rows.shape[0], E.groups.shape[0], 6 * E.types.shape[0]
    sums = n if strain is None else t
    f = numba.carray(stack(3 * r), (r, 3))
    z = numba.carray(stack(3 * E.vectors), (E.vectors, 3))
    fz = numba.carray(stack(3 * E.vectors), (E.vectors, 3))
    width = 1 if strain is None else second_size(t)
    s_at, e_at, J_at, L = stack(t), stack(n), stack(n * width), stack(second_size(n))
    N, g = numba.carray(stack(n), (n,)), numba.carray(stack(sums), (sums,))
    C, M = numba.carray(stack(n * n), (n, n)), numba.carray(stack(sums * sums), (sums, sums))
    CJ, D = numba.carray(stack(n * sums), (n, sums)), numba.carray(stack(9 * r), (r, 3, 3))
    B, S_at = numba.carray(stack(3 * sums * r), (sums, r, 3)), stack(3 * sums * u)
    S, rows = numba.carray(S_at, (sums, u, 3)), numba.carray(S_at, (sums, 3 * u))
    MS = numba.carray(stack(3 * sums * u), (sums, 3 * u))
    K, G = numba.carray(stack(9 * u * u), (3 * u, 3 * u)), numba.carray(stack(r * r), (r, r))
    _clear(f)
    _clear(K)
    _clear(G)
    find_directions(E, data.H, D)
    for p in range(E.points):
        T = data.tables[p]
        find_vectors(E, data, p, z)
        find_changes(E, T, z, D, B, S)
        find_second(E, strain, like, data, p, z, s_at, e_at, J_at)
        find_moduli(E, law, like, data, p, e_at, L, N, C)
        if linearised is not None:
            for i in range(n):
                N[i] = data.stress[p, i]
        if strain is None:
            for i in range(n):
                g[i] = N[i]
            add_congruent(C, rows, MS, K)
        else:
            jets = numba.carray(J_at, (n, width))
            find_between(E, jets, C, N, CJ, M)
            pull_strains(E, N, jets, g)
            add_congruent(M, rows, MS, K)
        add_second(E, T, g, G)
        if turning is not None:
            add_pulled(E, T, z, g, fz, f)
    add_local_matrix(E, D, K, G, numba.carray(A, (size, size)))
    if turning is not None:
        add_turning(E, data.H, f, A)


@inlined
def _stress(
    E: Cells, strain: Function, law: Function, like: Any, A: Pointer, w: Pointer, h: Pointer
) -> None:
    data, t, n, r = read(E, w), E.terms.shape[0], E.strains, E.rows.shape[0]
    dq = numba.carray(stack(3 * r), (r, 3))
    z = numba.carray(stack(3 * E.vectors), (E.vectors, 3))
    dz = numba.carray(stack(3 * E.vectors), (E.vectors, 3))
    s_at, e_at, J_at, L = stack(t), stack(n), stack(n * (1 + t)), stack(1 + n)
    e, N, change = (
        numba.carray(e_at, (n,)),
        numba.carray(stack(n), (n,)),
        numba.carray(stack(n), (n,)),
    )
    ds, out = numba.carray(stack(t), (t,)), numba.carray(A, (E.points, n))
    push_local(E, data.H, numba.carray(h, (6 * E.types.shape[0],)), dq)
    for p in range(E.points):
        find_vectors(E, data, p, z)
        multiply(data.tables[p], dq, dz)
        find_first(E, strain, like, data, p, z, s_at, e_at, J_at)
        _find_changes(E, strain, z, dz, J_at, ds, change)
        for i in range(n):
            e[i] += change[i]
        find_stress(E, law, like, data, p, e_at, L, N)
        for i in range(n):
            data.stress[p, i], out[p, i] = N[i], e[i]


@inlined
def _find_changes(
    E: Cells, strain: Function, z: Array, dz: Array, J_at: Pointer, ds: Array, de: Array
) -> None:
    """Changes ``de`` of strains of changes of vectors; ``ds``: room for those of products."""
    if strain is None:
        find_rates(E, z, dz, de)
    else:
        t, n = E.terms.shape[0], E.strains
        jets = numba.carray(J_at, (n, 1 + t))
        find_rates(E, z, dz, ds)
        for i in range(n):
            de[i] = 0.0
            for k in range(t):
                de[i] += jets[i, 1 + k] * ds[k]


@inlined
def _viscous_forces(
    E: Cells, strain: Function, like: Any, A: Pointer, w: Pointer, v: Pointer
) -> None:
    data, t, n, r = read(E, w), E.terms.shape[0], E.strains, E.rows.shape[0]
    dq = numba.carray(stack(3 * r), (r, 3))
    f = numba.carray(stack(3 * r), (r, 3))
    z = numba.carray(stack(3 * E.vectors), (E.vectors, 3))
    dz = numba.carray(stack(3 * E.vectors), (E.vectors, 3))
    s_at, e_at, J_at = stack(t), stack(n), stack(n * (1 + t))
    N, rate = numba.carray(stack(n), (n,)), numba.carray(stack(n), (n,))
    ds, g = numba.carray(stack(t), (t,)), numba.carray(stack(t), (t,))
    _clear(f)
    push_local(E, data.H, numba.carray(v, (6 * E.types.shape[0],)), dq)
    for p in range(E.points):
        find_vectors(E, data, p, z)
        multiply(data.tables[p], dq, dz)
        find_first(E, strain, like, data, p, z, s_at, e_at, J_at)
        _find_changes(E, strain, z, dz, J_at, ds, rate)
        for i in range(n):
            N[i] = 0.0
            for k in range(n):
                N[i] += data.viscosity[p, i, k] * rate[k]
        if strain is None:
            add_pulled(E, data.tables[p], z, N, dz, f)
        else:
            pull_strains(E, N, numba.carray(J_at, (n, 1 + t)), g)
            add_pulled(E, data.tables[p], z, g, dz, f)
    add_local(E, data.H, f, numba.carray(A, (6 * E.types.shape[0],)))


@inlined
def _viscous_tangent(E: Cells, strain: Function, like: Any, A: Pointer, w: Pointer) -> None:
    data, t, n = read(E, w), E.terms.shape[0], E.strains
    r, u, size = E.rows.shape[0], E.groups.shape[0], 6 * E.types.shape[0]
    sums = n if strain is None else t
    z = numba.carray(stack(3 * E.vectors), (E.vectors, 3))
    s_at, e_at, J_at = stack(t), stack(n), stack(n * (1 + t))
    M, D = numba.carray(stack(sums * sums), (sums, sums)), numba.carray(stack(9 * r), (r, 3, 3))
    B, S_at = numba.carray(stack(3 * sums * r), (sums, r, 3)), stack(3 * sums * u)
    S, rows = numba.carray(S_at, (sums, u, 3)), numba.carray(S_at, (sums, 3 * u))
    MS = numba.carray(stack(3 * sums * u), (sums, 3 * u))
    K, G = numba.carray(stack(9 * u * u), (3 * u, 3 * u)), numba.carray(stack(r * r), (r, r))
    _clear(K)
    _clear(G)
    find_directions(E, data.H, D)
    for p in range(E.points):
        find_vectors(E, data, p, z)
        find_changes(E, data.tables[p], z, D, B, S)
        if strain is None:
            add_congruent(data.viscosity[p], rows, MS, K)
        else:
            find_first(E, strain, like, data, p, z, s_at, e_at, J_at)
            jets = numba.carray(J_at, (n, 1 + t))
            for i in range(t):
                for k in range(t):
                    M[i, k] = 0.0
                    for a in range(n):
                        for b in range(n):
                            M[i, k] += jets[a, 1 + i] * data.viscosity[p, a, b] * jets[b, 1 + k]
            add_congruent(M, rows, MS, K)
    add_local_matrix(E, D, K, G, numba.carray(A, (size, size)))
