"""Energy, forces, tangent, stress and viscous forces of a cell, from vectors, strains and a law.

The author of an element defines its cells, without any derivatives in the unknowns:

- vectors ``z = T q + z₀`` at each quadrature point, linear in the nodal coordinate vectors ``q``;
  constant vectors; and derived vectors that are functions of few linear ones, such as unit normals;
- strains ``e(s)``, sums of scalar products ``s = z_a·z_b`` or a function of these;
- a law ``W(e)``: ``½ (e − e₀)·C (e − e₀)``, possibly with products of strains, or a function,
  times the quadrature weight.

With ``N = ∂W/∂e``, ``C = ∂²W/∂e²`` and ``g = N·∂e/∂s``, forces and tangent stiffness are::

    f = Σ g_k s_k′,    K = s′ᵀ (e′ᵀ C e′ + N·e″) s′ + Σ g_k s_k″ + ∂(Lᵀ f)/∂h

``s′`` and ``s″`` of products follow from those of vectors; derivatives of derived vectors, of ``e``
in ``s`` and of the law are computed in forward mode (:mod:`.jets`); the last term is the rotation
of nodal axes with their nodes. Strains are invariant under rigid motion if they are functions of
scalar products of vectors that rotate with it. The linearised stress is that of ``e + e′ h``; where
it is used, the tangent has it instead of ``N``. Each node may have any type.

Each function evaluates one cell; a function of an element that passes its constants includes it
when compiled. The data of a cell are the coordinates of its nodes, then those of
:func:`.element.cell_data`.
"""

from __future__ import annotations

from typing import Any

import numba

from fem_lie._arrays import Array
from fem_lie._jit import inlined
from fem_lie._jit.stack import blocks_at, matrix_at, stack, vector_at
from fem_lie.forms.kernels.addresses import Pointer
from fem_lie.forms.small_energy.derived import (
    derivatives_at,
    find_derived,
    find_derived_second,
    find_linear_changes,
)
from fem_lie.forms.small_energy.element import Cells, CompiledFunction, Element
from fem_lie.forms.small_energy.laws import (
    Function,
    add_pair_stiffness,
    add_second_of_strains,
    energy_at,
    find_between,
    find_pair_stress,
    find_strains,
    find_stress,
    first,
    plain,
    pull_strains,
    second,
    second_size,
)
from fem_lie.forms.small_energy.vectors import (
    CellData,
    add_congruent,
    add_local,
    add_local_matrix,
    add_pulled,
    add_second,
    add_turning,
    add_turning_of_frames,
    all_vectors,
    clear,
    find_changes,
    find_directions,
    find_rates,
    find_vector_forces,
    find_vectors,
    push_local,
    read,
)


@inlined
def add_energy(of: Element, A: Pointer, w: Pointer) -> None:
    """Add the energy of a cell.

    Args:
        of: The element.
        A: Scalar, added to.
        w: Data of the cell.
    """
    _energy(of.cells, of.strain, of.law, of.derive, of.like, A, w)


@inlined
def add_forces(of: Element, A: Pointer, w: Pointer) -> None:
    """Add the forces along nodal axes to ``A`` (k, 6); see :func:`add_energy`."""
    _forces(of.cells, of.strain, of.law, of.derive, of.like, A, w, None)


@inlined
def add_tangent(of: Element, A: Pointer, w: Pointer) -> None:
    """Add the tangent stiffness at the stress of the strains to ``A`` (k, 6, k, 6)."""
    _tangent(
        of.cells, of.strain, of.law, of.derive, of.like, of.turning, None, None, None, second, A, w
    )


@inlined
def add_tangent_at_stress(of: Element, A: Pointer, w: Pointer) -> None:
    """Add the tangent stiffness at the linearised stress to ``A`` (k, 6, k, 6)."""
    _tangent(
        of.cells, of.strain, of.law, of.derive, of.like, of.turning, None, 1, None, second, A, w
    )


@inlined
def add_hessian_at_stress(of: Element, A: Pointer, w: Pointer) -> None:
    """Add the second derivative along :func:`~fem_lie.lie.motions.retract` at that stress.

    It is symmetric. The term subtracts the part of the current forces due to rotation of frames,
    which the system adds for all forces on a node.
    """
    _tangent(of.cells, of.strain, of.law, of.derive, of.like, of.turning, 1, 1, None, second, A, w)


@inlined
def update_stress(of: Element, A: Pointer, w: Pointer, h: Pointer) -> None:
    """Set the linearised stress in the data to that at the end of increments ``h`` (k, 6).

    The strains ``e + e′ h``, shape (points, strains), less ``e₀`` of a quadratic law, are written
    to ``A``.
    """
    _stress(of.cells, of.strain, of.law, of.derive, of.like, A, w, h)


@inlined
def add_viscous_forces(of: Element, A: Pointer, w: Pointer, v: Pointer) -> None:
    """Add the forces of the stress ``η ė`` at twists ``v`` (k, 6) to ``A`` (k, 6)."""
    _forces(of.cells, of.strain, of.law, of.derive, of.like, A, w, v)


@inlined
def add_viscous_tangent(of: Element, A: Pointer, w: Pointer) -> None:
    """Add the derivative of the viscous forces in the twists to ``A`` (k, 6, k, 6)."""
    _tangent(of.cells, of.strain, of.law, of.derive, of.like, None, None, None, 1, first, A, w)


@inlined
def _vectors_at(
    E: Cells,
    derive: Function,
    order: CompiledFunction,
    like: Any,
    data: CellData,
    p: int,
    z: Array,
    x_at: Pointer,
    Y_at: Pointer,
    Y: Array,
) -> None:
    """Set all vectors at a point, and the derivatives of derived vectors."""
    find_vectors(E, data, p, z)
    if derive is not None:
        find_derived(E, derive, order, like, z, x_at, Y_at, Y)


@inlined
def _energy(
    E: Cells, strain: Function, law: Function, derive: Function, like: Any, A: Pointer, w: Pointer
) -> None:
    data, value, n = read(E, w), vector_at(A, 1), E.strains
    z, x_at = matrix_at(stack(3 * all_vectors(E)), all_vectors(E), 3), stack(_inputs(E))
    Y_at, s_at, e_at = stack(_derived(E, 1)), stack(E.terms.shape[0]), stack(n)
    Y, e, N = derivatives_at(Y_at, E, 1), vector_at(e_at, n), vector_at(stack(n), n)
    J_at = stack(n)
    for p in range(E.points):
        _vectors_at(E, derive, plain, like, data, p, z, x_at, Y_at, Y)
        find_strains(E, strain, plain, like, data, p, z, s_at, J_at, matrix_at(J_at, n, 1), e)
        value[0] += energy_at(E, law, like, data, p, e_at, e, N)


@inlined
def _inputs(E: Cells) -> int:
    """Number of components of the inputs of a derived vector."""
    return 3 * E.inputs.shape[1]


@inlined
def _derived(E: Cells, size: int) -> int:
    """Size of the derivatives of all derived vectors of a point, ``size`` numbers per component."""
    return 3 * E.inputs.shape[0] * size


@inlined
def _forces(
    E: Cells,
    strain: Function,
    law: Function,
    derive: Function,
    like: Any,
    A: Pointer,
    w: Pointer,
    v: Pointer | None,
) -> None:
    """Add the forces of the stress of the strains or, with twists ``v``, of the viscous stress."""
    data, t, n, r = read(E, w), E.terms.shape[0], E.strains, E.starts.shape[0]
    sums, size, count = n if strain is None else t, 1 + _inputs(E), all_vectors(E)
    f, z, fz = (
        matrix_at(stack(3 * r), r, 3),
        matrix_at(stack(3 * count), count, 3),
        matrix_at(stack(3 * count), count, 3),
    )
    x_at, Y_at, s_at, J_at = stack(_inputs(E)), stack(_derived(E, size)), stack(t), stack(n + n * t)
    e_at, L = stack(n), stack(1 + n)
    Y, J, e = derivatives_at(Y_at, E, size), matrix_at(J_at, n, 1 + t), vector_at(e_at, n)
    N, g = vector_at(stack(n), n), vector_at(stack(sums), sums)
    ds, rate, dq = (
        vector_at(stack(sums), sums),
        vector_at(stack(n), n),
        matrix_at(stack(3 * r), r, 3),
    )
    clear(f)
    if v is not None:
        push_local(E, data.H, vector_at(v, 6 * E.types.shape[0]), dq)
    for p in range(E.points):
        _vectors_at(E, derive, first, like, data, p, z, x_at, Y_at, Y)
        find_strains(E, strain, first, like, data, p, z, s_at, J_at, J, e)
        if v is None:
            find_stress(E, law, first, like, data, p, e_at, e, L, N, None)
        else:
            find_rates(E, derive, data.tables[p], z, Y, dq, fz, ds)
            _find_changes(E, strain, J, ds, rate)
            for i in range(n):
                N[i] = 0.0
                for k in range(n):
                    N[i] += data.viscosity[p, i, k] * rate[k]
        pull_strains(E, strain, N, J, g)
        find_vector_forces(E, z, g, fz)
        add_pulled(E, derive, data.tables[p], Y, fz, f)
    add_local(E, data.H, f, vector_at(A, 6 * E.types.shape[0]))


@inlined
def _jet_size(viscous: int | None, n: int) -> int:
    """Size of a jet of ``n`` variables: of first order for viscous forces, else of second."""
    if viscous is None:
        return second_size(n)
    else:
        return 1 + n


@inlined
def _tangent(
    E: Cells,
    strain: Function,
    law: Function,
    derive: Function,
    like: Any,
    turning: int | None,
    symmetric: int | None,
    linearised: int | None,
    viscous: int | None,
    order: CompiledFunction,
    A: Pointer,
    w: Pointer,
) -> None:
    """Add the derivative of the elastic forces or, if ``viscous``, of the viscous forces."""
    data, t, n = read(E, w), E.terms.shape[0], E.strains
    r, u, count = E.starts.shape[0], E.groups.shape[0], all_vectors(E)
    sums, c = n if strain is None else t, 3 * E.curved
    width, size = _jet_size(viscous, t), _jet_size(viscous, _inputs(E))
    f, z, fz = (
        matrix_at(stack(3 * r), r, 3),
        matrix_at(stack(3 * count), count, 3),
        matrix_at(stack(3 * count), count, 3),
    )
    x_at, Y_at, s_at, J_at = stack(_inputs(E)), stack(_derived(E, size)), stack(t), stack(n * width)
    e_at, L = stack(n), stack(second_size(n))
    Y, J, e = derivatives_at(Y_at, E, size), matrix_at(J_at, n, width), vector_at(e_at, n)
    N, g = vector_at(stack(n), n), vector_at(stack(sums), sums)
    stress = vector_at(stack(E.pairs.shape[0]), E.pairs.shape[0])
    C, M = matrix_at(stack(n * n), n, n), matrix_at(stack(sums * sums), sums, sums)
    CJ, D = matrix_at(stack(n * sums), n, sums), blocks_at(stack(9 * r), r, 3, 3)
    B, S_at = blocks_at(stack(3 * sums * r), sums, r, 3), stack(3 * sums * u)
    S, MS = blocks_at(S_at, sums, u, 3), matrix_at(stack(3 * sums * u), sums, 3 * u)
    K, G = matrix_at(stack(9 * u * u), 3 * u, 3 * u), matrix_at(stack(r * r), r, r)
    Q, Z_at, QZ = (
        matrix_at(stack(c * c), c, c),
        stack(3 * c * u),
        matrix_at(stack(3 * c * u), c, 3 * u),
    )
    clear(f)
    clear(K)
    clear(G)
    find_directions(E, data.H, D)
    for p in range(E.points):
        T = data.tables[p]
        _vectors_at(E, derive, order, like, data, p, z, x_at, Y_at, Y)
        find_changes(E, derive, T, z, Y, D, B, S)
        find_strains(E, strain, order, like, data, p, z, s_at, J_at, J, e)
        if viscous is None:
            find_stress(E, law, order, like, data, p, e_at, e, L, N, C)
            find_pair_stress(E, data, p, e, stress)
        else:
            for i in range(n):
                for k in range(n):
                    C[i, k] = data.viscosity[p, i, k]
        if linearised is not None:
            for i in range(n):
                N[i] = data.stress[p, i]
            for i in range(E.pairs.shape[0]):
                stress[i] = data.stress[p, n + i]
        if viscous is None:
            add_pair_stiffness(E, stress, C)
        if strain is None:
            add_congruent(C, matrix_at(S_at, sums, 3 * u), MS, K)
        else:
            find_between(E, J, C, CJ, M)
            if viscous is None:
                add_second_of_strains(E, J, N, M)
            add_congruent(M, matrix_at(S_at, sums, 3 * u), MS, K)
        if viscous is None:
            pull_strains(E, strain, N, J, g)
            add_second(E, T, g, G)
            if derive is not None:
                find_vector_forces(E, z, g, fz)
                find_derived_second(E, Y, g, fz, Q)
                find_linear_changes(E, T, D, numba.carray(Z_at, (E.curved, 3, u, 3)))
                add_congruent(Q, matrix_at(Z_at, c, 3 * u), QZ, K)
        if turning is not None:
            find_vector_forces(E, z, g, fz)
            add_pulled(E, derive, T, Y, fz, f)
    add_local_matrix(E, D, K, G, matrix_at(A, 6 * E.types.shape[0], 6 * E.types.shape[0]))
    if turning is not None:
        add_turning(E, data.H, f, A)
        if symmetric is not None:
            add_turning_of_frames(E, data.H, f, A)


@inlined
def _stress(
    E: Cells,
    strain: Function,
    law: Function,
    derive: Function,
    like: Any,
    A: Pointer,
    w: Pointer,
    h: Pointer,
) -> None:
    data, t, n, r = read(E, w), E.terms.shape[0], E.strains, E.starts.shape[0]
    sums, size, count = n if strain is None else t, 1 + _inputs(E), all_vectors(E)
    dq, z, dz = (
        matrix_at(stack(3 * r), r, 3),
        matrix_at(stack(3 * count), count, 3),
        matrix_at(stack(3 * count), count, 3),
    )
    x_at, Y_at, s_at, J_at = stack(_inputs(E)), stack(_derived(E, size)), stack(t), stack(n + n * t)
    e_at, L = stack(n), stack(1 + n)
    Y, J, e = derivatives_at(Y_at, E, size), matrix_at(J_at, n, 1 + t), vector_at(e_at, n)
    N, change = vector_at(stack(n), n), vector_at(stack(n), n)
    ds, out = vector_at(stack(sums), sums), matrix_at(A, E.points, n)
    push_local(E, data.H, vector_at(h, 6 * E.types.shape[0]), dq)
    for p in range(E.points):
        _vectors_at(E, derive, first, like, data, p, z, x_at, Y_at, Y)
        find_strains(E, strain, first, like, data, p, z, s_at, J_at, J, e)
        find_rates(E, derive, data.tables[p], z, Y, dq, dz, ds)
        _find_changes(E, strain, J, ds, change)
        for i in range(n):
            e[i] += change[i]
        find_stress(E, law, first, like, data, p, e_at, e, L, N, None)
        find_pair_stress(E, data, p, e, data.stress[p, n:])
        for i in range(n):
            data.stress[p, i], out[p, i] = N[i], e[i]


@inlined
def _find_changes(E: Cells, strain: Function, J: Array, ds: Array, de: Array) -> None:
    """Set changes ``de`` of strains from changes ``ds`` of sums of products."""
    for i in range(E.strains):
        if strain is None:
            de[i] = ds[i]
        else:
            de[i] = 0.0
            for k in range(ds.shape[0]):
                de[i] += J[i, 1 + k] * ds[k]
