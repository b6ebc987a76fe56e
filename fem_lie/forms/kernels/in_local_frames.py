"""Compiled kernels with DOLFINx's signature (UFCx) that call FFCx's functions and apply the map.

There is one kernel for each assembled quantity (energy, residual, tangent, independent stress,
local fields), the same for all energies and every :class:`~.addresses.FrameMap`. It calls FFCx's
functions, applies the map and condenses element-local fields ``s``. The addresses of FFCx's
functions and of the map are in a header of 64-bit integers in front of the form's constants:
nothing is recompiled when the energy changes, and numba can cache all kernels, which it could not
if a kernel were a closure over an address. :mod:`fem_lie.forms.wrapping` writes that header.
"""

from __future__ import annotations

import numba
import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import callback, compiled
from fem_lie._jit.stack import stack
from fem_lie.forms.kernels.addresses import (
    UFCX_SIGNATURE,
    Pointer,
    apply,
    own_entity,
    shift,
    tabulate,
)

# --- the header: 64-bit integers in the form's constants ------------------------------------------

COORDINATES, PULL_BACK, PUSH_FORWARD, GEOMETRIC = 0, 1, 2, 3  # addresses of the map's functions
N_Y, N_S, N_H, NODES = 4, 5, 6, 7  # sizes: coordinates, local fields, unknowns, nodes
AT_STATE, AT_Y, AT_H, AT_DY = 8, 9, 10, 11  # offsets into the packed coefficients w
FIRST, SECOND, THIRD, FOURTH = 12, 13, 14, 15  # where the descriptions of FFCx's functions begin
ENTITY = 16  # local number of the facets, for calls that pass none
HEADER_SIZE = 17
AT_Z = AT_H  # what the residual has instead of an increment
# a description: address (0: the form is zero), offset of its constants, doubles of its w, number of
# segments, then (offset in our w, length) of each segment


@compiled
def _inner(
    head: Indices,
    at: int,
    A: Pointer,
    w: Pointer,
    c: Pointer,
    x: Pointer,
    entity: Pointer,
    permutation: Pointer,
) -> None:
    """Call the FFCx function described at ``head[at]`` with its own layout of coefficients."""
    if head[at] == 0:
        return
    entity = own_entity(entity, shift(c, ENTITY))
    constants = shift(c, head[at + 1])
    segments = head[at + 3]
    if segments == 1:
        tabulate(head[at], A, shift(w, head[at + 4]), constants, x, entity, permutation)
        return
    own_pointer = stack(head[at + 2])
    own = numba.carray(own_pointer, (head[at + 2],))
    k = 0
    for segment in range(segments):
        start, length = head[at + 4 + 2 * segment], head[at + 5 + 2 * segment]
        source = numba.carray(shift(w, start), (length,))
        for i in range(length):
            own[k] = source[i]
            k += 1
    tabulate(head[at], A, own_pointer, constants, x, entity, permutation)


@compiled
def _clear(pointer: Pointer, size: int) -> None:
    values = numba.carray(pointer, (size,))
    for i in range(size):
        values[i] = 0.0


@compiled
def _solve(M: Array, B: Array) -> None:
    """Solve ``B ← M⁻¹ B`` by Gauss elimination with pivoting; ``M`` is overwritten.

    Zeros are skipped: mixed energies have blocks of zeros.
    """
    n, columns = B.shape
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(M[i, k]) > abs(M[pivot, k]):
                pivot = i
        if pivot != k:
            for j in range(n):
                M[k, j], M[pivot, j] = M[pivot, j], M[k, j]
            for j in range(columns):
                B[k, j], B[pivot, j] = B[pivot, j], B[k, j]
        for i in range(k + 1, n):
            if M[i, k] != 0.0:
                factor = M[i, k] / M[k, k]
                for j in range(k + 1, n):
                    M[i, j] -= factor * M[k, j]
                for j in range(columns):
                    B[i, j] -= factor * B[k, j]
    for k in range(n - 1, -1, -1):
        inverse = 1.0 / M[k, k]
        for j in range(columns):
            B[k, j] *= inverse
        for i in range(k):
            if M[i, k] != 0.0:
                factor = M[i, k]
                for j in range(columns):
                    B[i, j] -= factor * B[k, j]


@compiled
def _condense(K: Pointer, R: Pointer, M: Pointer, n_y: int, n_s: int) -> None:
    """Condense ``K −= Rᵀ M⁻¹ R`` of (n_y, n_y), (n_s, n_y), (n_s, n_s); ``M`` is overwritten."""
    whole, rows = numba.carray(K, (n_y, n_y)), numba.carray(R, (n_s, n_y))
    change = numba.carray(stack(n_s * n_y), (n_s, n_y))
    for k in range(n_s):
        for j in range(n_y):
            change[k, j] = rows[k, j]
    _solve(numba.carray(M, (n_s, n_s)), change)
    for k in range(n_s):
        for i in range(n_y):
            factor = rows[k, i]
            if factor != 0.0:
                for j in range(n_y):
                    whole[i, j] -= factor * change[k, j]


# --- the kernels ----------------------------------------------------------------------------------


@compiled
def _prepare(w: Pointer, c: Pointer) -> tuple[Indices, Pointer, Pointer]:
    """Header, pointers to state and coordinates; the map writes the coordinates first."""
    # the descriptions follow: the view is longer than its shape says
    head = numba.carray(c, (HEADER_SIZE,)).view(np.int64)
    state, y = shift(w, head[AT_STATE]), shift(w, head[AT_Y])
    if head[COORDINATES] != 0:
        apply(head[COORDINATES], state, y, y, y, head[NODES])
    return head, state, y


@compiled
def _pull_back_columns(
    head: Indices, state: Pointer, y: Pointer, K: Pointer, m: int, A: Pointer
) -> None:
    """Add ``Lᵀ K``, with ``K`` of (n_y, m), to ``A`` of (n_h, m)."""
    n_y, n_h = head[N_Y], head[N_H]
    column, pulled = stack(n_y), stack(n_h)
    columns, out = numba.carray(K, (n_y, m)), numba.carray(A, (n_h, m))
    column_values, pulled_values = numba.carray(column, (n_y,)), numba.carray(pulled, (n_h,))
    for j in range(m):
        for i in range(n_y):
            column_values[i] = columns[i, j]
        _clear(pulled, n_h)
        apply(head[PULL_BACK], state, y, column, pulled, head[NODES])
        for i in range(n_h):
            out[i, j] += pulled_values[i]


@compiled
def _add_in_frames(head: Indices, state: Pointer, y: Pointer, K: Pointer, A: Pointer) -> None:
    """Add ``Lᵀ K L``, with ``K`` of (n_y, n_y), to ``A`` of (n_h, n_h)."""
    n_y, n_h = head[N_Y], head[N_H]
    KL = stack(n_y * n_h)
    _clear(KL, n_y * n_h)
    for i in range(n_y):
        apply(head[PULL_BACK], state, y, shift(K, i * n_y), shift(KL, i * n_h), head[NODES])
    _pull_back_columns(head, state, y, KL, n_h, A)


@callback(UFCX_SIGNATURE)
def energy_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Rank 0: the energy of a cell."""
    head, _, _ = _prepare(w, c)
    _inner(head, head[FIRST], A, w, c, x, entity, permutation)


@callback(UFCX_SIGNATURE)
def energy_again_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Rank 0: the energy of a cell whose coordinates have been computed."""
    head = numba.carray(c, (HEADER_SIZE,)).view(np.int64)
    _inner(head, head[FIRST], A, w, c, x, entity, permutation)


@callback(UFCX_SIGNATURE)
def residual_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Rank 1: ``Lᵀ (f_y − K_ys z)`` with ``z = K_ss⁻¹ f_s``.

    First FFCx function: the bracket, second: f_s, third: K_ss.
    """
    head, state, y = _prepare(w, c)
    n_y, n_s = head[N_Y], head[N_S]
    if n_s > 0:
        z, M = shift(w, head[AT_Z]), stack(n_s * n_s)
        _clear(z, n_s)
        _clear(M, n_s * n_s)
        _inner(head, head[SECOND], z, w, c, x, entity, permutation)
        _inner(head, head[THIRD], M, w, c, x, entity, permutation)
        _solve(numba.carray(M, (n_s, n_s)), numba.carray(z, (n_s, 1)))
    f = stack(n_y)
    _clear(f, n_y)
    _inner(head, head[FIRST], f, w, c, x, entity, permutation)
    apply(head[PULL_BACK], state, y, f, A, head[NODES])


@callback(UFCX_SIGNATURE)
def tangent_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Rank 2: ``Lᵀ (K_yy − K_syᵀ K_ss⁻¹ K_sy) L + ∂(Lᵀ f_y)/∂h``.

    First FFCx function: K_yy, second: f_y of the independent stress, or none, and then no
    derivative of the map, third: K_sy, fourth: K_ss.
    """
    head, state, y = _prepare(w, c)
    n_y, n_s, nodes = head[N_Y], head[N_S], head[NODES]
    K, f = stack(n_y * n_y), stack(n_y)
    _clear(K, n_y * n_y)
    _clear(f, n_y)
    _inner(head, head[FIRST], K, w, c, x, entity, permutation)
    if head[SECOND] != 0:
        _inner(head, head[SECOND], f, w, c, x, entity, permutation)
        if head[GEOMETRIC] != 0:
            apply(head[GEOMETRIC], state, y, f, A, nodes)
    if n_s > 0:
        R, M = stack(n_s * n_y), stack(n_s * n_s)
        _clear(R, n_s * n_y)
        _clear(M, n_s * n_s)
        _inner(head, head[THIRD], R, w, c, x, entity, permutation)
        _inner(head, head[FOURTH], M, w, c, x, entity, permutation)
        _condense(K, R, M, n_y, n_s)
    _add_in_frames(head, state, y, K, A)


@callback(UFCX_SIGNATURE)
def viscous_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Rank 1: ``Lᵀ f(y, ẏ)`` with ``ẏ = L v``."""
    head, state, y = _prepare(w, c)
    f = stack(head[N_Y])
    _clear(f, head[N_Y])
    apply(head[PUSH_FORWARD], state, y, shift(w, head[AT_H]), shift(w, head[AT_DY]), head[NODES])
    _inner(head, head[FIRST], f, w, c, x, entity, permutation)
    apply(head[PULL_BACK], state, y, f, A, head[NODES])


@callback(UFCX_SIGNATURE)
def condensed_viscous_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Rank 1: ``−Lᵀ K_ys z`` with ``z = τ K_ss⁻¹ K_sy L v``, which follows ``L v`` in ``w``.

    First FFCx function: K_sy L v, second: K_ss/τ, third: −K_ys z.
    """
    head, state, y = _prepare(w, c)
    n_y, n_s = head[N_Y], head[N_S]
    z, M, f = shift(w, head[AT_DY] + n_y), stack(n_s * n_s), stack(n_y)
    _clear(z, n_s)
    _clear(M, n_s * n_s)
    _clear(f, n_y)
    apply(head[PUSH_FORWARD], state, y, shift(w, head[AT_H]), shift(w, head[AT_DY]), head[NODES])
    _inner(head, head[FIRST], z, w, c, x, entity, permutation)
    _inner(head, head[SECOND], M, w, c, x, entity, permutation)
    _solve(numba.carray(M, (n_s, n_s)), numba.carray(z, (n_s, 1)))
    _inner(head, head[THIRD], f, w, c, x, entity, permutation)
    apply(head[PULL_BACK], state, y, f, A, head[NODES])


@callback(UFCX_SIGNATURE)
def condensed_viscous_tangent_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Rank 2: ``−τ Lᵀ K_syᵀ K_ss⁻¹ K_sy L``. First FFCx function: K_sy, second: K_ss/τ."""
    head, state, y = _prepare(w, c)
    n_y, n_s = head[N_Y], head[N_S]
    K, R, M = stack(n_y * n_y), stack(n_s * n_y), stack(n_s * n_s)
    _clear(K, n_y * n_y)
    _clear(R, n_s * n_y)
    _clear(M, n_s * n_s)
    _inner(head, head[FIRST], R, w, c, x, entity, permutation)
    _inner(head, head[SECOND], M, w, c, x, entity, permutation)
    _condense(K, R, M, n_y, n_s)
    _add_in_frames(head, state, y, K, A)


@callback(UFCX_SIGNATURE)
def stress_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Rank 1: the new independent stress, ``σ(ε) + C ε'(y) L h``, times quadrature weights."""
    head, state, y = _prepare(w, c)
    dy = shift(w, head[AT_DY])
    apply(head[PUSH_FORWARD], state, y, shift(w, head[AT_H]), dy, head[NODES])
    _inner(head, head[FIRST], A, w, c, x, entity, permutation)


@callback(UFCX_SIGNATURE)
def local_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Rank 1: change of the local fields, ``−K_ss⁻¹ (f_s + K_sy L h)``.

    First FFCx function: the bracket, second: K_ss.
    """
    head, state, y = _prepare(w, c)
    n_s, dy = head[N_S], shift(w, head[AT_DY])
    f, M = stack(n_s), stack(n_s * n_s)
    _clear(f, n_s)
    _clear(M, n_s * n_s)
    apply(head[PUSH_FORWARD], state, y, shift(w, head[AT_H]), dy, head[NODES])
    _inner(head, head[FIRST], f, w, c, x, entity, permutation)
    _inner(head, head[SECOND], M, w, c, x, entity, permutation)
    z = numba.carray(f, (n_s, 1))
    _solve(numba.carray(M, (n_s, n_s)), z)
    out = numba.carray(A, (n_s,))
    for k in range(n_s):
        out[k] -= z[k, 0]


# --- blocks of other fields; their number of unknowns per cell is in N_S --------------------------


@callback(UFCX_SIGNATURE)
def field_columns_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Rank 2: ``Lᵀ ∂f_y/∂t`` for a field ``t``."""
    head, state, y = _prepare(w, c)
    n_y, n_t = head[N_Y], head[N_S]
    K = stack(n_y * n_t)
    _clear(K, n_y * n_t)
    _inner(head, head[FIRST], K, w, c, x, entity, permutation)
    _pull_back_columns(head, state, y, K, n_t, A)


@callback(UFCX_SIGNATURE)
def field_rows_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Rank 2: ``∂R_t/∂y L`` for the residual ``R_t`` of a field."""
    head, state, y = _prepare(w, c)
    n_y, n_t, n_h = head[N_Y], head[N_S], head[N_H]
    K = stack(n_y * n_t)
    _clear(K, n_y * n_t)
    _inner(head, head[FIRST], K, w, c, x, entity, permutation)
    for i in range(n_t):
        apply(head[PULL_BACK], state, y, shift(K, i * n_y), shift(A, i * n_h), head[NODES])
